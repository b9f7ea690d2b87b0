"""One-dimensional clustering: partition, distances, weights, edges, capacity."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from echofuse import _core

FS = 1e9  # a sample is a nanosecond


def cluster(
    decisions: NDArray[np.uint8], representative: str = "median", merge: int = 10, min_weight: int = 1
):
    core = _core.RangeClusterer()
    config = _core.RangeClusterConfig(
        merge_distance_s=merge / FS,
        min_weight=min_weight,
        representative=getattr(_core.ClusterRepresentative, representative),
    )
    assert core.configure(config, FS) == _core.Status.ok
    amplitude = decisions.astype(np.float32) * 2.0
    return core.process(decisions, amplitude, np.ones(len(decisions), np.float32))


@given(st.lists(st.booleans(), min_size=1, max_size=600), st.integers(1, 70))
def test_clusters_partition_the_decisions(hits: list[bool], merge: int) -> None:
    decisions = np.array(hits, np.uint8)
    status, clusters = cluster(decisions, merge=merge)
    if status == _core.Status.truncated:
        return
    assert int(clusters["weight"].sum()) == int(decisions.sum())
    assert np.all(clusters["first_sample"][1:] > clusters["last_sample"][:-1])
    assert np.all(decisions[clusters["first_sample"]] == 1)
    assert np.all(decisions[clusters["last_sample"]] == 1)
    assert np.all(np.diff(clusters["position_samples"]) >= merge)
    for row in clusters:
        members = np.flatnonzero(decisions[: row["last_sample"] + 1])
        members = members[members >= row["first_sample"]]
        assert len(members) == row["weight"]
        assert row["position_samples"] == members[(len(members) - 1) // 2]


@given(st.lists(st.booleans(), min_size=1, max_size=300), st.integers(1, 12))
def test_light_clusters_are_dropped_and_nothing_else(hits: list[bool], min_weight: int) -> None:
    decisions = np.array(hits, np.uint8)
    _, everything = cluster(decisions)
    _, heavy = cluster(decisions, min_weight=min_weight)
    assert np.array_equal(heavy, everything[everything["weight"] >= min_weight])


def test_a_burst_is_one_cluster_and_far_bursts_are_two() -> None:
    decisions = np.zeros(300, np.uint8)
    decisions[50:70] = 1
    decisions[75:80] = 1
    decisions[200:207] = 1
    _, clusters = cluster(decisions, merge=65)
    assert clusters["weight"].tolist() == [25, 7]
    assert clusters["position_samples"].tolist() == [62.0, 203.0]


def test_the_leading_edge_lies_between_the_last_quiet_and_the_first_loud_sample() -> None:
    core = _core.RangeClusterer()
    assert core.configure(_core.RangeClusterConfig(min_weight=1), 16.384e9) == _core.Status.ok
    amplitude = np.array([0, 1, 2, 3, 4, 3, 0], np.float32)
    threshold = np.full(7, 6.5, np.float32)  # squares: 4 at sample 2, 9 at sample 3
    decisions = (amplitude**2 > threshold).astype(np.uint8)
    _, clusters = core.process(decisions, amplitude, threshold)
    assert clusters["position_samples"].tolist() == [2.5]
    _, at_start = core.process(decisions[3:], amplitude[3:], threshold[3:])
    assert at_start["position_samples"].tolist() == [0.0]


def test_the_heaviest_survive_a_full_report() -> None:
    capacity = _core.LIMITS["max_clusters_per_scan"]
    decisions = np.zeros(1920, np.uint8)
    weights = []
    for index in range(capacity + 8):
        weight = 2 + index * 7 % 5
        weights.append(weight)
        decisions[26 * index : 26 * index + weight] = 1
    status, clusters = cluster(decisions, merge=15)
    assert status == _core.Status.truncated
    assert len(clusters) == capacity
    assert sorted(clusters["weight"]) == sorted(weights)[8:]
    assert np.all(np.diff(clusters["position_samples"]) > 0)


def test_wrong_lengths_and_configurations() -> None:
    core = _core.RangeClusterer()
    ones = np.ones(10, np.float32)
    assert core.process(np.ones(10, np.uint8), ones, ones)[0] == _core.Status.not_configured
    assert core.configure(_core.RangeClusterConfig(), FS) == _core.Status.ok
    assert core.process(np.ones(9, np.uint8), ones, ones)[0] == _core.Status.invalid_input
    assert core.process(np.ones(2000, np.uint8), np.ones(2000, np.float32), np.ones(2000, np.float32))[0] == (
        _core.Status.invalid_input
    )
    with pytest.raises(TypeError):
        core.process(np.ones(10), ones, ones)
    for config in (
        _core.RangeClusterConfig(merge_distance_s=float("nan")),
        _core.RangeClusterConfig(min_weight=0),
    ):
        assert core.configure(config, FS) == _core.Status.invalid_config
