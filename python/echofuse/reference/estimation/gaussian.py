"""The Gaussian kernel that all likelihoods here share: cut at five standard deviations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

CUT_SQUARED = 25.0
"""Beyond this squared Mahalanobis distance a likelihood is zero (exp(-12.5) = 4e-6 of its peak)."""


def gaussian_kernel(squared_distance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return exp(-d^2 / 2) for d^2 <= 25 and 0 beyond, any shape."""
    return np.where(squared_distance <= CUT_SQUARED, np.exp(-0.5 * squared_distance), 0.0)
