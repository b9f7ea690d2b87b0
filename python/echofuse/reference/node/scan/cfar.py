"""Detectors with a constant false-alarm rate (sensor-radar paper, Sec. IV-E)."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Samples = NDArray[np.float64]


class CfarConfig(Protocol):
    method: str  # "double_threshold_buffer", "cell_averaging", "global_average" or "ordered_statistic"
    false_alarm_probability: float
    training_cells_per_side: int
    guard_cells_per_side: int
    ordered_rank_fraction: float
    local_factor: float
    global_factor: float
    buffer_samples: int
    max_rises: int
    rise_threshold_factor: float


class CfarResult(NamedTuple):
    threshold: Samples  # (n_samples,) on the squared amplitude [count^2]
    decisions: NDArray[np.uint8]  # (n_samples,)
    margin: Samples  # (n_samples,) least relative distance of a deciding comparison from flipping


def averaging_factor(cells: int, false_alarm_probability: float) -> float:
    """Threshold over the mean of `cells` exponential cells."""
    return float(cells * (false_alarm_probability ** (-1.0 / cells) - 1.0))


def ordered_rank(cells: int, rank_fraction: float) -> int:
    """Rank k, from 1, of the cell that stands for the noise."""
    return min(cells, max(1, int(np.ceil(rank_fraction * cells - 1e-4))))


def ordered_factor(cells: int, rank: int, false_alarm_probability: float) -> float:
    """Threshold over the rank-th smallest of exponential cells: P_fa = prod (N - i) / (N - i + alpha)."""
    remaining = cells - np.arange(rank, dtype=np.float64)

    def excess(factor: float) -> float:  # falls with factor
        return float(np.sum(np.log(remaining / (remaining + factor))) - np.log(false_alarm_probability))

    low, high = 0.0, 1.0
    while excess(high) > 0.0:
        high *= 2.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle) > 0.0 else (low, middle)
    return 0.5 * (low + high)


def training_cells(k: int, n_samples: int, config: CfarConfig) -> NDArray[np.intp]:
    """Indices S_k of equation (14), cut at the scan's ends; all but the guarded for `global_average`."""
    guard = config.guard_cells_per_side
    reach = n_samples if config.method == "global_average" else guard + config.training_cells_per_side
    left = np.arange(max(0, k - reach), max(0, k - guard))
    right = np.arange(min(n_samples, k + guard + 1), min(n_samples, k + reach + 1))
    return np.concatenate([left, right])


def cfar(amplitude: Samples, config: CfarConfig) -> CfarResult:
    """Decide for every sample of amplitude (n_samples,) [count] whether its square exceeds the threshold."""
    power = amplitude**2
    if config.method == "double_threshold_buffer":
        return _double_threshold_buffer(power, config)
    factors: dict[int, float] = {}
    threshold = np.empty_like(power)
    for k in range(len(power)):
        cells = power[training_cells(k, len(power), config)]
        n = len(cells)
        rank = ordered_rank(n, config.ordered_rank_fraction)
        if config.method == "ordered_statistic":
            if n not in factors:
                factors[n] = ordered_factor(n, rank, config.false_alarm_probability)
            threshold[k] = factors[n] * np.sort(cells)[rank - 1]
        else:
            threshold[k] = averaging_factor(n, config.false_alarm_probability) * np.mean(cells)
    margin = np.abs(power - threshold) / np.maximum(np.maximum(power, threshold), 1e-300)
    return CfarResult(threshold, (power > threshold).astype(np.uint8), margin)


def _double_threshold_buffer(power: Samples, config: CfarConfig) -> CfarResult:
    forward = double_threshold_buffer_pass(power, config)
    backward = double_threshold_buffer_pass(power[::-1], config)
    threshold = np.minimum(forward.threshold, backward.threshold[::-1])
    margin = np.minimum(forward.margin, backward.margin[::-1])
    return CfarResult(threshold, (power > threshold).astype(np.uint8), margin)


def double_threshold_buffer_pass(power: Samples, config: CfarConfig) -> CfarResult:
    """Algorithm 1 in one direction over power (n_samples,) [count^2]; untested ones have threshold inf."""
    global_power = float(np.mean(power))
    rise = config.rise_threshold_factor * global_power
    buffer = list(power[: config.buffer_samples])
    frozen = False
    frozen_power = 0.0
    rises = 0
    threshold = np.full(len(power), np.inf)
    decisions = np.zeros(len(power), dtype=np.uint8)
    margin = np.ones(len(power))
    for k in range(config.buffer_samples, len(power)):
        local_power = frozen_power if frozen else float(np.mean(buffer))
        threshold[k] = config.local_factor * local_power + config.global_factor * global_power
        comparisons = [(power[k], threshold[k])]
        if power[k] > threshold[k]:
            decisions[k] = 1
        else:
            buffer = [*buffer[1:], power[k]]
            local_power = float(np.mean(buffer))
            comparisons += [(power[k], power[k - 1] + rise)]
            if power[k] > power[k - 1] + rise:
                rises += 1
            else:
                comparisons += [(power[k] + rise / 2.0, power[k - 1])]
                if power[k] < power[k - 1] - rise / 2.0:
                    rises = 0
            if rises > config.max_rises and not frozen:
                frozen, frozen_power = True, local_power
            elif frozen:
                comparisons += [(local_power, frozen_power)]
                if local_power < frozen_power:
                    frozen, rises = False, 0
        margin[k] = min(abs(a - b) / max(a, b, 1e-300) for a, b in comparisons)
    # A comparison that flips changes the buffer, and with it what follows.
    return CfarResult(threshold, decisions, np.minimum.accumulate(margin))
