"""The core's selection of measurements against the reference."""

from typing import Any

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import COIN_TOSS_MARGIN, Scoreboard, as_reference
from echofuse.reference.hub.measure.measurement_selection import (
    Frame,
    Limits,
    Measurements,
    measurement_selection,
)

LIMITS = Limits(
    _core.LIMITS["max_tuples_per_frame"],
    _core.LIMITS["max_measurements_per_frame"],
    _core.LIMITS["max_measurements_per_frame"],
)
CHOICES: dict[str, dict[str, Any]] = {
    "consensus": {},
    "consensus, echo tails": {"echo_tail_m": 2.0},
    "consensus, unaided": {"track_aided": False},
    "consensus, nu=4": {"nodes_per_tuple": 4},
    "all_tuples": {"method": _core.SelectionMethod.all_tuples},
    "all_tuples, nu=4": {
        "method": _core.SelectionMethod.all_tuples,
        "nodes_per_tuple": 4,
        "min_weight": 50.0,
    },
    "all_tuples, equation_residual": {
        "method": _core.SelectionMethod.all_tuples,
        "residual": _core.SelectionResidual.equation_residual,
        "nodes_per_tuple": 4,
        "max_equation_residual_m3": 5.0,
    },
}


def compare(
    board: Scoreboard,
    choice: str,
    where: str,
    stage: _core.MeasurementSelection,
    frame: Any,
    people: Any,
    expected: Measurements,
) -> bool:
    """One frame through the core; False where the reference was about to toss a coin."""
    node_index, path, weight, n_reported = frame
    before = stage.counters.dropped_tuples, stage.counters.dropped_detections
    status, got = stage.process(node_index, path, weight, n_reported, people)
    cut = (stage.counters.dropped_tuples - before[0], stage.counters.dropped_detections - before[1])
    assert cut == (expected.dropped_tuples, expected.dropped_detections), where
    truncated = any(cut) or expected.dropped_measurements > 0
    if expected.margin < COIN_TOSS_MARGIN and not np.array_equal(got["n_nodes"], expected.n_nodes):
        return False
    assert status == (_core.Status.truncated if truncated else _core.Status.ok), where
    if not board.decisions(choice, "nodes", where, got["n_nodes"], expected.n_nodes, expected.margin):
        return True
    position = np.stack([got["x_m"], got["y_m"]], axis=1)
    board.floats(choice, "position", where, position, expected.position_m, "hub.selection.position")
    board.floats(choice, "weight", where, got["weight"], expected.weight, "hub.selection.weight")
    board.floats(
        choice,
        "RR",
        where,
        got["range_residual_m"],
        expected.range_residual_m,
        "hub.selection.range_residual",
    )
    return True


@pytest.mark.parametrize("kind", ["bistatic", "monostatic", pytest.param("mixed", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "choice",
    [pytest.param(name, marks=pytest.mark.slow) if name.startswith("all") else name for name in CHOICES],
)
def test_selection(choice, kind, site_of, core_site, frame_of):  # type: ignore[no-untyped-def]
    site = site_of(kind)
    nodes, area = core_site(site)
    config = _core.SelectionConfig(**CHOICES[choice])
    ellipse = _core.EllipseConfig()
    stage = _core.MeasurementSelection()
    status = stage.configure(config, ellipse, nodes, area)
    if config.residual == _core.SelectionResidual.equation_residual and kind != "bistatic":
        assert status == _core.Status.invalid_config
        return
    assert status == _core.Status.ok
    board, tosses = Scoreboard(), 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        node_index, path, weight, people = frame_of(rng, site, seed % 4, n_false=0.7)
        predictions = (people[::2] + 0.1 * rng.standard_normal(people[::2].shape)).astype(np.float32)
        frame = Frame(
            node_index.astype(np.intp), path.astype(np.float64), weight.astype(np.float64), len(nodes)
        )
        expected = measurement_selection(
            as_reference(config), as_reference(ellipse), site, LIMITS, frame, predictions.astype(np.float64)
        )
        frame32 = (node_index, path, weight, len(nodes))
        tosses += not compare(board, choice, f"{kind} {seed}", stage, frame32, predictions, expected)
    assert tosses <= 2
    for row in board.rows():
        assert row.passed, row.failures[:3]


@pytest.mark.slow
def test_what_is_cut_is_counted_alike(site_of, core_site):  # type: ignore[no-untyped-def]
    """Twelve detections on each of six nodes: 34,560 triples, an eighth of which are solved."""
    site, rng = site_of("bistatic"), np.random.default_rng(3)
    nodes, area = core_site(site)
    config = _core.SelectionConfig(method=_core.SelectionMethod.all_tuples, max_range_residual_m=0.002)
    stage = _core.MeasurementSelection()
    assert stage.configure(config, _core.EllipseConfig(), nodes, area) == _core.Status.ok
    for n_each in (12, 16):
        node_index = np.repeat(np.arange(6, dtype=np.int32), n_each)
        path = np.sort(7 + 8 * rng.random((6, n_each)), axis=1).ravel().astype(np.float32)
        weight = (4 + 16 * rng.random(6 * n_each)).astype(np.float32)
        frame = Frame(node_index.astype(np.intp), path.astype(np.float64), weight.astype(np.float64), 6)
        expected = measurement_selection(
            as_reference(config), as_reference(_core.EllipseConfig()), site, LIMITS, frame
        )
        assert expected.dropped_tuples > 0
        assert n_each == 12 or expected.dropped_detections > 0
        board = Scoreboard()
        nobody = np.zeros((0, 2), np.float32)
        assert compare(board, "cut", str(n_each), stage, (node_index, path, weight, 6), nobody, expected)
        for row in board.rows():
            assert row.passed, row.failures[:3]
