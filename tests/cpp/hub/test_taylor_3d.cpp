#include "echofuse/hub/locate/taylor_3d.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>

namespace {

using namespace echofuse;
using namespace echofuse::hub;

constexpr float kSpacing_m = 0.39f;
const std::array<Point3, 4> kCross{{{-kSpacing_m, 0.0f, 0.0f},
                                    {kSpacing_m, 0.0f, 0.0f},
                                    {0.0f, 0.0f, -kSpacing_m},
                                    {0.0f, 0.0f, kSpacing_m}}};
constexpr std::array<float, 4> kVariance_m2{1e-4f, 1e-4f, 1e-4f, 1e-4f};
constexpr Point3 kPerson{0.8f, 3.8f, -0.4f};

double distance_m(const Point3& a, const Point3& b) {
  return std::hypot(double{a.x_m} - b.x_m, double{a.y_m} - b.y_m, double{a.z_m} - b.z_m);
}

std::array<float, 4> paths_of(const Point3& person) {
  std::array<float, 4> path_m;
  for (std::size_t i = 0; i < 4; ++i)
    path_m[i] = static_cast<float>(distance_m(person, {}) + distance_m(person, kCross[i]));
  return path_m;
}

Taylor3dConfig in_the_open() {
  Taylor3dConfig config;
  config.wall.compensation = WallCompensation::kNone;
  return config;
}

}  // namespace

TEST_CASE("Exact paths give the place back from either start") {
  for (const Taylor3dStart from : {Taylor3dStart::kThreeDTwoD, Taylor3dStart::kApproximate}) {
    Taylor3d taylor;
    Taylor3dConfig config = in_the_open();
    config.start = from;
    REQUIRE(taylor.configure(config, {}, kCross) == Status::kOk);
    Taylor3dFix fix;
    REQUIRE(taylor.process(paths_of(kPerson), kVariance_m2, {}, fix) == Status::kOk);
    CHECK(fix.status == Taylor3dStatus::kConverged);
    CHECK(distance_m(fix.position, kPerson) < 1e-4);
    CHECK(fix.covariance_m2[0] > 0.0f);
  }
}

TEST_CASE("Each of the paper's rules stops it and is named") {
  Taylor3d taylor;
  Taylor3dConfig config = in_the_open();
  config.start = Taylor3dStart::kGiven;
  Taylor3dFix fix;
  REQUIRE(taylor.configure(config, {}, kCross) == Status::kOk);
  const std::array<float, 4> path_m = paths_of(kPerson);
  REQUIRE(taylor.process(path_m, kVariance_m2, {0.5f, 3.5f, 0.0f}, fix) == Status::kOk);
  CHECK(fix.status == Taylor3dStatus::kConverged);

  config.max_iterations = 1;
  REQUIRE(taylor.configure(config, {}, kCross) == Status::kOk);
  REQUIRE(taylor.process(path_m, kVariance_m2, {0.5f, 3.5f, 0.0f}, fix) == Status::kOk);
  CHECK(fix.status == Taylor3dStatus::kIterationLimit);
  CHECK(fix.iterations == 1);

  config.max_iterations = 0;
  REQUIRE(taylor.configure(config, {}, kCross) == Status::kOk);
  REQUIRE(taylor.process(path_m, kVariance_m2, {0.5f, 3.5f, 0.0f}, fix) == Status::kOk);
  CHECK(fix.status == Taylor3dStatus::kIterationLimit);
  CHECK(fix.iterations == 0);
  CHECK(distance_m(fix.position, {0.5f, 3.5f, 0.0f}) == 0.0);
  CHECK(fix.covariance_m2[0] > 0.0f);

  config = in_the_open();  // a path shorter than the direct one: no place explains it
  std::array<float, 4> impossible = path_m;
  impossible[0] = 0.1f;
  REQUIRE(taylor.configure(config, {}, kCross) == Status::kOk);
  REQUIRE(taylor.process(impossible, kVariance_m2, {}, fix) == Status::kOk);
  CHECK(fix.clipped_start);
  CHECK(std::isfinite(fix.position.y_m));
}

TEST_CASE("A failed configure leaves the earlier configuration in force") {
  Taylor3d taylor;
  REQUIRE(taylor.configure(in_the_open(), {}, kCross) == Status::kOk);
  Taylor3dConfig bad = in_the_open();
  bad.min_step_m = std::numeric_limits<float>::quiet_NaN();
  CHECK(taylor.configure(bad, {}, kCross) == Status::kInvalidConfig);
  Taylor3dFix fix;
  REQUIRE(taylor.process(paths_of(kPerson), kVariance_m2, {}, fix) == Status::kOk);
  CHECK(distance_m(fix.position, kPerson) < 1e-4);
}
