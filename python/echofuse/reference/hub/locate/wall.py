"""Delay of a wave through a wall: the trace corrections of the through-wall paper, section 2."""

from math import sqrt
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

MIN_AIR_M = 0.01  # [m] of air on a ray, at least: a place within the wall is taken as just behind it


class WallConfig(Protocol):
    thickness_m: float
    relative_permittivity: float
    compensation: str  # none | first_kind | second_kind


class Ray(NamedTuple):
    optical_m: float  # straight line and excess [m]
    excess_m: float  # speed of light times the time, less the straight line [m]
    direction: NDArray[np.float64]  # (2,) gradient of optical_m by (lateral, depth); a unit vector


def sine_in_air(thickness_m: float, relative_permittivity: float, lateral_m: float, air_m: float) -> float:
    """Sine of the angle in air of the ray that obeys Snell's law, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(60):  # as far as float64 tells sines apart
        p = 0.5 * (low + high)
        reached = air_m * p / sqrt(1 - p**2) + thickness_m * p / sqrt(relative_permittivity - p**2)
        low, high = (p, high) if reached < lateral_m else (low, p)
    return low


def normal_excess_m(config: WallConfig) -> float:
    """Excess of one way at normal incidence [m]; 0 without compensation."""
    if config.compensation == "none":
        return 0.0
    return float(config.thickness_m * (np.sqrt(config.relative_permittivity) - 1.0))


def ray(config: WallConfig, lateral_m: float, depth_m: float) -> Ray:
    """Return the ray over ``lateral_m`` >= 0 along the wall and ``depth_m`` > 0 across it.

    The stand-off of the wall makes no difference.
    """
    straight = float(np.hypot(lateral_m, depth_m))
    direction = np.array([lateral_m, depth_m]) / straight
    w, permittivity = config.thickness_m, config.relative_permittivity
    if config.compensation != "second_kind" or w == 0.0:
        excess = normal_excess_m(config)
        return Ray(straight + excess, excess, direction)
    air = max(depth_m - w, MIN_AIR_M)
    p = sine_in_air(w, permittivity, lateral_m, air)
    optical = air / np.sqrt(1 - p**2) + w * permittivity / np.sqrt(permittivity - p**2)
    excess = float(optical - np.hypot(lateral_m, air + w))
    return Ray(straight + excess, excess, np.array([p, np.sqrt(1 - p**2)]))
