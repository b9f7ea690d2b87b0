"""Time of arrival of the direct path by a threshold on the envelope (sensor-radar paper, Sec. IV-C)."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

MIN_NOISE_SAMPLES = 8  # fewer say nothing about the noise


class DirectPathConfig(Protocol):
    search: str  # "serial_backward", "threshold_crossing" or "jump_back_search_forward"
    noise_samples: int
    early_detection_probability: float
    window_samples: int


class DirectPath(NamedTuple):
    found: bool
    toa_samples: float  # 0 unless found [sample]
    threshold: float  # [count]
    peak_sample: int
    margin: float  # least relative distance of a deciding comparison


NOT_FOUND = DirectPath(False, 0.0, 0.0, 0, 1.0)


def threshold_factor(config: DirectPathConfig) -> float:
    """Threshold over sigma that Rayleigh noise exceeds within noise_samples, early, by chance."""
    no_crossing_per_sample = (1.0 - config.early_detection_probability) ** (1.0 / config.noise_samples)
    return float(np.sqrt(-2.0 * np.log(1.0 - no_crossing_per_sample)))


def direct_path(envelope: NDArray[np.float64], config: DirectPathConfig) -> DirectPath:
    """Search the direct path in envelope (n_samples,) [count].

    sigma^2 is half the mean square of the last `noise_samples` before peak - window. The crossing between the
    first sample above the threshold and the one before it is interpolated linearly.
    """
    peak = int(np.argmax(envelope))
    start = max(0, peak - config.window_samples)
    head = envelope[max(0, start - config.noise_samples) : start]
    if len(head) < MIN_NOISE_SAMPLES:
        return NOT_FOUND
    threshold = threshold_factor(config) * float(np.sqrt(np.mean(head**2) / 2.0))
    above = envelope > threshold
    if not above[peak]:
        return NOT_FOUND._replace(threshold=threshold, peak_sample=peak)
    if config.search == "serial_backward":
        below = np.flatnonzero(~above[start:peak])
        first = start + int(below[-1]) + 1 if len(below) else start
        examined = envelope[max(0, first - 1) : peak + 1]
    else:
        begin = 0 if config.search == "threshold_crossing" else start
        first = begin + int(np.argmax(above[begin : peak + 1]))
        examined = envelope[begin : first + 1]
    toa = float(first)
    if first > 0 and not above[first - 1]:
        toa -= (envelope[first] - threshold) / (envelope[first] - envelope[first - 1])
    others = np.delete(envelope, peak)
    margin = min(
        float(np.min(np.abs(examined - threshold))) / max(threshold, 1e-30),
        1.0 - float(np.max(others)) / float(envelope[peak]),
    )
    return DirectPath(True, toa, threshold, peak, margin)
