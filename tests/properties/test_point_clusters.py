"""Laws of clustering in the plane, and the checked numbers of algorithms.md 6.8."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.cluster.hierarchy import fcluster, linkage

from echofuse import _core
from echofuse.reference.hub.measure.point_clusters import point_clusters

DISTANCES = st.sampled_from(["centroid", "minimum", "maximum"])


def clusters_of(distance: str, points, weight=None):  # type: ignore[no-untyped-def]
    stage = _core.PointClusters()
    config = _core.PointClusterConfig(distance=getattr(_core.ClusterDistance, distance))
    assert stage.configure(config) == _core.Status.ok
    points = np.asarray(points, np.float32).reshape(-1, 2)
    weight = np.ones(len(points), np.float32) if weight is None else weight
    status, got = stage.process(points, weight)
    assert status in (_core.Status.ok, _core.Status.truncated)
    return got


def cloud(seed: int, n: int, spread_m: float = 6.0):  # type: ignore[no-untyped-def]
    return spread_m * np.random.default_rng(seed).random((n, 2))


@given(distance=DISTANCES, seed=st.integers(0, 10**6), n=st.integers(0, 40))
def test_every_point_is_in_one_cluster(distance, seed, n):  # type: ignore[no-untyped-def]
    points = cloud(seed, n, 4.0)
    got = clusters_of(distance, points)
    if len(got) < _core.LIMITS["max_points_per_frame"]:
        assert got["members"].sum() == n
        assert got["weight"].sum() == pytest.approx(n)
        centre = got["members"] @ np.stack([got["x_m"], got["y_m"]], axis=1)
        np.testing.assert_allclose(centre, points.sum(axis=0), atol=1e-3)


@given(seed=st.integers(0, 10**6), n=st.integers(2, 30))
def test_the_smaller_the_distance_the_fewer_the_clusters(seed, n):  # type: ignore[no-untyped-def]
    """V-C: (28) makes fewer and larger clusters, (29) more and smaller ones. Single linkage is exact."""
    points = cloud(seed, n, 3.0)
    assert len(clusters_of("minimum", points)) <= len(clusters_of("maximum", points))


@given(distance=st.sampled_from([("minimum", "single"), ("maximum", "complete")]), seed=st.integers(0, 10**6))
def test_agrees_with_a_public_library(distance, seed):  # type: ignore[no-untyped-def]
    points = cloud(seed, 25, 3.0).astype(np.float32).astype(np.float64)
    tree = linkage(points, method=distance[1])
    if np.min(np.abs(tree[:, 2] - 0.8)) < 1e-5:
        return
    labels = fcluster(tree, 0.8, criterion="distance")
    expected = np.sort(np.bincount(labels)[1:])
    np.testing.assert_array_equal(np.sort(clusters_of(distance[0], points)["members"]), expected)


def printed_algorithm(points, threshold_m):  # type: ignore[no-untyped-def]
    """Algorithm 2 as it is printed: the least distance survives the pass that merged by it."""
    clusters = [[i] for i in range(len(points))]
    least, pair = np.inf, (0, 0)
    while True:
        for i in range(len(clusters)):
            for j in range(i + 1, len(clusters)):
                gap = np.linalg.norm(points[clusters[i]].mean(axis=0) - points[clusters[j]].mean(axis=0))
                if gap < least:
                    least, pair = gap, (i, j)
        if least >= threshold_m or pair[1] >= len(clusters):
            return clusters
        clusters[pair[0]] += clusters.pop(pair[1])


def test_the_mended_algorithm_finds_the_three_clouds():  # type: ignore[no-untyped-def]
    """Three people: the mended form finds three clusters, the printed one more."""
    mended, differs = [], 0
    for seed in range(100):
        rng = np.random.default_rng(seed)
        centres = np.array([[2.0, 2.0], [6.0, 3.0], [9.0, 4.5]])
        points = np.concatenate([centre + 0.2 * rng.standard_normal((6, 2)) for centre in centres])
        got = clusters_of("centroid", points)
        mended.append(len(got))
        differs += len(printed_algorithm(points, 0.8)) != len(got)
    assert 2.9 <= np.mean(mended) <= 3.2
    assert differs > 50


@given(n=st.integers(2, 14), seed=st.integers(0, 10**6))
def test_order_of_points_does_not_matter(n, seed):  # type: ignore[no-untyped-def]
    from types import SimpleNamespace

    points = cloud(seed, n, 3.0)
    config = SimpleNamespace(distance="centroid", threshold_m=0.8)
    weight = np.ones(n)
    one, other = point_clusters(config, points, weight), point_clusters(config, points[::-1], weight)
    assert sorted(one.members) == sorted(other.members)


def test_bad_points_are_refused():  # type: ignore[no-untyped-def]
    stage = _core.PointClusters()
    one = np.ones(1, np.float32)
    assert stage.process(np.zeros((1, 2), np.float32), one)[0] == _core.Status.not_configured
    assert stage.configure(_core.PointClusterConfig(threshold_m=float("nan"))) == _core.Status.invalid_config
    assert stage.configure(_core.PointClusterConfig()) == _core.Status.ok
    for bad in (np.nan, np.inf):
        assert stage.process(np.array([[0.0, bad]], np.float32), one)[0] == _core.Status.invalid_input
