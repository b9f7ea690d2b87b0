#include "echofuse/hub/registers.hpp"

#include <cstddef>
#include <tuple>
#include <utility>

#include "echofuse/hub/hub.hpp"
#include "echofuse/hub/through_wall.hpp"
#include "echofuse/hub/through_wall_3d.hpp"

namespace echofuse::hub {
namespace {

template <class Config>
using Node = typename decltype(Config::nodes)::value_type;

/// A member of a node, in each of a configuration's nodes.
template <class Config>
constexpr link::RegisterField of_each_node(link::RegisterField field) {
  field.offset = static_cast<std::uint16_t>(field.offset + offsetof(Config, nodes));
  field.repeat = static_cast<std::uint8_t>(std::tuple_size_v<decltype(Config::nodes)>);
  field.stride = sizeof(Node<Config>);
  return field;
}

// What stands in more than one table.
#define NODE_FIELD(Config, member) \
  of_each_node<Config>(ECHOFUSE_REGISTER_AS(Node<Config>, member, "nodes.#." #member))
#define SITE_FIELDS(Config)                                                                           \
  FIELD(n_nodes), FIELD(area.min_x_m), FIELD(area.min_y_m), FIELD(area.max_x_m), FIELD(area.max_y_m), \
      NODE_FIELD(Config, node_id), NODE_FIELD(Config, tx.x_m), NODE_FIELD(Config, tx.y_m),            \
      NODE_FIELD(Config, rx.x_m), NODE_FIELD(Config, rx.y_m)
#define FRAME_FIELDS                                                                                   \
  FIELD(frame_period_s), FIELD(frame_assembler.deadline_us), FIELD(frame_assembler.dead_after_frames), \
      FIELD(frame_assembler.resync_after_reports), FIELD(frame_assembler.max_delay_s)
#define TRACE_PAIRING_FIELDS                                                                  \
  FIELD(trace_pairing.rule), FIELD(trace_pairing.closing), FIELD(trace_pairing.separation_m), \
      FIELD(trace_pairing.clock_hz), FIELD(trace_pairing.correction_samples),                 \
      FIELD(trace_pairing.completion_limit)
#define PATH_TRACKER_FIELDS                                                                                 \
  FIELD(path_tracker.acceleration_density_m2ps3), FIELD(path_tracker.velocity_std_mps),                     \
      FIELD(path_tracker.path_std_m), FIELD(path_tracker.common_path_std_m), FIELD(path_tracker.gate),      \
      FIELD(path_tracker.missing_cost), FIELD(path_tracker.lone_gate), FIELD(path_tracker.lone_limit),      \
      FIELD(path_tracker.cut_off), FIELD(path_tracker.confirm_updates), FIELD(path_tracker.confirm_window), \
      FIELD(path_tracker.silent_time_s), FIELD(path_tracker.silent_velocity_time_s),                        \
      FIELD(path_tracker.birth_exclusion_m), FIELD(path_tracker.merge_distance_m),                          \
      FIELD(path_tracker.merge_speed_mps), FIELD(path_tracker.max_tracks),                                  \
      FIELD(path_tracker.turn_density_m2ps3), FIELD(path_tracker.turn_begin_probability),  \
      FIELD(path_tracker.turn_end_probability), FIELD(path_tracker.path_std_growth), FIELD(path_tracker.body_half_height_m)
#define TRACK_FIELDS                                                                                   \
  FIELD(tracks.association), FIELD(tracks.update), FIELD(tracks.gate_m), FIELD(tracks.cost_max_m),     \
      FIELD(tracks.gate_sigma), FIELD(tracks.silent_gate_growth_mps), FIELD(tracks.silent_gate_max_m), \
      FIELD(tracks.birth_exclusion_m), FIELD(tracks.confirm_updates), FIELD(tracks.silent_time_min_s), \
      FIELD(tracks.silent_time_per_confirmed), FIELD(tracks.silent_time_max_s),                        \
      FIELD(tracks.silent_velocity_time_s), FIELD(tracks.acceleration_density_m2ps3),                  \
      FIELD(tracks.measurement_std_m), FIELD(tracks.velocity_std_mps)

#define FIELD(member) ECHOFUSE_REGISTER(SensorRadarHubConfig, member)

constexpr link::RegisterField kSensorRadarFields[] = {
    SITE_FIELDS(SensorRadarHubConfig),
    FRAME_FIELDS,
    FIELD(aid_missed_frames),
    FIELD(tracker),
    FIELD(ellipse.refinement),
    FIELD(ellipse.max_iterations),
    FIELD(ellipse.max_step_m),
    FIELD(ellipse.body_radius_m),
    FIELD(ellipse.robust_scale_m),
    FIELD(selection.method),
    FIELD(selection.residual),
    FIELD(selection.nodes_per_tuple),
    FIELD(selection.min_weight),
    FIELD(selection.max_range_residual_m),
    FIELD(selection.max_equation_residual_m3),
    FIELD(selection.coarse_residual_m),
    FIELD(selection.support_gate_m),
    FIELD(selection.min_support),
    FIELD(selection.min_support_fraction),
    FIELD(selection.min_own_support),
    FIELD(selection.echo_tail_m),
    FIELD(selection.track_aided),
    FIELD(selection.track_gate_m),
    FIELD(selection.track_min_support),
    FIELD(selection.track_min_own_support),
    FIELD(point_clusters.distance),
    FIELD(point_clusters.threshold_m),
    FIELD(phd.detection_probability),
    FIELD(phd.survival_probability),
    FIELD(phd.clutter_per_frame),
    FIELD(phd.birth_per_frame),
    FIELD(phd.area_m2),
    FIELD(phd.measurement_std_m),
    FIELD(phd.acceleration_density_m2ps3),
    FIELD(phd.newborn_velocity_std_mps),
    FIELD(phd.particles_per_target),
    FIELD(phd.newborn_per_measurement),
    FIELD(phd.mass_average_frames),
    FIELD(phd.resampling),
    FIELD(phd.seed),
    FIELD(em.initialisation),
    FIELD(em.restarts),
    FIELD(em.initial_std_m),
    FIELD(em.covariance_floor_m2),
    FIELD(em.background_density_per_m2),
    FIELD(em.max_iterations),
    FIELD(em.tolerance_m),
    TRACK_FIELDS,
    FIELD(ranges.detection_probability),
    FIELD(ranges.far_detection_probability),
    FIELD(ranges.shadowed_detection_probability),
    FIELD(ranges.far_shadowed_detection_probability),
    FIELD(ranges.shadow_radius_m),
    FIELD(ranges.penumbra_m),
    FIELD(ranges.path_scale_m),
    FIELD(ranges.path_std_m),
    FIELD(ranges.visible_path_m),
    FIELD(ranges.nearest_path_m),
    FIELD(ranges.shared_path_m),
    FIELD(ranges.shared_score),
    FIELD(ranges.gate_m),
    FIELD(ranges.clutter_ahead_per_m),
    FIELD(ranges.clutter_near_per_m),
    FIELD(ranges.clutter_far_per_m),
    FIELD(ranges.far_m),
    FIELD(ranges.ahead_m),
    FIELD(ranges.window_frames),
    FIELD(ranges.newcomer_cost),
    FIELD(ranges.lasting_score),
    FIELD(ranges.identity_score),
    FIELD(ranges.confirm_frames),
    FIELD(ranges.silent_nodes),
    FIELD(ranges.acceleration_density_m2ps3),
    FIELD(ranges.newborn_position_std_m),
    FIELD(ranges.newborn_velocity_std_mps),
    FIELD(ranges.max_speed_mps),
    FIELD(ranges.candidate_detection_probability),
    FIELD(ranges.candidate_clutter_per_m),
    FIELD(ranges.candidate_memory),
    FIELD(ranges.drop_score),
    FIELD(ranges.merge_distance_m),
    FIELD(ranges.birth_step_m),
    FIELD(ranges.birth_score),
    FIELD(ranges.max_births),
    FIELD(ranges.birth_exclusion_m),
};

#undef FIELD
#define FIELD(member) ECHOFUSE_REGISTER(ThroughWallHubConfig, member)

constexpr link::RegisterField kThroughWallFields[] = {
    SITE_FIELDS(ThroughWallHubConfig),
    FRAME_FIELDS,
    FIELD(body_radius_m),
    FIELD(track_aided),
    TRACE_PAIRING_FIELDS,
    FIELD(line_locator.wall.thickness_m),
    FIELD(line_locator.wall.relative_permittivity),
    FIELD(line_locator.wall.compensation),
    FIELD(line_locator.path_std_m),
    PATH_TRACKER_FIELDS,
    TRACK_FIELDS,
};

#undef FIELD
#define FIELD(member) ECHOFUSE_REGISTER(ThroughWall3dHubConfig, member)

constexpr link::RegisterField kThroughWall3dFields[] = {
    SITE_FIELDS(ThroughWall3dHubConfig),
    FIELD(area.min_z_m),
    FIELD(area.max_z_m),
    NODE_FIELD(ThroughWall3dHubConfig, tx.z_m),
    NODE_FIELD(ThroughWall3dHubConfig, rx.z_m),
    FRAME_FIELDS,
    FIELD(body_radius_m),
    FIELD(track_aided),
    TRACE_PAIRING_FIELDS,
    FIELD(range_difference_m),
    FIELD(taylor_3d.wall.thickness_m),
    FIELD(taylor_3d.wall.relative_permittivity),
    FIELD(taylor_3d.wall.compensation),
    FIELD(taylor_3d.start),
    FIELD(taylor_3d.range_kind),
    FIELD(taylor_3d.min_step_m),
    FIELD(taylor_3d.max_iterations),
    FIELD(path_std_m),
    PATH_TRACKER_FIELDS,
    TRACK_FIELDS,
};

#undef FIELD
#undef TRACK_FIELDS
#undef PATH_TRACKER_FIELDS
#undef TRACE_PAIRING_FIELDS
#undef FRAME_FIELDS
#undef SITE_FIELDS
#undef NODE_FIELD

}  // namespace

Span<const link::RegisterField> config_registers() { return kSensorRadarFields; }

Span<const link::RegisterField> through_wall_registers() { return kThroughWallFields; }

Span<const link::RegisterField> through_wall_3d_registers() { return kThroughWall3dFields; }

}  // namespace echofuse::hub
