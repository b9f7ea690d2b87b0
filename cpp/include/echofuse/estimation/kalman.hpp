#pragma once

#include "echofuse/core/eigen.hpp"
#include "echofuse/estimation/particle_set.hpp"

namespace echofuse::estimation {

/// Kalman filter of a point in the plane that keeps its velocity but for white acceleration (Bar-Shalom, Li &
/// Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, sections 5.2 and 6.2).
/// State x [m], vx [m/s], y [m], vy [m/s]; the update is Joseph's form, so the covariance stays positive.
/// Reference: python/echofuse/reference/estimation/kalman.py
class ConstantVelocityFilter {
 public:
  using State = Eigen::Matrix<float, 4, 1>;
  using Covariance = Eigen::Matrix<float, 4, 4>;
  using Covariance2 = Eigen::Matrix<float, 2, 2>;

  ConstantVelocityFilter() = default;
  ConstantVelocityFilter(const State& state, const Covariance& covariance)
      : state_(state), covariance_(covariance) {}

  /// Moves by dt_s; the velocity is first multiplied by velocity_decay (1: kept).
  void predict(float dt_s, float acceleration_density_m2ps3, float velocity_decay = 1.0f);

  /// Takes in a measured position with its covariance [m^2], which is positive definite.
  void update(const Position& measured, const Covariance2& measurement_covariance);

  /// [m^2] of a measured minus the predicted position.
  Covariance2 innovation_covariance(const Covariance2& measurement_covariance) const;

  /// [1] squared Mahalanobis distance of a measured position from the predicted one.
  float squared_distance(const Position& measured, const Covariance2& measurement_covariance) const;

  /// [m^2] variance of direction . position.
  float variance_along(const Eigen::Vector2f& direction) const;

  /// Takes in one number that grows by direction . change of position: innovation is its measured minus its
  /// predicted value, variance_m2 > 0 that of its error (an extended Kalman filter's scalar update).
  void update_along(const Eigen::Vector2f& direction, float innovation_m, float variance_m2);

  const State& state() const { return state_; }
  const Covariance& covariance() const { return covariance_; }
  Position position() const { return {state_(0), state_(2)}; }

 private:
  State state_ = State::Zero();
  Covariance covariance_ = Covariance::Zero();
};

}  // namespace echofuse::estimation
