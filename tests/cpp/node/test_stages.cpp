#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "echofuse/core/random.hpp"
#include "echofuse/node/scan/cfar.hpp"
#include "echofuse/node/scan/clutter.hpp"
#include "echofuse/node/scan/noise_floor.hpp"
#include "echofuse/node/scan/pulse_integrator.hpp"

using namespace echofuse;
using namespace echofuse::node;

namespace {

constexpr float kGuard = -777.0f;
constexpr CfarMethod kMethods[] = {CfarMethod::kDoubleThresholdBuffer, CfarMethod::kCellAveraging,
                                   CfarMethod::kGlobalAverage, CfarMethod::kOrderedStatistic};

std::vector<float> noise_with_echo(std::uint64_t seed, std::size_t n) {
  Pcg32 random(seed, 0);
  std::vector<float> samples(n);
  for (float& sample : samples) sample = std::abs(random.normal());
  for (std::size_t k = n / 2; k < n / 2 + 8; ++k) samples[k] += 30.0f;
  return samples;
}

}  // namespace

TEST_CASE("every detector finds the echo, twice alike, within its outputs") {
  const std::vector<float> samples = noise_with_echo(5, 400);
  for (const CfarMethod method : kMethods) {
    CfarConfig config;
    config.method = method;
    CfarDetector detector;
    std::vector<float> threshold(402, kGuard);
    std::vector<std::uint8_t> decisions(402, 99);
    CHECK(detector.process({samples.data(), 400}, {threshold.data(), 400}, {decisions.data(), 400}) ==
          Status::kNotConfigured);
    REQUIRE(detector.configure(config) == Status::kOk);
    std::vector<float> first;
    for (int twice = 0; twice < 2; ++twice) {
      REQUIRE(detector.process({samples.data(), 400}, {threshold.data() + 1, 400},
                               {decisions.data() + 1, 400}) == Status::kOk);
      CHECK(threshold.front() == kGuard);
      CHECK(threshold.back() == kGuard);
      CHECK(decisions.front() == 99);
      CHECK(decisions.back() == 99);
      CHECK(decisions[1 + 204] == 1);
      CHECK(decisions[1 + 100] == 0);
      if (twice == 0) first = threshold;
    }
    CHECK(first == threshold);
  }
}

TEST_CASE("detectors refuse what is not finite, too short, or of two lengths") {
  std::vector<float> samples = noise_with_echo(6, 300);
  std::vector<float> threshold(300);
  std::vector<std::uint8_t> decisions(300);
  for (const CfarMethod method : kMethods) {
    CfarConfig config;
    config.method = method;
    CfarDetector detector;
    REQUIRE(detector.configure(config) == Status::kOk);
    const auto process = [&](std::size_t n, std::size_t n_out) {
      return detector.process({samples.data(), n}, {threshold.data(), n_out}, {decisions.data(), n_out});
    };
    CHECK(process(300, 299) == Status::kInvalidInput);
    CHECK(process(10, 10) == Status::kInvalidInput);
    const float kept = samples[7];
    for (const float bad : {std::nanf(""), INFINITY, -INFINITY}) {
      samples[7] = bad;
      CHECK(process(300, 300) == Status::kInvalidInput);
    }
    samples[7] = kept;
    CHECK(process(300, 300) == Status::kOk);
  }
}

TEST_CASE("frame difference remembers exactly its lag, in place too") {
  ClutterConfig config;
  config.method = ClutterMethod::kFrameDifference;
  config.difference_lag_scans = 3;
  ClutterFilter filter;
  float scan[4] = {};
  CHECK(filter.process(scan, scan) == Status::kNotConfigured);
  REQUIRE(filter.configure(config, 4) == Status::kOk);
  for (int t = 0; t < 9; ++t) {
    for (int k = 0; k < 4; ++k) scan[k] = static_cast<float>(t * t + k);
    CHECK(filter.ready() == (t >= 3));
    REQUIRE(filter.process(scan, scan) == Status::kOk);
    const float expected = t < 3 ? 0.0f : static_cast<float>(t * t - (t - 3) * (t - 3));
    for (const float value : scan) CHECK(value == expected);
  }
  config.difference_lag_scans = 4;
  CHECK(filter.configure(config, static_cast<int>(kMaxSamplesPerScan)) == Status::kInvalidConfig);
  float five[5] = {};
  CHECK(filter.process(five, five) == Status::kInvalidInput);
}

TEST_CASE("an exponential average starts as a plain mean and then follows") {
  ClutterConfig config;
  config.method = ClutterMethod::kExponentialAverage;
  config.averaging_factor = 0.75f;
  config.learning_scans = 2;
  ClutterFilter filter;
  REQUIRE(filter.configure(config, 1) == Status::kOk);
  // background before each scan: -, 4, 6, then 0.75 of the past (1/3 and 1/4 are not more than 0.25)
  const float scans[] = {4.0f, 8.0f, 9.0f, 7.0f, 15.0f};
  const float expected[] = {0.0f, 0.0f, 3.0f, 0.0f, 8.0f};
  for (int t = 0; t < 5; ++t) {
    float residual[1] = {kGuard};
    REQUIRE(filter.process({scans + t, 1}, residual) == Status::kOk);
    CHECK(residual[0] == doctest::Approx(expected[t]));
  }
}

TEST_CASE("a rectifier passes what is positive") {
  float samples[] = {-3.0f, 0.0f, 2.0f};
  rectify(samples);
  CHECK(samples[0] == 0.0f);
  CHECK(samples[1] == 0.0f);
  CHECK(samples[2] == 2.0f);
}

TEST_CASE("the noise floor follows the quietest block and raises thresholds only") {
  NoiseFloorConfig config;
  config.factor = 2.0f;
  config.block_samples = 2;
  NoiseFloor floor;
  REQUIRE(floor.configure(config) == Status::kOk);
  const float amplitude[] = {9.0f, 9.0f, 3.0f, 3.0f, 0.0f, 0.0f};  // a silent block says nothing
  float threshold[] = {1.0f, 100.0f, 1.0f, 1.0f, 1.0f, 1.0f};
  REQUIRE(floor.process(amplitude, threshold) == Status::kOk);
  CHECK(floor.floor() == doctest::Approx(3.0f));
  CHECK(threshold[0] == doctest::Approx(36.0f));
  CHECK(threshold[1] == 100.0f);
  const float silence[] = {0.0f, 0.0f};
  float low[] = {0.0f, 0.0f};
  REQUIRE(floor.process(silence, low) == Status::kOk);
  CHECK(floor.floor() == doctest::Approx(3.0f));
  CHECK(low[1] == doctest::Approx(36.0f));
}

TEST_CASE("pulses become scans by their mean, each scan by itself") {
  PulseIntegrator integrator;
  bool complete = true;
  const float pulse[] = {1.0f, 2.0f};
  CHECK(integrator.process(pulse, complete) == Status::kNotConfigured);
  PulseIntegratorConfig config;
  config.pulses_per_scan = 2;
  REQUIRE(integrator.configure(config) == Status::kOk);
  for (int scan = 0; scan < 2; ++scan) {
    const float later[] = {3.0f, static_cast<float>(scan)};
    REQUIRE(integrator.process(pulse, complete) == Status::kOk);
    CHECK_FALSE(complete);
    REQUIRE(integrator.process(later, complete) == Status::kOk);
    CHECK(complete);
    CHECK(integrator.scan()[0] == 2.0f);
    CHECK(integrator.scan()[1] == 1.0f + 0.5f * static_cast<float>(scan));
  }
  const float longer[] = {1.0f, 2.0f, 3.0f};
  REQUIRE(integrator.process(pulse, complete) == Status::kOk);
  CHECK(integrator.process(longer, complete) == Status::kInvalidInput);
  integrator.reset();
  CHECK(integrator.process(longer, complete) == Status::kOk);
}
