"""CFAR for Gaussian clutter along one response (Dutta, Arora & Bibyk 2006; through-wall paper)."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]

BLIND_SAMPLES = 5  # at the beginning: nothing is decided there


class GaussianCfarConfig(Protocol):
    fast_factor: float
    slow_factor: float
    deviations: float
    spread: str  # "standard_deviation" or "rms"
    starting_samples: int


class GaussianCfarResult(NamedTuple):
    decisions: NDArray[np.uint8]  # (n,)
    margin: Samples  # (n,) fast mean over threshold, less 1


def gaussian_cfar(samples: Samples, config: GaussianCfarConfig) -> GaussianCfarResult:
    """Decide where a fast mean of |samples| (n,) exceeds the slow mean by so many slow deviations.

    The slow statistics begin with what the same recursions leave behind the first samples.
    """
    amplitude = np.abs(samples)
    _, start = _statistics(amplitude[: config.starting_samples], (0.0, 0.0), config)
    rows, _ = _statistics(amplitude, start, config)
    fast, mean, square = rows.T
    threshold = mean + config.deviations * np.sqrt(square)
    margin = np.divide(fast, threshold, out=np.full(len(fast), np.inf), where=threshold > 0.0) - 1.0
    decisions = (fast > threshold).astype(np.uint8)
    decisions[:BLIND_SAMPLES], margin[:BLIND_SAMPLES] = 0, np.inf
    return GaussianCfarResult(decisions, margin)


def _statistics(
    amplitude: Samples, start: tuple[float, float], config: GaussianCfarConfig
) -> tuple[Samples, tuple[float, float]]:
    """Return fast mean, slow mean and slow mean square (n, 3) at each sample, and where the slow ones end."""
    fast, (mean, square) = 0.0, start
    rows = []
    for a in amplitude:
        fast += config.fast_factor * (a - fast)
        mean += config.slow_factor * (a - mean)
        spread = (a - mean) ** 2 if config.spread == "standard_deviation" else a**2
        square += config.slow_factor * (spread - square)
        rows.append((fast, mean, square))
    return np.array(rows).reshape(-1, 3), (mean, square)


def delay_samples(config: GaussianCfarConfig) -> float:
    """Return by how much the fast mean comes late [sample]."""
    return (1.0 - config.fast_factor) / config.fast_factor
