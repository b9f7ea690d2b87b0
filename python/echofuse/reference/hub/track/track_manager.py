"""Tracks from the points of each frame: association and the states unconfirmed, confirmed, silent, dead.

After section V-E of the sensor-radar paper. Deviations, each with the paper's form as a choice or a limit
case: a pair is judged by its own distance (the paper first accepts all pairs together when their sum is
small, which lets one track jump across the room), a silent track loses its velocity, and its gate grows while
it is silent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.estimation.assignment import NONE, assign, assignment_margin
from echofuse.reference.estimation.kalman import ConstantVelocityFilter

UNCONFIRMED, CONFIRMED, SILENT = range(3)
"""Values of ``Track.state``."""


class TrackManagerConfig(Protocol):
    """Association, life and motion of tracks."""

    association: str  # per_pair | hypothesis_cost
    update: str  # estimate: the point's own state replaces the track's | kalman: the track filters the point
    gate_m: float  # [m] furthest point from a track's prediction
    cost_max_m: float  # [m] hypothesis_cost: mean distance up to which all pairs hold
    gate_sigma: float  # [1] kalman: furthest point in standard deviations of the innovation; 0: no such test
    silent_gate_growth_mps: float  # [m/s] gate_m grows by this while silent
    silent_gate_max_m: float  # [m] up to this
    birth_exclusion_m: float  # [m] no track begins nearer to another one
    confirm_updates: int  # consecutive frames with a point, the first included
    silent_time_min_s: float  # [s] every confirmed track may be silent so long,
    silent_time_per_confirmed: float  # [1] or this share of the time for which it was confirmed,
    silent_time_max_s: float  # [s] but no longer than this
    silent_velocity_time_s: float  # [s] a silent track's velocity fades with this time constant
    acceleration_density_m2ps3: float  # [m^2/s^3]
    measurement_std_m: float  # [m] kalman: of a point, per coordinate
    velocity_std_mps: float  # [m/s] of a velocity that was not seen yet, per coordinate


class TrackEstimate(NamedTuple):
    """A point of this frame, in d = 2 or 3 dimensions; its velocity is 0 when it is a bare measurement."""

    position: NDArray[np.float64]  # (d,) [m]
    velocity: NDArray[np.float64]  # (d,) [m/s]
    covariance: NDArray[np.float64]  # (d, d) [m^2] of the position


@dataclass
class Track:
    """One track."""

    id: int
    state: int
    filter: ConstantVelocityFilter
    updates: int = 1  # consecutive frames with a point, until confirmed
    frames_since_update: int = 0
    confirmed_time_s: float = 0.0
    silent_time_s: float = 0.0
    motion: float = 1.0  # what is left of the motion of a silent track


class Step(NamedTuple):
    """Tracks after a frame, and how near its decisions were to others."""

    tracks: list[Track]  # ascending id
    point_of_track: NDArray[np.intp]  # (n_tracks before,) or -1
    margin: float


class TrackManager:
    """Keeps at most ``max_tracks`` tracks."""

    def __init__(self, config: TrackManagerConfig, max_tracks: int) -> None:
        self.config = config
        self.max_tracks = max_tracks
        self.tracks: list[Track] = []
        self.next_id = 1
        self.dropped_births = 0

    def process(self, points: list[TrackEstimate], dt_s: float) -> Step:
        """Move the tracks by ``dt_s``, give them their ``points``, end what is dead, begin what is new."""
        for track in self.tracks:
            self._predict(track, dt_s)
        point_of_track, margin = self._associate(points)
        margin = min(margin, *(self._silence_margin(track, dt_s) for track in self.tracks), np.inf)
        survivors = []
        for track, point in zip(self.tracks, point_of_track, strict=True):
            alive = self._miss(track, dt_s) if point == NONE else self._hit(track, points[point], dt_s)
            if alive:
                survivors.append(track)
        self.tracks = survivors
        taken = set(point_of_track.tolist())
        for index, point in enumerate(points):
            if index not in taken:
                margin = min(margin, self._begin(point))
        return Step(self.tracks, point_of_track, margin)

    def _predict(self, track: Track, dt_s: float) -> None:
        decay = 1.0
        if track.state == SILENT:
            decay = self.config.silent_velocity_time_s / (self.config.silent_velocity_time_s + dt_s)
        track.motion *= decay
        track.filter.predict(dt_s, self.config.acceleration_density_m2ps3 * track.motion, decay)

    def _gate(self, track: Track) -> float:
        grown = self.config.gate_m + self.config.silent_gate_growth_mps * track.silent_time_s
        return max(self.config.gate_m, min(grown, self.config.silent_gate_max_m))

    def _associate(self, points: list[TrackEstimate]) -> tuple[NDArray[np.intp], float]:
        if not self.tracks or not points:
            return np.full(len(self.tracks), NONE, np.intp), np.inf
        gate = np.array([self._gate(track) for track in self.tracks])
        distance = np.array([[self._distance(track, p) for p in points] for track in self.tracks])
        allowed = np.array([[self._within_sigma(track, p) for p in points] for track in self.tracks])
        if self.config.association == "per_pair":
            cost = np.where(allowed, np.minimum(distance, gate[:, None]), gate[:, None])
            columns = assign(cost)
            margin = assignment_margin(cost, columns, gate)
            accept_all = False
        else:
            columns = assign(distance)
            margin = assignment_margin(distance, columns, np.full(len(gate), 1e3)) * 1e3
            rows = np.flatnonzero(columns != NONE)
            excess = distance[rows, columns[rows]].mean() - self.config.cost_max_m
            margin = min(margin, abs(excess))
            accept_all = bool(excess <= 0.0)
        for row in np.flatnonzero(columns != NONE):
            if not accept_all:
                margin = min(margin, abs(distance[row, columns[row]] / gate[row] - 1.0))
                if distance[row, columns[row]] >= gate[row] or not allowed[row, columns[row]]:
                    columns[row] = NONE
        return columns, float(margin)

    def _distance(self, track: Track, point: TrackEstimate) -> float:
        return float(np.linalg.norm(point.position - track.filter.position))

    def _within_sigma(self, track: Track, point: TrackEstimate) -> bool:
        if self.config.gate_sigma == 0.0 or self.config.update == "estimate":
            return True
        innovation = point.position - track.filter.position
        covariance = track.filter.innovation_covariance(self._measurement_covariance(point))
        return bool(innovation @ np.linalg.solve(covariance, innovation) < self.config.gate_sigma**2)

    def _silence_margin(self, track: Track, dt_s: float) -> float:
        return abs(track.silent_time_s + 0.5 * dt_s - self._silence_limit(track)) / dt_s

    def _silence_limit(self, track: Track) -> float:
        earned = self.config.silent_time_per_confirmed * track.confirmed_time_s
        return min(max(earned, self.config.silent_time_min_s), self.config.silent_time_max_s)

    def _miss(self, track: Track, dt_s: float) -> bool:
        """Count a frame without a point; False when the track dies of it.

        Times are multiples of the frame's duration, so they are compared half a frame apart.
        """
        if track.state == UNCONFIRMED:
            return False
        track.state = SILENT
        track.frames_since_update += 1
        track.silent_time_s += dt_s
        return track.silent_time_s <= self._silence_limit(track) + 0.5 * dt_s

    def _hit(self, track: Track, point: TrackEstimate, dt_s: float) -> bool:
        if self.config.update == "kalman":
            track.filter.update(point.position, self._measurement_covariance(point))
        else:
            track.filter = self._filter_of(point)
        track.updates += 1
        track.frames_since_update = 0
        track.silent_time_s = 0.0
        track.motion = 1.0
        if track.state != UNCONFIRMED:
            track.confirmed_time_s += dt_s
        if track.state == SILENT or track.updates >= self.config.confirm_updates:
            track.state = CONFIRMED
        return True

    def _filter_of(self, point: TrackEstimate) -> ConstantVelocityFilter:
        std_mps = self.config.velocity_std_mps
        return ConstantVelocityFilter.at(point.position, point.covariance, point.velocity, std_mps)

    def _measurement_covariance(self, point: TrackEstimate) -> NDArray[np.float64]:
        """Of a bare point."""
        return np.asarray(self.config.measurement_std_m**2 * np.eye(len(point.position)))

    def _begin(self, point: TrackEstimate) -> float:
        """Begin a track unless it is too near to another; return the margin of that decision."""
        nearest = min((self._distance(track, point) for track in self.tracks), default=np.inf)
        exclusion = self.config.birth_exclusion_m
        margin = abs(nearest / exclusion - 1.0) if exclusion > 0.0 else np.inf
        if nearest < exclusion:
            return margin
        if len(self.tracks) >= self.max_tracks:
            self.dropped_births += 1
            return margin
        state = CONFIRMED if self.config.confirm_updates <= 1 else UNCONFIRMED
        self.tracks.append(Track(self.next_id, state, self._filter_of(point)))
        self.next_id += 1
        return margin
