"""Coherent integration of the pulses of one scan (sensor-radar paper, Sec. IV-A)."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]


class PulseIntegratorConfig(Protocol):
    pulses_per_scan: int


class PulseIntegrator:
    """Mean of every `pulses_per_scan` pulse responses in a row."""

    def __init__(self, config: PulseIntegratorConfig) -> None:
        self._pulses_per_scan = config.pulses_per_scan
        self._pulses: list[Samples] = []

    def reset(self) -> None:
        self._pulses = []

    def process(self, pulse: Samples) -> Samples | None:
        """Take pulse (n_samples,) [count]; the scan (n_samples,) when it completes one, else None."""
        self._pulses.append(pulse)
        if len(self._pulses) < self._pulses_per_scan:
            return None
        scan: Samples = np.mean(self._pulses, axis=0)
        self._pulses = []
        return scan
