"""Two constant-velocity filters, of somebody who walks straight and of one who turns, as one.

The interacting multiple model estimator of Blom & Bar-Shalom (IEEE Transactions on Automatic Control 33,
1988; Bar-Shalom, Li & Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001,
section 11.6.6).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.estimation.kalman import ConstantVelocityFilter

Array = NDArray[np.float64]


class TurningFilter:
    """State and covariance as ConstantVelocityFilter's: the mixture of both models."""

    def __init__(self, filter: ConstantVelocityFilter) -> None:
        """Begin both models with the same; the one is as probable as the other."""
        self.models = [
            ConstantVelocityFilter(filter.state.copy(), filter.covariance.copy()) for _ in range(2)
        ]
        self.probability = np.array([0.5, 0.5])  # (2,) straight, turning
        self.state, self.covariance = filter.state.copy(), filter.covariance.copy()

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

    def predict(
        self,
        dt_s: float,
        densities_m2ps3: tuple[float, float],
        begin_probability: float,
        end_probability: float,
        velocity_decay: float = 1.0,
    ) -> None:
        """Mix the models, then move each by ``dt_s`` with its density of acceleration (straight, turning).

        begin_probability, end_probability: that the one turns, the other goes straight again, in this step.
        """
        change = np.array(
            [[1.0 - begin_probability, begin_probability], [end_probability, 1.0 - end_probability]]
        )
        joint = change * self.probability[:, np.newaxis]  # from, to
        probability = joint.sum(axis=0)
        mixed = [_mixture(self.models, joint[:, to] / probability[to]) for to in range(2)]
        for model, (state, covariance), density in zip(self.models, mixed, densities_m2ps3, strict=True):
            model.state, model.covariance = state, covariance
            model.predict(dt_s, density, velocity_decay)
        self.probability = probability
        self._combine()

    def update_along(self, direction: Array, innovation_m: float, variance_m2: float) -> None:
        """Take in one number, as ConstantVelocityFilter does; innovation_m is that of the mixture."""
        log_likelihood = np.zeros(2)
        position = self.position.copy()
        for which, model in enumerate(self.models):
            own_m = innovation_m - float(direction @ (model.position - position))
            variance = float(direction @ model.position_covariance @ direction) + variance_m2
            log_likelihood[which] = -0.5 * (np.log(variance) + own_m**2 / variance)
            model.update_along(direction, own_m, variance_m2)
        weight = self.probability * np.exp(log_likelihood - np.max(log_likelihood))
        self.probability = weight / np.sum(weight)
        self._combine()

    def hold(self, axis: int, low_m: float, high_m: float) -> None:
        """Keep a coordinate within limits [m]; who reaches one stops there."""
        for model in self.models:
            model.hold(axis, low_m, high_m)
        self._combine()

    def _combine(self) -> None:
        self.state, self.covariance = _mixture(self.models, self.probability)


def _mixture(models: list[ConstantVelocityFilter], weight: Array) -> tuple[Array, Array]:
    """Mean and covariance of Gaussian distributions with weights (n,) that add up to 1."""
    state: Array = np.sum([w * model.state for w, model in zip(weight, models, strict=True)], axis=0)
    spread = [
        w * (model.covariance + np.outer(model.state - state, model.state - state))
        for w, model in zip(weight, models, strict=True)
    ]
    return state, np.asarray(np.sum(spread, axis=0))
