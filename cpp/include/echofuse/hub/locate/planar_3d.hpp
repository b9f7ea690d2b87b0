#pragma once

#include <array>
#include <cstdint>

namespace echofuse::hub {

/// Right-handed for one who looks at the wall: x along it, y the depth behind it, z upwards.
struct Point3 {
  float x_m = 0.0f;  ///< [m]
  float y_m = 0.0f;  ///< [m]
  float z_m = 0.0f;  ///< [m]
};

inline constexpr float kMaxPath3d_m =
    1e6f;  ///< [m] longer ones are refused, as their squares lose all meaning
inline constexpr float kMinDepth3d_m = 0.02f;  ///< [m] nearer to the antennas' plane the side is unknown

enum class Planar3dMethod : std::uint8_t {
  kThreeDTwoD,   ///< 3D-2D: each plane's distance from its axis, less the other plane's coordinate
  kApproximate,  ///< A-3D-2D: the mean of both distances, as if the other coordinate were 0
};

enum class Planar3dStatus : std::uint8_t {
  kFix,
  kClipped,  ///< ellipses that do not meet, a negative y^2, or y under 2 cm, were brought to the nearest that does
  kBadPath,  ///< a path is not finite or over 1000 km; there is no position
};

struct Planar3dFix {
  Planar3dStatus status = Planar3dStatus::kBadPath;
  Point3 position;  ///< [m] y >= 2 cm, unless kBadPath
};

/// A position before a cross of four receivers in the plane y = 0 at (-d, 0), (d, 0), (0, -d), (0, d) in x and z, the
/// transmitter in the middle (Taylor-series paper, section 1). Of two receivers on one axis, with paths d1 and d2:
/// the coordinate along it is (d1 - d2) (d1 d2 + d^2) / (2 d (d1 + d2)), and the distance from the transmitter
/// r = (d1^2 + d2^2 - 2 d^2) / (2 (d1 + d2)). 3D-2D: y is the mean of sqrt(r^2 - x^2 - z^2) of both axes.
/// A-3D-2D: the mean of sqrt(r^2 - x^2) and sqrt(r^2 - z^2), too deep by up to some decimetres off the middle.
/// path_m: (4,) [m]. spacing_m: [m] d > 0. Reference: python/echofuse/reference/hub/locate/planar_3d.py
Planar3dFix planar_3d(Planar3dMethod method, float spacing_m, const std::array<float, 4>& path_m);

}  // namespace echofuse::hub
