"""The receiver: paths in, one integrated scan of counts out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from echofuse.simulation.propagation import Paths
from echofuse.simulation.radio import Pulse, Radio
from echofuse.simulation.synthesis import path_spectrum

Array = NDArray[np.float64]

GUARD_SAMPLES = 64  # before and after the scan, so that a pulse that it cuts does not come around the circle
FAINTEST = 1e-5  # spectrum and paths below this part of their maximum are left out
NOISE_EDGE = 0.1  # of the noise bandwidth, roll-off of the band-pass at each side


class RadarFrontend:
    """Band-limited synthesis on the scan's frequency grid: delays are exact, to no sample."""

    def __init__(self, pulse: Pulse, radio: Radio) -> None:
        self.pulse, self.radio = pulse, radio
        if pulse.centre_hz + pulse.bandwidth_hz / 2.0 >= radio.sample_rate_hz / 2.0:
            raise ValueError("Radio.sample_rate_hz: too low for the pulse")
        self._n_fft = _even_fft_size(radio.n_samples + 2 * GUARD_SAMPLES)
        self._frequency_hz = np.fft.rfftfreq(self._n_fft, 1.0 / radio.sample_rate_hz)
        offset = (self._frequency_hz - pulse.centre_hz) / pulse.spectrum_deviation_hz
        shape = np.exp(-0.5 * offset**2)
        in_band = np.flatnonzero(shape > FAINTEST)
        self._first_bin = int(in_band[0])
        step = int(np.ceil(np.sqrt(len(in_band))))  # a square costs no more
        self._bins = slice(self._first_bin, min(self._first_bin + step**2, len(shape)))
        scale = 0.5 * pulse.envelope_deviation_s * np.sqrt(2.0 * np.pi) * radio.sample_rate_hz
        self._template_v = radio.pulse_amplitude_v(pulse) * scale * shape[self._bins]
        self._noise_shape_v = self._noise_spectrum()

    def receive(self, paths: Paths, first_sample_s: float) -> Array:
        """Noise-free scan (n_samples,) [V]: sum of the paths' pulses, each peaking at its delay."""
        delay_s = paths.delay_s - first_sample_s
        guard_s = GUARD_SAMPLES / self.radio.sample_rate_hz
        loudest = float(np.max(np.abs(paths.gain), initial=0.0))
        heard = (delay_s > -guard_s) & (delay_s < self.radio.pulse_period_s + guard_s)
        heard &= np.abs(paths.gain) > FAINTEST * loudest
        response = path_spectrum(
            delay_s[heard],
            paths.gain[heard],
            first_bin=self._first_bin,
            n_bins=len(self._template_v),
            bin_spacing_hz=self.radio.sample_rate_hz / self._n_fft,
        )
        spectrum = np.zeros(len(self._frequency_hz), dtype=np.complex128)
        spectrum[self._bins] = response * self._template_v
        return np.asarray(np.fft.irfft(spectrum, self._n_fft)[: self.radio.n_samples])

    def noise(self, rng: np.random.Generator) -> Array:
        """Thermal noise of an integrated scan (n_samples,) [V], coloured by the band-pass."""
        white = rng.standard_normal((2, len(self._frequency_hz)))
        spectrum = self._noise_shape_v * (white[0] + 1j * white[1])
        return np.asarray(np.fft.irfft(spectrum, self._n_fft)[: self.radio.n_samples])

    def start_error_s(self, rng: np.random.Generator) -> float:
        """By how much a scan starts late: normal jitter, and now and then a slip by whole samples."""
        radio = self.radio
        late_s = radio.timing_jitter_s * float(rng.standard_normal())
        slips, by = rng.random() < radio.lock_slip_probability, radio.lock_slip_max_samples
        slip = int(rng.integers(-by, by + 1))
        return late_s + (slip / radio.sample_rate_hz if slips else 0.0)

    def scan(self, paths: Paths, first_sample_s: float, rng: np.random.Generator) -> NDArray[np.float32]:
        """(n_samples,) [count] as the radar hands it over."""
        start_s = first_sample_s + self.start_error_s(rng)
        counts = (self.receive(paths, start_s) + self.noise(rng)) * self.radio.count_per_volt
        return np.asarray(np.rint(counts) if self.radio.quantise else counts, dtype=np.float32)

    def _noise_spectrum(self) -> Array:
        """(n_bins,) amplitude per unit normal: a band-pass of the budget's power, raised-cosine edges."""
        half = self.radio.noise_bandwidth_hz / 2.0
        edge = np.abs(self._frequency_hz - self.pulse.centre_hz) - half
        roll = 2.0 * half * NOISE_EDGE
        power = 0.5 - 0.5 * np.sin(np.pi / 2.0 * np.clip(edge / roll, -1.0, 1.0))
        power[[0, -1]] = 0.0  # these two bins are real
        variance = 4.0 * float(np.sum(power)) / self._n_fft**2  # of irfft with unit normals in both parts
        return np.asarray(np.sqrt(power / variance) * self.radio.noise_deviation_v)


def _even_fft_size(at_least: int) -> int:
    """The smallest even 2^a 3^b 5^c from there on."""
    size = at_least + at_least % 2
    while True:
        rest = size
        for prime in (2, 3, 5):
            while rest % prime == 0:
                rest //= prime
        if rest == 1:
            return size
        size += 2
