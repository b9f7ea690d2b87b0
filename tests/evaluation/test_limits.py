"""The bounds' numbers, worked out independently, and estimators that reach them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from echofuse.evaluation.limits import (
    bistatic_path_bound_m,
    delay_bound_s,
    effective_bandwidth_rad_s,
    monostatic_range_bound_m,
    position_covariance_bound_m2,
    position_error_bound_m,
)

# The breathing paper's pulse exp(-a t^2) cos(b t).
A_PER_S2, B_RAD_PER_S = 5.55e18, 26.15e9
COHERENT = np.sqrt(A_PER_S2 + B_RAD_PER_S**2)
ENVELOPE = np.sqrt(A_PER_S2)


def test_bandwidth_of_a_gaussian_pulse() -> None:
    assert pytest.approx(2.626e10, rel=5e-4) == COHERENT
    assert pytest.approx(2.356e9, rel=5e-4) == ENVELOPE
    rate_hz = 1e11
    time_s = np.arange(-400, 400) / rate_hz
    envelope = np.exp(-A_PER_S2 * time_s**2)
    assert effective_bandwidth_rad_s(envelope * np.cos(B_RAD_PER_S * time_s), rate_hz) == pytest.approx(
        COHERENT
    )
    assert effective_bandwidth_rad_s(envelope, rate_hz) == pytest.approx(ENVELOPE)
    baseband = envelope * np.exp(1j * 0.0)
    assert effective_bandwidth_rad_s(baseband, rate_hz) == pytest.approx(ENVELOPE)


def test_bandwidth_of_a_rectangular_band() -> None:
    """beta = pi B / sqrt(3)."""
    rate_hz, band_hz = 16e9, 2.2e9
    time_s = (np.arange(2**16) - 2**15) / rate_hz
    expected = np.pi * band_hz / np.sqrt(3.0)
    assert effective_bandwidth_rad_s(np.sinc(band_hz * time_s), rate_hz) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    ("ratio_db", "coherent_mm", "envelope_mm"), [(10, 1.81, 20.1), (20, 0.57, 6.36), (30, 0.18, 2.01)]
)
def test_range_bounds(ratio_db: float, coherent_mm: float, envelope_mm: float) -> None:
    ratio = 10.0 ** (ratio_db / 10.0)
    assert 1e3 * monostatic_range_bound_m(ratio, COHERENT) == pytest.approx(coherent_mm, abs=0.006)
    assert 1e3 * monostatic_range_bound_m(ratio, ENVELOPE) == pytest.approx(envelope_mm, abs=0.05)
    assert bistatic_path_bound_m(ratio, ENVELOPE) == pytest.approx(
        2.0 * monostatic_range_bound_m(ratio, ENVELOPE)
    )


def test_delay_bounds() -> None:
    assert 1e12 * delay_bound_s(100.0, COHERENT) == pytest.approx(3.81, abs=0.005)
    assert_allclose(1e12 * delay_bound_s([100.0, 1000.0], ENVELOPE), [42.4, 13.4], atol=0.05)


def test_a_matched_filter_reaches_the_coherent_bound() -> None:
    """Monte Carlo at 2E/N0 = 20 dB: the best delay of the correlation with a known pulse."""
    rate_hz, n_runs, ratio = 50e9, 1500, 100.0
    time_s = np.arange(-60, 61) / rate_hz
    offsets_s = np.linspace(-20e-12, 20e-12, 401)
    shifted = time_s - offsets_s[:, np.newaxis]
    templates = np.exp(-A_PER_S2 * shifted**2) * np.cos(B_RAD_PER_S * shifted)
    pulse = templates[200]
    sigma = np.sqrt(np.sum(pulse**2) / ratio)  # 2E/N0 = sum s^2 / sigma^2
    received = pulse + sigma * np.random.default_rng(3).normal(size=(n_runs, pulse.size))
    estimates_s = offsets_s[np.argmax(received @ templates.T, axis=1)]
    assert np.std(estimates_s) == pytest.approx(delay_bound_s(ratio, COHERENT), rel=0.08)


def test_handheld_array() -> None:
    """Tx in the middle of two Rx, 0.4 m to each side: the cross-range error is the limit."""
    tx, rx = np.zeros((2, 2)), np.array([[-0.4, 0.0], [0.4, 0.0]])
    places = [(0.0, 4.0), (1.5, 4.0), (2.0, 6.0)]
    expected = [(0.237, 0.012), (0.252, 0.095), (0.373, 0.125)]
    covariance = position_covariance_bound_m2(places, tx, rx, 0.0333)  # printed as 3.3 cm
    assert_allclose(np.sqrt(np.diagonal(covariance, axis1=-2, axis2=-1)), expected, atol=6e-4)


def test_three_dimensions() -> None:
    """Four Rx around a Tx, d = 0.39 m, path sigma 2 cm: 0.146 m cross-range at 4 m depth."""
    d = 0.39
    rx = np.array([[d, 0, 0], [-d, 0, 0], [0, 0, d], [0, 0, -d]])
    covariance = position_covariance_bound_m2((0.0, 4.0, 0.0), np.zeros((4, 3)), rx, 0.02)
    across_x, depth, across_z = np.sqrt(np.diag(covariance))
    assert (across_x, across_z) == (pytest.approx(0.146, abs=5e-4), pytest.approx(0.146, abs=5e-4))
    assert depth == pytest.approx(0.005, abs=5e-4)


TX_M = np.tile([5.75, 0.0], (6, 1))
RX_M = np.array([[0.0, 1.5], [1.9, 6.0], [5.75, 6.0], [9.6, 6.0], [11.5, 4.5], [11.5, 1.0]])


def test_six_receivers_and_maximum_likelihood() -> None:
    """Path sigma 5 cm: 3 to 5 cm in the room, and Gauss-Newton on the paths reaches it."""
    places = np.array([[5.0, 3.0], [3.0, 3.0], [8.0, 2.0]])
    bounds = position_error_bound_m(places, TX_M, RX_M, 0.05)
    assert np.all((bounds > 0.03) & (bounds < 0.05))
    rng = np.random.default_rng(11)
    for place, bound in zip(places, bounds, strict=True):
        paths = path_lengths(place, TX_M, RX_M)
        errors = []
        for _ in range(600):
            measured = paths + rng.normal(0.0, 0.05, paths.size)
            guess = place.copy()
            for _ in range(4):
                gradient = np.stack(
                    [
                        (path_lengths(guess + step, TX_M, RX_M) - path_lengths(guess - step, TX_M, RX_M))
                        / 2e-6
                        for step in 1e-6 * np.eye(2)
                    ],
                    axis=1,
                )
                guess = guess + np.linalg.lstsq(gradient, measured - path_lengths(guess, TX_M, RX_M))[0]
            errors.append(np.sum((guess - place) ** 2))
        assert np.sqrt(np.mean(errors)) == pytest.approx(bound, rel=0.08)


def path_lengths(place: np.ndarray, tx: np.ndarray, rx: np.ndarray) -> np.ndarray:
    return np.linalg.norm(place - tx, axis=1) + np.linalg.norm(place - rx, axis=1)


def test_monostatic_and_mixed_nodes() -> None:
    """A monostatic node's path is twice its range, so path sigma 2 s says as much as range sigma s."""
    place, node = np.array([3.0, 4.0]), np.array([[0.0, 0.0], [6.0, 0.0]])
    sigma_m = 0.1
    covariance = position_covariance_bound_m2(place, node, node, 2.0 * sigma_m)
    directions = np.array([[0.6, 0.8], [-0.6, 0.8]])
    assert_allclose(covariance, np.linalg.inv(directions.T @ directions / sigma_m**2), atol=1e-15)
    # One bistatic node more, with its own sigma, adds its information.
    tx, rx = np.vstack([node, [[0.0, 0.0]]]), np.vstack([node, [[6.0, 0.0]]])
    mixed = position_covariance_bound_m2(place, tx, rx, [0.2, 0.2, 0.05])
    gradient = np.array([0.0, 1.6]) / 0.05
    assert_allclose(
        np.linalg.inv(mixed), np.linalg.inv(covariance) + np.outer(gradient, gradient), rtol=1e-9, atol=1e-9
    )


def test_what_cannot_be_located_has_no_bound() -> None:
    on_a_line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    bounds = position_error_bound_m([[5.0, 0.0], [1.0, 1.0]], on_a_line, on_a_line, 0.05)
    assert bounds[0] == np.inf
    assert np.isfinite(bounds[1])
