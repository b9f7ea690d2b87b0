#pragma once

#include <cstdint>

#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::node {

enum class ClutterSpread : std::uint8_t {
  kStandardDeviation,  ///< about the slow mean
  kRms,                ///< about 0, as in the published code of the paper's chain
};

struct GaussianCfarConfig {
  float fast_factor = 0.3f;   ///< weight of a sample in the fast mean, in (0, 1]
  float slow_factor = 0.01f;  ///< in the slow mean and spread, in (0, 1]
  float deviations = 0.7f;    ///< of the slow spread by which the fast mean must exceed the slow one, > 0
  ClutterSpread spread = ClutterSpread::kStandardDeviation;
  int starting_samples = 200;  ///< [sample] over which the slow statistics run in before the first, >= 1
};

const char* invalid_field(const GaussianCfarConfig& config);

/// CFAR for Gaussian clutter (Dutta, Arora & Bibyk 2006; through-wall paper, Sec. 2), along the fast time of one response:
/// with a = |x|, X the fast and Y the slow exponential mean of a, S the slow spread, hit where X > Y + deviations S. The first
/// samples are not judged.
/// Reference: python/echofuse/reference/node/scan/gaussian_cfar.py
class GaussianCfarDetector {
 public:
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const GaussianCfarConfig& config);

  /// samples and decisions: (n_samples,) of one length; decisions 0 or 1.
  Status process(Span<const float> samples, Span<std::uint8_t> decisions) const;

  /// [sample] by which the fast mean comes late
  float delay_samples() const { return (1.0f - config_.fast_factor) / config_.fast_factor; }

 private:
  struct Statistics {
    float fast = 0.0f;
    float mean = 0.0f;
    float square = 0.0f;
  };

  void advance(float amplitude, Statistics& statistics) const;

  bool configured_ = false;
  GaussianCfarConfig config_;
};

}  // namespace echofuse::node
