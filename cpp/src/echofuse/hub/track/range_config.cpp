#include "echofuse/hub/track/range_config.hpp"

#include "echofuse/core/limits.hpp"

namespace echofuse::hub {
namespace {

constexpr float kMost = 1e3f;
constexpr int kMostFrames = 10000;
constexpr float kLeastLength_m = 1e-3f;
constexpr float kLeastDensity = 1e-6f;

bool within(float value, float least, float most) { return value >= least && value <= most; }
bool probability(float value) { return within(value, 0.01f, 0.99f); }

const char* invalid_model(const RangeTrackerConfig& c) {
  if (!probability(c.detection_probability)) return "detection_probability";
  if (!probability(c.far_detection_probability)) return "far_detection_probability";
  if (!probability(c.shadowed_detection_probability)) return "shadowed_detection_probability";
  if (!probability(c.far_shadowed_detection_probability)) return "far_shadowed_detection_probability";
  if (!within(c.shadow_radius_m, 0.0f, kMost)) return "shadow_radius_m";
  if (!within(c.penumbra_m, c.shadow_radius_m, kMost)) return "penumbra_m";
  if (!within(c.path_scale_m, kLeastLength_m, kMost)) return "path_scale_m";
  if (!within(c.path_std_m, kLeastLength_m, kMost)) return "path_std_m";
  if (!within(c.visible_path_m, -kMost, kMost)) return "visible_path_m";
  if (!within(c.nearest_path_m, c.visible_path_m, kMost)) return "nearest_path_m";
  if (!within(c.shared_path_m, 0.0f, kMost)) return "shared_path_m";
  if (!within(c.shared_score, -kMost, 0.0f)) return "shared_score";
  if (!within(c.gate_m, kLeastLength_m, kMost)) return "gate_m";
  if (!within(c.clutter_ahead_per_m, kLeastDensity, kMost)) return "clutter_ahead_per_m";
  if (!within(c.clutter_near_per_m, kLeastDensity, kMost)) return "clutter_near_per_m";
  if (!within(c.clutter_far_per_m, kLeastDensity, kMost)) return "clutter_far_per_m";
  if (!within(c.far_m, 0.0f, kMost)) return "far_m";
  if (!within(c.ahead_m, 0.0f, kMost)) return "ahead_m";
  return nullptr;
}

const char* invalid_people(const RangeTrackerConfig& c) {
  if (c.window_frames < 1 || c.window_frames > static_cast<int>(kMaxWindowFrames)) return "window_frames";
  if (!within(c.newcomer_cost, 0.0f, kMost)) return "newcomer_cost";
  if (!within(c.lasting_score, 0.0f, kMost)) return "lasting_score";
  if (!within(c.identity_score, 0.0f, kMost)) return "identity_score";
  if (c.confirm_frames < 1 || c.confirm_frames > kMostFrames) return "confirm_frames";
  if (c.silent_nodes < 1 || c.silent_nodes > static_cast<int>(kMaxNodes)) return "silent_nodes";
  return nullptr;
}

const char* invalid_candidates(const RangeTrackerConfig& c) {
  if (!within(c.acceleration_density_m2ps3, 0.0f, kMost)) return "acceleration_density_m2ps3";
  if (!within(c.newborn_position_std_m, kLeastLength_m, kMost)) return "newborn_position_std_m";
  if (!within(c.newborn_velocity_std_mps, kLeastLength_m, kMost)) return "newborn_velocity_std_mps";
  if (!within(c.max_speed_mps, kLeastLength_m, kMost)) return "max_speed_mps";
  if (!probability(c.candidate_detection_probability)) return "candidate_detection_probability";
  if (!within(c.candidate_clutter_per_m, kLeastDensity, kMost)) return "candidate_clutter_per_m";
  if (!within(c.candidate_memory, 0.0f, 1.0f)) return "candidate_memory";
  if (!within(c.drop_score, -kMost, kMost)) return "drop_score";
  if (!within(c.merge_distance_m, 0.0f, kMost)) return "merge_distance_m";
  if (!within(c.birth_step_m, 0.01f, kMost)) return "birth_step_m";
  if (!within(c.birth_score, -kMost, kMost)) return "birth_score";
  if (c.max_births < 0 || c.max_births > static_cast<int>(kMaxTracks)) return "max_births";
  if (!within(c.birth_exclusion_m, 0.0f, kMost)) return "birth_exclusion_m";
  return nullptr;
}

}  // namespace

const char* invalid_field(const RangeTrackerConfig& config) {
  if (const char* field = invalid_model(config); field != nullptr) return field;
  if (const char* field = invalid_people(config); field != nullptr) return field;
  return invalid_candidates(config);
}

}  // namespace echofuse::hub
