"""Laws of locating through a wall, and the checked numbers of algorithms.md 4.2, 5.7 and 8.2."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from echofuse import _core

RX = np.array([-0.4, 0.4], np.float32)
ROOM = {"x": st.floats(-3.0, 3.0), "y": st.floats(1.0, 7.0)}


def arrival_path(a, z, thickness_m, permittivity):  # type: ignore[no-untyped-def]
    """Least optical path over all places where the ray may leave the wall (Fermat), not by Snell."""
    lateral, air = abs(z[0] - a), z[1] - thickness_m
    inside = np.linspace(0.0, min(lateral, 4.0 * thickness_m), 200001)
    return np.min(np.hypot(lateral - inside, air) + np.sqrt(permittivity) * np.hypot(inside, thickness_m))


def paths(z, thickness_m=0.24, permittivity=4.0, rx=RX):  # type: ignore[no-untyped-def]
    legs = [arrival_path(a, z, thickness_m, permittivity) for a in [0.0, *rx]]
    return np.array([legs[0] + leg for leg in legs[1:]], np.float32)


def locator(kind, thickness_m=0.24, permittivity=4.0, rx=RX, path_std_m=0.033):  # type: ignore[no-untyped-def]
    wall = _core.WallConfig(
        thickness_m=thickness_m,
        relative_permittivity=permittivity,
        compensation=getattr(_core.WallCompensation, kind),
    )
    made = _core.LineLocator()
    config = _core.LineLocatorConfig(wall=wall, path_std_m=path_std_m)
    assert made.configure(config, np.array(rx, np.float32)) == _core.Status.ok
    return made


def error_m(made, z, path):  # type: ignore[no-untyped-def]
    status, fix = made.process(path, np.ones(len(path), np.float32))
    assert (status, fix.status) == (_core.Status.ok, _core.LineFixStatus.fix)
    return float(np.linalg.norm(np.subtract(fix.position_m, z)))


@given(**ROOM, thickness_m=st.floats(0.05, 0.5), permittivity=st.floats(1.0, 9.0))
def test_a_known_wall_costs_less_than_5_mm(x, y, thickness_m, permittivity):  # type: ignore[no-untyped-def]
    z = np.array([x, y])
    path = paths(z, thickness_m, permittivity)
    assert error_m(locator("second_kind", thickness_m, permittivity), z, path) < 5e-3


@given(**ROOM)
def test_four_receivers_give_the_place_back(x, y):  # type: ignore[no-untyped-def]
    z, rx = np.array([x, y]), [-0.6, -0.3, 0.3, 0.6]
    assert error_m(locator("second_kind", rx=rx), z, paths(z, rx=rx)) < 5e-3


@pytest.mark.parametrize(
    ("z", "errors_m"),
    [
        ((0.0, 4.0), (0.241, 0.000, 0.000)),
        ((1.5, 3.5), (0.257, 0.053, 0.000)),
        ((-3.0, 4.0), (0.281, 0.090, 0.000)),
        ((3.0, 2.0), (0.341, 0.160, 0.000)),
    ],
)
def test_checked_errors_of_the_wall(z, errors_m):  # type: ignore[no-untyped-def]
    path = paths(np.array(z))
    found = [error_m(locator(kind), z, path) for kind in ("none", "first_kind", "second_kind")]
    assert found == pytest.approx(errors_m, abs=2e-3)


@pytest.mark.parametrize(
    ("z", "deviations_m"),
    [((0.0, 4.0), (0.237, 0.012)), ((1.5, 4.0), (0.252, 0.095)), ((2.0, 6.0), (0.373, 0.125))],
)
def test_checked_bounds(z, deviations_m):  # type: ignore[no-untyped-def]
    made = locator("none", path_std_m=299792458.0 / 4.5e9 / 2.0)  # what algorithms.md rounds to 3.3 cm
    legs = np.hypot(z[0] - RX, z[1]) + np.hypot(*z)
    _, fix = made.process(legs.astype(np.float32), np.ones(2, np.float32))
    xx, _, yy = fix.covariance_m2
    assert (np.sqrt(xx), np.sqrt(yy)) == pytest.approx(deviations_m, abs=6e-4)


def test_the_covariance_is_that_of_the_errors():  # type: ignore[no-untyped-def]
    rng, z, rx = np.random.default_rng(5), np.array([1.0, 3.0]), [-0.6, -0.3, 0.3, 0.6]
    made, exact = locator("second_kind", rx=rx, path_std_m=0.01), paths(np.array([1.0, 3.0]), rx=rx)
    weight = np.array([1.0, 0.25, 1.0, 4.0], np.float32)
    squared = []
    for _ in range(2000):
        noisy = exact + 0.01 / np.sqrt(weight) * rng.standard_normal(4)
        _, fix = made.process(noisy.astype(np.float32), weight)
        xx, xy, yy = fix.covariance_m2
        error = np.subtract(fix.position_m, z)
        squared.append(error @ np.linalg.solve([[xx, xy], [xy, yy]], error))
    assert np.mean(squared) == pytest.approx(
        2.0, abs=0.2
    )  # chi-square of 2: the mean of 2000 has deviation 0.045


def test_ellipses_that_do_not_meet():  # type: ignore[no-untyped-def]
    def status(d1, d2):  # type: ignore[no-untyped-def]
        return _core.two_ellipses(d1, d2, -0.4, 0.4).status

    assert status(3.0, 3.7) == _core.LineFixStatus.fix
    assert status(3.0, 3.9) == _core.LineFixStatus.no_intersection  # further apart than the receivers
    assert status(0.3, 0.5) == _core.LineFixStatus.no_intersection  # shorter than the direct path
    assert status(3.0, 3.79999) == _core.LineFixStatus.too_near_axis


@given(**ROOM, thickness_m=st.floats(0.05, 0.5), permittivity=st.floats(1.0, 9.0))
def test_the_excess_lies_between_the_normal_one_and_the_whole_slab(x, y, thickness_m, permittivity):  # type: ignore[no-untyped-def]
    wall = _core.Wall()
    config = _core.WallConfig(thickness_m=thickness_m, relative_permittivity=permittivity)
    assert wall.configure(config) == _core.Status.ok
    normal = thickness_m * (np.sqrt(permittivity) - 1.0)
    excess, lateral, depth = wall.ray(abs(x), y)
    slope = np.hypot(x, y) / y
    assert normal - 1e-5 <= excess <= normal * slope + 1e-5  # the straight line is a slower ray
    assert lateral**2 + depth**2 == pytest.approx(1.0, abs=1e-5)
