"""Where echoes ought to be, and where a response has them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.simulation.people import Person
from echofuse.simulation.through_wall import ThroughWallSimulation
from echofuse.simulation.through_wall_scene import ThroughWallScene
from echofuse.simulation.wall import Wall

Array = NDArray[np.float64]


def clean_responses(scene: ThroughWallScene, people: Sequence[Person], time_s: Array, seed: int = 1) -> Array:
    """(n, n_receivers, n_samples) [count] without noise, sample 0 at time zero."""
    simulation = ThroughWallSimulation(scene, people, seed=seed)
    return np.array([[simulation.frontend.receive(c) for c in simulation.channels(float(t))] for t in time_s])


def peak_s(response: Array, clock_hz: float) -> float:
    """Where the trigonometric polynomial through the samples has its largest magnitude."""
    n, spectrum = len(response), np.fft.rfft(response)
    spectrum[1:] *= 2.0
    centre, step = float(np.argmax(np.abs(response))), 1e-2
    for _ in range(4):
        grid = centre + step * np.arange(-100, 101)
        between = np.abs((np.exp(2j * np.pi * np.outer(grid, np.arange(len(spectrum))) / n) @ spectrum).real)
        centre, step = float(grid[np.argmax(between)]), step / 50.0
    return centre / clock_hz


def bent_delay_s(wall: Wall, antenna_m: Array, target_m: Array) -> float:
    """Snell's law by bisection on the sine in air."""
    across = math.hypot(target_m[0] - antenna_m[0], target_m[2] - antenna_m[2])
    air, w, eps = target_m[1] - antenna_m[1] - wall.thickness_m, wall.thickness_m, wall.permittivity
    low, high = 0.0, 1.0 - 1e-12
    for _ in range(100):
        p = 0.5 * (low + high)
        short = air * p / math.sqrt(1.0 - p * p) + w * p / math.sqrt(eps - p * p) < across
        low, high = (p, high) if short else (low, p)
    return (air / math.sqrt(1.0 - low**2) + w * eps / math.sqrt(eps - low**2)) / SPEED_OF_LIGHT_MPS
