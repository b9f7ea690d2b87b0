"""Kalman filter of a point in the plane that keeps its velocity but for white acceleration.

Bar-Shalom, Li & Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, sections 5.2 and
6.2.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

POSITION = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]])
"""(2, 4): what a measurement shows of the state (x, vx, y, vy)."""


class ConstantVelocityFilter:
    """State (4,) x [m], vx [m/s], y [m], vy [m/s] and its covariance (4, 4)."""

    def __init__(self, state: NDArray[np.float64], covariance: NDArray[np.float64]) -> None:
        self.state = state
        self.covariance = covariance

    def predict(self, dt_s: float, acceleration_density_m2ps3: float, velocity_decay: float = 1.0) -> None:
        """Move by ``dt_s``; the velocity is first multiplied by ``velocity_decay`` (1: kept)."""
        axis = np.array([[1.0, dt_s * velocity_decay], [0.0, velocity_decay]])
        noise = acceleration_density_m2ps3 * np.array([[dt_s**3 / 3.0, dt_s**2 / 2.0], [dt_s**2 / 2.0, dt_s]])
        transition = np.kron(np.eye(2), axis)
        self.state = transition @ self.state
        self.covariance = transition @ self.covariance @ transition.T + np.kron(np.eye(2), noise)

    def innovation_covariance(self, measurement_covariance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the covariance (2, 2) [m^2] of a measured minus the predicted position."""
        return np.asarray(POSITION @ self.covariance @ POSITION.T + measurement_covariance)

    def update(self, position: NDArray[np.float64], measurement_covariance: NDArray[np.float64]) -> None:
        """Take in a measured position (2,) [m] with its covariance (2, 2) [m^2]; Joseph's form."""
        innovation = position - POSITION @ self.state
        gain = (
            self.covariance @ POSITION.T @ np.linalg.inv(self.innovation_covariance(measurement_covariance))
        )
        rest = np.eye(4) - gain @ POSITION
        self.state = self.state + gain @ innovation
        self.covariance = rest @ self.covariance @ rest.T + gain @ measurement_covariance @ gain.T

    def update_along(self, direction: NDArray[np.float64], innovation_m: float, variance_m2: float) -> None:
        """Take in one number that grows by direction (2,) . change of position; Joseph's form."""
        shown = direction @ POSITION
        gain = self.covariance @ shown / (shown @ self.covariance @ shown + variance_m2)
        rest = np.eye(4) - np.outer(gain, shown)
        self.state = self.state + gain * innovation_m
        self.covariance = rest @ self.covariance @ rest.T + variance_m2 * np.outer(gain, gain)
