#include "echofuse/estimation/kalman.hpp"

#include <Eigen/LU>

namespace echofuse::estimation {
namespace {

using Measurement = Eigen::Matrix<float, 2, 1>;
using Shown = Eigen::Matrix<float, 2, 4>;

Shown shown_part() {
  Shown shown = Shown::Zero();
  shown(0, 0) = 1.0f;
  shown(1, 2) = 1.0f;
  return shown;
}

}  // namespace

void ConstantVelocityFilter::predict(float dt_s, float acceleration_density_m2ps3, float velocity_decay) {
  const float variance = acceleration_density_m2ps3 * dt_s;
  Covariance transition = Covariance::Identity();
  Covariance noise = Covariance::Zero();
  for (const int axis : {0, 2}) {
    transition(axis, axis + 1) = dt_s * velocity_decay;
    transition(axis + 1, axis + 1) = velocity_decay;
    noise(axis, axis) = variance * dt_s * dt_s / 3.0f;
    noise(axis, axis + 1) = noise(axis + 1, axis) = variance * dt_s / 2.0f;
    noise(axis + 1, axis + 1) = variance;
  }
  state_ = (transition * state_).eval();
  covariance_ = (transition * covariance_ * transition.transpose() + noise).eval();
}

void ConstantVelocityFilter::update(const Position& measured, const Covariance2& measurement_covariance) {
  const Shown shown = shown_part();
  const Covariance2 inverse = innovation_covariance(measurement_covariance).inverse();
  const Eigen::Matrix<float, 4, 2> gain = covariance_ * shown.transpose() * inverse;
  const Measurement innovation(measured.x_m - state_(0), measured.y_m - state_(2));
  const Covariance rest = Covariance::Identity() - gain * shown;
  state_ += gain * innovation;
  const Covariance updated =
      rest * covariance_ * rest.transpose() + gain * measurement_covariance * gain.transpose();
  covariance_ = 0.5f * (updated + updated.transpose());
}

ConstantVelocityFilter::Covariance2 ConstantVelocityFilter::innovation_covariance(
    const Covariance2& measurement_covariance) const {
  Covariance2 position;
  position << covariance_(0, 0), covariance_(0, 2), covariance_(2, 0), covariance_(2, 2);
  return position + measurement_covariance;
}

float ConstantVelocityFilter::squared_distance(const Position& measured,
                                               const Covariance2& measurement_covariance) const {
  const Measurement innovation(measured.x_m - state_(0), measured.y_m - state_(2));
  const Covariance2 inverse = innovation_covariance(measurement_covariance).inverse();
  return innovation.dot(inverse * innovation);
}

float ConstantVelocityFilter::variance_along(const Eigen::Vector2f& direction) const {
  const State shown(direction(0), 0.0f, direction(1), 0.0f);
  return shown.dot(covariance_ * shown);
}

void ConstantVelocityFilter::update_along(const Eigen::Vector2f& direction, float innovation_m,
                                          float variance_m2) {
  const State shown(direction(0), 0.0f, direction(1), 0.0f);
  const State with_shown = covariance_ * shown;
  const State gain = with_shown / (shown.dot(with_shown) + variance_m2);
  const Covariance rest = Covariance::Identity() - gain * shown.transpose();
  state_ += gain * innovation_m;
  const Covariance updated = rest * covariance_ * rest.transpose() + variance_m2 * gain * gain.transpose();
  covariance_ = 0.5f * (updated + updated.transpose());
}

}  // namespace echofuse::estimation
