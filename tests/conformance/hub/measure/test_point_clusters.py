"""The core's clustering in the plane against the reference."""

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.reference.hub.measure.point_clusters import point_clusters


@pytest.mark.parametrize("distance", ["centroid", "minimum", "maximum"])
def test_clusters(distance):  # type: ignore[no-untyped-def]
    board = Scoreboard()
    config = _core.PointClusterConfig(distance=getattr(_core.ClusterDistance, distance))
    stage = _core.PointClusters()
    assert stage.configure(config) == _core.Status.ok
    for seed in range(60):
        rng = np.random.default_rng(seed)
        centres = 8 * rng.random((rng.integers(1, 6), 2))
        n = int(rng.integers(0, 30))
        points = (centres[rng.integers(len(centres), size=n)] + 0.3 * rng.standard_normal((n, 2))).astype(
            np.float32
        )
        weight = rng.random(n).astype(np.float32)
        status, got = stage.process(points, weight)
        expected = point_clusters(as_reference(config), points.astype(np.float64), weight.astype(np.float64))
        assert status == _core.Status.ok
        if not board.decisions(
            distance, "members", str(seed), got["members"], expected.members, expected.margin
        ):
            continue
        position = np.stack([got["x_m"], got["y_m"]], axis=1)
        board.floats(
            distance, "position", str(seed), position, expected.position_m, "hub.point_clusters.position"
        )
        board.floats(
            distance, "weight", str(seed), got["weight"], expected.weight, "hub.point_clusters.weight"
        )
    for row in board.rows():
        assert row.passed, row.failures[:3]


def test_too_many_clusters_keep_the_heaviest():  # type: ignore[no-untyped-def]
    n = _core.LIMITS["max_points_per_frame"] + 5
    stage = _core.PointClusters()
    assert stage.configure(_core.PointClusterConfig()) == _core.Status.ok
    points = np.stack([2.0 * np.arange(n), np.zeros(n)], axis=1).astype(np.float32)
    weight = np.roll(np.arange(n), 7).astype(np.float32)
    status, got = stage.process(points, weight)
    assert status == _core.Status.truncated
    assert stage.dropped == 5
    np.testing.assert_array_equal(got["weight"], weight[weight >= 5])
