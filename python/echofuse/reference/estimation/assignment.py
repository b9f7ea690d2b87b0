"""Assignment of rows to columns at the least total cost (Kuhn 1955, Munkres 1957)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

NONE = -1


def assign(cost: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return for each row of ``cost`` (n_rows, n_columns) its column, or -1; (n_rows,).

    As many pairs as the shorter side has, of the least total cost. One row after another enters along the
    shortest augmenting path, found with row and column potentials that keep every reduced cost non-negative.
    """
    n_rows, n_columns = cost.shape
    if n_rows > n_columns:
        row_of_column = assign(cost.T)
        column_of_row = np.full(n_rows, NONE, np.intp)
        column_of_row[row_of_column] = np.arange(n_columns)
        return column_of_row
    row_potential = np.zeros(n_rows)
    column_potential = np.zeros(n_columns)
    row_of = np.full(n_columns, NONE, np.intp)
    for root in range(n_rows):
        _enter(root, cost, row_potential, column_potential, row_of)
    column_of_row = np.full(n_rows, NONE, np.intp)
    for column in np.flatnonzero(row_of != NONE):
        column_of_row[row_of[column]] = column
    return column_of_row


def _enter(
    root: int,
    cost: NDArray[np.float64],
    row_potential: NDArray[np.float64],
    column_potential: NDArray[np.float64],
    row_of: NDArray[np.intp],
) -> None:
    """Add row ``root`` along the shortest alternating path to a free column (Dijkstra, reduced costs)."""
    n_columns = cost.shape[1]
    distance = np.full(n_columns, np.inf)
    previous = np.full(n_columns, NONE, np.intp)  # column from whose row this one was reached
    done = np.zeros(n_columns, bool)
    row, column, shortest = root, NONE, 0.0
    while True:
        reduced = shortest + cost[row] - row_potential[row] - column_potential
        shorter = ~done & (reduced < distance)
        distance[shorter] = reduced[shorter]
        previous[shorter] = column
        column = int(np.argmin(np.where(done, np.inf, distance)))
        shortest = float(distance[column])
        done[column] = True
        if row_of[column] == NONE:
            break
        row = int(row_of[column])
    row_potential[root] += shortest
    for other in np.flatnonzero(done & (row_of != NONE)):
        row_potential[row_of[other]] += shortest - distance[other]
        column_potential[other] -= shortest - distance[other]
    while column != NONE:
        row_of[column] = row_of[previous[column]] if previous[column] != NONE else root
        column = int(previous[column])


def assignment_margin(
    cost: NDArray[np.float64], columns: NDArray[np.intp], cap: NDArray[np.float64]
) -> float:
    """How much dearer the next best decision is, over the largest cap.

    ``cost`` (n_rows, n_columns) is capped at ``cap`` (n_rows,): a pair at its cap is no pair. Another
    decision either lacks one of the pairs found, or adds a pair of a free row and a free column that is just
    at its cap.
    """
    if cost.size == 0:
        return np.inf
    best = _total(cost, columns)
    margin = np.inf
    free_rows = np.ones(cost.shape[0], bool)
    free_columns = np.ones(cost.shape[1], bool)
    for row, column in enumerate(columns):
        if column == NONE or cost[row, column] >= cap[row]:
            continue
        free_rows[row], free_columns[column] = False, False
        without = cost.copy()
        without[row, column] = cap[row]
        margin = min(margin, _total(without, assign(without)) - best)
    distance_to_cap = np.abs(cap[:, None] - cost)[np.ix_(free_rows, free_columns)]
    below = distance_to_cap[distance_to_cap > 0.0]
    return float(min(margin, below.min(initial=np.inf)) / cap.max())


def _total(cost: NDArray[np.float64], columns: NDArray[np.intp]) -> float:
    rows = np.flatnonzero(columns != NONE)
    return float(cost[rows, columns[rows]].sum())
