"""Alignment: core against reference, every method."""

import numpy as np
import pytest
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.comparison import COIN_TOSS_MARGIN, Scoreboard, as_reference
from echofuse.reference.signal.alignment import estimate_shift, shifted

SEEDS = range(20)


def pulses(rng: np.random.Generator, n_samples: int, shift: float) -> NDArray[np.float32]:
    """(n_samples,) bells 6 samples wide, the strongest in the middle half, delayed by `shift`."""
    k = np.arange(n_samples)
    centres = np.concatenate([[0.5 * n_samples], rng.uniform(0, n_samples, 12)])
    heights = np.concatenate([[1000.0], rng.uniform(20, 300, 12)])
    bells = [h * np.exp(-0.5 * ((k - c - shift) / 6.0) ** 2) for h, c in zip(heights, centres, strict=True)]
    return np.sum(bells, axis=0).astype(np.float32)


@pytest.mark.parametrize("method", ["sub_sample", "integer", "none"])
def test_estimate(method: str) -> None:
    config = _core.AlignmentConfig(method=getattr(_core.AlignmentMethod, method))
    core = _core.Aligner()
    assert core.configure(config) == _core.Status.ok
    board = Scoreboard()
    for seed in SEEDS:
        n = 300 + 40 * seed
        true_shift = float(np.random.default_rng(seed).uniform(-20, 20))
        reference = pulses(np.random.default_rng(seed + 100), n, 0.0)
        scan = pulses(np.random.default_rng(seed + 100), n, true_shift)
        for first, last, coarse in (
            (0, n, round(true_shift) + 3),
            (100, n - 77, round(true_shift) - 5),
            (n // 4, 3 * n // 4, round(true_shift)),
        ):
            status, got = core.estimate(scan, reference, coarse, first, last)
            assert status == _core.Status.ok
            expected = estimate_shift(
                scan.astype(np.float64),
                reference.astype(np.float64),
                coarse,
                first,
                last,
                as_reference(config),
            )
            if expected.margin < COIN_TOSS_MARGIN and method != "none":
                continue
            where = f"seed {seed}, {first} to {last}"
            board.floats(
                method,
                "shift",
                where,
                [got.shift_samples],
                [expected.shift_samples],
                "signal.alignment.shift",
            )
            board.floats(
                method,
                "correlation",
                where,
                [got.correlation],
                [expected.correlation],
                "signal.alignment.correlation",
            )
    assert all(row.passed and row.cases >= 50 for row in board.rows()), board.as_json()


@pytest.mark.parametrize("half_length", [2, 8, 16])
def test_shift(half_length: int) -> None:
    config = _core.AlignmentConfig(interpolator_half_length_samples=half_length)
    core = _core.Aligner()
    assert core.configure(config) == _core.Status.ok
    board = Scoreboard()
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        samples = rng.normal(0.0, 50.0, rng.integers(30, 300)).astype(np.float32)
        for shift in (0.0, -3.0, 7.0, 1e-6, -1e-9, 0.5, *rng.uniform(-29, 29, 5)):
            exact = float(np.float32(shift))
            status, got = core.shift(samples, exact)
            assert status == _core.Status.ok
            expected = shifted(samples.astype(np.float64), exact, as_reference(config))
            board.floats(
                "shift", "shifted", f"seed {seed}, {shift}", got, expected, "signal.alignment.shifted"
            )
    assert all(row.passed for row in board.rows()), board.as_json()
