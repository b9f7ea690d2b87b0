"""What a run's tracker is compared with: simpler ways, fed with the very same frames."""

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.errors import InputError, problem
from echofuse.recording import TRACK_DTYPE
from echofuse.site import PIPELINES, apply_settings

if TYPE_CHECKING:
    from echofuse.run_tables import FrameOutput

__all__ = ["WAYS", "Baseline", "BaselineFrame", "baseline_of"]

Rows = NDArray[np.float32]

#: What the ways behind a wall set of a hub, by the dimension of its positions and by name; the first way
#: stands beside the run's own. In the plane the through-wall paper's pairing and, as it compares, all pairs
#: of traces; in space the Taylor-series method (TSM) from either start, and the starts alone.
WAYS: dict[int, dict[str, dict[str, Any]]] = {
    2: {rule: {"trace_pairing": {"rule": rule}} for rule in ("assignment", "all_pairs")},
    3: {
        f"{prefix}{start}": {"taylor_3d": {"start": start, "max_iterations": iterations}}
        for prefix, iterations in (("tsm_from_", 20), ("", 0))
        for start in ("three_d_two_d", "approximate")
    },
}


@dataclass(frozen=True, kw_only=True)
class BaselineFrame:
    """What the simpler ways made of one frame."""

    tracks: NDArray[np.void]  # of the way that stands beside the run's own in every table
    points: Mapping[str, Rows] = field(default_factory=dict)  # as FrameOutput.points, by way
    way_tracks: Mapping[str, NDArray[np.void]] = field(default_factory=dict)  # by way


class Baseline(Protocol):
    """A tracker that sees what the configured one sees."""

    def process(self, frame: "FrameOutput", dt_s: float) -> BaselineFrame:
        """Take the next frame, dt_s after the one before [s]."""
        ...


def baseline_of(pipeline: str, config: Any) -> Baseline:
    """Return a pipeline's baseline; config: the hub's, None where there is no hub."""
    if config is None:
        return _Nothing()
    return _UnaidedHubs(pipeline, config) if hasattr(config, "track_aided") else _KalmanOnPoints(config)


class _Nothing:
    def process(self, frame: "FrameOutput", dt_s: float) -> BaselineFrame:
        return BaselineFrame(tracks=np.zeros(0, TRACK_DTYPE))


class _KalmanOnPoints:
    """Kalman filters with global nearest neighbour, on the points that the tracker was given."""

    def __init__(self, config: Any) -> None:
        self._tracker = _core.KalmanTracker()
        if self._tracker.configure(config.tracks) != _core.Status.ok:
            key = config.tracks.invalid_field()
            raise InputError(problem("site", f"pipeline.tracks.{key}", "a possible value"))

    def process(self, frame: "FrameOutput", dt_s: float) -> BaselineFrame:
        _, tracks = self._tracker.process(np.ascontiguousarray(frame.points[:, :2]), dt_s)
        return BaselineFrame(tracks=tracks)


class _UnaidedHubs:
    """The papers' ways behind a wall: pairing, then locating, then tracking what was located."""

    def __init__(self, pipeline: str, config: Any) -> None:
        self._node_ids = [node.node_id for node in config.nodes[: config.n_nodes]]
        self._hubs = {}
        for way, settings in WAYS[PIPELINES[pipeline].dimension].items():
            own = deepcopy(config)
            apply_settings(own, {"track_aided": False, **settings})
            hub = PIPELINES[pipeline].new_hub()
            if hub.configure(own) != _core.Status.ok:
                raise InputError(problem("site", f"pipeline.{own.invalid_field()}", "a possible value"))
            self._hubs[way] = hub
        self._frames = 0

    def process(self, frame: "FrameOutput", dt_s: float) -> BaselineFrame:
        """Give each hub the reports of this frame; without the tap `frame` there is nothing to say."""
        if "frame" not in frame.taps:
            return BaselineFrame(tracks=np.zeros(0, TRACK_DTYPE))
        points, tracks = {}, {}
        for way, hub in self._hubs.items():
            self._report(hub, frame)
            _, closed, taps = hub.poll_with_taps(frame.time_us)
            if closed is not None:
                points[way], tracks[way] = taps["points"], closed[2]
        self._frames += 1
        beside = tracks.get(next(iter(self._hubs)), np.zeros(0, TRACK_DTYPE))
        return BaselineFrame(tracks=beside, points=points, way_tracks=tracks)

    def _report(self, hub: Any, frame: "FrameOutput") -> None:
        heard = frame.taps["frame"]
        for index, node_id in enumerate(self._node_ids):
            rows = heard[heard[:, 0] == index]
            delay_s = np.ascontiguousarray(rows[:, 1] / np.float32(SPEED_OF_LIGHT_MPS))
            hub.receive(node_id, self._frames, delay_s, np.ascontiguousarray(rows[:, 2]), frame.time_us)
