#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/estimation/mixture_em.hpp"
#include "echofuse/hub/locate/ellipse_least_squares.hpp"
#include "echofuse/hub/locate/site.hpp"
#include "echofuse/hub/measure/frame_assembler.hpp"
#include "echofuse/hub/measure/frame_clock.hpp"
#include "echofuse/hub/measure/measurement_selection.hpp"
#include "echofuse/hub/measure/point_clusters.hpp"
#include "echofuse/hub/track/kalman_tracker.hpp"
#include "echofuse/hub/track/phd_tracker.hpp"
#include "echofuse/hub/track/range_tracker.hpp"
#include "echofuse/hub/track/track_manager.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

enum class Tracker : std::uint8_t {
  kPhd,     ///< the paper: particle PHD filter, its peaks, tracks
  kKalman,  ///< a Kalman filter a track and global nearest neighbour
  kRange,   ///< tracks from the nodes' paths (docs/decisions/0004-several-people.md); points are only shown
};

struct SensorRadarHubConfig {
  std::array<NodeSite, kMaxNodes> nodes{};  ///< the first n_nodes
  int n_nodes = 0;                          ///< in [3, kMaxNodes]
  Area area;                                ///< where people are looked for
  float frame_period_s = 0.1f;  ///< [s] taken for the first frame, and when the clock stands still, > 0
  int aid_missed_frames = 3;    ///< tracks silent for more frames do not help the selection, >= 0
  Tracker tracker = Tracker::kPhd;
  FrameAssemblerConfig frame_assembler;
  EllipseConfig ellipse;
  SelectionConfig selection;
  PointClusterConfig point_clusters;
  PhdConfig phd;
  estimation::MixtureConfig em;
  TrackManagerConfig tracks;
  RangeTrackerConfig ranges;
};

/// The first impossible field; of a stage that is impossible by itself only the stage's name.
const char* invalid_field(const SensorRadarHubConfig& config);

/// What happened since configure() or reset(). Nothing is dropped uncounted.
struct SensorRadarHubCounters {
  FrameAssemblerCounters reports;
  SelectionCounters selection;
  std::uint64_t dropped_points = 0;  ///< clusters that the tracker had no room for
  std::uint32_t dropped_births = 0;  ///< tracks that could not begin
  std::uint32_t clock_faults = 0;    ///< frames that were not later than the one before
};

/// The hub of the pipeline `sensor_radar`: the nodes' reports in, tracks out (sensor-radar paper, Sec. V).
/// Reference: python/echofuse/reference/hub/hub.py
class SensorRadarHub {
 public:
  /// Forgets tracks and counters. kInvalidConfig: the earlier configuration and state stay in force.
  Status configure(const SensorRadarHubConfig& config);

  void reset();

  /// One node's report, at the hub's time. kInvalidInput (counted): malformed, or of a node not of this site.
  Status receive(const link::Detections& report, std::int64_t now_us);

  /// Works on the oldest frame if it is complete or overdue; call until closed is false.
  /// closed: whether tracks was filled. kTruncated: work was cut and counted, the tracks are valid.
  Status poll(std::int64_t now_us, link::Tracks& tracks, bool& closed);

  void set_tap_sink(const TapSink& sink);
  SensorRadarHubCounters counters() const;

 private:
  Status track(float dt_s, link::Tracks& tracks);
  void predict_people(float dt_s, BoundedVector<Point>& people) const;
  void tap_selected();
  void tap_points();

  bool configured_ = false;
  SensorRadarHubConfig config_;
  TapSink taps_;
  FrameAssembler frame_assembler_;
  MeasurementSelection selection_;
  PointClusters point_clusters_;
  PhdTracker phd_tracker_;
  KalmanTracker<2> kalman_tracker_;
  RangeTracker range_tracker_;

  Frame frame_;
  BoundedVector<Measurement, kMaxMeasurementsPerFrame> measurements_;
  BoundedVector<PointCluster, kMaxPointsPerFrame> points_;
  BoundedVector<link::Track, kMaxTracks> known_;  ///< tracks after the last frame
  FrameClock clock_;

  /// Where a tap is prepared: too much for a stack.
  std::array<float, std::max({3 * kMaxFrameDetections, 5 * kMaxMeasurementsPerFrame, 4 * kMaxPointsPerFrame})>
      tap_rows_{};
};

}  // namespace echofuse::hub
