#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "echofuse/core/span.hpp"

namespace echofuse {

/// Bits of a magnitude, ordered as magnitudes are, and NaN behind infinity: three instructions a sample where a comparison
/// of floats takes six.
inline std::uint32_t magnitude_bits(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits << 1u;
}

/// True if |value| <= limit for every value; false for NaN. limit >= 0.
inline bool all_within(Span<const float> values, float limit) {
  constexpr std::size_t kAtOnce = 8;
  const std::uint32_t most = magnitude_bits(limit);
  const float* value = values.begin();
  for (std::size_t blocks = values.size() / kAtOnce; blocks > 0; --blocks, value += kAtOnce)
#pragma GCC unroll 8
    for (std::size_t i = 0; i < kAtOnce; ++i)
      if (magnitude_bits(value[i]) > most) return false;
  for (; value < values.end(); ++value)
    if (magnitude_bits(*value) > most) return false;
  return true;
}

}  // namespace echofuse
