#include "echofuse/node/registers.hpp"

#include <cstddef>
#include <utility>

#include "echofuse/node/node.hpp"
#include "echofuse/node/through_wall.hpp"

namespace echofuse::node {
namespace {

// Stages that stand in more than one table.
#define ENVELOPE_FIELDS                                                \
  FIELD(envelope.method), FIELD(envelope.hilbert_half_length_samples), \
      FIELD(envelope.low_pass_half_length_samples), FIELD(envelope.low_pass_cutoff_hz)
#define CLUTTER_FIELDS                                                                   \
  FIELD(clutter.method), FIELD(clutter.averaging_factor), FIELD(clutter.learning_scans), \
      FIELD(clutter.difference_lag_scans), FIELD(clutter.shadow_window_samples)

#define FIELD(member) ECHOFUSE_REGISTER(SensorRadarNodeConfig, member)

constexpr link::RegisterField kSensorRadarFields[] = {
    FIELD(n_samples),
    FIELD(sample_rate_hz),
    FIELD(first_sample_s),
    FIELD(baseline_m),
    FIELD(time_zero),
    FIELD(delay_offset_s),
    FIELD(blind_zone_s),
    FIELD(pulse_integrator.pulses_per_scan),
    ENVELOPE_FIELDS,
    FIELD(direct_path.search),
    FIELD(direct_path.noise_samples),
    FIELD(direct_path.early_detection_probability),
    FIELD(direct_path.window_samples),
    FIELD(alignment.method),
    FIELD(alignment.max_shift_samples),
    FIELD(alignment.window_samples),
    FIELD(alignment.interpolator_half_length_samples),
    CLUTTER_FIELDS,
    FIELD(cfar.method),
    FIELD(cfar.false_alarm_probability),
    FIELD(cfar.training_cells_per_side),
    FIELD(cfar.guard_cells_per_side),
    FIELD(cfar.ordered_rank_fraction),
    FIELD(cfar.local_factor),
    FIELD(cfar.global_factor),
    FIELD(cfar.buffer_samples),
    FIELD(cfar.max_rises),
    FIELD(cfar.rise_threshold_factor),
    FIELD(noise_floor.factor),
    FIELD(noise_floor.block_samples),
    FIELD(noise_floor.averaging_factor),
    FIELD(range_clusters.merge_distance_s),
    FIELD(range_clusters.min_weight),
    FIELD(range_clusters.representative),
};

#undef FIELD
#define FIELD(member) ECHOFUSE_REGISTER(ThroughWallNodeConfig, member)

constexpr link::RegisterField kThroughWallFields[] = {
    FIELD(n_samples),
    FIELD(kept_samples),
    FIELD(sample_rate_hz),
    FIELD(baseline_m),
    FIELD(delay_offset_s),
    FIELD(blind_zone_s),
    FIELD(max_delay_s),
    FIELD(full_scale_count),
    FIELD(saturated_samples),
    FIELD(time_zero.learning_responses),
    FIELD(time_zero.strong_fraction),
    FIELD(time_zero.least_peak_factor),
    FIELD(time_zero.moved_samples),
    FIELD(time_zero.moved_responses),
    CLUTTER_FIELDS,
    ENVELOPE_FIELDS,
    FIELD(weak_signal.floor_factor),
    FIELD(weak_signal.noise_samples),
    FIELD(weak_signal.averaging_factor),
    FIELD(gaussian_cfar.fast_factor),
    FIELD(gaussian_cfar.slow_factor),
    FIELD(gaussian_cfar.deviations),
    FIELD(gaussian_cfar.spread),
    FIELD(gaussian_cfar.starting_samples),
    FIELD(target_traces.window_samples),
    FIELD(target_traces.least_hits),
    FIELD(target_traces.density_correction),
    FIELD(leading_edge.rule),
    FIELD(leading_edge.fraction),
    FIELD(leading_edge.mean_samples),
    FIELD(leading_edge.before_samples),
    FIELD(leading_edge.after_samples),
};

#undef FIELD
#undef CLUTTER_FIELDS
#undef ENVELOPE_FIELDS

}  // namespace

Span<const link::RegisterField> config_registers() { return kSensorRadarFields; }

Span<const link::RegisterField> through_wall_registers() { return kThroughWallFields; }

}  // namespace echofuse::node
