"""Weak-signal enhancement: the far echo is raised to the near one's height (through-wall paper, Sec. 2)."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]


class WeakSignalConfig(Protocol):
    floor_factor: float
    noise_samples: int
    averaging_factor: float


class WeakSignal:
    """Advance normalisation: each sample over the largest magnitude from it to the end.

    A floor of some deviations of the noise keeps the tail, where nothing but noise is left, from being
    raised as well. The noise is the rms of the last samples of the response, averaged over the responses.
    """

    def __init__(self, config: WeakSignalConfig) -> None:
        self.config = config
        self.noise = 0.0  # [count]
        self._averaged = 0

    def process(self, residual: Samples) -> Samples:
        """Return residual (n,) [count] normalised, (n,) in [-1, 1]."""
        rms = float(np.sqrt(np.mean(residual[-self.config.noise_samples :] ** 2)))
        keep = min(self.config.averaging_factor, self._averaged / (self._averaged + 1.0))
        self.noise = keep * self.noise + (1.0 - keep) * rms
        self._averaged += 1
        largest = np.maximum.accumulate(np.abs(residual)[::-1])[::-1]
        divisor = np.maximum(largest, self.config.floor_factor * self.noise)
        return np.divide(residual, divisor, out=np.zeros_like(residual), where=divisor > 0.0)
