"""OSPA and GOSPA against numbers worked out by hand, and as metrics."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from echofuse.evaluation.ospa import gospa, ospa

NOBODY = np.zeros((0, 2))


def test_by_hand() -> None:
    true = np.array([[0.0, 0.0], [5.0, 0.0]])
    assert ospa(true, true).distance == 0.0
    assert ospa(NOBODY, NOBODY).distance == 0.0
    assert ospa(NOBODY, true).distance == pytest.approx(1.0)
    one = ospa(np.array([[0.3, 0.4]]), true)  # 0.5 m off, and one missing
    assert one.localisation == pytest.approx(np.sqrt(0.25 / 2))
    assert one.cardinality == pytest.approx(np.sqrt(1.0 / 2))
    assert one.distance == pytest.approx(np.sqrt(1.25 / 2))
    assert ospa(true + 3.0, true, cutoff_m=2.0, order=1.0).distance == pytest.approx(2.0)

    split = gospa(np.array([[0.3, 0.4], [9.0, 9.0], [8.0, 0.0]]), true, cutoff_m=1.0)
    assert (split.n_missed, split.n_false) == (1, 2)
    assert (split.localisation, split.missed, split.false) == pytest.approx((0.25, 0.5, 1.0))
    assert split.distance == pytest.approx(np.sqrt(1.75))
    assert gospa(NOBODY, true).distance == pytest.approx(1.0)


@given(seed=st.integers(0, 2**32 - 1), order=st.sampled_from([1.0, 2.0]))
def test_both_are_metrics(seed: int, order: float) -> None:
    rng = np.random.default_rng(seed)
    a, b, c = (rng.uniform(0.0, 3.0, (rng.integers(0, 6), 2)) for _ in range(3))
    for distance in (ospa, gospa):
        ab, bc, ac = (distance(x, y, order=order).distance for x, y in ((a, b), (b, c), (a, c)))
        assert distance(b, a, order=order).distance == pytest.approx(ab)
        assert ac <= ab + bc + 1e-9
        assert ab >= 0.0
    assert ospa(a, b, order=order).distance <= 1.0 + 1e-9
