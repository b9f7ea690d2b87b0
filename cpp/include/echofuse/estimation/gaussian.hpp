#pragma once

#include <cstdint>
#include <cstring>

namespace echofuse::estimation {

/// [1] squared Mahalanobis distance beyond which a likelihood is zero: exp(-12.5) is 4e-6 of the peak.
inline constexpr float kGaussianCutSquared = 25.0f;

/// exp(-d^2 / 2) for 0 <= d^2 <= kGaussianCutSquared, to 3e-7 of the value. By +, * and bit operations alone,
/// so every IEEE machine gets the same bits; the C library's expf differs among them. Inline, so that a loop over
/// particles keeps the constants in registers.
inline float gaussian_kernel_within_cut(float squared_distance) {
  // exp(-y) = 2^-n exp(r), r = n ln 2 - y in [-0.35, 0.35]; ln 2 in two parts, so that r loses nothing.
  constexpr float kLog2E = 1.44269504f;
  constexpr float kLn2High = 0.693359375f;
  constexpr float kLn2Low = -2.12194440e-4f;
  const float y = 0.5f * squared_distance;
  const auto n = static_cast<std::int32_t>(y * kLog2E + 0.5f);
  const auto n_float = static_cast<float>(n);
  const float r = (n_float * kLn2High - y) + n_float * kLn2Low;
  const float series =
      1.0f +
      r * (1.0f + r * (0.5f + r * (1.0f / 6.0f +
                                   r * (1.0f / 24.0f +
                                        r * (1.0f / 120.0f + r * (1.0f / 720.0f + r * (1.0f / 5040.0f)))))));
  const auto scale_bits = static_cast<std::uint32_t>(127 - n) << 23u;
  float scale = 0.0f;
  std::memcpy(&scale, &scale_bits, sizeof scale);
  return series * scale;
}

/// exp(-d^2 / 2) of a squared distance >= 0, and 0 beyond kGaussianCutSquared.
/// Reference: python/echofuse/reference/estimation/gaussian.py
inline float gaussian_kernel(float squared_distance) {
  return squared_distance <= kGaussianCutSquared ? gaussian_kernel_within_cut(squared_distance) : 0.0f;
}

}  // namespace echofuse::estimation
