"""Laws of the constant-velocity filter."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from echofuse import _core


@given(
    seed=st.integers(0, 2**32 - 1),
    density=st.floats(0.0, 10.0, width=32),
    noise_m=st.floats(0.0078125, 10.0, width=32),
    decay=st.floats(0.0, 1.0, width=32),
)
def test_covariance_stays_symmetric_and_positive(
    seed: int, density: float, noise_m: float, decay: float
) -> None:
    rng = np.random.default_rng(seed)
    kalman = _core.ConstantVelocityFilter(
        np.zeros(4, np.float32), np.diag([1.0, 4.0, 1.0, 4.0]).astype(np.float32)
    )
    noise = (noise_m**2 * np.eye(2)).astype(np.float32)
    for _ in range(50):
        kalman.predict(float(rng.uniform(0.01, 1.0)), density, decay)
        before = kalman.covariance
        kalman.update(float(rng.normal()), float(rng.normal()), noise)
        after = kalman.covariance
        assert np.array_equal(after, after.T)
        assert np.linalg.eigvalsh(after.astype(np.float64)).min() >= -1e-6 * np.abs(after).max()
        assert np.all(np.diag(after) <= np.diag(before) * (1.0 + 1e-5))  # a measurement never harms


def test_learns_the_velocity_of_a_straight_walk() -> None:
    kalman = _core.ConstantVelocityFilter(np.zeros(4, np.float32), (4.0 * np.eye(4)).astype(np.float32))
    noise = (0.01 * np.eye(2)).astype(np.float32)
    for step in range(1, 101):
        kalman.predict(0.1, 1e-4)
        kalman.update(0.12 * step, -0.05 * step, noise)
    assert kalman.state == pytest.approx([12.0, 1.2, -5.0, -0.5], abs=0.02)
