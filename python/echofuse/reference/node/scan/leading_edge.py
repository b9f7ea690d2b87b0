"""Where a target's echo begins, to a fraction of a sample (docs/decisions/0007-leading-edge.md)."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]


class LeadingEdgeConfig(Protocol):
    fraction: float
    before_samples: int
    after_samples: int


class LeadingEdges(NamedTuple):
    toa_samples: Samples  # (n_traces,) [sample]
    margin: float  # least relative distance of a deciding comparison from flipping


def leading_edge(envelope: Samples, toa_samples: Samples, config: LeadingEdgeConfig) -> LeadingEdges:
    """Move each trace (n_traces,) [sample] to where envelope (n,) [count] exceeds a fraction of its largest.

    Searched are the samples from `before_samples` before the trace to `after_samples` behind it, and the
    first such place is taken. Between two samples the envelope is a straight line. A trace whose window lies
    outside, or holds nothing, stays.
    """
    moved, margin = toa_samples.copy(), np.inf
    for which, toa in enumerate(toa_samples):
        nearest = int(np.floor(toa + 0.5))
        first = max(nearest - config.before_samples, 0)
        window = envelope[first : nearest + config.after_samples + 1]
        if len(window) == 0 or not np.max(window) > 0.0:
            continue
        level = config.fraction * np.max(window)
        margin = min(margin, float(np.min(np.abs(window / level - 1.0))))
        crossed = int(np.argmax(window > level))
        if crossed == 0:
            moved[which] = first
            continue
        low, high = window[crossed - 1], window[crossed]
        moved[which] = first + crossed - 1 + (level - low) / (high - low)
    return LeadingEdges(moved, margin)
