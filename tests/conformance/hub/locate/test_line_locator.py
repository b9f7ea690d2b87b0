"""The core's wall and line of antennas against the reference."""

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.reference.hub.locate.line_locator import locate_on_line, path_and_gradient, two_ellipses
from echofuse.reference.hub.locate.wall import ray

KINDS = ["none", "first_kind", "second_kind"]


def wall_config(kind, thickness_m=0.24, relative_permittivity=4.0):  # type: ignore[no-untyped-def]
    return _core.WallConfig(
        thickness_m=thickness_m,
        relative_permittivity=relative_permittivity,
        compensation=getattr(_core.WallCompensation, kind),
    )


@pytest.mark.parametrize("kind", KINDS)
def test_wall(kind):  # type: ignore[no-untyped-def]
    board, rng, wall = Scoreboard(), np.random.default_rng(1), _core.Wall()
    for case in range(500):
        config = wall_config(kind, 0.05 + 0.5 * rng.random(), 1.0 + 11.0 * rng.random())
        assert wall.configure(config) == _core.Status.ok
        lateral, depth = (rng.random(2) * [8.0, 8.0] + [0.0, 0.02]).astype(np.float32)
        excess, *direction = wall.ray(lateral, depth)
        expected = ray(as_reference(config), float(lateral), float(depth))
        board.floats(kind, "excess", str(case), [excess], [expected.excess_m], "hub.wall.excess")
        board.floats(kind, "direction", str(case), direction, expected.direction, "hub.wall.direction")
    for row in board.rows():
        assert row.passed, row.failures[:3]


def test_two_ellipses_take_the_same_decisions():  # type: ignore[no-untyped-def]
    board, rng = Scoreboard(), np.random.default_rng(2)
    seen = set()
    for case in range(3000):
        rx = rng.uniform(-0.6, 0.6, 2).astype(np.float32)
        z = rng.uniform([-3.0, 0.0], [3.0, rng.choice([0.03, 6.0])])
        legs = np.hypot(z[0] - rx, z[1]) + np.hypot(*z)
        path = (legs + rng.choice([0.0, 0.5]) * rng.standard_normal(2)).astype(np.float32)
        fix = _core.two_ellipses(*path, *rx)
        expected = two_ellipses(path.astype(np.float64), rx.astype(np.float64))
        board.decisions("", "status", str(case), [fix.status.name], [expected.status], expected.margin)
        seen.add(expected.status)
    assert seen == {"fix", "no_intersection", "too_near_axis"}
    for row in board.rows():
        assert row.passed, row.failures[:3]
        assert row.excused < 30


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("rx", [(-0.4, 0.4), (-0.3, 0.5), (-0.6, -0.3, 0.3, 0.6)])
def test_fix(kind, rx):  # type: ignore[no-untyped-def]
    board, rng, locator = Scoreboard(), np.random.default_rng(3), _core.LineLocator()
    config = _core.LineLocatorConfig(wall=wall_config(kind), path_std_m=0.04)
    rx_x = np.array(rx, np.float32)
    assert locator.configure(config, rx_x) == _core.Status.ok
    reference, rx64 = as_reference(config), rx_x.astype(np.float64)
    fixes = 0
    for case in range(200):
        z = rng.uniform([-3.0, 1.0], [3.0, 7.0])
        exact, _ = path_and_gradient(reference.wall, z, rx64)
        path = (exact + 0.02 * rng.standard_normal(len(rx))).astype(np.float32)
        weight = rng.uniform(0.5, 2.0, len(rx)).astype(np.float32)
        if len(rx) > 2:
            weight[rng.integers(len(rx))] *= rng.integers(2)
        status, fix = locator.process(path, weight)
        assert status == _core.Status.ok
        expected = locate_on_line(reference, rx64, path.astype(np.float64), weight.astype(np.float64))
        same = board.decisions(
            kind, "status", str(case), [fix.status.name], [expected.status], expected.margin
        )
        if not same or expected.status != "fix" or not expected.converged:
            continue
        fixes += 1
        board.floats(kind, "position", str(case), fix.position_m, expected.position_m, "hub.line.position")
        (xx, xy), (_, yy) = expected.covariance_m2
        board.floats(kind, "covariance", str(case), fix.covariance_m2, [xx, xy, yy], "hub.line.covariance")
    assert fixes > 150
    for row in board.rows():
        assert row.passed, row.failures[:3]
        assert row.excused < 3 or row.tap != "status"


def test_bad_input_is_refused():  # type: ignore[no-untyped-def]
    locator, config = _core.LineLocator(), _core.LineLocatorConfig()
    two, ones = np.array([-0.4, 0.4], np.float32), np.ones(2, np.float32)
    assert locator.process(ones, ones)[0] == _core.Status.not_configured
    for line in ([0.4], [0.4, 0.4], [0.0, 0.4], [np.nan, 0.4], range(1, 10)):
        assert locator.configure(config, np.array(line, np.float32)) == _core.Status.invalid_config
    assert locator.configure(config, two) == _core.Status.ok
    bad = [(ones[:1], ones), (ones * np.nan, ones), (ones, -ones), (ones, np.array([1, 0], np.float32))]
    for path, weight in bad:
        assert locator.process(path.astype(np.float32), weight)[0] == _core.Status.invalid_input
