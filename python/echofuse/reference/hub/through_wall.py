"""The hub of the pipeline `through_wall_2d`: reports in, tracks out (through-wall paper, section 3)."""

from types import SimpleNamespace
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.reference.hub.hub import Area, NodeSite, track_rows
from echofuse.reference.hub.locate.line_locator import (
    LineFix,
    LineLocatorConfig,
    locate_on_line,
    path_and_gradient,
)
from echofuse.reference.hub.measure.frame_assembler import FrameAssembler, FrameAssemblerConfig, Report
from echofuse.reference.hub.measure.frame_clock import FrameClock
from echofuse.reference.hub.measure.trace_pairing import Couple, TracePairing, TracePairingConfig
from echofuse.reference.hub.track.kalman_tracker import KalmanTracker
from echofuse.reference.hub.track.path_tracker import PathTrack, PathTracker, PathTrackerConfig
from echofuse.reference.hub.track.track_manager import Track, TrackManagerConfig

Array = NDArray[np.float64]

SAME_TRACE = 0.5  # [sample] a couple's delay is this trace's
BETWEEN_DEVIATIONS = 3.0  # of a further receiver's path from what a couple predicts


class ThroughWallHubConfig(Protocol):
    nodes: list[NodeSite]
    n_nodes: int
    area: Area
    frame_period_s: float
    body_radius_m: float
    track_aided: bool
    frame_assembler: FrameAssemblerConfig
    trace_pairing: TracePairingConfig
    line_locator: LineLocatorConfig
    path_tracker: PathTrackerConfig
    tracks: TrackManagerConfig


class ThroughWallHubFrame(NamedTuple):
    """Everything that one frame went through."""

    time_us: int
    number: int
    taps: dict[str, Array]  # by the names of TapId
    tracks: list[PathTrack] | list[Track]
    margins: dict[str, float]  # by tap


class ThroughWallHub:
    """State: open frames, the last couples, tracks."""

    def __init__(self, config: ThroughWallHubConfig, max_points: int, max_tracks: int) -> None:
        self.config, self.max_points = config, max_points
        nodes = config.nodes[: config.n_nodes]
        self.tx_m = np.array([nodes[0].tx.x_m, nodes[0].tx.y_m])
        self.rx_x_m = np.array([node.rx.x_m for node in nodes]) - self.tx_m[0]
        self.outer = (int(np.argmin(self.rx_x_m)), int(np.argmax(self.rx_x_m)))
        area = config.area
        self.area_m = np.array([area.min_x_m, area.min_y_m, area.max_x_m, area.max_y_m]) - np.tile(
            self.tx_m, 2
        )
        inner = self.area_m + config.body_radius_m * np.array([1.0, 1.0, -1.0, -1.0])
        self.assembler = FrameAssembler(config.frame_assembler, [node.node_id for node in nodes])
        self.clock = FrameClock()
        pairing = vars(config.trace_pairing) | {"separation_m": float(np.ptp(self.rx_x_m))}
        if config.track_aided:
            pairing["completion_limit"] = 0
        self.pairing = TracePairing(SimpleNamespace(**pairing))
        rx_m = np.column_stack([self.rx_x_m, np.zeros(len(nodes))])
        self.paths = PathTracker(config.path_tracker, config.line_locator.wall, rx_m, inner)
        self.kalman = KalmanTracker(
            SimpleNamespace(**(vars(config.tracks) | {"update": "kalman"})), max_tracks
        )

    def receive(self, report: Report, now_us: int) -> bool:
        """Whether the report was a good one of this site."""
        return self.assembler.receive(report, now_us)

    def poll(self, now_us: int) -> ThroughWallHubFrame | None:
        """Work on the oldest frame if it is complete or overdue."""
        closed = self.assembler.poll(now_us)
        if closed is None:
            return None
        dt_s = self.clock.step_s(closed.time_us, self.config.frame_period_s)
        frame = closed.frame
        of_node = [np.flatnonzero(frame.node_index == r) for r in range(len(self.rx_x_m))]
        paths_m = frame.path_m + 2.0 * self.config.body_radius_m
        associated = np.zeros(len(paths_m), np.int64)
        margins = {"associated": 1.0}
        if self.config.track_aided:
            owners = self.paths.update([paths_m[rows] for rows in of_node], dt_s)
            for rows, ids in zip(of_node, owners, strict=True):
                associated[rows] = ids
            margins["associated"] = self.paths.margin

        points = self._points(paths_m, frame.weight, of_node, associated, margins)
        tracks: list[PathTrack] | list[Track]
        if self.config.track_aided:
            margins["tracks"] = self.paths.margin
            tracks = self.paths.tracks
            table_rows = [
                (t.id, t.state, *(t.filter.state[::2] + self.tx_m), *t.filter.state[1::2], t.misses)
                for t in tracks
            ]
            table = np.array(table_rows, np.float64).reshape(-1, 7)
        else:
            step = self.kalman.process(points[:, :2], dt_s)
            margins["tracks"], tracks, table = step.margin, step.tracks, track_rows(step)
        taps = {
            "frame": np.column_stack([frame.node_index, frame.path_m, frame.weight]),
            "associated": associated.astype(np.float64),
            "points": points,
            "tracks": table,
        }
        return ThroughWallHubFrame(closed.time_us, closed.number, taps, tracks, margins)

    def _points(
        self,
        paths_m: Array,
        weight: Array,
        of_node: list[NDArray[np.intp]],
        associated: NDArray[np.int64],
        margins: dict[str, float],
    ) -> Array:
        """Pair and locate what no track took: (n, 4) x, y [m], paths, least weight; mark it in associated."""
        free = [of_node[r][associated[of_node[r]] == 0] for r in self.outer]
        paired = self.pairing.process(*(paths_m[rows] / SPEED_OF_LIGHT_MPS for rows in free))
        margins["associated"] = min(margins["associated"], paired.margin)
        margins["points"] = paired.margin
        points: list[tuple[float, ...]] = []
        for number, couple in enumerate(paired.couples, start=1):
            located = self._locate(couple, -number, paths_m, weight, of_node, associated)
            fix = located[0]
            margins["points"] = min(margins["points"], fix.margin)
            edges = np.concatenate([fix.position_m - self.area_m[:2], self.area_m[2:] - fix.position_m])
            if fix.status != "fix":
                continue
            margins["points"] = min(margins["points"], float(np.min(np.abs(edges))))
            if np.any(edges < 0.0):
                continue
            if len(points) < self.max_points:
                points.append((*(fix.position_m + self.tx_m), *located[1:]))
            if self.config.track_aided:
                self.paths.begin(fix.position_m, fix.covariance_m2)
        margins["associated"] = min(margins["associated"], margins["points"])
        return np.array(points, np.float64).reshape(-1, 4)

    def _locate(
        self,
        couple: Couple,
        number: int,
        paths_m: Array,
        weight: Array,
        of_node: list[NDArray[np.intp]],
        associated: NDArray[np.int64],
    ) -> tuple[LineFix, int, float]:
        """Locate a couple and what it explains of further receivers' traces: fix, paths, least weight."""
        config = self.config
        n = len(self.rx_x_m)
        path_m, used, least = np.zeros(n), np.zeros(n), 0.0
        reach_m = SAME_TRACE / config.trace_pairing.clock_hz * SPEED_OF_LIGHT_MPS

        def use(r: int, expected_m: float, reach_m: float) -> None:
            nonlocal least
            many = config.trace_pairing.rule == "all_pairs"
            rows = [k for k in of_node[r] if (associated[k] <= 0 if many else associated[k] == 0)]
            apart = np.abs(paths_m[rows] - expected_m)
            if len(rows) == 0 or np.min(apart) >= reach_m:
                return
            k = rows[int(np.argmin(apart))]
            associated[k], path_m[r], used[r] = number, paths_m[k], 1.0
            least = weight[k] if least == 0.0 else min(least, weight[k])

        for r, delay_s in zip(self.outer, couple.delay_s, strict=True):
            use(r, delay_s * SPEED_OF_LIGHT_MPS, reach_m)
            path_m[r], used[r] = delay_s * SPEED_OF_LIGHT_MPS, 1.0
        fix = locate_on_line(config.line_locator, self.rx_x_m, path_m, used)
        if fix.status == "fix" and n > 2:
            predicted, gradient = path_and_gradient(config.line_locator.wall, fix.position_m, self.rx_x_m)
            for r in range(n):
                if r not in self.outer:
                    variance = (
                        gradient[r] @ fix.covariance_m2 @ gradient[r] + config.line_locator.path_std_m**2
                    )
                    use(r, predicted[r], BETWEEN_DEVIATIONS * float(np.sqrt(variance)))
            fix = locate_on_line(config.line_locator, self.rx_x_m, path_m, used)
        return fix, int(np.sum(used)), least
