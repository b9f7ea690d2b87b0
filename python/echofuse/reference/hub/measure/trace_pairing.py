"""Couples of two receivers' traces (through-wall paper, steps 4 to 7 of the TOA association, mended)."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.reference.estimation.assignment import assign, assignment_margin

Array = NDArray[np.float64]


class TracePairingConfig(Protocol):
    rule: str  # assignment | all_pairs
    closing: str  # exact | printed
    separation_m: float
    clock_hz: float
    correction_samples: int
    completion_limit: int


class Couple(NamedTuple):
    delay_s: tuple[float, float]
    centre: float  # [sample] C, the middle of both traces
    completions: int  # responses for which it was copied


class Step(NamedTuple):
    couples: list[Couple]
    margin: float  # least relative distance of a decision from flipping


class TracePairing:
    """State: the couples of the last response."""

    def __init__(self, config: TracePairingConfig) -> None:
        self.config = config
        separation = config.separation_m / SPEED_OF_LIGHT_MPS * config.clock_hz
        self.width = float(np.floor(separation + 0.5) + config.correction_samples)
        self.half_width = float(np.ceil(self.width / 2))
        self.previous: list[Couple] = []

    def couple(self, n1: float, n2: float) -> Couple:
        """Close a couple of two traces [sample] (step 7)."""
        centre = (n1 + n2) / 2
        gap = abs(n1 - n2) / 2
        if self.config.closing == "printed":  # (3) is a sample early, and (11) takes (6) for half as wide
            centre -= 1.0
            gap = self.width - (2 * self.half_width + 1 - abs(n1 - n2)) / 2
        first, second = (centre - gap, centre + gap) if n1 <= n2 else (centre + gap, centre - gap)
        return Couple((first / self.config.clock_hz, second / self.config.clock_hz), (n1 + n2) / 2, 0)

    def process(self, delay1_s: Array, delay2_s: Array) -> Step:
        """Pair the traces (n1,) and (n2,) [s] of one response."""
        n1, n2 = delay1_s * self.config.clock_hz, delay2_s * self.config.clock_hz
        # between the values that whole samples have
        limit, q = 2 * self.half_width + 0.5, self.half_width + 0.25
        apart = np.abs(n1[:, None] - n2[None, :])
        margin = float(np.min(np.abs(apart / limit - 1.0), initial=1.0))
        if self.config.rule == "all_pairs":
            return Step([self.couple(n1[i], n2[k]) for i, k in np.argwhere(apart <= limit)], margin)
        cap = limit + 0.5
        cost = np.where(apart <= limit, apart, cap)
        column = assign(cost) if cost.size else np.full(len(n1), -1)
        margin = min(margin, assignment_margin(cost, column, np.full(len(n1), cap)) if cost.size else 1.0)
        pairs = [(i, int(k)) for i, k in enumerate(column) if k >= 0 and cost[i, k] < cap]
        couples = [self.couple(n1[i], n2[k]) for i, k in pairs]
        lonely = [n for i, n in enumerate(n1) if i not in {p[0] for p in pairs}]
        lonely += [n for k, n in enumerate(n2) if k not in {p[1] for p in pairs}]
        free = []
        for old in self.previous:
            gaps = np.array([abs(old.centre - couple.centre) for couple in couples])
            margin = min(margin, float(np.min(np.abs(gaps / q - 1.0), initial=1.0)))
            if not np.any(gaps <= q) and old.completions < self.config.completion_limit:
                free.append(old)
        for n in lonely:
            gaps = np.array([abs(old.centre - n) for old in free])
            if len(gaps) == 0:
                continue
            ordered = np.sort(gaps)
            margin = min(margin, float(np.min(np.abs(gaps / q - 1.0))), *((np.diff(ordered[:2])) / q))
            best = int(np.argmin(gaps))
            if gaps[best] <= q:
                old = free.pop(best)
                couples.append(old._replace(completions=old.completions + 1))
        self.previous = couples
        return Step(couples, margin)
