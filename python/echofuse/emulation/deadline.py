"""Instructions to time: the deadline monitor's stated processor."""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Count = TypeVar("Count", float, NDArray[np.int64])


@dataclass(frozen=True, kw_only=True)
class Processor:
    """What turns counted instructions into time. The emulator counts no cycles, so their ratio is a statement."""

    clock_hz: float = 216e6
    cycles_per_instruction: float = 1.0

    def time_s(self, instructions: Count) -> Count:
        """Return the time [s] that so many instructions take."""
        return instructions * (self.cycles_per_instruction / self.clock_hz)
