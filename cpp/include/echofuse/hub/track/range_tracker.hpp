#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/core/tap.hpp"
#include "echofuse/estimation/kalman.hpp"
#include "echofuse/hub/locate/site.hpp"
#include "echofuse/hub/measure/frame.hpp"
#include "echofuse/link/messages.hpp"

namespace echofuse::hub {

/// Scores are sums of natural logarithms of likelihood ratios: a person is there, or clutter alone is.
struct RangeTrackerConfig {
  float detection_probability = 0.65f;  ///< [1] of a person by a node, per scan, in (0, 1)
  float path_std_m = 0.15f;             ///< [m] of a detection's path, > 0
  // Other detections of a node, per metre of path, by their distance behind another detection; > 0.
  float clutter_ahead_per_m = 0.1f;  ///< [1/m] behind none, or further than 8 m: hardly anything
  float clutter_body_per_m = 0.2f;   ///< [1/m] up to 1 m: the rest of the same body
  float clutter_echo_per_m = 0.14f;  ///< [1/m] up to 2.5 m: by way of floor and walls
  float clutter_far_per_m = 0.15f;   ///< [1/m] up to 8 m
  float blind_path_m = 0.3f;         ///< [m] this near behind the direct path a miss says nothing, >= 0
  float gate_m = 0.4f;               ///< [m] of path: narrowest gate of a track, > 0
  float gate_max_m = 0.7f;           ///< [m] widest gate, three deviations before, >= gate_m
  float echo_tail_m = 0.3f;          ///< [m] paths this far behind a confirmed track are his too, >= 0
  float acceleration_density_m2ps3 = 0.05f;  ///< [m^2/s^3] velocity variance gained per second, >= 0
  float newborn_position_std_m = 0.2f;       ///< [m] per coordinate, > 0
  float newborn_velocity_std_mps = 1.2f;     ///< [m/s] per coordinate, > 0
  float max_speed_mps = 2.5f;                ///< [m/s] an unconfirmed track that is faster dies, > 0
  float birth_step_m = 0.2f;       ///< [m] grid on which tracks begin; coarser if it has too many points, > 0
  float birth_score = 0.0f;        ///< [1] a track begins at a maximum above this
  int max_births = 10;             ///< [1] per frame, >= 0
  float birth_exclusion_m = 0.8f;  ///< [m] and not nearer to another track, >= 0
  float merge_distance_m = 0.6f;   ///< [m] an unconfirmed track dies this near to a better one, >= 0
  float unconfirmed_memory = 0.8f;  ///< [1] what is left of a score after a frame, in [0, 1]
  float confirmed_memory = 0.96f;   ///< [1] the same of a confirmed track
  float confirm_score = 20.0f;      ///< [1] least score of a track that is confirmed
  int confirm_frames = 7;           ///< [1] and least age, >= 1
  int confirm_nodes = 3;            ///< [1] and nodes with a detection of its own, >= 1
  float confirmed_bonus = 3.0f;     ///< [1] lead of confirmed tracks when detections are claimed, >= 0
  float shared_score = -0.4f;       ///< [1] of a node whose detection there is another track's, <= 0
  float max_score = 60.0f;          ///< [1] >= confirm_score
  float drop_score = 1.0f;          ///< [1] an unconfirmed track below this dies
  float end_score = 4.0f;           ///< [1] a confirmed track below this dies, < confirm_score
  int silent_nodes = 3;  ///< [1] nodes with a detection of its own, fewer: the track is silent, >= 1
};

/// nullptr, or the name of the first member with an impossible value.
const char* invalid_field(const RangeTrackerConfig& config);

/// Tracks people by the nodes' paths themselves: no position has to be found within one frame.
///
/// Where several people cross, the paths of one frame intersect in more places than there are people, and
/// the wrong ones often fit better. They do not move like people, though. So a track begins at each good
/// place, without claiming anything; an extended Kalman filter follows it through the paths of all nodes, and
/// its score sums the logarithm of how much likelier each node's nearest detection is with a person than
/// without. In the order of their scores, confirmed tracks claim what they explain, and those behind see
/// only the rest. Reference: python/echofuse/reference/hub/track/range_tracker.py
class RangeTracker {
 public:
  /// Also resets. kInvalidConfig: the earlier configuration and state stay in force.
  Status configure(const RangeTrackerConfig& config, float body_radius_m, Span<const NodeSite> nodes,
                   const Area& area);
  void reset();

  /// detections: by ascending node, then path. dt_s: [s] > 0 since the last frame. Shows the tap kTracks.
  /// tracks.tracks: all that live, ascending id; its time and frame stay the caller's.
  /// kTruncated: a track could not begin for lack of room; what is there is valid.
  /// kInvalidInput: detections out of order, not finite or too many, or dt_s not positive; nothing changes.
  Status process(Span<const FrameDetection> detections, float dt_s, link::Tracks& tracks);

  void set_tap_sink(const TapSink& sink) { sink_ = sink; }
  std::uint32_t dropped_births() const { return dropped_births_; }  ///< tracks for which there was no room

 private:
  static constexpr std::size_t kMaxCells = 2048;  ///< of the birth grid: 82 m^2 by 0.2 m

  struct RangeTrack {
    std::int32_t id = 0;
    int age = 1;  ///< frames
    bool confirmed = false;
    float score = 0.0f;
    int n_own = 0;  ///< nodes with a detection of its own in this frame
    std::int32_t frames_since_update = 0;
    estimation::ConstantVelocityFilter filter;
  };
  struct Cell {
    float score;
    int index;
  };

  bool index_frame(Span<const FrameDetection> detections);
  void rate_clutter();
  float clutter_per_m(float behind_m) const;
  int nearest(std::size_t node, float path_m, bool free_only, float gate_m) const;
  float hit_score(int detection, float error_m, float std_m) const;
  float follow(RangeTrack& track, bool may_share) const;
  bool lives(const RangeTrack& track) const;
  bool crowded(const RangeTrack& track) const;
  void claim(const RangeTrack& track);
  void advance(float dt_s);
  bool begin_tracks();
  float cell_score(const Point& place) const;
  bool begin_at(const Point& place);
  void report(link::Tracks& tracks) const;

  bool configured_ = false;
  RangeTrackerConfig config_;
  float body_radius_m_ = 0.0f;
  float miss_score_ = 0.0f;
  std::size_t n_nodes_ = 0;
  std::array<NodeSite, kMaxNodes> nodes_;
  std::array<float, kMaxNodes> blind_until_m_{};  ///< [m] path up to which a miss says nothing
  Area area_;
  float step_m_ = 0.0f;
  int columns_ = 0;
  int rows_ = 0;
  std::int32_t next_id_ = 1;
  std::uint32_t dropped_births_ = 0;
  TapSink sink_;

  // of the frame in work
  Span<const FrameDetection> detections_;
  std::array<std::uint16_t, kMaxNodes + 1> first_{};        ///< where each node's detections begin
  std::array<float, kMaxFrameDetections> clutter_score_{};  ///< log of pD / (sqrt(2 pi) clutter density)
  std::array<bool, kMaxFrameDetections> claimed_{};
  std::array<float, kMaxCells> cells_{};          ///< (columns, rows) scores
  BoundedVector<RangeTrack, kMaxTracks> tracks_;  ///< best first
};

}  // namespace echofuse::hub
