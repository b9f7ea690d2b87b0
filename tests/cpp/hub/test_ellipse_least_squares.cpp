#include "echofuse/hub/locate/ellipse_least_squares.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>

namespace {

using namespace echofuse;
using namespace echofuse::hub;

constexpr Area kRoom{0.0f, 0.0f, 11.5f, 6.0f};
const std::array<Point, 6> kReceivers{
    {{0.0f, 1.5f}, {0.0f, 4.5f}, {3.5f, 6.0f}, {8.0f, 6.0f}, {11.5f, 4.5f}, {11.5f, 1.5f}}};
constexpr Point kTransmitter{5.75f, 0.0f};

std::array<RangeEllipse, 6> ellipses_around(const Point& person, float body_radius_m = 0.0f) {
  std::array<RangeEllipse, 6> ellipses;
  for (std::size_t i = 0; i < 6; ++i)
    ellipses[i] = {kTransmitter, kReceivers[i],
                   path_length(person, kTransmitter, kReceivers[i], body_radius_m), 1.0f};
  return ellipses;
}

}  // namespace

TEST_CASE("Exact paths give the person back, by either form") {
  for (const EllipseRefinement refinement : {EllipseRefinement::kNone, EllipseRefinement::kGaussNewton}) {
    EllipseLeastSquares stage;
    EllipseConfig config;
    config.refinement = refinement;
    REQUIRE(stage.configure(config) == Status::kOk);
    EllipseFix fix;
    REQUIRE(stage.process(ellipses_around({3.0f, 2.0f}), kRoom, fix) == Status::kOk);
    CHECK(std::fabs(fix.position.x_m - 3.0f) < 1e-4f);
    CHECK(std::fabs(fix.position.y_m - 2.0f) < 1e-4f);
    CHECK(fix.range_residual_m < 1e-4f);
    CHECK(fix.converged);
  }
}

TEST_CASE("A round person is located at his middle") {
  EllipseLeastSquares stage;
  EllipseConfig config;
  config.body_radius_m = 0.2f;
  REQUIRE(stage.configure(config) == Status::kOk);
  EllipseFix fix;
  REQUIRE(stage.process(ellipses_around({7.0f, 3.5f}, 0.2f), kRoom, fix) == Status::kOk);
  CHECK(std::fabs(fix.position.x_m - 7.0f) < 1e-3f);
  CHECK(std::fabs(fix.position.y_m - 3.5f) < 1e-3f);
}

TEST_CASE("One foul path pulls the robust fix less") {
  EllipseLeastSquares stage;
  REQUIRE(stage.configure(EllipseConfig{}) == Status::kOk);
  std::array<RangeEllipse, 6> ellipses = ellipses_around({5.0f, 3.0f});
  ellipses[2].path_m += 0.5f;
  EllipseFix plain;
  plain.position = {5.0f, 3.0f};
  EllipseFix robust = plain;
  REQUIRE(stage.refine(ellipses, false, plain) == Status::kOk);
  REQUIRE(stage.refine(ellipses, true, robust) == Status::kOk);
  const auto error = [](const EllipseFix& fix) {
    return std::hypot(fix.position.x_m - 5.0f, fix.position.y_m - 3.0f);
  };
  CHECK(error(plain) > 0.02f);
  CHECK(error(robust) < 0.5f * error(plain));
}

TEST_CASE("A geometry that cannot locate is refused") {
  EllipseLeastSquares stage;
  EllipseFix fix;
  const std::array<RangeEllipse, 6> ellipses = ellipses_around({3.0f, 2.0f});
  CHECK(stage.process(ellipses, kRoom, fix) == Status::kNotConfigured);
  REQUIRE(stage.configure(EllipseConfig{}) == Status::kOk);
  CHECK(stage.process(Span<const RangeEllipse>(ellipses).first(2), kRoom, fix) == Status::kInvalidInput);
  std::array<RangeEllipse, 3> same{ellipses[0], ellipses[0], ellipses[0]};
  CHECK(stage.process(same, kRoom, fix) == Status::kInvalidInput);
}

TEST_CASE("Every impossible field of EllipseConfig is named") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EllipseConfig config;
  CHECK(invalid_field(config) == nullptr);
  config.max_iterations = 0;
  CHECK(doctest::String(invalid_field(config)) == "max_iterations");
  config = {};
  config.max_step_m = nan;
  CHECK(doctest::String(invalid_field(config)) == "max_step_m");
  config = {};
  config.body_radius_m = nan;
  CHECK(doctest::String(invalid_field(config)) == "body_radius_m");
  config = {};
  config.robust_scale_m = nan;
  CHECK(doctest::String(invalid_field(config)) == "robust_scale_m");
}
