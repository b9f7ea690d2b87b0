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
from echofuse.site import PIPELINES

if TYPE_CHECKING:
    from echofuse.run_tables import FrameOutput

__all__ = ["Baseline", "BaselineFrame", "baseline_of"]

Rows = NDArray[np.float32]


@dataclass(frozen=True, kw_only=True)
class BaselineFrame:
    """What the simpler ways made of one frame."""

    tracks: NDArray[np.void]
    points: Mapping[str, Rows] = field(default_factory=dict)  # as FrameOutput.points, by way


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
    """The through-wall paper's way, pairing and then locating and tracking, and the same with all pairs."""

    def __init__(self, pipeline: str, config: Any) -> None:
        self._node_ids = [node.node_id for node in config.nodes[: config.n_nodes]]
        self._hubs = {}
        for rule in (_core.PairingRule.assignment, _core.PairingRule.all_pairs):
            own = deepcopy(config)
            own.track_aided = False
            own.trace_pairing.rule = rule
            hub = PIPELINES[pipeline].new_hub()
            if hub.configure(own) != _core.Status.ok:
                raise InputError(problem("site", f"pipeline.{own.invalid_field()}", "a possible value"))
            self._hubs[rule.name] = hub
        self._frames = 0

    def process(self, frame: "FrameOutput", dt_s: float) -> BaselineFrame:
        """Give each hub the reports of this frame; without the tap `frame` there is nothing to say."""
        if "frame" not in frame.taps:
            return BaselineFrame(tracks=np.zeros(0, TRACK_DTYPE))
        tracks, points = np.zeros(0, TRACK_DTYPE), {}
        for rule, hub in self._hubs.items():
            self._report(hub, frame)
            _, closed, taps = hub.poll_with_taps(frame.time_us)
            if closed is None:
                continue
            points[rule] = taps["points"]
            if rule == _core.PairingRule.assignment.name:
                tracks = closed[2]
        self._frames += 1
        return BaselineFrame(tracks=tracks, points=points)

    def _report(self, hub: Any, frame: "FrameOutput") -> None:
        heard = frame.taps["frame"]
        for index, node_id in enumerate(self._node_ids):
            rows = heard[heard[:, 0] == index]
            delay_s = np.ascontiguousarray(rows[:, 1] / np.float32(SPEED_OF_LIGHT_MPS))
            hub.receive(node_id, self._frames, delay_s, np.ascontiguousarray(rows[:, 2]), frame.time_us)
