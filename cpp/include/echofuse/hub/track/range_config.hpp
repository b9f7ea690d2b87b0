#pragma once

#include <cstddef>

namespace echofuse::hub {

inline constexpr std::size_t kMaxWindowFrames = 16;  ///< that a set of people is judged by: 1.6 s at 10 Hz

/// Settings of the range tracker. Scores are natural logarithms of likelihoods, so they add up.
struct RangeTrackerConfig {
  // What a node detects of a person, per scan; "far": more than far_m of path behind the first person.
  float detection_probability = 0.96f;               ///< [1] in the clear, in (0, 1)
  float far_detection_probability = 0.8f;            ///< [1] in the clear, far
  float shadowed_detection_probability = 0.66f;      ///< [1] with somebody in the way
  float far_shadowed_detection_probability = 0.25f;  ///< [1] with somebody in the way, far
  float shadow_radius_m = 0.3f;  ///< [m] nearer than this to a leg of the path, somebody is in the way, >= 0
  float penumbra_m = 0.7f;       ///< [m] and nearer than this half in the way, >= shadow_radius_m
  float path_scale_m = 0.08f;    ///< [m] mean deviation of a person's detection from the path, > 0
  float path_std_m = 0.12f;      ///< [m] the same as a standard deviation, for the filters, > 0
  float visible_path_m = 0.45f;  ///< [m] nearer behind the direct path nobody is seen: a node's blind zone
  float nearest_path_m = 0.45f;  ///< [m] behind the direct path the nearest detections are, >= visible_path_m
  float shared_path_m = 0.4f;    ///< [m] two people nearer than this in path may be one detection, >= 0
  float shared_score = -0.5f;    ///< [1] of the one without, <= 0
  float gate_m = 0.5f;           ///< [m] of path: a detection further off is not the person's, > 0
  // Other detections, per metre of path, by how far they are behind a person; > 0.
  float clutter_ahead_per_m = 0.01f;  ///< [1/m] behind nobody
  float clutter_near_per_m = 0.55f;   ///< [1/m] up to far_m: the same body, floor, walls
  float clutter_far_per_m = 0.25f;    ///< [1/m] further
  float far_m = 3.5f;                 ///< [m] >= 0
  float ahead_m = 0.3f;               ///< [m] a detection so far ahead of a person is behind him yet, >= 0
  // Who is there: the set of tracks that explains the last frames best.
  int window_frames = 15;       ///< [1] in [1, kMaxWindowFrames]
  float newcomer_cost = 40.0f;  ///< [1] by which one more person has to explain the window better, >= 0
  float lasting_score = 65.0f;  ///< [1] for as many people as before, >= 0
  float identity_score = 5.0f;  ///< [1] for each who was there before, >= 0
  int confirm_frames = 5;       ///< [1] least age of a track that joins, >= 1
  int silent_nodes = 3;         ///< [1] nodes with a detection of its own, fewer: the track is silent, >= 1
  // Motion, and the tracks that are not confirmed.
  float acceleration_density_m2ps3 = 0.05f;       ///< [m^2/s^3] velocity variance gained per second, >= 0
  float newborn_position_std_m = 0.2f;            ///< [m] per coordinate, > 0
  float newborn_velocity_std_mps = 1.2f;          ///< [m/s] per coordinate, > 0
  float max_speed_mps = 2.5f;                     ///< [m/s] a faster one dies, > 0
  float candidate_detection_probability = 0.85f;  ///< [1] in (0, 1)
  float candidate_clutter_per_m = 0.15f;          ///< [1/m] > 0
  float candidate_memory = 0.8f;                  ///< [1] what is left of a score after a frame, in [0, 1]
  float drop_score = 2.0f;                        ///< [1] below it dies
  float merge_distance_m = 0.6f;                  ///< [m] dies this near to a better one, >= 0
  float birth_step_m = 0.2f;       ///< [m] grid on which they begin; coarser if it has too many points, > 0
  float birth_score = 0.5f;        ///< [1] one begins at a maximum above this
  int max_births = 10;             ///< [1] per frame, >= 0
  float birth_exclusion_m = 0.6f;  ///< [m] and not nearer to another track, >= 0
};

/// nullptr, or the name of the first member with an impossible value.
const char* invalid_field(const RangeTrackerConfig& config);

}  // namespace echofuse::hub
