#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/eigen.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/hub/locate/site.hpp"
#include "echofuse/hub/locate/wall.hpp"
#include "echofuse/hub/measure/frame_assembler.hpp"
#include "echofuse/hub/measure/frame_clock.hpp"
#include "echofuse/hub/measure/trace_pairing.hpp"
#include "echofuse/hub/track/kalman_tracker.hpp"
#include "echofuse/hub/track/path_tracker.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

/// What happened since configure() or reset(), of every hub behind a wall.
struct PathHubCounters {
  FrameAssemblerCounters reports;
  std::uint32_t couples = 0;
  std::uint32_t unlocated = 0;             ///< targets whose paths meet nowhere
  std::uint32_t outside_area = 0;          ///< or not in the room
  std::uint32_t dropped_points = 0;        ///< frames with more targets than points; some left out
  std::uint32_t dropped_births = 0;        ///< tracks that could not begin
  std::uint32_t dropped_combinations = 0;  ///< searches of a track that were cut short
  std::uint32_t clock_faults = 0;          ///< frames that were not later than the one before
};

/// The room behind the wall.
template <int kDimension>
struct Room {
  using Vector = Eigen::Matrix<float, kDimension, 1>;
  Vector tx_m;
  Vector least_m, most_m;  ///< its corners
  float body_radius_m = 0.0f;

  /// Where people's middles can be, from the transmitter: a body radius from each wall (and at any height).
  Vector inner_least_m() const { return least_m - tx_m + margin_m(); }
  Vector inner_most_m() const { return most_m - tx_m - margin_m(); }
  bool has_room() const {
    return body_radius_m >= 0.0f && (inner_most_m().array() > inner_least_m().array()).all();
  }

 private:
  Vector margin_m() const {
    Vector margin_m = Vector::Constant(body_radius_m);
    if constexpr (kDimension == 3) margin_m(2) = 0.0f;
    return margin_m;
  }
};

/// What the hubs of antennas before a wall have in common, in the plane and in space: the frame, which track or target took
/// each of its detections, points, tracks, and the taps. A frame is open(), then for each target that the hub found
/// begin_target(), take() of what it consists of and keep() where that is; then close().
/// Reference: python/echofuse/reference/hub/path_hub.py
template <int kDimension>
class PathHub {
 public:
  using Vector = typename PathTracker<kDimension>::Vector;                          ///< [m]
  using PositionCovariance = typename PathTracker<kDimension>::PositionCovariance;  ///< [m^2]
  using Delays = BoundedVector<float, kMaxDetectionsPerNode>;                       ///< [s]

  struct Setup {
    Span<const NodeSite> nodes;  ///< of which their ids are read
    Span<const Vector> rx_m;     ///< from the transmitter
    Room<kDimension> room;
    float frame_period_s = 0.0f;
    bool track_aided = true;
    FrameAssemblerConfig frame_assembler;
    TracePairingConfig trace_pairing;
    WallConfig wall;
    PathTrackerConfig path_tracker;
    TrackManagerConfig tracks;
  };

  void configure(const Setup& setup);
  void reset();
  Status receive(const link::Detections& report, std::int64_t now_us);
  void set_tap_sink(const TapSink& sink) { taps_ = sink; }

  /// Opens the oldest frame if it is complete or overdue, and lets tracks take what they explain.
  Status open(std::int64_t now_us, bool& opened);

  /// Of the detections of a receiver that nothing took, ascending.
  void free_delays(std::size_t receiver, Delays& delay_s) const;

  /// The next target of the frame: none of the receivers has a path of it yet.
  void begin_target();

  /// It consists of a couple of two receivers' traces, and of the detections that these are (of a completed couple one is
  /// nobody's).
  void take(const TraceCouple& couple, std::size_t receiver1, std::size_t receiver2);

  /// And of the receiver's available detection that is nearest to a path, if there is one within reach.
  bool use(std::size_t receiver, float path_m, float reach_m);

  /// [m] of the target, and 1 or 0: whether a receiver has one.
  Span<const float> path_m() const { return {path_m_.data(), n_receivers_}; }
  Span<const float> weight() const { return {weight_.data(), n_receivers_}; }

  /// The target is here, from the transmitter: in the room it is a point, and begins a track. kTruncated: no room for that.
  Status keep(const Vector& position_m, const PositionCovariance& covariance_m2);

  /// Shows what became of the frame, and fills tracks.
  Status close(link::Tracks& tracks);

  PathHubCounters counters() const;
  void count_couples(std::size_t n) { counted_.couples += static_cast<std::uint32_t>(n); }
  void count_unlocated() { ++counted_.unlocated; }
  void count_dropped_points() { ++counted_.dropped_points; }

 private:
  struct LocatedPoint {
    Vector position_m;  ///< from the transmitter
    int n_paths = 0;
    float weight = 0.0f;  ///< least of its traces'
  };
  static constexpr std::size_t kMaxDetections = kMaxArrayReceivers * kMaxDetectionsPerNode;

  bool available(std::size_t detection) const;
  void show_associated();
  void show_points();
  Status track(link::Tracks& tracks);

  bool configured_ = false;
  std::size_t n_receivers_ = 0;
  Room<kDimension> room_{};
  float frame_period_s_ = 0.0f;
  float same_trace_m_ = 0.0f;  ///< [m] a couple's path is this detection's
  bool track_aided_ = true;
  bool share_detections_ = false;  ///< a detection may be of many targets

  PathHubCounters counted_;
  TapSink taps_;
  FrameAssembler frame_assembler_;
  FrameClock clock_;
  PathTracker<kDimension> path_tracker_;
  KalmanTracker<kDimension> kalman_tracker_;

  Frame frame_;
  float step_s_ = 0.0f;                                         ///< since the last one
  std::array<std::int32_t, kMaxFrameDetections> associated_{};  ///< as the tap
  std::int32_t target_ = 0;                                     ///< -k: the frame's k-th
  std::array<float, kMaxArrayReceivers> path_m_{}, weight_{};
  float least_weight_ = 0.0f;
  BoundedVector<LocatedPoint, kMaxPointsPerFrame> points_;
  std::array<float, 3 * kMaxDetections> tap_rows_{};  ///< where a tap is prepared: too much for a stack
};

}  // namespace echofuse::hub
