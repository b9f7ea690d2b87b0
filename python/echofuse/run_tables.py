"""Collects what nodes and hub say, scan by scan and frame by frame, into the tables of a run."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echofuse.baselines import baseline_of
from echofuse.recording import DETECTION_DTYPE, TRACK_DTYPE, Recording, frame_rows
from echofuse.result import ASSOCIATED_DTYPE, POINT_DTYPE, NodeStack, ResponseStack, RunResult
from echofuse.site import Site

__all__ = ["FrameOutput", "NodeOutput", "RunTables", "Scan", "Taps"]

Taps = dict[str, NDArray[np.float32]]

IMAGES = ("rotated", "subtracted", "enhanced")  # of a through-wall receiver
TRACES = ("target_traces", "leading_edges")  # in samples there
#: Taps of nodes that are kept of every scan, for the report.
STACKED = ("residual", "decisions", "range_clusters", *IMAGES, *TRACES, "detections")


@dataclass(frozen=True, kw_only=True)
class Scan:
    """One scan on its way to its node."""

    time_us: int
    node: int  # index into the recording's nodes
    index: int  # index into that node's scans


@dataclass(frozen=True, kw_only=True)
class NodeOutput:
    """What one node said about one scan."""

    detections: NDArray[np.void]  # delay_s, weight
    taps: Taps = field(default_factory=dict)  # when asked for


@dataclass(frozen=True, kw_only=True)
class FrameOutput:
    """What the hub said about one frame."""

    time_us: int
    points: NDArray[np.float32]  # (n, 4) x, y [m], members, weight; (n, 5) with z of a hub in space
    tracks: NDArray[np.void]
    taps: Taps = field(default_factory=dict)  # of the hub


class RunTables:
    """Collects the rows of a run."""

    def __init__(self, recording: Recording, config: Any) -> None:
        """config: the hub's, None where there is no hub."""
        self._recording = recording
        self._frame_period_s = 0.1 if config is None else float(config.frame_period_s)
        self._frame_time_us: list[int] = []
        self._points: list[NDArray[np.void]] = []
        self._tracks: list[NDArray[np.void]] = []
        self._baseline: list[NDArray[np.void]] = []
        self._waiting: list[NDArray[np.void]] = []  # detections since the last frame closed
        self._detections: list[NDArray[np.void]] = []
        self._taps: dict[int, list[Taps]] = {}
        self._shown: dict[str, Taps] = {}
        self._compared = baseline_of(recording.pipeline, config)
        self._compared_points: dict[str, list[NDArray[np.void]]] = {}
        self._compared_tracks: dict[str, list[NDArray[np.void]]] = {}
        self._associated: list[NDArray[np.void]] = []

    def add_scan(self, scan: Scan, output: NodeOutput, *, shown: bool) -> None:
        """Take what a node said of a scan; `shown` when the report's pictures are of this one."""
        rows = np.zeros(len(output.detections), DETECTION_DTYPE)
        rows["node"], rows["time_us"] = scan.node, scan.time_us
        rows["delay_s"], rows["weight"] = output.detections["delay_s"], output.detections["weight"]
        self._waiting.append(rows)
        if output.taps:
            self._taps.setdefault(scan.node, []).append(
                {name: output.taps[name] for name in STACKED if name in output.taps}
            )
            if shown:
                self._shown[self._recording.nodes[scan.node].name] = output.taps

    def add_frame(self, frame: FrameOutput) -> None:
        """Take what the hub said of a frame, and count the detections since the last one as its."""
        number = len(self._frame_time_us)
        last_us = self._frame_time_us[-1] if number else None
        self._frame_time_us.append(frame.time_us)
        for rows in self._waiting:
            rows["frame"] = number
        self._detections += self._waiting
        self._waiting = []
        self._points.append(_point_rows(number, frame.time_us, frame.points))
        self._tracks.append(self._track_rows(number, frame.time_us, frame.tracks))
        if "associated" in frame.taps:
            self._associated.append(_associated_rows(number, frame.taps))
        dt_s = self._frame_period_s if last_us is None else max((frame.time_us - last_us) * 1e-6, 1e-6)
        compared = self._compared.process(frame, dt_s)
        self._baseline.append(self._track_rows(number, frame.time_us, compared.tracks))
        for way, located in compared.points.items():
            table = self._compared_points.setdefault(way, [])
            table.append(_point_rows(number, frame.time_us, located))
        for way, tracks in compared.way_tracks.items():
            table = self._compared_tracks.setdefault(way, [])
            table.append(self._track_rows(number, frame.time_us, tracks))

    def _track_rows(self, frame: int, time_us: int, tracks: NDArray[np.void]) -> NDArray[np.void]:
        return frame_rows(tracks, TRACK_DTYPE, frame, time_us, pipeline=self._recording.pipeline)

    def result(self, site: Site, counters: dict[str, dict[str, int]], shown: int) -> RunResult:
        """Return everything that was collected; its metrics are still to be measured."""
        return RunResult(
            site=site,
            recording=self._recording,
            frame_time_us=np.array(self._frame_time_us, np.int64),
            detections=_joined(self._detections, DETECTION_DTYPE),
            points=_joined(self._points, POINT_DTYPE),
            tracks=_joined(self._tracks, TRACK_DTYPE),
            baseline_tracks=_joined(self._baseline, TRACK_DTYPE),
            compared_points={way: _joined(rows, POINT_DTYPE) for way, rows in self._compared_points.items()},
            compared_tracks={way: _joined(rows, TRACK_DTYPE) for way, rows in self._compared_tracks.items()},
            associated=_joined(self._associated, ASSOCIATED_DTYPE),
            metrics={},
            baseline_metrics={},
            counters=counters,
            **self._stacks(),
            shown_frame=max(shown, 0),
            shown_taps=self._shown,
        )

    def _stacks(self) -> dict[str, Any]:
        """Return `stacks` or `responses` of the result, as the nodes' taps are."""
        names = {node: self._recording.nodes[node].name for node in self._taps}
        if any("rotated" in tap for taps in self._taps.values() for tap in taps):
            return {"responses": {name: self._responses(node) for node, name in names.items()}}
        return {"stacks": {name: self._stack(node) for node, name in names.items()}}

    def _responses(self, node: int) -> ResponseStack:
        source = self._recording.nodes[node]
        taps = self._taps[node]
        turned = (len(tap["rotated"]) for tap in taps if "rotated" in tap)
        n_samples = next(turned, source.scans.shape[1])  # of a turned response that are kept
        nothing, none = np.zeros(n_samples, np.float32), np.zeros((0, 2))
        rate_hz = source.sample_rate_hz
        to_delay = dict.fromkeys(TRACES, np.array([1.0 / rate_hz, 1.0])) | {"detections": np.ones(2)}
        return ResponseStack(
            images={name: np.array([tap.get(name, nothing) for tap in taps]) for name in IMAGES},
            decisions=np.array([tap.get("decisions", nothing) for tap in taps]).astype(np.uint8),
            delays={
                name: [np.asarray(tap.get(name, none), np.float64).reshape(-1, 2) * scale for tap in taps]
                for name, scale in to_delay.items()
            },
            delay_s=np.arange(n_samples) / rate_hz,
        )

    def _stack(self, node: int) -> NodeStack:
        source = self._recording.nodes[node]
        n_samples = source.scans.shape[1]
        nothing = np.zeros(n_samples, np.float32)
        taps = self._taps[node]
        return NodeStack(
            residual=np.array([tap.get("residual", nothing) for tap in taps]),
            decisions=np.array([tap.get("decisions", nothing) for tap in taps]).astype(np.uint8),
            clusters=[tap.get("range_clusters", np.zeros((0, 4), np.float32)) for tap in taps],
            delay_s=source.first_sample_s + np.arange(n_samples) / source.sample_rate_hz,
        )


def _point_rows(frame: int, time_us: int, points: NDArray[np.float32]) -> NDArray[np.void]:
    rows = np.zeros(len(points), POINT_DTYPE)
    rows["frame"], rows["time_us"] = frame, time_us
    in_space = points.shape[1] == 5
    rows["z_m"] = np.nan
    for column, name in enumerate(("x_m", "y_m", *(("z_m",) if in_space else ()), "members", "weight")):
        rows[name] = points[:, column]
    return rows


def _associated_rows(frame: int, taps: Taps) -> NDArray[np.void]:
    rows = np.zeros(len(taps["frame"]), ASSOCIATED_DTYPE)
    rows["frame"], rows["owner"] = frame, taps["associated"]
    rows["node"], rows["path_m"] = taps["frame"][:, 0], taps["frame"][:, 1]
    return rows


def _joined(tables: Iterable[NDArray[np.void]], dtype: "np.dtype[np.void]") -> NDArray[np.void]:
    tables = list(tables)
    return np.concatenate(tables) if tables else np.zeros(0, dtype)
