"""Laws of the constant-velocity filter, in the plane and in space."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from echofuse import _core

FILTERS = {2: _core.ConstantVelocityFilter, 3: _core.ConstantVelocityFilter3d}


@given(
    dimension=st.sampled_from([2, 3]),
    seed=st.integers(0, 2**32 - 1),
    density=st.floats(0.0, 10.0, width=32),
    noise_m=st.floats(0.0078125, 10.0, width=32),
    decay=st.floats(0.0, 1.0, width=32),
)
def test_covariance_stays_symmetric_and_positive(
    dimension: int, seed: int, density: float, noise_m: float, decay: float
) -> None:
    rng = np.random.default_rng(seed)
    kalman = FILTERS[dimension](
        np.zeros(2 * dimension, np.float32), np.diag([1.0, 4.0] * dimension).astype(np.float32)
    )
    noise = (noise_m**2 * np.eye(dimension)).astype(np.float32)
    for _ in range(50):
        kalman.predict(float(rng.uniform(0.01, 1.0)), density, decay)
        before = kalman.covariance
        kalman.update(rng.normal(size=dimension).astype(np.float32), noise)
        after = kalman.covariance
        assert np.array_equal(after, after.T)
        assert np.linalg.eigvalsh(after.astype(np.float64)).min() >= -1e-6 * np.abs(after).max()
        assert np.all(np.diag(after) <= np.diag(before) * (1.0 + 1e-5))  # a measurement never harms


@pytest.mark.parametrize("dimension", [2, 3])
def test_learns_the_velocity_of_a_straight_walk(dimension: int) -> None:
    velocity = np.array([1.2, -0.5, 0.3])[:dimension]
    kalman = FILTERS[dimension](
        np.zeros(2 * dimension, np.float32), (4.0 * np.eye(2 * dimension)).astype(np.float32)
    )
    noise = (0.01 * np.eye(dimension)).astype(np.float32)
    for step in range(1, 101):
        kalman.predict(0.1, 1e-4)
        kalman.update((0.1 * step * velocity).astype(np.float32), noise)
    assert kalman.state[::2] == pytest.approx(10.0 * velocity, abs=0.02)
    assert kalman.state[1::2] == pytest.approx(velocity, abs=0.02)


def test_what_does_not_fit_is_refused() -> None:
    kalman = _core.ConstantVelocityFilter3d(np.zeros(6, np.float32), np.eye(6, dtype=np.float32))
    with pytest.raises(ValueError, match="position_m has the wrong shape"):
        kalman.update(np.zeros(2, np.float32), np.eye(3, dtype=np.float32))
    with pytest.raises(ValueError, match="state has the wrong shape"):
        _core.ConstantVelocityFilter3d(np.zeros(4, np.float32), np.eye(6, dtype=np.float32))
