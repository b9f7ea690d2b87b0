#pragma once

#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::node {

struct NoiseFloorConfig {
  float factor = 0.0f;             ///< least amplitude of a detection over the floor, >= 0; 0: no such limit
  int block_samples = 24;          ///< [sample] the quietest block of this length tells the floor, >= 1
  float averaging_factor = 0.98f;  ///< weight of the past in the average over scans, in (0, 1)
};

const char* invalid_field(const NoiseFloorConfig& config);

/// Keeps an empty scan silent: a CFAR threshold follows whatever is there, noise included, and so always
/// finds something that stands out. The floor is the rms of each scan's quietest block, averaged over scans
/// (first as a plain mean); thresholds under (factor * floor)^2 are raised to it. Reference:
/// python/echofuse/reference/node/scan/noise_floor.py
class NoiseFloor {
 public:
  Status configure(const NoiseFloorConfig& config);

  void reset();

  /// amplitude: (n_samples,) [count], at least one block long; threshold: (n_samples,) [count^2], raised.
  Status process(Span<const float> amplitude, Span<float> threshold);

  /// [count] rms; 0 before the first scan.
  float floor() const { return floor_; }

 private:
  bool configured_ = false;
  NoiseFloorConfig config_;
  int n_averaged_ = 0;
  float floor_ = 0.0f;
};

}  // namespace echofuse::node
