"""One-dimensional clustering of the detector's decisions (sensor-radar paper, Sec. IV-F; algorithms 6.6)."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray


class RangeClusterConfig(Protocol):
    merge_distance_s: float
    min_weight: int
    representative: str  # "leading_edge" or "median"


class RangeCluster(NamedTuple):
    position_samples: float  # [sample]
    weight: int  # number of decisions
    first_sample: int
    last_sample: int


def lower_median(members: list[int]) -> int:
    """Middle one of ascending members, the lower of two."""
    return members[(len(members) - 1) // 2]


def merged(hits: list[int], merge_distance_samples: int) -> list[list[int]]:
    """Merge ascending hits: always the two clusters with the closest medians, the leftmost of equals."""
    clusters = [[hit] for hit in hits]
    while len(clusters) > 1:
        medians = [lower_median(members) for members in clusters]
        distances = np.diff(medians)
        closest = int(np.argmin(distances))
        if distances[closest] >= merge_distance_samples:
            break
        clusters[closest : closest + 2] = [clusters[closest] + clusters[closest + 1]]
    return clusters


def leading_edge(first: int, amplitude: NDArray[np.float64], threshold: NDArray[np.float64]) -> float:
    """Where the square of amplitude crosses the threshold before sample `first`, linearly."""
    excess = amplitude[first] ** 2 - threshold[first]
    if first == 0:
        return float(first)
    deficit = threshold[first - 1] - amplitude[first - 1] ** 2
    if not (excess > 0.0 and 0.0 < deficit < np.inf):
        return float(first)
    return float(first - excess / (excess + deficit))


def range_clusters(
    decisions: NDArray[np.uint8],
    amplitude: NDArray[np.float64],
    threshold: NDArray[np.float64],
    sample_rate_hz: float,
    config: RangeClusterConfig,
) -> list[RangeCluster]:
    """Cluster decisions (n,); amplitude [count] and threshold [count^2] (n,) place the edges."""
    merge_distance = round(config.merge_distance_s * sample_rate_hz)
    result = []
    for members in merged([int(k) for k in np.flatnonzero(decisions)], merge_distance):
        if len(members) < config.min_weight:
            continue
        position = float(lower_median(members))
        if config.representative == "leading_edge":
            position = leading_edge(members[0], amplitude, threshold)
        result.append(RangeCluster(position, len(members), members[0], members[-1]))
    return result
