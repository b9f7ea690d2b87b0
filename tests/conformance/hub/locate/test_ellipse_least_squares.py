"""The core's ellipse intersection against the reference."""

from types import SimpleNamespace

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.reference.hub.locate.ellipse_least_squares import Ellipses, ellipse_least_squares, refine
from echofuse.reference.hub.locate.site import invalid_site, path_gradient, path_m

KINDS = ["bistatic", "monostatic", "mixed"]


def random_paths(rng, site, chosen, sigma_m=0.08):  # type: ignore[no-untyped-def]
    low, high = site.area_m[:2] + 0.3, site.area_m[2:] - 0.3
    person = low + rng.random(2) * (high - low)
    path = path_m(person, site.tx_m[chosen], site.rx_m[chosen]) + sigma_m * rng.standard_normal(len(chosen))
    return path.astype(np.float32)


@pytest.mark.parametrize("body_radius_m", [0.0, 0.2])
@pytest.mark.parametrize("kind", KINDS)
def test_path_and_gradient(kind, body_radius_m, site_of, core_site):  # type: ignore[no-untyped-def]
    board, rng, site = Scoreboard(), np.random.default_rng(1), site_of(kind)
    nodes, _ = core_site(site)
    for case in range(200):
        z = (site.area_m[:2] + rng.random(2) * (site.area_m[2:] - site.area_m[:2])).astype(np.float32)
        node = case % len(nodes)
        point = _core.Point(x_m=float(z[0]), y_m=float(z[1]))
        path, *gradient = _core.path_length(point, nodes[node].tx, nodes[node].rx, body_radius_m)
        radius = float(np.float32(body_radius_m))
        tx, rx = site.tx_m[node], site.rx_m[node]
        z64 = z.astype(np.float64)
        board.floats(kind, "path", str(case), [path], [path_m(z64, tx, rx, radius)], "hub.path_length")
        board.floats(
            kind, "gradient", str(case), gradient, path_gradient(z64, tx, rx, radius), "hub.path_gradient"
        )
    for row in board.rows():
        assert row.passed, row.failures[:3]


@pytest.mark.parametrize("body_radius_m", [0.0, 0.2])
@pytest.mark.parametrize("refinement", ["gauss_newton", "none"])
@pytest.mark.parametrize("kind", KINDS)
def test_fix(kind, refinement, body_radius_m, site_of, core_site):  # type: ignore[no-untyped-def]
    board, site = Scoreboard(), site_of(kind)
    nodes, area = core_site(site)
    config = _core.EllipseConfig(
        refinement=getattr(_core.EllipseRefinement, refinement), body_radius_m=body_radius_m
    )
    stage = _core.EllipseLeastSquares()
    assert stage.configure(config) == _core.Status.ok
    reference_config = as_reference(config)
    position_row = "hub.ellipse.position" if refinement == "gauss_newton" else "hub.ellipse.start"
    located = 0
    for seed in range(150):
        rng = np.random.default_rng(seed)
        chosen = np.sort(rng.choice(len(nodes), size=rng.integers(3, len(nodes) + 1), replace=False))
        path = random_paths(rng, site, chosen)
        ones = np.ones(len(chosen), np.float32)
        status, fix = stage.process([nodes[i] for i in chosen], path, ones, area)
        ellipses = Ellipses(
            site.tx_m[chosen], site.rx_m[chosen], path.astype(np.float64), np.ones(len(chosen))
        )
        expected = ellipse_least_squares(reference_config, ellipses, site.area_m)
        if expected is not None and (expected.margin < 1e-5 or not expected.converged):
            continue
        assert (status == _core.Status.ok) == (expected is not None), seed
        if expected is None:
            continue
        located += 1
        board.floats(kind, "position", str(seed), fix.position_m, expected.position_m, position_row)
        board.floats(
            kind,
            "RR",
            str(seed),
            [fix.range_residual_m],
            [expected.range_residual_m],
            "hub.ellipse.range_residual",
        )
        if np.isfinite(expected.equation_residual_m3):
            target, reference = [fix.equation_residual_m3], [expected.equation_residual_m3]
            board.floats(kind, "RE", str(seed), target, reference, "hub.ellipse.equation_residual")
        else:
            assert np.isnan(fix.equation_residual_m3)
    assert located > 120
    for row in board.rows():
        assert row.passed, row.failures[:3]


@pytest.mark.parametrize("kind", KINDS)
def test_robust_refinement(kind, site_of, core_site):  # type: ignore[no-untyped-def]
    board, site = Scoreboard(), site_of(kind)
    nodes, _ = core_site(site)
    config = _core.EllipseConfig()
    stage = _core.EllipseLeastSquares()
    assert stage.configure(config) == _core.Status.ok
    everyone = np.arange(len(nodes))
    for seed in range(50):
        rng = np.random.default_rng(seed)
        path = random_paths(rng, site, everyone)
        path[rng.integers(len(path))] += 0.4
        weight = (0.5 + rng.random(len(path))).astype(np.float32)
        middle = 0.5 * (site.area_m[:2] + site.area_m[2:])
        ellipses = Ellipses(site.tx_m, site.rx_m, path.astype(np.float64), weight.astype(np.float64))
        begin = refine(as_reference(config), ellipses, middle, robust=False)
        assert begin is not None
        z = begin.position_m.astype(np.float32)
        expected = refine(as_reference(config), ellipses, z.astype(np.float64), robust=True)
        point = _core.Point(x_m=float(z[0]), y_m=float(z[1]))
        status, fix = stage.refine(nodes, path, weight, point, True)
        assert expected is not None
        assert status == _core.Status.ok
        if expected.converged:
            board.floats(
                kind, "position", str(seed), fix.position_m, expected.position_m, "hub.ellipse.position"
            )
    for row in board.rows():
        assert row.passed, row.failures[:3]
        assert row.cases > 30


def test_invalid_sites_are_named_alike(site_of, core_site):  # type: ignore[no-untyped-def]
    line = np.array([[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [4.0, 0.0]])
    room = np.array([0.0, 0.0, 4.0, 4.0])
    site = site_of("bistatic")
    twin = site.rx_m.copy()
    twin[3] = twin[0]
    cases = [
        (site, None),
        (site._replace(tx_m=site.tx_m[:2], rx_m=site.rx_m[:2]), "n_nodes"),
        (site._replace(rx_m=twin), "nodes"),
        (site._replace(area_m=np.array([0.0, 0.0, 0.0, 4.0])), "area"),
        (site._replace(area_m=np.array([0.0, np.nan, 3.0, 4.0])), "area"),
        (SimpleNamespace(tx_m=line, rx_m=line, area_m=room), None),
        (SimpleNamespace(tx_m=line, rx_m=line, area_m=room - np.array([0.0, 2.0, 0.0, 2.0])), "nodes"),
    ]
    for case, expected in cases:
        nodes, area = core_site(case)
        assert _core.invalid_site(nodes, area) == expected
        assert invalid_site(case) == expected
