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
#include "echofuse/hub/measure/trace_pairing.hpp"
#include "echofuse/hub/path_hub.hpp"
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

/// Nothing is dropped uncounted: a couple is a point, or unlocated, or outside_area.
using ThroughWallHubCounters = PathHubCounters;

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
  Status receive(const link::Detections& report, std::int64_t now_us) {
    return paths_.receive(report, now_us);
  }

  /// Works on the oldest frame if it is complete or overdue; call until closed is false.
  /// closed: whether tracks was filled. kTruncated: work was cut and counted, the tracks are valid.
  Status poll(std::int64_t now_us, link::Tracks& tracks, bool& closed);

  void set_tap_sink(const TapSink& sink) { paths_.set_tap_sink(sink); }
  ThroughWallHubCounters counters() const { return paths_.counters(); }

 private:
  Status pair(BoundedVector<TraceCouple>& couples);
  Status locate(const TraceCouple& couple);
  LineFix locate_paths();
  bool use_between(const LineFix& fix);

  PathHub<2> paths_;
  TracePairing trace_pairing_;
  LineLocator line_locator_;
  float path_variance_m2_ = 0.0f;
  std::array<float, kMaxArrayReceivers> rx_x_m_{};  ///< from the transmitter
  std::size_t n_receivers_ = 0;
  std::size_t first_ = 0, last_ = 0;  ///< the receivers farthest apart
};

}  // namespace echofuse::hub
