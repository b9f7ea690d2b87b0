#pragma once

#include <algorithm>

#include "common.hpp"
#include "echofuse/core/tap.hpp"

namespace echofuse::bindings {

/// A tap's name in Python and its columns; 0 columns: one-dimensional.
struct TapLayout {
  TapId tap;
  const char* name;
  std::size_t columns;
};
inline constexpr TapLayout kTapLayouts[] = {
    {TapId::kScan, "scan", 0},
    {TapId::kEnvelope, "envelope", 0},
    {TapId::kDirectPath, "direct_path", 0},
    {TapId::kAlignment, "alignment", 0},
    {TapId::kAligned, "aligned", 0},
    {TapId::kResidual, "residual", 0},
    {TapId::kThreshold, "threshold", 0},
    {TapId::kDecisions, "decisions", 0},
    {TapId::kRangeClusters, "range_clusters", 4},
    {TapId::kDetections, "detections", 2},
    {TapId::kTimeZero, "time_zero", 0},
    {TapId::kRotated, "rotated", 0},
    {TapId::kSubtracted, "subtracted", 0},
    {TapId::kEnhanced, "enhanced", 0},
    {TapId::kTargetTraces, "target_traces", 2},
    {TapId::kLeadingEdges, "leading_edges", 2},
    {TapId::kFrame, "frame", 3},
    {TapId::kSelected, "selected", 5},
    {TapId::kPoints, "points", 4},
    {TapId::kPredicted, "predicted", 5},
    {TapId::kUpdated, "updated", 5},
    {TapId::kResampled, "resampled", 5},
    {TapId::kPeaks, "peaks", 5},
    {TapId::kTracks, "tracks", 7},
    {TapId::kAssociated, "associated", 0},
    {TapId::kSpatialPoints, "points", 5},
    {TapId::kSpatialTracks, "tracks", 9},
};

/// Copies the taps of one call into a dictionary by name, and takes the sink out again, whatever happens.
template <class Pipeline>
class TapGuard {
 public:
  TapGuard(Pipeline& pipeline, py::dict& taps) : pipeline_(pipeline) {
    pipeline_.set_tap_sink({&record, &taps});
  }
  TapGuard(const TapGuard&) = delete;
  TapGuard& operator=(const TapGuard&) = delete;
  ~TapGuard() { pipeline_.set_tap_sink({}); }

 private:
  static void record(void* context, TapId tap, Span<const float> values) {
    for (const TapLayout& layout : kTapLayouts) {
      if (layout.tap != tap) continue;
      FloatArray array = to_array(values);
      if (layout.columns != 0) array = array.reshape({values.size() / layout.columns, layout.columns});
      (*static_cast<py::dict*>(context))[layout.name] = array;
    }
  }

  Pipeline& pipeline_;
};

}  // namespace echofuse::bindings
