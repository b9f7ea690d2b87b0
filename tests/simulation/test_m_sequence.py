"""The sequence, and the front-end against correlation in the time domain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from echofuse.simulation.m_sequence import FEEDBACK, MSequenceFrontend, MSequenceRadar, m_sequence
from echofuse.simulation.propagation import Paths
from echofuse.simulation.synthesis import Spectrum, path_spectrum

RADAR = MSequenceRadar()
FRONTEND = MSequenceFrontend(RADAR)


def channel(frontend: MSequenceFrontend, paths: Paths) -> Spectrum:
    return path_spectrum(
        paths.delay_s,
        paths.gain,
        first_bin=0,
        n_bins=len(frontend.frequency_hz),
        bin_spacing_hz=frontend.bin_spacing_hz,
    )


def one_path(delay_s: float, gain: float = 1.0) -> Paths:
    return Paths(np.array([delay_s]), np.array([gain]))


@pytest.mark.parametrize("order", sorted(FEEDBACK))
def test_the_autocorrelation_of_an_m_sequence_has_two_values(order: int) -> None:
    sequence = m_sequence(order)
    n = 2**order - 1
    assert sequence.shape == (n,)
    assert np.sum(sequence) == -1.0  # one more of one chip than of the other
    correlation = np.fft.irfft(np.abs(np.fft.rfft(sequence)) ** 2, n)
    assert correlation[0] == pytest.approx(n, rel=1e-12)
    np.testing.assert_allclose(correlation[1:], -1.0, atol=1e-9)


def test_the_paper_s_radar_has_511_samples_in_114_ns() -> None:
    assert RADAR.n_samples == 511
    assert RADAR.n_samples / RADAR.clock_hz == pytest.approx(113.6e-9, abs=0.05e-9)
    assert MSequenceRadar(order=12, clock_hz=7e9).n_samples == 4095


def test_the_front_end_is_the_correlation_of_received_chips_with_the_sequence() -> None:
    radar = replace(RADAR, order=7, lowest_hz=0.0)
    frontend, sequence = MSequenceFrontend(radar), m_sequence(7)
    chips, gains = (3, 40, 126), (1.0, -0.3, 0.05)
    received = np.sum(
        [gain * np.roll(sequence, chip) for chip, gain in zip(chips, gains, strict=True)], axis=0
    )
    correlated = [np.dot(received, np.roll(sequence, lag)) / len(sequence) for lag in range(len(sequence))]
    # That is all chips as impulses; the radar holds them, and filters before it samples.
    of_nyquist = frontend.frequency_hz / (radar.clock_hz / 2.0)
    low_pass = np.where(of_nyquist < 0.8, 1.0, np.cos(np.pi / 2.0 * (of_nyquist - 0.8) / 0.2) ** 2)
    filtered = np.fft.rfft(correlated) * np.sinc(frontend.frequency_hz / radar.clock_hz) * low_pass
    expected = np.fft.irfft(filtered, radar.n_samples)
    paths = Paths(np.array(chips) / radar.clock_hz, np.array(gains))
    response = frontend.receive(channel(frontend, paths))
    np.testing.assert_allclose(response / response[3], expected / expected[3], atol=1e-9)


@pytest.mark.parametrize("samples", [0.0, 6.004, 100.5, 510.9])
def test_a_path_peaks_at_its_delay(samples: float) -> None:
    response = FRONTEND.receive(channel(FRONTEND, one_path(samples / RADAR.clock_hz, 1e-2)))
    # The band-limited response between the samples, 1e-4 of a sample apart, is its trigonometric polynomial.
    offset = np.arange(-500, 501) * 1e-4
    spectrum = np.fft.rfft(response)
    spectrum[1:] *= 2.0
    turn = np.exp(2j * np.pi * np.outer(samples + offset, np.arange(len(spectrum))) / RADAR.n_samples)
    between = (turn @ spectrum).real / RADAR.n_samples
    assert offset[np.argmax(between)] == pytest.approx(0.0, abs=1e-9)
    assert np.max(between) == pytest.approx(1e-2 * RADAR.count_at_unit_gain, rel=1e-9)


def test_the_antennas_cut_the_lowest_frequencies_and_the_sampler_the_highest() -> None:
    frequency_hz = FRONTEND.frequency_hz
    spectrum = np.abs(np.fft.rfft(FRONTEND.receive(channel(FRONTEND, one_path(0.0)))))
    both_antennas = frequency_hz**2 / (frequency_hz**2 + 0.4e9**2)
    expected = both_antennas * np.sinc(frequency_hz / 4.5e9)
    flat = frequency_hz < 0.8 * 2.25e9
    middle = np.argmin(np.abs(frequency_hz - 1.1e9))
    np.testing.assert_allclose(
        (spectrum / spectrum[middle])[flat], (expected / expected[middle])[flat], atol=1e-6
    )
    assert spectrum[-1] < 1e-3 * spectrum[middle]


def test_cables_are_part_of_every_delay() -> None:
    late = MSequenceFrontend(replace(RADAR, group_delay_s=3.0 / RADAR.clock_hz))
    paths = one_path(20.25 / RADAR.clock_hz)
    np.testing.assert_allclose(
        late.receive(channel(late, paths)), np.roll(FRONTEND.receive(channel(FRONTEND, paths)), 3), atol=1e-6
    )


def test_noise_is_white_but_for_its_mean() -> None:
    rng = np.random.default_rng(5)
    noise = np.stack([FRONTEND.noise(rng) for _ in range(400)])
    assert np.std(noise) == pytest.approx(RADAR.noise_count, rel=0.01)
    power = np.mean(np.abs(np.fft.rfft(noise, axis=1)) ** 2, axis=0)
    np.testing.assert_allclose(power[1:] / np.mean(power[1:]), 1.0, atol=0.3)  # 6 standard deviations
    assert power[0] / np.mean(power[1:]) == pytest.approx(1.0 / 512.0, rel=0.3)


def test_a_response_begins_at_the_start_chip() -> None:
    quiet = MSequenceFrontend(replace(RADAR, noise_count=0.0))
    gains = channel(quiet, one_path(6.0 / RADAR.clock_hz))
    response = quiet.response(gains, 507, np.random.default_rng(0))
    assert response.dtype == np.float32
    assert np.argmax(response) == 2  # 507 + 6 - 511


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"order": 6}, "order: 6, expected 7 to 13"),
        ({"clock_hz": 0.0}, "clock_hz"),
        ({"lowest_hz": 2.25e9}, "lowest_hz"),
        ({"noise_count": -1.0}, "noise_count"),
        ({"response_period_s": float("nan")}, "response_period_s"),
    ],
)
def test_impossible_radars_are_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(RADAR, **change)  # type: ignore[arg-type]


def test_an_unknown_order_is_refused() -> None:
    with pytest.raises(ValueError, match="order: 3"):
        m_sequence(3)
