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

    Searched are the samples from `before_samples` before the trace to `after_samples` behind it. A trace
    whose window lies outside, or holds nothing, stays.
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

    The step at k is the mean of envelope (n,) from k on less that before k; outside the envelope is 0. From
    one neighbour to the next the parabola's place is continuous, so only others can change it by much.
    """
    means = np.convolve(np.pad(envelope, mean_samples), np.full(mean_samples, 1.0 / mean_samples), "valid")
    steps = (means[mean_samples:] - means[:-mean_samples])[first : last + 1]
    best = int(np.argmax(steps))
    inside = 0 < best < len(steps) - 1
    others = np.abs(np.arange(len(steps)) - best) > (1 if inside else 0)
    next_best = float(np.max(steps[others], initial=-np.inf))
    margin = (float(steps[best]) - next_best) / float(np.max(envelope[first : last + 1]))
    if not inside:
        return float(first + best), margin
    before, largest, behind = (float(step) for step in steps[best - 1 : best + 2])
    curvature = before - 2.0 * largest + behind
    return first + best + (0.5 * (before - behind) / curvature if curvature < 0.0 else 0.0), margin
