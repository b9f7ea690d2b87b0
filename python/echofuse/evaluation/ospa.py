"""Distances between two sets of points, estimated and true: OSPA and GOSPA."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment


class Ospa(NamedTuple):
    """An OSPA distance [m]: ``distance**order = localisation**order + cardinality**order``."""

    distance: float
    localisation: float
    cardinality: float


class Gospa(NamedTuple):
    """A GOSPA distance (alpha = 2) [m] and its parts: ``distance**order`` is their sum [m^order]."""

    distance: float
    localisation: float
    missed: float
    false: float
    n_missed: int
    n_false: int


def ospa(
    estimated: NDArray[np.floating], true: NDArray[np.floating], *, cutoff_m: float = 1.0, order: float = 2.0
) -> Ospa:
    """Return the optimal sub-pattern assignment distance of two point sets.

    Schuhmacher, Vo & Vo, IEEE Trans. Signal Processing 56(8), 2008, eq. 3.

    Parameters
    ----------
    estimated, true
        Points (n, d) and (m, d) [m]; either may be empty.
    cutoff_m
        Distance [m] that a point without partner costs, and that no pair exceeds.
    order
        Exponent, at least 1: the larger, the dearer an outlier.
    """
    cost = _capped(estimated, true, cutoff_m) ** order
    larger, smaller = max(cost.shape), min(cost.shape)
    if larger == 0:
        return Ospa(0.0, 0.0, 0.0)
    rows, columns = linear_sum_assignment(cost)
    localisation = float(cost[rows, columns].sum()) / larger
    cardinality = cutoff_m**order * (larger - smaller) / larger
    power = 1.0 / order
    return Ospa((localisation + cardinality) ** power, localisation**power, cardinality**power)


def gospa(
    estimated: NDArray[np.floating], true: NDArray[np.floating], *, cutoff_m: float = 1.0, order: float = 2.0
) -> Gospa:
    """Return the generalised OSPA distance with alpha = 2, which splits into localisation, missed and false.

    Rahmathullah, Garcia-Fernandez & Svensson, FUSION 2017, eq. 1 and proposition 1. Not divided by the number
    of points. Parameters as in `ospa`; a pair at the cut-off counts as one missed and one false point.
    """
    capped = _capped(estimated, true, cutoff_m)
    rows, columns = linear_sum_assignment(capped**order)
    paired = capped[rows, columns][capped[rows, columns] < cutoff_m]
    n_false, n_missed = (size - len(paired) for size in capped.shape)
    half = cutoff_m**order / 2.0
    localisation = float((paired**order).sum())
    missed, false = half * n_missed, half * n_false
    return Gospa(
        (localisation + missed + false) ** (1.0 / order), localisation, missed, false, n_missed, n_false
    )


def _capped(
    estimated: NDArray[np.floating], true: NDArray[np.floating], cutoff_m: float
) -> NDArray[np.float64]:
    """Pairwise distances (n, m) [m], at most ``cutoff_m``."""
    if len(estimated) == 0 or len(true) == 0:
        return np.zeros((len(estimated), len(true)))
    offsets = np.asarray(estimated, float)[:, None, :] - np.asarray(true, float)[None, :, :]
    return np.asarray(np.minimum(np.linalg.norm(offsets, axis=2), cutoff_m), dtype=np.float64)
