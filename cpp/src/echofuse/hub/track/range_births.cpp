#include "echofuse/hub/track/range_births.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "echofuse/core/check.hpp"

namespace echofuse::hub {
namespace {

constexpr float kLogSqrtTwoPi = 0.91893853f;
constexpr float kGridVariance = 0.3f;  ///< [1] times the step squared: of a path at the nearest grid point
constexpr float kGateStds = 4.0f;
constexpr int kNeighbours = 2;  ///< [cell] a maximum is the best so far around

}  // namespace

LoneScore::LoneScore(const RangeTrackerConfig& config)
    : hit_at_std(std::log(config.candidate_detection_probability / config.candidate_clutter_per_m) -
                 kLogSqrtTwoPi),
      missed(std::log(1.0f - config.candidate_detection_probability)) {}

float LoneScore::operator()(float error_m, float std_m, float log_std) const {
  const float deviations = error_m / std_m;
  return std::max(hit_at_std - log_std - 0.5f * deviations * deviations, missed);
}

int nearest(Span<const float> paths_m, float path_m, float gate_m) {
  int best = -1;
  float least = gate_m;
  for (std::size_t i = 0; i < paths_m.size(); ++i) {
    const float error = std::fabs(paths_m[i] - path_m);
    if (!(error < least)) continue;
    least = error;
    best = static_cast<int>(i);
  }
  return best;
}

void RangeBirths::configure(const RangeTrackerConfig& config, const Area& area, std::size_t n_nodes) {
  config_ = config;
  area_ = area;
  n_nodes_ = n_nodes;
  const float width = area.max_x_m - area.min_x_m;
  const float height = area.max_y_m - area.min_y_m;
  step_m_ = std::max(config.birth_step_m, std::max(width, height) / static_cast<float>(kMaxCells / 4));
  const auto cells = [&](float length) { return std::max(1, static_cast<int>(length / step_m_)); };
  while (cells(width) * cells(height) > static_cast<int>(kMaxCells)) step_m_ *= 1.1f;
  columns_ = cells(width);
  rows_ = cells(height);
  std_m_ = std::sqrt(config.path_std_m * config.path_std_m + kGridVariance * step_m_ * step_m_);
  log_std_ = std::log(std_m_);
  lone_ = LoneScore(config);
}

Point RangeBirths::place(int column, int row) const {
  return {area_.min_x_m + (static_cast<float>(column) + 0.5f) * step_m_,
          area_.min_y_m + (static_cast<float>(row) + 0.5f) * step_m_};
}

/// As soon as the birth score is out of reach, the lowest number: no other cell needs to know more.
float RangeBirths::cell_score(const PeopleLikelihood& likelihood, const Point& place) const {
  const float most = std::max(lone_.hit_at_std - log_std_, 0.0f);
  float score = 0.0f;
  float left = static_cast<float>(n_nodes_);
  for (std::size_t node = 0; node < n_nodes_; ++node, left -= 1.0f) {
    if (score + left * most < config_.birth_score) return std::numeric_limits<float>::lowest();
    const float path = likelihood.visible_path(place, node);
    if (path < 0.0f) continue;
    const Span<const float> paths = likelihood.paths(node);
    const int own = nearest(paths, path, kGateStds * std_m_);
    score += own < 0 ? lone_.missed : lone_(paths[static_cast<std::size_t>(own)] - path, std_m_, log_std_);
  }
  return score;
}

bool RangeBirths::is_maximum(int column, int row) const {
  const int index = column * rows_ + row;
  const float score = cells_[static_cast<std::size_t>(index)];
  if (score < config_.birth_score) return false;
  for (int c = std::max(0, column - kNeighbours); c <= std::min(columns_ - 1, column + kNeighbours); ++c) {
    for (int r = std::max(0, row - kNeighbours); r <= std::min(rows_ - 1, row + kNeighbours); ++r) {
      const int other = c * rows_ + r;
      const float value = cells_[static_cast<std::size_t>(other)];
      if (value > score || (value == score && other < index)) return false;
    }
  }
  return true;
}

void RangeBirths::process(const PeopleLikelihood& likelihood, BoundedVector<Place>& places) {
  places.clear();
  for (int column = 0; column < columns_; ++column)
    for (int row = 0; row < rows_; ++row)
      cells_[static_cast<std::size_t>(column * rows_ + row)] = cell_score(likelihood, place(column, row));
  for (int column = 0; column < columns_; ++column) {
    for (int row = 0; row < rows_; ++row) {
      if (!is_maximum(column, row)) continue;
      const Place found{cells_[static_cast<std::size_t>(column * rows_ + row)], place(column, row)};
      if (places.full() && found.score <= places.back().score) continue;
      if (places.full()) places.pop_back();
      ECHOFUSE_CHECK(places.try_push_back(found));
      for (std::size_t i = places.size() - 1; i > 0 && places[i].score > places[i - 1].score; --i)
        std::swap(places[i], places[i - 1]);
    }
  }
}

}  // namespace echofuse::hub
