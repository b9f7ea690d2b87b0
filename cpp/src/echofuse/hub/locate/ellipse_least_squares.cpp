#include "echofuse/hub/locate/ellipse_least_squares.hpp"

#include <cmath>
#include <limits>

#include "echofuse/core/constants.hpp"

namespace echofuse::hub {
namespace {

constexpr float kMinCondition = 1e-6f;     ///< det / trace^2 of the normal matrix; below, it is singular
constexpr float kConvergedStep_m = 1e-4f;  ///< far under any radar's error

/// Sums of a weighted 2 x 2 normal equation.
struct Normal {
  float xx = 0.0f, xy = 0.0f, yy = 0.0f, x = 0.0f, y = 0.0f;

  void add(float row_x, float row_y, float value, float weight) {
    xx += weight * row_x * row_x;
    xy += weight * row_x * row_y;
    yy += weight * row_y * row_y;
    x += weight * row_x * value;
    y += weight * row_y * value;
  }

  [[nodiscard]] bool solve(Point& solution) const {
    const float determinant = xx * yy - xy * xy;
    const float trace = xx + yy;
    if (!(determinant > kMinCondition * trace * trace)) return false;
    solution = {(yy * x - xy * y) / determinant, (xx * y - xy * x) / determinant};
    return true;
  }
};

bool equal(const Point& a, const Point& b) { return a.x_m == b.x_m && a.y_m == b.y_m; }

std::size_t shortest(Span<const RangeEllipse> ellipses) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < ellipses.size(); ++i)
    if (ellipses[i].path_m < ellipses[best].path_m) best = i;
  return best;
}

/// One row a.z = g of the linear system, positions relative to the pivot's transmitter.
struct Row {
  float x, y, g;
};

/// (20)-(21) with the origin at x_t, where (18) is p = (q^2 - |x|^2) / 2.
Row ellipse_row(const RangeEllipse& pivot, const RangeEllipse& other, float widening_m) {
  const float q_k = pivot.path_m + widening_m;
  const float q_i = other.path_m + widening_m;
  const float k_x = pivot.rx.x_m - pivot.tx.x_m;
  const float k_y = pivot.rx.y_m - pivot.tx.y_m;
  const float i_x = other.rx.x_m - pivot.tx.x_m;
  const float i_y = other.rx.y_m - pivot.tx.y_m;
  const float p_k = 0.5f * (q_k * q_k - k_x * k_x - k_y * k_y);
  const float p_i = 0.5f * (q_i * q_i - i_x * i_x - i_y * i_y);
  return {q_i * k_x - q_k * i_x, q_i * k_y - q_k * i_y, q_k * p_i - q_i * p_k};
}

/// Difference of the circles of two monostatic nodes, origin at the pivot's node.
Row circle_row(const RangeEllipse& pivot, const RangeEllipse& other, float widening_m) {
  const float r_k = 0.5f * (pivot.path_m + widening_m);
  const float r_i = 0.5f * (other.path_m + widening_m);
  const float i_x = other.rx.x_m - pivot.rx.x_m;
  const float i_y = other.rx.y_m - pivot.rx.y_m;
  return {2.0f * i_x, 2.0f * i_y, r_k * r_k - r_i * r_i + i_x * i_x + i_y * i_y};
}

}  // namespace

const char* invalid_field(const EllipseConfig& config) {
  if (config.refinement > EllipseRefinement::kNone) return "refinement";
  if (config.max_iterations < 1 || config.max_iterations > 50) return "max_iterations";
  if (!(config.max_step_m > 0.0f && std::isfinite(config.max_step_m))) return "max_step_m";
  if (!(config.body_radius_m >= 0.0f && config.body_radius_m <= 1.0f)) return "body_radius_m";
  if (!(config.robust_scale_m >= 0.0f && std::isfinite(config.robust_scale_m))) return "robust_scale_m";
  return nullptr;
}

Status EllipseLeastSquares::configure(const EllipseConfig& config) {
  if (invalid_field(config) != nullptr) return Status::kInvalidConfig;
  config_ = config;
  for (std::size_t i = 0; i < kStartSamples; ++i) {
    // Half a step off the axes: nodes stand on walls, and so would samples stand on the area's edge.
    const float angle = 2.0f * kPi * (static_cast<float>(i) + 0.5f) / static_cast<float>(kStartSamples);
    circle_[i] = {std::cos(angle), std::sin(angle)};
  }
  configured_ = true;
  return Status::kOk;
}

Status EllipseLeastSquares::process(Span<const RangeEllipse> ellipses, const Area& area,
                                    EllipseFix& fix) const {
  const Status started = start(ellipses, area, fix);
  if (started != Status::kOk || config_.refinement == EllipseRefinement::kNone) return started;
  return refine(ellipses, false, fix);
}

Status EllipseLeastSquares::start(Span<const RangeEllipse> ellipses, const Area& area,
                                  EllipseFix& fix) const {
  fix = EllipseFix{};
  if (!configured_) return Status::kNotConfigured;
  if (ellipses.size() < 3) return Status::kInvalidInput;
  fix.equation_residual_m3 = std::numeric_limits<float>::quiet_NaN();
  if (!solve_linear(ellipses, fix) && !best_sample(ellipses, area, fix)) return Status::kInvalidInput;
  fix.range_residual_m = range_residual(ellipses, fix.position);
  fix.converged = true;
  return Status::kOk;
}

/// (23); with a body radius all paths are first widened by 2 R, the offset of an echo straight back.
bool EllipseLeastSquares::solve_linear(Span<const RangeEllipse> ellipses, EllipseFix& fix) const {
  const std::size_t k = shortest(ellipses);
  const RangeEllipse& pivot = ellipses[k];
  bool shared = true;
  bool monostatic = true;
  for (const RangeEllipse& ellipse : ellipses) {
    shared = shared && equal(ellipse.tx, pivot.tx);
    monostatic = monostatic && equal(ellipse.tx, ellipse.rx);
  }
  if (!shared && !monostatic) return false;

  const float widening_m = 2.0f * config_.body_radius_m;
  const auto row_of = [&](const RangeEllipse& other) {
    return shared ? ellipse_row(pivot, other, widening_m) : circle_row(pivot, other, widening_m);
  };
  Normal normal;
  for (std::size_t i = 0; i < ellipses.size(); ++i) {
    if (i == k) continue;
    const Row row = row_of(ellipses[i]);
    normal.add(row.x, row.y, row.g, 1.0f);
  }
  Point offset;
  if (!normal.solve(offset)) return false;
  fix.position = {pivot.tx.x_m + offset.x_m, pivot.tx.y_m + offset.y_m};
  if (!shared) return true;

  float sum = 0.0f;
  for (std::size_t i = 0; i < ellipses.size(); ++i) {
    if (i == k) continue;
    const Row row = row_of(ellipses[i]);
    const float error = row.x * offset.x_m + row.y * offset.y_m - row.g;
    sum += error * error;
  }
  fix.equation_residual_m3 = std::sqrt(sum);
  return true;
}

bool EllipseLeastSquares::best_sample(Span<const RangeEllipse> ellipses, const Area& area,
                                      EllipseFix& fix) const {
  const RangeEllipse& smallest = ellipses[shortest(ellipses)];
  const float widening_m = 2.0f * config_.body_radius_m;
  const float major = 0.5f * (smallest.path_m + widening_m);
  const float half_x = 0.5f * (smallest.rx.x_m - smallest.tx.x_m);
  const float half_y = 0.5f * (smallest.rx.y_m - smallest.tx.y_m);
  const float half_squared = half_x * half_x + half_y * half_y;
  if (!(major > 0.0f && major * major > half_squared)) return false;
  const float half = std::sqrt(half_squared);
  const float minor = std::sqrt(major * major - half_squared);
  const float along_x = half > 0.0f ? half_x / half : 1.0f;
  const float along_y = half > 0.0f ? half_y / half : 0.0f;

  float least = std::numeric_limits<float>::infinity();
  for (const Point& unit : circle_) {
    const float along = major * unit.x_m;
    const float across = minor * unit.y_m;
    const Point point{smallest.tx.x_m + half_x + along * along_x - across * along_y,
                      smallest.tx.y_m + half_y + along * along_y + across * along_x};
    if (!contains(area, point)) continue;
    float cost = 0.0f;
    for (const RangeEllipse& ellipse : ellipses) {
      const float error = ellipse.path_m + widening_m - path_length(point, ellipse.tx, ellipse.rx, 0.0f);
      cost += error * error;
    }
    if (!(cost < least)) continue;
    least = cost;
    fix.position = point;
  }
  return std::isfinite(least);
}

Status EllipseLeastSquares::refine(Span<const RangeEllipse> ellipses, bool robust, EllipseFix& fix) const {
  if (!configured_) return Status::kNotConfigured;
  const float per_scale = robust && config_.robust_scale_m > 0.0f ? 1.0f / config_.robust_scale_m : 0.0f;
  fix.iterations = 0;
  fix.converged = false;
  while (fix.iterations < config_.max_iterations && !fix.converged) {
    Normal normal;
    for (const RangeEllipse& ellipse : ellipses) {
      Point gradient;
      const float residual = ellipse.path_m - path_length(fix.position, ellipse.tx, ellipse.rx,
                                                          config_.body_radius_m, &gradient);
      const float scaled = residual * per_scale;
      normal.add(gradient.x_m, gradient.y_m, residual, ellipse.weight / (1.0f + scaled * scaled));
    }
    Point step;
    if (!normal.solve(step)) return Status::kInvalidInput;
    const float length = std::sqrt(step.x_m * step.x_m + step.y_m * step.y_m);
    const float scale = length > config_.max_step_m ? config_.max_step_m / length : 1.0f;
    fix.position.x_m += scale * step.x_m;
    fix.position.y_m += scale * step.y_m;
    ++fix.iterations;
    fix.converged = length < kConvergedStep_m;
  }
  fix.range_residual_m = range_residual(ellipses, fix.position);
  return Status::kOk;
}

float EllipseLeastSquares::range_residual(Span<const RangeEllipse> ellipses, const Point& position) const {
  float sum = 0.0f;
  for (const RangeEllipse& ellipse : ellipses) {
    const float error = ellipse.path_m - path_length(position, ellipse.tx, ellipse.rx, config_.body_radius_m);
    sum += error * error;
  }
  return std::sqrt(sum / static_cast<float>(ellipses.size()));
}

}  // namespace echofuse::hub
