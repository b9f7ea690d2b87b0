"""The core's positions in space against the reference."""

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.reference.hub.locate.planar_3d import planar_3d
from echofuse.reference.hub.locate.taylor_3d import ranges_and_gradient, taylor_3d

D = np.float32(0.39)
CROSS = D * np.array([[-1, 0, 0], [1, 0, 0], [0, 0, -1], [0, 0, 1]], np.float32)
EXTRA = np.array([[0.6, 0, 0.6], [-0.6, 0, 0.6], [0.6, 0, -0.6]], np.float32)
ANCHORS = np.array([[0, 0, 0.3], [6, 0, 2.5], [6, 5, 0.4], [0, 5, 2.4], [3, 0, 1.2], [3, 5, 2.6]], np.float32)
ORIGIN = np.zeros(3, np.float32)
METHODS = ["three_d_two_d", "approximate"]


@pytest.mark.parametrize("method", METHODS)
def test_planar_3d(method):  # type: ignore[no-untyped-def]
    board, rng, seen = Scoreboard(), np.random.default_rng(1), set()
    for case in range(3000):
        low, high = rng.choice([0.5, 3.0]), rng.choice([0.1, 6.0])
        z = rng.uniform([-low, 0.03, -low], [low, 0.03 + high, low])
        noise = rng.choice([0.0, 0.05, 0.6]) * rng.standard_normal(4)
        path = (np.linalg.norm(z) + np.linalg.norm(z - CROSS, axis=1) + noise).astype(np.float32)
        fix = _core.planar_3d(getattr(_core.Planar3dMethod, method), D, path)
        expected = planar_3d(method, float(D), path.astype(np.float64))
        same = board.decisions(
            method, "status", str(case), [fix.status.name], [expected.status], expected.margin
        )
        seen.add(expected.status)
        if same and expected.status == "fix" and z[1] > 1.0:
            board.floats(
                method, "position", str(case), fix.position_m, expected.position_m, "hub.planar_3d.position"
            )
    assert seen == {"fix", "clipped"}
    for row in board.rows():
        assert row.passed, row.failures[:3]
        assert row.excused < 30


def configs():  # type: ignore[no-untyped-def]
    kinds = _core.WallCompensation
    for start in METHODS:
        for kind in (kinds.none, kinds.first_kind, kinds.second_kind):
            wall = _core.WallConfig(thickness_m=0.2, compensation=kind)
            yield _core.Taylor3dConfig(wall=wall, start=getattr(_core.Taylor3dStart, start)), CROSS
        yield _core.Taylor3dConfig(start=getattr(_core.Taylor3dStart, start), max_iterations=0), CROSS
    wall = _core.WallConfig(compensation=kinds.second_kind)
    yield _core.Taylor3dConfig(wall=wall), np.concatenate([CROSS, EXTRA])
    given = {"wall": _core.WallConfig(compensation=kinds.none), "start": _core.Taylor3dStart.given}
    yield _core.Taylor3dConfig(**given), ANCHORS
    yield _core.Taylor3dConfig(**given, range_kind=_core.RangeKind.one_way), ANCHORS


@pytest.mark.parametrize("case", range(11))
def test_taylor_3d(case):  # type: ignore[no-untyped-def]
    config, rx = list(configs())[case]
    board, rng, taylor = Scoreboard(), np.random.default_rng(case), _core.Taylor3d()
    assert taylor.configure(config, ORIGIN, rx) == _core.Status.ok
    reference, rx64, zero = as_reference(config), rx.astype(np.float64), np.zeros(3)
    anchors = rx is ANCHORS
    located = 0
    for trial in range(150):
        z = (
            rng.uniform([0.5, 0.5, 0.3], [5.5, 4.5, 2.3])
            if anchors
            else rng.uniform([-2, 1.5, -1], [2, 6, 1])
        )
        exact, _ = ranges_and_gradient(reference, zero, rx64, z)
        std = rng.uniform(0.005, 0.02, len(rx))
        variance = (std**2).astype(np.float32)
        if len(rx) > 4 and rng.random() < 0.3:
            variance[rng.integers(4, len(rx))] = np.inf
        measured = (exact + std * rng.standard_normal(len(rx))).astype(np.float32)
        given = (z + 0.3 * rng.standard_normal(3)).astype(np.float32)
        status, fix = taylor.process(measured, variance, given)
        assert status == _core.Status.ok
        expected = taylor_3d(
            reference, zero, rx64, *(a.astype(np.float64) for a in (measured, variance, given))
        )
        same = board.decisions(
            "", "status", str(trial), [fix.status.name], [expected.status], expected.margin
        )
        if not same or expected.status not in ("converged", "iteration_limit"):
            continue
        located += 1
        where = str(trial)
        upper = expected.covariance_m2[np.triu_indices(3)]
        board.floats("", "position", where, fix.position_m, expected.position_m, "hub.taylor_3d.position")
        board.floats("", "covariance", where, fix.covariance_m2, upper, "hub.taylor_3d.covariance")
        board.floats(
            "",
            "residual",
            where,
            [fix.range_residual_m],
            [expected.range_residual_m],
            "hub.taylor_3d.residual",
        )
    assert located > 140
    for row in board.rows():
        assert row.passed, row.failures[:3]
        assert row.excused < 3


def test_the_rule_that_stops_is_that_of_the_reference():  # type: ignore[no-untyped-def]
    rng, taylor, seen = np.random.default_rng(3), _core.Taylor3d(), set()
    config = _core.Taylor3dConfig(
        wall=_core.WallConfig(compensation=_core.WallCompensation.none),
        start=_core.Taylor3dStart.given,
        max_iterations=3,
    )
    assert taylor.configure(config, ORIGIN, CROSS) == _core.Status.ok
    board, ones = Scoreboard(), np.ones(4, np.float32)
    for trial in range(300):
        z = rng.uniform([-2, 1.5, -1], [2, 6, 1])
        exact, _ = ranges_and_gradient(as_reference(config), np.zeros(3), CROSS.astype(np.float64), z)
        offset = rng.standard_normal(3)
        scale = rng.choice([0.01, 1.0, 5.0]) / np.linalg.norm(offset)
        given, path = (z + scale * offset).astype(np.float32), exact.astype(np.float32)
        status, fix = taylor.process(path, ones, given)
        assert status == _core.Status.ok
        inputs = (a.astype(np.float64) for a in (CROSS, path, ones, given))
        expected = taylor_3d(as_reference(config), np.zeros(3), *inputs)
        board.decisions("", "status", str(trial), [fix.status.name], [expected.status], expected.margin)
        seen.add(expected.status)
    assert {"converged", "diverging", "iteration_limit"} <= seen
    for row in board.rows():
        assert row.passed, row.failures[:3]


def test_bad_input_is_refused():  # type: ignore[no-untyped-def]
    taylor, config, invalid = _core.Taylor3d(), _core.Taylor3dConfig(), _core.Status.invalid_config
    ones = np.ones(4, np.float32)
    assert taylor.process(ones, ones, ORIGIN)[0] == _core.Status.not_configured
    given = _core.Taylor3dConfig(start=_core.Taylor3dStart.given)
    many = np.zeros((9, 3), np.float32)
    off_plane = CROSS + np.array([[0, 0.1, 0]], np.float32)
    refused = [(config, CROSS[:3]), (config, CROSS[::-1].copy()), (given, CROSS[:2]), (given, many)]
    refused += [(given, off_plane), (given, CROSS * np.float32(np.nan))]
    refused += [(_core.Taylor3dConfig(range_kind=_core.RangeKind.one_way), CROSS)]
    for bad, rx in refused:
        assert taylor.configure(bad, ORIGIN, rx) == invalid
    assert taylor.configure(config, ORIGIN, CROSS) == _core.Status.ok
    path = (4 * ones).astype(np.float32)
    one_nan = path.copy()
    one_nan[2] = np.nan
    for measured, variance in [(one_nan, ones), (path[:3], ones[:3]), (path, 0 * ones), (path, -ones)]:
        status, fix = taylor.process(measured, variance, ORIGIN)
        assert status == _core.Status.invalid_input
        assert fix.position_m == (0.0, 0.0, 0.0)
    missing = ones.copy()
    missing[2] = np.inf
    status, fix = taylor.process(one_nan, missing, ORIGIN)
    assert (status, fix.status) == (_core.Status.ok, _core.Taylor3dStatus.no_start)
    missing[1] = np.inf
    assert taylor.process(path, missing, ORIGIN)[0] == _core.Status.invalid_input
    bad_fields = [("min_step_m", 0.0), ("max_iterations", -1)]
    for name, value in bad_fields:
        assert _core.Taylor3dConfig(**{name: value}).invalid_field() == name
