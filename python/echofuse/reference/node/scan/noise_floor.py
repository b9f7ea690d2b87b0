"""A least threshold from the quietest part of the scans, so that an empty scan stays silent."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]


class NoiseFloorConfig(Protocol):
    factor: float
    block_samples: int
    averaging_factor: float


class NoiseFloor:
    """Average over scans of the rms of each scan's quietest block that is not all 0."""

    def __init__(self, config: NoiseFloorConfig) -> None:
        self._config = config
        self.reset()

    def reset(self) -> None:
        self.floor = 0.0  # [count]
        self._averaged = 0

    def process(self, amplitude: Samples, threshold: Samples) -> Samples:
        """Return threshold (n,) [count^2], at least (factor * floor)^2; amplitude (n,) [count]."""
        config = self._config
        if config.factor == 0.0:
            return threshold
        block = config.block_samples
        blocks = amplitude[: len(amplitude) // block * block].reshape(-1, block)
        powers = np.mean(blocks**2, axis=1)
        if np.any(powers > 0.0):
            quietest = float(np.sqrt(np.min(powers[powers > 0.0])))
            keep = min(config.averaging_factor, self._averaged / (self._averaged + 1.0))
            self.floor = keep * self.floor + (1.0 - keep) * quietest
            self._averaged += 1
        return np.maximum(threshold, (config.factor * self.floor) ** 2)
