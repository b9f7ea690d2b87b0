"""Systematic resampling (Kitagawa, J. Computational and Graphical Statistics 5, 1996)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Resampling(NamedTuple):
    """Which particle each new particle copies, and how far that choice is from its neighbour."""

    indices: NDArray[np.intp]  # (n_out,) ascending
    margin: NDArray[
        np.float64
    ]  # (n_out,) distance of the pointer to the next cumulative weight, over the total


def systematic_resample(weights: NDArray[np.float64], uniform: float, n_out: int) -> Resampling:
    """Draw n_out indices, each as often as its share of ``weights`` (n,), from one uniform number in [0, 1).

    The k-th pointer, (k + uniform) * total / n_out, falls on the first particle whose cumulative weight
    exceeds it. Without any weight there is nothing to draw: the result is empty.
    """
    cumulative = np.cumsum(weights)
    total = float(cumulative[-1]) if len(weights) else 0.0
    if total <= 0.0 or n_out == 0:
        return Resampling(np.zeros(0, np.intp), np.zeros(0))
    pointers = (np.arange(n_out) + uniform) * (total / n_out)
    last = int(np.flatnonzero(weights > 0.0)[-1])
    indices = np.minimum(np.searchsorted(cumulative, pointers, side="right"), last)
    edges = np.concatenate([[0.0], cumulative])
    margin = np.abs(edges[None, :] - pointers[:, None]).min(axis=1) / total
    return Resampling(indices, margin)
