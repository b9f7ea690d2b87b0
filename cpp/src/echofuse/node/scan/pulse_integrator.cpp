#include "echofuse/node/scan/pulse_integrator.hpp"

#include <algorithm>

namespace echofuse::node {

const char* invalid_field(const PulseIntegratorConfig& config) {
  return config.pulses_per_scan >= 1 && config.pulses_per_scan <= 1000000 ? nullptr : "pulses_per_scan";
}

Status PulseIntegrator::configure(const PulseIntegratorConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  pulses_per_scan_ = config.pulses_per_scan;
  reset();
  return Status::kOk;
}

void PulseIntegrator::reset() { n_pulses_ = 0; }

Status PulseIntegrator::process(Span<const float> pulse, bool& complete) {
  complete = false;
  if (pulses_per_scan_ == 0) return Status::kNotConfigured;
  if (pulse.empty() || pulse.size() > sum_.size()) return Status::kInvalidInput;
  if (n_pulses_ > 0 && pulse.size() != n_samples_) return Status::kInvalidInput;
  if (n_pulses_ == 0) {
    n_samples_ = pulse.size();
    std::copy(pulse.begin(), pulse.end(), sum_.begin());
  } else {
    for (std::size_t k = 0; k < n_samples_; ++k) sum_[k] += pulse[k];
  }
  if (++n_pulses_ < pulses_per_scan_) return Status::kOk;
  if (pulses_per_scan_ > 1) {
    const float scale = 1.0f / static_cast<float>(pulses_per_scan_);
    for (std::size_t k = 0; k < n_samples_; ++k) sum_[k] *= scale;
  }
  n_pulses_ = 0;
  complete = true;
  return Status::kOk;
}

}  // namespace echofuse::node
