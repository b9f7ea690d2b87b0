#include "echofuse/hub/locate/wall.hpp"

#include <algorithm>
#include <cmath>

namespace echofuse::hub {
namespace {

constexpr float kMinAir_m = 0.01f;
constexpr int kMaxIterations = 12;          ///< 5 suffice for all but grazing rays
constexpr float kConvergedTangent = 1e-6f;  ///< [1] relative; the path depends on it in second order only

float hypotenuse(float a, float b) { return std::sqrt(a * a + b * b); }

}  // namespace

const char* invalid_field(const WallConfig& config) {
  if (!(config.thickness_m >= 0.0f && config.thickness_m <= 2.0f)) return "thickness_m";
  if (!(config.relative_permittivity >= 1.0f && config.relative_permittivity <= 100.0f))
    return "relative_permittivity";
  if (config.compensation > WallCompensation::kSecondKind) return "compensation";
  return nullptr;
}

Status Wall::configure(const WallConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  return Status::kOk;
}

WallRay Wall::ray(float lateral_m, float depth_m) const {
  const float w = config_.thickness_m;
  const float e = config_.relative_permittivity;
  if (config_.compensation != WallCompensation::kSecondKind || w == 0.0f) {
    const float straight = hypotenuse(lateral_m, depth_m);
    return {normal_excess_m(), lateral_m / straight, depth_m / straight};
  }
  const float air = std::max(depth_m - w, kMinAir_m);
  float q = lateral_m / (air + w / std::sqrt(e));
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const float squared = e + (e - 1.0f) * q * q;
    const float root = std::sqrt(squared);
    const float step = (lateral_m - air * q - w * q / root) / (air + w * e / (squared * root));
    q += step;
    if (!(std::abs(step) > kConvergedTangent * q)) break;
  }
  const float secant = std::sqrt(1.0f + q * q);
  const float p = q / secant;
  const float optical = p * lateral_m + air / secant + w * std::sqrt(e - p * p);
  return {optical - hypotenuse(lateral_m, air + w), p, 1.0f / secant};
}

float Wall::spread_m(const WallRay& ray, float depth_m) const {
  const float w = config_.thickness_m;
  const float e = config_.relative_permittivity;
  if (config_.compensation != WallCompensation::kSecondKind || w == 0.0f) return depth_m;
  const float q = ray.lateral / ray.depth;
  const float squared = e + (e - 1.0f) * q * q;
  return std::max(depth_m - w, kMinAir_m) + w * e / (squared * std::sqrt(squared));
}

float Wall::normal_excess_m() const {
  if (config_.compensation == WallCompensation::kNone) return 0.0f;
  return config_.thickness_m * (std::sqrt(config_.relative_permittivity) - 1.0f);
}

}  // namespace echofuse::hub
