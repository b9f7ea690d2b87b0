#include "echofuse/node/node.hpp"

#include <algorithm>
#include <cmath>

#include "echofuse/core/constants.hpp"
#include "echofuse/core/magnitude.hpp"
#include "echofuse/node/pipeline.hpp"
#include "echofuse/node/scan/drop_lightest.hpp"

namespace echofuse::node {
namespace {

constexpr float kResembling = 0.9f;  ///< [1] correlation of a scan with the background that it belongs to

/// The stage's first configuration that cannot be, by name.
const char* invalid_stage(const SensorRadarNodeConfig& config) {
  if (invalid_field(config.pulse_integrator) != nullptr) return "pulse_integrator";
  if (invalid_field(config.envelope) != nullptr) return "envelope";
  if (invalid_field(config.direct_path) != nullptr) return "direct_path";
  if (invalid_field(config.alignment) != nullptr) return "alignment";
  if (invalid_field(config.clutter) != nullptr) return "clutter";
  if (invalid_field(config.cfar) != nullptr) return "cfar";
  if (invalid_field(config.noise_floor) != nullptr) return "noise_floor";
  if (invalid_field(config.range_clusters) != nullptr) return "range_clusters";
  return nullptr;
}

/// Stages that are possible by themselves, but not with this scan.
const char* invalid_together(const SensorRadarNodeConfig& config) {
  if (!(config.envelope.low_pass_cutoff_hz < 0.5f * config.sample_rate_hz))
    return "envelope.low_pass_cutoff_hz";
  const auto memory = static_cast<int>(kMaxClutterMemory);
  if (config.clutter.method == ClutterMethod::kFrameDifference &&
      config.clutter.difference_lag_scans > memory / config.n_samples)
    return "clutter.difference_lag_scans";
  if (!within(config.range_clusters.merge_distance_s * config.sample_rate_hz, 0.5f, 65535.0f))
    return "range_clusters.merge_distance_s";
  return nullptr;
}

}  // namespace

const char* invalid_field(const SensorRadarNodeConfig& config) {
  if (config.node_id < 0) return "node_id";
  if (config.n_samples < 2 || config.n_samples > static_cast<int>(kMaxSamplesPerScan)) return "n_samples";
  if (!within(config.sample_rate_hz, 1.0f, 1e12f)) return "sample_rate_hz";
  if (!within(config.first_sample_s, -kMaxDelay_s, kMaxDelay_s)) return "first_sample_s";
  if (!within(config.baseline_m, 0.0f, 1e6f)) return "baseline_m";
  if (config.time_zero != TimeZero::kDirectPath && config.time_zero != TimeZero::kRecorded)
    return "time_zero";
  if (!within(config.delay_offset_s, -kMaxDelay_s, kMaxDelay_s)) return "delay_offset_s";
  if (!within(config.blind_zone_s, 0.0f, kMaxDelay_s)) return "blind_zone_s";
  const char* stage = invalid_stage(config);
  return stage != nullptr ? stage : invalid_together(config);
}

Status SensorRadarNode::configure(const SensorRadarNodeConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  const Status results[] = {pulse_integrator_.configure(config.pulse_integrator),
                            envelope_.configure(config.envelope, config.sample_rate_hz),
                            direct_path_.configure(config.direct_path),
                            aligner_.configure(config.alignment),
                            clutter_.configure(config.clutter, config.n_samples),
                            cfar_.configure(config.cfar),
                            noise_floor_.configure(config.noise_floor),
                            range_clusterer_.configure(config.range_clusters, config.sample_rate_hz)};
  for (const Status result : results)
    ECHOFUSE_CHECK(result == Status::kOk);  // invalid_field has seen them all
  config_ = config;
  configured_ = true;
  counters_ = SensorRadarNodeCounters{};
  frame_ = 0;
  reset();
  return Status::kOk;
}

void SensorRadarNode::reset() {
  pulse_integrator_.reset();
  clutter_.reset();
  noise_floor_.reset();
  n_reference_ = 0;
  n_empty_room_ = 0;
  last_shift_samples_ = 0.0f;
  background_direct_path_ = DirectPath{};
  report_ready_ = false;
  reference_envelope_.fill(0.0f);
}

bool SensorRadarNode::ready() const {
  return clutter_.ready() && (config_.time_zero == TimeZero::kRecorded || background_direct_path_.found);
}

bool SensorRadarNode::usable(Span<const float> scan) const {
  return scan.size() == static_cast<std::size_t>(config_.n_samples) && all_within(scan, kMaxMagnitude);
}

Status SensorRadarNode::set_empty_room(Span<const float> scan) {
  if (!configured_) return Status::kNotConfigured;
  if (!usable(scan)) {
    ++counters_.rejected_scans;
    return Status::kInvalidInput;
  }
  if (n_empty_room_ == 0) reset();
  const Span<float> amplitude = cut(amplitude_);
  const Span<float> work = cut(work_);
  (void)envelope_.process(scan, amplitude);
  const DirectPath direct_path = find_direct_path(amplitude);
  const float shift = align(amplitude, direct_path).shift_samples;
  ++n_empty_room_;
  learn_reference(amplitude, shift);
  const Span<const float> source =
      uses_envelope(config_.clutter.method) ? Span<const float>(amplitude) : scan;
  (void)aligner_.shift(source, shift, work);
  return clutter_.add_empty_room(work);
}

Status SensorRadarNode::process(Span<const float> scan, std::int64_t time_us, link::Detections& out) {
  begin_report(config_.node_id, frame_, time_us, out);
  report_ready_ = false;
  if (!configured_) return Status::kNotConfigured;
  if (!usable(scan)) {
    ++counters_.rejected_scans;
    return Status::kInvalidInput;
  }

  // 1. Coherent mean of the pulses.
  bool complete = false;
  (void)pulse_integrator_.process(scan, complete);
  if (!complete) return Status::kOk;
  const Span<const float> integrated = pulse_integrator_.scan();
  taps_(TapId::kScan, integrated);

  // 2. Envelope, direct path, and the delay against the background.
  const Span<float> amplitude = cut(amplitude_);
  (void)envelope_.process(integrated, amplitude);
  taps_(TapId::kEnvelope, amplitude);
  const DirectPath direct_path = find_direct_path(amplitude);
  tap_direct_path(direct_path);
  if (!direct_path.found && config_.time_zero == TimeZero::kDirectPath) ++counters_.direct_path_missing;
  const signal::Alignment alignment = align(amplitude, direct_path);
  tap_alignment(alignment);
  if (n_empty_room_ == 0 && n_reference_ < config_.clutter.learning_scans)
    learn_reference(amplitude, alignment.shift_samples);

  // 3. What moved: rectified amplitude of the difference from the background.
  const bool reports = ready();
  remove_clutter(integrated, alignment.shift_samples);
  taps_(TapId::kResidual, amplitude);

  // 4. Detector, outside the blind zone, and clusters of its decisions.
  ++counters_.scans;
  if (!reports) ++counters_.learning_scans;
  detect(reports ? usable_range(alignment.shift_samples) : Range{});
  taps_(TapId::kThreshold, cut(work_));
  const Status status = report(out);
  tap_report(taps_, out);
  report_ready_ = true;
  ++frame_;
  return status;
}

DirectPath SensorRadarNode::find_direct_path(Span<const float> envelope) const {
  DirectPath direct_path;
  if (config_.time_zero == TimeZero::kRecorded) return direct_path;
  (void)direct_path_.process(envelope, direct_path);
  return direct_path;
}

/// Shift of the scan against the reference. The direct path gives the coarse one; where it is missing, the
/// last scan's does. A jump further than the search reaches is believed if the whole scan then resembles the
/// background (a clock that stepped), and not if something hides the direct path, so that a wall is taken for
/// it.
signal::Alignment SensorRadarNode::align(Span<const float> envelope, const DirectPath& direct_path) {
  signal::Alignment alignment;
  if (n_reference_ == 0) return alignment;
  const Span<const float> reference = cut(reference_envelope_);
  const int last = static_cast<int>(std::lround(last_shift_samples_));
  int coarse = last;
  if (direct_path.found && background_direct_path_.found)
    coarse = static_cast<int>(std::lround(direct_path.toa_samples - background_direct_path_.toa_samples));
  (void)aligner_.estimate(envelope, reference, coarse, compared_.first, compared_.last, alignment);
  if (std::abs(coarse - last) > config_.alignment.max_shift_samples) {
    ++counters_.alignment_doubts;
    if (alignment.correlation < kResembling)
      (void)aligner_.estimate(envelope, reference, last, compared_.first, compared_.last, alignment);
  }
  last_shift_samples_ = alignment.shift_samples;
  return alignment;
}

/// Running mean of aligned envelopes; the background's direct path is that of the mean.
void SensorRadarNode::learn_reference(Span<const float> envelope, float shift_samples) {
  const Span<float> aligned = cut(work_);
  (void)aligner_.shift(envelope, shift_samples, aligned);
  ++n_reference_;
  const float weight = 1.0f / static_cast<float>(n_reference_);
  for (std::size_t k = 0; k < aligned.size(); ++k)
    reference_envelope_[k] += weight * (aligned[k] - reference_envelope_[k]);
  background_direct_path_ = find_direct_path(cut(reference_envelope_));
  compared_ = compared_range();
}

/// A window that starts an eighth of itself before the strongest arrival, cut to the scan.
SensorRadarNode::Range SensorRadarNode::compared_range() const {
  const auto end = reference_envelope_.begin() + config_.n_samples;
  const auto peak =
      static_cast<int>(std::max_element(reference_envelope_.begin(), end) - reference_envelope_.begin());
  const int length = std::min(config_.alignment.window_samples, config_.n_samples);
  const int first = std::clamp(peak - length / 8, 0, config_.n_samples - length);
  return {first, first + length};
}

/// Leaves the rectified residual in amplitude_, which holds the scan's envelope before.
void SensorRadarNode::remove_clutter(Span<const float> scan, float shift_samples) {
  const Span<float> amplitude = cut(amplitude_);
  const Span<float> aligned = cut(work_);
  const bool on_envelope = uses_envelope(config_.clutter.method);
  (void)aligner_.shift(on_envelope ? Span<const float>(amplitude) : scan, shift_samples, aligned);
  taps_(TapId::kAligned, aligned);
  (void)clutter_.process(aligned, on_envelope ? amplitude : aligned);
  if (on_envelope)
    rectify(amplitude);
  else
    (void)envelope_.process(aligned, amplitude);  // never negative
}

/// What lies behind the blind zone and is not touched by what the alignment shifted in at the ends.
SensorRadarNode::Range SensorRadarNode::usable_range(float shift_samples) const {
  int edge = 0;
  if (config_.alignment.method != signal::AlignmentMethod::kNone) {
    const int shift =
        std::max(config_.alignment.max_shift_samples, static_cast<int>(std::ceil(std::abs(shift_samples))));
    edge = shift + config_.alignment.interpolator_half_length_samples;
    if (!uses_envelope(config_.clutter.method)) edge += envelope_.reach_samples();
  }
  const float blind_delay_s = config_.baseline_m / kSpeedOfLight_mps + config_.blind_zone_s;
  const float blind_samples = (blind_delay_s - delay_s(0.0f)) * config_.sample_rate_hz;
  const auto n_samples = static_cast<float>(config_.n_samples);
  const int blind = static_cast<int>(std::ceil(std::clamp(blind_samples, 0.0f, n_samples)));
  return {std::max(edge, blind), config_.n_samples - edge};
}

/// From amplitude_ to the threshold in work_ and decisions_, both 0 outside the range.
void SensorRadarNode::detect(Range range) {
  const Span<float> threshold = cut(work_);
  std::fill(threshold.begin(), threshold.end(), 0.0f);
  decisions_.fill(0);
  if (range.last == 0) return;  // nothing to be judged yet
  if (range.last - range.first < std::max(cfar_.min_samples(), config_.noise_floor.block_samples)) {
    ++counters_.undetectable_scans;
    return;
  }
  const auto first = static_cast<std::size_t>(range.first);
  const auto count = static_cast<std::size_t>(range.last - range.first);
  const Span<const float> amplitude = cut(amplitude_).subspan(first, count);
  const Span<std::uint8_t> decisions{decisions_.data() + first, count};
  (void)cfar_.process(amplitude, threshold.subspan(first, count), decisions);
  if (config_.noise_floor.factor == 0.0f) return;  // no floor: all stands as decided
  (void)noise_floor_.process(amplitude, threshold.subspan(first, count));
  for (std::size_t k = 0; k < count; ++k)
    if (amplitude[k] * amplitude[k] <= threshold[first + k]) decisions[k] = 0;
}

/// Clusters of the decisions, the heaviest of them as detections.
Status SensorRadarNode::report(link::Detections& out) {
  const Span<const std::uint8_t> decisions{decisions_.data(), static_cast<std::size_t>(config_.n_samples)};
  Status status = range_clusterer_.process(decisions, cut(amplitude_), cut(work_), clusters_);
  if (status == Status::kTruncated) ++counters_.truncated_detections;
  tap_clusters(decisions);
  while (clusters_.size() > out.detections.capacity()) {
    drop_lightest(clusters_);
    ++counters_.truncated_detections;
    status = Status::kTruncated;
  }
  for (const RangeCluster& cluster : clusters_)
    (void)out.detections.try_push_back(
        {delay_s(cluster.position_samples), static_cast<float>(cluster.weight)});
  return status;
}

/// Propagation delay transmitter -> person -> receiver of an echo at a place in the aligned scan.
float SensorRadarNode::delay_s(float position_samples) const {
  if (config_.time_zero == TimeZero::kRecorded)
    return config_.first_sample_s + position_samples / config_.sample_rate_hz + config_.delay_offset_s;
  return (position_samples - background_direct_path_.toa_samples) / config_.sample_rate_hz +
         config_.baseline_m / kSpeedOfLight_mps + config_.delay_offset_s;
}

void SensorRadarNode::tap_direct_path(const DirectPath& direct_path) const {
  if (!taps_.wants(TapId::kDirectPath)) return;
  const float path[] = {direct_path.found ? 1.0f : 0.0f, direct_path.toa_samples, direct_path.threshold};
  taps_(TapId::kDirectPath, path);
}

void SensorRadarNode::tap_alignment(const signal::Alignment& alignment) const {
  if (!taps_.wants(TapId::kAlignment)) return;
  const float shift[] = {alignment.shift_samples, alignment.correlation};
  taps_(TapId::kAlignment, shift);
}

/// Overwrites work_, which nobody needs any more.
void SensorRadarNode::tap_clusters(Span<const std::uint8_t> decisions) {
  if (!taps_.wants(TapId::kRangeClusters)) return;
  const Span<float> values = cut(work_);
  for (std::size_t k = 0; k < decisions.size(); ++k) values[k] = static_cast<float>(decisions[k]);
  taps_(TapId::kDecisions, values);
  std::size_t size = 0;
  for (const RangeCluster& cluster : clusters_) {
    work_[size++] = cluster.position_samples;
    work_[size++] = static_cast<float>(cluster.weight);
    work_[size++] = static_cast<float>(cluster.first_sample);
    work_[size++] = static_cast<float>(cluster.last_sample);
  }
  taps_(TapId::kRangeClusters, {work_.data(), size});
}

}  // namespace echofuse::node
