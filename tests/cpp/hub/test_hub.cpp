#include "echofuse/hub/hub.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "echofuse/core/constants.hpp"

namespace {

using namespace echofuse;
using namespace echofuse::hub;

SensorRadarHubConfig room() {
  SensorRadarHubConfig config;
  config.n_nodes = 4;
  config.area = {0.0f, 0.0f, 4.0f, 4.0f};
  const Point corners[] = {{0.0f, 0.0f}, {4.0f, 0.0f}, {4.0f, 4.0f}, {0.0f, 4.0f}};
  for (std::size_t i = 0; i < 4; ++i) config.nodes[i] = {101 + static_cast<int>(i), corners[i], corners[i]};
  return config;
}

/// Reports of all nodes on one person; returns what poll said.
bool walk(SensorRadarHub& hub, const SensorRadarHubConfig& config, const Point& person, std::uint32_t frame,
          std::int64_t now_us, link::Tracks& tracks) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(config.n_nodes); ++i) {
    link::Detections report;
    report.node_id = config.nodes[i].node_id;
    report.frame = frame;
    const float path = path_length(person, config.nodes[i].tx, config.nodes[i].rx, 0.0f);
    REQUIRE(report.detections.try_push_back({path / kSpeedOfLight_mps, 20.0f}));
    REQUIRE(hub.receive(report, now_us) == Status::kOk);
  }
  bool closed = false;
  REQUIRE(hub.poll(now_us, tracks, closed) == Status::kOk);
  return closed;
}

}  // namespace

TEST_CASE("A walking person becomes one confirmed track, with either tracker") {
  for (const Tracker tracker : {Tracker::kPhd, Tracker::kKalman}) {
    SensorRadarHubConfig config = room();
    config.tracker = tracker;
    config.phd.area_m2 = 16.0f;
    const auto hub = std::make_unique<SensorRadarHub>();
    REQUIRE(hub->configure(config) == Status::kOk);
    link::Tracks tracks;
    Point person{1.0f, 1.5f};
    for (std::uint32_t frame = 0; frame < 20; ++frame) {
      person.x_m += 0.1f;
      REQUIRE(walk(*hub, config, person, frame, 100000 * static_cast<std::int64_t>(frame), tracks));
    }
    REQUIRE(tracks.tracks.size() == 1);
    CHECK(tracks.tracks[0].state == link::TrackState::kConfirmed);
    CHECK(std::fabs(tracks.tracks[0].x_m - person.x_m) < 0.15f);
    CHECK(std::fabs(tracks.tracks[0].y_m - person.y_m) < 0.15f);
    CHECK(tracks.frame == 19);
    CHECK(hub->counters().reports.accepted == 80);
    CHECK(hub->counters().clock_faults == 0);

    hub->reset();
    CHECK(hub->counters().reports.accepted == 0);
    REQUIRE(walk(*hub, config, person, 0, 0, tracks));
    for (const link::Track& track : tracks.tracks) CHECK(track.state == link::TrackState::kUnconfirmed);
  }
}

TEST_CASE("A missing node holds a frame until its deadline") {
  const SensorRadarHubConfig config = room();
  const auto hub = std::make_unique<SensorRadarHub>();
  REQUIRE(hub->configure(config) == Status::kOk);
  link::Detections report;
  report.node_id = 102;
  link::Tracks tracks;
  bool closed = true;
  REQUIRE(hub->receive(report, 1000) == Status::kOk);
  REQUIRE(hub->poll(1000 + config.frame_assembler.deadline_us - 1, tracks, closed) == Status::kOk);
  CHECK_FALSE(closed);
  REQUIRE(hub->poll(1000 + config.frame_assembler.deadline_us, tracks, closed) == Status::kOk);
  CHECK(closed);
  CHECK(hub->counters().reports.lost == 3);
}

TEST_CASE("Bad reports are refused and counted") {
  const auto hub = std::make_unique<SensorRadarHub>();
  link::Detections report;
  CHECK(hub->receive(report, 0) == Status::kNotConfigured);
  REQUIRE(hub->configure(room()) == Status::kOk);
  report.node_id = 7;
  CHECK(hub->receive(report, 0) == Status::kInvalidInput);
  report.node_id = 101;
  REQUIRE(report.detections.try_push_back({std::numeric_limits<float>::quiet_NaN(), 1.0f}));
  CHECK(hub->receive(report, 0) == Status::kInvalidInput);
  CHECK(hub->counters().reports.unknown_node == 1);
  CHECK(hub->counters().reports.malformed == 1);
}

TEST_CASE("An impossible site is refused by name") {
  const auto hub = std::make_unique<SensorRadarHub>();
  const auto refused = [&](const SensorRadarHubConfig& config) {
    CHECK(hub->configure(config) == Status::kInvalidConfig);
    return doctest::String(invalid_field(config));
  };
  SensorRadarHubConfig few = room();
  few.n_nodes = 2;
  CHECK(refused(few) == "n_nodes");
  SensorRadarHubConfig together = room();
  together.nodes[1].tx = together.nodes[1].rx = together.nodes[0].rx;
  CHECK(refused(together) == "nodes");
  SensorRadarHubConfig twins = room();
  twins.nodes[1].node_id = twins.nodes[0].node_id;
  CHECK(refused(twins) == "nodes");
  SensorRadarHubConfig line = room();
  for (std::size_t i = 0; i < 4; ++i) line.nodes[i].tx = line.nodes[i].rx = {static_cast<float>(i), 2.0f};
  CHECK(refused(line) == "nodes");
  line.area = {0.0f, 2.0f, 4.0f, 4.0f};  // beside the line: the mirror image is outside
  CHECK(hub->configure(line) == Status::kOk);
  SensorRadarHubConfig flat = room();
  flat.area.max_y_m = flat.area.min_y_m;
  CHECK(refused(flat) == "area");
}

TEST_CASE("The hub fits into 256 KiB") { CHECK(sizeof(SensorRadarHub) < 256 * 1024); }
