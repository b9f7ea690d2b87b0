#include "echofuse/node/node.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "echofuse/core/random.hpp"

using namespace echofuse;
using node::SensorRadarNode;
using node::SensorRadarNodeConfig;

namespace {

constexpr int kSamples = 900;

void add_pulse(std::vector<float>& scan, float place, float amplitude) {
  for (std::size_t k = 0; k < scan.size(); ++k) {
    const float x = static_cast<float>(k) - place;
    scan[k] += amplitude * std::exp(-0.02f * x * x) * std::cos(1.65f * x);
  }
}

/// Direct path at 400, walls, and a person when `person` > 0.
std::vector<float> scan_of(std::uint64_t seed, float person) {
  Pcg32 random(seed, 9);
  std::vector<float> scan(kSamples);
  for (float& sample : scan) sample = 3.0f * random.normal();
  add_pulse(scan, 400.0f, 3000.0f);
  add_pulse(scan, 520.0f, 800.0f);
  if (person > 0.0f) add_pulse(scan, person, 300.0f);
  return scan;
}

SensorRadarNodeConfig config_of() {
  SensorRadarNodeConfig config;
  config.node_id = 7;
  config.n_samples = kSamples;
  config.baseline_m = 5.0f;
  return config;
}

Span<const float> view(const std::vector<float>& scan) { return {scan.data(), scan.size()}; }

struct Seen {
  int taps = 0;
  int last = -1;
  bool in_order = true;
};

}  // namespace

TEST_CASE("a node fits its budget") { CHECK(sizeof(SensorRadarNode) <= 80 * 1024); }

TEST_CASE("GIVEN an empty room WHEN a person comes THEN the report says where, frame by frame") {
  SensorRadarNode node;
  link::Detections report;
  CHECK(node.process(view(scan_of(1, 0.0f)), 0, report) == Status::kNotConfigured);
  REQUIRE(node.configure(config_of()) == Status::kOk);
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    REQUIRE(node.set_empty_room(view(scan_of(seed, 0.0f))) == Status::kOk);
  for (std::uint32_t frame = 0; frame < 5; ++frame) {
    const float person = 620.0f + 10.0f * static_cast<float>(frame);
    REQUIRE(node.process(view(scan_of(100 + frame, person)), 1000 * frame, report) == Status::kOk);
    CHECK(node.report_ready());
    CHECK(report.node_id == 7);
    CHECK(report.frame == frame);
    CHECK(report.time_us == 1000 * frame);
    const float expected = 5.0f / 299792458.0f + (person - 400.0f) / 16.384e9f;
    bool found = false;
    for (const link::Detection& detection : report.detections)
      found = found || std::abs(detection.delay_s - expected) < 16.0f / 16.384e9f;
    CHECK(found);
  }
  CHECK(node.counters().scans == 5);
}

TEST_CASE("GIVEN a sink WHEN a scan is processed THEN every tap comes once and in order") {
  SensorRadarNode node;
  REQUIRE(node.configure(config_of()) == Status::kOk);
  REQUIRE(node.set_empty_room(view(scan_of(1, 0.0f))) == Status::kOk);
  Seen seen;
  node.set_tap_sink({[](void* context, TapId tap, Span<const float>) {
                       Seen& state = *static_cast<Seen*>(context);
                       state.in_order = state.in_order && static_cast<int>(tap) > state.last;
                       state.last = static_cast<int>(tap);
                       ++state.taps;
                     },
                     &seen});
  link::Detections report;
  REQUIRE(node.process(view(scan_of(2, 650.0f)), 0, report) == Status::kOk);
  CHECK(seen.taps == 10);
  CHECK(seen.in_order);
  CHECK(seen.last == static_cast<int>(TapId::kDetections));
}

TEST_CASE(
    "GIVEN a sink for marks WHEN a scan is processed THEN each stage ends with one, and no tap is prepared") {
  SensorRadarNode node;
  REQUIRE(node.configure(config_of()) == Status::kOk);
  REQUIRE(node.set_empty_room(view(scan_of(1, 0.0f))) == Status::kOk);
  struct Marks {
    std::vector<TapId> taps;
    std::size_t values = 0;
  } marks;
  node.set_tap_sink(TapSink::marks(
      [](void* context, TapId tap, Span<const float> values) {
        static_cast<Marks*>(context)->taps.push_back(tap);
        static_cast<Marks*>(context)->values += values.size();
      },
      &marks));
  link::Detections report;
  REQUIRE(node.process(view(scan_of(2, 650.0f)), 0, report) == Status::kOk);
  CHECK(marks.taps == std::vector<TapId>{TapId::kScan, TapId::kEnvelope, TapId::kDirectPath,
                                         TapId::kAlignment, TapId::kAligned, TapId::kResidual,
                                         TapId::kThreshold, TapId::kRangeClusters, TapId::kDetections});
  CHECK(marks.values == 0);
  CHECK_FALSE(report.detections.empty());
}

TEST_CASE("GIVEN a broken scan WHEN it is processed THEN it is counted and nothing else changes") {
  SensorRadarNode node;
  REQUIRE(node.configure(config_of()) == Status::kOk);
  link::Detections report;
  std::vector<float> scan = scan_of(3, 650.0f);
  scan[17] = std::nanf("");
  CHECK(node.process(view(scan), 0, report) == Status::kInvalidInput);
  CHECK(report.detections.empty());
  CHECK(node.process({scan.data(), 10}, 0, report) == Status::kInvalidInput);
  CHECK(node.counters().rejected_scans == 2);
  CHECK(node.counters().scans == 0);
  SensorRadarNodeConfig bad = config_of();
  bad.sample_rate_hz = std::nanf("");
  CHECK(node.configure(bad) == Status::kInvalidConfig);
  CHECK(node.counters().rejected_scans == 2);  // the earlier configuration stays in force
}

TEST_CASE("GIVEN more echoes than a report holds THEN the heaviest are kept and the others counted") {
  SensorRadarNodeConfig config = config_of();
  config.n_samples = static_cast<int>(kMaxSamplesPerScan);
  config.time_zero = node::TimeZero::kRecorded;
  config.baseline_m = 0.0f;
  config.alignment.method = signal::AlignmentMethod::kNone;
  config.cfar.global_factor = 0.2f;
  config.range_clusters.merge_distance_s = 2e-9f;
  config.range_clusters.min_weight = 1;
  SensorRadarNode node;
  REQUIRE(node.configure(config) == Status::kOk);
  std::vector<float> scan(kMaxSamplesPerScan);
  Pcg32 random(8, 8);
  for (float& sample : scan) sample = random.normal();
  REQUIRE(node.set_empty_room(view(scan)) == Status::kOk);
  for (int echo = 0; echo < 20; ++echo) add_pulse(scan, 90.0f + 90.0f * static_cast<float>(echo), 500.0f);
  link::Detections report;
  CHECK(node.process(view(scan), 0, report) == Status::kTruncated);
  CHECK(report.detections.size() == kMaxDetectionsPerNode);
  CHECK(node.counters().truncated_detections >= 4);
  for (std::size_t i = 1; i < report.detections.size(); ++i)
    CHECK(report.detections[i].delay_s > report.detections[i - 1].delay_s);
}
