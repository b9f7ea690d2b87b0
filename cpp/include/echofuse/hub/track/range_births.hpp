#pragma once

#include <array>
#include <cstddef>

#include "echofuse/core/bounded_vector.hpp"
#include "echofuse/core/limits.hpp"
#include "echofuse/core/span.hpp"
#include "echofuse/hub/locate/site.hpp"
#include "echofuse/hub/track/people_likelihood.hpp"
#include "echofuse/hub/track/range_config.hpp"

namespace echofuse::hub {

/// Logarithm of how much likelier a node's detection of somebody is with her there than as clutter, for one
/// person by herself. A node that misses her counts no less than a detection that is far off.
struct LoneScore {
  float hit_at_std = 0.0f;  ///< [1] of a detection on the path, for a deviation of 1 m
  float missed = 0.0f;      ///< [1]

  LoneScore() = default;
  explicit LoneScore(const RangeTrackerConfig& config);
  float operator()(float error_m, float std_m, float log_std) const;
};

/// The detection nearest to a path, closer than the gate, or -1.
int nearest(Span<const float> paths_m, float path_m, float gate_m);

/// Where tracks may begin: maxima of the lone score of the newest frame, on a grid over the area.
/// Reference: python/echofuse/reference/hub/track/range_births.py
class RangeBirths {
 public:
  struct Place {
    float score = 0.0f;
    Point at;
  };

  /// The settings are possible (range_config.hpp).
  void configure(const RangeTrackerConfig& config, const Area& area, std::size_t n_nodes);

  /// Places above the birth score, best first.
  void process(const PeopleLikelihood& likelihood, BoundedVector<Place>& places);

 private:
  static constexpr std::size_t kMaxCells = 2048;  ///< 82 m^2 by 0.2 m

  Point place(int column, int row) const;
  float cell_score(const PeopleLikelihood& likelihood, const Point& place) const;
  bool is_maximum(int column, int row) const;

  RangeTrackerConfig config_;
  Area area_;
  std::size_t n_nodes_ = 0;
  float step_m_ = 0.0f;
  int columns_ = 0;
  int rows_ = 0;
  float std_m_ = 0.0f;  ///< [m] of a path at the nearest grid point
  float log_std_ = 0.0f;
  LoneScore lone_;
  std::array<float, kMaxCells> cells_{};  ///< (columns, rows) scores
};

}  // namespace echofuse::hub
