#include "echofuse/node/scan/time_zero.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace echofuse::node {

const char* invalid_field(const TimeZeroConfig& config) {
  if (config.learning_responses < 1) return "learning_responses";
  if (!(config.strong_fraction > 0.0f && config.strong_fraction <= 1.0f)) return "strong_fraction";
  if (!(config.least_peak_factor > 1.0f && std::isfinite(config.least_peak_factor)))
    return "least_peak_factor";
  if (config.moved_samples < 0) return "moved_samples";
  if (config.moved_responses < 1) return "moved_responses";
  return nullptr;
}

Status TimeZeroFinder::configure(const TimeZeroConfig& config, int n_samples, float expected_samples) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  if (n_samples < 3 || n_samples > static_cast<int>(kMaxResponseSamples)) return Status::kInvalidConfig;
  if (!(expected_samples >= 0.0f && expected_samples < static_cast<float>(n_samples)))
    return Status::kInvalidConfig;
  config_ = config;
  n_samples_ = n_samples;
  expected_ = static_cast<int>(std::nearbyint(expected_samples));
  reset();
  return Status::kOk;
}

void TimeZeroFinder::reset() {
  n_learnt_ = 0;
  elsewhere_ = 0;
  place_ = CrossTalk{};
}

Status TimeZeroFinder::process(Span<const float> response, Span<float> rotated, TimeZeroResult& result) {
  result = TimeZeroResult{};
  if (n_samples_ == 0) return Status::kNotConfigured;
  const auto n = static_cast<std::size_t>(n_samples_);
  if (response.size() != n || rotated.empty() || rotated.size() > n) return Status::kInvalidInput;
  std::fill(rotated.begin(), rotated.end(), 0.0f);
  if (!place_.found) {
    learn(response);
    return Status::kOk;
  }

  const CrossTalk here = cross_talk(response);
  int off = std::abs(here.sample - place_.sample);
  off = std::min(off, n_samples_ - off);
  if (!here.found || off > config_.moved_samples) {
    if (++elsewhere_ >= config_.moved_responses) {
      reset();
      learn(response);
      result.moved = true;
    }
    return Status::kOk;
  }
  elsewhere_ = 0;
  result.found = true;
  result.rotation_samples = (place_.sample - expected_ + n_samples_) % n_samples_;
  result.fraction_samples = place_.fraction_samples;
  const auto first = static_cast<std::size_t>(result.rotation_samples);
  const std::size_t before_end = std::min(rotated.size(), n - first);
  std::copy_n(response.begin() + first, before_end, rotated.begin());
  std::copy_n(response.begin(), rotated.size() - before_end, rotated.begin() + before_end);
  return Status::kOk;
}

void TimeZeroFinder::learn(Span<const float> response) {
  if (n_learnt_ == 0) mean_.fill(0.0f);
  ++n_learnt_;
  const float weight = 1.0f / static_cast<float>(n_learnt_);
  for (std::size_t k = 0; k < response.size(); ++k) mean_[k] += weight * (response[k] - mean_[k]);
  if (n_learnt_ < config_.learning_responses) return;
  place_ = cross_talk({mean_.data(), response.size()});
  n_learnt_ = 0;
}

TimeZeroFinder::CrossTalk TimeZeroFinder::cross_talk(Span<const float> response) const {
  const auto amplitude = [&](int k) {
    return std::abs(response[static_cast<std::size_t>((k + n_samples_) % n_samples_)]);
  };
  float largest = 0.0f;
  float sum = 0.0f;
  for (const float value : response) {
    largest = std::max(largest, std::abs(value));
    sum += std::abs(value);
  }
  CrossTalk found;
  if (!(largest > config_.least_peak_factor * (sum / static_cast<float>(n_samples_)))) return found;

  const float level = config_.strong_fraction * largest;
  int first_strong = -1;  // of all, for the rest before it reaches around the end
  int last_strong = -1;
  int longest_rest = -1;
  for (int k = 0; k < n_samples_; ++k) {
    const float a = std::abs(response[static_cast<std::size_t>(k)]);  // amplitude(k), which divides
    if (!(a >= level && a > amplitude(k - 1) && a >= amplitude(k + 1))) continue;
    const int rest = k - last_strong - 1;
    if (first_strong < 0) {
      first_strong = k;
    } else if (rest > longest_rest) {
      longest_rest = rest;
      found.sample = k;
    }
    last_strong = k;
  }
  if (first_strong < 0) return found;
  const int around = (first_strong - last_strong - 1 + n_samples_) % n_samples_;
  if (around >= longest_rest) found.sample = first_strong;  // of equals the first
  found.found = true;
  const float left = amplitude(found.sample - 1);
  const float right = amplitude(found.sample + 1);
  const float curvature = left - 2.0f * amplitude(found.sample) + right;
  if (curvature < 0.0f) found.fraction_samples = 0.5f * (left - right) / curvature;
  return found;
}

}  // namespace echofuse::node
