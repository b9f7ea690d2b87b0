#pragma once

#include <cstdint>

#include "echofuse/core/span.hpp"

namespace echofuse {

/// Names of the intermediate arrays that a pipeline shows, in the order of the data flow.
/// The values are part of the recording and of the link: append, never renumber.
enum class TapId : std::uint8_t {
  // node
  kScan = 0,        ///< (n_samples,) integrated scan [count]
  kEnvelope = 1,    ///< (n_samples,) amplitude envelope before alignment [count]
  kDirectPath = 2,  ///< (3,) found [0/1], toa [sample], threshold [count]
  kAlignment = 3,   ///< (2,) shift against the background [sample], correlation [1]
  kAligned = 4,     ///< (n_samples,) what clutter removal works on: aligned envelope, or aligned scan [count]
  kResidual = 5,    ///< (n_samples,) rectified amplitude after clutter removal [count]
  kThreshold = 6,   ///< (n_samples,) detection threshold on the squared residual [count^2]
  kDecisions = 7,   ///< (n_samples,) 0 or 1
  kRangeClusters = 8,  ///< (n_clusters, 4) position [sample], weight, first, last sample
  kDetections = 9,     ///< (n_detections, 2) delay [s], weight
  // node of an M-sequence radar, beside kScan, kEnvelope, kDecisions and kDetections
  kTimeZero = 10,      ///< (3,) found [0/1], rotation [sample], fraction [sample]
  kRotated = 11,       ///< (n_samples,) response turned to time zero [count]
  kSubtracted = 12,    ///< (n_samples,) signed, after background subtraction [count]
  kEnhanced = 13,      ///< (n_samples,) after weak-signal enhancement [1]
  kTargetTraces = 14,  ///< (n_traces, 2) toa [sample], weight, as found in the decisions
  kLeadingEdges = 15,  ///< (n_traces, 2) the same traces at their echoes' leading edges
  // hub
  kFrame = 32,      ///< (n_detections, 3) node index, path length [m], weight
  kSelected = 33,   ///< (n_measurements, 5) x [m], y [m], weight, residual, nodes
  kPoints = 34,     ///< (n_points, 4) x [m], y [m], members, weight after two-dimensional clustering
  kPredicted = 35,  ///< (n_particles, 5) x, vx, y, vy, weight before the update
  kUpdated = 36,    ///< (n_particles, 5) after the update, newborn particles last
  kResampled = 37,  ///< (n_particles, 5)
  kPeaks = 38,      ///< (n_peaks, 5) x, y [m], vx, vy [m/s], mass
  kTracks = 39,     ///< (n_tracks, 7) id, state, x, y [m], vx, vy [m/s], scans since the last update
  kAssociated =
      40,  ///< (n_detections,) of the frame: id of the track that took it, -k of the k-th couple, 0 of neither
  // hub that locates in three dimensions, in place of kPoints and kTracks
  kSpatialPoints = 41,  ///< (n_points, 5) x, y, z [m], members, weight
  kSpatialTracks =
      42,  ///< (n_tracks, 9) id, state, x, y, z [m], vx, vy, vz [m/s], scans since the last update
};

/// Receives one tap: `values` is only valid during the call, and empty for a mark.
using TapFunction = void (*)(void* context, TapId tap, Span<const float> values);

/// A pipeline's way out for taps: all their values; or marks alone, so that the stages that run between them can be
/// timed without the work of showing anything. Without a sink a tap costs one comparison.
class TapSink {
 public:
  TapSink() = default;
  TapSink(TapFunction function, void* context) : function_(function), context_(context), values_(true) {}

  /// A sink that is called at each tap, and gets no values.
  static TapSink marks(TapFunction function, void* context) {
    TapSink sink(function, context);
    sink.values_ = false;
    return sink;
  }

  /// True if the values of `tap` are wanted, so that it is worth while to prepare them; marks it otherwise.
  [[nodiscard]] bool wants(TapId tap) const {
    if (!values_ && function_ != nullptr) function_(context_, tap, {});
    return values_;
  }

  /// For values that are at hand.
  void operator()(TapId tap, Span<const float> values) const {
    if (function_ != nullptr) function_(context_, tap, values_ ? values : Span<const float>());
  }

 private:
  TapFunction function_ = nullptr;
  void* context_ = nullptr;
  bool values_ = false;  ///< and not marks alone
};

}  // namespace echofuse
