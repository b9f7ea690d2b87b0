#pragma once

#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::node {

struct TargetTraceConfig {
  int window_samples = 15;          ///< [sample] a person's extent, 1 m of path (W_p), >= 1
  int least_hits = 5;               ///< in the window for a target (T_LIM), 1 to window_samples
  bool density_correction = false;  ///< take off by how much missing hits delay the beginning
};

const char* invalid_field(const TargetTraceConfig& config);

struct TargetTrace {
  float toa_samples = 0.0f;  ///< [sample] of the target's first reflection
  std::int32_t weight = 0;   ///< most hits in a window
};

/// Simple targets for distributed ones, steps 1 to 3 of the TOA association (through-wall paper, Sec. 3.2): where the hits
/// in a window reach least_hits a target begins, least_hits - 1 samples before (the paper's T_LIM is one too many). With hits
/// in a share p of its samples it is found (least_hits - 1) (1 / p - 1) samples late; density_correction takes p from the fullest
/// window.
/// Reference: python/echofuse/reference/node/scan/target_traces.py
class TargetTracer {
 public:
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const TargetTraceConfig& config);

  /// decisions: (n_samples,) 0 or 1. traces: by ascending time. kTruncated: the first that it holds.
  Status process(Span<const std::uint8_t> decisions, BoundedVector<TargetTrace>& traces) const;

 private:
  float beginning(int sample, int weight) const;

  bool configured_ = false;
  TargetTraceConfig config_;
};

}  // namespace echofuse::node
