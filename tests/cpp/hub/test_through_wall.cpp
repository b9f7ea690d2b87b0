#include "echofuse/hub/through_wall.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "echofuse/core/constants.hpp"
#include "echofuse/core/random.hpp"

namespace {

using namespace echofuse;
using namespace echofuse::hub;

ThroughWallHubConfig line(int n_nodes) {
  ThroughWallHubConfig config;
  config.n_nodes = n_nodes;
  config.area = {-2.35f, 0.48f, 2.35f, 6.1f};
  for (int i = 0; i < n_nodes; ++i) {
    const float x_m = -0.4f + 0.8f * static_cast<float>(i) / static_cast<float>(n_nodes - 1);
    config.nodes[static_cast<std::size_t>(i)] = {10 + i, {}, {x_m + (x_m == 0.0f ? 0.05f : 0.0f), 0.0f}};
  }
  return config;
}

float path_to(const ThroughWallHubConfig& config, std::size_t node, const Point& person) {
  Wall wall;
  REQUIRE(wall.configure(config.line_locator.wall) == Status::kOk);
  return antenna_ray(wall, person, 0.0f).optical_m +
         antenna_ray(wall, person, config.nodes[node].rx.x_m).optical_m - 2.0f * config.body_radius_m;
}

}  // namespace

TEST_CASE("A person behind the wall becomes one confirmed track, whichever way the traces are paired") {
  for (const bool track_aided : {true, false}) {
    ThroughWallHubConfig config = line(2);
    config.track_aided = track_aided;
    const auto hub = std::make_unique<ThroughWallHub>();
    REQUIRE(hub->configure(config) == Status::kOk);
    link::Tracks tracks;
    Point person{0.6f, 2.0f};
    for (std::uint32_t frame = 0; frame < 20; ++frame) {
      const std::int64_t now_us = 74000 * static_cast<std::int64_t>(frame);
      person.y_m += 0.07f;
      for (std::size_t i = 0; i < 2; ++i) {
        link::Detections report;
        report.node_id = config.nodes[i].node_id;
        report.frame = frame;
        REQUIRE(report.detections.try_push_back({path_to(config, i, person) / kSpeedOfLight_mps, 6.0f}));
        REQUIRE(hub->receive(report, now_us) == Status::kOk);
      }
      bool closed = false;
      REQUIRE(hub->poll(now_us, tracks, closed) == Status::kOk);
      REQUIRE(closed);
    }
    REQUIRE(tracks.tracks.size() == 1);
    CHECK(tracks.tracks[0].state == link::TrackState::kConfirmed);
    CHECK(std::fabs(tracks.tracks[0].x_m - person.x_m) < 0.1f);
    CHECK(std::fabs(tracks.tracks[0].y_m - person.y_m) < 0.1f);
  }
}

TEST_CASE("Full reports of many receivers are cut where that is counted") {
  for (const int n_nodes : {2, 5, 8}) {
    const ThroughWallHubConfig config = line(n_nodes);
    const auto hub = std::make_unique<ThroughWallHub>();
    REQUIRE(hub->configure(config) == Status::kOk);
    Pcg32 random(17);
    link::Tracks tracks;
    bool cut = false;
    for (std::uint32_t frame = 0; frame < 40; ++frame) {
      const std::int64_t now_us = 74000 * static_cast<std::int64_t>(frame);
      for (int i = 0; i < n_nodes; ++i) {
        std::array<float, kMaxDetectionsPerNode> path_m{};
        for (float& path : path_m) path = 2.0f + 10.0f * random.uniform();
        std::sort(path_m.begin(), path_m.end());
        link::Detections report;
        report.node_id = 10 + i;
        report.frame = frame;
        for (const float path : path_m)
          REQUIRE(report.detections.try_push_back({path / kSpeedOfLight_mps, 5.0f}));
        REQUIRE(hub->receive(report, now_us) == Status::kOk);
      }
      bool closed = false;
      const Status status = hub->poll(now_us, tracks, closed);
      REQUIRE(closed);
      cut = cut || status == Status::kTruncated;
      for (const link::Track& track : tracks.tracks) CHECK(std::isfinite(track.x_m + track.y_m));
    }
    const ThroughWallHubCounters counted = hub->counters();
    CHECK(counted.reports.frames == 40);
    CHECK(cut == (counted.dropped_combinations + counted.dropped_points + counted.dropped_births > 0));
  }
}
