"""The receiver: pulses at exact delays, noise of the link budget, jitter, counts."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import hilbert

from echofuse.simulation.propagation import Paths
from echofuse.simulation.radar_frontend import RadarFrontend
from echofuse.simulation.radio import Pulse, Radio
from echofuse.simulation.scene import sensor_radar_scene
from echofuse.simulation.sensor_radar import SensorRadarSimulation

PULSE, RADIO = Pulse(), Radio()
FRONTEND = RadarFrontend(PULSE, RADIO)


def peak_sample(scan: NDArray[np.floating]) -> float:
    """Sub-sample place of the envelope's peak; a parabola through its logarithm is exact for a Gaussian."""
    envelope = np.log(np.abs(hilbert(scan)) + 1e-30)
    k = int(np.argmax(envelope))
    before, at, after = envelope[k - 1 : k + 2]
    return float(k + 0.5 * (before - after) / (before - 2.0 * at + after))


def one_path(delay_s: float, gain: float = 1.0) -> Paths:
    return Paths(np.array([delay_s]), np.array([gain]))


@pytest.mark.parametrize("samples", [0.0, 100.0, 327.68, 900.5, 1731.013])
def test_a_pulse_is_the_closed_form_at_any_delay(samples: float) -> None:
    delay_s = samples / RADIO.sample_rate_hz
    scan = FRONTEND.receive(one_path(delay_s, 1e-3), 0.0)
    t = np.arange(RADIO.n_samples) / RADIO.sample_rate_hz - delay_s
    envelope = np.exp(-0.5 * (t / PULSE.envelope_deviation_s) ** 2)
    exact = 1e-3 * RADIO.pulse_amplitude_v(PULSE) * np.cos(2.0 * np.pi * PULSE.centre_hz * t) * envelope
    np.testing.assert_allclose(scan, exact, atol=2e-5 * np.max(exact))


def test_the_band_is_2_2_ghz_at_minus_10_db_about_4_3_ghz() -> None:
    power = np.abs(np.fft.rfft(FRONTEND.receive(one_path(50e-9), 0.0), 2**16)) ** 2
    frequency = np.fft.rfftfreq(2**16, 1.0 / RADIO.sample_rate_hz)
    inside = frequency[power > 0.1 * power.max()]
    assert inside[0] == pytest.approx(3.2e9, abs=5e6)
    assert inside[-1] == pytest.approx(5.4e9, abs=5e6)


def test_a_received_pulse_has_the_transmitted_energy_times_the_gain() -> None:
    scan = FRONTEND.receive(one_path(40e-9, 1e-3), 0.0)
    energy_j = np.sum(scan**2) / RADIO.impedance_ohm / RADIO.sample_rate_hz
    assert energy_j / RADIO.pulse_energy_j == pytest.approx(1e-6, rel=1e-4, abs=0.0)
    assert RADIO.pulse_energy_j == pytest.approx(10 ** (-1.264) * 1e-3 * 117.1875e-9, rel=1e-9, abs=0.0)


@pytest.mark.parametrize("delay_s", [-5e-9, 122e-9, 500e-9])
def test_what_arrives_outside_the_scan_does_not_come_around(delay_s: float) -> None:
    assert np.max(np.abs(FRONTEND.receive(one_path(delay_s), 0.0))) < 1e-4


def test_paths_add_up() -> None:
    both = Paths(np.array([30e-9, 30.3e-9]), np.array([1.0, -0.4]))
    apart = FRONTEND.receive(one_path(30e-9), 0.0) + FRONTEND.receive(one_path(30.3e-9, -0.4), 0.0)
    np.testing.assert_allclose(FRONTEND.receive(both, 0.0), apart, atol=1e-9)


def test_noise_variance_is_the_link_budgets() -> None:
    rng = np.random.default_rng(7)
    noise = np.concatenate([FRONTEND.noise(rng) for _ in range(200)])
    k_t_f = 1.380649e-23 * 290.0 * 10**0.48
    assert np.mean(noise**2) / 50.0 == pytest.approx(k_t_f * 2.2e9 / 20480, rel=0.02, abs=0.0)
    assert abs(np.mean(noise)) < 0.02 * np.std(noise)


def test_more_pulses_mean_less_noise() -> None:
    fourfold = replace(RADIO, pulses_per_scan=4 * RADIO.pulses_per_scan)
    assert fourfold.noise_deviation_v == pytest.approx(RADIO.noise_deviation_v / 2.0, rel=1e-9, abs=0.0)


def test_scan_start_jitters_and_slips() -> None:
    rng = np.random.default_rng(3)
    radio = replace(RADIO, lock_slip_probability=0.25, lock_slip_max_samples=2)
    frontend = RadarFrontend(PULSE, radio)
    late = np.array([frontend.start_error_s(rng) for _ in range(4000)]) * radio.sample_rate_hz
    slip = np.rint(late)
    assert set(np.unique(slip)) == {-2.0, -1.0, 0.0, 1.0, 2.0}
    assert np.mean(slip != 0.0) == pytest.approx(0.25 * 4 / 5, abs=0.03)
    assert np.std(late - slip) == pytest.approx(10e-12 * radio.sample_rate_hz, rel=0.05)


def test_a_late_start_shows_the_pulse_early() -> None:
    still = replace(RADIO, timing_jitter_s=200e-12, lock_slip_probability=0.0)
    frontend = RadarFrontend(PULSE, still)
    late_s = frontend.start_error_s(np.random.default_rng(5))
    scan = frontend.scan(one_path(60e-9, 1e-3), 0.0, np.random.default_rng(5))
    assert peak_sample(scan) == pytest.approx((60e-9 - late_s) * still.sample_rate_hz, abs=0.02)


def test_counts_are_whole_and_noise_is_about_five_of_them() -> None:
    scan = FRONTEND.scan(Paths(np.zeros(0), np.zeros(0)), 0.0, np.random.default_rng(1))
    assert scan.dtype == np.float32
    np.testing.assert_array_equal(scan, np.rint(scan))
    assert 4.5 < np.std(scan) < 5.7


def test_a_pulse_beyond_nyquist_is_refused() -> None:
    with pytest.raises(ValueError, match="sample_rate_hz"):
        RadarFrontend(PULSE, replace(RADIO, sample_rate_hz=8e9))


def test_other_radios_work_too() -> None:
    pulse = Pulse(centre_hz=3.0e9, bandwidth_hz=1.2e9)
    frontend = RadarFrontend(pulse, replace(RADIO, sample_rate_hz=10e9, n_samples=777))
    scan = frontend.receive(one_path(31.27e-9), 3e-9)
    assert len(scan) == 777
    assert peak_sample(scan) == pytest.approx(282.7, abs=0.02)


def test_direct_path_arrives_at_the_geometric_delay_at_every_node() -> None:
    scene = sensor_radar_scene()
    bare = replace(
        scene,
        furniture=(),
        room=replace(
            scene.room, wall_reflections=(0.0, 0.0, 0.0, 0.0), floor_reflection=0, ceiling_reflection=0
        ),
    )
    simulation = SensorRadarSimulation(bare, (), seed=0)
    frontend = RadarFrontend(bare.pulse, bare.radio)
    for which, node in enumerate(bare.nodes):
        first_s = bare.first_sample_s(node)
        place = peak_sample(frontend.receive(simulation.paths(which, 0.0), first_s))
        expected_s = math.dist(node.tx_position_m, node.rx_position_m) / 299_792_458.0
        assert first_s + place / bare.radio.sample_rate_hz == pytest.approx(expected_s, abs=0.1 * 61.035e-12)
        assert place == pytest.approx(20e-9 * 16.384e9, abs=0.1)
