"""Time zero of an M-sequence radar from the cross-talk between its antennas (through-wall paper, Sec. 2)."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]


class TimeZeroConfig(Protocol):
    learning_responses: int
    strong_fraction: float
    least_peak_factor: float
    moved_samples: int
    moved_responses: int


class TimeZeroResult(NamedTuple):
    found: bool  # the response could be rotated
    moved: bool  # the radar was switched on anew: what was learnt is void, and learning begins again
    rotation: int  # [sample] to the left
    fraction_samples: float  # cross-talk behind its sample, in [-0.5, 0.5]
    response: Samples  # (n_kept,) rotated and cut; all 0 while it is not known
    margin: float  # least relative distance of a deciding comparison from flipping


class CrossTalk(NamedTuple):
    sample: int
    fraction_samples: float
    found: bool
    margin: float


def cross_talk(response: Samples, config: TimeZeroConfig) -> CrossTalk:
    """Find the first strong maximum of |response| (n,) [count], which repeats itself every n samples.

    Strong is what reaches a fraction of the largest; the first is the one with the longest rest before it,
    since nothing comes before the cross-talk but the ends of the farthest echoes.
    """
    amplitude = np.abs(response)
    n = len(amplitude)
    largest = float(np.max(amplitude))
    mean = float(np.mean(amplitude))
    margin = abs(largest / (config.least_peak_factor * mean) - 1.0) if mean > 0.0 else np.inf
    if not largest > config.least_peak_factor * mean:
        return CrossTalk(0, 0.0, False, margin)
    before, after = np.roll(amplitude, 1), np.roll(amplitude, -1)
    level = config.strong_fraction * largest
    strong = np.flatnonzero((amplitude >= level) & (amplitude > before) & (amplitude >= after))
    margin = min(margin, float(np.min(np.abs(amplitude / level - 1.0))))
    margin = min(margin, float(np.min(np.abs(amplitude[strong] - before[strong]) / largest)))
    rest = (strong - np.roll(strong, 1) - 1) % n  # one alone has rested for the whole period
    first = int(strong[np.argmax(rest)])
    left, middle, right = amplitude[first - 1], amplitude[first], amplitude[(first + 1) % n]
    curvature = left - 2.0 * middle + right
    return CrossTalk(first, float(0.5 * (left - right) / curvature) if curvature < 0.0 else 0.0, True, margin)


class TimeZero:
    """Learns where the cross-talk is from the mean of the first responses, and turns each response to it."""

    def __init__(self, config: TimeZeroConfig, expected_samples: float) -> None:
        """expected_samples: of the cross-talk behind transmission [sample]."""
        self.config, self.expected = config, round(expected_samples)
        self.learnt: list[Samples] = []
        self.place: CrossTalk | None = None
        self.elsewhere = 0  # responses in a row

    def process(self, response: Samples, kept_samples: int = 0) -> TimeZeroResult:
        """Turn response (n,) [count] and keep so many samples of it from its beginning; 0: all."""
        nothing = np.zeros(kept_samples or len(response))
        if self.place is None:
            self.learnt.append(response)
            if len(self.learnt) < self.config.learning_responses:
                return TimeZeroResult(False, False, 0, 0.0, nothing, np.inf)
            place = cross_talk(np.mean(self.learnt, axis=0), self.config)
            self.learnt = []
            if place.found:
                self.place, self.elsewhere = place, 0
            return TimeZeroResult(False, False, 0, 0.0, nothing, place.margin)
        here = cross_talk(response, self.config)
        n = len(response)
        off = (here.sample - self.place.sample + n // 2) % n - n // 2
        if not here.found or abs(off) > self.config.moved_samples:
            self.elsewhere += 1
            if self.elsewhere >= self.config.moved_responses:
                self.place, self.learnt = None, [response]
                return TimeZeroResult(False, True, 0, 0.0, nothing, here.margin)
            return TimeZeroResult(False, False, 0, 0.0, nothing, here.margin)
        self.elsewhere = 0
        rotation = (self.place.sample - self.expected) % n
        kept = np.roll(response, -rotation)[: len(nothing)]
        return TimeZeroResult(True, False, rotation, self.place.fraction_samples, kept, here.margin)
