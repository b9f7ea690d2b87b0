#include "echofuse/hub/track/phd_filter.hpp"

#include <algorithm>
#include <cmath>

#include "echofuse/core/compensated_sum.hpp"
#include "echofuse/core/constants.hpp"
#include "echofuse/estimation/gaussian.hpp"
#include "echofuse/estimation/resampling.hpp"

namespace echofuse::hub {
namespace {

using estimation::Particle;

bool within(float value, float least, float most) { return value >= least && value <= most; }

}  // namespace

const char* invalid_field(const PhdConfig& config) {
  if (!within(config.detection_probability, 0.0f, 1.0f)) return "detection_probability";
  if (!within(config.survival_probability, 1e-6f, 1.0f)) return "survival_probability";
  if (!within(config.clutter_per_frame, 0.0f, 1e6f)) return "clutter_per_frame";
  if (!within(config.birth_per_frame, 1e-9f, 1e3f)) return "birth_per_frame";
  if (!within(config.area_m2, 1e-3f, 1e9f)) return "area_m2";
  if (!within(config.measurement_std_m, 1e-3f, 1e3f)) return "measurement_std_m";
  if (!within(config.acceleration_density_m2ps3, 0.0f, 1e6f)) return "acceleration_density_m2ps3";
  if (!within(config.newborn_velocity_std_mps, 0.0f, 1e3f)) return "newborn_velocity_std_mps";
  if (config.particles_per_target < 1 || config.particles_per_target > static_cast<int>(kMaxParticles))
    return "particles_per_target";
  if (config.newborn_per_measurement < 1 ||
      config.newborn_per_measurement > static_cast<int>(kMaxNewbornParticles))
    return "newborn_per_measurement";
  if (config.mass_average_frames < 1 || config.mass_average_frames > 16) return "mass_average_frames";
  if (config.resampling != ResamplingChance::kSquareRoot &&
      config.resampling != ResamplingChance::kProportional)
    return "resampling";
  return nullptr;
}

Status PhdFilter::configure(const PhdConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  configured_ = true;
  reset();
  return Status::kOk;
}

void PhdFilter::reset() {
  random_ = Pcg32(config_.seed);
  n_particles_ = n_persistent_ = 0;
  seeds_.clear();
  n_masses_ = 0;
  mass_ = 0.0f;
  number_ = 0;
  peak_seed_ = 0;
}

Status PhdFilter::predict(float dt_s) {
  if (!configured_) return Status::kNotConfigured;
  if (!(dt_s > 0.0f) || !std::isfinite(dt_s)) return Status::kInvalidInput;
  n_persistent_ = n_particles_;
  const float kick_std_mps = std::sqrt(config_.acceleration_density_m2ps3 * dt_s);
  for (std::size_t i = 0; i < n_particles_; ++i) {
    Particle& particle = particles_[i];
    const float kick_x = kick_std_mps * random_.normal();
    const float kick_y = kick_std_mps * random_.normal();
    particle.x_m += dt_s * (particle.vx_mps + 0.5f * kick_x);
    particle.y_m += dt_s * (particle.vy_mps + 0.5f * kick_y);
    particle.vx_mps += kick_x;
    particle.vy_mps += kick_y;
    particle.weight *= config_.survival_probability;
  }
  return Status::kOk;
}

Status PhdFilter::update(Span<const Eigen::Vector2f> measurements) {
  if (!configured_) return Status::kNotConfigured;
  for (const Eigen::Vector2f& z : measurements)
    if (!z.allFinite()) return Status::kInvalidInput;
  const std::size_t n_used = std::min(measurements.size(), kMaxPointsPerFrame);
  n_persistent_ = std::min(n_particles_, kMaxParticles);
  n_particles_ = n_persistent_;
  seeds_.clear();

  for (std::size_t i = 0; i < n_persistent_; ++i)
    updated_[i] = (1.0f - config_.detection_probability) * particles_[i].weight;
  const float birth_per_m2 = config_.birth_per_frame / config_.area_m2;
  for (const Eigen::Vector2f& z : measurements.first(n_used)) {
    const float total = explain(z);
    CompensatedSum explained;
    for (std::size_t i = 0; i < n_persistent_; ++i) {
      if (parts_[i] == 0.0f) continue;
      const float share = parts_[i] / total;
      updated_[i] += share;
      explained.add(share);
    }
    ECHOFUSE_CHECK(seeds_.try_push_back({z.x(), z.y(), explained.value()}));
    const auto allowed =
        std::min(static_cast<std::size_t>(config_.newborn_per_measurement), kMaxNewbornParticles / n_used);
    add_newborn(z, birth_per_m2 / total, allowed);
  }
  for (std::size_t i = 0; i < n_persistent_; ++i) particles_[i].weight = updated_[i];
  peak_seed_ = random_.next_u32();
  count_targets();
  return n_used < measurements.size() ? Status::kTruncated : Status::kOk;
}

float PhdFilter::explain(const Eigen::Vector2f& z) {
  const float inverse_variance = 1.0f / (config_.measurement_std_m * config_.measurement_std_m);
  const float scale = config_.detection_probability * inverse_variance / (2.0f * kPi);
  CompensatedSum sum;
  for (std::size_t i = 0; i < n_persistent_; ++i) {
    const Particle& particle = particles_[i];
    const float dx = particle.x_m - z.x();
    const float dy = particle.y_m - z.y();
    const float squared = (dx * dx + dy * dy) * inverse_variance;
    parts_[i] = 0.0f;
    if (squared > estimation::kGaussianCutSquared) continue;
    parts_[i] = scale * estimation::gaussian_kernel(squared) * particle.weight;
    sum.add(parts_[i]);
  }
  return (config_.clutter_per_frame + config_.birth_per_frame) / config_.area_m2 + sum.value();
}

void PhdFilter::add_newborn(const Eigen::Vector2f& z, float mass, std::size_t count) {
  const float weight = mass / static_cast<float>(count);
  for (std::size_t i = 0; i < count; ++i) {
    Particle& particle = particles_[n_particles_++];
    particle.x_m = z.x() + config_.measurement_std_m * random_.normal();
    particle.y_m = z.y() + config_.measurement_std_m * random_.normal();
    particle.vx_mps = config_.newborn_velocity_std_mps * random_.normal();
    particle.vy_mps = config_.newborn_velocity_std_mps * random_.normal();
    particle.weight = weight;
  }
}

void PhdFilter::count_targets() {
  mass_ = estimation::total_weight(persistent());
  const auto window = static_cast<std::size_t>(config_.mass_average_frames);
  masses_[n_masses_ % window] = mass_;
  ++n_masses_;
  const std::size_t n = std::min(n_masses_, window);
  float sum = 0.0f;
  for (std::size_t i = 0; i < n; ++i) sum += masses_[i];
  const float rounded = std::floor(sum / static_cast<float>(n) + 0.5f);
  number_ = std::min(static_cast<std::size_t>(rounded), kMaxTargets);
}

Status PhdFilter::resample() {
  if (!configured_) return Status::kNotConfigured;
  const std::size_t wanted =
      static_cast<std::size_t>(config_.particles_per_target) * std::max<std::size_t>(1, number_);
  const std::size_t n_out = std::min(wanted, kMaxParticles);
  const bool by_root = config_.resampling == ResamplingChance::kSquareRoot;
  for (std::size_t i = 0; i < n_particles_; ++i)
    parts_[i] = by_root ? std::sqrt(particles_[i].weight) : particles_[i].weight;
  const float total = estimation::total_weight(particles());
  const float uniform = random_.uniform();
  const Span<std::uint16_t> drawn(drawn_.data(), n_out);
  const Status status = estimation::systematic_resample({parts_.data(), n_particles_}, uniform, drawn);
  if (status != Status::kOk) {  // no particles, or none with a weight
    n_particles_ = n_persistent_ = 0;
    return Status::kOk;
  }

  constexpr std::array<float Particle::*, estimation::kParticleColumns> kMembers = {
      &Particle::x_m, &Particle::vx_mps, &Particle::y_m, &Particle::vy_mps, &Particle::weight};
  for (float Particle::*member : kMembers) {  // column by column, through one column of scratch
    for (std::size_t k = 0; k < n_out; ++k) parts_[k] = particles_[drawn_[k]].*member;
    for (std::size_t k = 0; k < n_out; ++k) particles_[k].*member = parts_[k];
  }
  n_particles_ = n_persistent_ = n_out;
  for (std::size_t k = 0; k < n_out; ++k)
    particles_[k].weight = by_root ? std::sqrt(particles_[k].weight) : 1.0f;
  const float scale = total / estimation::total_weight(particles());
  for (std::size_t k = 0; k < n_out; ++k) particles_[k].weight *= scale;
  return Status::kOk;
}

}  // namespace echofuse::hub
