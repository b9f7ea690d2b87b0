"""Laws of the assignment."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from echofuse import _core
from echofuse.reference.estimation.assignment import assign

SIDE = st.integers(1, _core.LIMITS["max_assignment"])


@given(rows=SIDE, columns=SIDE, seed=st.integers(0, 2**32 - 1), levels=st.sampled_from([2, 10, 10**6]))
def test_costs_as_little_as_the_optimum(rows: int, columns: int, seed: int, levels: int) -> None:
    """Ties included: few levels make many."""
    cost = (np.random.default_rng(seed).integers(0, levels, (rows, columns)) / levels).astype(np.float32)
    status, found = _core.assign(cost)
    assert status == _core.Status.ok
    exact = cost.astype(np.float64)
    best = exact[linear_sum_assignment(exact)].sum()
    for column_of_row in (found, assign(exact)):
        paired = np.flatnonzero(column_of_row >= 0)
        assert len(paired) == min(rows, columns)
        assert len(set(column_of_row[paired])) == len(paired)
        assert exact[paired, column_of_row[paired]].sum() == pytest.approx(best, abs=1e-5)


def test_refuses_what_it_cannot_solve() -> None:
    too_many = _core.LIMITS["max_assignment"] + 1
    assert _core.assign(np.zeros((too_many, 1), np.float32))[0] == _core.Status.invalid_input
    assert _core.assign(np.full((2, 2), np.nan, np.float32))[0] == _core.Status.invalid_input
    status, columns = _core.assign(np.zeros((3, 0), np.float32))
    assert status == _core.Status.ok
    assert columns.tolist() == [-1, -1, -1]
