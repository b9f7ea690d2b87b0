#include "echofuse/node/through_wall.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "echofuse/core/constants.hpp"
#include "echofuse/core/random.hpp"

using namespace echofuse;
using node::ThroughWallNode;
using node::ThroughWallNodeConfig;

namespace {

constexpr int kSamples = 511;
constexpr int kLong = static_cast<int>(kMaxResponseSamples);
constexpr int kSettled = 13;  // responses: 5 for time zero, 8 for the background
constexpr float kRate = 4.5e9f;

float echo(int k, float place, float carrier) {
  const float x = static_cast<float>(k) - place;
  return std::exp(-0.2f * x * x) * std::cos(2.0f * kPi * carrier * x);
}

/// Cross-talk, a wall, and a person's echo where `person` > 0; begins with chip `start`.
std::vector<float> response(std::uint64_t seed, int start, float person = 0.0f, int n_samples = kSamples) {
  Pcg32 random(seed, 5);
  std::vector<float> plain(static_cast<std::size_t>(n_samples));
  for (int k = 0; k < n_samples; ++k) {
    float& sample = plain[static_cast<std::size_t>(k)];
    sample = 2.0f * random.normal() + 4000.0f * echo(k, 6.0f, 0.0f) + 900.0f * echo(k, 14.0f, 0.25f);
    if (person > 0.0f) sample += 300.0f * echo(k, person, 0.25f) + 200.0f * echo(k, person + 6.0f, 0.25f);
  }
  std::rotate(plain.rbegin(), plain.rbegin() + start, plain.rend());
  return plain;
}

Span<const float> view(const std::vector<float>& samples) { return {samples.data(), samples.size()}; }

struct Heard {
  ThroughWallNode node;
  link::Detections report;
  std::uint64_t seed = 0;

  explicit Heard(int n_samples = kSamples, int kept_samples = 0) {
    ThroughWallNodeConfig config;
    config.node_id = 3;
    config.n_samples = n_samples;
    config.kept_samples = kept_samples;
    config.full_scale_count = 8000.0f;
    REQUIRE(node.configure(config) == Status::kOk);
  }
  Status say(const std::vector<float>& samples) {
    return node.process(view(samples), 1000 * static_cast<std::int64_t>(++seed), report);
  }
  void settle(int start, int n = kSettled, int n_samples = kSamples) {
    for (int i = 0; i < n; ++i) {
      REQUIRE(say(response(seed, start, 0.0f, n_samples)) == Status::kOk);
      REQUIRE(report.detections.empty());
    }
  }
  bool reports(float person) const {
    const float first = (person - 2.0f) / kRate;  // where the echo is half as high
    for (const link::Detection& detection : report.detections)
      if (std::abs(detection.delay_s - first) < 1.0f / kRate) return true;
    return false;
  }
};

}  // namespace

TEST_CASE("a through-wall node fits its budget") { CHECK(sizeof(ThroughWallNode) <= 60 * 1024); }

TEST_CASE("GIVEN an empty room behind a wall WHEN a person comes THEN the report says where") {
  Heard heard;
  heard.settle(200);
  REQUIRE(heard.node.ready());
  for (std::uint32_t k = 0; k < 5; ++k) {
    const float person = 60.0f + 20.0f * static_cast<float>(k);
    REQUIRE(heard.say(response(heard.seed, 200, person)) == Status::kOk);
    CHECK(heard.node.report_ready());
    CHECK(heard.report.node_id == 3);
    CHECK(heard.report.frame == kSettled + k);
    CHECK(heard.report.time_us == 1000 * static_cast<std::int64_t>(heard.seed));
    CHECK(heard.reports(person));
  }
}

TEST_CASE(
    "GIVEN a node that is ready WHEN the radar is switched on anew THEN it says nothing until all is known "
    "again") {
  Heard heard;
  heard.settle(200);
  heard.settle(77, 2 + kSettled);
  CHECK(heard.node.counters().time_zero_moved == 1);
  CHECK(heard.node.counters().cross_talk_missing == 2);
  CHECK(heard.node.counters().settling_responses == 2 * kSettled);
  REQUIRE(heard.say(response(heard.seed, 77, 90.0f)) == Status::kOk);
  CHECK(heard.reports(90.0f));
}

TEST_CASE("GIVEN a long sequence of which little is kept WHEN people come THEN only what is kept is seen") {
  for (const int start : {0, 200, kLong - 100}) {  // what is kept begins or lies around the response's end
    Heard heard(kLong, 300);
    heard.settle(start, kSettled, kLong);
    std::size_t shown = 0;
    const TapFunction count = [](void* context, TapId tap, Span<const float> values) {
      if (tap == TapId::kScan) CHECK(values.size() == kLong);
      if (tap == TapId::kRotated || tap == TapId::kSubtracted || tap == TapId::kEnvelope ||
          tap == TapId::kEnhanced || tap == TapId::kDecisions)
        *static_cast<std::size_t*>(context) += values.size();
    };
    heard.node.set_tap_sink(TapSink(count, &shown));
    REQUIRE(heard.say(response(heard.seed, start, 90.0f, kLong)) == Status::kOk);
    CHECK(shown == 5 * 300);
    CHECK(heard.reports(90.0f));
    REQUIRE(heard.say(response(heard.seed, start, 320.0f, kLong)) == Status::kOk);
    CHECK_FALSE(heard.reports(320.0f));
  }
}

TEST_CASE("GIVEN a receiver in trouble THEN each response is counted once and the next good one is judged") {
  Heard heard;
  heard.settle(200);
  REQUIRE(heard.say(std::vector<float>(kSamples, -3.0f)) == Status::kOk);
  CHECK(heard.report.detections.empty());
  std::vector<float> saturated = response(1, 200, 90.0f);
  for (float& sample : saturated) sample = std::clamp(20.0f * sample, -8000.0f, 8000.0f);
  REQUIRE(heard.say(saturated) == Status::kOk);
  CHECK(heard.report.detections.empty());
  std::vector<float> broken = response(2, 200, 90.0f);
  broken[17] = std::nanf("");
  CHECK(heard.say(broken) == Status::kInvalidInput);
  CHECK_FALSE(heard.node.report_ready());
  const node::ThroughWallNodeCounters& counted = heard.node.counters();
  CHECK(counted.dead_responses == 1);
  CHECK(counted.saturated_responses == 1);
  CHECK(counted.rejected_responses == 1);
  CHECK(counted.responses == kSettled + 2);
  CHECK(counted.settling_responses == kSettled);
  REQUIRE(heard.say(response(heard.seed, 200, 90.0f)) == Status::kOk);
  CHECK(heard.reports(90.0f));
}

TEST_CASE(
    "GIVEN a sink or one for marks WHEN a response is processed THEN every stage shows itself once, in its "
    "order") {
  const std::vector<TapId> order{
      TapId::kScan,     TapId::kTimeZero,  TapId::kRotated,      TapId::kSubtracted,   TapId::kEnvelope,
      TapId::kEnhanced, TapId::kDecisions, TapId::kTargetTraces, TapId::kLeadingEdges, TapId::kDetections};
  struct Seen {
    std::vector<TapId> taps;
    std::size_t values = 0;
  };
  const TapFunction record = [](void* context, TapId tap, Span<const float> values) {
    static_cast<Seen*>(context)->taps.push_back(tap);
    static_cast<Seen*>(context)->values += values.size();
  };
  for (const bool marks : {false, true}) {
    for (const int settled : {3, kSettled}) {  // whether or not it is judged
      Heard heard;
      heard.settle(200, settled);
      Seen seen;
      heard.node.set_tap_sink(marks ? TapSink::marks(record, &seen) : TapSink(record, &seen));
      REQUIRE(heard.say(response(heard.seed, 200, 90.0f)) == Status::kOk);
      CHECK(seen.taps == order);
      CHECK((seen.values == 0) == marks);
    }
  }
}

TEST_CASE("GIVEN an impossible configuration THEN it is named and the earlier one stays in force") {
  Heard heard;
  heard.settle(200);
  ThroughWallNodeConfig bad;
  bad.clutter.method = node::ClutterMethod::kEmptyRoomEnvelope;
  CHECK(std::string(invalid_field(bad)) == "clutter.method");
  CHECK(heard.node.configure(bad) == Status::kInvalidConfig);
  CHECK(heard.node.ready());
  REQUIRE(heard.say(response(heard.seed, 200, 90.0f)) == Status::kOk);
  CHECK(heard.reports(90.0f));
}
