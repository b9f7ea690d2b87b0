#include "echofuse/hub/locate/line_locator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace echofuse::hub {
namespace {

constexpr float kMinDepth_m = 0.02f;
constexpr float kMinDeterminant = 1e-6f;
constexpr float kMinCondition = 1e-6f;
constexpr float kConvergedStep_m = 1e-4f;
constexpr float kMaxStep_m = 1.0f;
constexpr int kMaxIterations = 10;

float distance_m(const Point& a, const Point& b) {
  const float dx = a.x_m - b.x_m;
  const float dy = a.y_m - b.y_m;
  return std::sqrt(dx * dx + dy * dy);
}

}  // namespace

const char* invalid_field(const LineLocatorConfig& config) {
  if (invalid_field(config.wall) != nullptr) return "wall";
  if (!(config.path_std_m > 0.0f && std::isfinite(config.path_std_m))) return "path_std_m";
  return nullptr;
}

AntennaRay antenna_ray(const Wall& wall, const Point& position, float antenna_x_m) {
  const float across_m = position.x_m - antenna_x_m;
  const WallRay ray = wall.ray(std::abs(across_m), position.y_m);
  const float straight_m = std::sqrt(across_m * across_m + position.y_m * position.y_m);
  return {straight_m + ray.excess_m, {across_m < 0.0f ? -ray.lateral : ray.lateral, ray.depth}};
}

LineFix two_ellipses(float path1_m, float path2_m, float rx1_x_m, float rx2_x_m) {
  LineFix fix;
  fix.converged = true;
  const float d1 = path1_m, d2 = path2_m, x1 = rx1_x_m, x2 = rx2_x_m;
  if (!(d1 > std::abs(x1) && d2 > std::abs(x2))) return fix;
  const float determinant = x1 * d2 - x2 * d1;
  if (!(std::abs(determinant) > kMinDeterminant * (std::abs(x1) * d2 + std::abs(x2) * d1))) return fix;
  // k2 d1 - k1 d2 with its differences taken first, as d1 and d2 are nearly the same.
  const float x = 0.5f * ((d2 - d1) * (d1 * d2 + x1 * x1) + d1 * (x1 - x2) * (x1 + x2)) / determinant;
  const float r0 = (x1 * x + 0.5f * (d1 - x1) * (d1 + x1)) / d1;
  const float y_squared = (r0 - x) * (r0 + x);
  if (!(r0 > 0.0f && d1 > r0 && d2 > r0 && y_squared >= 0.0f)) return fix;
  fix.position = {x, std::sqrt(y_squared)};
  fix.status = fix.position.y_m >= kMinDepth_m ? LineFixStatus::kFix : LineFixStatus::kTooNearAxis;
  return fix;
}

Status LineLocator::configure(const LineLocatorConfig& config, Span<const float> rx_x_m) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  if (rx_x_m.size() < 2 || rx_x_m.size() > kMaxArrayReceivers) return Status::kInvalidConfig;
  for (std::size_t i = 0; i < rx_x_m.size(); ++i) {
    if (!std::isfinite(rx_x_m[i]) || rx_x_m[i] == 0.0f) return Status::kInvalidConfig;
    for (std::size_t k = 0; k < i; ++k)
      if (rx_x_m[i] == rx_x_m[k]) return Status::kInvalidConfig;
  }
  const Status status = wall_.configure(config.wall);
  if (status != Status::kOk) return status;
  path_variance_m2_ = config.path_std_m * config.path_std_m;
  n_receivers_ = rx_x_m.size();
  std::copy(rx_x_m.begin(), rx_x_m.end(), rx_x_m_.begin());
  return Status::kOk;
}

Status LineLocator::process(Span<const float> path_m, Span<const float> weight, LineFix& fix) const {
  fix = LineFix{};
  if (n_receivers_ == 0) return Status::kNotConfigured;
  if (path_m.size() != n_receivers_ || weight.size() != n_receivers_) return Status::kInvalidInput;
  Paths paths;
  for (std::size_t i = 0; i < n_receivers_; ++i) {
    if (!(weight[i] >= 0.0f && std::isfinite(weight[i]))) return Status::kInvalidInput;
    if (weight[i] == 0.0f) continue;
    if (!std::isfinite(path_m[i])) return Status::kInvalidInput;
    paths.rx_x_m[paths.n] = rx_x_m_[i];
    paths.path_m[paths.n] = path_m[i];
    paths.weight[paths.n++] = weight[i];
  }
  if (paths.n < 2) return Status::kInvalidInput;
  start(paths, fix);
  if (fix.status == LineFixStatus::kFix) refine(paths, fix);
  return Status::kOk;
}

LineFix LineLocator::behind_wall(float path1_m, float path2_m, float rx1_x_m, float rx2_x_m) const {
  const float excess_m = 2.0f * wall_.normal_excess_m();
  LineFix fix = two_ellipses(path1_m - excess_m, path2_m - excess_m, rx1_x_m, rx2_x_m);
  if (wall_.config().compensation != WallCompensation::kSecondKind) return fix;
  for (int iteration = 1; iteration <= kMaxIterations && fix.status == LineFixStatus::kFix; ++iteration) {
    const Point at = fix.position;
    const float tx_excess_m = wall_.ray(std::abs(at.x_m), at.y_m).excess_m;
    const float rx1_excess_m = wall_.ray(std::abs(at.x_m - rx1_x_m), at.y_m).excess_m;
    const float rx2_excess_m = wall_.ray(std::abs(at.x_m - rx2_x_m), at.y_m).excess_m;
    fix = two_ellipses(path1_m - tx_excess_m - rx1_excess_m, path2_m - tx_excess_m - rx2_excess_m, rx1_x_m,
                       rx2_x_m);
    fix.iterations = iteration;
    fix.converged = fix.status != LineFixStatus::kFix || distance_m(at, fix.position) < kConvergedStep_m;
    if (fix.converged) break;
  }
  return fix;
}

/// The pair with the least weighted squares of all paths' residuals; the first one when none has a fix.
void LineLocator::start(const Paths& paths, LineFix& fix) const {
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < paths.n; ++i) {
    for (std::size_t k = i + 1; k < paths.n; ++k) {
      const LineFix candidate =
          behind_wall(paths.path_m[i], paths.path_m[k], paths.rx_x_m[i], paths.rx_x_m[k]);
      const bool first = i == 0 && k == 1;
      if (candidate.status != LineFixStatus::kFix) {
        if (first) fix = candidate;
        continue;
      }
      const float cost = information(paths, candidate.position).cost;
      if (!first && !(cost < least)) continue;
      least = cost;
      fix = candidate;
    }
  }
}

LineLocator::Information LineLocator::information(const Paths& paths, const Point& position) const {
  const AntennaRay tx = antenna_ray(wall_, position, 0.0f);
  Information sums;
  for (std::size_t i = 0; i < paths.n; ++i) {
    const AntennaRay path = tx + antenna_ray(wall_, position, paths.rx_x_m[i]);
    const float x = path.gradient.x_m;
    const float y = path.gradient.y_m;
    const float residual = paths.path_m[i] - path.optical_m;
    const float weight = paths.weight[i];
    sums.xx += weight * x * x;
    sums.xy += weight * x * y;
    sums.yy += weight * y * y;
    sums.x += weight * x * residual;
    sums.y += weight * y * residual;
    sums.cost += weight * residual * residual;
  }
  return sums;
}

void LineLocator::refine(const Paths& paths, LineFix& fix) const {
  if (paths.n > 2) {
    fix.iterations = 0;
    fix.converged = false;
  }
  for (;;) {
    const Information sums = information(paths, fix.position);
    const float determinant = sums.xx * sums.yy - sums.xy * sums.xy;
    const float trace = sums.xx + sums.yy;
    if (!(determinant > kMinCondition * trace * trace)) {
      fix.status = LineFixStatus::kSingular;
      return;
    }
    if (paths.n == 2 || fix.converged || fix.iterations == kMaxIterations) {
      const float scale = path_variance_m2_ / determinant;
      fix.covariance_xx_m2 = scale * sums.yy;
      fix.covariance_xy_m2 = -scale * sums.xy;
      fix.covariance_yy_m2 = scale * sums.xx;
      return;
    }
    const Point step{(sums.yy * sums.x - sums.xy * sums.y) / determinant,
                     (sums.xx * sums.y - sums.xy * sums.x) / determinant};
    const float length = distance_m(step, {0.0f, 0.0f});
    const float scale = length > kMaxStep_m ? kMaxStep_m / length : 1.0f;
    fix.position.x_m += scale * step.x_m;
    fix.position.y_m = std::max(fix.position.y_m + scale * step.y_m, kMinDepth_m);
    ++fix.iterations;
    fix.converged = length < kConvergedStep_m;
  }
}

}  // namespace echofuse::hub
