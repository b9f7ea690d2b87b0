#include "echofuse/node/scan/weak_signal.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace echofuse::node {

const char* invalid_field(const WeakSignalConfig& config) {
  if (!(config.floor_factor >= 0.0f && std::isfinite(config.floor_factor))) return "floor_factor";
  if (config.noise_samples < 1) return "noise_samples";
  if (!(config.averaging_factor >= 0.0f && config.averaging_factor < 1.0f)) return "averaging_factor";
  return nullptr;
}

Status WeakSignalEnhancer::configure(const WeakSignalConfig& config, int n_samples) {
  if (invalid_field(config) != nullptr || config.noise_samples > n_samples) return Status::kInvalidConfig;
  config_ = config;
  n_samples_ = n_samples;
  reset();
  return Status::kOk;
}

void WeakSignalEnhancer::reset() {
  n_averaged_ = 0;
  noise_ = 0.0f;
}

Status WeakSignalEnhancer::process(Span<float> samples) {
  if (n_samples_ == 0) return Status::kNotConfigured;
  if (samples.size() != static_cast<std::size_t>(n_samples_)) return Status::kInvalidInput;

  const auto n_noise = static_cast<std::size_t>(config_.noise_samples);
  float square = 0.0f;
  for (std::size_t k = samples.size() - n_noise; k < samples.size(); ++k) square += samples[k] * samples[k];
  const float averaged = static_cast<float>(n_averaged_);
  const float keep = std::min(config_.averaging_factor, averaged / (averaged + 1.0f));
  noise_ = keep * noise_ + (1.0f - keep) * std::sqrt(square / static_cast<float>(n_noise));
  if (n_averaged_ < 1000000) ++n_averaged_;  // where the average has long been exponential

  float largest = config_.floor_factor * noise_;
  for (std::size_t k = samples.size(); k > 0; --k) {
    float& sample = samples[k - 1];
    largest = std::max(largest, std::abs(sample));
    sample = largest > 0.0f ? sample / largest : 0.0f;
  }
  return Status::kOk;
}

}  // namespace echofuse::node
