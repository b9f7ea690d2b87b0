#include "echofuse/estimation/mixture_em.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "echofuse/core/compensated_sum.hpp"
#include "echofuse/core/constants.hpp"
#include "echofuse/estimation/gaussian.hpp"

namespace echofuse::estimation {
namespace {

constexpr float kEmptyShare = 1e-6f;     ///< a component with less stays where it is, with share 0
constexpr float kLeastDensity = 1e-12f;  ///< [1/m^2] of a particle that nothing explains, for the logarithm
constexpr std::size_t kBlock = 16;       ///< [particle] looked at together
constexpr float kTwoPi = 2.0f * kPi;

bool within(float value, float least, float most) { return value >= least && value <= most; }

/// What the density of one component needs, computed once an iteration.
struct Density {
  float x_m, y_m;
  float information_xx, information_xy, information_yy;  ///< [1/m^2] inverse covariance
  float peak;                                            ///< [1/m^2] share times the density at the mean

  explicit Density(const MixtureComponent& c) : x_m(c.x_m), y_m(c.y_m) {
    const float determinant =
        c.covariance_xx_m2 * c.covariance_yy_m2 - c.covariance_xy_m2 * c.covariance_xy_m2;
    information_xx = c.covariance_yy_m2 / determinant;
    information_xy = -c.covariance_xy_m2 / determinant;
    information_yy = c.covariance_xx_m2 / determinant;
    peak = c.share / (kTwoPi * std::sqrt(determinant));
  }
  Density() = default;

  float at(const Particle& particle) const {
    const float dx = particle.x_m - x_m;
    const float dy = particle.y_m - y_m;
    return peak * gaussian_kernel(information_xx * dx * dx + 2.0f * information_xy * dx * dy +
                                  information_yy * dy * dy);
  }
};

/// Sums over the particles of one component, offsets from its mean before the step.
struct Moments {
  float weight = 0.0f;
  float x = 0.0f, y = 0.0f, vx = 0.0f, vy = 0.0f;
  float xx = 0.0f, xy = 0.0f, yy = 0.0f;

  void add(const Particle& particle, float x_m, float y_m, float part) {
    const float dx = particle.x_m - x_m;
    const float dy = particle.y_m - y_m;
    weight += part;
    x += part * dx;
    y += part * dy;
    vx += part * particle.vx_mps;
    vy += part * particle.vy_mps;
    xx += part * dx * dx;
    xy += part * dx * dy;
    yy += part * dy * dy;
  }
};

/// A few particles, component by component: what belongs to a component stays in registers meanwhile.
class Block {
 public:
  Block(const Particle* particles, std::size_t count, float background)
      : particles_(particles), count_(count) {
    for (std::size_t i = 0; i < count; ++i) density_[i] = background;
  }

  void add_density(const Density& density, std::size_t component) {
    const Density here = density;  // a copy, which no store can change
    for (std::size_t i = 0; i < count_; ++i) {
      const float part = here.at(particles_[i]);
      parts_[component][i] = part;
      density_[i] += part;
    }
  }

  /// From each particle's density its weight over it; 0 where nothing explains the particle.
  void share_out(float total, float background, CompensatedSum& stray) {
    for (std::size_t i = 0; i < count_; ++i) {
      const bool explained = density_[i] > 0.0f;
      density_[i] = explained ? particles_[i].weight / (total * density_[i]) : 0.0f;
      if (explained) stray.add(background * density_[i]);
    }
  }

  void add_moments(const MixtureComponent& component, std::size_t index, Moments& moments) const {
    Moments sums = moments;
    const float x_m = component.x_m;
    const float y_m = component.y_m;
    for (std::size_t i = 0; i < count_; ++i)
      if (parts_[index][i] > 0.0f) sums.add(particles_[i], x_m, y_m, parts_[index][i] * density_[i]);
    moments = sums;
  }

 private:
  const Particle* particles_;
  std::size_t count_;
  std::array<float, kBlock> density_;  ///< [1/m^2], then weight over it
  std::array<std::array<float, kBlock>, kMaxTargets> parts_;
};

float squared_distance_to_nearest(const Particle& particle, const Mixture& mixture) {
  if (mixture.components.empty()) return 1.0f;
  float nearest = std::numeric_limits<float>::infinity();
  for (const MixtureComponent& component : mixture.components) {
    const float dx = particle.x_m - component.x_m;
    const float dy = particle.y_m - component.y_m;
    nearest = std::fmin(nearest, dx * dx + dy * dy);
  }
  return nearest;
}

void add_centre(float x_m, float y_m, Mixture& mixture) {
  ECHOFUSE_CHECK(mixture.components.try_push_back({x_m, y_m, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f}));
}

void copy(const Mixture& from, Mixture& to) {
  (void)to.components.assign(from.components.span());
  to.background = from.background;
}

}  // namespace

const char* invalid_field(const MixtureConfig& config) {
  if (config.initialisation != PeakInitialisation::kMeasurements &&
      config.initialisation != PeakInitialisation::kKMeansPlusPlus)
    return "initialisation";
  if (config.restarts < 1 || config.restarts > 100) return "restarts";
  if (!within(config.initial_std_m, 1e-3f, 1e3f)) return "initial_std_m";
  if (!within(config.covariance_floor_m2, 1e-8f, 1e3f)) return "covariance_floor_m2";
  if (!within(config.background_density_per_m2, 0.0f, 1e3f)) return "background_density_per_m2";
  if (config.max_iterations < 1 || config.max_iterations > 1000) return "max_iterations";
  if (!within(config.tolerance_m, 0.0f, 1e3f)) return "tolerance_m";
  return nullptr;
}

Status MixtureFitter::configure(const MixtureConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  configured_ = true;
  return Status::kOk;
}

Status MixtureFitter::process(Span<const Particle> particles, Span<const MixtureSeed> seeds,
                              std::size_t n_components, Pcg32& random, Mixture& mixture) const {
  mixture.components.clear();
  mixture.background = 0.0f;
  if (!configured_) return Status::kNotConfigured;
  if (n_components == 0) return Status::kOk;
  const float total = total_weight(particles);
  if (!(total > 0.0f) || n_components > kMaxTargets) return Status::kInvalidInput;

  const bool from_seeds = config_.initialisation == PeakInitialisation::kMeasurements;
  const int n_starts = from_seeds ? 1 : config_.restarts;
  float best_likelihood = -std::numeric_limits<float>::infinity();
  Mixture tried;
  for (int start = 0; start < n_starts; ++start) {
    tried.components.clear();
    if (from_seeds) take_best_seeds(seeds, n_components, tried);
    fill_by_draws(particles, n_components, random, tried);
    iterate(particles, total, tried);
    const float likelihood = n_starts == 1 ? 0.0f : log_likelihood(particles, tried);
    if (likelihood > best_likelihood) {
      copy(tried, mixture);
      best_likelihood = likelihood;
    }
  }
  return Status::kOk;
}

void MixtureFitter::take_best_seeds(Span<const MixtureSeed> seeds, std::size_t n, Mixture& mixture) const {
  float last_mass = std::numeric_limits<float>::infinity();
  std::size_t last_index = 0;
  while (mixture.components.size() < n) {  // the next lighter one, the first of equals
    const MixtureSeed* best = nullptr;
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      const bool after_last = seeds[i].mass < last_mass || (seeds[i].mass == last_mass && i > last_index);
      if (!after_last || !(seeds[i].mass > (best == nullptr ? 0.0f : best->mass))) continue;
      best = &seeds[i];
    }
    if (best == nullptr) return;
    add_centre(best->x_m, best->y_m, mixture);
    last_mass = best->mass;
    last_index = static_cast<std::size_t>(best - seeds.data());
  }
}

void MixtureFitter::fill_by_draws(Span<const Particle> particles, std::size_t n, Pcg32& random,
                                  Mixture& mixture) const {
  while (mixture.components.size() < n) {
    CompensatedSum total;
    for (const Particle& particle : particles)
      total.add(particle.weight * squared_distance_to_nearest(particle, mixture));
    const float pointer = random.uniform() * total.value();
    CompensatedSum cumulative;
    std::size_t index = 0;
    for (; index + 1 < particles.size(); ++index) {
      cumulative.add(particles[index].weight * squared_distance_to_nearest(particles[index], mixture));
      if (cumulative.value() > pointer) break;
    }
    add_centre(particles[index].x_m, particles[index].y_m, mixture);
  }
}

void MixtureFitter::iterate(Span<const Particle> particles, float total, Mixture& mixture) const {
  const auto n = static_cast<float>(mixture.components.size());
  const float share = 1.0f / (config_.background_density_per_m2 > 0.0f ? n + 1.0f : n);
  for (MixtureComponent& component : mixture.components) {
    component.covariance_xx_m2 = component.covariance_yy_m2 = config_.initial_std_m * config_.initial_std_m;
    component.share = share;
  }
  mixture.background = config_.background_density_per_m2 > 0.0f ? share : 0.0f;
  for (int iteration = 0; iteration < config_.max_iterations; ++iteration)
    if (step(particles, total, mixture) <= config_.tolerance_m) return;
}

/// One expectation and one maximisation; returns how far the fastest mean moved in a coordinate [m].
float MixtureFitter::step(Span<const Particle> particles, float total, Mixture& mixture) const {
  const std::size_t n = mixture.components.size();
  std::array<Density, kMaxTargets> densities;
  std::array<Moments, kMaxTargets> moments;
  for (std::size_t c = 0; c < n; ++c) densities[c] = Density(mixture.components[c]);
  const float background = mixture.background * config_.background_density_per_m2;

  CompensatedSum stray;
  for (std::size_t first = 0; first < particles.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, particles.size() - first);
    Block block(particles.data() + first, count, background);
    for (std::size_t c = 0; c < n; ++c) block.add_density(densities[c], c);
    block.share_out(total, background, stray);
    for (std::size_t c = 0; c < n; ++c) block.add_moments(mixture.components[c], c, moments[c]);
  }

  float everything = stray.value();
  for (std::size_t c = 0; c < n; ++c) everything += moments[c].weight;
  mixture.background = everything > 0.0f ? stray.value() / everything : 0.0f;
  float moved = 0.0f;
  for (std::size_t c = 0; c < n; ++c) {
    MixtureComponent& component = mixture.components[c];
    const Moments& m = moments[c];
    component.share = 0.0f;
    if (!(m.weight > kEmptyShare)) continue;
    const float dx = m.x / m.weight;
    const float dy = m.y / m.weight;
    moved = std::fmax(moved, std::fmax(std::fabs(dx), std::fabs(dy)));
    component.x_m += dx;
    component.y_m += dy;
    component.vx_mps = m.vx / m.weight;
    component.vy_mps = m.vy / m.weight;
    component.covariance_xx_m2 = std::fmax(m.xx / m.weight - dx * dx, 0.0f) + config_.covariance_floor_m2;
    component.covariance_yy_m2 = std::fmax(m.yy / m.weight - dy * dy, 0.0f) + config_.covariance_floor_m2;
    component.covariance_xy_m2 = m.xy / m.weight - dx * dy;
    component.share = m.weight / everything;
  }
  return moved;
}

float MixtureFitter::log_likelihood(Span<const Particle> particles, const Mixture& mixture) const {
  const float total = total_weight(particles);
  const float background = mixture.background * config_.background_density_per_m2;
  std::array<Density, kMaxTargets> densities;
  for (std::size_t c = 0; c < mixture.components.size(); ++c) densities[c] = Density(mixture.components[c]);
  CompensatedSum sum;
  for (const Particle& particle : particles) {
    float density = background;
    for (std::size_t c = 0; c < mixture.components.size(); ++c) density += densities[c].at(particle);
    sum.add(particle.weight * std::log(std::fmax(density, kLeastDensity)));
  }
  return sum.value() / total;
}

}  // namespace echofuse::estimation
