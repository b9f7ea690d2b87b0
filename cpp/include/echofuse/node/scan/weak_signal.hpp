#pragma once

#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::node {

struct WeakSignalConfig {
  float floor_factor = 4.0f;       ///< least divisor in deviations of the noise, >= 0
  int noise_samples = 64;          ///< [sample] at the end of a response, where nothing but noise is, >= 1
  float averaging_factor = 0.95f;  ///< weight of the past in the noise, in [0, 1)
};

const char* invalid_field(const WeakSignalConfig& config);

/// Weak-signal enhancement, "advance normalisation" (through-wall paper, Sec. 2): each sample over the largest
/// magnitude from it to the end, so that a far echo is as high as a near one. The divisor has a floor, without which the
/// tail of the response would be raised as well.
/// Reference: python/echofuse/reference/node/scan/weak_signal.py
class WeakSignalEnhancer {
 public:
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const WeakSignalConfig& config, int n_samples);

  void reset();

  /// samples: (n_samples,) [count], in place; then in [-1, 1].
  Status process(Span<float> samples);

  float noise() const { return noise_; }  ///< [count] rms

 private:
  WeakSignalConfig config_;
  int n_samples_ = 0;  ///< 0 until configured
  int n_averaged_ = 0;
  float noise_ = 0.0f;
};

}  // namespace echofuse::node
