"""The wall between the antennas and the room: refracted paths, loss, and echoes inside it.

The model's slab is homogeneous and infinite. x runs along it, y into the room, z up; antennas are at low y.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.simulation.propagation import Paths, friis_gain
from echofuse.simulation.synthesis import Spectrum

Array = NDArray[np.float64]

NEWTON_STEPS = 4
INNER_ECHOES = 3  # of the wall's own response: each is 29 dB below the one before


@dataclass(frozen=True, kw_only=True)
class Wall:
    """A slab, y in [front_m, back_m]. Defaults: the paper's brick wall, 24 cm, antennas 24 cm before it."""

    front_m: float = 0.24
    thickness_m: float = 0.24
    permittivity: float = 4.0  # relative, of brick; ITU-R P.2040 has 3.9
    loss_db_per_m: float = 20.0  # ITU-R P.2040, brick: 1636 sigma / sqrt(eps), sigma = 0.0242 S/m at 1.1 GHz

    def __post_init__(self) -> None:
        if not self.thickness_m > 0.0:
            raise ValueError("Wall.thickness_m: must be positive")
        if not self.permittivity >= 1.0:
            raise ValueError("Wall.permittivity: at least 1")
        if not self.loss_db_per_m >= 0.0:
            raise ValueError("Wall.loss_db_per_m: must not be negative")

    @property
    def back_m(self) -> float:
        return self.front_m + self.thickness_m

    def amplitude_loss(self, slab_m: ArrayLike) -> Array:
        """Of a way inside the wall [m], any shape [1]."""
        return np.asarray(10.0 ** (-self.loss_db_per_m * np.asarray(slab_m) / 20.0))


class Rays(NamedTuple):
    """Refracted rays, all of one shape."""

    delay_s: Array
    length_m: Array  # of the way, in air and wall
    slab_m: Array  # of that, in the wall
    sine: Array  # of the angle in air from the wall's normal [1]


def refracted(wall: Wall, transverse_m: ArrayLike, air_m: ArrayLike, passes: int = 1) -> Rays:
    """Rays that go `transverse_m` along the wall, while `air_m` of air and `passes` walls lie across.

    Snell's law, with u the tangent of the angle in air, p its sine, L = air_m, w the walls' thickness:
        L u + w u / sqrt(eps + (eps - 1) u^2) = transverse
        c delay = L / sqrt(1 - p^2) + w eps / sqrt(eps - p^2)
                = p transverse + L sqrt(1 - p^2) + w sqrt(eps - p^2)    there, and stationary in p (Fermat)
    The left side is concave and grows, so Newton's method from the left goes up to the root and never past
    it; an error that it leaves counts squared in the delay. transverse_m >= 0 and air_m > 0 broadcast.
    """
    across, air = np.broadcast_arrays(np.asarray(transverse_m, float), np.asarray(air_m, float))
    slab, eps = passes * wall.thickness_m, wall.permittivity
    tangent = across / (air + slab / math.sqrt(eps))
    for _ in range(NEWTON_STEPS):
        bent = 1.0 / np.sqrt(eps + (eps - 1.0) * tangent**2)
        tangent = tangent + (across - tangent * (air + slab * bent)) / (air + slab * eps * bent**3)
    cosine = 1.0 / np.sqrt(1.0 + tangent**2)
    sine = tangent * cosine
    inside = np.sqrt(eps - sine**2)
    slab_m = slab * math.sqrt(eps) / inside
    return Rays(
        (sine * across + air * cosine + slab * inside) / SPEED_OF_LIGHT_MPS,
        air / cosine + slab_m,
        slab_m,
        sine,
    )


def reflection(wall: Wall, sine: ArrayLike) -> Array:
    """Fresnel's amplitude coefficient from air, electric field along the wall (upright antennas) [1]."""
    cosine, inside = _cosines(wall, sine)
    return np.asarray((cosine - inside) / (cosine + inside))


def transmission(wall: Wall, rays: Rays, passes: int = 1) -> Array:
    """Amplitude factor of rays through the wall: both faces, 1 - Gamma^2 a pass, and the loss between [1]."""
    faces = (1.0 - reflection(wall, rays.sine) ** 2) ** passes
    return np.asarray(faces * wall.amplitude_loss(rays.slab_m))


def reverberation(wall: Wall, sine: float, frequency_hz: Array) -> Spectrum:
    """What the echoes inside the wall add to one pass, (n_frequencies,): the geometric series

    1 / (1 - q exp(-j 2 pi f T)), q = Gamma^2 times the loss of there and back, T = 2 w sqrt(eps - p^2) / c.
    """
    _, inside = _cosines(wall, sine)
    there_and_back_m = 2.0 * wall.thickness_m * math.sqrt(wall.permittivity) / float(inside)
    ratio = float(reflection(wall, sine)) ** 2 * float(wall.amplitude_loss(there_and_back_m))
    period_s = 2.0 * wall.thickness_m * float(inside) / SPEED_OF_LIGHT_MPS
    return np.asarray(1.0 / (1.0 - ratio * np.exp(-2j * np.pi * frequency_hz * period_s)))


def wall_response(wall: Wall, transverse_m: float, air_m: float, wavelength_m: float) -> tuple[Paths, Array]:
    """The wall itself, seen over `air_m` there and back by antennas `transverse_m` apart.

    The front face, Gamma, and what comes back out of it after 2 m passes, (1 - Gamma^2) (-Gamma)^(2 m - 1).
    Antenna gains of 0 dB. Returns (paths, sine (n,) of each one's angle in air).
    """
    found, gains = [], []
    for echo in range(INNER_ECHOES + 1):
        ray = refracted(wall, transverse_m, air_m, 2 * echo)
        face = float(reflection(wall, ray.sine))
        factor = face if echo == 0 else (1.0 - face**2) * (-face) ** (2 * echo - 1)
        gains.append(factor * float(wall.amplitude_loss(ray.slab_m) * friis_gain(ray.length_m, wavelength_m)))
        found.append((float(ray.delay_s), float(ray.sine)))
    delay_s, sine = np.array(found).T
    return Paths(delay_s, np.array(gains)), sine


def _cosines(wall: Wall, sine: ArrayLike) -> tuple[Array, Array]:
    """cos(theta) in air and sqrt(eps) cos(theta) inside."""
    square = np.asarray(sine, dtype=np.float64) ** 2
    return np.sqrt(1.0 - square), np.sqrt(wall.permittivity - square)
