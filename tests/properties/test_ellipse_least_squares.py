"""Laws of locating by ellipses, and the checked numbers of algorithms.md 6.7."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from echofuse import _core
from echofuse.reference.hub.locate.site import path_gradient, path_m

AREA = _core.Area(min_x_m=0.0, min_y_m=0.0, max_x_m=11.5, max_y_m=6.0)
TX = np.array([5.75, 0.0])
RX = np.array([[0.0, 1.5], [0.0, 4.5], [3.5, 6.0], [8.0, 6.0], [11.5, 4.5], [11.5, 1.5]])
PLACES = st.tuples(st.floats(0.3, 11.2), st.floats(0.3, 5.7))


def point(z) -> _core.Point:  # type: ignore[no-untyped-def]
    return _core.Point(x_m=float(z[0]), y_m=float(z[1]))


def nodes_at(tx, rx):  # type: ignore[no-untyped-def]
    return [
        _core.NodeSite(node_id=i, tx=point(t), rx=point(r))
        for i, (t, r) in enumerate(zip(tx, rx, strict=True))
    ]


def stage(**fields) -> _core.EllipseLeastSquares:  # type: ignore[no-untyped-def]
    made = _core.EllipseLeastSquares()
    assert made.configure(_core.EllipseConfig(**fields)) == _core.Status.ok
    return made


def locate(made, nodes, path):  # type: ignore[no-untyped-def]
    return made.process(nodes, np.asarray(path, np.float32), np.ones(len(path), np.float32), AREA)


@given(
    place=PLACES,
    body_radius_m=st.sampled_from([0.0, 0.15, 0.3]),
    kind=st.sampled_from(["bi", "mono", "mixed"]),
)
def test_exact_paths_give_the_place_back(place, body_radius_m, kind):  # type: ignore[no-untyped-def]
    z = np.array(place)
    tx = {
        "bi": np.repeat(TX[None], 6, axis=0),
        "mono": RX,
        "mixed": np.where(np.arange(6)[:, None] % 2, RX, TX),
    }[kind]
    assume(np.min(np.linalg.norm(np.concatenate([RX, tx]) - z, axis=1)) > body_radius_m + 0.1)
    baseline = np.linalg.norm(tx - RX, axis=1)
    path = path_m(z, tx, RX, body_radius_m)
    assume(kind != "bi" or np.all(path > baseline + 0.05))
    gradients = path_gradient(z, tx, RX, body_radius_m)
    assume(np.linalg.det(gradients.T @ gradients) > 1.0)
    status, fix = locate(stage(body_radius_m=body_radius_m, max_iterations=30), nodes_at(tx, RX), path)
    assert status == _core.Status.ok
    if fix.range_residual_m < 0.01:  # six exact paths: anything else is another minimum, and says so
        np.testing.assert_allclose(fix.position_m, z, atol=5e-3)
    else:
        assert kind == "mixed" or body_radius_m > 0


@given(place=PLACES, seed=st.integers(0, 10**6))
def test_refinement_never_fits_worse(place, seed):  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(seed)
    path = path_m(np.array(place), TX, RX) + 0.05 * rng.standard_normal(6)
    nodes = nodes_at(np.repeat(TX[None], 6, axis=0), RX)
    paper, refined = (
        locate(stage(refinement=_core.EllipseRefinement.none), nodes, path),
        locate(stage(), nodes, path),
    )
    if paper[0] == refined[0] == _core.Status.ok and refined[1].converged:
        assert refined[1].range_residual_m <= paper[1].range_residual_m + 1e-4


@given(
    turn=st.floats(-3.1, 3.1),
    shift=st.tuples(st.floats(-50, 50), st.floats(-50, 50)),
    seed=st.integers(0, 999),
)
def test_turning_and_moving_the_site_turns_and_moves_the_fix(turn, shift, seed):  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(seed)
    path = path_m(np.array([4.0, 3.0]), TX, RX) + 0.05 * rng.standard_normal(6)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    tx = np.repeat(TX[None], 6, axis=0)
    _, fix = locate(stage(), nodes_at(tx, RX), path)
    _, moved = locate(stage(), nodes_at(tx @ rotation.T + shift, RX @ rotation.T + shift), path)
    np.testing.assert_allclose(moved.position_m, rotation @ fix.position_m + shift, atol=2e-3)


@pytest.mark.parametrize(
    ("n_nodes", "sigma_m", "paper_m", "refined_m"), [(3, 0.1, 0.172, 0.104), (4, 0.1, 0.128, 0.079)]
)
def test_median_error_of_both_forms(n_nodes, sigma_m, paper_m, refined_m):  # type: ignore[no-untyped-def]
    """Algorithms 6.7: 0.172 -> 0.104 m for nu = 3, 0.128 -> 0.079 m for nu = 4."""
    rng = np.random.default_rng(11)
    errors = []
    forms = stage(refinement=_core.EllipseRefinement.none), stage()
    for _ in range(1500):
        z = np.array([0.5, 0.5]) + rng.random(2) * [10.5, 5.0]
        rx = RX[rng.choice(6, n_nodes, replace=False)]
        path = path_m(z, TX, rx) + sigma_m * rng.standard_normal(n_nodes)
        fixes = [locate(form, nodes_at(np.repeat(TX[None], n_nodes, axis=0), rx), path) for form in forms]
        if all(status == _core.Status.ok for status, _ in fixes):
            errors.append([np.linalg.norm(fix.position_m - z) for _, fix in fixes])
    np.testing.assert_allclose(np.median(errors, axis=0), [paper_m, refined_m], rtol=0.15)


def test_true_triples_pass_the_range_residual_and_equation_residual_says_nothing():  # type: ignore[no-untyped-def]
    """Algorithms 6.7: 99.7-100 % of true triples have RR < 2.5 sigma after refinement, a third of ghosts."""
    rng, made, sigma_m = np.random.default_rng(5), stage(), 0.1
    passed: dict[bool, list[bool]] = {True: [], False: []}
    equation: dict[bool, list[float]] = {True: [], False: []}
    for _ in range(1500):
        people = np.array([0.5, 0.5]) + rng.random((2, 2)) * [10.5, 5.0]
        chosen = rng.choice(6, 3, replace=False)
        nodes = nodes_at(np.repeat(TX[None], 3, axis=0), RX[chosen])
        for true, who in ((True, [0, 0, 0]), (False, [0, 1, int(rng.integers(2))])):
            path = [path_m(people[w], TX, RX[c]) for w, c in zip(who, chosen, strict=True)]
            status, fix = locate(made, nodes, np.array(path) + sigma_m * rng.standard_normal(3))
            if status == _core.Status.ok and np.isfinite(fix.equation_residual_m3):
                passed[true].append(fix.range_residual_m < 2.5 * sigma_m)
                equation[true].append(fix.equation_residual_m3)
    assert np.mean(passed[True]) > 0.99
    assert np.mean(passed[False]) < 0.45
    # Two equations for two unknowns: what is left is the rounding of the arithmetic, of ghosts as of people.
    assert max(np.median(equation[True]), np.median(equation[False])) < 1e-3
    better = np.mean(np.array(equation[False])[:, None] > np.array(equation[True])[None])
    assert 0.4 < better < 0.6
