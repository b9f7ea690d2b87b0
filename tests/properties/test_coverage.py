"""Laws of coverage (section III) and the checked numbers of algorithms.md 6.1 and 8.2."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from echofuse import _core
from echofuse.reference.hub.locate import coverage as reference
from echofuse.reference.hub.locate.site import path_gradient, path_m

LENGTHS = st.floats(0.1, 30.0)


@given(to_tx=LENGTHS, to_rx=LENGTHS, angle=st.floats(0.0, 3.0), log_chi=st.floats(-2, 6))
def test_relations_of_section_three_hold(to_tx, to_rx, angle, log_chi):  # type: ignore[no-untyped-def]
    """(6)-(8) from the triangle of person, transmitter and receiver, to 1e-12 in the reference."""
    chi, total = 10.0**log_chi, to_tx + to_rx
    baseline = np.sqrt(to_tx**2 + to_rx**2 - 2 * to_tx * to_rx * np.cos(angle))
    if total**2 - baseline**2 < 1e-3 * total**2:
        return
    assert reference.leg_product_m2(total, baseline, angle) == pytest.approx(to_tx * to_rx, rel=1e-12)
    ratio = reference.snr(chi, to_tx, to_rx)
    assert reference.snr_on_ellipse(chi, total, baseline, angle) == pytest.approx(ratio, rel=1e-11)
    assert reference.sum_on_cassini_m(chi, ratio, baseline, angle) == pytest.approx(total, rel=1e-12)
    assert reference.max_leg_product_m2(chi, ratio) == pytest.approx(to_tx * to_rx, rel=1e-12)
    assert _core.snr_on_ellipse(chi, total, baseline, angle) == pytest.approx(ratio, rel=3e-3)


def test_extremes_on_an_ellipse():  # type: ignore[no-untyped-def]
    """16 chi / (S^2 - l^2)^2 on the extended baseline, 16 chi / S^4 in the middle."""
    chi, total, baseline = 100.0, 8.0, 3.0
    assert reference.snr_on_ellipse(chi, total, baseline, 0.0) == pytest.approx(
        16 * chi / (total**2 - baseline**2) ** 2
    )
    widest = 2 * np.arcsin(baseline / total)
    assert reference.snr_on_ellipse(chi, total, baseline, widest) == pytest.approx(16 * chi / total**4)


@pytest.mark.parametrize(
    ("place", "sigma_xy"),
    [((0.0, 4.0), (0.237, 0.012)), ((1.5, 4.0), (0.252, 0.095)), ((2.0, 6.0), (0.373, 0.125))],
)
def test_bound_of_a_handheld_array(place, sigma_xy):  # type: ignore[no-untyped-def]
    """Algorithms 8.2: receivers 0.4 m left and right of the transmitter, path deviation 3.3 cm."""
    rx = np.array([[-0.4, 0.0], [0.4, 0.0]])
    bound = reference.position_error_bound_m(path_gradient(np.array(place), np.zeros((2, 2)), rx), 0.033)
    assert bound == pytest.approx(np.hypot(*sigma_xy), rel=0.02)


@pytest.mark.parametrize("place", [(2.5, 2.0), (5.75, 3.5), (9.0, 4.0)])
def test_least_squares_reach_the_bound(place):  # type: ignore[no-untyped-def]
    """Algorithms 8.2: six receivers, 5 cm: the refined fix is as good as the bound allows."""
    tx = np.repeat([[5.75, 0.0]], 6, axis=0)
    rx = np.array([[0.0, 1.5], [0.0, 4.5], [3.5, 6.0], [8.0, 6.0], [11.5, 4.5], [11.5, 1.5]])
    nodes = [
        _core.NodeSite(node_id=i, tx=_core.Point(x_m=t[0], y_m=t[1]), rx=_core.Point(x_m=r[0], y_m=r[1]))
        for i, (t, r) in enumerate(zip(tx, rx, strict=True))
    ]
    area = _core.Area(max_x_m=11.5, max_y_m=6.0)
    coverage = _core.Coverage()
    assert (
        coverage.configure(
            _core.CoverageConfig(path_sigma_m=0.05, min_snr_db=-50.0, blind_zone_s=0.0), nodes, area
        )
        == _core.Status.ok
    )
    _, seen = coverage.process(np.array([place], np.float32))
    bound = float(seen["position_error_bound_m"][0])
    gradients = path_gradient(np.array(place), tx, rx)
    assert bound == pytest.approx(reference.position_error_bound_m(gradients, 0.05), rel=1e-4)
    rng, squared = np.random.default_rng(2), []
    stage = _core.EllipseLeastSquares()
    assert stage.configure(_core.EllipseConfig()) == _core.Status.ok
    for _ in range(2000):
        path = (path_m(np.array(place), tx, rx) + 0.05 * rng.standard_normal(6)).astype(np.float32)
        _, fix = stage.process(nodes, path, np.ones(6, np.float32), area)
        squared.append(np.sum((np.array(fix.position_m) - place) ** 2))
    assert np.sqrt(np.mean(squared)) == pytest.approx(bound, rel=0.06)


def test_more_power_covers_more_and_the_middle_of_a_baseline_is_blind():  # type: ignore[no-untyped-def]
    corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]
    tx = _core.Point(x_m=2.0, y_m=0.0)
    nodes = [
        _core.NodeSite(node_id=i, tx=tx, rx=_core.Point(x_m=x, y_m=y)) for i, (x, y) in enumerate(corners)
    ]
    area = _core.Area(max_x_m=4.0, max_y_m=4.0)
    grid = np.stack(np.meshgrid(np.linspace(0.1, 3.9, 20), np.linspace(0.1, 3.9, 20)), axis=-1)
    places = grid.reshape(-1, 2).astype(np.float32)
    covering = []
    for power in (-60.0, -40.0, -12.64):
        stage = _core.Coverage()
        config = _core.CoverageConfig(transmit_power_dbm=power, min_snr_db=30.0)
        assert stage.configure(config, nodes, area) == _core.Status.ok
        covering.append(stage.process(places)[1]["n_covering"])
    assert np.all(covering[0] <= covering[1])
    assert np.all(covering[1] <= covering[2])
    assert covering[0].sum() < covering[2].sum()
    between = np.array([[3.0, 2.0]], np.float32)  # halfway between the transmitter and the third corner
    assert stage.process(between)[1]["n_blind"][0] == 1
    assert stage.process(np.array([[np.nan, 1.0]], np.float32))[0] == _core.Status.invalid_input
