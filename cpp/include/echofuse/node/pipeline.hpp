#pragma once

#include "echofuse/core/span.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/link/messages.hpp"

/// What the pipelines of all nodes share.

namespace echofuse::node {

inline constexpr float kMaxMagnitude =
    1e12f;  ///< [count] of a sample: squares of what filters make of it, and their sums, stay finite
inline constexpr float kMaxDelay_s = 1.0f;  ///< [s] a bound for what is measured in nanoseconds

inline bool within(float value, float low, float high) {
  return value >= low && value <= high;  // false for NaN
}

/// Empties a report and gives it its head.
void begin_report(std::int32_t node_id, std::uint32_t frame, std::int64_t time_us, link::Detections& report);

/// Shows a report as kDetections.
void tap_report(const TapSink& taps, const link::Detections& report);

}  // namespace echofuse::node
