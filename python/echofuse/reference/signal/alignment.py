"""Alignment of a scan with the background's (sensor-radar paper, footnote 11)."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]


class AlignmentConfig(Protocol):
    method: str  # "sub_sample", "integer" or "none"
    max_shift_samples: int
    window_samples: int
    interpolator_half_length_samples: int


class Alignment(NamedTuple):
    shift_samples: float  # how much later the envelope is than the reference [sample]
    correlation: float  # normalised, at the best whole shift [1]
    margin: float  # lead of the best whole shift over the second, relative


def estimate_shift(
    envelope: Samples, reference: Samples, coarse_shift: int, first: int, last: int, config: AlignmentConfig
) -> Alignment:
    """Maximise sum_k envelope[k + m] reference[k], first <= k < last, |m - coarse| <= max shift.

    envelope, reference: (n_samples,) [count]; the envelope counts as 0 outside. A parabola through the best m
    and its neighbours gives the fraction, unless the best m is the last one allowed.
    """
    reach = 0 if config.method == "none" else config.max_shift_samples
    centre = 0 if config.method == "none" else coarse_shift
    pad = reach + abs(centre)
    padded = np.pad(envelope, pad)
    template = reference[first:last]
    shifts = np.arange(centre - reach, centre + reach + 1)
    windows = np.stack([padded[pad + first + m : pad + last + m] for m in shifts])  # (n_shifts, last - first)
    products = windows @ template
    best = int(np.argmax(products))
    energy = float(np.sqrt(np.sum(windows[best] ** 2) * np.sum(template**2)))
    correlation = float(products[best]) / energy if energy > 0.0 else 0.0
    second = np.max(np.delete(products, best), initial=0.0)
    margin = 1.0 - float(second) / float(products[best]) if products[best] > 0.0 else 0.0
    shift = float(shifts[best])
    if config.method == "sub_sample" and 0 < best < len(shifts) - 1:
        left, peak, right = products[best - 1 : best + 2]
        curvature = left - 2.0 * peak + right
        if curvature < 0.0:
            shift += 0.5 * float((left - right) / curvature)
    return Alignment(shift, correlation, margin)


def interpolator(fraction: float, half_length: int) -> Samples:
    """Taps for offsets -half_length + 1 .. half_length: a Blackman-windowed sinc at `fraction`."""
    x = np.arange(-half_length + 1, half_length + 1) - fraction
    window = 0.42 + 0.5 * np.cos(np.pi * x / half_length) + 0.08 * np.cos(2.0 * np.pi * x / half_length)
    taps = np.sinc(x) * window
    result: Samples = taps / taps.sum()
    return result


def shifted(samples: Samples, shift_samples: float, config: AlignmentConfig) -> Samples:
    """Return samples (n,) read at k + shift_samples, which undoes a delay of that much; 0 outside."""
    n = len(samples)
    whole = int(np.floor(shift_samples))
    fraction = shift_samples - whole
    half_length = config.interpolator_half_length_samples
    taps = np.array([1.0]) if fraction == 0.0 else interpolator(fraction, half_length)
    offsets = np.array([0]) if fraction == 0.0 else np.arange(-half_length + 1, half_length + 1)
    output = np.zeros(n)
    for tap, offset in zip(taps, offsets, strict=True):
        source = np.arange(n) + whole + offset
        inside = (source >= 0) & (source < n)
        output[inside] += tap * samples[source[inside]]
    return output
