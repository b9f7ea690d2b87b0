#pragma once

#include <cstdint>

#include "echofuse/core/status.hpp"

namespace echofuse::hub {

enum class WallCompensation : std::uint8_t {
  kNone,        ///< as if there were no wall
  kFirstKind,   ///< the delay at normal incidence, whatever the angle
  kSecondKind,  ///< the delay of the ray that obeys Snell's law
};

struct WallConfig {
  float thickness_m = 0.24f;           ///< [m] the paper's brick wall, in [0, 2]
  float relative_permittivity = 4.0f;  ///< [1] of brick, in [1, 100]
  WallCompensation compensation = WallCompensation::kSecondKind;
};

/// nullptr, or the name of the first member with an impossible value.
const char* invalid_field(const WallConfig& config);

/// One way from an antenna before the wall to a target behind it.
struct WallRay {
  float excess_m = 0.0f;  ///< [m] speed of light times the time, less the straight line
  float lateral = 0.0f;   ///< [1] gradient of the optical path along the wall: the sine of the angle in air
  float depth = 1.0f;     ///< [1] and across it: the cosine
};

/// Delay through a homogeneous slab (through-wall paper, section 2). With q the tangent of the angle in air, w the
/// thickness, e the permittivity and L the air on the ray, Snell's law is L q + w q / sqrt(e + (e - 1) q^2) = lateral,
/// concave in q, so that Newton's iterations rise to the root from below; the optical path is then
/// p lateral + L sqrt(1 - p^2) + w sqrt(e - p^2), p = q / sqrt(1 + q^2), which does not change with p in first order.
/// The stand-off of the wall makes no difference. Reference: python/echofuse/reference/hub/locate/wall.py
class Wall {
 public:
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const WallConfig& config);

  /// lateral_m: [m] >= 0 along the wall, in any number of dimensions. depth_m: [m] > 0 across it; the air is at least
  /// 1 cm of it, so a place within the wall is taken as just behind it.
  WallRay ray(float lateral_m, float depth_m) const;

  /// [m] by which the way of a ray() over depth_m along the wall grows with the tangent of its angle in air.
  float spread_m(const WallRay& ray, float depth_m) const;

  /// [m] excess of one way at normal incidence, w (sqrt(e) - 1); 0 without compensation.
  float normal_excess_m() const;

  const WallConfig& config() const { return config_; }

 private:
  WallConfig config_;
};

}  // namespace echofuse::hub
