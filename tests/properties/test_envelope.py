"""Envelope: against the exact one, level, phase, bad input."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import hilbert

from echofuse import _core

FS = 16.384e9
K = np.arange(600)


def envelope(scan, **fields):
    core = _core.Envelope()
    assert core.configure(_core.EnvelopeConfig(**fields), FS) == _core.Status.ok
    status, result = core.process(scan.astype(np.float32))
    assert status == _core.Status.ok
    return np.asarray(result, np.float64)


@given(place=st.floats(60, 540), phase=st.floats(0, 6.28), width=st.floats(3.0, 8.0))
def test_within_one_percent_of_the_exact_envelope(place: float, phase: float, width: float) -> None:
    """3.2 to 5.4 GHz: algorithms.md 6.2 takes the Hilbert transform by FFT."""
    bell = 1000.0 * np.exp(-0.5 * ((K - place) / width) ** 2)
    scan = bell * np.cos(2.0 * np.pi * 4.3e9 / FS * K + phase)
    got = envelope(scan)
    assert np.max(np.abs(got - np.abs(hilbert(scan)))) < 10.0
    assert np.max(np.abs(got - bell)) < 10.0


def test_low_pass_method_gives_an_amplitude_too() -> None:
    bell = 1000.0 * np.exp(-0.5 * ((K - 300.3) / 12.0) ** 2)
    got = envelope(bell * np.cos(2.0 * np.pi * 4.3e9 / FS * K), method=_core.EnvelopeMethod.square_low_pass)
    assert np.max(np.abs(got - bell)) < 50.0


def test_bad_input() -> None:
    core = _core.Envelope()
    assert core.process(np.ones(5, np.float32))[0] == _core.Status.not_configured
    assert (
        core.configure(_core.EnvelopeConfig(hilbert_half_length_samples=0), FS) == _core.Status.invalid_config
    )
    assert core.configure(_core.EnvelopeConfig(), float("nan")) == _core.Status.invalid_config
    assert core.configure(_core.EnvelopeConfig(), FS) == _core.Status.ok
    assert core.process(np.zeros(0, np.float32))[0] == _core.Status.invalid_input
    with pytest.raises(TypeError):
        core.process(np.ones(5))
    with pytest.raises(ValueError, match="one-dimensional"):
        core.process(np.ones((2, 5), np.float32))
