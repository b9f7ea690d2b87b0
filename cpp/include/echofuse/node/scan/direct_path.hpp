#pragma once

#include <cstdint>

#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::node {

enum class DirectPathSearch : std::uint8_t {
  kSerialBackward,         ///< from the peak back while above the threshold
  kThresholdCrossing,      ///< the first sample above the threshold
  kJumpBackSearchForward,  ///< the first one above it within a window before the peak
};

struct DirectPathConfig {
  DirectPathSearch search = DirectPathSearch::kSerialBackward;
  int noise_samples = 300;                    ///< [sample] before the search window that give the noise, >= 8
  float early_detection_probability = 0.01f;  ///< that noise alone crosses within noise_samples, in (0, 1)
  int window_samples = 60;                    ///< [sample] searched before the peak
};

const char* invalid_field(const DirectPathConfig& config);

struct DirectPath {
  bool found = false;
  float toa_samples = 0.0f;  ///< [sample] of the leading edge; 0 unless found
  float threshold = 0.0f;    ///< [count]
  int peak_sample = 0;
};

/// Time of arrival of the direct path (sensor-radar paper, Sec. IV-C): where the envelope of the strongest
/// arrival crosses sigma sqrt(-2 ln(1 - (1 - P_ed)^(1/N_n))), sigma^2 = half the mean square of the noise
/// before it (Rayleigh). Linear interpolation between the two samples of the crossing.
/// Reference: python/echofuse/reference/node/scan/direct_path.py
class DirectPathSearcher {
 public:
  Status configure(const DirectPathConfig& config);

  /// envelope: (n_samples,) [count]. kOk also when nothing was found: fewer than 8 noise samples before the
  /// window, or no peak above the threshold.
  Status process(Span<const float> envelope, DirectPath& direct_path) const;

  float threshold_factor() const { return threshold_factor_; }

 private:
  /// First sample that counts as the arrival, its predecessor below the threshold unless a limit is reached.
  int arrival(Span<const float> envelope, float threshold, int start, int peak) const;

  DirectPathConfig config_;
  float threshold_factor_ = 0.0f;  ///< threshold over sigma [1]; 0 until configured
};

}  // namespace echofuse::node
