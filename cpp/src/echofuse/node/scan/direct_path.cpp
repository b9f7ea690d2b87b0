#include "echofuse/node/scan/direct_path.hpp"

#include <algorithm>
#include <cmath>

#include "echofuse/core/compensated_sum.hpp"
#include "echofuse/core/limits.hpp"

namespace echofuse::node {
namespace {

constexpr int kMinNoiseSamples = 8;  ///< fewer say nothing about the noise

/// Place of the greatest value, the first of equals.
int strongest(Span<const float> values) {
  int place = 0;
  float greatest = values[0];
  const int n_values = static_cast<int>(values.size());
#pragma GCC unroll 8
  for (int k = 1; k < n_values; ++k) {
    const float value = values[static_cast<std::size_t>(k)];
    if (!(value > greatest)) continue;
    greatest = value;
    place = k;
  }
  return place;
}

bool is_search(DirectPathSearch search) {
  return search == DirectPathSearch::kSerialBackward || search == DirectPathSearch::kThresholdCrossing ||
         search == DirectPathSearch::kJumpBackSearchForward;
}

}  // namespace

const char* invalid_field(const DirectPathConfig& config) {
  constexpr int kLongest = static_cast<int>(kMaxSamplesPerScan);
  if (!is_search(config.search)) return "search";
  if (config.noise_samples < kMinNoiseSamples || config.noise_samples > kLongest) return "noise_samples";
  if (!(config.early_detection_probability > 1e-6f && config.early_detection_probability < 1.0f))
    return "early_detection_probability";
  if (config.window_samples < 1 || config.window_samples > kLongest) return "window_samples";
  return nullptr;
}

Status DirectPathSearcher::configure(const DirectPathConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  // 1 - (1 - P)^(1/N), without the cancellation
  const float per_sample =
      -std::expm1(std::log1p(-config.early_detection_probability) / static_cast<float>(config.noise_samples));
  threshold_factor_ = std::sqrt(-2.0f * std::log(per_sample));
  return Status::kOk;
}

Status DirectPathSearcher::process(Span<const float> envelope, DirectPath& direct_path) const {
  direct_path = DirectPath{};
  if (threshold_factor_ == 0.0f) return Status::kNotConfigured;
  if (envelope.empty()) return Status::kInvalidInput;
  const int peak = strongest(envelope);
  const int start = std::max(0, peak - config_.window_samples);
  const int n_noise = std::min(start, config_.noise_samples);
  if (n_noise < kMinNoiseSamples) return Status::kOk;

  CompensatedSum power;
  for (int k = start - n_noise; k < start; ++k) {
    const float value = envelope[static_cast<std::size_t>(k)];
    power.add(value * value);
  }
  const float sigma = std::sqrt(power.value() / (2.0f * static_cast<float>(n_noise)));
  const float threshold = threshold_factor_ * sigma;
  direct_path.threshold = threshold;
  direct_path.peak_sample = peak;
  if (!(envelope[static_cast<std::size_t>(peak)] > threshold)) return Status::kOk;

  const int first = arrival(envelope, threshold, start, peak);
  direct_path.found = true;
  direct_path.toa_samples = static_cast<float>(first);
  if (first > 0) {
    const float above = envelope[static_cast<std::size_t>(first)];
    const float before = envelope[static_cast<std::size_t>(first - 1)];
    if (before <= threshold) direct_path.toa_samples -= (above - threshold) / (above - before);
  }
  return Status::kOk;
}

int DirectPathSearcher::arrival(Span<const float> envelope, float threshold, int start, int peak) const {
  if (config_.search == DirectPathSearch::kSerialBackward) {
    int first = peak;
    while (first > start && envelope[static_cast<std::size_t>(first - 1)] > threshold) --first;
    return first;
  }
  int first = config_.search == DirectPathSearch::kThresholdCrossing ? 0 : start;
  while (first < peak && !(envelope[static_cast<std::size_t>(first)] > threshold)) ++first;
  return first;
}

}  // namespace echofuse::node
