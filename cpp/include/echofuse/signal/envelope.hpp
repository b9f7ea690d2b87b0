#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::signal {

inline constexpr std::size_t kMaxFilterHalfLength = 63;  ///< [sample] 3.8 ns at 16.4 GHz, several pulses

enum class EnvelopeMethod : std::uint8_t {
  kHilbert,        ///< |r + jH(r)|
  kSquareLowPass,  ///< sqrt(2 LPF(r^2))
};

struct EnvelopeConfig {
  EnvelopeMethod method = EnvelopeMethod::kHilbert;
  int hilbert_half_length_samples = 11;   ///< [sample] filter taps on each side, 1 .. kMaxFilterHalfLength
  int low_pass_half_length_samples = 15;  ///< [sample] the same for the low pass
  float low_pass_cutoff_hz = 1.1e9f;      ///< [Hz] half the pulse's bandwidth, below half the sample rate
};

const char* invalid_field(const EnvelopeConfig& config);

/// Amplitude envelope of a scan (sensor-radar paper, Sec. IV-B), by a Hann-windowed filter without delay:
/// Hilbert transformer h[n] = 2 / (pi n) at odd n, or low pass of the square. What is outside the scan is 0.
/// Within 0.5 % of the exact envelope between 0.1 and 0.4 of the sample rate (half length 11).
/// Reference: python/echofuse/reference/signal/envelope.py
class Envelope {
 public:
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const EnvelopeConfig& config, float sample_rate_hz);

  /// scan, envelope: (n_samples,) [count], not overlapping.
  Status process(Span<const float> scan, Span<float> envelope) const;

  /// [sample] How far a sample spreads into the envelope.
  int reach_samples() const { return half_length_; }

 private:
  void hilbert(Span<const float> scan, Span<float> envelope) const;
  void square_low_pass(Span<const float> scan, Span<float> envelope) const;

  bool configured_ = false;
  EnvelopeMethod method_ = EnvelopeMethod::kHilbert;
  int half_length_ = 0;
  int n_taps_ = 0;
  std::array<float, kMaxFilterHalfLength + 1> taps_{};  ///< Hilbert: offsets 1, 3, ...; low pass: 0, 1, ...
};

}  // namespace echofuse::signal
