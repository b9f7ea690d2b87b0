#include "echofuse/hub/locate/taylor_3d.hpp"

#include "echofuse/core/eigen.hpp"
// after core/eigen.hpp
#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace echofuse::hub {
namespace {

constexpr float kMinPivot = 3e-6f;  ///< ten times what float32 leaves of a singular matrix's
constexpr float kMinVariance_m2 = 1e-12f;
constexpr float kMaxVariance_m2 = 1e12f;
constexpr float kSameSpacing = 1e-5f;  ///< relative

using Vector3 = Eigen::Vector3f;
using Matrix3 = Eigen::Matrix3f;

bool finite(const Point3& point) {
  return std::isfinite(point.x_m) && std::isfinite(point.y_m) && std::isfinite(point.z_m);
}

bool same(const Point3& a, const Point3& b, float tolerance_m) {
  return std::abs(a.x_m - b.x_m) <= tolerance_m && std::abs(a.y_m - b.y_m) <= tolerance_m &&
         std::abs(a.z_m - b.z_m) <= tolerance_m;
}

bool is_cross(const Point3& tx, Span<const Point3> rx) {
  if (rx.size() < 4) return false;
  const float d = rx[1].x_m;
  const float tolerance = kSameSpacing * d;
  return d > 0.0f && same(tx, {}, 0.0f) && same(rx[0], {-d, 0.0f, 0.0f}, tolerance) &&
         same(rx[1], {d, 0.0f, 0.0f}, tolerance) && same(rx[2], {0.0f, 0.0f, -d}, tolerance) &&
         same(rx[3], {0.0f, 0.0f, d}, tolerance);
}

/// False when the matrix is singular to float32, or not finite.
bool factor(const Matrix3& matrix, Eigen::LLT<Matrix3>& cholesky) {
  cholesky.compute(matrix);
  if (cholesky.info() != Eigen::Success) return false;
  for (int i = 0; i < 3; ++i) {
    const float root = cholesky.matrixLLT()(i, i);
    if (!(root * root > kMinPivot * matrix(i, i))) return false;
  }
  return true;
}

}  // namespace

struct Taylor3d::Information {
  Matrix3 matrix = Matrix3::Zero();    ///< A^T W A
  Vector3 gradient = Vector3::Zero();  ///< A^T W D
  float squares_m2 = 0.0f;             ///< D^T D
};

AntennaRay3d antenna_ray_3d(const Wall& wall, const Point3& position, const Point3& antenna) {
  const float dx = position.x_m - antenna.x_m;
  const float dy = position.y_m - antenna.y_m;
  const float dz = position.z_m - antenna.z_m;
  const float lateral_m = std::sqrt(dx * dx + dz * dz);
  const float straight_m = std::sqrt(dx * dx + dy * dy + dz * dz);
  const WallRay ray = wall.ray(lateral_m, dy);
  const float per_lateral = lateral_m > 0.0f ? ray.lateral / lateral_m : 0.0f;
  return {straight_m + ray.excess_m, {dx * per_lateral, ray.depth, dz * per_lateral}};
}

const char* invalid_field(const Taylor3dConfig& config) {
  if (invalid_field(config.wall) != nullptr) return "wall";
  if (config.start > Taylor3dStart::kGiven) return "start";
  if (config.range_kind > RangeKind::kOneWay) return "range_kind";
  if (!(config.min_step_m > 0.0f && std::isfinite(config.min_step_m))) return "min_step_m";
  if (!(config.max_iterations >= 0 && config.max_iterations <= 100)) return "max_iterations";
  return nullptr;
}

Status Taylor3d::configure(const Taylor3dConfig& config, const Point3& tx, Span<const Point3> rx) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  const bool bistatic = config.range_kind == RangeKind::kBistatic;
  if (rx.size() < (bistatic ? 3u : 4u) || rx.size() > kMaxArrayReceivers) return Status::kInvalidConfig;
  if (bistatic && !finite(tx)) return Status::kInvalidConfig;
  bool in_plane = !bistatic || tx.y_m == 0.0f;
  for (const Point3& receiver : rx) {
    if (!finite(receiver)) return Status::kInvalidConfig;
    in_plane = in_plane && receiver.y_m == 0.0f;
  }
  if (config.start != Taylor3dStart::kGiven && !(bistatic && is_cross(tx, rx))) return Status::kInvalidConfig;
  if (config.wall.compensation != WallCompensation::kNone && !in_plane) return Status::kInvalidConfig;
  const Status status = wall_.configure(config.wall);
  if (status != Status::kOk) return status;
  config_ = config;
  tx_ = tx;
  std::copy(rx.begin(), rx.end(), rx_.begin());
  n_receivers_ = rx.size();
  in_plane_ = in_plane;
  return Status::kOk;
}

Status Taylor3d::read(Span<const float> range_m, Span<const float> variance_m2, Ranges& ranges) const {
  if (range_m.size() != n_receivers_ || variance_m2.size() != n_receivers_) return Status::kInvalidInput;
  for (std::size_t i = 0; i < n_receivers_; ++i) {
    const float variance = variance_m2[i];
    const bool missing = variance == std::numeric_limits<float>::infinity();
    ranges.range_m[i] = missing ? 0.0f : range_m[i];
    ranges.weight[i] = missing ? 0.0f : 1.0f / variance;
    if (missing) continue;
    if (!(variance >= kMinVariance_m2 && variance <= kMaxVariance_m2)) return Status::kInvalidInput;
    if (!(std::abs(range_m[i]) <= kMaxPath3d_m)) return Status::kInvalidInput;
    ++ranges.n_used;
  }
  const std::size_t least = config_.range_kind == RangeKind::kBistatic ? 3 : 4;
  return ranges.n_used < least ? Status::kInvalidInput : Status::kOk;
}

bool Taylor3d::start(const Ranges& ranges, const Point3& given, Taylor3dFix& fix) const {
  fix.position = given;
  if (config_.start != Taylor3dStart::kGiven) {
    const float excess_m = 2.0f * wall_.normal_excess_m();
    std::array<float, 4> path_m;
    for (std::size_t i = 0; i < 4; ++i) {
      if (ranges.weight[i] == 0.0f) return false;
      path_m[i] = ranges.range_m[i] - excess_m;
    }
    const Planar3dMethod method = config_.start == Taylor3dStart::kApproximate ? Planar3dMethod::kApproximate
                                                                               : Planar3dMethod::kThreeDTwoD;
    const Planar3dFix planar = planar_3d(method, rx_[1].x_m, path_m);
    if (planar.status == Planar3dStatus::kBadPath) return false;
    fix.position = planar.position;
    fix.clipped_start = planar.status == Planar3dStatus::kClipped;
  }
  if (in_plane_) fix.position.y_m = std::max(fix.position.y_m, kMinDepth3d_m);
  return true;
}

/// [m] optical path between an antenna and a position, with its gradient by the position.
float Taylor3d::leg(const Point3& position, const Point3& antenna, Point3& gradient) const {
  if (in_plane_) {
    const AntennaRay3d ray = antenna_ray_3d(wall_, position, antenna);
    gradient = ray.gradient;
    return ray.optical_m;
  }
  const float dx = position.x_m - antenna.x_m;
  const float dy = position.y_m - antenna.y_m;
  const float dz = position.z_m - antenna.z_m;
  const float straight_m = std::sqrt(dx * dx + dy * dy + dz * dz);
  const float per_m = straight_m > 0.0f ? 1.0f / straight_m : 0.0f;
  gradient = {dx * per_m, dy * per_m, dz * per_m};
  return straight_m;
}

void Taylor3d::linearise(const Ranges& ranges, const Point3& position, Information& sums) const {
  sums = Information{};
  Point3 to_tx{};
  float tx_m = 0.0f;
  if (config_.range_kind == RangeKind::kBistatic) tx_m = leg(position, tx_, to_tx);
  for (std::size_t i = 0; i < n_receivers_; ++i) {
    const float weight = ranges.weight[i];
    if (weight == 0.0f) continue;
    Point3 to_rx;
    const float predicted_m = tx_m + leg(position, rx_[i], to_rx);
    const float residual_m = ranges.range_m[i] - predicted_m;
    const Vector3 row(to_tx.x_m + to_rx.x_m, to_tx.y_m + to_rx.y_m, to_tx.z_m + to_rx.z_m);
    sums.matrix += (weight * row).lazyProduct(row.transpose());
    sums.gradient += (weight * residual_m) * row;
    sums.squares_m2 += residual_m * residual_m;
  }
}

Status Taylor3d::process(Span<const float> range_m, Span<const float> variance_m2, const Point3& given,
                         Taylor3dFix& fix) const {
  fix = Taylor3dFix{};
  if (n_receivers_ == 0) return Status::kNotConfigured;
  Ranges ranges;
  const Status status = read(range_m, variance_m2, ranges);
  if (status != Status::kOk) return status;
  if (config_.start == Taylor3dStart::kGiven && !finite(given)) return Status::kInvalidInput;
  if (!start(ranges, given, fix)) return Status::kOk;

  Information sums;
  Eigen::LLT<Matrix3> cholesky;
  float previous_m = std::numeric_limits<float>::infinity();
  fix.status = Taylor3dStatus::kIterationLimit;
  for (bool stopped = config_.max_iterations == 0;;) {
    linearise(ranges, fix.position, sums);
    if (!factor(sums.matrix, cholesky)) {
      fix.status = Taylor3dStatus::kSingular;
      fix.position = {};
      return Status::kOk;
    }
    if (stopped) break;
    const Vector3 step = cholesky.solve(sums.gradient);
    const float length_m = step.norm();
    if (!(length_m < previous_m)) {
      fix.status = Taylor3dStatus::kDiverging;
      break;
    }
    fix.position.x_m += step.x();
    fix.position.y_m += step.y();
    fix.position.z_m += step.z();
    if (in_plane_) fix.position.y_m = std::max(fix.position.y_m, kMinDepth3d_m);
    previous_m = length_m;
    ++fix.iterations;
    const bool converged = length_m <= config_.min_step_m;
    stopped = converged || fix.iterations == config_.max_iterations;
    if (stopped) fix.status = converged ? Taylor3dStatus::kConverged : Taylor3dStatus::kIterationLimit;
  }
  for (int column = 0, at = 0; column < 3; ++column) {
    const Vector3 solved = cholesky.solve(Vector3(Vector3::Unit(column)));
    for (int row = column; row < 3; ++row) fix.covariance_m2[static_cast<std::size_t>(at++)] = solved(row);
  }
  fix.range_residual_m = std::sqrt(sums.squares_m2 / static_cast<float>(ranges.n_used));
  return Status::kOk;
}

}  // namespace echofuse::hub
