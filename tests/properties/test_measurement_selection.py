"""Laws of the selection of measurements: people found, ghosts avoided, work bounded."""

from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from echofuse import _core
from echofuse.reference.hub.locate.site import path_m
from echofuse.reference.hub.measure.measurement_selection import elementary_symmetric

TX = np.array([5.75, 0.0])
RX = np.array([[0.0, 1.5], [0.0, 4.5], [3.5, 6.0], [8.0, 6.0], [11.5, 4.5], [11.5, 1.5]])
AREA = _core.Area(min_x_m=0.0, min_y_m=0.0, max_x_m=11.5, max_y_m=6.0)
NOBODY = np.zeros((0, 2), np.float32)


def selection(**fields) -> _core.MeasurementSelection:  # type: ignore[no-untyped-def]
    nodes = [
        _core.NodeSite(node_id=i, tx=_core.Point(x_m=TX[0], y_m=TX[1]), rx=_core.Point(x_m=x, y_m=y))
        for i, (x, y) in enumerate(RX)
    ]
    stage = _core.MeasurementSelection()
    assert (
        stage.configure(_core.SelectionConfig(**fields), _core.EllipseConfig(), nodes, AREA)
        == _core.Status.ok
    )
    return stage


def frame(rng, people, *, sigma_m=0.08, detected=0.9, n_false=1.0, merged_m=0.6):  # type: ignore[no-untyped-def]
    """(node_index, path_m, weight): echoes nearer to each other than merged_m are one detection."""
    rows = []
    for node, rx in enumerate(RX):
        paths = sorted(
            path_m(z, TX, rx) + sigma_m * rng.standard_normal() for z in people if rng.random() < detected
        )
        kept = [path for i, path in enumerate(paths) if i == 0 or path - paths[i - 1] >= merged_m]
        baseline = float(np.linalg.norm(TX - rx))
        kept += list(baseline + 0.5 + 9.0 * rng.random(rng.poisson(n_false)))
        rows += [(node, path, 15.0) for path in sorted(kept)]
    columns = np.array(rows).reshape(-1, 3).T
    return columns[0].astype(np.int32), columns[1].astype(np.float32), columns[2].astype(np.float32)


def found_and_ghosts(got, people, gate_m=0.6):  # type: ignore[no-untyped-def]
    position = np.stack([got["x_m"], got["y_m"]], axis=1)
    if len(position) == 0:
        return 0, 0
    gaps = np.linalg.norm(position[:, None] - people[None], axis=2)
    return int(np.sum(gaps.min(axis=0) < gate_m)), int(np.sum(gaps.min(axis=1) >= gate_m))


def apart(rng, n):  # type: ignore[no-untyped-def]
    while True:
        people = np.array([1.0, 1.0]) + rng.random((n, 2)) * [9.5, 4.0]
        if n == 1 or np.min(np.linalg.norm(people[:, None] - people[None], axis=2) + 9 * np.eye(n)) > 1.2:
            return people


@given(seed=st.integers(0, 10**6))
def test_one_person_without_noise_is_one_measurement(seed):  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(seed)
    people = apart(rng, 1)
    status, got = selection().process(*frame(rng, people, sigma_m=0.0, detected=1.0, n_false=0.0), 6, NOBODY)
    assert status == _core.Status.ok
    assert len(got) == 1
    assert got["n_nodes"][0] == 6
    np.testing.assert_allclose([got["x_m"][0], got["y_m"][0]], people[0], atol=0.02)


@given(seed=st.integers(0, 10**6), n=st.integers(0, 5), aided=st.booleans())
@settings(max_examples=50)
def test_a_detection_is_enough_for_one_measurement_of_its_own(seed, n, aided):  # type: ignore[no-untyped-def]
    """Each measurement rests on at least two detections of its own, inside the area, on distinct nodes."""
    rng = np.random.default_rng(seed)
    people = apart(rng, n) if n else np.zeros((0, 2))
    predictions = people.astype(np.float32) if aided else NOBODY
    node_index, path, weight = frame(rng, people)
    _, got = selection().process(node_index, path, weight, 6, predictions)
    assert 2 * len(got) <= len(path)
    assert np.all((got["n_nodes"] >= 3) & (got["n_nodes"] <= 6))
    assert np.all((got["x_m"] >= 0) & (got["x_m"] <= 11.5) & (got["y_m"] >= 0) & (got["y_m"] <= 6))
    assert np.all(got["range_residual_m"] <= 0.25 + 1e-6)


def test_consensus_avoids_the_ghosts_that_all_tuples_make():  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(3)
    stages = {
        "all": selection(method=_core.SelectionMethod.all_tuples),
        "consensus": selection(),
        "aided": selection(),
    }
    found = dict.fromkeys(stages, 0)
    ghosts = dict.fromkeys(stages, 0)
    n_frames, n_people = 150, 3
    for _ in range(n_frames):
        people = apart(rng, n_people)
        reports = frame(rng, people)
        near = (people + 0.15 * rng.standard_normal(people.shape)).astype(np.float32)
        for name, stage in stages.items():
            _, got = stage.process(*reports, 6, near if name == "aided" else NOBODY)
            hits, wrong = found_and_ghosts(got, people)
            found[name] += hits
            ghosts[name] += wrong
    assert ghosts["all"] > 10 * n_frames  # before clustering
    assert ghosts["consensus"] < 0.6 * n_frames
    assert ghosts["aided"] < 0.3 * n_frames
    assert found["consensus"] > 0.65 * n_frames * n_people
    assert found["aided"] > 0.85 * n_frames * n_people


@pytest.mark.parametrize(("n_nodes", "nu", "counts"), [(4, 3, (24, 96, 240)), (4, 4, (14, 78, 252))])
def test_number_of_type_3_false_alarms(n_nodes, nu, counts):  # type: ignore[no-untyped-def]
    """(24), from the number of tuples that are solved: M true ones among C(N_r, nu) M^nu."""
    for n_people, expected in zip((2, 3, 4), counts, strict=True):
        tuples = elementary_symmetric([n_people] * n_nodes, nu)
        assert tuples - comb(n_nodes, nu) * n_people == expected


@given(seed=st.integers(0, 10**6), n_each=st.integers(1, 16), nu=st.integers(3, 6))
@settings(max_examples=40, deadline=None)
def test_work_is_bounded_and_nothing_is_cut_uncounted(seed, n_each, nu):  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(seed)
    stage = selection(nodes_per_tuple=nu)
    node_index = np.repeat(np.arange(6, dtype=np.int32), n_each)
    path = np.sort(8 + 8 * rng.random((6, n_each)), axis=1).astype(np.float32).ravel()
    weight = rng.uniform(4, 20, 6 * n_each).astype(np.float32)
    status, _ = stage.process(node_index, path, weight, 6, NOBODY)
    total = comb(6, nu) * n_each**nu
    done, dropped = stage.counters.tuples, stage.counters.dropped_tuples
    assert done <= _core.LIMITS["max_tuples_per_frame"]
    assert done + dropped == total
    assert (status == _core.Status.truncated) >= (stage.counters.dropped_detections > 0)
    if total <= _core.LIMITS["max_tuples_per_frame"]:
        assert dropped == 0
