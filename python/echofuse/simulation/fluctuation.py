"""How a walking body's echo comes and goes, and what follows it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.simulation.synthesis import Spectrum

Array = NDArray[np.float64]

RCS_DEVIATION_DB = 3.0  # of the whole echo, log-normal
N_WAVES = 8  # sinusoids that make one such fluctuation
SLOWEST, FASTEST = 0.5, 3.0  # of them, in each gait cycle
TAIL_ENERGY = 1.6  # of what comes late, over what comes from the skin at once
TAIL_M = 0.36  # of path in which it falls to 1 / e: 12 dB a metre
N_TAIL = 16


class Aspect(NamedTuple):
    """From where a body is seen: the bisector of the ways to transmitter and receiver."""

    azimuth_rad: float
    elevation_rad: float


class EchoFluctuation:
    """One person's, a smooth random function of gait and aspect; its moments are taken over the draws.

    A body's outline changes as it walks, and its lobes are wavelength / (2 width) wide: so the echo varies
    several times within a cycle of two steps, and two receivers see the less of the same variation the
    farther apart they look. Their correlation is 1 / e where their bisectors differ by one lobe, which in
    elevation is wavelength / (2 height) wide.

    Waves that creep around the body, or go between limbs, trunk and floor, come later: a tail of echoes
    that vary in the same way, each for itself. Level and decay are those of the person in docs/real_walk.md.
    """

    def __init__(
        self, rng: np.random.Generator, *, width_m: float, height_m: float = 0.0, wavelength_m: float
    ) -> None:
        """height_m: 0 where all see the body from one elevation."""
        self._spread = math.sqrt(2.0) * width_m / (math.pi * wavelength_m)  # [1 / rad], one lobe's 1 / e
        self._whole = self._waves(rng, N_WAVES)
        self._late = self._waves(rng, N_TAIL)
        # One echo in each of N_TAIL parts of equal energy.
        self._late_s = (
            -TAIL_M * np.log1p(-(np.arange(N_TAIL) + rng.random(N_TAIL)) / N_TAIL) / SPEED_OF_LIGHT_MPS
        )
        upright = math.sqrt(2.0) * height_m / (math.pi * wavelength_m)
        self._whole[2] = upright * rng.standard_normal(N_WAVES)
        self._late[2] = upright * rng.standard_normal(N_TAIL)

    def amplitude(self, gait_cycles: float, aspect: Aspect) -> float:
        """Factor of the whole echo [1]: log-normal with a mean square of 1, but for the number of waves."""
        deviation = RCS_DEVIATION_DB * math.log(10.0) / 20.0  # of the amplitude's logarithm
        normal = math.sqrt(2.0 / N_WAVES) * float(np.sum(_cosines(self._whole, gait_cycles, aspect)))
        return math.exp(deviation * normal - deviation**2)

    def response(self, gait_cycles: float, aspect: Aspect, frequency_hz: Array) -> Spectrum:
        """(n,) at frequencies (n,): the amplitude, times an echo at once and its tail; mean energy 1."""
        late = math.sqrt(2.0 * TAIL_ENERGY / N_TAIL) * _cosines(self._late, gait_cycles, aspect)
        tail = np.exp(-2j * np.pi * np.outer(frequency_hz, self._late_s)) @ late
        scale = self.amplitude(gait_cycles, aspect) / math.sqrt(1.0 + TAIL_ENERGY)
        return np.asarray(scale * (1.0 + tail))

    def _waves(self, rng: np.random.Generator, count: int) -> Array:
        """(4, count) turns a gait cycle, a radian of azimuth, one of elevation (0 yet), and at the start."""
        return np.stack(
            [
                rng.uniform(SLOWEST, FASTEST, count),
                self._spread * rng.standard_normal(count),
                np.zeros(count),
                rng.random(count),
            ]
        )


def _cosines(waves: Array, gait_cycles: float, aspect: Aspect) -> Array:
    per_cycle, sideways, upwards, start = waves
    turns = per_cycle * gait_cycles + sideways * aspect.azimuth_rad + upwards * aspect.elevation_rad + start
    return np.asarray(np.cos(2.0 * np.pi * turns))
