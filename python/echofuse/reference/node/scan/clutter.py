"""Removal of what stands still (sensor-radar paper, Sec. IV-D)."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]


class ClutterConfig(Protocol):
    method: str  # "empty_room_envelope", "empty_room_scan", "exponential_average" or "frame_difference"
    averaging_factor: float
    learning_scans: int
    difference_lag_scans: int


class ClutterFilter:
    """Difference between a scan (or its envelope) and a background, equation (13)."""

    def __init__(self, config: ClutterConfig) -> None:
        self._config = config
        self.reset()

    def reset(self) -> None:
        self._empty_room: list[Samples] = []
        self._learnt: list[Samples] = []
        self._history: list[Samples] = []
        self._average: Samples | None = None
        self._averaged = 0

    @property
    def ready(self) -> bool:
        if self._config.method == "frame_difference":
            return len(self._history) >= self._config.difference_lag_scans
        if self._config.method == "exponential_average":
            return self._averaged >= self._config.learning_scans
        return bool(self._empty_room) or len(self._learnt) >= self._config.learning_scans

    def add_empty_room(self, samples: Samples) -> None:
        """Add one scan or envelope (n_samples,) of the empty room, in place of what was learnt."""
        self._empty_room.append(samples)
        self._average = np.mean(self._empty_room, axis=0)
        self._averaged = max(self._config.learning_scans, len(self._empty_room))

    def process(self, samples: Samples) -> Samples:
        """Return samples - background (n_samples,) [count], signed; all 0 while that is being learnt."""
        method = self._config.method
        if method == "frame_difference":
            return self._frame_difference(samples)
        if method == "exponential_average":
            return self._exponential_average(samples)
        if not self.ready:
            self._learnt.append(samples)
            return np.zeros_like(samples)
        background: Samples = np.mean(self._empty_room or self._learnt, axis=0)
        return samples - background

    def _frame_difference(self, samples: Samples) -> Samples:
        ready = self.ready
        self._history.append(samples)
        if not ready:
            return np.zeros_like(samples)
        return samples - self._history.pop(0)

    def _exponential_average(self, samples: Samples) -> Samples:
        ready = self.ready
        previous = np.zeros_like(samples) if self._average is None else self._average
        keep = min(self._config.averaging_factor, self._averaged / (self._averaged + 1.0))
        self._average = keep * previous + (1.0 - keep) * samples
        self._averaged += 1
        return samples - previous if ready else np.zeros_like(samples)


def rectified(samples: Samples) -> Samples:
    """Half-wave rectifier: a person adds energy, what got weaker is a shadow (ghost mitigation)."""
    return np.maximum(0.0, samples)
