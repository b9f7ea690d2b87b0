"""Where a target's echo begins, to a fraction of a sample (docs/decisions/0007-leading-edge.md)."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]


class LeadingEdgeConfig(Protocol):
    rule: str  # fraction | contrast
    fraction: float
    mean_samples: int
    before_samples: int
    after_samples: int


class LeadingEdges(NamedTuple):
    toa_samples: Samples  # (n_traces,) [sample]
    margin: float  # least relative distance of a deciding comparison from flipping


def leading_edge(envelope: Samples, toa_samples: Samples, config: LeadingEdgeConfig) -> LeadingEdges:
    """Move each trace (n_traces,) [sample] to where its echo begins in envelope (n,) [count].

    Searched are the samples from `before_samples` before the trace to `after_samples` behind it. A trace whose
    window lies outside, or holds nothing, stays.
    """
    moved, margin = toa_samples.copy(), np.inf
    for which, toa in enumerate(toa_samples):
        nearest = int(np.floor(toa + 0.5))
        first = max(nearest - config.before_samples, 0)
        last = min(nearest + config.after_samples, len(envelope) - 1)
        window = envelope[first : last + 1]
        if len(window) == 0 or not np.max(window) > 0.0:
            continue
        if config.rule == "contrast":
            found, found_margin = largest_step(envelope, first, last, config.mean_samples)
        else:
            found, found_margin = first_above(window, config.fraction * float(np.max(window)))
            found += first
        moved[which], margin = found, min(margin, found_margin)
    return LeadingEdges(moved, margin)


def first_above(window: Samples, level: float) -> tuple[float, float]:
    """Return where window (n,) first exceeds level, a straight line between samples, and the margin."""
    margin = float(np.min(np.abs(window / level - 1.0)))
    crossed = int(np.argmax(window > level))
    if crossed == 0:
        return 0.0, margin
    low, high = window[crossed - 1], window[crossed]
    return crossed - 1 + float((level - low) / (high - low)), margin


def largest_step(envelope: Samples, first: int, last: int, mean_samples: int) -> tuple[float, float]:
    """Return the place in [first, last] with the largest step, a parabola between samples, and the margin.

    The step at k is the mean of envelope (n,) from k on less that before k, 0 outside. The margin is that over
    the largest step which is no neighbour's: between neighbours the place is continuous.
    """
    padded = np.pad(envelope, mean_samples)
    means = np.convolve(padded, np.full(mean_samples, 1.0 / mean_samples), "valid")  # of those from k - mean_samples on
    steps = (means[mean_samples:] - means[:-mean_samples])[first : last + 1]
    best = int(np.argmax(steps))
    elsewhere = np.abs(np.arange(len(steps)) - best) > 1
    next_best = float(np.max(steps[elsewhere], initial=-np.inf))
    margin = (float(steps[best]) - next_best) / float(np.max(envelope[first : last + 1]))
    if best in (0, len(steps) - 1):
        at_edge = float(np.max(np.diff(np.sort(steps)[-2:]), initial=0.0)) if len(steps) > 1 else 1.0
        return float(first + best), min(margin, at_edge / float(np.max(envelope[first : last + 1])))
    before, largest, behind = steps[best - 1 : best + 2]
    curvature = before - 2.0 * largest + behind
    return first + best + float(0.5 * (before - behind) / curvature if curvature < 0.0 else 0.0), margin
