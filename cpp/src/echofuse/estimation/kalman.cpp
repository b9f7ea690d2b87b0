#include "echofuse/estimation/kalman.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace echofuse::estimation {

template <int kDimension>
ConstantVelocityFilter<kDimension> ConstantVelocityFilter<kDimension>::at(
    const Vector& position, const PositionCovariance& position_covariance, const Vector& velocity,
    float velocity_std_mps) {
  ConstantVelocityFilter filter;
  filter.state_(positions()) = position;
  filter.state_(velocities()) = velocity;
  filter.covariance_(positions(), positions()) = position_covariance;
  for (int axis = 0; axis < 2 * kDimension; axis += 2)
    filter.covariance_(axis + 1, axis + 1) = velocity_std_mps * velocity_std_mps;
  return filter;
}

template <int kDimension>
void ConstantVelocityFilter<kDimension>::predict(float dt_s, float acceleration_density_m2ps3,
                                                 float velocity_decay) {
  const float variance = acceleration_density_m2ps3 * dt_s;
  Covariance transition = Covariance::Identity();
  Covariance noise = Covariance::Zero();
  for (int axis = 0; axis < 2 * kDimension; axis += 2) {
    transition(axis, axis + 1) = dt_s * velocity_decay;
    transition(axis + 1, axis + 1) = velocity_decay;
    noise(axis, axis) = variance * dt_s * dt_s / 3.0f;
    noise(axis, axis + 1) = noise(axis + 1, axis) = variance * dt_s / 2.0f;
    noise(axis + 1, axis + 1) = variance;
  }
  state_ = (transition * state_).eval();
  covariance_ = (transition * covariance_ * transition.transpose() + noise).eval();
}

template <int kDimension>
void ConstantVelocityFilter<kDimension>::update(const Vector& measured,
                                                const PositionCovariance& measurement_covariance) {
  Eigen::Matrix<float, kDimension, 2 * kDimension> shown;
  shown.setZero();
  for (int axis = 0; axis < kDimension; ++axis) shown(axis, 2 * axis) = 1.0f;
  const PositionCovariance inverse = innovation_covariance(measurement_covariance).inverse();
  const Eigen::Matrix<float, 2 * kDimension, kDimension> gain = covariance_ * shown.transpose() * inverse;
  const Vector innovation = measured - position();
  const Covariance rest = Covariance::Identity() - gain * shown;
  state_ += gain * innovation;
  const Covariance updated =
      rest * covariance_ * rest.transpose() + gain * measurement_covariance * gain.transpose();
  covariance_ = 0.5f * (updated + updated.transpose());
}

template <int kDimension>
typename ConstantVelocityFilter<kDimension>::PositionCovariance
ConstantVelocityFilter<kDimension>::innovation_covariance(
    const PositionCovariance& measurement_covariance) const {
  return position_covariance() + measurement_covariance;
}

template <int kDimension>
float ConstantVelocityFilter<kDimension>::squared_distance(
    const Vector& measured, const PositionCovariance& measurement_covariance) const {
  const Vector innovation = measured - position();
  const PositionCovariance inverse = innovation_covariance(measurement_covariance).inverse();
  return innovation.dot(inverse * innovation);
}

template <int kDimension>
float ConstantVelocityFilter<kDimension>::variance_along(const Vector& direction) const {
  State shown = State::Zero();
  shown(positions()) = direction;
  return shown.dot(covariance_ * shown);
}

template <int kDimension>
void ConstantVelocityFilter<kDimension>::update_along(const Vector& direction, float innovation_m,
                                                      float variance_m2) {
  State shown = State::Zero();
  shown(positions()) = direction;
  const State with_shown = covariance_ * shown;
  const State gain = with_shown / (shown.dot(with_shown) + variance_m2);
  const Covariance rest = Covariance::Identity() - gain * shown.transpose();
  state_ += gain * innovation_m;
  const Covariance updated = rest * covariance_ * rest.transpose() + variance_m2 * gain * gain.transpose();
  covariance_ = 0.5f * (updated + updated.transpose());
}

template <int kDimension>
bool ConstantVelocityFilter<kDimension>::hold(int axis, float low_m, float high_m) {
  const float at = state_(2 * axis);
  if (at >= low_m && at <= high_m) return false;
  state_(2 * axis) = std::clamp(at, low_m, high_m);
  state_(2 * axis + 1) = 0.0f;
  return true;
}

template class ConstantVelocityFilter<2>;
template class ConstantVelocityFilter<3>;

}  // namespace echofuse::estimation
