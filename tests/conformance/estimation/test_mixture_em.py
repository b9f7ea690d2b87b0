"""Mixture by expectation-maximisation: core against reference, every choice."""

import numpy as np
import pytest
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.reference.core.random import Pcg32
from echofuse.reference.estimation.mixture_em import fit_mixture, log_likelihood

SEEDS = range(20)


def clouds(rng: np.random.Generator, n: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Particles (600, 5) in n clouds and some strays; seeds (n + 2, 3) near the clouds and two elsewhere."""
    centres = rng.uniform(-10.0, 10.0, (n, 2))
    member = rng.integers(0, n, 600)
    particles = rng.normal(0.0, 1.0, (600, 5))
    particles[:, [0, 2]] = centres[member] + rng.normal(0.0, 0.15, (600, 2)) * rng.uniform(0.5, 1.5, (600, 1))
    particles[:20, [0, 2]] = rng.uniform(-10.0, 10.0, (20, 2))
    particles[:, 4] = rng.uniform(0.1, 1.0, 600)
    near = np.column_stack([centres + rng.normal(0.0, 0.1, (n, 2)), rng.uniform(0.5, 1.0, n)])
    far = np.column_stack([rng.uniform(-10.0, 10.0, (2, 2)), [0.01, 0.0]])
    return particles.astype(np.float32), rng.permutation(np.concatenate([near, far])).astype(np.float32)


@pytest.mark.parametrize("background", [0.0, 0.01])
@pytest.mark.parametrize("n_seeds_missing", [0, 1])
@pytest.mark.parametrize(("initialisation", "restarts"), [("measurements", 3), ("k_means_plus_plus", 1)])
def test_mixture(initialisation: str, restarts: int, n_seeds_missing: int, background: float) -> None:
    config = _core.MixtureConfig(
        initialisation=getattr(_core.PeakInitialisation, initialisation),
        restarts=restarts,
        background_density_per_m2=background,
    )
    board, reference_config = Scoreboard(), as_reference(config)
    fitter = _core.MixtureFitter()
    assert fitter.configure(config) == _core.Status.ok
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        n = int(rng.integers(1, 7))
        particles, seeds = clouds(rng, n)
        if n_seeds_missing:
            seeds = seeds[:1]
        status, got, got_background = fitter.process(particles, seeds, n, _core.Pcg32(seed))
        assert status == _core.Status.ok
        expected = fit_mixture(
            particles.astype(np.float64), seeds.astype(np.float64), n, reference_config, Pcg32(seed)
        )
        where, margin = f"seed {seed}", expected.margin
        position = np.column_stack([got["x_m"], got["y_m"]])
        velocity = np.column_stack([got["vx_mps"], got["vy_mps"]])
        covariance = np.column_stack([got[f"covariance_{part}_m2"] for part in ("xx", "xy", "yy")])
        upper = expected.covariance[:, [0, 0, 1], [0, 1, 1]]
        name = "estimation.mixture."
        board.floats("", "position", where, position, expected.mean, name + "position", margin)
        board.floats("", "velocity", where, velocity, expected.velocity, name + "velocity", margin)
        board.floats("", "covariance", where, covariance, upper, name + "covariance", margin)
        shares = np.append(got["share"], got_background)
        board.floats(
            "", "share", where, shares, [*expected.share, expected.background], name + "share", margin
        )
    assert {row.tap: row.failures for row in board.rows() if row.failures} == {}


def test_best_of_several_starts_is_as_likely() -> None:
    """Which of two equal fits is kept is a coin toss, their likelihood is not."""
    config = _core.MixtureConfig(initialisation=_core.PeakInitialisation.k_means_plus_plus, restarts=4)
    board, fitter = Scoreboard(), _core.MixtureFitter()
    assert fitter.configure(config) == _core.Status.ok
    for seed in SEEDS:
        particles, seeds = clouds(np.random.default_rng(seed), 4)
        _, got, background = fitter.process(particles, seeds, 4, _core.Pcg32(seed))
        exact = particles.astype(np.float64)
        expected = fit_mixture(exact, seeds.astype(np.float64), 4, as_reference(config), Pcg32(seed))
        likelihood = log_likelihood(exact, expected, as_reference(config))
        found = fitter.log_likelihood(particles, got, background)
        board.floats("", "likelihood", f"seed {seed}", found, likelihood, "estimation.mixture.likelihood")
    assert [row.failures for row in board.rows()] == [[]]
