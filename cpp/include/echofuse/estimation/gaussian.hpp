#pragma once

namespace echofuse::estimation {

/// [1] squared Mahalanobis distance beyond which a likelihood is zero: exp(-12.5) is 4e-6 of the peak.
inline constexpr float kGaussianCutSquared = 25.0f;

/// exp(-d^2 / 2) for 0 <= d^2 <= kGaussianCutSquared, to 3e-7 of the value. By +, * and bit operations alone,
/// so every IEEE machine gets the same bits; the C library's expf differs among them.
float gaussian_kernel_within_cut(float squared_distance);

/// exp(-d^2 / 2) of a squared distance >= 0, and 0 beyond kGaussianCutSquared.
/// Reference: python/echofuse/reference/estimation/gaussian.py
inline float gaussian_kernel(float squared_distance) {
  return squared_distance <= kGaussianCutSquared ? gaussian_kernel_within_cut(squared_distance) : 0.0f;
}

}  // namespace echofuse::estimation
