"""Instructions to time: the deadline monitor's stated processor."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, kw_only=True)
class Processor:
    """What turns counted instructions into time; the emulator counts no cycles: their ratio is stated."""

    clock_hz: float = 216e6
    cycles_per_instruction: float = 1.0

    def time_s(self, instructions: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the time [s] that so many instructions take."""
        return np.asarray(instructions * (self.cycles_per_instruction / self.clock_hz), np.float64)
