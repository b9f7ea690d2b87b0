#pragma once

#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/random.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/estimation/particle_set.hpp"

namespace echofuse::estimation {

enum class PeakInitialisation : std::uint8_t {
  kMeasurements,    ///< at the heaviest seeds; only what they do not fill is drawn
  kKMeansPlusPlus,  ///< all drawn as k-means++ does, `restarts` times; the likeliest result is kept
};

struct MixtureConfig {
  PeakInitialisation initialisation = PeakInitialisation::kMeasurements;
  int restarts = 3;                   ///< [1] of kKMeansPlusPlus, 1 to 100
  float initial_std_m = 0.2f;         ///< [m] of every component at the start, > 0
  float covariance_floor_m2 = 1e-3f;  ///< [m^2] added to both variances, > 0
  float background_density_per_m2 =
      0.01f;                ///< [1/m^2] uniform component for what belongs to no peak, >= 0; 0: none (paper)
  int max_iterations = 15;  ///< [1] 1 to 1000; what takes longer is one peak shared by two components
  float tolerance_m = 1e-3f;  ///< [m] stop when no mean moved further, >= 0
};

/// nullptr, or the name of the first member with an impossible value.
const char* invalid_field(const MixtureConfig& config);

/// Where a peak may be.
struct MixtureSeed {
  float x_m;
  float y_m;
  float mass;  ///< [1] any scale; a seed without mass is not used
};

/// One Gaussian over positions, and the mean velocity of the particles that belong to it.
struct MixtureComponent {
  float x_m, y_m;
  float vx_mps, vy_mps;
  float covariance_xx_m2, covariance_xy_m2, covariance_yy_m2;
  float share;  ///< [1] of the particles' weight
};

struct Mixture {
  BoundedVector<MixtureComponent, kMaxTargets> components;  ///< in the order of their seeds
  float background = 0.0f;                                  ///< [1] share of the uniform component
};

/// Peaks of a particle density: Gaussian mixture by expectation-maximisation (Dempster, Laird & Rubin 1977)
/// on weighted positions. The uniform component keeps stray particles (a missed target's, clutter's) from
/// pulling a peak across the room. Work: particles * components * iterations. Reference:
/// python/echofuse/reference/estimation/mixture_em.py
class MixtureFitter {
 public:
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const MixtureConfig& config);

  /// particles: weights >= 0. n_components: 0 to kMaxTargets. random: one uniform number a drawn centre.
  /// kInvalidInput: no weight, or too many components; mixture is empty.
  Status process(Span<const Particle> particles, Span<const MixtureSeed> seeds, std::size_t n_components,
                 Pcg32& random, Mixture& mixture) const;

  /// [1] weighted mean of the log density [1/m^2] of the particles under the mixture.
  float log_likelihood(Span<const Particle> particles, const Mixture& mixture) const;

 private:
  void take_best_seeds(Span<const MixtureSeed> seeds, std::size_t n, Mixture& mixture) const;
  void fill_by_draws(Span<const Particle> particles, std::size_t n, Pcg32& random, Mixture& mixture) const;
  void iterate(Span<const Particle> particles, float total, Mixture& mixture) const;
  float step(Span<const Particle> particles, float total, Mixture& mixture) const;

  MixtureConfig config_{};
  bool configured_ = false;
};

}  // namespace echofuse::estimation
