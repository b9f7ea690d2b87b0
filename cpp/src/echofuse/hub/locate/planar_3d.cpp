#include "echofuse/hub/locate/planar_3d.hpp"

#include <algorithm>
#include <cmath>

namespace echofuse::hub {
namespace {

constexpr float kClip = 1e-6f;

/// Two receivers on one axis.
struct Axis {
  float along_m = 0.0f;  ///< [m] coordinate along the axis
  float range_m = 0.0f;  ///< [m] distance from the transmitter
  bool clipped = false;
};

Axis locate_on_axis(float path1_m, float path2_m, float d) {
  const float least = d * (1.0f + kClip);
  const float most = 2.0f * d * (1.0f - kClip);
  float d1 = std::max(path1_m, least);
  float d2 = std::max(path2_m, least);
  Axis axis;
  axis.clipped = d1 != path1_m || d2 != path2_m;
  float difference = d1 - d2;
  if (std::abs(difference) > most) {
    const float middle = 0.5f * (d1 + d2);
    difference = std::copysign(most, difference);
    d1 = middle + 0.5f * difference;
    d2 = middle - 0.5f * difference;
    axis.clipped = true;
  }
  const float sum = d1 + d2;
  axis.along_m = difference * (d1 * d2 + d * d) / (2.0f * d * sum);
  axis.range_m = (d1 * d1 + d2 * d2 - 2.0f * d * d) / (2.0f * sum);
  return axis;
}

float difference_of_squares(float a, float b) { return (a - b) * (a + b); }

}  // namespace

Planar3dFix planar_3d(Planar3dMethod method, float spacing_m, const std::array<float, 4>& path_m) {
  Planar3dFix fix;
  for (const float path : path_m)
    if (!(std::abs(path) <= kMaxPath3d_m)) return fix;
  const Axis x = locate_on_axis(path_m[0], path_m[1], spacing_m);
  const Axis z = locate_on_axis(path_m[2], path_m[3], spacing_m);
  float square1 = difference_of_squares(x.range_m, x.along_m);
  float square2 = difference_of_squares(z.range_m, z.along_m);
  if (method == Planar3dMethod::kThreeDTwoD) {
    square1 -= z.along_m * z.along_m;
    square2 -= x.along_m * x.along_m;
  }
  const float y = 0.5f * (std::sqrt(std::max(square1, 0.0f)) + std::sqrt(std::max(square2, 0.0f)));
  const bool clipped = x.clipped || z.clipped || square1 < 0.0f || square2 < 0.0f || y < kMinDepth3d_m;
  fix.status = clipped ? Planar3dStatus::kClipped : Planar3dStatus::kFix;
  fix.position = {x.along_m, std::max(y, kMinDepth3d_m), z.along_m};
  return fix;
}

}  // namespace echofuse::hub
