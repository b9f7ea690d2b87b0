"""The radio: pulse, link budget, receiver timing and counts, with the paper's values (section VI)."""

from __future__ import annotations

import math
from dataclasses import dataclass

BOLTZMANN_JPK = 1.380649e-23
REFERENCE_TEMPERATURE_K = 290.0


@dataclass(frozen=True, kw_only=True)
class Pulse:
    """The received pulse: a carrier under a Gaussian, `bandwidth_hz` wide between its -10 dB points."""

    kind: str = "gaussian"
    centre_hz: float = 4.3e9
    bandwidth_hz: float = 2.2e9

    def __post_init__(self) -> None:
        if self.kind != "gaussian":
            raise ValueError(f"Pulse.kind: {self.kind!r}, only 'gaussian' can be simulated")
        if not 0.0 < self.bandwidth_hz < 2.0 * self.centre_hz:
            raise ValueError("Pulse.bandwidth_hz: in (0, 2 centre_hz)")

    @property
    def spectrum_deviation_hz(self) -> float:
        """Standard deviation of the Gaussian amplitude spectrum: |P(bandwidth / 2)|^2 = 0.1 |P(0)|^2."""
        return self.bandwidth_hz / 2.0 / math.sqrt(math.log(10.0))

    @property
    def envelope_deviation_s(self) -> float:
        """Standard deviation of the Gaussian envelope."""
        return 1.0 / (2.0 * math.pi * self.spectrum_deviation_hz)


@dataclass(frozen=True, kw_only=True)
class Radio:
    """One kind of radar module."""

    sample_rate_hz: float = 16.384e9
    n_samples: int = 1920
    pulses_per_scan: int = 20480
    transmit_power_dbm: float = -12.64  # mean over time
    noise_figure_db: float = 4.8
    noise_bandwidth_hz: float = 2.2e9  # of the receiver's band-pass, noise equivalent
    antenna_gain_db: float = 0.0  # each antenna, in the horizontal plane
    direct_path_at_s: float = 20e-9  # where in the scan the receiver keeps the direct path (Fig. 5a)
    timing_jitter_s: float = 10e-12  # scan start, normal, new in each scan
    lock_slip_probability: float = 0.1  # that a scan starts whole samples early or late
    lock_slip_max_samples: int = 3
    count_per_volt: float = 2e7  # at the antenna, 50 ohm: thermal noise of a scan is about 5 counts
    quantise: bool = True  # to whole counts
    impedance_ohm: float = 50.0

    def __post_init__(self) -> None:
        if self.n_samples < 1 or self.pulses_per_scan < 1 or not self.sample_rate_hz > 0.0:
            raise ValueError("Radio: n_samples, pulses_per_scan and sample_rate_hz must be positive")

    @property
    def pulse_period_s(self) -> float:
        """T_IP: a scan covers one whole inter-pulse period."""
        return self.n_samples / self.sample_rate_hz

    @property
    def scan_duration_s(self) -> float:
        return self.pulse_period_s * self.pulses_per_scan

    @property
    def pulse_energy_j(self) -> float:
        """Energy of one transmitted pulse: mean power times inter-pulse period."""
        return float(1e-3 * 10.0 ** (self.transmit_power_dbm / 10.0) * self.pulse_period_s)

    @property
    def noise_density_w_per_hz(self) -> float:
        """N_0 = k T F, one-sided."""
        return float(BOLTZMANN_JPK * REFERENCE_TEMPERATURE_K * 10.0 ** (self.noise_figure_db / 10.0))

    @property
    def noise_deviation_v(self) -> float:
        """Thermal noise of an integrated scan: sqrt(N_0 B R / N_s)."""
        power_w = self.noise_density_w_per_hz * self.noise_bandwidth_hz / self.pulses_per_scan
        return math.sqrt(power_w * self.impedance_ohm)

    def pulse_amplitude_v(self, pulse: Pulse) -> float:
        """Peak of A cos(.) exp(-t^2 / 2 s^2) at the transmitter, from its energy A^2 s sqrt(pi) / (2 R)."""
        width_s = pulse.envelope_deviation_s * math.sqrt(math.pi)
        return math.sqrt(2.0 * self.pulse_energy_j * self.impedance_ohm / width_s)

    def integrated_energy_ratio(self) -> float:
        """E N_s / N_0 of what is transmitted: times a path's power gain it is that path's SNR (eqs. 1, 2)."""
        return self.pulse_energy_j * self.pulses_per_scan / self.noise_density_w_per_hz
