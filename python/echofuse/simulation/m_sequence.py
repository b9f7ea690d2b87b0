"""The M-sequence radar: maximum-length binary sequence, and a receiver that correlates with it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.simulation.propagation import friis_gain
from echofuse.simulation.synthesis import Spectrum

Array = NDArray[np.float64]

# Exponents of a primitive polynomial over GF(2) for each order, beside the order itself and 0.
FEEDBACK = {7: (1,), 8: (4, 3, 2), 9: (4,), 10: (3,), 11: (2,), 12: (6, 4, 1), 13: (4, 3, 1)}
ORDERS = f"{min(FEEDBACK)} to {max(FEEDBACK)}"
ROLL_OFF = 0.8  # of half the clock: there the low-pass before the sampler begins to fall


def m_sequence(order: int) -> NDArray[np.float64]:
    """(2^order - 1,) of +1 and -1: s[n + order] = s[n] + sum of s[n + k], k of FEEDBACK, modulo 2."""
    if order not in FEEDBACK:
        raise ValueError(f"order: {order}, expected {ORDERS}")
    bits = [1] * order
    for n in range(2**order - 1 - order):
        bits.append((bits[n] + sum(bits[n + k] for k in FEEDBACK[order])) % 2)
    return 1.0 - 2.0 * np.array(bits, dtype=np.float64)


@dataclass(frozen=True, kw_only=True)
class MSequenceRadar:
    """Radar and antennas, with the paper's values; those of amplitude are in docs/through_wall.md."""

    order: int = 9
    clock_hz: float = 4.5e9  # chips, and samples of the impulse response, a second
    response_period_s: float = 0.074
    lowest_hz: float = 0.4e9  # of the antennas, -3 dB each
    antenna_gain_db: float = 3.0  # each, into the wall's normal; the amplitude falls with the cosine
    sideways_gain_db: float = 0.0  # each, towards the other antennas
    group_delay_s: float = 0.0  # of cables and electronics, part of every delay
    count_at_unit_gain: float = 4e5  # peak of a path with gain 1
    noise_count: float = 8.0  # standard deviation of a sample: 31 dB under a person 2 m away

    def __post_init__(self) -> None:
        if self.order not in FEEDBACK:
            raise ValueError(f"MSequenceRadar.order: {self.order}, expected {ORDERS}")
        if not (self.clock_hz > 0.0 and self.response_period_s > 0.0 and self.count_at_unit_gain > 0.0):
            raise ValueError(
                "MSequenceRadar: clock_hz, response_period_s and count_at_unit_gain must be positive"
            )
        if not 0.0 <= self.lowest_hz < self.clock_hz / 2.0:
            raise ValueError("MSequenceRadar.lowest_hz: in [0, clock_hz / 2)")
        if not self.noise_count >= 0.0:
            raise ValueError("MSequenceRadar.noise_count: must not be negative")

    @property
    def n_samples(self) -> int:
        return int(2**self.order - 1)

    @property
    def wavelength_m(self) -> float:
        """In the middle of the band, for gains."""
        return SPEED_OF_LIGHT_MPS / (self.clock_hz / 4.0)

    def pattern(self, sine: Array) -> Array:
        """Amplitude gain of one antenna at an angle from the wall's normal, any shape [1]."""
        return np.asarray(10.0 ** (self.antenna_gain_db / 20.0) * np.sqrt(1.0 - sine**2))

    def crosstalk_gain(self, distance_m: float) -> float:
        """From one antenna straight to another beside it [1]."""
        return float(friis_gain(distance_m, self.wavelength_m) * 10.0 ** (self.sideways_gain_db / 10.0))


class MSequenceFrontend:
    """Channel in, correlated impulse response out: all in the frequency domain, so circular and exact.

    The sampler runs at the clock, and the low-pass before it keeps below half of that. Spectrum of a path:
    |M|^2 / N (sequence and correlation), sinc(f / clock) (chips are held), the low-pass, and of each of the
    two antennas f / sqrt(f^2 + lowest^2). Phases are equalised: a path peaks exactly at its delay.
    """

    def __init__(self, radar: MSequenceRadar) -> None:
        self.radar = radar
        n = radar.n_samples
        self.bin_spacing_hz = radar.clock_hz / n
        self.frequency_hz = np.arange(n // 2 + 1, dtype=np.float64) * self.bin_spacing_hz  # (n_bins,)
        self._sequence = np.fft.rfft(m_sequence(radar.order)) / math.sqrt(n)
        low_pass = _low_pass(self.frequency_hz / (radar.clock_hz / 2.0))
        square = self.frequency_hz**2
        high_pass = square / np.maximum(square + radar.lowest_hz**2, 1.0)
        if radar.lowest_hz == 0.0:
            high_pass[0] = 1.0
        chip = np.sinc(self.frequency_hz / radar.clock_hz)
        shape = np.abs(self._sequence) ** 2 * chip * low_pass * high_pass
        peak = (shape[0] + 2.0 * np.sum(shape[1:])) / n
        late = np.exp(-2j * np.pi * self.frequency_hz * radar.group_delay_s)
        self._system = radar.count_at_unit_gain / peak * shape * late

    def receive(self, channel: Spectrum) -> Array:
        """Noise-free response (n_samples,) [count] of a channel (n_bins,) of gains; sample 0: no delay."""
        return np.asarray(np.fft.irfft(channel * self._system, self.radar.n_samples))

    def noise(self, rng: np.random.Generator) -> Array:
        """(n_samples,) [count]: white noise of the receiver, after the correlation."""
        white = self.radar.noise_count * rng.standard_normal(self.radar.n_samples)
        return np.asarray(np.fft.irfft(np.fft.rfft(white) * np.conj(self._sequence), self.radar.n_samples))

    def response(self, channel: Spectrum, start_chip: int, rng: np.random.Generator) -> NDArray[np.float32]:
        """(n_samples,) [count] as the radar hands it over: delay 0 is in sample `start_chip`."""
        return np.roll(self.receive(channel) + self.noise(rng), start_chip).astype(np.float32)


def _low_pass(of_half_clock: Array) -> Array:
    """Amplitude (n,): 1, and a cosine roll-off over the last fifth of the band."""
    fall = np.clip((of_half_clock - ROLL_OFF) / (1.0 - ROLL_OFF), 0.0, 1.0)
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * fall))
