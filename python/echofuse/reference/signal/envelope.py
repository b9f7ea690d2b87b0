"""Amplitude envelope of a scan (sensor-radar paper, Sec. IV-B)."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]


class EnvelopeConfig(Protocol):
    method: str  # "hilbert" or "square_low_pass"
    hilbert_half_length_samples: int
    low_pass_half_length_samples: int
    low_pass_cutoff_hz: float


def raised_cosine(offset: Samples, half_length: int) -> Samples:
    """Hann window, 1 at offset 0 and 0 at +-(half_length + 1)."""
    return 0.5 + 0.5 * np.cos(np.pi * offset / (half_length + 1))


def hilbert_filter(half_length: int) -> Samples:
    """Taps (2 half_length + 1,) of a Hilbert transformer: 2 / (pi n) at odd n, 0 at even n, windowed."""
    n = np.arange(-half_length, half_length + 1, dtype=np.float64)
    odd = n % 2 != 0
    taps = np.zeros_like(n)
    taps[odd] = 2.0 / (np.pi * n[odd])
    return taps * raised_cosine(n, half_length)


def low_pass_filter(half_length: int, cutoff_hz: float, sample_rate_hz: float) -> Samples:
    """Impulse response (2 half_length + 1,) of a windowed sinc that passes a constant unchanged."""
    n = np.arange(-half_length, half_length + 1, dtype=np.float64)
    taps = np.sinc(2.0 * cutoff_hz / sample_rate_hz * n) * raised_cosine(n, half_length)
    gain = float(taps.sum())
    return taps / gain


def filtered(samples: Samples, taps: Samples) -> Samples:
    """Convolve without delay, same length; samples (n,) count as 0 outside, taps (2 h + 1,)."""
    half_length = len(taps) // 2
    return np.convolve(samples, taps)[half_length : half_length + len(samples)]


def envelope(scan: Samples, sample_rate_hz: float, config: EnvelopeConfig) -> Samples:
    """Return the amplitude envelope of scan (n_samples,) [count]: |r + jH(r)|, or sqrt(2 LPF(r^2))."""
    if config.method == "hilbert":
        return np.hypot(scan, filtered(scan, hilbert_filter(config.hilbert_half_length_samples)))
    taps = low_pass_filter(config.low_pass_half_length_samples, config.low_pass_cutoff_hz, sample_rate_hz)
    return np.sqrt(np.maximum(0.0, 2.0 * filtered(scan**2, taps)))
