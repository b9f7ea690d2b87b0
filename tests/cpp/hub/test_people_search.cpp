#include <doctest/doctest.h>

#include <algorithm>
#include <array>

#include "echofuse/hub/track/people_likelihood.hpp"
#include "echofuse/hub/track/people_search.hpp"

namespace {

using namespace echofuse;
using namespace echofuse::hub;
using Filter = estimation::ConstantVelocityFilter<2>;

constexpr float kBodyRadius_m = 0.18f;
const std::array<NodeSite, 6> kNodes{{{1, {5.75f, 0.0f}, {0.0f, 1.5f}},
                                      {2, {5.75f, 0.0f}, {1.9f, 6.0f}},
                                      {3, {5.75f, 0.0f}, {5.75f, 6.0f}},
                                      {4, {5.75f, 0.0f}, {9.6f, 6.0f}},
                                      {5, {5.75f, 0.0f}, {11.5f, 4.5f}},
                                      {6, {5.75f, 0.0f}, {11.5f, 1.0f}}}};

/// People who stand still, and whom every node detects where they are.
struct Room {
  explicit Room(std::initializer_list<Point> people) {
    config.visible_path_m = config.nearest_path_m = -1.0f;
    likelihood.configure(config, kBodyRadius_m, {kNodes.data(), kNodes.size()});
    search.configure(config);
    BoundedVector<FrameDetection, kMaxFrameDetections> detections;
    for (std::size_t node = 0; node < kNodes.size(); ++node) {
      std::array<float, 4> paths{};
      std::size_t n = 0;
      for (const Point& p : people)
        paths[n++] = path_length(p, kNodes[node].tx, kNodes[node].rx, kBodyRadius_m);
      std::sort(paths.begin(), paths.begin() + static_cast<std::ptrdiff_t>(n));
      for (std::size_t i = 0; i < n; ++i)
        REQUIRE(detections.try_push_back({static_cast<int>(node), paths[i], 10.0f}));
    }
    for (int k = 0; k < config.window_frames; ++k) likelihood.add_frame(detections.span(), 0.1f);
  }

  /// Somebody who was at a place in all frames.
  Trail trail(const Point& at) const {
    Trail made;
    const Filter filter({at.x_m, 0.0f, at.y_m, 0.0f}, 1e-4f * Filter::Covariance::Identity());
    likelihood.lay(filter, 1, made);
    return made;
  }

  RangeTrackerConfig config;
  PeopleLikelihood likelihood;
  PeopleSearch search;
};

const Point kLeft{3.0f, 2.5f};
const Point kRight{8.5f, 3.5f};
const Point kNobody{6.5f, 4.8f};

}  // namespace

TEST_CASE("Those who are there explain the detections best") {
  const Room room({kLeft, kRight});
  const Trail left = room.trail(kLeft);
  const Trail right = room.trail(kRight);
  const Trail ghost = room.trail(kNobody);
  const std::array<const Trail*, 3> all{&left, &right, &ghost};
  const std::array<const Trail*, 2> wrong{&left, &ghost};
  const float both = room.likelihood.score({all.data(), 2});
  CHECK(both > room.likelihood.score({all.data(), 1}));
  CHECK(both > room.likelihood.score({all.data(), 3}));
  CHECK(both > room.likelihood.score({wrong.data(), 2}));
  CHECK(both > room.likelihood.score({}));
}

TEST_CASE("The order of the people does not matter") {
  const Room room({kLeft, kRight});
  const Trail left = room.trail(kLeft);
  const Trail right = room.trail(kRight);
  const std::array<const Trail*, 2> one{&left, &right};
  const std::array<const Trail*, 2> other{&right, &left};
  CHECK(room.likelihood.score({one.data(), 2}) ==
        doctest::Approx(room.likelihood.score({other.data(), 2})).epsilon(1e-5));
}

TEST_CASE("People join who explain what nobody does, and a ghost gives way") {
  Room room({kLeft, kRight});
  const Trail left = room.trail(kLeft);
  const Trail right = room.trail(kRight);
  const Trail ghost = room.trail(kNobody);
  std::array<bool, 3> there{};
  const std::array<Candidate, 3> newcomers{{{&left, false}, {&ghost, false}, {&right, false}}};
  room.search.process(room.likelihood, {newcomers.data(), 3}, {there.data(), 3});
  CHECK(there == std::array<bool, 3>{true, false, true});
  const std::array<Candidate, 3> mistaken{{{&ghost, true}, {&left, false}, {&right, false}}};
  room.search.process(room.likelihood, {mistaken.data(), 3}, {there.data(), 3});
  CHECK(there == std::array<bool, 3>{false, true, true});
}

TEST_CASE("A detection is claimed by the nearer of two") {
  const Room room({kLeft});
  const Trail left = room.trail(kLeft);
  const Trail beside = room.trail({kLeft.x_m + 0.2f, kLeft.y_m + 0.1f});
  const std::array<const Trail*, 2> people{&beside, &left};
  const std::array<float, 2> stds_m{0.12f, 0.12f};
  std::array<PeopleLikelihood::Claim, 2> claims;
  room.likelihood.claim({people.data(), 2}, {stds_m.data(), 2}, 4, {claims.data(), 2});
  CHECK(claims[0].detection == -1);
  CHECK(claims[1].detection == 0);
  CHECK(claims[1].sureness > 0.9f);
}
