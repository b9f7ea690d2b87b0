#include "echofuse/hub/through_wall_3d.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "echofuse/core/constants.hpp"
#include "echofuse/core/random.hpp"

namespace {

using namespace echofuse;
using namespace echofuse::hub;

constexpr float kSpacing_m = 0.39f;
constexpr std::int64_t kPeriod_us = 74000;
const Point3 kTx{0.2f, -0.1f, 1.1f};

ThroughWall3dHubConfig cross() {
  ThroughWall3dHubConfig config;
  config.area = {-2.5f, 0.5f, -0.5f, 2.5f, 7.0f, 3.5f};
  const Point3 arms[] = {{-kSpacing_m, 0, 0}, {kSpacing_m, 0, 0}, {0, 0, -kSpacing_m}, {0, 0, kSpacing_m}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Point3 rx{kTx.x_m + arms[i].x_m, kTx.y_m, kTx.z_m + arms[i].z_m};
    config.nodes[i] = {20 + static_cast<std::int32_t>(i), kTx, rx};
  }
  return config;
}

Point3 from_tx(const Point3& a) { return {a.x_m - kTx.x_m, a.y_m - kTx.y_m, a.z_m - kTx.z_m}; }

/// As a round person's skin reflects it, before the wall of the configuration.
float delay_to(const ThroughWall3dHubConfig& config, std::size_t node, const Point3& person) {
  Wall wall;
  REQUIRE(wall.configure(config.taylor_3d.wall) == Status::kOk);
  const Point3 at = from_tx(person);
  const float path_m = antenna_ray_3d(wall, at, {}).optical_m +
                       antenna_ray_3d(wall, at, from_tx(config.nodes[node].rx)).optical_m;
  return (path_m - 2.0f * config.body_radius_m) / kSpeedOfLight_mps;
}

Status send(ThroughWall3dHub& hub, std::int32_t node_id, std::uint32_t frame, Span<const float> delay_s) {
  link::Detections report;
  report.node_id = node_id;
  report.frame = frame;
  for (const float delay : delay_s) REQUIRE(report.detections.try_push_back({delay, 6.0f}));
  return hub.receive(report, kPeriod_us * frame);
}

bool named(const ThroughWall3dHubConfig& config, const char* field) {
  const char* invalid = invalid_field(config);
  ThroughWall3dHub hub;
  return invalid != nullptr && std::strcmp(invalid, field) == 0 && hub.configure(config) != Status::kOk;
}

}  // namespace

TEST_CASE("A person on the stairs becomes one confirmed track, whichever way the traces are paired") {
  for (const bool track_aided : {true, false}) {
    ThroughWall3dHubConfig config = cross();
    config.track_aided = track_aided;
    const auto hub = std::make_unique<ThroughWall3dHub>();
    REQUIRE(hub->configure(config) == Status::kOk);
    link::Tracks tracks;
    Point3 person{-0.8f, 3.0f, 0.4f};
    for (std::uint32_t frame = 0; frame < 25; ++frame) {
      const std::int64_t now_us = kPeriod_us * frame;
      person.x_m += 0.04f;
      person.z_m += 0.03f;
      for (std::size_t i = 0; i < 4; ++i) {
        const float delay_s[] = {delay_to(config, i, person)};
        REQUIRE(send(*hub, config.nodes[i].node_id, frame, delay_s) == Status::kOk);
      }
      bool closed = false;
      REQUIRE(hub->poll(now_us, tracks, closed) == Status::kOk);
      REQUIRE(closed);
    }
    REQUIRE(tracks.tracks.size() == 1);
    const link::Track& track = tracks.tracks[0];
    CHECK(track.state == link::TrackState::kConfirmed);
    CHECK(std::fabs(track.x_m - person.x_m) < 0.12f);
    CHECK(std::fabs(track.y_m - person.y_m) < 0.12f);
    CHECK(std::fabs(track.z_m - person.z_m) < 0.12f);
    CHECK(track.vz_mps > 0.2f);
    CHECK(track.covariance_zz_m2 > 0.0f);
    const ThroughWall3dHubCounters counted = hub->counters();
    CHECK(counted.quads >= 1);
    CHECK(counted.couples == 2 * counted.quads);
    CHECK(counted.unlocated + counted.outside_area + counted.clipped == 0);
  }
}

TEST_CASE("What is no cross, no room behind it, or no way to locate is named") {
  CHECK(invalid_field(cross()) == nullptr);
  CHECK(named({}, "nodes"));
  ThroughWall3dHubConfig config = cross();
  config.n_nodes = 3;
  CHECK(named(config, "n_nodes"));

  config = cross();
  config.nodes[1].rx.z_m += 0.002f;
  CHECK(named(config, "nodes"));
  config.nodes[1].rx.z_m -= 0.0015f;  // half a millimetre is allowed
  CHECK(invalid_field(config) == nullptr);
  config = cross();
  config.nodes[3].rx.y_m += 0.1f;
  CHECK(named(config, "nodes"));
  config = cross();
  std::swap(config.nodes[0].rx, config.nodes[1].rx);
  CHECK(named(config, "nodes"));
  config = cross();
  config.nodes[2].tx.x_m += 0.1f;  // two transmitters
  CHECK(named(config, "nodes"));
  config = cross();
  config.nodes[2].node_id = config.nodes[0].node_id;
  CHECK(named(config, "nodes"));
  config = cross();
  config.nodes[2].rx.z_m = std::numeric_limits<float>::quiet_NaN();
  CHECK(named(config, "nodes"));

  config = cross();
  config.area.min_y_m = -0.2f;  // before the antennas
  CHECK(named(config, "area"));
  config = cross();
  config.area.max_z_m = config.area.min_z_m;
  CHECK(named(config, "area"));
  config = cross();
  config.body_radius_m = 2.5f;  // nobody fits in
  CHECK(named(config, "body_radius_m"));
  config = cross();
  config.range_difference_m = 0.0f;
  CHECK(named(config, "range_difference_m"));
  config = cross();
  config.taylor_3d.start = Taylor3dStart::kGiven;  // by whom?
  CHECK(named(config, "taylor_3d"));
  config = cross();
  config.path_std_m = 0.0f;
  CHECK(named(config, "path_std_m"));
  config = cross();
  config.path_tracker.body_half_height_m = -1.0f;
  CHECK(named(config, "path_tracker"));
}

TEST_CASE("A failed configure leaves the earlier one in force, and an unconfigured hub says so") {
  const auto hub = std::make_unique<ThroughWall3dHub>();
  link::Tracks tracks;
  bool closed = true;
  CHECK(send(*hub, 20, 0, {}) == Status::kNotConfigured);
  CHECK(hub->poll(0, tracks, closed) == Status::kNotConfigured);
  CHECK_FALSE(closed);
  REQUIRE(hub->configure(cross()) == Status::kOk);
  CHECK(hub->configure({}) == Status::kInvalidConfig);
  CHECK(send(*hub, 20, 0, {}) == Status::kOk);
}

TEST_CASE("Malformed reports are refused and counted, and reports of nothing make frames of nothing") {
  const ThroughWall3dHubConfig config = cross();
  const auto hub = std::make_unique<ThroughWall3dHub>();
  REQUIRE(hub->configure(config) == Status::kOk);
  const float bad_s[] = {std::numeric_limits<float>::quiet_NaN()};
  CHECK(send(*hub, 20, 0, bad_s) == Status::kInvalidInput);
  CHECK(send(*hub, 99, 0, {}) == Status::kInvalidInput);

  link::Tracks tracks;
  for (std::uint32_t frame = 0; frame < 3; ++frame) {
    for (const NodeSite3d& node : config.nodes) REQUIRE(send(*hub, node.node_id, frame, {}) == Status::kOk);
    bool closed = false;
    REQUIRE(hub->poll(kPeriod_us * frame, tracks, closed) == Status::kOk);
    CHECK(closed);
    CHECK(tracks.tracks.empty());
  }
  const ThroughWall3dHubCounters counted = hub->counters();
  CHECK(counted.reports.malformed == 1);
  CHECK(counted.reports.unknown_node == 1);
  CHECK(counted.reports.frames == 3);
  CHECK(counted.couples + counted.quads == 0);
}

TEST_CASE("Paths beyond every horizon are located nowhere") {
  ThroughWall3dHubConfig config = cross();
  config.frame_assembler.max_delay_s = 1.0f;
  const auto hub = std::make_unique<ThroughWall3dHub>();
  REQUIRE(hub->configure(config) == Status::kOk);
  const float delay_s[] = {0.01f};
  for (const NodeSite3d& node : config.nodes) REQUIRE(send(*hub, node.node_id, 0, delay_s) == Status::kOk);
  link::Tracks tracks;
  bool closed = false;
  REQUIRE(hub->poll(0, tracks, closed) == Status::kOk);
  CHECK(hub->counters().quads == 1);
  CHECK(hub->counters().unlocated == 1);
}

TEST_CASE("Full reports are cut where that is counted, and no quad is lost") {
  for (const PairingRule rule : {PairingRule::kAssignment, PairingRule::kAllPairs}) {
    for (const bool track_aided : {true, false}) {
      ThroughWall3dHubConfig config = cross();
      config.track_aided = track_aided;
      config.trace_pairing.rule = rule;
      const auto hub = std::make_unique<ThroughWall3dHub>();
      REQUIRE(hub->configure(config) == Status::kOk);
      Pcg32 random(17);
      link::Tracks tracks;
      bool cut = false;
      for (std::uint32_t frame = 0; frame < 40; ++frame) {
        const std::int64_t now_us = kPeriod_us * frame;
        for (const NodeSite3d& node : config.nodes) {
          std::array<float, kMaxDetectionsPerNode> delay_s{};
          for (float& delay : delay_s) delay = (0.3f + 12.0f * random.uniform()) / kSpeedOfLight_mps;
          std::sort(delay_s.begin(), delay_s.end());
          REQUIRE(send(*hub, node.node_id, frame, delay_s) == Status::kOk);
        }
        bool closed = false;
        const Status status = hub->poll(now_us, tracks, closed);
        REQUIRE(closed);
        cut = cut || status == Status::kTruncated;
        for (const link::Track& track : tracks.tracks)
          CHECK(std::isfinite(track.x_m + track.y_m + track.z_m));
      }
      const ThroughWall3dHubCounters counted = hub->counters();
      CHECK(counted.reports.frames == 40);
      CHECK(counted.quads > 0);
      CHECK(cut == (counted.dropped_combinations + counted.dropped_points + counted.dropped_births > 0));
      CHECK(counted.unlocated + counted.outside_area <= counted.quads);
    }
  }
}
