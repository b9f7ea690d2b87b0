"""Tracks people by the nodes' paths themselves: no position has to be found within one frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.estimation.kalman import ConstantVelocityFilter
from echofuse.reference.hub.locate.site import Site, path_gradient
from echofuse.reference.hub.track.people_likelihood import PeopleLikelihood, Trail
from echofuse.reference.hub.track.people_search import PeopleSearch
from echofuse.reference.hub.track.range_births import RangeBirths, lone_score, missed_score
from echofuse.reference.hub.track.range_config import RangeTrackerConfig
from echofuse.reference.hub.track.track_manager import CONFIRMED, SILENT, UNCONFIRMED

Array = NDArray[np.float64]

OUTSIDE_M = 0.2
DOUBLE_M, DOUBLE_MPS = 0.3, 0.7
BIRTH_SHARE = 0.5
DEMOTED_SCORE = 30.0
LEAST_SURENESS = 0.05
MAX_TARGETS = 16


@dataclass
class RangeTrack:
    id: int
    filter: ConstantVelocityFilter
    trail: Trail
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
        return self.filter.position

    @property
    def velocity_mps(self) -> Array:
        return self.filter.velocity


class RangeStep(NamedTuple):
    """Tracks after a frame, and how near its decisions were to others."""

    tracks: list[RangeTrack]  # ascending id
    margin: float  # [m] or [1]


class RangeTracker:
    """State: tracks, the confirmed ones first, then by descending score; the window's detections."""

    def __init__(self, config: RangeTrackerConfig, body_radius_m: float, site: Site, max_tracks: int) -> None:
        self.config, self.radius_m, self.site, self.max_tracks = config, body_radius_m, site, max_tracks
        self.likelihood = PeopleLikelihood(config, body_radius_m, site)
        self.search = PeopleSearch(config, MAX_TARGETS)
        self.births = RangeBirths(config, site)
        self.tracks: list[RangeTrack] = []
        self.next_id = 1
        self.margin = np.inf

    def process(self, node_index: NDArray[np.int64], path_m: Array, dt_s: float) -> RangeStep:
        """Take in a frame's detections, ascending node then path (n,)."""
        self.margin = np.inf
        self.likelihood.add_frame([path_m[node_index == node] for node in range(len(self.site.tx_m))], dt_s)
        self._predict(dt_s)
        self._update_confirmed()
        self._advance()
        self._choose_people()
        self._begin()
        return RangeStep(sorted(self.tracks, key=lambda track: track.id), self.margin)

    def _note(self, margin: float) -> None:
        self.margin = min(self.margin, margin)

    def _decide(self, value: float, threshold: float) -> bool:
        """Whether value > threshold; notes how clear it is."""
        self._note(abs(value - threshold))
        return value > threshold

    def _visible_path(self, track: RangeTrack, node: int) -> float:
        paths, margin = self.likelihood.visible_paths(track.position_m)
        self._note(margin)
        return float(paths[node])

    def _gradient(self, track: RangeTrack, node: int) -> Array:
        return path_gradient(track.position_m, self.site.tx_m[node], self.site.rx_m[node], self.radius_m)

    def _path_std_m(self, track: RangeTrack, node: int) -> float:
        direction = self._gradient(track, node)
        variance = direction @ track.filter.position_covariance @ direction
        return float(np.sqrt(variance + self.config.path_std_m**2))

    def _predict(self, dt_s: float) -> None:
        """Move all tracks, and put them in order."""
        for track in self.tracks:
            track.filter.predict(dt_s, self.config.acceleration_density_m2ps3)
            self.likelihood.step(track.trail)
        confirmed = [track for track in self.tracks if track.confirmed]
        others = sorted((track for track in self.tracks if not track.confirmed), key=lambda t: -t.score)
        gaps = np.diff([track.score for track in others])
        self._note(float(np.min(np.abs(gaps[gaps != 0.0]), initial=np.inf)))
        self.tracks = confirmed + others

    def _update_confirmed(self) -> None:
        """They share out the detections of each node, and follow theirs the more the surer it is."""
        people = [track for track in self.tracks if track.confirmed]
        for track in people:
            self._note(self.likelihood.lay(track.filter, None, track.trail))
            track.n_own = 0
        trails = [track.trail for track in people]
        for node in range(len(self.site.tx_m)):
            if not people:
                return
            stds_m = np.array([self._path_std_m(track, node) for track in people])
            claims = self.likelihood.claim(trails, stds_m, node)
            self._note(claims.margin)
            for track, detection, sureness in zip(people, claims.detection, claims.sureness, strict=True):
                if detection < 0 or not self._decide(sureness, LEAST_SURENESS):
                    continue
                path = self._visible_path(track, node)
                if np.isnan(path):
                    continue
                innovation = self.likelihood.frames[0][node][detection] - path
                noise = (self.config.path_std_m / sureness) ** 2
                track.filter.update_along(self._gradient(track, node), innovation, noise)
                track.n_own += 1

    def _follow(self, track: RangeTrack) -> float:
        """Update an unconfirmed track by each node's nearest detection; its score in this frame."""
        c, score, track.n_own = self.config, 0.0, 0
        for node, detections in enumerate(self.likelihood.frames[0]):
            path = self._visible_path(track, node)
            if np.isnan(path):
                continue
            errors = np.abs(detections - path)
            near = np.sort(errors[errors < c.gate_m])
            self._note(float(np.min(np.diff(near), initial=np.inf)))
            if not len(errors) or not self._decide(c.gate_m, float(errors.min())):
                score += missed_score(c)
                continue
            error = float(detections[np.argmin(errors)] - path)
            score += lone_score(c, error, self._path_std_m(track, node))
            track.filter.update_along(self._gradient(track, node), error, c.path_std_m**2)
            track.n_own += 1
        return score

    def _lives(self, track: RangeTrack) -> bool:
        c, area = self.config, self.site.area_m
        low, high = track.position_m - (area[:2] - OUTSIDE_M), area[2:] + OUTSIDE_M - track.position_m
        if not self._decide(float(min(low.min(), high.min())), 0.0):
            return False
        if track.confirmed:
            return True
        speed = float(np.linalg.norm(track.velocity_mps))
        return self._decide(track.score, c.drop_score) and self._decide(c.max_speed_mps, speed)

    def _crowded(self, track: RangeTrack, better: list[RangeTrack]) -> bool:
        """Whether a better track is the same person."""
        for other in better:
            distance = float(np.linalg.norm(other.position_m - track.position_m))
            if not track.confirmed:
                if self._decide(self.config.merge_distance_m, distance):
                    return True
                continue
            apart = float(np.linalg.norm(other.velocity_mps - track.velocity_mps))
            if self._decide(DOUBLE_M, distance) and self._decide(DOUBLE_MPS, apart):
                return True
        return False

    def _advance(self) -> None:
        """Unconfirmed tracks follow what is nearest; who is no person, or one twice, ends."""
        kept: list[RangeTrack] = []
        for track in self.tracks:
            if not track.confirmed:
                track.score = self.config.candidate_memory * track.score + self._follow(track)
            track.age += 1
            own = track.n_own >= self.config.silent_nodes
            track.frames_since_update = 0 if own else track.frames_since_update + 1
            if self._lives(track) and not self._crowded(track, kept):
                kept.append(track)
        self.tracks = kept

    def _choose_people(self) -> None:
        """Confirmed is the set of tracks that explains the window best."""
        candidates = []
        for track in self.tracks:
            eligible = track.confirmed or track.age >= self.config.confirm_frames
            edge = self.likelihood.lay(track.filter, track.age if eligible else None, track.trail)
            if eligible:
                self._note(edge)
                candidates.append(track)
        n_before = sum(track.confirmed for track in candidates)
        there, margin = self.search.process(self.likelihood, [track.trail for track in candidates], n_before)
        self._note(margin)
        for index, track in enumerate(candidates):
            if track.confirmed and index not in there:
                track.score = DEMOTED_SCORE
            track.confirmed = index in there

    def _begin(self) -> None:
        """At the places that fit best."""
        places = self.births.process(self.likelihood)
        self._note(places.margin)
        n_begun = 0
        for at_m in places.at_m:
            if n_begun >= self.config.max_births:
                break
            n_begun += self._begin_at(at_m)

    def _begin_at(self, place_m: Array) -> bool:
        c = self.config
        for track in self.tracks:
            distance = float(np.linalg.norm(track.position_m - place_m))
            if self._decide(c.birth_exclusion_m, distance):
                return False
        covariance = c.newborn_position_std_m**2 * np.eye(2)
        filter_ = ConstantVelocityFilter.at(place_m, covariance, np.zeros(2), c.newborn_velocity_std_mps)
        track = RangeTrack(self.next_id, filter_, Trail(len(self.site.tx_m)))
        score = self._follow(track)
        if not self._decide(score, c.birth_score) or track.n_own == 0:  # 0: where all nodes are blind
            return False
        if len(self.tracks) >= self.max_tracks:
            return False
        track.score = BIRTH_SHARE * score
        self.likelihood.lay(track.filter, None, track.trail)
        self.tracks.append(track)
        self.next_id += 1
        return True
