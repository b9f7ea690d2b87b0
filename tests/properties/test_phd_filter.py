"""Laws of the particle PHD filter."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from echofuse import _core


def phd_filter(**settings_: Any) -> _core.PhdFilter:
    made = _core.PhdFilter()
    assert made.configure(_core.PhdConfig(**{"particles_per_target": 300, **settings_})) == _core.Status.ok
    return made


def frame(phd: _core.PhdFilter, points: list[list[float]] | NDArray[np.float64], dt_s: float = 0.1) -> None:
    assert phd.predict(dt_s) == _core.Status.ok
    assert phd.update(np.array(points, np.float32).reshape(-1, 2)) == _core.Status.ok
    assert phd.resample() == _core.Status.ok


def mass_of(particles: NDArray[np.float32]) -> float:
    return float(particles[:, 4].sum(dtype=np.float64))


@given(p_detect=st.floats(0.0, 1.0, width=32), p_survive=st.floats(0.0625, 1.0, width=32))
def test_without_measurements_mass_fades_as_the_model_says(p_detect: float, p_survive: float) -> None:
    phd = phd_filter(detection_probability=p_detect, survival_probability=p_survive)
    for _ in range(4):
        frame(phd, [[1.0, 2.0]])
    before = mass_of(phd.particles)
    frame(phd, [])
    assert phd.mass == pytest.approx((1.0 - p_detect) * p_survive * before, rel=1e-5, abs=1e-9)


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(1, 12))
@settings(max_examples=40)
def test_the_order_of_measurements_does_not_matter(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    first, second = phd_filter(), phd_filter()
    points = rng.uniform(0.0, 5.0, (n, 2))
    for phd in (first, second):
        for _ in range(3):
            frame(phd, points)
    shuffled = rng.permutation(points)
    for phd, given_points in ((first, points), (second, shuffled)):
        assert phd.predict(0.1) == _core.Status.ok
        assert phd.update(given_points.astype(np.float32)) == _core.Status.ok
    assert first.mass == pytest.approx(second.mass, rel=1e-5)
    assert np.allclose(np.sort(first.persistent[:, 4]), np.sort(second.persistent[:, 4]), rtol=1e-4)
    assert np.allclose(
        np.sort(first.measurement_mass), np.sort(second.measurement_mass), rtol=1e-4, atol=1e-6
    )


@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(0, 20),
    chance=st.sampled_from([_core.ResamplingChance.square_root, _core.ResamplingChance.proportional]),
)
@settings(max_examples=40)
def test_mass_is_kept_by_resampling_and_bounded_by_measurements(
    seed: int, n: int, chance: _core.ResamplingChance
) -> None:
    rng = np.random.default_rng(seed)
    phd = phd_filter(resampling=chance)
    for _ in range(4):
        before = mass_of(phd.particles)
        assert phd.predict(0.1) == _core.Status.ok
        assert phd.update(rng.uniform(0.0, 6.0, (n, 2)).astype(np.float32)) == _core.Status.ok
        assert np.all(phd.measurement_mass >= 0.0)
        assert np.all(phd.measurement_mass <= 1.0 + 1e-5)  # one measurement shows one target at most
        assert phd.mass <= 0.1 * before + phd.measurement_mass.sum() + 1e-4
        mass = mass_of(phd.particles)
        assert phd.resample() == _core.Status.ok
        assert mass_of(phd.particles) == pytest.approx(mass, rel=1e-5)
        assert np.all(phd.particles[:, 4] >= 0.0)


@pytest.mark.parametrize("n_targets", [0, 1, 3])
def test_counts_targets_that_are_there(n_targets: int) -> None:
    """Newborn mass is kept apart: two clutter points a frame make no target."""
    rng = np.random.default_rng(n_targets)
    phd = phd_filter(measurement_std_m=0.2)
    centres = np.array([[1.0, 1.0], [9.0, 2.0], [5.0, 5.0]])[:n_targets]
    masses = []
    for _ in range(150):
        seen = centres[rng.random(n_targets) < 0.9]
        clutter = rng.uniform([0.0, 0.0], [11.5, 6.0], (rng.poisson(2.0), 2))
        frame(phd, np.concatenate([seen + rng.normal(0.0, 0.2, seen.shape), clutter]))
        masses.append(phd.mass)
    assert np.mean(masses[30:]) == pytest.approx(n_targets, abs=0.15 if n_targets < 2 else 0.4)


def test_same_seed_same_particles_and_reset_starts_anew() -> None:
    first, second = phd_filter(seed=5), phd_filter(seed=5)
    for phd in (first, second):
        for _ in range(3):
            frame(phd, [[1.0, 2.0], [3.0, 1.0]])
    assert np.array_equal(first.particles, second.particles)
    first.reset()
    assert len(first.particles) == 0
    for _ in range(3):
        frame(first, [[1.0, 2.0], [3.0, 1.0]])
    assert np.array_equal(first.particles, second.particles)
    other = phd_filter(seed=6)
    for _ in range(3):
        frame(other, [[1.0, 2.0], [3.0, 1.0]])
    assert not np.array_equal(other.particles, second.particles)


def test_bad_input_changes_nothing() -> None:
    phd = phd_filter()
    frame(phd, [[1.0, 2.0]])
    before = phd.particles
    for dt_s in (0.0, -1.0, float("nan"), float("inf")):
        assert phd.predict(dt_s) == _core.Status.invalid_input
    for bad in (np.nan, np.inf):
        assert phd.update(np.array([[1.0, bad]], np.float32)) == _core.Status.invalid_input
    assert np.array_equal(phd.particles, before)
    assert _core.PhdFilter().predict(0.1) == _core.Status.not_configured
