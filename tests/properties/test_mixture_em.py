"""Laws of the mixture fit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from echofuse import _core

BOTH = st.sampled_from([_core.PeakInitialisation.measurements, _core.PeakInitialisation.k_means_plus_plus])


def clouds(rng: np.random.Generator, centres: NDArray[np.float64], std_m: float) -> NDArray[np.float32]:
    member = np.arange(900) % len(centres)
    particles = rng.normal(0.0, 1.0, (900, 5))
    particles[:, [0, 2]] = centres[member] + rng.normal(0.0, std_m, (900, 2))
    particles[:, 4] = rng.uniform(0.5, 1.0, 900) / 900
    return particles.astype(np.float32)


def fitter(**settings_: object) -> _core.MixtureFitter:
    made = _core.MixtureFitter()
    assert made.configure(_core.MixtureConfig(**settings_)) == _core.Status.ok
    return made


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(1, 5), background=st.sampled_from([0.0, 0.01]))
@settings(max_examples=40)
def test_each_iteration_makes_the_particles_likelier(seed: int, n: int, background: float) -> None:
    rng = np.random.default_rng(seed)
    particles = clouds(rng, rng.uniform(-1.0, 1.0, (n, 2)), 0.3)
    seeds = np.column_stack([rng.uniform(-1.0, 1.0, (n, 2)), np.ones(n)]).astype(np.float32)
    likelihoods = []
    for iterations in range(1, 12):
        made = fitter(
            initial_std_m=1.0,
            covariance_floor_m2=1e-8,
            max_iterations=iterations,
            tolerance_m=0.0,
            background_density_per_m2=background,
        )
        _, components, stray = made.process(particles, seeds, n, _core.Pcg32(1))
        likelihoods.append(made.log_likelihood(particles, components, stray))
    assert np.all(np.diff(likelihoods) > -1e-4)  # the kernel's cut at five deviations costs as much


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(1, 6), initialisation=BOTH)
@settings(max_examples=60)
def test_finds_clouds_that_stand_apart(seed: int, n: int, initialisation: _core.PeakInitialisation) -> None:
    rng = np.random.default_rng(seed)
    centres = (rng.permutation(9)[:n, None] // [3, 1] % 3) * 3.0 + rng.uniform(-0.5, 0.5, (n, 2))
    particles = clouds(rng, centres, 0.15)
    near = centres + rng.normal(0.0, 0.1, (n, 2))
    seeds = np.column_stack([near, rng.uniform(0.5, 1.0, n)]).astype(np.float32)
    made = fitter(initialisation=initialisation, restarts=10, initial_std_m=0.3)
    status, components, stray = made.process(particles, seeds, n, _core.Pcg32(seed))
    assert status == _core.Status.ok
    found = np.column_stack([components["x_m"], components["y_m"]])
    distance = np.linalg.norm(found[:, None] - centres[None], axis=2)
    assert distance.min(axis=0).max() < 0.08
    assert components["share"].sum() + stray == pytest.approx(1.0, abs=1e-5)
    assert stray < 0.02


def test_strays_do_not_pull_a_peak() -> None:
    """The uniform component is for this: one particle in twenty, 5 m away, would move the peak 0.25 m."""
    rng = np.random.default_rng(0)
    particles = clouds(rng, np.zeros((1, 2)), 0.1)
    particles[::20, 0] += 5.0
    seeds = np.array([[0.1, 0.0, 1.0]], np.float32)
    _, components, stray = fitter().process(particles, seeds, 1, _core.Pcg32(0))
    assert abs(components["x_m"][0]) < 0.03
    assert stray == pytest.approx(0.05, abs=0.02)


def test_refuses_what_has_no_peaks() -> None:
    made = fitter()
    seeds = np.zeros((0, 3), np.float32)
    empty = np.zeros((0, 5), np.float32)
    assert made.process(empty, seeds, 1, _core.Pcg32())[0] == _core.Status.invalid_input
    assert made.process(empty, seeds, 0, _core.Pcg32())[0] == _core.Status.ok
    many = _core.LIMITS["max_targets"] + 1
    assert (
        made.process(np.ones((9, 5), np.float32), seeds, many, _core.Pcg32())[0] == _core.Status.invalid_input
    )
    assert _core.MixtureFitter().process(empty, seeds, 0, _core.Pcg32())[0] == _core.Status.not_configured
