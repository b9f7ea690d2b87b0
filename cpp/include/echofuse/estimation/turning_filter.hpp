#pragma once

#include <array>

#include "echofuse/core/eigen.hpp"
#include "echofuse/estimation/kalman.hpp"

namespace echofuse::estimation {

/// How somebody moves who walks straight, and now and then turns.
struct TurningMotion {
  float straight_density_m2ps3 = 0.0f;  ///< [m^2/s^3] velocity variance gained per second, > 0
  float turning_density_m2ps3 = 0.0f;   ///< [m^2/s^3] the same of one who turns, > 0
  float begin_probability = 0.0f;       ///< [1] that one who walks straight turns after a step in time, in (0, 1)
  float end_probability = 0.0f;         ///< [1] that one who turns walks straight after it, in (0, 1)
};

/// Two constant-velocity filters, of somebody who walks straight and of one who turns, as one: the interacting multiple
/// model estimator (Blom & Bar-Shalom, IEEE Transactions on Automatic Control 33, 1988; Bar-Shalom, Li & Kirubarajan 2001,
/// section 11.6.6). State and covariance are the mixture's. Where nobody turns it is the straight filter alone.
/// Reference: python/echofuse/reference/estimation/turning_filter.py
template <int kDimension>
class TurningFilter {
 public:
  using Filter = ConstantVelocityFilter<kDimension>;
  using Vector = typename Filter::Vector;
  using State = typename Filter::State;
  using Covariance = typename Filter::Covariance;

  TurningFilter() = default;

  /// Both models begin with the same, the one as probable as the other. turns: false for the straight filter alone.
  TurningFilter(const Filter& filter, bool turns)
      : turns_(turns), turning_(turns ? 0.5f : 0.0f), models_{filter, filter}, mixture_(filter) {}

  /// Mixes the models and moves each by dt_s; velocities are first multiplied by velocity_decay.
  void predict(float dt_s, const TurningMotion& motion, float velocity_decay = 1.0f);

  /// As ConstantVelocityFilter's; innovation_m is that of the mixture.
  void update_along(const Vector& direction, float innovation_m, float variance_m2);

  /// Keeps a coordinate within limits [m]; who reaches one stops there.
  void hold(int axis, float low_m, float high_m);

  /// [m^2] as ConstantVelocityFilter's
  float variance_along(const Vector& direction) const { return mixture_.variance_along(direction); }

  const Filter& mixture() const { return mixture_; }
  const State& state() const { return mixture_.state(); }
  const Covariance& covariance() const { return mixture_.covariance(); }
  Vector position() const { return mixture_.position(); }  ///< [m]
  Vector velocity() const { return mixture_.velocity(); }  ///< [m/s]
  float turning_probability() const { return turning_; }

 private:
  Filter mix(float turning) const;

  bool turns_ = false;
  float turning_ = 0.0f;            ///< [1] probability
  std::array<Filter, 2> models_{};  ///< straight, turning; unused where nobody turns
  Filter mixture_;
};

}  // namespace echofuse::estimation
