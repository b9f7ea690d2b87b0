#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "echofuse/hub/track/range_tracker.hpp"

namespace {

using namespace echofuse;
using namespace echofuse::hub;

const std::array<NodeSite, 6> kNodes{{{1, {5.75f, 0.0f}, {0.0f, 1.5f}},
                                      {2, {5.75f, 0.0f}, {1.9f, 6.0f}},
                                      {3, {5.75f, 0.0f}, {5.75f, 6.0f}},
                                      {4, {5.75f, 0.0f}, {9.6f, 6.0f}},
                                      {5, {5.75f, 0.0f}, {11.5f, 4.5f}},
                                      {6, {5.75f, 0.0f}, {11.5f, 1.0f}}}};
const Area kArea{0.0f, 0.0f, 11.5f, 6.0f};

void configure(RangeTracker& tracker) {
  RangeTrackerConfig config;
  config.visible_path_m = config.nearest_path_m = -1.0f;  // every node sees everybody
  REQUIRE(tracker.configure(config, 0.18f, {kNodes.data(), kNodes.size()}, kArea) == Status::kOk);
}

/// Exact paths of everybody, each node's in order.
void see(Span<const Point> people, BoundedVector<FrameDetection>& detections) {
  detections.clear();
  for (std::size_t node = 0; node < kNodes.size(); ++node) {
    std::array<float, 4> paths{};
    std::size_t n = 0;
    for (const Point& p : people) paths[n++] = path_length(p, kNodes[node].tx, kNodes[node].rx, 0.18f);
    std::sort(paths.begin(), paths.begin() + static_cast<std::ptrdiff_t>(n));
    for (std::size_t i = 0; i < n; ++i)
      REQUIRE(detections.try_push_back({static_cast<int>(node), paths[i], 10.0f}));
  }
}

}  // namespace

TEST_CASE("Three walking people become three confirmed tracks where they are") {
  RangeTracker tracker;
  configure(tracker);
  BoundedVector<FrameDetection, kMaxFrameDetections> detections;
  link::Tracks tracks;
  std::array<Point, 3> people;
  for (int k = 0; k < 25; ++k) {
    const float t = 0.1f * static_cast<float>(k);
    people = {Point{8.8f - 1.4f * t, 2.6f}, Point{2.8f + 1.3f * t, 4.5f}, Point{3.1f + 1.0f * t, 1.0f}};
    see({people.data(), people.size()}, detections);
    (void)tracker.process(detections.span(), 0.1f, tracks);
  }
  int confirmed = 0;
  for (const link::Track& track : tracks.tracks) {
    if (track.state != link::TrackState::kConfirmed) continue;
    ++confirmed;
    float nearest = 1e9f;
    for (const Point& p : people)
      nearest = std::min(nearest, std::hypot(track.x_m - p.x_m, track.y_m - p.y_m));
    CHECK(nearest < 0.15f);
  }
  CHECK(confirmed == 3);
}

TEST_CASE("Whoever leaves ends, and nobody makes no track") {
  RangeTracker tracker;
  configure(tracker);
  BoundedVector<FrameDetection, kMaxFrameDetections> detections;
  link::Tracks tracks;
  for (int k = 0; k < 20; ++k) {
    const std::array<Point, 1> person{{{4.0f + 0.1f * static_cast<float>(k), 3.0f}}};
    see({person.data(), 1}, detections);
    CHECK(tracker.process(detections.span(), 0.1f, tracks) == Status::kOk);
  }
  REQUIRE(tracks.tracks.size() >= 1);
  CHECK(tracks.tracks[0].state == link::TrackState::kConfirmed);
  for (int k = 0; k < 100; ++k) CHECK(tracker.process({}, 0.1f, tracks) == Status::kOk);
  CHECK(tracks.tracks.empty());
}
