#include "echofuse/estimation/assignment.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "echofuse/core/limits.hpp"

namespace echofuse::estimation {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

/// Rows enter one after another; potentials keep every reduced cost non-negative. rows <= columns here: the
/// caller swaps the strides otherwise.
class Assignment {
 public:
  Assignment(const float* cost, std::size_t row_stride, std::size_t column_stride, std::size_t n_columns)
      : cost_(cost), row_stride_(row_stride), column_stride_(column_stride), n_columns_(n_columns) {
    row_of_.fill(kUnassigned);
  }

  /// Adds a row along the shortest alternating path to a free column (Dijkstra on the reduced costs).
  void enter(std::size_t root) {
    std::array<float, kMaxAssignment> distance;
    std::array<int, kMaxAssignment> previous;
    std::array<bool, kMaxAssignment> done;
    distance.fill(kFar);
    previous.fill(kUnassigned);
    done.fill(false);
    std::size_t row = root;
    int column = kUnassigned;
    float shortest = 0.0f;
    do {
      relax(row, shortest, column, done, distance, previous);
      column = nearest(done, distance);
      const auto reached = static_cast<std::size_t>(column);
      shortest = distance[reached];
      done[reached] = true;
      if (row_of_[reached] != kUnassigned) row = static_cast<std::size_t>(row_of_[reached]);
    } while (row_of_[static_cast<std::size_t>(column)] != kUnassigned);
    shift_potentials(root, shortest, done, distance);
    augment(root, column, previous);
  }

  int row_of(std::size_t column) const { return row_of_[column]; }

 private:
  void relax(std::size_t row, float shortest, int from, const std::array<bool, kMaxAssignment>& done,
             std::array<float, kMaxAssignment>& distance, std::array<int, kMaxAssignment>& previous) const {
    for (std::size_t column = 0; column < n_columns_; ++column) {
      if (done[column]) continue;
      const float cost = cost_[row * row_stride_ + column * column_stride_];
      const float reduced = shortest + cost - row_potential_[row] - column_potential_[column];
      if (reduced < distance[column]) {
        distance[column] = reduced;
        previous[column] = from;
      }
    }
  }

  int nearest(const std::array<bool, kMaxAssignment>& done,
              const std::array<float, kMaxAssignment>& distance) const {
    int best = kUnassigned;
    float best_distance = kFar;
    for (std::size_t column = 0; column < n_columns_; ++column) {
      if (!done[column] && distance[column] < best_distance) {
        best = static_cast<int>(column);
        best_distance = distance[column];
      }
    }
    return best;
  }

  void shift_potentials(std::size_t root, float shortest, const std::array<bool, kMaxAssignment>& done,
                        const std::array<float, kMaxAssignment>& distance) {
    row_potential_[root] += shortest;
    for (std::size_t column = 0; column < n_columns_; ++column) {
      if (!done[column] || row_of_[column] == kUnassigned) continue;
      const float shift = shortest - distance[column];
      row_potential_[static_cast<std::size_t>(row_of_[column])] += shift;
      column_potential_[column] -= shift;
    }
  }

  void augment(std::size_t root, int column, const std::array<int, kMaxAssignment>& previous) {
    while (column != kUnassigned) {
      const int before = previous[static_cast<std::size_t>(column)];
      row_of_[static_cast<std::size_t>(column)] =
          before == kUnassigned ? static_cast<int>(root) : row_of_[static_cast<std::size_t>(before)];
      column = before;
    }
  }

  const float* cost_;
  std::size_t row_stride_, column_stride_, n_columns_;
  std::array<float, kMaxAssignment> row_potential_{};
  std::array<float, kMaxAssignment> column_potential_{};
  std::array<int, kMaxAssignment> row_of_{};
};

}  // namespace

Status assign(Span<const float> cost, std::size_t n_rows, std::size_t n_columns, Span<int> column_of_row) {
  if (n_rows > kMaxAssignment || n_columns > kMaxAssignment || cost.size() != n_rows * n_columns ||
      column_of_row.size() != n_rows)
    return Status::kInvalidInput;
  for (const float value : cost)
    if (!std::isfinite(value)) return Status::kInvalidInput;
  for (int& column : column_of_row) column = kUnassigned;
  if (cost.empty()) return Status::kOk;

  if (n_rows <= n_columns) {
    Assignment solver(cost.data(), n_columns, 1, n_columns);
    for (std::size_t row = 0; row < n_rows; ++row) solver.enter(row);
    for (std::size_t column = 0; column < n_columns; ++column)
      if (const int row = solver.row_of(column); row != kUnassigned)
        column_of_row[static_cast<std::size_t>(row)] = static_cast<int>(column);
  } else {
    Assignment solver(cost.data(), 1, n_columns, n_rows);
    for (std::size_t column = 0; column < n_columns; ++column) solver.enter(column);
    for (std::size_t row = 0; row < n_rows; ++row) column_of_row[row] = solver.row_of(row);
  }
  return Status::kOk;
}

}  // namespace echofuse::estimation
