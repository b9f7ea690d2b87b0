#pragma once

#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/node/scan/target_traces.hpp"

namespace echofuse::node {

enum class EdgeRule : std::uint8_t {
  kFraction,  ///< where the envelope first exceeds a fraction of its largest value
  kContrast,  ///< where the mean envelope behind exceeds that before it the most
};

struct LeadingEdgeConfig {
  EdgeRule rule = EdgeRule::kFraction;
  float fraction = 0.5f;   ///< kFraction: of the largest envelope in the window, in (0, 1)
  int mean_samples = 10;   ///< [sample] kContrast: of either mean, in [1, 1000]
  int before_samples = 4;  ///< [sample] the window begins so long before the trace, in [0, 1000]
  int after_samples = 13;  ///< [sample] and ends so long behind it: a person's depth, in [0, 1000]
};

const char* invalid_field(const LeadingEdgeConfig& config);

/// Where a target's echo begins, to a fraction of a sample: each trace moves to a place in a window about it. By kFraction
/// to where the envelope first exceeds a fraction of the largest value there, a straight line between samples; by kContrast
/// to where its step is largest, a parabola between samples, which limbs before the trunk and noise shift less. A detector's
/// hits say that less well: by half a metre of position from two receivers 0.8 m apart (docs/decisions/0007-leading-edge.md).
/// Reference: python/echofuse/reference/node/scan/leading_edge.py
class LeadingEdge {
 public:
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const LeadingEdgeConfig& config);

  /// envelope: (n_samples,) [count], >= 0. traces: those whose window is outside or holds nothing stay as they are.
  Status process(Span<const float> envelope, BoundedVector<TargetTrace>& traces) const;

 private:
  float edge(Span<const float> envelope, float toa_samples) const;
  float first_above(Span<const float> envelope, int first, float level) const;
  float largest_step(Span<const float> envelope, int first, int last) const;
  float step(Span<const float> envelope, int at) const;

  bool configured_ = false;
  LeadingEdgeConfig config_;
};

}  // namespace echofuse::node
