"""Tracks from the paths of traces before a plane of antennas: an extended Kalman filter a person.

A handheld's cross-range comes from small differences of paths, and one in ten of them is wrong by
decimetres. So tracks take part in the pairing: each looks among all combinations of traces for the one that
its prediction explains (the through-wall paper, section 4, names what goes wrong without: targets at equal
ranges lose their traces).

The transmitter is the origin, x runs along the wall, y > 0 is the depth, and in space z points upwards.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.estimation.kalman import ConstantVelocityFilter
from echofuse.reference.estimation.turning_filter import TurningFilter
from echofuse.reference.hub.locate.taylor_3d import leg
from echofuse.reference.hub.locate.wall import WallConfig
from echofuse.reference.hub.track.track_manager import CONFIRMED, SILENT, UNCONFIRMED

Array = NDArray[np.float64]

NONE = -1
MIN_DEPTH_M = 0.02
GROWTH_BEGINS_M = 4.0  # of a mean path
STEP_M = 1e-5  # of a numerical derivative


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
    path_std_growth: float
    turn_density_m2ps3: float
    turn_begin_probability: float
    turn_end_probability: float
    body_half_height_m: float


@dataclass
class PathTrack:
    id: int
    filter: ConstantVelocityFilter | TurningFilter
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


class Prediction(NamedTuple):
    path_m: Array  # (n,) of each receiver
    gradient: Array  # (n, d)
    own_m2: float  # variance of one receiver's path for itself
    common_m2: float  # of what all share


class _Choice(NamedTuple):
    distance: float
    traces: tuple[int, ...]  # one a receiver, NONE where it has none


def paths_and_gradients(wall: WallConfig, position_m: Array, rx_m: Array) -> tuple[Array, Array]:
    """Paths (n,) [m] from the origin by a position (d,) to receivers (n, d), and their gradients (n, d)."""
    d = len(position_m)
    place, *antennas = (np.pad(of, (0, 3 - d)) for of in (position_m, np.zeros(d), *rx_m))
    legs = [leg(wall, True, place, antenna) for antenna in antennas]
    optical_m, gradient = np.array([r for r, _ in legs]), np.array([g[:d] for _, g in legs])
    return optical_m[0] + optical_m[1:], gradient[0] + gradient[1:]


def paths_by_skin(wall: WallConfig, position_m: Array, rx_m: Array, half_axes_m: Array) -> Array:
    """Paths (n,) [m] by the nearest of an upright ellipsoid's surface, of a middle and half axes (3,).

    A plane front that travels along g, the sum of both unit vectors, meets the ellipsoid earlier than its
    middle by its support s(g) = |half axes * g|.
    """
    path_m, gradient = paths_and_gradients(wall, position_m, rx_m)
    return np.asarray(path_m - np.linalg.norm(half_axes_m * gradient, axis=1))


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

    def __init__(
        self,
        config: PathTrackerConfig,
        wall: WallConfig,
        rx_m: Array,
        area_m: Array,
        body_radius_m: float = 0.0,
    ) -> None:
        """rx_m (n, d): receivers; area_m (2 d,): least x, y, (z), then most of a person's middle [m].

        body_radius_m: in space, half the width of a body; paths hold twice as much more than was measured.
        """
        self.config, self.wall, self.rx_m, self.area_m = config, wall, rx_m, area_m
        self.dimension = rx_m.shape[1]
        self.body_radius_m = body_radius_m if self.dimension == 3 else 0.0
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
        """Begin a track at a fix (d,) that no track explains; False when there was no room for it."""
        c = self.config
        for track in self.tracks:
            distance = float(np.linalg.norm(track.filter.position - position_m))
            self._decide(distance, c.birth_exclusion_m)
            if distance < c.birth_exclusion_m:
                return True
        if len(self.tracks) >= c.max_tracks:
            self.dropped_births += 1
            return False
        covariance = covariance_m2 + c.common_path_std_m**2 / 4.0 * np.eye(self.dimension)
        at_rest = np.zeros(self.dimension)
        begun = ConstantVelocityFilter.at(position_m, covariance, at_rest, c.velocity_std_mps)
        filter = TurningFilter(begun) if c.turn_density_m2ps3 > 0.0 else begun
        self.tracks.append(PathTrack(self.next_id, filter, confirmed=c.confirm_updates <= 1))
        self.next_id += 1
        return True

    def _decide(self, value: float, limit: float) -> None:
        self.margin = min(self.margin, abs(value / limit - 1.0)) if limit > 0.0 else self.margin

    def predicted(self, track: PathTrack) -> Prediction:
        """Paths where a track is."""
        c, a = self.config, self.body_radius_m
        position = track.filter.position.copy()
        position[1] = max(position[1], MIN_DEPTH_M)
        path_m, gradient = paths_and_gradients(self.wall, position, self.rx_m)
        if a > 0.0:
            half_axes_m = np.array([a, a, c.body_half_height_m if c.body_half_height_m > 0.0 else a])

            def by_skin(place: Array) -> Array:
                return paths_by_skin(self.wall, place, self.rx_m, half_axes_m)

            path_m = by_skin(position) + 2.0 * a
            gradient = np.column_stack(
                [(by_skin(position + h) - by_skin(position - h)) / (2.0 * STEP_M) for h in STEP_M * np.eye(3)]
            )
        growth = 1.0 + c.path_std_growth * max(float(np.mean(path_m)) - GROWTH_BEGINS_M, 0.0)
        return Prediction(path_m, gradient, (growth * c.path_std_m) ** 2, (growth * c.common_path_std_m) ** 2)

    def _predict(self, dt_s: float) -> None:
        """A silent track comes to rest, and none leaves the room through its walls."""
        c = self.config
        fade = np.exp(-dt_s / c.silent_velocity_time_s) if c.silent_velocity_time_s > 0.0 else 0.0
        for track in self.tracks:
            decay = float(fade) if track.state == SILENT else 1.0
            if isinstance(track.filter, TurningFilter):
                densities = c.acceleration_density_m2ps3, c.turn_density_m2ps3
                changes = c.turn_begin_probability, c.turn_end_probability
                track.filter.predict(dt_s, densities, *changes, decay)
            else:
                track.filter.predict(dt_s, c.acceleration_density_m2ps3, decay)
            for axis in range(self.dimension):
                track.filter.hold(axis, self.area_m[axis], self.area_m[axis + self.dimension])

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
        predicted = self.predicted(track)
        of_position = predicted.gradient @ track.filter.position_covariance @ predicted.gradient.T
        noise = predicted.own_m2 * np.eye(len(paths_m)) + predicted.common_m2
        covariance = of_position + noise
        free = [[*np.flatnonzero(owner == 0), NONE] for owner in owners]
        for traces in np.array(np.meshgrid(*free, indexing="ij")).reshape(len(free), -1).T:
            present = np.flatnonzero(traces != NONE)
            if len(present) < 2:
                continue
            innovation = np.array([paths_m[r][traces[r]] for r in present]) - predicted.path_m[present]
            distance = float(innovation @ np.linalg.solve(covariance[np.ix_(present, present)], innovation))
            distance += self.config.missing_cost * (len(paths_m) - len(present))
            self._decide(distance, self.config.gate)
            if distance < self.config.gate:
                yield _Choice(distance, tuple(int(k) for k in traces))

    def _take(self, track: PathTrack, paths_m: list[Array], traces: tuple[int, ...]) -> None:
        """The mean of the paths, then what differs between them, whose noises are independent."""
        present = [r for r, k in enumerate(traces) if k != NONE]
        measured = np.array([paths_m[r][traces[r]] for r in present])
        predicted = self.predicted(track)
        ahead = measured - predicted.path_m[present]
        before = track.filter.position.copy()
        n = len(present)
        for which, row in enumerate(helmert(n)):
            direction = row @ predicted.gradient[present]
            moved = track.filter.position - before
            innovation = float(row @ ahead - direction @ moved)
            variance = predicted.own_m2 + (n * predicted.common_m2 if which == 0 else 0.0)
            self._take_along(track, direction, innovation, variance, cut=which > 0)

    def _take_along(
        self, track: PathTrack, direction: Array, innovation: float, variance: float, *, cut: bool
    ) -> None:
        if cut:
            position = track.filter.position_covariance
            most = self.config.cut_off * float(np.sqrt(direction @ position @ direction + variance))
            innovation = min(max(innovation, -most), most)
        track.filter.update_along(direction, innovation, variance)

    def _take_lone(self, track: PathTrack, paths_m: list[Array], owners: list[NDArray[np.int64]]) -> bool:
        """The free trace that a confirmed track explains best, along its own path."""
        c = self.config
        if not track.confirmed or track.lone >= c.lone_limit:
            return False
        predicted, gradient, own_m2, common_m2 = self.predicted(track)
        position = track.filter.position_covariance
        noise = own_m2 + common_m2
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
        distance = float(np.linalg.norm(one.filter.position - other.filter.position))
        speed = float(np.linalg.norm(one.filter.velocity - other.filter.velocity))
        self._decide(distance, self.config.merge_distance_m)
        self._decide(speed, self.config.merge_speed_mps)
        return distance < self.config.merge_distance_m and speed < self.config.merge_speed_mps
