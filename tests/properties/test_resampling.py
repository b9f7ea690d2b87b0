"""Laws of systematic resampling."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from echofuse import _core

WEIGHTS = arrays(np.float32, st.integers(1, 300), elements=st.floats(0.0, 1e3, width=32))


@given(weights=WEIGHTS, uniform=st.floats(0.0, 1.0, exclude_max=True, width=32), n_out=st.integers(1, 2048))
def test_each_is_drawn_as_often_as_its_share(weights: np.ndarray, uniform: float, n_out: int) -> None:
    """To less than one copy, whatever the uniform number; what has no weight is never drawn."""
    status, indices = _core.systematic_resample(weights, uniform, n_out)
    total = weights.sum(dtype=np.float64)
    if total == 0.0:
        assert status == _core.Status.invalid_input
        return
    assert status == _core.Status.ok
    copies = np.bincount(indices, minlength=len(weights))
    expected = n_out * weights.astype(np.float64) / total
    assert np.all(np.diff(indices.astype(int)) >= 0)
    assert np.all(np.abs(copies - expected) < 1.0 + 1e-3)
    assert copies[weights < 1e-7 * total / n_out].sum() <= 1


def test_is_unbiased() -> None:
    weights = np.random.default_rng(3).exponential(size=50).astype(np.float32)
    draws = [_core.systematic_resample(weights, k / 500, 40)[1] for k in range(500)]
    mean = np.mean([np.bincount(d, minlength=50) for d in draws], axis=0)
    assert np.allclose(mean, 40 * weights / weights.sum(), atol=0.01)
