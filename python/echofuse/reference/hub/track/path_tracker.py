"""Tracks from the paths of traces before a line of antennas: an extended Kalman filter a person.

A handheld's cross-range comes from small differences of paths, and one in ten of them is wrong by
decimetres. So tracks take part in the pairing: each looks among all combinations of traces for the one that
its prediction explains (the through-wall paper, section 4, names what goes wrong without: targets at equal
ranges lose their traces).

The transmitter is the origin, x runs along the antennas, y > 0 is the depth.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.estimation.kalman import ConstantVelocityFilter
from echofuse.reference.hub.locate.line_locator import path_and_gradient
from echofuse.reference.hub.locate.wall import WallConfig
from echofuse.reference.hub.track.track_manager import CONFIRMED, SILENT, UNCONFIRMED

Array = NDArray[np.float64]

NONE = -1
MIN_DEPTH_M = 0.02
POSITION = slice(None, None, 2)  # of the state (x, vx, y, vy)
VELOCITY = slice(1, None, 2)


class PathTrackerConfig(Protocol):
    acceleration_density_m2ps3: float
    velocity_std_mps: float
    path_std_m: float
    common_path_std_m: float
    gate: float
    missing_cost: float
    lone_gate: float
    lone_limit: int
    cut_off: float
    confirm_updates: int
    confirm_window: int
    silent_time_s: float
    silent_velocity_time_s: float
    birth_exclusion_m: float
    merge_distance_m: float
    merge_speed_mps: float
    max_tracks: int


@dataclass
class PathTrack:
    id: int
    filter: ConstantVelocityFilter
    confirmed: bool
    updates: list[bool] = field(
        default_factory=lambda: [True]
    )  # of the last responses, the first one's birth
    misses: int = 0  # responses since its last trace
    lone: int = 0  # responses in a row with one trace
    silent_time_s: float = 0.0

    @property
    def state(self) -> int:
        """As link::TrackState."""
        if not self.confirmed:
            return UNCONFIRMED
        return SILENT if self.misses else CONFIRMED

    def predicted(self, wall: WallConfig, rx_x_m: Array) -> tuple[Array, Array]:
        """Paths (n,) and their gradients (n, 2) where the track is."""
        x, y = self.filter.state[POSITION]
        return path_and_gradient(wall, np.array([x, max(y, MIN_DEPTH_M)]), rx_x_m)


class _Choice(NamedTuple):
    distance: float
    traces: tuple[int, ...]  # one a receiver, NONE where it has none


def helmert(n: int) -> Array:
    """(n, n) orthonormal: the mean's row first, then the contrasts."""
    rows = [np.full(n, 1.0 / np.sqrt(n))]
    for k in range(1, n):
        row = np.zeros(n)
        row[:k], row[k] = 1.0, -float(k)
        rows.append(row / np.sqrt(k * (k + 1.0)))
    return np.array(rows)


class PathTracker:
    """State: the tracks. margin: least relative distance of a decision of the last response from flipping."""

    def __init__(self, config: PathTrackerConfig, wall: WallConfig, rx_x_m: Array, area_m: Array) -> None:
        """rx_x_m (n,): receivers; area_m (4,): least x and y, most x and y of a person's middle [m]."""
        self.config, self.wall, self.rx_x_m, self.area_m = config, wall, rx_x_m, area_m
        self.tracks: list[PathTrack] = []
        self.next_id = 1
        self.dropped_births = 0
        self.margin = 1.0

    def update(self, paths_m: list[Array], dt_s: float) -> list[NDArray[np.int64]]:
        """Move on by dt_s, and let tracks take of each receiver's paths (n_traces,) [m].

        Returns of each path the id of the track that took it, 0 if none did.
        """
        self.margin = 1.0
        self._predict(dt_s)
        owners = [np.zeros(len(paths), np.int64) for paths in paths_m]
        taken: dict[int, tuple[int, ...]] = {}
        for confirmed in (True, False):
            candidates = [t for t in self.tracks if t.confirmed == confirmed]
            taken |= self._share_out(candidates, paths_m, owners)
        for track in self.tracks:
            if track.id in taken:
                self._take(track, paths_m, taken[track.id])
                updated, track.lone = True, 0
            else:
                updated = self._take_lone(track, paths_m, owners)
            track.updates = [*track.updates, updated][-self.config.confirm_window :]
            track.misses = 0 if updated else track.misses + 1
            track.silent_time_s = 0.0 if updated else track.silent_time_s + dt_s
        self._live(dt_s)
        return owners

    def begin(self, position_m: Array, covariance_m2: Array) -> bool:
        """Begin a track at a fix (2,) that no track explains; False when there was no room for it."""
        c = self.config
        for track in self.tracks:
            distance = float(np.linalg.norm(track.filter.state[POSITION] - position_m))
            self._decide(distance, c.birth_exclusion_m)
            if distance < c.birth_exclusion_m:
                return True
        if len(self.tracks) >= c.max_tracks:
            self.dropped_births += 1
            return False
        covariance: Array = np.kron(np.eye(2), np.diag([0.0, c.velocity_std_mps**2])).astype(np.float64)
        covariance[POSITION, POSITION] = covariance_m2 + c.common_path_std_m**2 / 4.0 * np.eye(2)
        state = np.array([position_m[0], 0.0, position_m[1], 0.0])
        confirmed = c.confirm_updates <= 1
        self.tracks.append(PathTrack(self.next_id, ConstantVelocityFilter(state, covariance), confirmed))
        self.next_id += 1
        return True

    def _decide(self, value: float, limit: float) -> None:
        self.margin = min(self.margin, abs(value / limit - 1.0)) if limit > 0.0 else self.margin

    def _predict(self, dt_s: float) -> None:
        """A silent track comes to rest, and none leaves the room through its walls."""
        c = self.config
        fade = np.exp(-dt_s / c.silent_velocity_time_s) if c.silent_velocity_time_s > 0.0 else 0.0
        for track in self.tracks:
            silent = track.state == SILENT
            track.filter.predict(dt_s, c.acceleration_density_m2ps3, float(fade) if silent else 1.0)
            for axis in range(2):
                low, high = self.area_m[axis], self.area_m[axis + 2]
                if not low <= track.filter.state[2 * axis] <= high:
                    track.filter.state[2 * axis] = np.clip(track.filter.state[2 * axis], low, high)
                    track.filter.state[2 * axis + 1] = 0.0

    def _share_out(
        self, tracks: list[PathTrack], paths_m: list[Array], owners: list[NDArray[np.int64]]
    ) -> dict[int, tuple[int, ...]]:
        """By ascending distance, as long as a combination's traces are free."""
        choices = [
            (choice, track) for track in tracks for choice in self._combinations(track, paths_m, owners)
        ]
        taken: dict[int, tuple[int, ...]] = {}
        ordered = sorted(choices, key=lambda pair: pair[0].distance)
        for choice, track in ordered:
            chosen = [(r, k) for r, k in enumerate(choice.traces) if k != NONE]
            if track.id not in taken and all(owners[r][k] == 0 for r, k in chosen):
                taken[track.id] = choice.traces
                for r, k in chosen:
                    owners[r][k] = track.id
        for (one, _), (other, _) in pairwise(ordered):
            self.margin = min(self.margin, (other.distance - one.distance) / self.config.gate)
        return taken

    def _combinations(
        self, track: PathTrack, paths_m: list[Array], owners: list[NDArray[np.int64]]
    ) -> Iterator[_Choice]:
        """All within the gate of at least two receivers' free traces."""
        predicted, gradient = track.predicted(self.wall, self.rx_x_m)
        position = track.filter.covariance[POSITION, POSITION]
        covariance = gradient @ position @ gradient.T + self._noise(len(paths_m))
        free = [[*np.flatnonzero(owner == 0), NONE] for owner in owners]
        for traces in np.array(np.meshgrid(*free, indexing="ij")).reshape(len(free), -1).T:
            present = np.flatnonzero(traces != NONE)
            if len(present) < 2:
                continue
            innovation = np.array([paths_m[r][traces[r]] for r in present]) - predicted[present]
            distance = float(innovation @ np.linalg.solve(covariance[np.ix_(present, present)], innovation))
            distance += self.config.missing_cost * (len(paths_m) - len(present))
            self._decide(distance, self.config.gate)
            if distance < self.config.gate:
                yield _Choice(distance, tuple(int(k) for k in traces))

    def _noise(self, n: int) -> Array:
        c = self.config
        return np.asarray(c.path_std_m**2 * np.eye(n) + c.common_path_std_m**2 * np.ones((n, n)))

    def _take(self, track: PathTrack, paths_m: list[Array], traces: tuple[int, ...]) -> None:
        """The mean of the paths, then what differs between them, whose noises are independent."""
        present = [r for r, k in enumerate(traces) if k != NONE]
        measured = np.array([paths_m[r][traces[r]] for r in present])
        predicted, gradient = (of[present] for of in track.predicted(self.wall, self.rx_x_m))
        before = track.filter.state[POSITION].copy()
        n, c = len(present), self.config
        for which, row in enumerate(helmert(n)):
            direction = row @ gradient
            moved = track.filter.state[POSITION] - before
            innovation = float(row @ (measured - predicted) - direction @ moved)
            variance = c.path_std_m**2 + (n * c.common_path_std_m**2 if which == 0 else 0.0)
            self._take_along(track, direction, innovation, variance, cut=which > 0)

    def _take_along(
        self, track: PathTrack, direction: Array, innovation: float, variance: float, *, cut: bool
    ) -> None:
        if cut:
            position = track.filter.covariance[POSITION, POSITION]
            most = self.config.cut_off * float(np.sqrt(direction @ position @ direction + variance))
            innovation = min(max(innovation, -most), most)
        track.filter.update_along(direction, innovation, variance)

    def _take_lone(self, track: PathTrack, paths_m: list[Array], owners: list[NDArray[np.int64]]) -> bool:
        """The free trace that a confirmed track explains best, along its own path."""
        c = self.config
        if not track.confirmed or track.lone >= c.lone_limit:
            return False
        predicted, gradient = track.predicted(self.wall, self.rx_x_m)
        position = track.filter.covariance[POSITION, POSITION]
        noise = float(self._noise(1)[0, 0])
        found = []
        for r, paths in enumerate(paths_m):
            variance = float(gradient[r] @ position @ gradient[r]) + noise
            for k in map(int, np.flatnonzero(owners[r] == 0)):
                distance = float((paths[k] - predicted[r]) ** 2 / variance)
                self._decide(distance, c.lone_gate)
                if distance < c.lone_gate:
                    found.append((distance, r, k))
        if not found:
            return False
        ordered = sorted(found)
        if len(ordered) > 1:
            self.margin = min(self.margin, (ordered[1][0] - ordered[0][0]) / c.lone_gate)
        _, r, k = ordered[0]
        owners[r][k] = track.id
        self._take_along(track, gradient[r], float(paths_m[r][k] - predicted[r]), noise, cut=True)
        track.lone += 1
        return True

    def _live(self, dt_s: float) -> None:
        """Confirm, delete, and make one of two tracks of one person."""
        c = self.config
        left: list[PathTrack] = []
        for track in self.tracks:
            n = sum(track.updates)
            track.confirmed = track.confirmed or n >= c.confirm_updates
            hopeless = len(track.updates) - n > c.confirm_window - c.confirm_updates
            silent_too_long = track.silent_time_s > c.silent_time_s + 0.5 * dt_s
            dead = silent_too_long if track.confirmed else hopeless
            if not dead and not any(self._same(track, other) for other in left):
                left.append(track)
        self.tracks = left

    def _same(self, one: PathTrack, other: PathTrack) -> bool:
        if not (one.confirmed and other.confirmed):
            return False
        apart = one.filter.state - other.filter.state
        distance, speed = (float(np.linalg.norm(apart[part])) for part in (POSITION, VELOCITY))
        self._decide(distance, self.config.merge_distance_m)
        self._decide(speed, self.config.merge_speed_mps)
        return distance < self.config.merge_distance_m and speed < self.config.merge_speed_mps
