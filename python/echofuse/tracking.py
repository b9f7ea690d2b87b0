"""The trackers on plain arrays: located points of each frame in, tracks out.

>>> import numpy as np
>>> from echofuse.tracking import PhdTracker
>>> tracker = PhdTracker()
>>> for step in range(5):
...     tracks = tracker.process(np.array([[2.0 + 0.1 * step, 3.0]], np.float32), dt_s=0.1)
>>> print(tracks["state"], np.abs(tracks["x_m"] - 2.4) < 0.3)
[1] [ True]
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse._core import MixtureConfig, PhdConfig, TrackManagerConfig, TrackState

__all__ = ["KalmanTracker", "MixtureConfig", "PhdConfig", "PhdTracker", "TrackManagerConfig", "TrackState"]


class PhdTracker:
    """Particle PHD filter, its peaks by expectation-maximisation, and tracks (sensor-radar paper, V-D, V-E).

    Parameters
    ----------
    config
        Targets, sensor and clutter; ``area_m2``, ``clutter_per_frame`` and ``measurement_std_m`` matter most.
    manager
        Association and life of tracks.
    peaks
        Search for peaks.

    Raises
    ------
    ValueError
        A configuration is impossible; the message names the field.
    """

    def __init__(
        self,
        config: PhdConfig | None = None,
        manager: TrackManagerConfig | None = None,
        peaks: MixtureConfig | None = None,
    ) -> None:
        config, manager, peaks = (
            config or PhdConfig(),
            manager or TrackManagerConfig(),
            peaks or MixtureConfig(),
        )
        for given in (config, manager, peaks):
            _require_valid(given)
        self._tracker = _core.PhdTracker()
        _require_done(self._tracker.configure(config, peaks, manager))

    def process(self, measurements: NDArray[np.float32], dt_s: float) -> NDArray[np.void]:
        """Take in the points of one frame, ``dt_s`` [s] after the last one.

        Parameters
        ----------
        measurements
            Points (m, 2) [m], float32; m may be 0. Of more than 32 points the first 32 are used.

        Returns ------- Structured array of all living tracks, ascending ``id``: ``state`` (a `TrackState`
        value), ``frames_since_update``, ``x_m``, ``y_m``, ``vx_mps``, ``vy_mps`` and the position's
        ``covariance_*_m2``.

        Raises
        ------
        ValueError
            A point is not finite, or ``dt_s`` is not positive; nothing changed.
        """
        status, tracks = self._tracker.process(measurements, dt_s)
        _require_done(status)
        return np.asarray(tracks)

    def reset(self) -> None:
        """Forget everything; the random stream starts anew."""
        self._tracker.reset()

    @property
    def mass(self) -> float:
        """Expected number of targets after the last frame."""
        return self._tracker.mass


class KalmanTracker:
    """The baseline: a Kalman filter a track, global nearest neighbour, the same track states.

    Parameters and errors as of `PhdTracker`; ``manager.update`` is taken as ``kalman``.
    """

    def __init__(self, manager: TrackManagerConfig | None = None) -> None:
        manager = manager or TrackManagerConfig()
        _require_valid(manager)
        self._tracker = _core.KalmanTracker()
        _require_done(self._tracker.configure(manager))

    def process(self, measurements: NDArray[np.float32], dt_s: float) -> NDArray[np.void]:
        """Take in the points (m, 2) [m] of one frame, ``dt_s`` [s] after the last; see `PhdTracker`."""
        status, tracks = self._tracker.process(measurements, dt_s)
        _require_done(status)
        return np.asarray(tracks)

    def reset(self) -> None:
        """Forget everything."""
        self._tracker.reset()


def _require_valid(config: PhdConfig | TrackManagerConfig | MixtureConfig) -> None:
    field = config.invalid_field()
    if field is not None:
        raise ValueError(f"{type(config).__name__}.{field} cannot be {getattr(config, field)!r}")


def _require_done(status: _core.Status) -> None:
    if status not in (_core.Status.ok, _core.Status.truncated):
        raise ValueError(f"the tracker refused: {status.name} (points must be finite and dt_s positive)")
