#include "echofuse/signal/envelope.hpp"

#include <algorithm>
#include <cmath>

#include "echofuse/core/constants.hpp"

namespace echofuse::signal {
namespace {

constexpr int kTile = 8;       ///< neighbouring samples made at once
constexpr int kUsualTaps = 6;  ///< half length 11 or 12

bool is_half_length(int value) { return value >= 1 && value <= static_cast<int>(kMaxFilterHalfLength); }

/// Hann window, 1 at offset 0 and 0 at half_length + 1.
float raised_cosine(int offset, int half_length) {
  return 0.5f + 0.5f * std::cos(kPi * static_cast<float>(offset) / static_cast<float>(half_length + 1));
}

float at_or_zero(Span<const float> values, int index) {
  if (index < 0 || index >= static_cast<int>(values.size())) return 0.0f;
  return values[static_cast<std::size_t>(index)];
}

float square(float value) { return value * value; }

/// kTile neighbouring samples, all taps inside the scan: every tap is loaded once for all of them, and where their
/// number is a constant (not 0) every sample as well.
template <int kTaps>
void hilbert_tile(const float* scan, const float* taps, int n_taps, float* envelope) {
  float sum[kTile] = {};
#pragma GCC unroll 8
  for (int i = 0; i < (kTaps > 0 ? kTaps : n_taps); ++i) {
    const float tap = taps[i];
#pragma GCC unroll 8
    for (int j = 0; j < kTile; ++j) sum[j] += tap * (scan[j - 1 - 2 * i] - scan[j + 1 + 2 * i]);
  }
#pragma GCC unroll 8
  for (int j = 0; j < kTile; ++j) envelope[j] = std::sqrt(square(scan[j]) + square(sum[j]));
}

}  // namespace

const char* invalid_field(const EnvelopeConfig& config) {
  if (config.method != EnvelopeMethod::kHilbert && config.method != EnvelopeMethod::kSquareLowPass)
    return "method";
  if (!is_half_length(config.hilbert_half_length_samples)) return "hilbert_half_length_samples";
  if (!is_half_length(config.low_pass_half_length_samples)) return "low_pass_half_length_samples";
  if (!(config.low_pass_cutoff_hz > 0.0f && std::isfinite(config.low_pass_cutoff_hz)))
    return "low_pass_cutoff_hz";
  return nullptr;
}

Status Envelope::configure(const EnvelopeConfig& config, float sample_rate_hz) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  if (!(sample_rate_hz > 0.0f && std::isfinite(sample_rate_hz))) return Status::kInvalidConfig;
  const float cutoff = config.low_pass_cutoff_hz / sample_rate_hz;
  method_ = config.method;
  if (method_ == EnvelopeMethod::kHilbert) {
    half_length_ = config.hilbert_half_length_samples;
    n_taps_ = (half_length_ + 1) / 2;
    for (int i = 0; i < n_taps_; ++i) {
      const int offset = 2 * i + 1;
      taps_[static_cast<std::size_t>(i)] =
          2.0f / (kPi * static_cast<float>(offset)) * raised_cosine(offset, half_length_);
    }
  } else {
    half_length_ = config.low_pass_half_length_samples;
    n_taps_ = half_length_ + 1;
    float gain = 0.0f;
    for (int offset = 0; offset < n_taps_; ++offset) {
      const float angle = 2.0f * kPi * cutoff * static_cast<float>(offset);
      const float sinc = offset == 0 ? 1.0f : std::sin(angle) / angle;
      taps_[static_cast<std::size_t>(offset)] = sinc * raised_cosine(offset, half_length_);
      gain += (offset == 0 ? 1.0f : 2.0f) * taps_[static_cast<std::size_t>(offset)];
    }
    for (float& tap : taps_) tap /= gain;
  }
  configured_ = true;
  return Status::kOk;
}

Status Envelope::process(Span<const float> scan, Span<float> envelope) const {
  if (!configured_) return Status::kNotConfigured;
  if (scan.empty() || scan.size() != envelope.size()) return Status::kInvalidInput;
  if (method_ == EnvelopeMethod::kHilbert)
    hilbert(scan, envelope);
  else
    square_low_pass(scan, envelope);
  return Status::kOk;
}

void Envelope::hilbert(Span<const float> scan, Span<float> envelope) const {
  const int n_samples = static_cast<int>(scan.size());
  int k = 0;
  while (k < n_samples) {
    if (k >= half_length_ && k + kTile <= n_samples - half_length_) {
      if (n_taps_ == kUsualTaps)
        hilbert_tile<kUsualTaps>(scan.data() + k, taps_.data(), n_taps_, envelope.data() + k);
      else
        hilbert_tile<0>(scan.data() + k, taps_.data(), n_taps_, envelope.data() + k);
      k += kTile;
      continue;
    }
    float quadrature = 0.0f;
    for (int i = 0; i < n_taps_; ++i)
      quadrature += taps_[static_cast<std::size_t>(i)] *
                    (at_or_zero(scan, k - (2 * i + 1)) - at_or_zero(scan, k + 2 * i + 1));
    envelope[static_cast<std::size_t>(k)] =
        std::sqrt(square(scan[static_cast<std::size_t>(k)]) + square(quadrature));
    ++k;
  }
}

void Envelope::square_low_pass(Span<const float> scan, Span<float> envelope) const {
  const int n_samples = static_cast<int>(scan.size());
  for (int k = 0; k < n_samples; ++k) {
    const float* centre = scan.data() + k;
    float power = taps_[0] * square(*centre);
    if (k >= half_length_ && k < n_samples - half_length_) {
      for (int i = 1; i < n_taps_; ++i)
        power += taps_[static_cast<std::size_t>(i)] * (square(centre[-i]) + square(centre[i]));
    } else {
      for (int i = 1; i < n_taps_; ++i)
        power += taps_[static_cast<std::size_t>(i)] *
                 (square(at_or_zero(scan, k - i)) + square(at_or_zero(scan, k + i)));
    }
    envelope[static_cast<std::size_t>(k)] = std::sqrt(std::max(0.0f, 2.0f * power));
  }
}

}  // namespace echofuse::signal
