#pragma once

#include <array>

#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::node {

struct PulseIntegratorConfig {
  int pulses_per_scan = 1;  ///< pulse responses averaged into one scan; 1: the radar module integrates itself
};

const char* invalid_field(const PulseIntegratorConfig& config);

/// Coherent integration (sensor-radar paper, Sec. IV-A): the mean of every N_s pulse responses in a row.
/// Reference: python/echofuse/reference/node/scan/pulse_integrator.py
class PulseIntegrator {
 public:
  Status configure(const PulseIntegratorConfig& config);

  /// Forgets the pulses of an unfinished scan.
  void reset();

  /// pulse: (n_samples,) [count], of the same length within a scan. complete: scan() holds a new scan.
  Status process(Span<const float> pulse, bool& complete);

  /// (n_samples,) [count] The last complete scan; only valid until the next process().
  Span<const float> scan() const { return {sum_.data(), n_samples_}; }

 private:
  int pulses_per_scan_ = 0;  ///< 0 until configured
  int n_pulses_ = 0;         ///< in sum_ so far
  std::size_t n_samples_ = 0;
  std::array<float, kMaxSamplesPerScan> sum_{};  ///< of the pulses; their mean once complete
};

}  // namespace echofuse::node
