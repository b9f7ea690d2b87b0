"""Where a person goes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

HEADING_WINDOW_S = 0.2  # a walker turns and brakes within twice this


@dataclass(frozen=True, kw_only=True)
class Walk:
    """Straight legs between waypoints at one speed, with stops; past the last one the person turns back.

    Waypoints are (x, y), or (x, y, z) where the ground rises: then the speed is that along the slope.
    """

    waypoints_m: tuple[tuple[float, ...], ...]
    speed_mps: float
    stops_s: tuple[tuple[float, float], ...] = ()  # (start, duration), ascending, not overlapping

    def __post_init__(self) -> None:
        if {len(point) for point in self.waypoints_m} not in ({2}, {3}):
            raise ValueError("Walk.waypoints_m: all of (x, y), or all of (x, y, z)")
        if len(self.waypoints_m) < 2 or not self.length_m > 0.0:
            raise ValueError("Walk.waypoints_m: at least two different points")
        if not self.speed_mps > 0.0:
            raise ValueError("Walk.speed_mps: must be positive; a standing person has a stop")
        free_from_s = 0.0
        for start_s, duration_s in self.stops_s:
            if start_s < free_from_s or duration_s < 0.0:
                raise ValueError("Walk.stops_s: must ascend from 0 and not overlap")
            free_from_s = start_s + duration_s

    @property
    def length_m(self) -> float:
        """Of one way."""
        return sum(math.dist(a, b) for a, b in zip(self.waypoints_m, self.waypoints_m[1:], strict=False))

    def distance_m(self, time_s: ArrayLike) -> NDArray[np.float64]:
        """Distance walked since time 0; time_s any shape."""
        moving_s = np.asarray(time_s, dtype=np.float64).copy()
        for start_s, duration_s in self.stops_s:
            moving_s -= np.clip(np.asarray(time_s) - start_s, 0.0, duration_s)
        return self.speed_mps * moving_s

    @property
    def rises(self) -> bool:
        """Whether the ground has a height."""
        return len(self.waypoints_m[0]) == 3

    def position_m(self, time_s: ArrayLike) -> NDArray[np.float64]:
        """Where on the plan: time_s (...,) -> (..., 2)."""
        return self._along(time_s, (0, 1))

    def ground_m(self, time_s: ArrayLike) -> NDArray[np.float64]:
        """Height of the ground there, 0 where waypoints have none: time_s (...,) -> (...,)."""
        return self._along(time_s, (2,))[..., 0] if self.rises else np.zeros(np.shape(time_s))

    def _along(self, time_s: ArrayLike, axes: tuple[int, ...]) -> NDArray[np.float64]:
        points = np.asarray(self.waypoints_m, dtype=np.float64)
        mark = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        there_and_back = np.mod(self.distance_m(time_s), 2.0 * mark[-1])
        along = np.minimum(there_and_back, 2.0 * mark[-1] - there_and_back)
        return np.stack([np.interp(along, mark, points[:, axis]) for axis in axes], axis=-1)

    def velocity_mps(self, time_s: float) -> NDArray[np.float64]:
        """Mean velocity (2,) over the time that a body needs to turn or to brake."""
        window = np.array([time_s - HEADING_WINDOW_S, time_s + HEADING_WINDOW_S])
        before, after = self.position_m(np.maximum(window, 0.0))
        return np.asarray((after - before) / (2.0 * HEADING_WINDOW_S - max(0.0, -window[0])))

    def heading_rad(self, time_s: float) -> float:
        """Direction of travel; while standing, that of the last step."""
        for start_s, duration_s in self.stops_s:
            if start_s <= time_s < start_s + duration_s:
                time_s = max(start_s - HEADING_WINDOW_S, 0.0) if start_s > 0.0 else start_s + duration_s
        ahead_m = self.velocity_mps(time_s)
        if float(np.hypot(*ahead_m)) < 1e-9:  # exactly at a turning point
            ahead_m = self.velocity_mps(time_s + HEADING_WINDOW_S / 2.0)
        return math.atan2(ahead_m[1], ahead_m[0])
