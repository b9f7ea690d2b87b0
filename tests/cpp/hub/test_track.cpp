#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "echofuse/hub/track/kalman_tracker.hpp"
#include "echofuse/hub/track/phd_tracker.hpp"

namespace echofuse::hub {
namespace {

constexpr float kDt_s = 0.1f;

template <class Tracker>
Status feed(Tracker& tracker, int frame, link::Tracks& tracks) {
  const Eigen::Vector2f z{1.0f + 0.1f * static_cast<float>(frame), 2.0f};
  return tracker.process({&z, 1}, kDt_s, tracks);
}

struct TapCount {
  int calls = 0;
  std::size_t last_size = 0;
  static void count(void* context, TapId, Span<const float> values) {
    auto& self = *static_cast<TapCount*>(context);
    ++self.calls;
    self.last_size = values.size();
  }
};

}  // namespace

TEST_CASE("memory of a PHD tracker is what the limits say") {
  // 3,072 particles of 20 bytes and scratch of 24 KB.
  CHECK(sizeof(PhdTracker) < 100000);
  CHECK(sizeof(KalmanTracker<2>) < 8000);
  CHECK(sizeof(KalmanTracker<3>) < 11000);
}

TEST_CASE("a walking person becomes one confirmed track with the right velocity") {
  static PhdTracker phd;
  REQUIRE(phd.configure({}, {}, {}) == Status::kOk);
  KalmanTracker<2> kalman;
  REQUIRE(kalman.configure({}) == Status::kOk);
  link::Tracks by_phd;
  link::Tracks by_kalman;
  for (int frame = 0; frame < 40; ++frame) {
    REQUIRE(feed(phd, frame, by_phd) == Status::kOk);
    REQUIRE(feed(kalman, frame, by_kalman) == Status::kOk);
  }
  for (const link::Tracks* tracks : {&by_phd, &by_kalman}) {
    REQUIRE(tracks->tracks.size() == 1);
    const link::Track& track = tracks->tracks[0];
    CHECK(track.state == link::TrackState::kConfirmed);
    CHECK(track.x_m == doctest::Approx(4.9).epsilon(0.03));
    CHECK(track.vx_mps == doctest::Approx(1.0).epsilon(0.3));
    CHECK(std::fabs(track.vy_mps) < 0.3f);
  }
}

TEST_CASE("in space, one who climbs above another is another track, and climbs") {
  KalmanTracker<3> tracker;
  REQUIRE(tracker.configure({}) == Status::kOk);
  TapCount count;
  tracker.set_tap_sink({&TapCount::count, &count});
  link::Tracks tracks;
  for (int frame = 0; frame < 40; ++frame) {
    const std::array<Eigen::Vector3f, 2> measured{
        {{1.0f, 2.0f, 0.9f}, {1.0f, 2.0f, 2.5f + 0.05f * static_cast<float>(frame)}}};
    REQUIRE(tracker.process({measured.data(), measured.size()}, kDt_s, tracks) == Status::kOk);
  }
  REQUIRE(tracks.tracks.size() == 2);
  const link::Track& below = tracks.tracks[0];
  const link::Track& above = tracks.tracks[1];
  CHECK(below.state == link::TrackState::kConfirmed);
  CHECK(above.state == link::TrackState::kConfirmed);
  CHECK(below.z_m == doctest::Approx(0.9));
  CHECK(above.z_m == doctest::Approx(4.45).epsilon(0.02));
  CHECK(above.vz_mps == doctest::Approx(0.5).epsilon(0.2));
  CHECK(std::fabs(below.vz_mps) < 0.1f);
  CHECK(above.covariance_zz_m2 > 0.0f);
  CHECK(count.last_size == 9 * tracks.tracks.size());
}

TEST_CASE("reset gives the same tracks again") {
  static PhdTracker tracker;
  REQUIRE(tracker.configure({}, {}, {}) == Status::kOk);
  link::Tracks first;
  link::Tracks second;
  for (int frame = 0; frame < 12; ++frame) REQUIRE(feed(tracker, frame, first) == Status::kOk);
  tracker.reset();
  for (int frame = 0; frame < 12; ++frame) REQUIRE(feed(tracker, frame, second) == Status::kOk);
  REQUIRE(first.tracks.size() == 1);
  REQUIRE(second.tracks.size() == 1);
  CHECK(first.tracks[0].id == second.tracks[0].id);
  CHECK(first.tracks[0].x_m == second.tracks[0].x_m);
}

TEST_CASE("taps come once a frame, and none of a refused one") {
  static PhdTracker tracker;
  REQUIRE(tracker.configure({}, {}, {}) == Status::kOk);
  TapCount count;
  tracker.set_tap_sink({&TapCount::count, &count});
  link::Tracks tracks;
  REQUIRE(feed(tracker, 0, tracks) == Status::kOk);
  CHECK(count.calls == 5);
  CHECK(count.last_size == 7 * tracks.tracks.size());
  const Eigen::Vector2f bad{std::numeric_limits<float>::infinity(), 0.0f};
  CHECK(tracker.process({&bad, 1}, kDt_s, tracks) == Status::kInvalidInput);
  CHECK(tracker.process({}, 0.0f, tracks) == Status::kInvalidInput);
  CHECK(count.calls == 5);
}

TEST_CASE("an impossible configuration leaves all earlier ones in force") {
  static PhdTracker tracker;
  link::Tracks tracks;
  CHECK(feed(tracker, 0, tracks) == Status::kNotConfigured);
  REQUIRE(tracker.configure({}, {}, {}) == Status::kOk);
  for (int frame = 0; frame < 5; ++frame) REQUIRE(feed(tracker, frame, tracks) == Status::kOk);
  TrackManagerConfig bad;
  bad.confirm_updates = 0;
  CHECK(doctest::String(invalid_field(bad)) == "confirm_updates");
  CHECK(tracker.configure({}, {}, bad) == Status::kInvalidConfig);
  REQUIRE(feed(tracker, 5, tracks) == Status::kOk);
  REQUIRE(tracks.tracks.size() == 1);
  CHECK(tracks.tracks[0].id == 1);
}

TEST_CASE("with more births than room the rest is counted") {
  TrackManager<2> manager;
  REQUIRE(manager.configure({}) == Status::kOk);
  std::array<TrackEstimate<2>, kMaxTracks + 3> points;
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {{5.0f * static_cast<float>(i), 0.0f}, {0.0f, 0.0f}, 0.01f * Eigen::Matrix2f::Identity()};
  link::Tracks tracks;
  CHECK(manager.process({points.data(), points.size()}, kDt_s, tracks) == Status::kTruncated);
  CHECK(tracks.tracks.size() == kMaxTracks);
  CHECK(manager.dropped_births() == 3);
}

}  // namespace echofuse::hub
