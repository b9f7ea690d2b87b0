"""Hierarchical clustering (sensor-radar paper, Algorithm 2; each pass finds the least distance anew)."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class PointClusterConfig(Protocol):
    distance: str  # centroid | minimum | maximum
    threshold_m: float


class PointClusters(NamedTuple):
    position_m: Array  # (c, 2) [m] centroids, in the order of their first members
    members: NDArray[np.intp]  # (c,)
    weight: Array  # (c,) sum of the members' weights
    label: NDArray[np.intp]  # (n,) each point's cluster
    margin: float  # least relative distance of a decision from flipping


def cluster_distance(kind: str, first: Array, second: Array) -> float:
    """Distance between clusters of points (n, 2) and (m, 2) [m]: (26), (28) or (29)."""
    if kind == "centroid":
        return float(np.linalg.norm(first.mean(axis=0) - second.mean(axis=0)))
    between = np.linalg.norm(first[:, None] - second[None], axis=2)
    return float(between.min() if kind == "minimum" else between.max())


def point_clusters(config: PointClusterConfig, position_m: Array, weight: Array) -> PointClusters:
    """Merge the two nearest clusters while they are closer than the threshold; points (n, 2) [m]."""
    clusters = [[i] for i in range(len(position_m))]
    margin = np.inf
    while len(clusters) > 1:
        pairs = [
            (cluster_distance(config.distance, position_m[clusters[i]], position_m[clusters[j]]), i, j)
            for i in range(len(clusters) - 1)
            for j in range(i + 1, len(clusters))
        ]
        nearest, i_min, j_min = min(pairs)
        margin = min(margin, abs(nearest / config.threshold_m - 1.0))
        if not nearest < config.threshold_m:
            break
        rivals = [d for d, i, j in pairs if (i, j) != (i_min, j_min)]
        if rivals:
            margin = min(margin, (min(rivals) - nearest) / config.threshold_m)
        clusters[i_min] += clusters.pop(j_min)
    label = np.zeros(len(position_m), dtype=np.intp)
    for number, members in enumerate(clusters):
        label[members] = number
    return PointClusters(
        np.array([position_m[members].mean(axis=0) for members in clusters]).reshape(-1, 2),
        np.array([len(members) for members in clusters], dtype=np.intp),
        np.array([weight[members].sum() for members in clusters]),
        label,
        float(margin),
    )
