"""The baseline: a constant-velocity Kalman filter a track and global nearest neighbour."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.hub.track.track_manager import Step, TrackEstimate, TrackManager, TrackManagerConfig


class KalmanTracker:
    """A track manager, configured with ``update = "kalman"``, that is fed with bare measurements."""

    def __init__(self, config: TrackManagerConfig, max_tracks: int) -> None:
        if config.update != "kalman":
            raise ValueError('config.update must be "kalman"')
        self.manager = TrackManager(config, max_tracks)

    def process(self, measurements: NDArray[np.float64], dt_s: float) -> Step:
        """Take in the points (m, 2) or (m, 3) [m] of one frame, ``dt_s`` after the last one."""
        covariance = self.manager.config.measurement_std_m**2 * np.eye(measurements.shape[1])
        points = [TrackEstimate(z, np.zeros_like(z), covariance) for z in measurements]
        return self.manager.process(points, dt_s)
