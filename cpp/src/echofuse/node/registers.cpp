#include "echofuse/node/registers.hpp"

#include <cstddef>
#include <utility>

#include "echofuse/node/node.hpp"

namespace echofuse::node {
namespace {

#define FIELD(member) ECHOFUSE_REGISTER(SensorRadarNodeConfig, member)

constexpr link::RegisterField kFields[] = {
    FIELD(n_samples),
    FIELD(sample_rate_hz),
    FIELD(first_sample_s),
    FIELD(baseline_m),
    FIELD(time_zero),
    FIELD(delay_offset_s),
    FIELD(blind_zone_s),
    FIELD(pulse_integrator.pulses_per_scan),
    FIELD(envelope.method),
    FIELD(envelope.hilbert_half_length_samples),
    FIELD(envelope.low_pass_half_length_samples),
    FIELD(envelope.low_pass_cutoff_hz),
    FIELD(direct_path.search),
    FIELD(direct_path.noise_samples),
    FIELD(direct_path.early_detection_probability),
    FIELD(direct_path.window_samples),
    FIELD(alignment.method),
    FIELD(alignment.max_shift_samples),
    FIELD(alignment.window_samples),
    FIELD(alignment.interpolator_half_length_samples),
    FIELD(clutter.method),
    FIELD(clutter.averaging_factor),
    FIELD(clutter.learning_scans),
    FIELD(clutter.difference_lag_scans),
    FIELD(clutter.shadow_window_samples),
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

}  // namespace

Span<const link::RegisterField> config_registers() { return kFields; }

}  // namespace echofuse::node
