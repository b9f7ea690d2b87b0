#include "echofuse/core/random.hpp"

#include <cmath>
#include <cstring>

namespace echofuse {
namespace {

constexpr std::uint64_t kMultiplier = 6364136223846793005u;
constexpr float kDrawScale = 1.0f / 16777216.0f;  // 2^-24

/// Natural logarithm of a positive normal number by +, * and / alone: the C library's differs from machine to
/// machine. x = m * 2^e with m in [sqrt(1/2), sqrt(2)); log m = 2 artanh(s), s = (m - 1) / (m + 1), |s| <
/// 0.172.
float portable_log(float x) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  constexpr std::uint32_t kSqrtHalfBits = 0x3f3504f3u;
  const std::uint32_t shifted = bits - kSqrtHalfBits;
  const int exponent = static_cast<int>(static_cast<std::int32_t>(shifted) >> 23);
  const std::uint32_t mantissa_bits = (shifted & 0x007fffffu) + kSqrtHalfBits;
  float mantissa = 0.0f;
  std::memcpy(&mantissa, &mantissa_bits, sizeof mantissa);

  constexpr float kLn2 = 0.69314718f;
  const float s = (mantissa - 1.0f) / (mantissa + 1.0f);
  const float s2 = s * s;
  const float series = s2 * (1.0f / 3.0f + s2 * (1.0f / 5.0f + s2 * (1.0f / 7.0f + s2 * (1.0f / 9.0f))));
  return static_cast<float>(exponent) * kLn2 + 2.0f * (s + s * series);
}

/// Inverse normal distribution at 1/2 + offset, |offset| < 1/2 (AS 241, PPND7). Its branch for probabilities
/// under exp(-25) is left out: the smallest here is 2^-25.
float inverse_normal(float offset) {
  if (std::fabs(offset) <= 0.425f) {
    const float r = 0.180625f - offset * offset;
    const float above = ((59.109374720f * r + 159.29113202f) * r + 50.434271938f) * r + 3.3871327179f;
    const float below = ((67.187563600f * r + 78.757757664f) * r + 17.895169469f) * r + 1.0f;
    return offset * above / below;
  }
  const float tail = 0.5f - std::fabs(offset);
  const float r = std::sqrt(-portable_log(tail)) - 1.6f;
  const float above = ((0.17023821103f * r + 1.3067284816f) * r + 2.7568153900f) * r + 1.4234372777f;
  const float below = (0.12021132975f * r + 0.73700164250f) * r + 1.0f;
  const float magnitude = above / below;
  return offset < 0.0f ? -magnitude : magnitude;
}

}  // namespace

Pcg32::Pcg32(std::uint64_t seed, std::uint64_t stream) : increment_((stream << 1u) | 1u) {
  (void)next_u32();
  state_ += seed;
  (void)next_u32();
}

std::uint32_t Pcg32::next_u32() {
  const std::uint64_t old = state_;
  state_ = old * kMultiplier + increment_;
  const auto xorshifted = static_cast<std::uint32_t>(((old >> 18u) ^ old) >> 27u);
  const auto rotation = static_cast<std::uint32_t>(old >> 59u);
  return (xorshifted >> rotation) | (xorshifted << ((32u - rotation) & 31u));
}

float Pcg32::uniform() { return static_cast<float>(next_u32() >> 8u) * kDrawScale; }

float Pcg32::normal() {
  const auto k = static_cast<std::int32_t>(next_u32() >> 8u);
  return inverse_normal((static_cast<float>(k - 8388608) + 0.5f) * kDrawScale);
}

}  // namespace echofuse
