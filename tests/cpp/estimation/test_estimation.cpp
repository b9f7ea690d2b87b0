#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>

#include "echofuse/core/compensated_sum.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/estimation/assignment.hpp"
#include "echofuse/estimation/gaussian.hpp"
#include "echofuse/estimation/kalman.hpp"
#include "echofuse/estimation/mixture_em.hpp"
#include "echofuse/estimation/resampling.hpp"

namespace echofuse::estimation {

TEST_CASE("the Gaussian kernel is exp and ends at five deviations") {
  CHECK(gaussian_kernel(0.0f) == 1.0f);
  CHECK(gaussian_kernel(2.0f) == doctest::Approx(std::exp(-1.0)).epsilon(1e-6));
  CHECK(gaussian_kernel(25.0f) > 0.0f);
  CHECK(gaussian_kernel(25.001f) == 0.0f);
  CHECK(gaussian_kernel(std::numeric_limits<float>::quiet_NaN()) == 0.0f);
}

TEST_CASE("a compensated sum keeps what plain float32 loses") {
  CompensatedSum sum;
  float plain = 0.0f;
  sum.add(1e7f);
  plain += 1e7f;
  for (int i = 0; i < 10000; ++i) {
    sum.add(0.1f);
    plain += 0.1f;
  }
  CHECK(plain == 1e7f);
  CHECK(sum.value() == doctest::Approx(1e7 + 1000.0).epsilon(1e-7));
}

TEST_CASE("systematic resampling copies each as often as its share") {
  const std::array<float, 4> weights = {0.0f, 3.0f, 0.0f, 1.0f};
  std::array<std::uint16_t, 8> indices{};
  REQUIRE(systematic_resample({weights.data(), 4}, 0.5f, {indices.data(), 8}) == Status::kOk);
  CHECK(indices == std::array<std::uint16_t, 8>{1, 1, 1, 1, 1, 1, 3, 3});

  const std::array<float, 2> nothing = {0.0f, 0.0f};
  CHECK(systematic_resample({nothing.data(), 2}, 0.5f, {indices.data(), 8}) == Status::kInvalidInput);
  CHECK(systematic_resample({}, 0.5f, {indices.data(), 8}) == Status::kInvalidInput);
}

TEST_CASE("assignment weighs all pairs together, not one after another") {
  // The nearest pair first, (0, 0) at 1, would cost 1 + 10.
  const std::array<float, 4> cost = {1.0f, 2.0f, 2.0f, 10.0f};
  std::array<int, 2> column{};
  REQUIRE(assign({cost.data(), 4}, 2, 2, {column.data(), 2}) == Status::kOk);
  CHECK(column == std::array<int, 2>{1, 0});

  const std::array<float, 3> tall = {5.0f, 1.0f, 3.0f};
  std::array<int, 3> of_row{};
  REQUIRE(assign({tall.data(), 3}, 3, 1, {of_row.data(), 3}) == Status::kOk);
  CHECK(of_row == std::array<int, 3>{kUnassigned, 0, kUnassigned});
}

TEST_CASE("assignment refuses lengths that do not fit") {
  const std::array<float, 4> cost{};
  std::array<int, 2> column{};
  CHECK(assign({cost.data(), 4}, 2, 1, {column.data(), 2}) == Status::kInvalidInput);
  CHECK(assign({cost.data(), 4}, 2, 2, {column.data(), 1}) == Status::kInvalidInput);
}

TEST_CASE_TEMPLATE("a Kalman update between two equal uncertainties ends in the middle", Filter,
                   ConstantVelocityFilter<2>, ConstantVelocityFilter<3>) {
  const auto unit = Filter::PositionCovariance::Identity();
  Filter filter(Filter::State::Zero(), Filter::Covariance::Identity());
  typename Filter::Vector measured = Filter::Vector::Constant(2.0f);
  measured(1) = -4.0f;
  filter.update(measured, unit);
  CHECK((filter.position() - 0.5f * measured).norm() == doctest::Approx(0.0));
  CHECK((filter.position_covariance() - 0.5f * unit).norm() == doctest::Approx(0.0));
  CHECK(filter.velocity().norm() == 0.0f);
  CHECK(filter.squared_distance(0.5f * measured + Filter::Vector::Unit(1), unit) ==
        doctest::Approx(1.0 / 1.5));
}

TEST_CASE_TEMPLATE("a filter begins where it is put, and moves by its velocity", Filter,
                   ConstantVelocityFilter<2>, ConstantVelocityFilter<3>) {
  constexpr int kAxes = Filter::Vector::SizeAtCompileTime;
  const typename Filter::Vector position = Filter::Vector::LinSpaced(1.0f, 5.0f);
  const typename Filter::Vector velocity = Filter::Vector::LinSpaced(-1.0f, 0.5f);
  typename Filter::PositionCovariance covariance = 0.04f * Filter::PositionCovariance::Identity();
  covariance(0, kAxes - 1) = covariance(kAxes - 1, 0) = 0.01f;
  Filter filter = Filter::at(position, covariance, velocity, 0.3f);
  CHECK(filter.position() == position);
  CHECK(filter.velocity() == velocity);
  CHECK(filter.position_covariance() == covariance);

  filter.predict(2.0f, 0.0f);
  CHECK((filter.position() - (position + 2.0f * velocity)).norm() == doctest::Approx(0.0));
  const auto along = Filter::Vector::Unit(kAxes - 1);  // 0.04 + (2 * 0.3)^2
  CHECK(filter.variance_along(along) == doctest::Approx(0.4));
  CHECK(filter.position_covariance()(0, kAxes - 1) == doctest::Approx(0.01));

  filter.update_along(along, 1.0f, 0.4f);  // as sure as the prediction: half the way
  CHECK(filter.position()(kAxes - 1) == doctest::Approx(5.0 + 2.0 * 0.5 + 0.5));
  CHECK(filter.variance_along(along) == doctest::Approx(0.2));
}

TEST_CASE("the mixture fit refuses bad configurations and keeps the earlier one") {
  MixtureFitter fitter;
  Mixture mixture;
  Pcg32 random;
  const std::array<Particle, 2> particles = {
      {{1.0f, 0.5f, 2.0f, 0.0f, 1.0f}, {1.2f, 0.5f, 2.0f, 0.0f, 1.0f}}};
  const std::array<MixtureSeed, 1> seeds = {{{1.0f, 2.0f, 1.0f}}};
  CHECK(fitter.process({particles.data(), 2}, {seeds.data(), 1}, 1, random, mixture) ==
        Status::kNotConfigured);
  REQUIRE(fitter.configure({}) == Status::kOk);
  MixtureConfig bad;
  bad.initial_std_m = std::numeric_limits<float>::quiet_NaN();
  CHECK(doctest::String(invalid_field(bad)) == "initial_std_m");
  CHECK(fitter.configure(bad) == Status::kInvalidConfig);
  REQUIRE(fitter.process({particles.data(), 2}, {seeds.data(), 1}, 1, random, mixture) == Status::kOk);
  REQUIRE(mixture.components.size() == 1);
  CHECK(mixture.components[0].x_m == doctest::Approx(1.1));
  CHECK(mixture.components[0].vx_mps == doctest::Approx(0.5));
}

}  // namespace echofuse::estimation
