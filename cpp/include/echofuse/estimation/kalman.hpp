#pragma once

#include "echofuse/core/eigen.hpp"

namespace echofuse::estimation {

/// Kalman filter of a point in the plane or in space that keeps its velocity but for white acceleration
/// (Bar-Shalom, Li & Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, sections 5.2
/// and 6.2). State x [m], vx [m/s], y [m], vy [m/s], and in space z [m], vz [m/s]; the update is Joseph's form,
/// so the covariance stays positive. Reference: python/echofuse/reference/estimation/kalman.py
template <int kDimension>
class ConstantVelocityFilter {
  static_assert(kDimension == 2 || kDimension == 3, "kalman.cpp compiles these");
  static auto positions() { return Eigen::seqN(Eigen::fix<0>, Eigen::fix<kDimension>, Eigen::fix<2>); }
  static auto velocities() { return Eigen::seqN(Eigen::fix<1>, Eigen::fix<kDimension>, Eigen::fix<2>); }

 public:
  using Vector = Eigen::Matrix<float, kDimension, 1>;  ///< x, y, and in space z
  using PositionCovariance = Eigen::Matrix<float, kDimension, kDimension>;
  using State = Eigen::Matrix<float, 2 * kDimension, 1>;
  using Covariance = Eigen::Matrix<float, 2 * kDimension, 2 * kDimension>;

  ConstantVelocityFilter() = default;
  ConstantVelocityFilter(const State& state, const Covariance& covariance)
      : state_(state), covariance_(covariance) {}

  /// At a position [m] with its covariance [m^2], moving by a velocity [m/s] known to so much per coordinate.
  static ConstantVelocityFilter at(const Vector& position, const PositionCovariance& position_covariance,
                                   const Vector& velocity, float velocity_std_mps);

  /// Moves by dt_s; the velocity is first multiplied by velocity_decay (1: kept).
  void predict(float dt_s, float acceleration_density_m2ps3, float velocity_decay = 1.0f);

  /// Takes in a measured position [m] with its covariance [m^2], which is positive definite.
  void update(const Vector& measured, const PositionCovariance& measurement_covariance);

  /// [m^2] of a measured minus the predicted position.
  PositionCovariance innovation_covariance(const PositionCovariance& measurement_covariance) const;

  /// [1] squared Mahalanobis distance of a measured position [m] from the predicted one.
  float squared_distance(const Vector& measured, const PositionCovariance& measurement_covariance) const;

  /// [m^2] variance of direction . position.
  float variance_along(const Vector& direction) const;

  /// Takes in one number that grows by direction . change of position: innovation is its measured minus its
  /// predicted value, variance_m2 > 0 that of its error (an extended Kalman filter's scalar update).
  void update_along(const Vector& direction, float innovation_m, float variance_m2);

  /// Keeps a coordinate within limits [m]; who reaches one stops there. Whether it had to.
  bool hold(int axis, float low_m, float high_m);

  const State& state() const { return state_; }
  const Covariance& covariance() const { return covariance_; }
  Vector position() const { return state_(positions()); }                                           ///< [m]
  Vector velocity() const { return state_(velocities()); }                                          ///< [m/s]
  PositionCovariance position_covariance() const { return covariance_(positions(), positions()); }  ///< [m^2]

 private:
  State state_ = State::Zero();
  Covariance covariance_ = Covariance::Zero();
};

}  // namespace echofuse::estimation
