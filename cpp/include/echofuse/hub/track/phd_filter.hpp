#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/eigen.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/random.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/estimation/mixture_em.hpp"
#include "echofuse/estimation/particle_set.hpp"

namespace echofuse::hub {

enum class ResamplingChance : std::uint8_t {
  kSquareRoot,    ///< root of the weight: the few light particles of a missed or a new target live on
  kProportional,  ///< the weight (paper): all particles weigh the same afterwards
};

struct PhdConfig {
  float detection_probability = 0.9f;       ///< [1] of a target, per frame, in [0, 1]
  float survival_probability = 0.99f;       ///< [1] of a target, per frame, in (0, 1]
  float clutter_per_frame = 2.0f;           ///< [1] expected clutter points, uniform over the area, >= 0
  float birth_per_frame = 0.02f;            ///< [1] expected new targets, uniform over the area, > 0
  float area_m2 = 69.0f;                    ///< [m^2] of the monitored area, > 0
  float measurement_std_m = 0.3f;           ///< [m] of a point, per coordinate, > 0
  float acceleration_density_m2ps3 = 0.1f;  ///< [m^2/s^3] velocity variance gained per second, >= 0
  float newborn_velocity_std_mps = 1.2f;    ///< [m/s] per coordinate, >= 0
  int particles_per_target = 1000;          ///< [1] 1 to kMaxParticles; kMaxParticles in total
  int newborn_per_measurement = 64;         ///< [1] 1 to kMaxNewbornParticles; kMaxNewbornParticles in total
  int mass_average_frames = 1;              ///< [1] over which the mass is averaged before rounding, 1 to 16
  ResamplingChance resampling = ResamplingChance::kSquareRoot;
  std::uint64_t seed = 1;  ///< of the random stream
};

/// nullptr, or the name of the first member with an impossible value.
const char* invalid_field(const PhdConfig& config);

/// Particle PHD filter with measurement-driven birth (Mahler, IEEE Trans. Aerospace and Electronic Systems
/// 39(4), 2003; persistent and newborn targets apart as Ristic, Clark, Vo & Vo, ibid. 48(2), 2012):
///   L(z) = kappa + n_b/A + sum_i p_D g(z|x_i) w_i,  w_i <- (1 - p_D) w_i + sum_z p_D g(z|x_i) w_i / L(z),
///   newborn of z: particles around z with mass (n_b/A) / L(z), which join the persistent ones in the next
///   frame.
/// A frame is predict, update, resample. Work: particles * measurements.
/// Random draws: predict, a normal for x and one for y of each particle; update, four normals (x, y, vx, vy)
/// for each newborn particle, measurement by measurement, then 32 bits (peak_seed); resample, one uniform
/// number. Reference: python/echofuse/reference/hub/track/phd_filter.py
class PhdFilter {
 public:
  /// Also resets. kInvalidConfig: the earlier configuration and state stay in force.
  Status configure(const PhdConfig& config);

  /// Forgets everything; the random stream starts anew.
  void reset();

  /// dt_s: [s] > 0 since the last frame, else kInvalidInput and nothing changes.
  Status predict(float dt_s);

  /// kInvalidInput: a measurement is not finite; nothing changes. kTruncated: the first kMaxPointsPerFrame
  /// used.
  Status update(Span<const Eigen::Vector2f> measurements);

  /// Draws the particles of the next frame; the mass stays.
  Status resample();

  /// After predict and resample: persistent ones. After update: persistent, then newborn.
  Span<const estimation::Particle> particles() const { return {particles_.data(), n_particles_}; }
  Span<const estimation::Particle> persistent() const { return {particles_.data(), n_persistent_}; }

  /// Of the last update: position of each measurement and the persistent mass that it explains.
  Span<const estimation::MixtureSeed> seeds() const { return seeds_.span(); }
  float mass() const { return mass_; }            ///< [1] expected number of targets after the last update
  std::size_t number() const { return number_; }  ///< mass averaged over frames, rounded, <= kMaxTargets
  std::uint32_t peak_seed() const { return peak_seed_; }  ///< for the search for peaks in this frame

 private:
  static constexpr std::size_t kPoolSize = kMaxParticles + kMaxNewbornParticles;
  static constexpr std::size_t kMaxAveragedFrames = 16;

  /// [1/m^2] L(z); parts_ holds p_D g(z|x_i) w_i afterwards.
  float explain(const Eigen::Vector2f& z);
  void add_newborn(const Eigen::Vector2f& z, float mass, std::size_t count);
  void count_targets();

  PhdConfig config_{};
  bool configured_ = false;
  Pcg32 random_{};
  std::array<estimation::Particle, kPoolSize> particles_{};
  std::size_t n_particles_ = 0;
  std::size_t n_persistent_ = 0;
  std::array<float, kPoolSize> parts_{};              ///< scratch: one value a particle
  std::array<float, kMaxParticles> updated_{};        ///< scratch: weights after the update
  std::array<std::uint16_t, kMaxParticles> drawn_{};  ///< scratch: resampled indices
  BoundedVector<estimation::MixtureSeed, kMaxPointsPerFrame> seeds_;
  std::array<float, kMaxAveragedFrames> masses_{};  ///< ring of the last frames
  std::size_t n_masses_ = 0;                        ///< frames seen so far
  float mass_ = 0.0f;
  std::size_t number_ = 0;
  std::uint32_t peak_seed_ = 0;
};

}  // namespace echofuse::hub
