#pragma once

#include <cstddef>

#include "echofuse/core/span.hpp"
#include "echofuse/core/status.hpp"

namespace echofuse::estimation {

inline constexpr int kUnassigned = -1;

/// Pairs rows with columns at the least total cost (Kuhn 1955, Munkres 1957), by shortest augmenting paths:
/// at most min(rows, columns)^2 * max(rows, columns) steps. cost: (n_rows, n_columns) row by row, finite.
/// column_of_row: (n_rows,) filled; kUnassigned for the rows left over when there are more rows than columns.
/// kInvalidInput: more than kMaxAssignment rows or columns, lengths that do not fit, a cost that is not
/// finite. Reference: python/echofuse/reference/estimation/assignment.py
Status assign(Span<const float> cost, std::size_t n_rows, std::size_t n_columns, Span<int> column_of_row);

}  // namespace echofuse::estimation
