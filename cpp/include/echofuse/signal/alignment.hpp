#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::signal {

inline constexpr std::size_t kMaxAlignmentShift = 64;  ///< [sample] 3.9 ns of timing jitter at 16.4 GHz
inline constexpr std::size_t kMaxInterpolatorHalfLength =
    16;  ///< [sample] more gains nothing over float noise

enum class AlignmentMethod : std::uint8_t {
  kSubSample,  ///< whole shift and a fraction by a parabola
  kInteger,    ///< whole shift
  kNone,       ///< no shift
};

struct AlignmentConfig {
  AlignmentMethod method = AlignmentMethod::kSubSample;
  int max_shift_samples = 8;  ///< [sample] searched on each side of the coarse shift
  int window_samples = 512;   ///< [sample] compared, around the background's strongest one; >= 8
  int interpolator_half_length_samples = 8;  ///< [sample] taps on each side of the fractional delay
};

const char* invalid_field(const AlignmentConfig& config);

struct Alignment {
  float shift_samples = 0.0f;  ///< [sample] how much later the envelope is than the reference
  float correlation = 0.0f;    ///< [1] normalised, at the best whole shift
};

/// Finds and undoes the delay of a scan against the background's (sensor-radar paper, footnote 11): cross-
/// correlation over whole shifts, a parabola through the best three for the fraction, and a Blackman-windowed
/// sinc as fractional delay.
/// Reference: python/echofuse/reference/signal/alignment.py
class Aligner {
 public:
  Status configure(const AlignmentConfig& config);

  /// Maximises sum_k envelope[k + shift] reference[k] over k in [first, last) and |shift - coarse_shift| <=
  /// max_shift_samples. envelope, reference: (n_samples,) [count]; the envelope is 0 outside.
  Status estimate(Span<const float> envelope, Span<const float> reference, int coarse_shift, int first,
                  int last, Alignment& alignment) const;

  /// output[k] = input at k + shift_samples: undoes a delay of that much. 0 where that is outside.
  /// input, output: (n_samples,), not overlapping; |shift_samples| <= n_samples.
  Status shift(Span<const float> input, float shift_samples, Span<float> output) const;

  AlignmentMethod method() const { return config_.method; }

 private:
  using Taps = std::array<float, 2 * kMaxInterpolatorHalfLength>;
  void interpolator(float fraction, Taps& taps) const;

  bool configured_ = false;
  AlignmentConfig config_;
  Taps window_cosine_{};  ///< cos(pi j / half length), j = -half length + 1 .. half length
  Taps window_sine_{};
};

}  // namespace echofuse::signal
