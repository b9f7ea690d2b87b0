"""Particle PHD filter with measurement-driven birth.

Mahler, IEEE Trans. Aerospace and Electronic Systems 39(4), 2003; persistent and newborn targets apart as in
Ristic, Clark, Vo & Vo, IEEE Trans. Aerospace and Electronic Systems 48(2), 2012.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.core.random import Pcg32
from echofuse.reference.estimation.gaussian import gaussian_kernel
from echofuse.reference.estimation.mixture_em import VX, VY, WEIGHT, X, Y
from echofuse.reference.estimation.resampling import Resampling, systematic_resample


class PhdConfig(Protocol):
    """Model of targets, sensor and clutter."""

    detection_probability: float
    survival_probability: float  # per frame
    clutter_per_frame: float  # expected clutter points, uniform over the area
    birth_per_frame: float  # expected new targets, uniform over the area
    area_m2: float
    measurement_std_m: float  # per coordinate
    acceleration_density_m2ps3: float  # [m^2/s^3] velocity variance gained per second
    newborn_velocity_std_mps: float  # per coordinate
    particles_per_target: int
    newborn_per_measurement: int
    mass_average_frames: int
    resampling: str  # square_root | proportional
    seed: int


class PhdLimits(Protocol):
    """Capacities of the filter that is compared with."""

    max_particles: int
    max_newborn_particles: int
    max_targets: int


class PhdUpdate(NamedTuple):
    """What an update found."""

    particles: NDArray[np.float64]  # (n + n_newborn, 5) newborn last
    n_persistent: int
    measurement_mass: NDArray[np.float64]  # (m,) persistent mass that each measurement explains
    mass: float  # of the persistent particles: expected number of targets
    number: int  # the mass, averaged over frames and rounded
    number_margin: float  # distance of the averaged mass from the next half


class PhdFilter:
    """Particles (n, 5): x, vx, y, vy, weight; the sum of weights is the expected number of targets.

    Random numbers are drawn in this order: ``predict``, a normal for x and one for y of each particle;
    ``update``, four normals (x, y, vx, vy) for each newborn particle, measurement by measurement, then 32
    bits that seed the search for peaks (`peak_seed`); ``resample``, one uniform number.
    """

    def __init__(self, config: PhdConfig, limits: PhdLimits) -> None:
        self.config = config
        self.limits = limits
        self.reset()

    def reset(self) -> None:
        """Forget everything; the random stream starts anew."""
        self.random = Pcg32(self.config.seed)
        self.particles = np.zeros((0, 5))
        self.masses: list[float] = []
        self.number = 0
        self.peak_seed = 0

    def predict(self, dt_s: float) -> NDArray[np.float64]:
        """Move every particle by ``dt_s``; two normals each (x, y), velocity changed in mid-step."""
        n = len(self.particles)
        kicks = self.random.normals(2 * n).reshape(n, 2) * np.sqrt(
            self.config.acceleration_density_m2ps3 * dt_s
        )
        moved = self.particles.copy()
        moved[:, X] += dt_s * (self.particles[:, VX] + 0.5 * kicks[:, 0])
        moved[:, Y] += dt_s * (self.particles[:, VY] + 0.5 * kicks[:, 1])
        moved[:, VX] += kicks[:, 0]
        moved[:, VY] += kicks[:, 1]
        moved[:, WEIGHT] *= self.config.survival_probability
        self.particles = moved
        return moved

    def update(self, measurements: NDArray[np.float64]) -> PhdUpdate:
        """Weigh with ``measurements`` (m, 2) [m] and add the newborn particles of each."""
        config = self.config
        persistent = self.particles
        n, weight = len(persistent), persistent[:, WEIGHT]
        updated = (1.0 - config.detection_probability) * weight
        explained = np.zeros(len(measurements))
        newborn = []
        for index, z in enumerate(measurements):
            squared = ((persistent[:, [X, Y]] - z) ** 2).sum(axis=1) / config.measurement_std_m**2
            likelihood = gaussian_kernel(squared) / (2.0 * np.pi * config.measurement_std_m**2)
            parts = config.detection_probability * likelihood * weight
            birth = config.birth_per_frame / config.area_m2
            total = config.clutter_per_frame / config.area_m2 + birth + parts.sum()
            if total > 0.0:
                updated = updated + parts / total
                explained[index] = parts.sum() / total
            newborn.append(self._born_at(z, birth / total if total > 0.0 else 0.0, len(measurements)))
        self.particles = np.concatenate([np.column_stack([persistent[:, :4], updated]), *newborn])
        mass = float(updated.sum())
        self.peak_seed = self.random.next_u32()
        self.masses = [*self.masses, mass][-config.mass_average_frames :]
        average = float(np.mean(self.masses))
        self.number = min(int(np.floor(average + 0.5)), self.limits.max_targets)
        margin = abs(average + 0.5 - np.round(average + 0.5))
        return PhdUpdate(self.particles, n, explained, mass, self.number, margin)

    def resample(self) -> Resampling:
        """Draw the particles of the next frame, as many as the number of targets asks for; the mass stays.

        square_root: drawn in proportion to the root of the weights and weighted by the root, so that the few
        light particles of a missed or a new target live on; proportional: all of one weight afterwards.
        """
        wanted = self.config.particles_per_target * max(1, self.number)
        n_out = min(wanted, self.limits.max_particles)
        weights = self.particles[:, WEIGHT]
        chances = np.sqrt(weights) if self.config.resampling == "square_root" else weights
        drawn = systematic_resample(chances, self.random.uniform(), n_out)
        self.particles = self.particles[drawn.indices]
        if len(self.particles) > 0:
            ratios = (weights / np.maximum(chances, 1e-300))[drawn.indices]
            self.particles[:, WEIGHT] = ratios * (weights.sum() / ratios.sum())
        return drawn

    def _born_at(self, z: NDArray[np.float64], mass: float, n_measurements: int) -> NDArray[np.float64]:
        """Newborn particles around ``z`` (2,); four normals each: x, y, vx, vy."""
        count = min(self.config.newborn_per_measurement, self.limits.max_newborn_particles // n_measurements)
        draws = self.random.normals(4 * count).reshape(count, 4)
        born = np.zeros((count, 5))
        born[:, [X, Y]] = z + self.config.measurement_std_m * draws[:, :2]
        born[:, [VX, VY]] = self.config.newborn_velocity_std_mps * draws[:, 2:]
        born[:, WEIGHT] = mass / count
        return born
