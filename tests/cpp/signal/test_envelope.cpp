#include "echofuse/signal/envelope.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace echofuse;
using signal::Envelope;
using signal::EnvelopeConfig;
using signal::EnvelopeMethod;

namespace {

constexpr float kGuard = -12345.0f;
constexpr float kRate = 16.384e9f;

std::vector<float> tone(std::size_t n, float amplitude, float cycles) {
  std::vector<float> samples(n);
  for (std::size_t k = 0; k < n; ++k)
    samples[k] = amplitude * std::cos(6.2831853f * cycles * static_cast<float>(k));
  return samples;
}

}  // namespace

TEST_CASE("the envelope of a tone is its amplitude, and nothing is written behind it") {
  for (const EnvelopeMethod method : {EnvelopeMethod::kHilbert, EnvelopeMethod::kSquareLowPass}) {
    EnvelopeConfig config;
    config.method = method;
    Envelope envelope;
    REQUIRE(envelope.configure(config, kRate) == Status::kOk);
    const std::vector<float> scan = tone(200, 70.0f, 0.26f);
    std::vector<float> out(202, kGuard);
    for (int twice = 0; twice < 2; ++twice) {
      REQUIRE(envelope.process({scan.data(), 200}, {out.data() + 1, 200}) == Status::kOk);
      CHECK(out.front() == kGuard);
      CHECK(out.back() == kGuard);
      for (std::size_t k = 30; k < 170; ++k) CHECK(out[k + 1] == doctest::Approx(70.0f).epsilon(0.01));
    }
  }
}

TEST_CASE("a failed configure leaves the earlier envelope in force") {
  Envelope envelope;
  const std::vector<float> scan = tone(100, 3.0f, 0.25f);
  std::vector<float> before(100);
  std::vector<float> after(100);
  CHECK(envelope.process({scan.data(), 100}, {before.data(), 100}) == Status::kNotConfigured);
  REQUIRE(envelope.configure(EnvelopeConfig{}, kRate) == Status::kOk);
  REQUIRE(envelope.process({scan.data(), 100}, {before.data(), 100}) == Status::kOk);
  EnvelopeConfig bad;
  bad.low_pass_cutoff_hz = std::nanf("");
  CHECK(envelope.configure(bad, kRate) == Status::kInvalidConfig);
  CHECK(envelope.configure(EnvelopeConfig{}, 0.0f) == Status::kInvalidConfig);
  REQUIRE(envelope.process({scan.data(), 100}, {after.data(), 100}) == Status::kOk);
  CHECK(before == after);
  CHECK(envelope.process({scan.data(), 100}, {after.data(), 99}) == Status::kInvalidInput);
}
