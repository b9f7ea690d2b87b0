#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"
#include "echofuse/hub/locate/site.hpp"

namespace echofuse::hub {

enum class EllipseRefinement : std::uint8_t {
  kGaussNewton,  ///< minimise the path residuals from (23) on
  kNone,         ///< the paper's (23)
};

struct EllipseConfig {
  EllipseRefinement refinement = EllipseRefinement::kGaussNewton;
  int max_iterations = 10;       ///< of Gauss-Newton, in [1, 50]
  float max_step_m = 1.0f;       ///< [m] a longer step is shortened to this, > 0
  float body_radius_m = 0.0f;    ///< [m] echoes come from a round person's skin, in [0, 1]
  float robust_scale_m = 0.15f;  ///< [m] in refine(): weight / (1 + (residual / scale)^2); 0: all alike
};

const char* invalid_field(const EllipseConfig& config);

struct RangeEllipse {
  Point tx;
  Point rx;
  float path_m = 0.0f;  ///< [m] measured path tx -> person -> rx
  float weight = 1.0f;  ///< [1] relative inverse variance of the path
};

struct EllipseFix {
  Point position;
  float range_residual_m = 0.0f;      ///< [m] RR: root mean square of measured minus predicted path
  float equation_residual_m3 = 0.0f;  ///< [m^3] RE of (25) at (23); NaN unless all share one transmitter
  int iterations = 0;
  bool converged = false;  ///< the last step was under 0.1 mm, or there was nothing to iterate
};

/// One person's position from n >= 3 paths (sensor-radar paper, eqs. 16-23). With z the position, q_i the
/// path of pair i: z.(x_i - x_t) + p_i = q_i |z - x_t|, from which the pair k of the shortest path eliminates
/// |z - x_t|: the linear least squares A z = g. Pairs that are all monostatic give differences of circles;
/// mixed pairs, or a singular A, start from the best of 32 points on the smallest ellipse within the area.
/// Then Gauss-Newton on q_i - |z - x_t| - |z - x_i|.
/// Reference: python/echofuse/reference/hub/locate/ellipse_least_squares.py
class EllipseLeastSquares {
 public:
  /// kInvalidConfig: the earlier configuration stays in force.
  Status configure(const EllipseConfig& config);

  /// kInvalidInput: fewer than 3 ellipses, or a singular geometry; fix is then meaningless.
  Status process(Span<const RangeEllipse> ellipses, const Area& area, EllipseFix& fix) const;

  /// Only the start of process(): (23) or the best sample. iterations is 0.
  Status start(Span<const RangeEllipse> ellipses, const Area& area, EllipseFix& fix) const;

  /// Gauss-Newton from fix.position; robust: down-weights foul paths by config.robust_scale_m.
  Status refine(Span<const RangeEllipse> ellipses, bool robust, EllipseFix& fix) const;

  const EllipseConfig& config() const { return config_; }

 private:
  static constexpr std::size_t kStartSamples = 32;

  bool solve_linear(Span<const RangeEllipse> ellipses, EllipseFix& fix) const;
  bool best_sample(Span<const RangeEllipse> ellipses, const Area& area, EllipseFix& fix) const;
  float range_residual(Span<const RangeEllipse> ellipses, const Point& position) const;

  EllipseConfig config_;
  std::array<Point, kStartSamples> circle_;  ///< [1] unit circle
  bool configured_ = false;
};

}  // namespace echofuse::hub
