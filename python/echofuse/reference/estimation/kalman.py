"""Kalman filter of a point in the plane or in space that keeps its velocity but for white acceleration.

Bar-Shalom, Li & Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, sections 5.2 and
6.2.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class ConstantVelocityFilter:
    """State (2 d,) x [m], vx [m/s], y, vy, and in space z, vz, and its covariance (2 d, 2 d); d is 2 or 3."""

    def __init__(self, state: Array, covariance: Array) -> None:
        self.state = state
        self.covariance = covariance
        self.dimension = len(state) // 2
        self.shown = np.kron(np.eye(self.dimension), [[1.0, 0.0]])  # (d, 2 d): of the state, the position

    @classmethod
    def at(
        cls, position: Array, position_covariance: Array, velocity: Array, velocity_std_mps: float
    ) -> ConstantVelocityFilter:
        """Begin at a position (d,) [m], moving by a velocity (d,) [m/s] known to so much per coordinate."""
        covariance: Array = np.diag([0.0, velocity_std_mps**2] * len(position))
        covariance[::2, ::2] = position_covariance
        return cls(np.column_stack([position, velocity]).ravel(), covariance)

    @property
    def position(self) -> Array:
        """Position (d,) [m]."""
        return self.state[::2]

    @property
    def velocity(self) -> Array:
        """Velocity (d,) [m/s]."""
        return self.state[1::2]

    @property
    def position_covariance(self) -> Array:
        """Covariance of the position (d, d) [m^2]."""
        return self.covariance[::2, ::2]

    def predict(self, dt_s: float, acceleration_density_m2ps3: float, velocity_decay: float = 1.0) -> None:
        """Move by ``dt_s``; the velocity is first multiplied by ``velocity_decay`` (1: kept)."""
        axis = np.array([[1.0, dt_s * velocity_decay], [0.0, velocity_decay]])
        noise = acceleration_density_m2ps3 * np.array([[dt_s**3 / 3.0, dt_s**2 / 2.0], [dt_s**2 / 2.0, dt_s]])
        axes = np.eye(self.dimension)
        transition = np.kron(axes, axis)
        self.state = transition @ self.state
        self.covariance = transition @ self.covariance @ transition.T + np.kron(axes, noise)

    def innovation_covariance(self, measurement_covariance: Array) -> Array:
        """Return the covariance (d, d) [m^2] of a measured minus the predicted position."""
        return self.position_covariance + measurement_covariance

    def update(self, position: Array, measurement_covariance: Array) -> None:
        """Take in a measured position (d,) [m] with its covariance (d, d) [m^2]; Joseph's form."""
        inverse = np.linalg.inv(self.innovation_covariance(measurement_covariance))
        gain = self.covariance @ self.shown.T @ inverse
        rest = np.eye(len(self.state)) - gain @ self.shown
        self.state = self.state + gain @ (position - self.position)
        self.covariance = rest @ self.covariance @ rest.T + gain @ measurement_covariance @ gain.T

    def update_along(self, direction: Array, innovation_m: float, variance_m2: float) -> None:
        """Take in one number that grows by direction (d,) . change of position; Joseph's form."""
        shown = direction @ self.shown
        gain = self.covariance @ shown / (shown @ self.covariance @ shown + variance_m2)
        rest = np.eye(len(self.state)) - np.outer(gain, shown)
        self.state = self.state + gain * innovation_m
        self.covariance = rest @ self.covariance @ rest.T + variance_m2 * np.outer(gain, gain)

    def hold(self, axis: int, low_m: float, high_m: float) -> None:
        """Keep a coordinate within limits [m]; who reaches one stops there."""
        if not low_m <= self.state[2 * axis] <= high_m:
            self.state[2 * axis] = np.clip(self.state[2 * axis], low_m, high_m)
            self.state[2 * axis + 1] = 0.0
