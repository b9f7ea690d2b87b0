"""Alignment: recovered shifts, residual clutter, exact whole shifts, bad input."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from echofuse import _core

FS = 16.384e9
N = 1200


def aligner(method: str = "sub_sample") -> _core.Aligner:
    core = _core.Aligner()
    assert (
        core.configure(_core.AlignmentConfig(method=getattr(_core.AlignmentMethod, method)))
        == _core.Status.ok
    )
    return core


def room(late: float, seed: int = 0) -> NDArray[np.float32]:
    """Envelope of a direct path and 60 multipaths, all `late` samples later, (N,) [count]."""
    rng = np.random.default_rng(seed)
    k = np.arange(N)
    scan = (
        3000.0 * np.exp(-0.5 * ((k - 330 - late) / 5.0) ** 2) * np.cos(2 * np.pi * 0.262 * (k - 330 - late))
    )
    for place, gain in zip(rng.uniform(350, 1100, 60), rng.normal(0, 250, 60), strict=True):
        x = k - place - late
        scan += gain * np.exp(-0.5 * (x / 5.0) ** 2) * np.cos(2 * np.pi * 0.262 * x)
    core = _core.Envelope()
    assert core.configure(_core.EnvelopeConfig(), FS) == _core.Status.ok
    return np.asarray(core.process(scan.astype(np.float32))[1])


@given(late=st.floats(-40.0, 40.0), error=st.integers(-6, 6))
def test_the_shift_is_recovered(late: float, error: int) -> None:
    """algorithms.md 6.3: 0.004 samples."""
    status, found = aligner().estimate(room(late), room(0.0), round(late) + error, 0, N)
    assert status == _core.Status.ok
    assert found.shift_samples == pytest.approx(late, abs=0.02)
    assert found.correlation > 0.98


def test_residual_clutter_falls_with_finer_alignment() -> None:
    """algorithms.md 6.3: -17.6 dB without, -28.0 dB by whole samples, -36.5 dB by fractions."""
    rng, background = np.random.default_rng(8), room(0.0)
    power: dict[str, list[float]] = {"none": [], "integer": [], "sub_sample": []}
    for late in rng.normal(0.0, 1.3, 40):
        scan = room(float(late))
        for method, powers in power.items():
            core = aligner(method)
            _, found = core.estimate(scan, background, 0, 0, N)
            residual = core.shift(scan, found.shift_samples)[1][20:-20] - background[20:-20]
            powers.append(float(np.sum(residual**2) / np.sum(background**2)))
    none_db, integer_db, sub_sample_db = (10.0 * np.log10(np.mean(powers)) for powers in power.values())
    assert -20.0 < none_db < -8.0
    assert integer_db < none_db - 8.0
    assert sub_sample_db < min(-36.5, integer_db - 8.0)


@given(shift=st.integers(-50, 50), seed=st.integers(0, 100))
def test_whole_shifts_copy_exactly(shift: int, seed: int) -> None:
    samples = np.random.default_rng(seed).normal(size=80).astype(np.float32)
    status, got = aligner().shift(samples, float(shift))
    expected = np.zeros(80, np.float32)
    source = np.arange(80) + shift
    inside = (source >= 0) & (source < 80)
    expected[inside] = samples[source[inside]]
    assert status == _core.Status.ok
    assert np.array_equal(got, expected)


@given(shift=st.floats(-3.0, 3.0), cycles=st.floats(0.0, 0.33))
def test_fractions_delay_a_tone_of_the_band(shift: float, cycles: float) -> None:
    k = np.arange(200)
    tone = np.cos(2.0 * np.pi * cycles * k).astype(np.float32)
    _, got = aligner().shift(tone, shift)
    exact = np.cos(2.0 * np.pi * cycles * (k + np.float32(shift)))
    assert np.max(np.abs(got - exact)[15:-15]) < 2e-3


def test_bad_input() -> None:
    core = _core.Aligner()
    ones = np.ones(20, np.float32)
    assert core.shift(ones, 0.0)[0] == _core.Status.not_configured
    core = aligner()
    assert core.shift(ones, float("nan"))[0] == _core.Status.invalid_input
    assert core.shift(ones, 21.0)[0] == _core.Status.invalid_input
    for arguments in (
        (ones, ones[:19], 0, 0, 19),
        (ones, ones, 0, 5, 5),
        (ones, ones, 0, -1, 5),
        (ones, ones, 21, 0, 5),
    ):
        assert core.estimate(*arguments)[0] == _core.Status.invalid_input
    for config in (
        _core.AlignmentConfig(max_shift_samples=0),
        _core.AlignmentConfig(interpolator_half_length_samples=99),
    ):
        assert core.configure(config) == _core.Status.invalid_config
