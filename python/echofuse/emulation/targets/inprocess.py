"""The target `inprocess`: the compiled library through its bindings, behind the same bytes as firmware."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.emulation import codec
from echofuse.emulation.machine import Machine, ScanInput, StepOutput
from echofuse.emulation.reception import Receiver
from echofuse.pipeline import configured_hub, configured_node, hub_config, node_config, places_of
from echofuse.recording import NodeRecording
from echofuse.site import PIPELINES, Site

HUB_ID = 0xF000


class InProcessTarget:
    """Nodes and hub as objects of this process."""

    name = "inprocess"

    def __init__(self, site: Site, sources: Sequence[NodeRecording]) -> None:
        self._site, self._sources = site, tuple(sources)
        self._places = places_of(site, sources)

    def open_node(self, index: int) -> Machine:
        """Start a node; one that the site does not list reports that it has found nothing."""
        source = self._sources[index]
        place = self._places.get(source.node_id)
        if place is None:
            return InProcessNode(source.node_id, None)
        config = node_config(self._site, place, source)
        return InProcessNode(source.node_id, configured_node(self._site, config, source))

    def open_hub(self) -> Machine:
        """Start the hub."""
        dimension = PIPELINES[self._site.pipeline].dimension
        return InProcessHub(configured_hub(self._site, hub_config(self._site)), dimension)

    def close(self) -> None:
        """Nothing is held beside the machines."""


class InProcessNode:
    """One node. It does what firmware_sim/node_firmware.cpp does with a scan."""

    def __init__(self, node_id: int, node: "_core.SensorRadarNode | None") -> None:
        self._node_id, self._node = node_id, node
        self._reports = 0

    def step(
        self, now_us: int, link_in: bytes = b"", scan: ScanInput | None = None, *, taps: bool = False
    ) -> StepOutput:
        """Process a scan if there is one, and report it."""
        if scan is None:
            return StepOutput()
        nothing = np.zeros(0, np.float32)
        if self._node is None:
            return StepOutput(link_out=self._report(scan.time_us, nothing, nothing))
        tapped: dict[str, NDArray[np.float32]] = {}
        if taps:
            status, rows, tapped = self._node.process_with_taps(scan.samples, scan.time_us)
        else:
            status, rows = self._node.process(scan.samples, scan.time_us)
        if status == _core.Status.invalid_input or not self._node.report_ready():
            return StepOutput(taps=tuple(tapped.items()))
        report = self._report(scan.time_us, rows["delay_s"], rows["weight"])
        return StepOutput(link_out=report, taps=tuple(tapped.items()))

    def counters(self, now_us: int) -> dict[str, int]:
        """Return what the node has counted."""
        return {} if self._node is None else self._node.counters()

    def close(self) -> None:
        """Nothing is held."""

    def _report(self, time_us: int, delay_s: NDArray[np.float32], weight: NDArray[np.float32]) -> bytes:
        payload = codec.detections_payload(time_us, delay_s, weight)
        transfer = codec.Transfer(self._node_id, codec.DETECTIONS, self._reports, payload)
        self._reports += 1
        return codec.frame(transfer)


class InProcessHub:
    """The hub. It does what firmware_sim/hub_firmware.cpp does in a turn."""

    def __init__(self, hub: "_core.SensorRadarHub", dimension: int) -> None:
        """dimension: of the positions that it tells."""
        self._hub = hub
        self._subject = codec.SPATIAL_TRACKS if dimension == 3 else codec.TRACKS
        self._receiver = Receiver()

    def step(
        self, now_us: int, link_in: bytes = b"", scan: ScanInput | None = None, *, taps: bool = False
    ) -> StepOutput:
        """Close what is overdue, then take one message after the other."""
        said: list[bytes] = []
        shown: list[tuple[str, NDArray[np.float32]]] = []
        self._close_frames(now_us, said, shown)
        for transfer in self._receiver.feed(link_in, now_us):
            if transfer.port != codec.DETECTIONS or transfer.kind != codec.MESSAGE:
                continue
            time_us, rows = codec.parse_detections(transfer.payload)
            delay_s, weight = (np.ascontiguousarray(rows[name], np.float32) for name in ("delay_s", "weight"))
            # The hub counts what it does not take.
            frame = transfer.transfer_id & 0xFFFFFFFF
            self._hub.receive(transfer.source, frame, delay_s, weight, now_us, time_us)
            self._close_frames(now_us, said, shown)
        return StepOutput(link_out=b"".join(said), taps=shown)

    def counters(self, now_us: int) -> dict[str, int]:
        """Return what the hub has counted, of its link too."""
        return self._hub.counters() | {
            f"link_{name}": count for name, count in self._receiver.counters().items()
        }

    def close(self) -> None:
        """Nothing is held."""

    def _close_frames(
        self, now_us: int, said: list[bytes], shown: list[tuple[str, NDArray[np.float32]]]
    ) -> None:
        while True:
            _, closed, taps = self._hub.poll_with_taps(now_us)
            if closed is None:
                return
            time_us, frame, tracks = closed
            payload = codec.tracks_payload(time_us, frame, tracks, codec.TRACK_ROWS[self._subject])
            said.append(codec.frame(codec.Transfer(HUB_ID, self._subject, frame, payload)))
            shown.extend(taps.items())
