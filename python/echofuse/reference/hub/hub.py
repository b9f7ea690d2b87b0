"""The hub of the pipeline `sensor_radar`: the nodes' reports in, tracks out (sensor-radar paper, V)."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.estimation.mixture_em import Mixture, MixtureConfig
from echofuse.reference.hub.locate.ellipse_least_squares import EllipseConfig
from echofuse.reference.hub.locate.site import Site
from echofuse.reference.hub.measure.frame_assembler import (
    ClosedFrame,
    FrameAssembler,
    FrameAssemblerConfig,
    Report,
)
from echofuse.reference.hub.measure.frame_clock import FrameClock
from echofuse.reference.hub.measure.measurement_selection import (
    Limits,
    Measurements,
    SelectionConfig,
    measurement_selection,
)
from echofuse.reference.hub.measure.point_clusters import PointClusterConfig, PointClusters, point_clusters
from echofuse.reference.hub.track.kalman_tracker import KalmanTracker
from echofuse.reference.hub.track.phd_filter import PhdConfig
from echofuse.reference.hub.track.phd_tracker import PhdStep, PhdTracker
from echofuse.reference.hub.track.range_config import RangeTrackerConfig
from echofuse.reference.hub.track.range_tracker import RangeStep, RangeTrack, RangeTracker
from echofuse.reference.hub.track.track_manager import UNCONFIRMED, Step, Track, TrackManagerConfig

Array = NDArray[np.float64]


class Point(Protocol):
    x_m: float
    y_m: float


class NodeSite(Protocol):
    node_id: int
    tx: Point
    rx: Point


class Area(Protocol):
    min_x_m: float
    min_y_m: float
    max_x_m: float
    max_y_m: float


class SensorRadarHubConfig(Protocol):
    nodes: list[NodeSite]
    n_nodes: int
    area: Area
    frame_period_s: float
    aid_missed_frames: int
    tracker: str  # phd | kalman | range
    frame_assembler: FrameAssemblerConfig
    ellipse: EllipseConfig
    selection: SelectionConfig
    point_clusters: PointClusterConfig
    phd: PhdConfig
    em: MixtureConfig
    tracks: TrackManagerConfig
    ranges: RangeTrackerConfig


@dataclass
class HubLimits:
    """The capacities of the core's limits.hpp that matter to the hub."""

    max_tuples: int
    max_measurements: int
    max_candidates: int
    max_points: int
    max_particles: int
    max_newborn_particles: int
    max_targets: int
    max_tracks: int


class HubFrame(NamedTuple):
    """Everything that one frame went through."""

    time_us: int
    number: int
    dt_s: float
    taps: dict[str, Array]  # by the names of TapId
    tracks: list[Track] | list[RangeTrack]
    margins: dict[str, float]  # by stage: selection, points, number, peaks, resampled, tracks


class SensorRadarHub:
    """State: open frames and tracks."""

    def __init__(self, config: SensorRadarHubConfig, limits: HubLimits) -> None:
        self.config, self.limits = config, limits
        nodes = config.nodes[: config.n_nodes]
        area = config.area
        self.site = Site(
            np.array([[node.tx.x_m, node.tx.y_m] for node in nodes]),
            np.array([[node.rx.x_m, node.rx.y_m] for node in nodes]),
            np.array([area.min_x_m, area.min_y_m, area.max_x_m, area.max_y_m]),
        )
        self.assembler = FrameAssembler(config.frame_assembler, [node.node_id for node in nodes])
        self.phd: PhdTracker | None = None
        self.kalman: KalmanTracker | None = None
        self.ranges: RangeTracker | None = None
        if config.tracker == "phd":
            self.phd = PhdTracker(config.phd, config.em, config.tracks, limits, limits.max_tracks)
        elif config.tracker == "range":
            radius_m = config.ellipse.body_radius_m
            self.ranges = RangeTracker(config.ranges, radius_m, self.site, limits.max_tracks)
        else:
            kalman = SimpleNamespace(**(vars(config.tracks) | {"update": "kalman"}))
            self.kalman = KalmanTracker(kalman, limits.max_tracks)
        self.known: list[Track] | list[RangeTrack] = []
        self.clock = FrameClock()

    def receive(self, report: Report, now_us: int) -> bool:
        """Whether the report was a good one of this site."""
        return self.assembler.receive(report, now_us)

    def poll(self, now_us: int) -> HubFrame | None:
        """Work on the oldest frame if it is complete or overdue."""
        closed = self.assembler.poll(now_us)
        if closed is None:
            return None
        dt_s = self.clock.step_s(closed.time_us, self.config.frame_period_s)
        limits = Limits(self.limits.max_tuples, self.limits.max_measurements, self.limits.max_candidates)
        selected = measurement_selection(
            self.config.selection,
            self.config.ellipse,
            self.site,
            limits,
            closed.frame,
            self.predict_people(dt_s),
        )
        clusters = point_clusters(self.config.point_clusters, selected.position_m, selected.weight)
        points = keep_heaviest(clusters, self.limits.max_points)
        taps = measurement_taps(closed, selected, points)
        step: Step | RangeStep
        margins = {"selection": selected.margin, "points": points.margin}
        if self.phd is not None:
            phd_step = self.phd.process(points.position_m, dt_s)
            taps |= phd_taps(phd_step)
            margins |= phd_margins(phd_step)
            step = phd_step.step
        elif self.ranges is not None:
            frame = closed.frame
            step = self.ranges.process(frame.node_index, frame.path_m, dt_s)
        else:
            assert self.kalman is not None
            step = self.kalman.process(points.position_m, dt_s)
        self.known = step.tracks
        taps["tracks"] = track_rows(step)
        margins["tracks"] = step.margin
        return HubFrame(closed.time_us, closed.number, dt_s, taps, step.tracks, margins)

    def predict_people(self, dt_s: float) -> Array:
        """Where the known people should be by now (p, 2) [m]."""
        known = [
            track
            for track in self.known
            if track.state != UNCONFIRMED and track.frames_since_update <= self.config.aid_missed_frames
        ]
        states = np.array([track.filter.state for track in known]).reshape(-1, 4)  # x, vx, y, vy
        return np.asarray(states[:, [0, 2]] + dt_s * states[:, [1, 3]])


def keep_heaviest(clusters: PointClusters, max_points: int) -> PointClusters:
    """Leave out the lightest clusters beyond the trackers' capacity."""
    kept = np.sort(np.lexsort((np.arange(len(clusters.weight)), clusters.weight))[::-1][:max_points])
    return clusters._replace(
        position_m=clusters.position_m[kept], members=clusters.members[kept], weight=clusters.weight[kept]
    )


def measurement_taps(closed: ClosedFrame, selected: Measurements, points: PointClusters) -> dict[str, Array]:
    """frame (n, 3), selected (m, 5), points (c, 4)."""
    frame = closed.frame
    return {
        "frame": np.column_stack([frame.node_index, frame.path_m, frame.weight]),
        "selected": np.column_stack(
            [selected.position_m, selected.weight, selected.range_residual_m, selected.n_nodes]
        ),
        "points": np.column_stack([points.position_m, points.members, points.weight]),
    }


def phd_taps(step: PhdStep) -> dict[str, Array]:
    """predicted, updated, resampled (n, 5) and peaks (p, 5)."""
    return {
        "predicted": step.predicted,
        "updated": step.update.particles,
        "peaks": peak_rows(step.peaks, step.update.mass),
        "resampled": step.resampled,
    }


def peak_rows(peaks: Mixture | None, mass: float) -> Array:
    """(p, 5): x, y, vx, vy, mass."""
    if peaks is None:
        return np.zeros((0, 5))
    return np.column_stack([peaks.mean, peaks.velocity, peaks.share * mass])


def phd_margins(step: PhdStep) -> dict[str, float]:
    """How near the filter's own decisions came to flipping."""
    return {
        "number": step.update.number_margin,
        "peaks": np.inf if step.peaks is None else step.peaks.margin,
        "resampled": float(np.min(step.resampling.margin, initial=np.inf)),
    }


def track_rows(step: Step | RangeStep) -> Array:
    """(t, 7): id, state, x, y, vx, vy, frames since the last update."""
    rows = [
        (t.id, t.state, *t.filter.position, *t.filter.velocity, t.frames_since_update) for t in step.tracks
    ]
    return np.array(rows, dtype=np.float64).reshape(-1, 7)
