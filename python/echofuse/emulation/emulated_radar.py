"""A site on firmware, with the same site in this process beside it: what differs between the two is counted.

The pictures' taps and the baseline's points come from the process, all that a run reports from the firmware.
"""

import math
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from echofuse.emulation import codec
from echofuse.emulation.deadline import Processor
from echofuse.emulation.firmware import FirmwareRadar
from echofuse.emulation.image_size import image_size
from echofuse.emulation.targets import BoardOpener, firmware_image, image_name
from echofuse.pipeline import SensorRadar, node_config
from echofuse.recording import NodeRecording
from echofuse.run_tables import FrameOutput, NodeOutput, Scan
from echofuse.site import Site

SAME_POSITION_M = 1e-3  # of one track on two targets


@dataclass
class Agreement:
    """How firmware and process compare, scan by scan and frame by frame."""

    scans: int = 0
    scans_differ: int = 0  # other detections: their number, or any delay or weight
    frames: int = 0
    frames_differ: int = 0  # other tracks: their number, id or state, or a position by over SAME_POSITION_M
    position_difference_m: float = 0.0  # the largest one of the frames whose tracks are the same

    def add_scan(self, here: NDArray[np.void], there: NDArray[np.void]) -> None:
        """Compare the detections of one scan, (n,) delay_s, weight."""
        self.scans += 1
        same = len(here) == len(there) and all(
            np.array_equal(here[name], there[name]) for name in ("delay_s", "weight")
        )
        self.scans_differ += not same

    def add_frame(self, here: NDArray[np.void], there: NDArray[np.void]) -> None:
        """Compare the tracks of one frame."""
        self.frames += 1
        if len(here) != len(there) or any(
            not np.array_equal(here[name], there[name]) for name in ("id", "state", "frames_since_update")
        ):
            self.frames_differ += 1
            return
        apart = np.zeros(len(here), np.float32)
        for name in ("x_m", "y_m", "z_m"):  # z: 0 of both where the hub is planar
            apart = np.hypot(apart, here[name] - there[name])
        largest = float(apart.max(initial=0.0))
        self.frames_differ += largest > SAME_POSITION_M
        self.position_difference_m = max(self.position_difference_m, largest)

    @property
    def same(self) -> bool:
        """Whether all decisions are the same."""
        return self.scans_differ == 0 and self.frames_differ == 0


class EmulatedRadar:
    """Nodes and hub of one site on boards of a target; takes the place of `pipeline.SensorRadar`."""

    def __init__(self, site: Site, sources: Sequence[NodeRecording], target: str) -> None:
        self._here = SensorRadar(site, sources)
        self._sources = tuple(sources)
        self._target, self._pipeline = target, site.pipeline
        self.hub_config = self._here.hub_config
        self.agreement = Agreement()
        self._frames_here: deque[FrameOutput] = deque()
        self._frames_there: deque[tuple[int, NDArray[np.void]]] = deque()
        self._open_board = BoardOpener(target, site.pipeline)
        self._there = FirmwareRadar(self._open_board)
        try:
            self._there.hub.configure(self.hub_config)
            places = {place.id: place for place in site.nodes}
            for source in sources:
                if source.node_id in places:
                    config = node_config(site, places[source.node_id], source)
                    empty_room = [] if source.reference is None else list(source.reference)
                    self._there.add_node(source.name, source.node_id, config, empty_room)
            self._open_board.check_all_taken(site.name)
        except BaseException:
            self.__exit__()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._there.close()
        self._open_board.close()

    def scan(self, scan: Scan, samples: NDArray[Any], *, taps: bool = False) -> NodeOutput:
        """Give both nodes their next scan; the firmware's detections, the process's taps."""
        here = self._here.scan(scan, samples, taps=taps)
        source = self._sources[scan.node]
        if source.node_id not in self._there.nodes:
            stranger = codec.Transfer(
                source.node_id,
                codec.DETECTIONS,
                scan.index,
                codec.detections_payload(scan.time_us, np.empty(0), np.empty(0)),
            )
            self._deliver(codec.frame(stranger), scan.time_us)
            return here
        values = np.ascontiguousarray(samples, np.float32)
        rows = self._there.scan(source.node_id, values, scan.time_us)
        self._collect()
        there = np.zeros(len(rows), here.detections.dtype)
        there["delay_s"], there["weight"] = rows["delay_s"], rows["weight"]
        self.agreement.add_scan(here.detections, there)
        return NodeOutput(detections=there, taps=here.taps)

    def frames(self, now_us: int) -> Iterator[FrameOutput]:
        """Yield the frames that both hubs have closed, with the firmware's tracks."""
        self._deliver(b"", now_us)
        self._frames_here.extend(self._here.frames(now_us))
        while self._frames_here and self._frames_there:
            here = self._frames_here.popleft()
            time_us, rows = self._frames_there.popleft()
            tracks = np.zeros(len(rows), here.tracks.dtype)
            for name in rows.dtype.names or ():
                tracks[name] = rows[name]
            self.agreement.add_frame(here.tracks, tracks)
            yield FrameOutput(time_us=time_us, points=here.points, tracks=tracks, taps=here.taps)

    def counters(self) -> dict[str, dict[str, int]]:
        """Return what the machines say that they have counted, by name; the firmware's."""
        return self._there.counters() | self._open_board.rejected

    def metrics(self, processor: Processor) -> dict[str, float]:
        """Return what the run cost on the target, and how far it agrees with the process."""
        agreed = self.agreement
        found: dict[str, float] = {
            "scans_that_differ": agreed.scans_differ,
            "frames_that_differ": agreed.frames_differ + len(self._frames_here) + len(self._frames_there),
            "position_difference_m": agreed.position_difference_m,
        }
        if self._target != "cortex-m7":
            return found
        instructions = self._there.instructions()
        stacks = {
            "node": [n.stack_bytes for n in self._there.nodes.values()],
            "hub": [self._there.hub.stack_bytes],
        }
        for role, prefix in (("node", ""), ("hub", "hub_")):
            size = image_size(firmware_image(self._target, image_name(self._pipeline, role)))
            found[f"{prefix}instructions_mean"] = (
                float(instructions[role].mean()) if len(instructions[role]) else 0.0
            )
            found[f"{prefix}instructions_max"] = float(instructions[role].max(initial=0))
            found[f"{prefix}ram_bytes"] = size.ram_bytes
            found[f"{prefix}flash_bytes"] = size.flash_bytes
            found[f"{prefix}stack_bytes"] = max(stacks[role], default=0)
            found[f"{prefix}time_max_s"] = float(processor.time_s(instructions[role]).max(initial=0.0))
        found["frame_period_s"] = self._frame_period_s()
        found["deadlines_missed"] = sum(
            int(np.count_nonzero(processor.time_s(instructions[role]) > found["frame_period_s"]))
            for role in ("node", "hub")
        )
        return found

    def _frame_period_s(self) -> float:
        """Return the shortest time between two scans of a node, which is what there is for each."""
        steps = [np.diff(source.time_s) for source in self._sources if len(source.time_s) > 1]
        return min((float(step.min()) for step in steps), default=math.inf)

    def _deliver(self, link: bytes, now_us: int) -> None:
        self._there.deliver(link, now_us)
        self._collect()

    def _collect(self) -> None:
        self._frames_there.extend((time_us, rows) for time_us, _, rows in self._there.take_tracks())
