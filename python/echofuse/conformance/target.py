"""What can be compared with the reference: the library in this process, and whatever else answers alike."""

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse import _core

Scan = NDArray[np.float32]
Taps = dict[str, NDArray[np.float32]]


@dataclass
class NodeAnswer:
    """What a node said about one complete scan."""

    detections: NDArray[np.float64]  # (n, 2) delay [s], weight
    taps: Taps = field(default_factory=dict)  # by the names of TapId


class ScanTarget(Protocol):
    """A configured node of any pipeline."""

    def process(self, scan: Scan, time_us: int) -> NodeAnswer | None:
        """Take scan (n_samples,) [count]; an answer when it completes the pulses of a scan."""

    def close(self) -> None:
        """Give it back."""


class NodeTarget(ScanTarget, Protocol):
    """A configured node of the sensor radar."""

    def set_empty_room(self, scan: Scan) -> None:
        """Average one scan (n_samples,) [count] of the empty room into the background."""


@dataclass(frozen=True)
class Report:
    """One node's report on one scan, as the hub gets it."""

    node_id: int
    frame: int  # counts the node's scans
    delay_s: NDArray[np.float32]  # (n,) ascending
    weight: NDArray[np.float32]  # (n,)


@dataclass
class HubAnswer:
    """What a hub said about one frame."""

    time_us: int
    frame: int
    tracks: NDArray[np.void]  # fields of link::Track
    taps: Taps = field(default_factory=dict)


class HubTarget(Protocol):
    """A configured hub."""

    def receive(self, report: Report, now_us: int) -> None:
        """Take a report, good or bad."""

    def poll(self, now_us: int) -> HubAnswer | None:
        """Work on the oldest frame that is closed by now, if there is one."""

    def close(self) -> None:
        """Give it back."""


class ConformanceTarget(Protocol):
    """A machine that runs the pipeline."""

    name: str

    def node(self, config: "_core.SensorRadarNodeConfig") -> NodeTarget:
        """Return a node configured and forgetful."""

    def through_wall_node(self, config: "_core.ThroughWallNodeConfig") -> ScanTarget:
        """Return a receiver configured and forgetful."""

    def hub(self, config: "_core.SensorRadarHubConfig") -> HubTarget:
        """Return a hub configured and forgetful."""

    def through_wall_hub(self, config: "_core.ThroughWallHubConfig") -> HubTarget:
        """Return a hub of receivers configured and forgetful."""

    def through_wall_3d_hub(self, config: "_core.ThroughWall3dHubConfig") -> HubTarget:
        """Return a hub of a cross of receivers configured and forgetful."""

    def close(self) -> None:
        """End all machines."""


class InProcessScans:
    """A node of the library in this process."""

    def __init__(self, node: Any, config: Any) -> None:
        self._node = node
        _expect(node.configure(config), f"configure, {config.invalid_field()}")

    def process(self, scan: Scan, time_us: int) -> NodeAnswer | None:
        """See `ScanTarget`."""
        status, detections, taps = self._node.process_with_taps(scan, time_us)
        _expect(status, "process", _core.Status.truncated)
        if not self._node.report_ready():
            return None
        return NodeAnswer(_columns(detections, "delay_s", "weight"), taps)

    def close(self) -> None:
        """Nothing is held."""


class InProcessNode(InProcessScans):
    """The library's sensor-radar node in this process."""

    def set_empty_room(self, scan: Scan) -> None:
        """See `NodeTarget`."""
        _expect(self._node.set_empty_room(scan), "set_empty_room")


class InProcessHub:
    """A hub of the library in this process."""

    def __init__(self, hub: Any, config: Any) -> None:
        self._hub = hub
        _expect(self._hub.configure(config), f"configure, {config.invalid_field()}")

    def receive(self, report: Report, now_us: int) -> None:
        """See `HubTarget`."""
        status = self._hub.receive(report.node_id, report.frame, report.delay_s, report.weight, now_us)
        _expect(status, "receive", _core.Status.invalid_input)

    def poll(self, now_us: int) -> HubAnswer | None:
        """See `HubTarget`."""
        status, closed, taps = self._hub.poll_with_taps(now_us)
        _expect(status, "poll", _core.Status.truncated)
        if closed is None:
            return None
        time_us, frame, tracks = closed
        return HubAnswer(time_us, frame, tracks, taps)

    def close(self) -> None:
        """Nothing is held."""


class InProcessTarget:
    """The library in this process."""

    name = "inprocess"

    def node(self, config: "_core.SensorRadarNodeConfig") -> NodeTarget:
        """See `ConformanceTarget`."""
        return InProcessNode(_core.SensorRadarNode(), config)

    def through_wall_node(self, config: "_core.ThroughWallNodeConfig") -> ScanTarget:
        """See `ConformanceTarget`."""
        return InProcessScans(_core.ThroughWallNode(), config)

    def hub(self, config: "_core.SensorRadarHubConfig") -> HubTarget:
        """See `ConformanceTarget`."""
        return InProcessHub(_core.SensorRadarHub(), config)

    def through_wall_hub(self, config: "_core.ThroughWallHubConfig") -> HubTarget:
        """See `ConformanceTarget`."""
        return InProcessHub(_core.ThroughWallHub(), config)

    def through_wall_3d_hub(self, config: "_core.ThroughWall3dHubConfig") -> HubTarget:
        """See `ConformanceTarget`."""
        return InProcessHub(_core.ThroughWall3dHub(), config)

    def close(self) -> None:
        """Nothing is held."""


def _expect(status: Any, what: str, *others: Any) -> None:
    if status not in (_core.Status.ok, *others):
        raise RuntimeError(f"the target refuses to {what}: {status}")


def _columns(table: NDArray[Any], *names: str) -> NDArray[np.float64]:
    return np.stack([table[name].astype(np.float64) for name in names], axis=1)
