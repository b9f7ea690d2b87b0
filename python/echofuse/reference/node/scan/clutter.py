"""Removal of what stands still (sensor-radar paper, Sec. IV-D)."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]


class ClutterConfig(Protocol):
    method: str  # "empty_room_" + "envelope", "scan" or "shadowed", "exponential_average", "frame_difference"
    averaging_factor: float
    learning_scans: int
    difference_lag_scans: int
    shadow_window_samples: int


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
        if method == "empty_room_shadowed":
            return samples - shadowed(background, samples, self._config.shadow_window_samples)
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


def shadowed(background: Samples, samples: Samples, window: int) -> Samples:
    """What is left of background (n,) in samples (n,) [count].

    Around each sample, by a triangle of `window` samples, the background and its slope (its quadrature, as it
    is a band-pass signal) are each fitted to the samples; they may weaken the background, not strengthen it.
    """
    padded = np.concatenate([[0.0], background, [0.0]])
    slope = padded[2:] - padded[:-2]

    def around(values: Samples) -> Samples:
        triangle = np.convolve(np.ones(window // 2 + 1), np.ones(window // 2 + 1))
        return np.convolve(values, triangle)[window // 2 : window // 2 + len(values)]

    power, slope_power = around(background**2), around(slope**2)
    usable = (power > 0.0) & (slope_power > 0.0)
    power, slope_power = np.where(usable, power, 1.0), np.where(usable, slope_power, 1.0)
    gain, turn = around(samples * background) / power, around(samples * slope) / slope_power
    strength = np.sqrt(gain**2 + turn**2 * slope_power / power)
    left = (gain * background + turn * slope) / np.maximum(1.0, strength)
    return np.where(usable, left, 0.0)


def rectified(samples: Samples) -> Samples:
    """Half-wave rectifier: a person adds energy, what got weaker is a shadow (ghost mitigation)."""
    return np.maximum(0.0, samples)
