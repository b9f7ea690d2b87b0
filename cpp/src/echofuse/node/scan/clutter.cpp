#include "echofuse/node/scan/clutter.hpp"

#include <algorithm>
#include <cmath>

#include "echofuse/node/scan/sliding_sum.hpp"

namespace echofuse::node {
namespace {

constexpr std::size_t kMaxShadowWindow = 127;

/// Sum of the last `window` values (odd), weighted by a triangle: it must not jump when a loud one enters.
class TriangleSum {
 public:
  explicit TriangleSum(std::size_t window) : first_((window + 1) / 2), second_((window + 1) / 2) {}
  void push(float value) {
    first_.push(value);
    second_.push(first_.value());
  }
  float value() const { return second_.value(); }

 private:
  SlidingSum<(kMaxShadowWindow + 1) / 2> first_;
  SlidingSum<(kMaxShadowWindow + 1) / 2> second_;
};

}  // namespace

const char* invalid_field(const ClutterConfig& config) {
  if (config.method > ClutterMethod::kFrameDifference) return "method";
  if (!(config.averaging_factor > 0.0f && config.averaging_factor < 1.0f)) return "averaging_factor";
  if (config.learning_scans < 1) return "learning_scans";
  if (config.difference_lag_scans < 1) return "difference_lag_scans";
  const int window = config.shadow_window_samples;
  if (window < 3 || window > static_cast<int>(kMaxShadowWindow) || window % 2 == 0)
    return "shadow_window_samples";
  return nullptr;
}

bool uses_envelope(ClutterMethod method) { return method == ClutterMethod::kEmptyRoomEnvelope; }

Status ClutterFilter::configure(const ClutterConfig& config, int n_samples) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  if (n_samples < 1 || n_samples > static_cast<int>(kMaxSamplesPerScan)) return Status::kInvalidConfig;
  const auto most_scans = static_cast<int>(kMaxClutterMemory) / n_samples;
  if (config.method == ClutterMethod::kFrameDifference && config.difference_lag_scans > most_scans)
    return Status::kInvalidConfig;
  config_ = config;
  n_samples_ = static_cast<std::size_t>(n_samples);
  reset();
  return Status::kOk;
}

void ClutterFilter::reset() {
  n_averaged_ = 0;
  n_empty_room_ = 0;
  oldest_ = 0;
  memory_.fill(0.0f);
}

bool ClutterFilter::ready() const {
  if (n_samples_ == 0) return false;
  if (config_.method == ClutterMethod::kFrameDifference) return n_averaged_ >= config_.difference_lag_scans;
  return n_empty_room_ > 0 || n_averaged_ >= config_.learning_scans;
}

Status ClutterFilter::add_empty_room(Span<const float> samples) {
  if (n_samples_ == 0) return Status::kNotConfigured;
  if (samples.size() != n_samples_) return Status::kInvalidInput;
  if (config_.method == ClutterMethod::kFrameDifference) return Status::kOk;
  if (n_empty_room_ == 0) memory_.fill(0.0f);
  ++n_empty_room_;
  learn(samples, 1.0f / static_cast<float>(n_empty_room_));
  n_averaged_ = std::max(config_.learning_scans, n_empty_room_);
  return Status::kOk;
}

Status ClutterFilter::process(Span<const float> samples, Span<float> residual) {
  if (n_samples_ == 0) return Status::kNotConfigured;
  if (samples.size() != n_samples_ || residual.size() != n_samples_) return Status::kInvalidInput;
  const bool was_ready = ready();
  if (config_.method == ClutterMethod::kFrameDifference) {
    difference(samples, residual, was_ready);
    return Status::kOk;
  }
  const bool follows = config_.method == ClutterMethod::kExponentialAverage;
  const bool learns = follows || !was_ready;
  if (config_.method == ClutterMethod::kEmptyRoomShadowed && was_ready) {
    subtract_shadowed(samples, residual);
    return Status::kOk;
  }
  if (!learns) {
#pragma GCC unroll 8
    for (std::size_t k = 0; k < n_samples_; ++k) residual[k] = samples[k] - memory_[k];
    return Status::kOk;
  }
  const float mean_weight = 1.0f / static_cast<float>(n_averaged_ + 1);
  const float weight = follows ? std::max(1.0f - config_.averaging_factor, mean_weight) : mean_weight;
  n_averaged_ = std::min(n_averaged_ + 1, 1 << 20);
  for (std::size_t k = 0; k < n_samples_; ++k) {
    const float change = samples[k] - memory_[k];
    memory_[k] += weight * change;
    residual[k] = was_ready ? change : 0.0f;
  }
  return Status::kOk;
}

void ClutterFilter::learn(Span<const float> samples, float weight) {
  for (std::size_t k = 0; k < n_samples_; ++k) memory_[k] += weight * (samples[k] - memory_[k]);
}

/// Background at the next less at the previous sample.
float ClutterFilter::slope(std::size_t k) const {
  const float next = k + 1 < n_samples_ ? memory_[k + 1] : 0.0f;
  return next - (k > 0 ? memory_[k - 1] : 0.0f);
}

/// residual = samples - gain * background - turned * slope, both gains those that fit best in the window
/// around the sample, then shrunk until together they weaken the background. samples may be residual.
void ClutterFilter::subtract_shadowed(Span<const float> samples, Span<float> residual) const {
  const auto window = static_cast<std::size_t>(config_.shadow_window_samples);
  TriangleSum background_power(window), slope_power(window), along(window), across(window);
  const std::size_t ahead = window / 2;
  for (std::size_t k = 0; k < n_samples_ + ahead; ++k) {
    const bool inside = k < n_samples_;
    const float sample = inside ? samples[k] : 0.0f;
    const float background = inside ? memory_[k] : 0.0f;
    const float turned = inside ? slope(k) : 0.0f;
    background_power.push(background * background);
    slope_power.push(turned * turned);
    along.push(sample * background);
    across.push(sample * turned);
    if (k < ahead) continue;
    const std::size_t centre = k - ahead;
    residual[centre] = samples[centre];
    if (!(background_power.value() > 0.0f && slope_power.value() > 0.0f)) continue;
    const float gain = along.value() / background_power.value();
    const float turn = across.value() / slope_power.value();
    const float squared = gain * gain + turn * turn * slope_power.value() / background_power.value();
    const float shrink = squared > 1.0f ? 1.0f / std::sqrt(squared) : 1.0f;
    residual[centre] -= shrink * (gain * memory_[centre] + turn * slope(centre));
  }
}

/// memory_ is a ring of difference_lag_scans scans; the new one takes the oldest one's place.
void ClutterFilter::difference(Span<const float> samples, Span<float> residual, bool subtract) {
  float* oldest = memory_.data() + oldest_ * n_samples_;
  for (std::size_t k = 0; k < n_samples_; ++k) {
    const float now = samples[k];
    residual[k] = subtract ? now - oldest[k] : 0.0f;
    oldest[k] = now;
  }
  oldest_ = (oldest_ + 1) % static_cast<std::size_t>(config_.difference_lag_scans);
  n_averaged_ = std::min(n_averaged_ + 1, config_.difference_lag_scans);
}

void rectify(Span<float> samples) {
  for (float& sample : samples) sample = std::max(0.0f, sample);
}

}  // namespace echofuse::node
