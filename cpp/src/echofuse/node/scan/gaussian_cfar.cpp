#include "echofuse/node/scan/gaussian_cfar.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace echofuse::node {
namespace {

constexpr std::size_t kBlindSamples = 5;  ///< until the fast mean has begun

bool is_factor(float value) { return value > 0.0f && value <= 1.0f; }

}  // namespace

const char* invalid_field(const GaussianCfarConfig& config) {
  if (!is_factor(config.fast_factor)) return "fast_factor";
  if (!is_factor(config.slow_factor)) return "slow_factor";
  if (!(config.deviations > 0.0f && std::isfinite(config.deviations))) return "deviations";
  if (config.spread > ClutterSpread::kRms) return "spread";
  if (config.starting_samples < 1) return "starting_samples";
  return nullptr;
}

Status GaussianCfarDetector::configure(const GaussianCfarConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  configured_ = true;
  return Status::kOk;
}

Status GaussianCfarDetector::process(Span<const float> samples, Span<std::uint8_t> decisions) const {
  if (!configured_) return Status::kNotConfigured;
  if (samples.size() != decisions.size()) return Status::kInvalidInput;
  Statistics statistics;
  const std::size_t n_start = std::min(samples.size(), static_cast<std::size_t>(config_.starting_samples));
  for (std::size_t k = 0; k < n_start; ++k) advance(std::abs(samples[k]), statistics);
  statistics.fast = 0.0f;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    advance(std::abs(samples[k]), statistics);
    const float above = statistics.fast - statistics.mean;
    const bool hit = above > config_.deviations * std::sqrt(statistics.square);
    decisions[k] = k >= kBlindSamples && hit ? 1 : 0;
  }
  return Status::kOk;
}

void GaussianCfarDetector::advance(float amplitude, Statistics& statistics) const {
  statistics.fast += config_.fast_factor * (amplitude - statistics.fast);
  statistics.mean += config_.slow_factor * (amplitude - statistics.mean);
  const float spread = config_.spread == ClutterSpread::kRms ? amplitude : amplitude - statistics.mean;
  statistics.square += config_.slow_factor * (spread * spread - statistics.square);
}

}  // namespace echofuse::node
