"""Laws of locating in space, and the checked numbers of algorithms.md 4.2 to 4.4."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from echofuse import _core
from echofuse.conformance.comparison import as_reference
from echofuse.reference.hub.locate.planar_3d import planar_3d
from echofuse.reference.hub.locate.taylor_3d import taylor_3d

D = 0.39
CROSS = D * np.array([[-1.0, 0, 0], [1, 0, 0], [0, 0, -1], [0, 0, 1]])
ORIGIN, ONES = np.zeros(3, np.float32), np.ones(4, np.float32)
NO_WALL = _core.WallConfig(compensation=_core.WallCompensation.none)
ROOM = {"x": st.floats(-2.5, 2.5), "y": st.floats(1.0, 7.0), "z": st.floats(-1.2, 1.2)}


def paths(z, rx=CROSS):  # type: ignore[no-untyped-def]
    return np.linalg.norm(z) + np.linalg.norm(z - rx, axis=1)


def taylor(start="three_d_two_d", rx=CROSS, tx=ORIGIN, **config):  # type: ignore[no-untyped-def]
    made = _core.Taylor3d()
    chosen = _core.Taylor3dConfig(
        **({"wall": NO_WALL, "start": getattr(_core.Taylor3dStart, start)} | config)
    )
    assert made.configure(chosen, np.asarray(tx, np.float32), np.asarray(rx, np.float32)) == _core.Status.ok
    return made


def locate(made, range_m, variance=ONES, start=ORIGIN):  # type: ignore[no-untyped-def]
    arrays = (np.asarray(a, np.float32) for a in (range_m, variance, start))
    status, fix = made.process(*arrays)
    assert status == _core.Status.ok
    return fix


def bound(z, variance, rx=CROSS):  # type: ignore[no-untyped-def]
    """Cramer-Rao bound (3, 3) [m^2], from the geometry alone."""
    legs = z - np.concatenate([[[0.0, 0, 0]], rx])
    units = legs / np.linalg.norm(legs, axis=1)[:, None]
    rows = units[0] + units[1:]
    return np.linalg.inv(rows.T @ (rows / np.asarray(variance)[:, None]))


@given(**ROOM)
def test_the_reference_is_exact(x, y, z):  # type: ignore[no-untyped-def]
    at, config = np.array([x, y, z]), as_reference(_core.Taylor3dConfig(wall=NO_WALL))
    assert np.linalg.norm(planar_3d("three_d_two_d", D, paths(at)).position_m - at) < 1e-9
    fix = taylor_3d(config, np.zeros(3), CROSS, paths(at), np.ones(4), np.zeros(3))
    assert np.linalg.norm(fix.position_m - at) < 1e-9


@given(x=st.floats(-1.0, 1.0), z=st.floats(-1.0, 1.0))
def test_the_core_is_exact_at_4_m(x, z):  # type: ignore[no-untyped-def]
    at = np.array([x, np.sqrt(16.0 - x**2 - z**2), z])
    planar = _core.planar_3d(_core.Planar3dMethod.three_d_two_d, D, paths(at).astype(np.float32))
    for position in (planar.position_m, locate(taylor(), paths(at)).position_m):
        assert np.linalg.norm(np.subtract(position, at)) < 1e-4


@pytest.mark.parametrize(("at", "bias_m"), [((1.5, 4.0, 0.8), 0.176), ((0.3, 2.0, 1.2), 0.177)])
def test_checked_bias_of_the_approximate_method(at, bias_m):  # type: ignore[no-untyped-def]
    path = paths(np.array(at))
    fix = _core.planar_3d(_core.Planar3dMethod.approximate, D, path.astype(np.float32))
    assert np.subtract(fix.position_m, at) == pytest.approx([0.0, bias_m, 0.0], abs=5e-4)
    assert locate(taylor("approximate"), path).position_m == pytest.approx(at, abs=2e-4)  # TSM takes it away


def errors(at, variance, n, rng):  # type: ignore[no-untyped-def]
    """Errors of 3D-2D and of weighted TSM, (n, 3) each, and the stop statuses of TSM."""
    made, planar, refined, stops = taylor(), [], [], []
    noisy = paths(at) + np.sqrt(variance) * rng.standard_normal((n, 4))
    for path in noisy.astype(np.float32):
        planar.append(_core.planar_3d(_core.Planar3dMethod.three_d_two_d, D, path).position_m)
        fix = locate(made, path, variance)
        refined.append(fix.position_m)
        stops.append(fix.status)
    return np.array(planar) - at, np.array(refined) - at, stops


@pytest.mark.parametrize("std_m", [0.005, 0.02])
def test_tsm_reaches_the_bound_all_over_the_room_and_never_diverges(std_m):  # type: ignore[no-untyped-def]
    rng, made, variance = np.random.default_rng(7), taylor(), np.full(4, std_m**2, np.float32)
    for _ in range(200):
        at = rng.uniform([-1.5, 2.0, -0.8], [1.5, 5.0, 0.8])
        noisy = (paths(at) + std_m * rng.standard_normal((2500, 4))).astype(np.float32)  # 5e5 draws in all
        fixes = [made.process(path, variance, ORIGIN)[1] for path in noisy]
        assert {fix.status for fix in fixes} == {_core.Taylor3dStatus.converged}
        error = np.array([fix.position_m for fix in fixes]) - at
        rms = np.sqrt(np.mean(np.sum(error**2, axis=1)))
        assert rms == pytest.approx(np.sqrt(np.trace(bound(at, variance))), rel=0.05)  # 2500 draws leave 1 %


def test_equal_variances_leave_nothing_to_gain_over_3d_2d():  # type: ignore[no-untyped-def]
    planar, refined, _ = errors(
        np.array([1.5, 4.0, 0.8]), np.full(4, 0.005**2), 3000, np.random.default_rng(8)
    )
    rms = [np.sqrt(np.mean(np.sum(e**2, axis=1))) for e in (planar, refined)]
    assert rms[1] == pytest.approx(rms[0], rel=0.01)
    assert rms[1] == pytest.approx(0.058, abs=0.003)


def test_unequal_variances_gain_what_is_predicted():  # type: ignore[no-untyped-def]
    # Small enough for the first order: a receiver of 40 mm adds 10 % to the depth's variance in the second.
    at, variance = np.array([1.0, 4.0, 0.5]), np.array([0.001, 0.001, 0.001, 0.01]) ** 2
    planar, refined, _ = errors(at, variance, 4000, np.random.default_rng(9))
    step = 1e-6  # 3D-2D is a function of the paths: its first-order covariance from its own derivative
    jacobian = np.stack(
        [
            planar_3d("three_d_two_d", D, paths(at) + step * row).position_m
            - planar_3d("three_d_two_d", D, paths(at) - step * row).position_m
            for row in np.eye(4)
        ],
        axis=1,
    ) / (2 * step)
    predicted = np.diag(jacobian @ np.diag(variance) @ jacobian.T), np.diag(bound(at, variance))
    for error, expected in zip((planar, refined), predicted, strict=True):
        assert np.mean(error**2, axis=0) == pytest.approx(expected, rel=0.1)
    assert np.sum(predicted[1]) < 0.9 * np.sum(predicted[0])


def test_the_covariance_is_that_of_the_errors():  # type: ignore[no-untyped-def]
    rng, at, variance = np.random.default_rng(5), np.array([0.7, 3.5, -0.4]), np.array([1, 4, 1, 2]) * 1e-5
    made, chi2 = taylor(), []
    for _ in range(2000):
        fix = locate(made, paths(at) + np.sqrt(variance) * rng.standard_normal(4), variance)
        full = np.zeros((3, 3))
        full[np.triu_indices(3)] = fix.covariance_m2
        full = full + np.triu(full, 1).T
        error = np.subtract(fix.position_m, at)
        chi2.append(error @ np.linalg.solve(full, error))
    assert np.mean(chi2) == pytest.approx(
        3.0, abs=0.25
    )  # chi-square of 3: the mean of 2000 has deviation 0.055


ANCHORS = np.array([[0, 0, 0.3], [6, 0, 2.5], [6, 5, 0.4], [0, 5, 2.4], [3, 0, 1.2], [3, 5, 2.6]])


@given(x=st.floats(0.5, 5.5), y=st.floats(0.5, 4.5), z=st.floats(0.3, 2.3), n=st.integers(4, 6))
def test_one_way_ranges_to_anchors_that_are_not_coplanar(x, y, z, n):  # type: ignore[no-untyped-def]
    at = np.array([x, y, z])
    made = taylor("given", rx=ANCHORS[:n], range_kind=_core.RangeKind.one_way)
    fix = locate(made, np.linalg.norm(at - ANCHORS[:n], axis=1), np.ones(n), at + np.array([0.3, -0.3, 0.2]))
    assert fix.status == _core.Taylor3dStatus.converged
    assert np.linalg.norm(np.subtract(fix.position_m, at)) < 1e-4


def fermat(a, z, thickness_m=0.2, permittivity=4.0):  # type: ignore[no-untyped-def]
    """Least optical path over all places where the ray may leave the wall, not by Snell."""
    lateral, air = np.hypot(z[0] - a[0], z[2] - a[2]), z[1] - thickness_m
    inside = np.linspace(0.0, min(lateral, 4.0 * thickness_m), 100001)
    return np.min(np.hypot(lateral - inside, air) + np.sqrt(permittivity) * np.hypot(inside, thickness_m))


@pytest.mark.parametrize("at", [(0.2, 4.0, 0.1), (1.5, 3.5, 0.8), (-2.0, 4.0, -0.8)])
def test_a_known_wall_costs_millimetres_and_the_first_kind_more(at):  # type: ignore[no-untyped-def]
    z = np.array(at)
    path = fermat(np.zeros(3), z) + np.array([fermat(a, z) for a in CROSS])
    found = []
    for kind in ("none", "first_kind", "second_kind"):
        wall = _core.WallConfig(thickness_m=0.2, compensation=getattr(_core.WallCompensation, kind))
        found.append(np.linalg.norm(np.subtract(locate(taylor(wall=wall), path).position_m, z)))
    assert found[2] < 5e-3
    assert found[2] <= found[1] + 1e-3
    assert found[1] < found[0]


def test_receivers_on_a_line_are_singular():  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(4)
    line = np.array([[-0.6, 0, 0], [-0.3, 0, 0], [0.3, 0, 0], [0.6, 0, 0]])
    made = taylor("given", rx=line)
    for _ in range(2000):
        at = rng.uniform([-2, 1, -1.5], [2, 7, 1.5])
        fix = locate(made, paths(at, line), ONES, at + 0.2 * rng.standard_normal(3))
        assert fix.status == _core.Taylor3dStatus.singular
        assert fix.position_m == (0.0, 0.0, 0.0)


@given(
    **ROOM,
    offset=st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1),
    length=st.sampled_from([5.0, 100.0, 1e6]),
)
def test_a_bad_start_ends_with_a_status_and_nothing_that_is_not_finite(x, y, z, offset, length):  # type: ignore[no-untyped-def]
    at = np.array([x, y, z])
    start = at + length * np.array(offset) / np.linalg.norm(offset)
    fix = locate(taylor("given"), paths(at), ONES, start)
    assert np.all(np.isfinite([*fix.position_m, *fix.covariance_m2, fix.range_residual_m]))
    assert fix.iterations <= 20
    if fix.status == _core.Taylor3dStatus.singular:
        assert fix.position_m == (0.0, 0.0, 0.0)
    else:
        assert fix.position_m[1] >= np.float32(0.02)


@given(path=st.lists(st.floats(-1e6, 1e6, width=32), min_size=4, max_size=4))
def test_any_paths_give_a_status_and_nothing_that_is_not_finite(path):  # type: ignore[no-untyped-def]
    path = np.array(path, np.float32)
    for method in (_core.Planar3dMethod.three_d_two_d, _core.Planar3dMethod.approximate):
        planar = _core.planar_3d(method, D, path)
        assert np.all(np.isfinite(planar.position_m))
        assert planar.position_m[1] >= np.float32(0.02)
    fix = locate(taylor(), path)
    assert np.all(np.isfinite([*fix.position_m, *fix.covariance_m2, fix.range_residual_m]))


def test_a_negative_discriminant_is_clipped_and_says_so():  # type: ignore[no-untyped-def]
    path = paths(np.array([1.0, 0.05, 1.0]))
    path[[0, 2]] += 0.1
    fix = _core.planar_3d(_core.Planar3dMethod.three_d_two_d, D, path.astype(np.float32))
    assert fix.status == _core.Planar3dStatus.clipped
    assert fix.position_m[1] == pytest.approx(0.02)
    assert locate(taylor(), path).clipped_start
    path[1] = np.nan
    bad = _core.planar_3d(_core.Planar3dMethod.three_d_two_d, D, path.astype(np.float32))
    assert bad.status == _core.Planar3dStatus.bad_path
