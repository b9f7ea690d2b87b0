#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "echofuse/core/random.hpp"

namespace echofuse {
namespace {

/// The normal distribution, by the C library in double.
double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

}  // namespace

TEST_CASE("the published stream of seed 42, stream 54") {
  Pcg32 random(42, 54);
  for (const std::uint32_t expected :
       {0xa15c02b7u, 0x7b47f409u, 0xba1d3330u, 0x83d2f293u, 0xbfa4784bu, 0xcbed606eu})
    CHECK(random.next_u32() == expected);
}

TEST_CASE("uniform is the upper 24 bits of the draw, in [0, 1)") {
  Pcg32 random(7, 3);
  Pcg32 draws(7, 3);
  for (int i = 0; i < 1000; ++i) {
    const float value = random.uniform();
    REQUIRE(value == static_cast<float>(draws.next_u32() >> 8u) / 16777216.0f);
    REQUIRE(value < 1.0f);
  }
}

TEST_CASE("normal inverts the normal distribution in the middle of its step") {
  Pcg32 random(11, 5);
  Pcg32 draws(11, 5);
  for (int i = 0; i < 20000; ++i) {
    const double z = static_cast<double>(random.normal());
    const double probability = (static_cast<double>(draws.next_u32() >> 8u) + 0.5) / 16777216.0;
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::acos(-1.0));
    const double error = (normal_cdf(z) - probability) / density;
    REQUIRE(std::fabs(error) <= 1e-6 * std::max(1.0, std::fabs(z)));
  }
}

TEST_CASE("normals keep their bits on every machine") {
  // A hash of 4096 normals, written down once: a port whose float32 rounds otherwise is caught here.
  Pcg32 random(2026, 1);
  std::uint32_t hash = 2166136261u;
  for (int i = 0; i < 4096; ++i) {
    const float value = random.normal();
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * 16777619u;
  }
  CHECK(hash == 136054446u);
}

TEST_CASE("streams of one seed differ") {
  Pcg32 first(1, 1);
  Pcg32 second(1, 2);
  int equal = 0;
  for (int i = 0; i < 100; ++i) equal += first.next_u32() == second.next_u32() ? 1 : 0;
  CHECK(equal < 3);
}

}  // namespace echofuse
