"""Tracks people by the nodes' paths themselves: no position has to be found within one frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.estimation.kalman import ConstantVelocityFilter
from echofuse.reference.hub.locate.site import Site, path_gradient, path_m
from echofuse.reference.hub.track.track_manager import CONFIRMED, SILENT, UNCONFIRMED

Array = NDArray[np.float64]

GATE_SIGMAS = 3.0
BODY_M, ECHO_M, FAR_M = 1.0, 2.5, 8.0
GRID_VARIANCE = 0.3
BIRTH_SHARE = 0.5
OUTSIDE_M = 0.2
SHARED_VARIANCE = 4.0
DOUBLE_M, DOUBLE_MPS = 0.3, 0.7
MAX_CELLS = 2048


class RangeTrackerConfig(Protocol):
    detection_probability: float
    path_std_m: float
    clutter_ahead_per_m: float
    clutter_body_per_m: float
    clutter_echo_per_m: float
    clutter_far_per_m: float
    blind_path_m: float
    gate_m: float
    gate_max_m: float
    echo_tail_m: float
    acceleration_density_m2ps3: float
    newborn_position_std_m: float
    newborn_velocity_std_mps: float
    max_speed_mps: float
    birth_step_m: float
    birth_score: float
    max_births: int
    birth_exclusion_m: float
    merge_distance_m: float
    unconfirmed_memory: float
    confirmed_memory: float
    confirm_score: float
    confirm_frames: int
    confirm_nodes: int
    confirmed_bonus: float
    shared_score: float
    max_score: float
    drop_score: float
    end_score: float
    silent_nodes: int


@dataclass
class RangeTrack:
    id: int
    filter: ConstantVelocityFilter
    age: int = 1
    confirmed: bool = False
    score: float = 0.0
    n_own: int = 0
    frames_since_update: int = 0

    @property
    def state(self) -> int:
        if not self.confirmed:
            return UNCONFIRMED
        return CONFIRMED if self.frames_since_update == 0 else SILENT

    @property
    def position_m(self) -> Array:
        return np.asarray(self.filter.state[[0, 2]])

    @property
    def velocity_mps(self) -> Array:
        return np.asarray(self.filter.state[[1, 3]])


class RangeStep(NamedTuple):
    """Tracks after a frame, and how near its decisions were to others."""

    tracks: list[RangeTrack]  # ascending id
    margin: float  # [m] or [1]


class RangeTracker:
    """State: tracks, best first."""

    def __init__(self, config: RangeTrackerConfig, body_radius_m: float, site: Site, max_tracks: int) -> None:
        self.config, self.radius_m, self.site, self.max_tracks = config, body_radius_m, site, max_tracks
        self.blind_until_m = np.linalg.norm(site.tx_m - site.rx_m, axis=1) + config.blind_path_m
        self.miss_score = float(np.log(1.0 - config.detection_probability))
        self.tracks: list[RangeTrack] = []
        self.next_id = 1
        self.margin = np.inf
        width, height = site.area_m[2:] - site.area_m[:2]
        self.step_m = max(config.birth_step_m, max(width, height) / (MAX_CELLS // 4))
        while self._cells(width) * self._cells(height) > MAX_CELLS:
            self.step_m *= 1.1
        columns = site.area_m[0] + (np.arange(self._cells(width)) + 0.5) * self.step_m
        rows = site.area_m[1] + (np.arange(self._cells(height)) + 0.5) * self.step_m
        self.grid_m = np.stack(np.meshgrid(columns, rows, indexing="ij"), axis=-1)

    def process(self, node_index: NDArray[np.int64], path_m: Array, dt_s: float) -> RangeStep:
        """Take in a frame's detections, ascending node then path (n,)."""
        self.margin = np.inf
        self.paths = [path_m[node_index == node] for node in range(len(self.site.tx_m))]
        self.claimed = [np.zeros(len(paths), bool) for paths in self.paths]
        self.clutter = [self._clutter_per_m(paths) for paths in self.paths]
        self._advance(dt_s)
        self._begin()
        return RangeStep(sorted(self.tracks, key=lambda track: track.id), self.margin)

    def _cells(self, length_m: float) -> int:
        return max(1, int(np.float32(length_m) / np.float32(self.step_m)))

    def _decide(self, value: float, threshold: float) -> bool:
        """Whether value > threshold; notes how clear it is."""
        self.margin = min(self.margin, abs(value - threshold))
        return value > threshold

    def _clutter_per_m(self, paths_m: Array) -> Array:
        """Density of clutter at each detection (n,), by what is in front of it."""
        c = self.config
        density = np.full(len(paths_m), c.clutter_ahead_per_m)
        for i, path in enumerate(paths_m):
            for behind in path - paths_m[:i]:
                self._note_edges(behind)
                if 0.0 < behind < BODY_M:
                    density[i] = max(density[i], c.clutter_body_per_m)
                elif BODY_M <= behind < ECHO_M:
                    density[i] = max(density[i], c.clutter_echo_per_m)
                elif ECHO_M <= behind < FAR_M:
                    density[i] = max(density[i], c.clutter_far_per_m)
        return density

    def _note_edges(self, behind_m: float) -> None:
        self.margin = min(self.margin, *(abs(behind_m - edge) for edge in (BODY_M, ECHO_M, FAR_M)))

    def _path(self, position_m: Array, node: int) -> float:
        return float(path_m(position_m, self.site.tx_m[node], self.site.rx_m[node], self.radius_m))

    def _nearest(self, node: int, path: float, free_only: bool, gate_m: float) -> int | None:
        errors = np.abs(self.paths[node] - path)
        if free_only:
            errors = np.where(self.claimed[node], np.inf, errors)
        if not len(errors):
            return None
        order = np.sort(errors[np.isfinite(errors)])
        if len(order) > 1 and order[0] < gate_m:
            self.margin = min(self.margin, order[1] - order[0])
        best = int(np.argmin(errors))
        return best if self._decide(gate_m, float(errors[best])) else None

    def _hit_score(self, node: int, detection: int, path: float, std_m: float) -> float:
        """Log-likelihood ratio: the detection is the person's, or the person was missed."""
        deviations = (self.paths[node][detection] - path) / std_m
        density = self.clutter[node][detection]
        hit = self.config.detection_probability * np.exp(-0.5 * deviations**2)
        hit /= np.sqrt(2.0 * np.pi) * std_m * density
        return max(float(np.log(max(hit, 1e-300))), self.miss_score)

    def _follow(self, track: RangeTrack, may_share: bool) -> float:
        """Update the track by each node's nearest detection; its score in this frame."""
        c, score, track.n_own = self.config, 0.0, 0
        for node, (tx, rx) in enumerate(zip(self.site.tx_m, self.site.rx_m, strict=True)):
            path = self._path(track.position_m, node)
            if self._decide(self.blind_until_m[node], path):
                continue
            gradient = path_gradient(track.position_m, tx, rx, self.radius_m)
            shown = np.array([gradient[0], 0.0, gradient[1], 0.0])
            noise = c.path_std_m**2
            variance = shown @ track.filter.covariance @ shown + noise
            gate = min(c.gate_max_m, max(c.gate_m, GATE_SIGMAS * np.sqrt(variance)))
            chosen = self._nearest(node, path, True, gate)
            if chosen is not None:
                score += self._hit_score(node, chosen, path, float(np.sqrt(variance)))
                track.n_own += 1
            else:
                chosen = self._nearest(node, path, False, gate)
                score += self.miss_score if chosen is None else c.shared_score
                if chosen is None or not may_share:
                    continue
                noise += (SHARED_VARIANCE - 1.0) * variance
            track.filter.update_along(gradient, self.paths[node][chosen] - path, noise)
        return score

    def _lives(self, track: RangeTrack) -> bool:
        c, area = self.config, self.site.area_m
        low, high = track.position_m - (area[:2] - OUTSIDE_M), area[2:] + OUTSIDE_M - track.position_m
        if not self._decide(float(min(low.min(), high.min())), 0.0):
            return False
        if track.confirmed:
            return self._decide(track.score, c.end_score)
        speed = float(np.linalg.norm(track.velocity_mps))
        return self._decide(track.score, c.drop_score) and self._decide(c.max_speed_mps, speed)

    def _crowded(self, track: RangeTrack, better: list[RangeTrack]) -> bool:
        for other in better:
            distance = float(np.linalg.norm(other.position_m - track.position_m))
            if not track.confirmed:
                if self._decide(self.config.merge_distance_m, distance):
                    return True
            elif other.confirmed:
                apart = float(np.linalg.norm(other.velocity_mps - track.velocity_mps))
                if self._decide(DOUBLE_M, distance) and self._decide(DOUBLE_MPS, apart):
                    return True
        return False

    def _claim(self, track: RangeTrack) -> None:
        c = self.config
        for node in range(len(self.paths)):
            behind = self.paths[node] - self._path(track.position_m, node)
            tail = max(c.gate_m, c.echo_tail_m)
            for edge in (-c.gate_m, tail):
                self.margin = min([self.margin, *np.abs(behind - edge)])
            self.claimed[node] |= (behind > -c.gate_m) & (behind < tail)

    def _rank(self, track: RangeTrack) -> float:
        return track.score + (self.config.confirmed_bonus if track.confirmed else 0.0)

    def _advance(self, dt_s: float) -> None:
        """Every track by its turn: the best see all detections, the others what is left."""
        c = self.config
        for track in self.tracks:
            track.filter.predict(dt_s, c.acceleration_density_m2ps3)
        ranked = sorted(self.tracks, key=self._rank, reverse=True)
        ranks = np.array([self._rank(track) for track in ranked])
        ties = np.abs(np.diff(ranks))
        self.margin = min([self.margin, *ties[ties > 0.0]])
        self.tracks = []
        for track in ranked:
            memory = c.confirmed_memory if track.confirmed else c.unconfirmed_memory
            score = self._follow(track, track.confirmed)
            track.score = min(c.max_score, memory * track.score + score)
            track.age += 1
            track.frames_since_update = 0 if track.n_own >= c.silent_nodes else track.frames_since_update + 1
            if not self._lives(track) or self._crowded(track, self.tracks):
                continue
            if not track.confirmed and track.age >= c.confirm_frames and track.n_own >= c.confirm_nodes:
                track.confirmed = self._decide(track.score, c.confirm_score)
            if track.confirmed:
                self._claim(track)
            self.tracks.append(track)

    def _begin(self) -> None:
        """At the grid's maxima of what the tracks have left over, best first."""
        c = self.config
        scores = np.array([[self._cell_score(z) for z in column] for column in self.grid_m])
        maxima = [
            (scores[i, j], i, j) for i, j in np.ndindex(*scores.shape) if self._is_maximum(scores, i, j)
        ]
        maxima.sort(key=lambda cell: -cell[0])
        n_begun = 0
        for score, i, j in maxima[: self.max_tracks]:
            self._decide(float(score), c.birth_score)
            if n_begun >= c.max_births or len(self.tracks) >= self.max_tracks:
                break
            n_begun += self._begin_at(self.grid_m[i, j])

    def _is_maximum(self, scores: Array, i: int, j: int) -> bool:
        """At least the birth score, and the best within two cells; of equal ones the first."""
        if scores[i, j] < self.config.birth_score:
            return False
        for a in range(max(0, i - 2), min(scores.shape[0], i + 3)):
            for b in range(max(0, j - 2), min(scores.shape[1], j + 3)):
                if scores[a, b] > scores[i, j] or (scores[a, b] == scores[i, j] and (a, b) < (i, j)):
                    return False
                if (a, b) != (i, j):
                    self.margin = min(self.margin, abs(scores[i, j] - scores[a, b]))
        return True

    def _cell_score(self, place_m: Array) -> float:
        """Score of a person at a place, by detections that nobody claims."""
        c, score = self.config, 0.0
        std = float(np.sqrt(c.path_std_m**2 + GRID_VARIANCE * self.step_m**2))
        for node in range(len(self.paths)):
            path = self._path(place_m, node)
            if path < self.blind_until_m[node]:
                continue
            errors = np.abs(self.paths[node] - path)
            free = np.where(self.claimed[node], np.inf, errors)
            near_own = len(free) > 0 and free.min() <= c.gate_m
            if not near_own and len(errors) and errors.min() < c.gate_m:
                continue  # another's: says nothing
            if len(free) and free.min() < 4.0 * std:
                score += self._hit_score(node, int(np.argmin(free)), path, std)
            else:
                score += self.miss_score
        return score

    def _begin_at(self, place_m: Array) -> bool:
        c = self.config
        for track in self.tracks:
            distance = float(np.linalg.norm(track.position_m - place_m))
            if self._decide(c.birth_exclusion_m, distance):
                return False
        variances = np.array([c.newborn_position_std_m, c.newborn_velocity_std_mps] * 2) ** 2
        state = np.array([place_m[0], 0.0, place_m[1], 0.0])
        track = RangeTrack(self.next_id, ConstantVelocityFilter(state, np.diag(variances)))
        score = self._follow(track, False)
        if not self._decide(score, c.birth_score) or track.n_own == 0:  # 0: where all nodes are blind
            return False
        track.score = BIRTH_SHARE * score
        self.tracks.append(track)
        self.next_id += 1
        return True
