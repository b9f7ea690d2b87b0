#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/hub/locate/line_locator.hpp"
#include "echofuse/hub/locate/site.hpp"
#include "echofuse/hub/measure/frame_assembler.hpp"
#include "echofuse/hub/measure/frame_clock.hpp"
#include "echofuse/hub/measure/trace_pairing.hpp"
#include "echofuse/hub/track/kalman_tracker.hpp"
#include "echofuse/hub/track/path_tracker.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

struct ThroughWallHubConfig {
  std::array<NodeSite, kMaxArrayReceivers>
      nodes{};                    ///< the first n_nodes: one transmitter, receivers beside it
  int n_nodes = 0;                ///< in [2, kMaxArrayReceivers]
  Area area;                      ///< the room behind the wall, at greater y than the antennas
  float frame_period_s = 0.074f;  ///< [s] taken for the first frame, and when the clock stands still, > 0
  float body_radius_m = 0.21f;    ///< [m] from where an echo begins to a person's middle, >= 0
  bool track_aided =
      true;  ///< tracks take part in the pairing; false: the paper, pair, locate, then track positions
  FrameAssemblerConfig frame_assembler;
  TracePairingConfig trace_pairing;  ///< its separation is the nodes'
  LineLocatorConfig line_locator;    ///< its wall is everybody's
  PathTrackerConfig path_tracker;    ///< track_aided
  TrackManagerConfig tracks;         ///< not track_aided
};

/// The first impossible field; of a stage that is impossible by itself only the stage's name.
const char* invalid_field(const ThroughWallHubConfig& config);

/// What happened since configure() or reset(). Nothing is dropped uncounted: a couple is a point, or in one of the next two.
struct ThroughWallHubCounters {
  FrameAssemblerCounters reports;
  std::uint32_t couples = 0;
  std::uint32_t unlocated = 0;             ///< their paths meet nowhere
  std::uint32_t outside_area = 0;          ///< or not in the room
  std::uint32_t dropped_points = 0;        ///< frames with more couples than points; some left out
  std::uint32_t dropped_births = 0;        ///< tracks that could not begin
  std::uint32_t dropped_combinations = 0;  ///< searches of a track that were cut short
  std::uint32_t clock_faults = 0;          ///< frames that were not later than the one before
};

/// The hub of the pipeline `through_wall_2d`: the receivers' reports in, tracks out (through-wall paper, Sec. 3). Tracks take
/// what they explain; what is left is paired, located behind the wall, and begins tracks. Paths are lengthened by two body
/// radii, so that positions are people's middles.
/// Reference: python/echofuse/reference/hub/through_wall.py
class ThroughWallHub {
 public:
  /// Forgets tracks and counters. kInvalidConfig: the earlier configuration and state stay in force.
  Status configure(const ThroughWallHubConfig& config);

  void reset();

  /// One receiver's report, at the hub's time. kInvalidInput (counted): malformed, or of a node not of this site.
  Status receive(const link::Detections& report, std::int64_t now_us);

  /// Works on the oldest frame if it is complete or overdue; call until closed is false.
  /// closed: whether tracks was filled. kTruncated: work was cut and counted, the tracks are valid.
  Status poll(std::int64_t now_us, link::Tracks& tracks, bool& closed);

  void set_tap_sink(const TapSink& sink);
  ThroughWallHubCounters counters() const;

 private:
  struct LocatedPoint {
    Point position;  ///< [m] from the transmitter
    int n_paths = 0;
    float weight = 0.0f;  ///< least of its traces'
  };

  static constexpr std::size_t kMaxDetections = kMaxArrayReceivers * kMaxDetectionsPerNode;
  using Delays = BoundedVector<float, kMaxDetectionsPerNode>;

  void free_delays(std::size_t receiver, Delays& delay_s) const;
  Status pair(BoundedVector<TraceCouple>& couples);
  Status locate(const TraceCouple& couple, std::int32_t number);
  LineFix locate_paths();
  bool available(std::size_t detection) const;
  bool use(std::size_t receiver, float path_m, float reach_m, std::int32_t number);
  bool use_between(const LineFix& fix, std::int32_t number);
  Status track(float dt_s, link::Tracks& tracks);
  void show_associated();
  void show_points();

  bool configured_ = false;
  ThroughWallHubConfig config_;
  ThroughWallHubCounters counted_;
  TapSink taps_;
  FrameAssembler frame_assembler_;
  FrameClock clock_;
  TracePairing trace_pairing_;
  LineLocator line_locator_;
  PathTracker<2> path_tracker_;
  KalmanTracker<2> kalman_tracker_;
  Point tx_;                                        ///< origin of the stages
  std::array<float, kMaxArrayReceivers> rx_x_m_{};  ///< from there
  std::size_t first_ = 0, last_ = 0;                ///< the receivers farthest apart

  Frame frame_;
  std::array<std::int32_t, kMaxFrameDetections> associated_{};  ///< as the tap
  std::array<float, kMaxArrayReceivers> path_m_{}, weight_{};   ///< of the couple being located
  float least_weight_ = 0.0f;
  BoundedVector<LocatedPoint, kMaxPointsPerFrame> points_;
  std::array<float, 3 * kMaxDetections> tap_rows_{};  ///< where a tap is prepared: too much for a stack
};

}  // namespace echofuse::hub
