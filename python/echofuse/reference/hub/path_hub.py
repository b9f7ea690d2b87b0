"""What the hubs of antennas before a wall have in common, in the plane and in space."""

from types import SimpleNamespace
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.reference.hub.locate.wall import WallConfig
from echofuse.reference.hub.measure.frame_assembler import FrameAssembler, FrameAssemblerConfig, Report
from echofuse.reference.hub.measure.frame_clock import FrameClock
from echofuse.reference.hub.measure.trace_pairing import Couple, TracePairing, TracePairingConfig
from echofuse.reference.hub.track.kalman_tracker import KalmanTracker
from echofuse.reference.hub.track.path_tracker import PathTrack, PathTracker, PathTrackerConfig
from echofuse.reference.hub.track.track_manager import Track, TrackManagerConfig

Array = NDArray[np.float64]

SAME_TRACE = 0.5  # [sample] a couple's delay is this trace's


class PathHubConfig(Protocol):
    frame_period_s: float
    body_radius_m: float
    track_aided: bool
    frame_assembler: FrameAssemblerConfig
    trace_pairing: TracePairingConfig
    path_tracker: PathTrackerConfig
    tracks: TrackManagerConfig


class PathHubFrame(NamedTuple):
    """Everything that one frame went through."""

    time_us: int
    number: int
    taps: dict[str, Array]  # by the names of TapId
    tracks: list[PathTrack] | list[Track]
    margins: dict[str, float]  # by tap


class OpenFrame:
    """A frame's detections, who took them, and the targets that were found in what was left."""

    def __init__(self, n_receivers: int, node_index: NDArray[np.intp], paths_m: Array, weight: Array) -> None:
        self.n_receivers, self.paths_m, self.weight = n_receivers, paths_m, weight
        self.of_node = [np.flatnonzero(node_index == r) for r in range(n_receivers)]
        self.associated = np.zeros(len(paths_m), np.int64)  # id of a track, -k of the k-th target, 0
        self.margins = {"associated": 1.0, "points": 1.0}
        self.n_targets = 0
        self.points: list[tuple[float, ...]] = []

    def free_delays(self, receiver: int) -> Array:
        """Of a receiver's detections that nothing took (n,) [s]."""
        rows = self.of_node[receiver]
        return np.asarray(self.paths_m[rows[self.associated[rows] == 0]] / SPEED_OF_LIGHT_MPS)

    def decide(self, tap: str, margin: float) -> None:
        """Take in how near a decision was to another."""
        self.margins[tap] = min(self.margins[tap], margin)


class Target:
    """What a target consists of: a path (n,) [m] of each receiver where used (n,) is 1; least weight."""

    def __init__(self, frame: OpenFrame, config: TracePairingConfig) -> None:
        self.frame, self.config = frame, config
        frame.n_targets += 1
        self.path_m, self.used, self.weight = np.zeros(frame.n_receivers), np.zeros(frame.n_receivers), 0.0

    def take(self, couple: Couple, receivers: tuple[int, int]) -> None:
        """Take both traces of a couple; of a completed one a trace is no detection."""
        reach_m = SAME_TRACE / self.config.clock_hz * SPEED_OF_LIGHT_MPS
        for r, delay_s in zip(receivers, couple.delay_s, strict=True):
            self.use(r, delay_s * SPEED_OF_LIGHT_MPS, reach_m)
            self.path_m[r], self.used[r] = delay_s * SPEED_OF_LIGHT_MPS, 1.0

    def use(self, r: int, expected_m: float, reach_m: float) -> None:
        """Take the available detection that is nearest to a path, if there is one within reach."""
        frame, many = self.frame, self.config.rule == "all_pairs"
        available = frame.associated <= 0 if many else frame.associated == 0
        rows = [k for k in frame.of_node[r] if available[k]]
        apart = np.abs(frame.paths_m[rows] - expected_m)
        if len(rows) == 0 or np.min(apart) >= reach_m:
            return
        k = rows[int(np.argmin(apart))]
        frame.associated[k], self.path_m[r], self.used[r] = -frame.n_targets, frame.paths_m[k], 1.0
        weight = float(frame.weight[k])
        self.weight = weight if self.weight == 0.0 else min(self.weight, weight)


class PathHub:
    """State: open frames, the last couples, tracks. A hub defines how targets are found in what is left."""

    def __init__(
        self,
        config: PathHubConfig,
        wall: WallConfig,
        node_ids: list[int],
        tx_m: Array,
        rx_m: Array,
        area_m: Array,
        *,
        max_points: int,
        max_tracks: int,
    ) -> None:
        """tx_m (d,); rx_m (n, d) from there; area_m (2 d,): least x, y, (z), then most [m]."""
        self.settings, self.max_points = config, max_points
        self.tx_m, d = tx_m, len(tx_m)
        self.area_m = area_m - np.tile(tx_m, 2)
        margin_m = config.body_radius_m * np.array([1.0, 1.0, 0.0])[:d]
        inner_m = self.area_m + np.concatenate([margin_m, -margin_m])
        self.assembler = FrameAssembler(config.frame_assembler, node_ids)
        self.clock = FrameClock()
        self.paths = PathTracker(config.path_tracker, wall, rx_m, inner_m, config.body_radius_m)
        self.kalman = KalmanTracker(
            SimpleNamespace(**(vars(config.tracks) | {"update": "kalman"})), max_tracks
        )

    def trace_pairing(self, separation_m: float) -> TracePairing:
        """Return the pairing of two receivers; tracks complete couples themselves, and better."""
        pairing = vars(self.settings.trace_pairing) | {"separation_m": separation_m}
        if self.settings.track_aided:
            pairing["completion_limit"] = 0
        return TracePairing(SimpleNamespace(**pairing))

    def find_targets(self, frame: OpenFrame) -> None:
        """Find targets in what no track took, and keep() where they are."""
        raise NotImplementedError

    def receive(self, report: Report, now_us: int) -> bool:
        """Whether the report was a good one of this site."""
        return self.assembler.receive(report, now_us)

    def poll(self, now_us: int) -> PathHubFrame | None:
        """Work on the oldest frame if it is complete or overdue."""
        closed = self.assembler.poll(now_us)
        if closed is None:
            return None
        heard, config = closed.frame, self.settings
        dt_s = self.clock.step_s(closed.time_us, config.frame_period_s)
        paths_m = heard.path_m + 2.0 * config.body_radius_m
        frame = OpenFrame(len(self.paths.rx_m), heard.node_index, paths_m, heard.weight)
        if config.track_aided:
            owners = self.paths.update([paths_m[rows] for rows in frame.of_node], dt_s)
            for rows, ids in zip(frame.of_node, owners, strict=True):
                frame.associated[rows] = ids
            frame.decide("associated", self.paths.margin)

        self.find_targets(frame)
        frame.decide("associated", frame.margins["points"])
        d = len(self.tx_m)
        points = np.array(frame.points, np.float64).reshape(-1, d + 2)
        tracks: list[PathTrack] | list[Track]
        if config.track_aided:
            frame.margins["tracks"], tracks = self.paths.margin, self.paths.tracks
            table = [self._row(t, self.tx_m, t.misses) for t in self.paths.tracks]
        else:
            step = self.kalman.process(points[:, :d], dt_s)
            frame.margins["tracks"], tracks = step.margin, step.tracks
            table = [self._row(t, np.zeros(d), t.frames_since_update) for t in step.tracks]
        taps = {
            "frame": np.column_stack([heard.node_index, heard.path_m, heard.weight]),
            "associated": frame.associated.astype(np.float64),
            "points": points,
            "tracks": np.array(table, np.float64).reshape(-1, 2 * d + 3),
        }
        return PathHubFrame(closed.time_us, closed.number, taps, tracks, frame.margins)

    def _row(self, track: PathTrack | Track, origin_m: Array, misses: int) -> tuple[float, ...]:
        """Of the tap `tracks`."""
        place = track.filter.position + origin_m
        return (track.id, track.state, *place, *track.filter.velocity, misses)

    def keep(self, frame: OpenFrame, target: Target, position_m: Array, covariance_m2: Array) -> None:
        """In the room, a position (d,) from the transmitter is a point, and begins a track."""
        d = len(position_m)
        edges = np.concatenate([position_m - self.area_m[:d], self.area_m[d:] - position_m])
        frame.decide("points", float(np.min(np.abs(edges))))
        if np.any(edges < 0.0):
            return
        frame.points.append((*(position_m + self.tx_m), float(np.sum(target.used)), target.weight))
        if self.settings.track_aided:
            self.paths.begin(position_m, covariance_m2)
