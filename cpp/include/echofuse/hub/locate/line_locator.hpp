#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/hub/locate/site.hpp"
#include "echofuse/hub/locate/wall.hpp"

namespace echofuse::hub {

enum class LineFixStatus : std::uint8_t {
  kFix,
  kNoIntersection,  ///< the ellipses do not meet
  kTooNearAxis,     ///< nearer than 2 cm to the antennas' line, where the side is unknown
  kSingular,        ///< the paths do not determine a position
};

struct LineLocatorConfig {
  WallConfig wall;
  float path_std_m = 0.033f;  ///< [m] of a path of weight 1: half a sample at 4.5 GHz, > 0
};

/// nullptr, or the name of the first member with an impossible value.
const char* invalid_field(const LineLocatorConfig& config);

struct LineFix {
  LineFixStatus status = LineFixStatus::kNoIntersection;
  Point position;  ///< [m] y > 0
  float covariance_xx_m2 = 0.0f, covariance_xy_m2 = 0.0f, covariance_yy_m2 = 0.0f;
  int iterations = 0;      ///< of the wall's correction, or of Gauss-Newton for more than two paths
  bool converged = false;  ///< the last step was under 0.1 mm
};

/// One way between a position and an antenna on the line, through the wall.
struct AntennaRay {
  float optical_m = 0.0f;  ///< [m] speed of light times the time
  Point gradient;          ///< [1] of it with respect to the position
};

/// position: y_m > 0, before the antenna's wall or behind it.
AntennaRay antenna_ray(const Wall& wall, const Point& position, float antenna_x_m);

/// The way there and the way back: a path.
inline AntennaRay operator+(const AntennaRay& a, const AntennaRay& b) {
  return {a.optical_m + b.optical_m, {a.gradient.x_m + b.gradient.x_m, a.gradient.y_m + b.gradient.y_m}};
}

/// Where two ellipses with one focus at the origin and the others at (x1, 0), (x2, 0) meet, in closed form: with
/// k = (d^2 - x_r^2) / 2, x = (k2 d1 - k1 d2) / (x1 d2 - x2 d1) and y^2 = ((x1 x + k1) / d1)^2 - x^2.
LineFix two_ellipses(float path1_m, float path2_m, float rx1_x_m, float rx2_x_m);

/// A position before (or, behind a wall that is parallel to it) a line of antennas: the transmitter is the origin,
/// receivers lie on the x axis, y is the depth (through-wall paper, section 2). Two paths: two_ellipses() of the
/// paths less the wall's delay, again until the fix stays. More: weighted Gauss-Newton on the optical paths from the
/// pair that explains all paths best. The covariance is the inverse of the Fisher information of the paths at the
/// fix. Reference: python/echofuse/reference/hub/locate/line_locator.py
class LineLocator {
 public:
  /// rx_x_m: (n,) [m] abscissae, 2 <= n <= kMaxArrayReceivers, all different and none 0.
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const LineLocatorConfig& config, Span<const float> rx_x_m);

  /// path_m, weight: (n,) [m] and [1] relative inverse variance; weight 0: this receiver has no path. kInvalidInput:
  /// another n, something not finite or a negative weight, or less than two paths; fix is then empty. What the
  /// geometry says is in fix.status, with kOk.
  Status process(Span<const float> path_m, Span<const float> weight, LineFix& fix) const;

  const Wall& wall() const { return wall_; }

 private:
  struct Paths {
    std::array<float, kMaxArrayReceivers> rx_x_m, path_m, weight;
    std::size_t n = 0;
  };
  struct Information {
    float xx = 0.0f, xy = 0.0f, yy = 0.0f, x = 0.0f, y = 0.0f, cost = 0.0f;
  };

  LineFix behind_wall(float path1_m, float path2_m, float rx1_x_m, float rx2_x_m) const;
  Information information(const Paths& paths, const Point& position) const;
  void start(const Paths& paths, LineFix& fix) const;
  void refine(const Paths& paths, LineFix& fix) const;

  Wall wall_;
  float path_variance_m2_ = 0.0f;
  std::array<float, kMaxArrayReceivers> rx_x_m_{};
  std::size_t n_receivers_ = 0;
};

}  // namespace echofuse::hub
