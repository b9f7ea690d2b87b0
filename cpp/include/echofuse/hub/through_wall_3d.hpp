#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/hub/locate/site_3d.hpp"
#include "echofuse/hub/locate/taylor_3d.hpp"
#include "echofuse/hub/measure/trace_pairing.hpp"
#include "echofuse/hub/path_hub.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

struct ThroughWall3dHubConfig {
  std::array<NodeSite3d, 4>
      nodes{};  ///< receivers at -d and d along x, then at -d and d up; one transmitter midway
  int n_nodes = 4;
  Box area;                       ///< the room behind the wall, at greater y than the antennas
  float frame_period_s = 0.074f;  ///< [s] taken for the first frame, and when the clock stands still, > 0
  float body_radius_m = 0.21f;    ///< [m] from where an echo begins to a person's middle, >= 0
  bool track_aided =
      true;  ///< tracks take part in the pairing; false: the paper, pair, locate, then track positions
  FrameAssemblerConfig frame_assembler;
  TracePairingConfig trace_pairing;  ///< of each axis; its separation is the nodes'
  float range_difference_m = 0.3f;  ///< [m] at most, of a target's distance by one axis and by the other, > 0
  Taylor3dConfig taylor_3d;         ///< its wall is everybody's; a start of its own, and bistatic paths
  float path_std_m = 0.06f;         ///< [m] of the paths that locate a target, in [1e-3, 1e3]
  PathTrackerConfig path_tracker;   ///< track_aided
  TrackManagerConfig tracks;        ///< not track_aided
};

/// The first impossible field; of a stage that is impossible by itself only the stage's name.
const char* invalid_field(const ThroughWall3dHubConfig& config);

/// Nothing is dropped uncounted: a quad is a point, or unlocated, or outside_area.
struct ThroughWall3dHubCounters : PathHubCounters {
  std::uint32_t quads = 0;    ///< a couple of one axis and one of the other
  std::uint32_t clipped = 0;  ///< of these, the start was, see Planar3dStatus
};

/// The hub of the pipeline `through_wall_3d`: the reports of a cross of four receivers in, tracks in space out
/// (Taylor-series paper). Tracks take what they explain; what is left is paired on each axis, a couple of one with one of
/// the other when both say the same distance from the transmitter, r = (d1^2 + d2^2 - 2 d^2) / (2 (d1 + d2)) of paths
/// less the wall's delay; and quads are located behind the wall and begin tracks. Paths are lengthened by two body radii,
/// so that positions are people's middles. The cross is taken as perfect, d the mean of its arms.
/// Reference: python/echofuse/reference/hub/through_wall_3d.py
class ThroughWall3dHub {
 public:
  /// Forgets tracks and counters. kInvalidConfig: the earlier configuration and state stay in force.
  Status configure(const ThroughWall3dHubConfig& config);

  void reset();

  /// One receiver's report, at the hub's time. kInvalidInput (counted): malformed, or of a node not of this site.
  Status receive(const link::Detections& report, std::int64_t now_us) {
    return paths_.receive(report, now_us);
  }

  /// Works on the oldest frame if it is complete or overdue; call until closed is false.
  /// closed: whether tracks was filled. kTruncated: work was cut and counted, the tracks are valid.
  Status poll(std::int64_t now_us, link::Tracks& tracks, bool& closed);

  void set_tap_sink(const TapSink& sink) { paths_.set_tap_sink(sink); }
  ThroughWall3dHubCounters counters() const;

 private:
  using Couples = BoundedVector<TraceCouple, kMaxPointsPerFrame>;
  struct Quad {
    std::size_t along = 0, up = 0;  ///< couples
  };

  Status pair();
  float range_m(const TraceCouple& couple) const;
  bool match_all();
  bool match_by_assignment();
  Status locate(const Quad& quad);

  float spacing_m_ = 0.0f;  ///< [m] d
  float range_difference_m_ = 0.0f;
  bool all_pairs_ = false;
  float variance_m2_ = 0.0f;  ///< of a path
  float excess_m_ = 0.0f;     ///< [m] of a path, through the wall and back
  std::uint32_t quads_found_ = 0;
  std::uint32_t clipped_ = 0;
  PathHub<3> paths_;
  TracePairing pairing_along_, pairing_up_;
  Taylor3d taylor_3d_;

  Couples along_, up_;  ///< of the frame
  BoundedVector<Quad, kMaxPointsPerFrame> quads_;
  std::array<float, kMaxPointsPerFrame * kMaxPointsPerFrame>
      difference_m_{};  ///< (along, up) of their distances
};

}  // namespace echofuse::hub
