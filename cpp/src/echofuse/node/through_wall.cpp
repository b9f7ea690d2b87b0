#include "echofuse/node/through_wall.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "echofuse/core/constants.hpp"
#include "echofuse/core/magnitude.hpp"
#include "echofuse/node/pipeline.hpp"
#include "echofuse/node/scan/drop_lightest.hpp"

namespace echofuse::node {
namespace {

constexpr float kSameEcho = 1.0f;  ///< [sample] two traces that begin closer together are one

/// [s] from transmitter to receiver on the shortest way
float cross_talk_delay_s(const ThroughWallNodeConfig& config) {
  return config.baseline_m / kSpeedOfLight_mps;
}

/// [sample] of a turned response that the stages behind time zero see
int kept_samples(const ThroughWallNodeConfig& config) {
  return config.kept_samples > 0 ? std::min(config.kept_samples, config.n_samples) : config.n_samples;
}

/// The stage's first configuration that cannot be, by name.
const char* invalid_stage(const ThroughWallNodeConfig& config) {
  if (invalid_field(config.time_zero) != nullptr) return "time_zero";
  if (invalid_field(config.clutter) != nullptr) return "clutter";
  if (invalid_field(config.envelope) != nullptr) return "envelope";
  if (invalid_field(config.weak_signal) != nullptr) return "weak_signal";
  if (invalid_field(config.gaussian_cfar) != nullptr) return "gaussian_cfar";
  if (invalid_field(config.target_traces) != nullptr) return "target_traces";
  if (invalid_field(config.leading_edge) != nullptr) return "leading_edge";
  return nullptr;
}

/// Fields that are possible by themselves, but not with each other.
const char* invalid_together(const ThroughWallNodeConfig& config) {
  if (!(cross_talk_delay_s(config) * config.sample_rate_hz < static_cast<float>(config.n_samples)))
    return "baseline_m";
  const float first_s = cross_talk_delay_s(config) + config.blind_zone_s;
  if (config.max_delay_s != 0.0f && !(config.max_delay_s > first_s)) return "max_delay_s";
  const int kept = kept_samples(config);
  if (kept > static_cast<int>(kMaxSamplesPerScan)) return "kept_samples";
  if (uses_envelope(config.clutter.method)) return "clutter.method";  // the phase would be lost too early
  const auto memory = static_cast<int>(kMaxClutterMemory);
  if (config.clutter.method == ClutterMethod::kFrameDifference &&
      config.clutter.difference_lag_scans > memory / kept)
    return "clutter.difference_lag_scans";
  if (!(config.envelope.low_pass_cutoff_hz < 0.5f * config.sample_rate_hz))
    return "envelope.low_pass_cutoff_hz";
  if (config.weak_signal.noise_samples > config.n_samples) return "weak_signal.noise_samples";
  const auto judged = static_cast<float>(kept - config.weak_signal.noise_samples);
  if (kept < config.n_samples && !(first_s * config.sample_rate_hz < judged)) return "kept_samples";
  return nullptr;
}

/// By ascending time. Traces that begin within a sample of an earlier one are the same echo: what is left has the
/// earlier beginning and the larger weight.
void sort_and_merge(BoundedVector<TargetTrace>& traces) {
  for (std::size_t end = 1; end < traces.size(); ++end)
    for (std::size_t k = end; k > 0 && traces[k].toa_samples < traces[k - 1].toa_samples; --k)
      std::swap(traces[k], traces[k - 1]);
  std::size_t kept = 0;
  for (const TargetTrace trace : traces) {
    if (kept > 0 && trace.toa_samples - traces[kept - 1].toa_samples < kSameEcho)
      traces[kept - 1].weight = std::max(traces[kept - 1].weight, trace.weight);
    else
      traces[kept++] = trace;
  }
  while (traces.size() > kept) traces.pop_back();
}

}  // namespace

const char* invalid_field(const ThroughWallNodeConfig& config) {
  if (config.node_id < 0) return "node_id";
  if (config.n_samples < 3 || config.n_samples > static_cast<int>(kMaxResponseSamples)) return "n_samples";
  if (config.kept_samples < 0 || config.kept_samples > static_cast<int>(kMaxSamplesPerScan))
    return "kept_samples";
  if (!within(config.sample_rate_hz, 1.0f, 1e12f)) return "sample_rate_hz";
  if (!within(config.baseline_m, 0.0f, 1e6f)) return "baseline_m";
  if (!within(config.delay_offset_s, -kMaxDelay_s, kMaxDelay_s)) return "delay_offset_s";
  if (!within(config.blind_zone_s, 0.0f, kMaxDelay_s)) return "blind_zone_s";
  if (!within(config.max_delay_s, 0.0f, kMaxDelay_s)) return "max_delay_s";
  if (!within(config.full_scale_count, 0.0f, kMaxMagnitude)) return "full_scale_count";
  if (config.saturated_samples < 0) return "saturated_samples";
  const char* stage = invalid_stage(config);
  return stage != nullptr ? stage : invalid_together(config);
}

Status ThroughWallNode::configure(const ThroughWallNodeConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  const float expected_samples = cross_talk_delay_s(config) * config.sample_rate_hz;
  const int kept = kept_samples(config);
  const Status results[] = {time_zero_.configure(config.time_zero, config.n_samples, expected_samples),
                            clutter_.configure(config.clutter, kept),
                            envelope_.configure(config.envelope, config.sample_rate_hz),
                            weak_signal_.configure(config.weak_signal, kept),
                            gaussian_cfar_.configure(config.gaussian_cfar),
                            target_traces_.configure(config.target_traces),
                            leading_edge_.configure(config.leading_edge)};
  for (const Status result : results)
    ECHOFUSE_CHECK(result == Status::kOk);  // invalid_field has seen them all
  config_ = config;
  n_kept_ = static_cast<std::size_t>(kept);
  configured_ = true;
  counters_ = ThroughWallNodeCounters{};
  frame_ = 0;
  reset();
  return Status::kOk;
}

void ThroughWallNode::reset() {
  time_zero_.reset();
  clutter_.reset();
  weak_signal_.reset();
  n_learning_ = 0;
  report_ready_ = false;
}

bool ThroughWallNode::usable(Span<const float> response) const {
  return response.size() == static_cast<std::size_t>(config_.n_samples) &&
         all_within(response, kMaxMagnitude);
}

Status ThroughWallNode::process(Span<const float> response, std::int64_t time_us, link::Detections& out) {
  begin_report(config_.node_id, frame_, time_us, out);
  report_ready_ = false;
  if (!configured_) return Status::kNotConfigured;
  if (!usable(response)) {
    ++counters_.rejected_responses;
    return Status::kInvalidInput;
  }
  ++counters_.responses;
  taps_(TapId::kScan, response);

  // 1. Turned to time zero, and cut; all 0 where that is not known, and from there on.
  const TimeZeroResult time_zero = find_time_zero(response);
  tap_time_zero(time_zero);
  taps_(TapId::kRotated, cut(work_));

  // 2. What moved, and its amplitude.
  const bool judges = subtract_background(time_zero.found);
  taps_(TapId::kSubtracted, cut(work_));
  (void)envelope_.process(cut(work_), cut(amplitude_));
  taps_(TapId::kEnvelope, cut(amplitude_));

  // 3. Weak echoes raised to strong ones, and decisions.
  detect(judges);

  // 4. Traces of people in the decisions, each moved to its echo's leading edge.
  const Span<const std::uint8_t> decisions{decisions_.data(), n_kept_};
  const Status found = target_traces_.process(decisions, traces_);
  tap_traces(TapId::kTargetTraces);
  (void)leading_edge_.process(cut(amplitude_), traces_);
  tap_traces(TapId::kLeadingEdges);

  const Status status = report(time_zero, found, out);
  tap_report(taps_, out);
  report_ready_ = true;
  ++frame_;
  return status;
}

/// False, and counted, for what a dead or saturated receiver gives.
bool ThroughWallNode::trusted(Span<const float> response) {
  if (std::all_of(response.begin(), response.end(), [&](float value) { return value == response[0]; })) {
    ++counters_.dead_responses;
    return false;
  }
  const auto at_full_scale = [&](float value) { return std::abs(value) >= config_.full_scale_count; };
  if (config_.full_scale_count > 0.0f &&
      std::count_if(response.begin(), response.end(), at_full_scale) > config_.saturated_samples) {
    ++counters_.saturated_responses;
    return false;
  }
  return true;
}

/// Leaves what is kept of the turned response in work_.
TimeZeroResult ThroughWallNode::find_time_zero(Span<const float> response) {
  TimeZeroResult time_zero;
  if (!trusted(response)) {
    std::fill(work_.begin(), work_.end(), 0.0f);
    return time_zero;
  }
  (void)time_zero_.process(response, cut(work_), time_zero);
  if (time_zero.moved) {  // this response is the first that is learnt anew
    ++counters_.time_zero_moved;
    clutter_.reset();
    weak_signal_.reset();
    n_learning_ = 0;
  }
  const bool learning = n_learning_ < config_.time_zero.learning_responses;
  if (learning) ++n_learning_;
  if (!time_zero.found) ++(learning ? counters_.settling_responses : counters_.cross_talk_missing);
  return time_zero;
}

/// Turned response in work_ -> what is left without the background; whether that is one to be judged.
bool ThroughWallNode::subtract_background(bool found) {
  if (!found) return false;
  const bool settled = clutter_.ready();
  if (!settled) ++counters_.settling_responses;
  (void)clutter_.process(cut(work_), cut(work_));
  return settled;
}

/// Subtracted response in work_ -> enhanced there, and decisions_.
void ThroughWallNode::detect(bool judges) {
  if (judges) (void)weak_signal_.process(cut(work_));  // what is not judged is 0
  taps_(TapId::kEnhanced, cut(work_));
  (void)gaussian_cfar_.process(cut(work_), {decisions_.data(), n_kept_});
  tap_decisions();
}

/// Traces at their leading edges -> detections, by ascending delay.
Status ThroughWallNode::report(const TimeZeroResult& time_zero, Status status, link::Detections& out) {
  if (status == Status::kTruncated) ++counters_.truncated_detections;
  sort_and_merge(traces_);
  const float first_s = cross_talk_delay_s(config_) + config_.blind_zone_s;
  const float last_s = config_.max_delay_s > 0.0f ? config_.max_delay_s : std::numeric_limits<float>::max();
  for (std::size_t k = traces_.size(); k > 0; --k)
    if (!within(delay_s(traces_[k - 1].toa_samples, time_zero), first_s, last_s)) traces_.erase_at(k - 1);
  while (traces_.size() > out.detections.capacity()) {
    drop_lightest(traces_);
    ++counters_.truncated_detections;
    status = Status::kTruncated;
  }
  for (const TargetTrace& trace : traces_)
    (void)out.detections.try_push_back(
        {delay_s(trace.toa_samples, time_zero), static_cast<float>(trace.weight)});
  return status;
}

/// Propagation delay transmitter -> person -> receiver of an echo in the turned response.
float ThroughWallNode::delay_s(float toa_samples, const TimeZeroResult& time_zero) const {
  const float cross_talk_samples =
      static_cast<float>(time_zero_.expected_samples()) + time_zero.fraction_samples;
  return (toa_samples - cross_talk_samples) / config_.sample_rate_hz + cross_talk_delay_s(config_) +
         config_.delay_offset_s;
}

void ThroughWallNode::tap_time_zero(const TimeZeroResult& time_zero) const {
  if (!taps_.wants(TapId::kTimeZero)) return;
  const float values[] = {time_zero.found ? 1.0f : 0.0f, static_cast<float>(time_zero.rotation_samples),
                          time_zero.fraction_samples};
  taps_(TapId::kTimeZero, values);
}

/// Overwrites work_, which nobody needs any more.
void ThroughWallNode::tap_decisions() {
  if (!taps_.wants(TapId::kDecisions)) return;
  const Span<float> values = cut(work_);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = static_cast<float>(decisions_[k]);
  taps_(TapId::kDecisions, values);
}

void ThroughWallNode::tap_traces(TapId tap) const {
  if (!taps_.wants(tap)) return;
  float rows[2 * kMaxClustersPerScan];
  std::size_t size = 0;
  for (const TargetTrace& trace : traces_) {
    rows[size++] = trace.toa_samples;
    rows[size++] = static_cast<float>(trace.weight);
  }
  taps_(tap, {rows, size});
}

}  // namespace echofuse::node
