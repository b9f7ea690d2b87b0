#include "echofuse/estimation/turning_filter.hpp"

#include <algorithm>
#include <cmath>

namespace echofuse::estimation {

template <int kDimension>
void TurningFilter<kDimension>::predict(float dt_s, const TurningMotion& motion, float velocity_decay) {
  if (!turns_) {
    mixture_.predict(dt_s, motion.straight_density_m2ps3, velocity_decay);
    return;
  }
  const float straight = 1.0f - turning_;
  const float begins = motion.begin_probability * straight;
  const float goes_on = (1.0f - motion.end_probability) * turning_;
  const float turning = begins + goes_on;
  const Filter to_straight = mix(motion.end_probability * turning_ / (1.0f - turning));
  const Filter to_turning = mix(goes_on / turning);
  models_ = {to_straight, to_turning};
  models_[0].predict(dt_s, motion.straight_density_m2ps3, velocity_decay);
  models_[1].predict(dt_s, motion.turning_density_m2ps3, velocity_decay);
  turning_ = turning;
  mixture_ = mix(turning_);
}

template <int kDimension>
void TurningFilter<kDimension>::update_along(const Vector& direction, float innovation_m, float variance_m2) {
  if (!turns_) {
    mixture_.update_along(direction, innovation_m, variance_m2);
    return;
  }
  std::array<float, 2> log_likelihood{};
  for (std::size_t i = 0; i < 2; ++i) {
    const float own_m = innovation_m - direction.dot(models_[i].position() - mixture_.position());
    const float variance = models_[i].variance_along(direction) + variance_m2;
    log_likelihood[i] = -0.5f * (std::log(variance) + own_m * own_m / variance);
    models_[i].update_along(direction, own_m, variance_m2);
  }
  const float straight = (1.0f - turning_) * std::exp(std::min(log_likelihood[0] - log_likelihood[1], 0.0f));
  const float turning = turning_ * std::exp(std::min(log_likelihood[1] - log_likelihood[0], 0.0f));
  turning_ = turning / (straight + turning);
  mixture_ = mix(turning_);
}

template <int kDimension>
void TurningFilter<kDimension>::hold(int axis, float low_m, float high_m) {
  if (!turns_) {
    (void)mixture_.hold(axis, low_m, high_m);
    return;
  }
  const bool held[] = {models_[0].hold(axis, low_m, high_m), models_[1].hold(axis, low_m, high_m)};
  if (held[0] || held[1]) mixture_ = mix(turning_);
}

/// turning: weight of that model.
template <int kDimension>
typename TurningFilter<kDimension>::Filter TurningFilter<kDimension>::mix(float turning) const {
  const State apart = models_[1].state() - models_[0].state();
  const float straight = 1.0f - turning;
  const State state = models_[0].state() + turning * apart;
  const Covariance covariance = straight * models_[0].covariance() + turning * models_[1].covariance() +
                                (straight * turning) * apart * apart.transpose();
  return {state, covariance};
}

template class TurningFilter<2>;
template class TurningFilter<3>;

}  // namespace echofuse::estimation
