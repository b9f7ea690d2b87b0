#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/hub/locate/planar_3d.hpp"
#include "echofuse/hub/locate/wall.hpp"

namespace echofuse::hub {

enum class Taylor3dStart : std::uint8_t {
  kThreeDTwoD,   ///< 3D-2D of the first four receivers
  kApproximate,  ///< A-3D-2D of them
  kGiven,        ///< the caller's point
};

enum class RangeKind : std::uint8_t {
  kBistatic,  ///< transmitter -> target -> receiver
  kOneWay,    ///< target -> receiver: ranges to anchors
};

/// One way between a position and an antenna in the plane y = 0, through the wall.
struct AntennaRay3d {
  float optical_m = 0.0f;  ///< [m] speed of light times the time
  Point3 gradient;         ///< [1] of it with respect to the position; a unit vector
};

/// position: y_m > antenna's, as antenna_ray() on a line.
AntennaRay3d antenna_ray_3d(const Wall& wall, const Point3& position, const Point3& antenna);

/// How the iteration ended, by the paper's rules; (b) is to go on.
enum class Taylor3dStatus : std::uint8_t {
  kConverged,       ///< (c) the last step was not over min_step_m
  kDiverging,       ///< (a) a step was not shorter than the one before; the position is that before this step
  kIterationLimit,  ///< (d) max_iterations
  kSingular,        ///< the ranges do not determine a position (receivers on a line); there is none
  kNoStart,         ///< a receiver of the cross has no range; there is no position
};

struct Taylor3dConfig {
  WallConfig wall{0.2f, 4.0f, WallCompensation::kFirstKind};  ///< the paper's; only before antennas in y = 0
  Taylor3dStart start = Taylor3dStart::kThreeDTwoD;
  RangeKind range_kind = RangeKind::kBistatic;
  float min_step_m = 1e-4f;  ///< [m] epsilon of the paper, > 0
  int max_iterations = 20;   ///< N of the paper, in [0, 100]; 0: the start itself
};

/// nullptr, or the name of the first member with an impossible value.
const char* invalid_field(const Taylor3dConfig& config);

struct Taylor3dFix {
  Taylor3dStatus status = Taylor3dStatus::kNoStart;
  Point3 position;                       ///< [m]
  std::array<float, 6> covariance_m2{};  ///< [m^2] xx, xy, xz, yy, yz, zz: the inverse Fisher information
  float range_residual_m = 0.0f;         ///< [m] root mean square of measured less predicted range
  int iterations = 0;                    ///< steps taken
  bool clipped_start = false;            ///< the start was, see Planar3dStatus
};

/// A position in space from n >= 3 bistatic paths, or n >= 4 one-way ranges, of receivers anywhere (Taylor-series
/// paper, sections 3 and 4): from a start, steps that solve the linearised equations by weighted least squares,
/// (A^T W A) delta = A^T W D with W the inverse variances, until one of the rules a, c and d. As in the paper, no step
/// is shortened: rule a catches what a poor start costs. When all antennas lie in the plane y = 0, y stays >= 2 cm,
/// and ranges may pass a wall parallel to it. Reference: python/echofuse/reference/hub/locate/taylor_3d.py
class Taylor3d {
 public:
  /// tx: not used with one-way ranges. rx: (n,), 3 (one-way: 4) <= n <= kMaxArrayReceivers; unless the start is given,
  /// the first four are the cross of planar_3d(). kInvalidConfig: an impossible value, such a start without a cross or
  /// with one-way ranges, or a wall that is compensated with antennas out of y = 0; the earlier configuration stays in
  /// force.
  Status configure(const Taylor3dConfig& config, const Point3& tx, Span<const Point3> rx);

  /// range_m, variance_m2: (n,) [m] and [m^2] > 0, infinite: this receiver has no range. given: the start, if so
  /// configured. kInvalidInput: another n, a range that is not finite or over 1000 km, a variance that is not in
  /// [1e-12, 1e12] or infinite, a start that is not finite, or too few ranges; fix is then empty. What the geometry
  /// says is in fix.status, with kOk.
  Status process(Span<const float> range_m, Span<const float> variance_m2, const Point3& given,
                 Taylor3dFix& fix) const;

 private:
  struct Ranges {
    std::array<float, kMaxArrayReceivers> range_m, weight;
    std::size_t n_used = 0;
  };
  struct Information;

  Status read(Span<const float> range_m, Span<const float> variance_m2, Ranges& ranges) const;
  bool start(const Ranges& ranges, const Point3& given, Taylor3dFix& fix) const;
  float leg(const Point3& position, const Point3& antenna, Point3& gradient) const;
  void linearise(const Ranges& ranges, const Point3& position, Information& sums) const;

  Taylor3dConfig config_;
  Wall wall_;
  Point3 tx_;
  std::array<Point3, kMaxArrayReceivers> rx_;
  std::size_t n_receivers_ = 0;
  bool in_plane_ = false;  ///< all antennas have y = 0
};

}  // namespace echofuse::hub
