"""Simple targets for distributed ones: steps 1 to 3 of the TOA association (through-wall paper, Sec. 3.2)."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray


class TargetTraceConfig(Protocol):
    window_samples: int
    least_hits: int
    density_correction: bool


class TargetTraces(NamedTuple):
    sums: NDArray[np.intp]  # (n,) equation (1)
    toa_samples: NDArray[np.float64]  # (n_traces,) ascending [sample]
    weight: NDArray[np.intp]  # (n_traces,) largest sum of each


def target_traces(decisions: NDArray[np.uint8], config: TargetTraceConfig) -> TargetTraces:
    """Return the traces in the detector's decisions (n,).

    With hits in a share p of a target's samples the sum reaches least_hits late by (least_hits - 1)
    (1 / p - 1) samples on average; the density correction takes p from the largest sum.
    """
    counts = np.concatenate([[0], np.cumsum(decisions.astype(np.intp))])
    ends = np.arange(1, len(decisions) + 1)
    sums = counts[ends] - counts[np.maximum(ends - config.window_samples, 0)]
    inside = np.concatenate([[False], sums >= config.least_hits, [False]])
    begins = np.flatnonzero(inside[1:-1] & ~inside[:-2] & inside[2:])
    toas, weights = [], []
    for begin in begins:
        behind = np.flatnonzero(~inside[begin + 1 :])[0] + begin
        weight = int(np.max(sums[begin:behind]))
        toa = float(begin - (config.least_hits - 1))
        if config.density_correction:
            toa -= (config.least_hits - 1) * (min(config.window_samples / weight, 3.0) - 1.0)
        toas.append(max(toa, 0.0))
        weights.append(weight)
    return TargetTraces(sums, np.array(toas), np.array(weights, np.intp))
