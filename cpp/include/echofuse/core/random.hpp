#pragma once

#include <cstdint>

namespace echofuse {

/// The one source of randomness, always passed in: PCG-XSH-RR 64/32 (O'Neill, HMC-CS-2014-0905, 2014).
/// Every method takes exactly one 32-bit draw, so two programs that call alike stay in step, and computes
/// with exact or correctly rounded float32 operations only, so every IEEE machine gets the same bits.
/// Reference: python/echofuse/reference/core/random.py
class Pcg32 {
 public:
  explicit Pcg32(std::uint64_t seed = 0, std::uint64_t stream = 0);

  std::uint32_t next_u32();

  /// [1] in [0, 1): k * 2^-24 with k = next_u32() >> 8, exact in float32.
  float uniform();

  /// [1] standard normal: the inverse of the normal distribution at (k + 1/2) * 2^-24, k as above, so within
  /// +-5.42. Evaluated by Wichura's PPND7 (Applied Statistics 37, AS 241, 1988) to 1e-6 * max(1, |value|).
  float normal();

 private:
  std::uint64_t state_ = 0;
  std::uint64_t increment_ = 1;  ///< odd; which of 2^63 streams
};

}  // namespace echofuse
