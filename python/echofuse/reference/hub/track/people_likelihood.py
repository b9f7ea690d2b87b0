"""How well a set of people explains all that the nodes detected in the last frames."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.estimation.kalman import ConstantVelocityFilter
from echofuse.reference.hub.locate.site import Site, path_m
from echofuse.reference.hub.track.range_config import RangeTrackerConfig

Array = NDArray[np.float64]


class Trail:
    """Where one person was, newest frame first; a frame's place in it grows as frames come."""

    def __init__(self, n_nodes: int) -> None:
        self.position_m: Array = np.zeros((0, 2))
        self.scale_m: Array = np.zeros(0)  # mean deviation of a detection from the path
        self.path_m: Array = np.zeros((0, n_nodes))  # NaN: too near to be seen


class Score(NamedTuple):
    value: float
    edge: float  # [m] to the nearest place where it would jump


class Claims(NamedTuple):
    """Of each person, in the newest frame at a node."""

    detection: NDArray[np.intp]  # (n_people,) -1 without one
    sureness: Array  # (n_people,) probability that it is hers
    margin: float  # [m]


class _Scene(NamedTuple):
    """People at the nodes in the window's frames."""

    path_m: Array  # (n_people, n_frames, n_nodes) infinite when too near
    first_m: Array  # (n_frames, n_nodes)
    probability: Array  # (n_people, n_frames, n_nodes) of being detected
    detection: NDArray[np.intp]  # (n_people, n_frames, n_nodes) -1 without one
    edge: float


class PeopleLikelihood:
    """State: the detections of the window, newest frame first."""

    def __init__(self, config: RangeTrackerConfig, body_radius_m: float, site: Site) -> None:
        self.config, self.radius_m, self.site = config, body_radius_m, site
        self.baseline_m = np.linalg.norm(site.tx_m - site.rx_m, axis=1)
        self.frames: list[list[Array]] = []  # by frame and node, ascending paths
        self.dt_s: list[float] = []  # since the frame before
        self.detections = np.zeros((0, len(site.tx_m), 1))  # NaN beyond a node's last

    def add_frame(self, paths: list[Array], dt_s: float) -> None:
        """Take in the next frame's paths by node [m]; the oldest beyond the window is forgotten."""
        window = self.config.window_frames
        self.frames = [paths, *self.frames][:window]
        self.dt_s = [dt_s, *self.dt_s][:window]
        most = max([1, *(len(node) for frame in self.frames for node in frame)])
        self.detections = np.full((len(self.frames), len(self.site.tx_m), most), np.nan)
        for f, frame in enumerate(self.frames):
            for n, node in enumerate(frame):
                self.detections[f, n, : len(node)] = node

    def visible_paths(self, place_m: Array) -> tuple[Array, float]:
        """Path over a place at each node (n_nodes,), NaN if too near, and how near that decision was [m]."""
        c, site = self.config, self.site
        paths = np.array(
            [path_m(place_m, tx, rx, self.radius_m) for tx, rx in zip(site.tx_m, site.rx_m, strict=True)]
        )
        least = self.baseline_m + c.visible_path_m
        shown = np.maximum(paths, self.baseline_m + c.nearest_path_m)
        return np.where(paths < least, np.nan, shown), float(np.min(np.abs(paths - least)))

    def step(self, trail: Trail) -> None:
        """Make room in a trail for the newest frame."""
        keep = self.config.window_frames - 1
        trail.position_m = np.vstack([np.full((1, 2), np.nan), trail.position_m[:keep]])
        trail.scale_m = np.append(np.nan, trail.scale_m[:keep])
        trail.path_m = np.vstack([np.full((1, len(self.site.tx_m)), np.nan), trail.path_m[:keep]])

    def lay(self, filter_: ConstantVelocityFilter, age: int | None, trail: Trail) -> float:
        """Put a filter's state into the newest frame; with `age`, also into those before the track began.

        Those are straight back from the newest, the less sure the further. Returns the nearest decision [m].
        """
        c, edge = self.config, np.inf
        position, velocity = filter_.position, filter_.velocity
        spread = filter_.covariance
        back_s = np.concatenate([[0.0], np.cumsum(self.dt_s)])
        oldest = 0 if age is None else len(self.frames) - 1
        missing = oldest + 1 - len(trail.scale_m)
        if missing > 0:
            trail.position_m = np.vstack([trail.position_m, np.full((missing, 2), np.nan)])
            trail.scale_m = np.append(trail.scale_m, np.full(missing, np.nan))
            trail.path_m = np.vstack([trail.path_m, np.full((missing, len(self.site.tx_m)), np.nan)])
        for lag in range(oldest + 1):
            if lag > 0 and age is not None and lag < age:
                continue
            back = back_s[lag]
            variance = 0.0
            if lag > 0:
                motion = np.array([[1.0, -back]])
                for axis in (slice(0, 2), slice(2, 4)):
                    variance += (motion @ spread[axis, axis] @ motion.T).item()
                variance = max(0.0, variance + c.acceleration_density_m2ps3 * back**3)
            trail.position_m[lag] = position - back * velocity
            # A Laplace density of mean deviation b has the variance 2 b^2.
            trail.scale_m[lag] = np.sqrt(c.path_scale_m**2 + variance / 2.0)
            trail.path_m[lag], near = self.visible_paths(trail.position_m[lag])
            edge = min(edge, near)
        return float(edge)

    def score(self, people: Sequence[Trail]) -> Score:
        """Logarithm of the likelihood of the window's detections, up to what is the same for all sets."""
        c, n = self.config, len(self.frames)
        scene = self._scene(people, n)
        log_clutter, edge = self._log_clutter(scene, self.detections)
        total, explained = 0.0, np.zeros(self.detections.shape, bool)
        for i, trail in enumerate(people):
            seen = np.isfinite(scene.path_m[i])
            missed = np.where(self._shares(scene, i), c.shared_score, np.log(1.0 - scene.probability[i]))
            own = scene.detection[i] >= 0
            total += float(np.sum(missed[seen & ~own]))
            f, node = np.nonzero(own)
            chosen = scene.detection[i][own]
            explained[f, node, chosen] = True
            error = np.abs(self.detections[f, node, chosen] - scene.path_m[i][own])
            scale = trail.scale_m[f]
            hit = np.log(scene.probability[i][own] / (2.0 * scale)) - error / scale
            total += float(np.sum(np.maximum(hit, missed[own] + log_clutter[f, node, chosen])))
        total += float(np.sum(log_clutter[np.isfinite(self.detections) & ~explained]))
        return Score(total, min(edge, scene.edge))

    def claim(self, people: Sequence[Trail], stds_m: Array, node: int) -> Claims:
        """Whose is what in the newest frame at a node; stds_m (n_people,) of the paths."""
        scene = self._scene(people, 1)
        detection, margin = scene.detection[:, 0, node], scene.edge
        paths = self.frames[0][node]
        sureness = np.zeros(len(people))
        for i in np.flatnonzero(detection >= 0):
            probability = scene.probability[i, 0, node]
            deviations = (paths[detection[i]] - scene.path_m[i, 0, node]) / stds_m[i]
            own = probability * np.exp(-0.5 * deviations**2) / (np.sqrt(2.0 * np.pi) * stds_m[i])
            sureness[i] = own / (own + (1.0 - probability) * self.config.clutter_near_per_m)
        errors = np.abs(paths[np.newaxis] - scene.path_m[:, 0, node, np.newaxis])
        return Claims(detection, sureness, min(margin, _tie(errors, self.config.gate_m)))

    def _scene(self, people: Sequence[Trail], n_frames: int) -> _Scene:
        c = self.config
        shape = (0, n_frames, len(self.site.tx_m))
        if not people:
            nothing = np.zeros(shape)
            return _Scene(nothing, np.full(shape[1:], np.inf), nothing, np.zeros(shape, np.intp), np.inf)
        path = np.stack([trail.path_m[:n_frames] for trail in people])
        hidden = np.isnan(path)
        first = np.min(np.where(hidden, self.baseline_m + c.visible_path_m, path), axis=0)
        path = np.where(hidden, np.inf, path)
        behind = np.where(hidden, 0.0, path - first)
        clearance = self._clearance([trail.position_m[:n_frames] for trail in people])
        edge = min(
            float(np.min(np.abs(behind - c.far_m))),
            *(float(np.min(np.abs(clearance - radius))) for radius in (c.shadow_radius_m, c.penumbra_m)),
        )
        far = behind > c.far_m
        clear = np.where(far, c.far_detection_probability, c.detection_probability)
        shadowed = np.where(far, c.far_shadowed_detection_probability, c.shadowed_detection_probability)
        half = (clear + shadowed) / 2.0
        probability = np.where(clearance < c.penumbra_m, half, clear)
        probability = np.where(clearance < c.shadow_radius_m, shadowed, probability)
        detection = _associate(path, self.detections[:n_frames], c.gate_m)
        return _Scene(path, first, probability, detection, edge)

    def _clearance(self, positions: list[Array]) -> Array:
        """How near others are to the legs to each person (n_people, n_frames, n_nodes) [m]."""
        site, n_frames = self.site, len(positions[0])
        clearance = np.full((len(positions), n_frames, len(site.tx_m)), np.inf)
        for i, place in enumerate(positions):
            for j, other in enumerate(positions):
                if i == j:
                    continue
                for antennas in (site.tx_m, site.rx_m):
                    leg = place[:, np.newaxis] - antennas  # (n_frames, n_nodes, 2)
                    to_other = other[:, np.newaxis] - antennas
                    part = np.clip(np.sum(leg * to_other, axis=-1) / np.sum(leg**2, axis=-1), 0.0, 1.0)
                    off = np.linalg.norm(part[..., np.newaxis] * leg - to_other, axis=-1)
                    clearance[i] = np.minimum(clearance[i], off)
        return clearance

    def _shares(self, scene: _Scene, i: int) -> NDArray[np.bool_]:
        """Where somebody with a detection is so near in path that it may be both's (n_frames, n_nodes)."""
        shares = np.zeros(scene.first_m.shape, bool)
        for j in range(len(scene.path_m)):
            if j != i:
                with np.errstate(invalid="ignore"):
                    near = np.abs(scene.path_m[j] - scene.path_m[i]) < self.config.shared_path_m
                shares |= near & (scene.detection[j] >= 0)
        return shares

    def _log_clutter(self, scene: _Scene, detections: Array) -> tuple[Array, float]:
        """By how far each detection is behind somebody (n_frames, n_nodes, n_detections), and the edge."""
        c = self.config
        behind = detections - scene.first_m[..., np.newaxis] + c.ahead_m
        ahead = ~(behind > 0.0)
        edge = np.min(np.abs(behind), initial=np.inf, where=np.isfinite(behind))
        for path in scene.path_m:
            own = detections - path[..., np.newaxis] + c.ahead_m
            edge = np.min(np.abs(own), initial=edge, where=np.isfinite(own))
            behind = np.where(own > 0.0, np.minimum(behind, own), behind)
        edge = np.min(np.abs(behind - c.far_m), initial=edge, where=np.isfinite(behind))
        density = np.where(behind < c.far_m, c.clutter_near_per_m, c.clutter_far_per_m)
        return np.log(np.where(ahead, c.clutter_ahead_per_m, density)), float(edge)


def _associate(path: Array, detections: Array, gate_m: float) -> NDArray[np.intp]:
    """Pairs of person and detection, the nearest first: each person's (n_people, n_frames, n_nodes)."""
    with np.errstate(invalid="ignore"):
        error = np.abs(detections[np.newaxis] - path[..., np.newaxis])
    error = np.where(np.isnan(error) | ~(error < gate_m), np.inf, error)
    chosen = np.full(path.shape, -1, np.intp)
    n_people, n_detections = len(path), detections.shape[-1]
    f, node = np.meshgrid(*(np.arange(size) for size in path.shape[1:]), indexing="ij")
    for _ in range(n_people):
        flat = np.moveaxis(error, 0, 2).reshape(*path.shape[1:], n_people * n_detections)
        best: NDArray[np.intp] = np.asarray(np.argmin(flat, axis=-1))
        found = np.asarray(np.isfinite(np.min(flat, axis=-1)))
        who, which = best // n_detections, best % n_detections
        chosen[who[found], f[found], node[found]] = which[found]
        error[who[found], f[found], node[found]] = np.inf
        error[:, f[found], node[found], which[found]] = np.inf
    return chosen


def _tie(errors: Array, gate_m: float) -> float:
    """How near two pairs of one person or one detection are to taking each other's place [m]."""
    margin = float(np.min(np.abs(errors - gate_m), initial=np.inf))
    for rows in (errors, errors.T):
        for row in rows:
            row = np.sort(row[row < gate_m])
            margin = min(margin, float(np.min(np.diff(row), initial=np.inf)))
    return margin
