"""Nodes and hub of one site as firmware: scans in by the front-ends, everything else over the link."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echofuse.emulation import codec
from echofuse.emulation.codec import FrameReader, Transfer
from echofuse.emulation.lockstep import PROFILE_TOTAL, StepOutput
from echofuse.emulation.targets.boards import AnyBoard
from echofuse.errors import TargetError

HUB_ID = 0xF000
HARNESS_ID = 0xF001  # who writes the registers

CONFIG_STEP_US = 1  # the clock while a machine is configured: before everything


class Machine:
    """One board, what it says on the link, and what it counts."""

    def __init__(self, board: AnyBoard, node_id: int) -> None:
        self.board = board
        self.node_id = node_id
        self.health: dict[str, int] = {}
        self.profiles: list[
            dict[int, int]
        ] = []  # ticks by TapId that ended a stage, 255 for all; one a scan or frame
        self.stack_bytes = 0
        self._reader = FrameReader()
        self._requests: Counter[int] = Counter()
        self.config: Any = None  # that is in force

    def step(
        self,
        now_us: int,
        link: bytes = b"",
        *,
        scan: NDArray[np.float32] | None = None,
        scan_time_us: int = 0,
        taps: bool = False,
    ) -> tuple[StepOutput, list[Transfer]]:
        """Let the board work at one moment; what it did, and the transfers that it put on the link."""
        output = self.board.step(now_us, link, scan=scan, scan_time_us=scan_time_us, taps=taps)
        return output, self._heard(output)

    def ask_health(self, now_us: int) -> list[Transfer]:
        """Let the board say what it has counted, at this moment or later; all that it says then."""
        return self._heard(self.board.ask_health(now_us))

    def _heard(self, output: StepOutput) -> list[Transfer]:
        transfers = list(self._reader.feed(output.link))
        for transfer in transfers:
            if transfer.port == codec.NODE_HEALTH and transfer.kind == codec.MESSAGE:
                self.health = codec.parse_health(transfer.payload)
        if output.profile:
            self.profiles.append(output.profile)
            self.stack_bytes = output.stack_bytes or 0
        return transfers

    def write_register(self, name: str, value: object) -> object:
        """Write a register over the link; what it says then."""
        return self._access(name, codec.register_write(name, value))

    def read_register(self, name: str) -> object:
        """Read a register over the link; None when there is none of this name."""
        return self._access(name, codec.register_read(name))

    def configure(self, config: Any) -> None:
        """Write every member that differs from what is in force, put them there, and see that they are."""
        before = self.config if isinstance(self.config, type(config)) else type(config)()
        for name, value in _differences(config, before):
            said = self.write_register(name, value)
            if said is None or not np.isclose(float(said), float(value), rtol=1e-6):  # type: ignore[arg-type]
                raise TargetError(f"{self.board.name}: register {name} says {said} and not {value}")
        self.write_register("echofuse.apply", False)
        if self.write_register("echofuse.apply", True) is not True:
            self.step(CONFIG_STEP_US)
        if self.read_register("echofuse.apply") is not True:
            raise TargetError(f"{self.board.name}: refuses the site's configuration")
        self.config = deepcopy(config)

    def show_empty_room(self, scans: Sequence[NDArray[Any]]) -> None:
        """Give a node its scans of the empty room, (n_scans, n_samples), and see that it has taken them.

        A node whose pipeline has no use for them has no such register, and gets none.
        """
        left = "echofuse.empty_room_scans_left"
        if self.read_register(left) is None:
            return
        self.write_register(left, np.uint16(len(scans)))
        for scan in scans:
            self.step(CONFIG_STEP_US, scan=np.ascontiguousarray(scan, np.float32))
        if self.read_register(left) != 0:
            raise TargetError(f"{self.board.name}: has not taken the {len(scans)} scans of the empty room")

    @property
    def requests(self) -> int:
        """How many frames the harness has sent to configure it."""
        return sum(self._requests.values())

    def _access(self, name: str, request: bytes) -> object:
        service = codec.REGISTER_ACCESS
        self._requests[service] += 1
        asked = Transfer(HARNESS_ID, service, self._requests[service], request, codec.REQUEST, self.node_id)
        _, transfers = self.step(CONFIG_STEP_US, codec.frame(asked))
        for transfer in transfers:
            if transfer.kind == codec.RESPONSE and transfer.transfer_id == asked.transfer_id:
                return codec.parse_register(transfer.payload)
        raise TargetError(f"{self.board.name}: no answer about the register {name}")


def _differences(value: Any, default: Any, where: str = "") -> Iterator[tuple[str, Any]]:
    """Yield (register, value) for every member that a configuration sets."""
    if hasattr(value, "fields"):
        for name in value.fields():
            if name != "node_id" or where:  # a node's own id is its board's
                yield from _differences(
                    getattr(value, name), getattr(default, name), f"{where}.{name}".lstrip(".")
                )
    elif isinstance(value, Sequence):
        for index, (item, plain) in enumerate(zip(value, default, strict=True)):
            yield from _differences(item, plain, f"{where}.{index}")
    elif value != default:
        yield where, np.uint64(value) if where.endswith("seed") else value


class FirmwareRadar:
    """A site's nodes and hub on boards, fed scan by scan. A link without faults joins them in no time."""

    def __init__(self, open_board: Callable[[str, str, int], AnyBoard]) -> None:
        """open_board: starts the firmware of a role ("node", "hub") by a name and a node id."""
        self._open_board = open_board
        self.nodes: dict[int, Machine] = {}
        self.names: dict[int, str] = {}
        self.hub = Machine(open_board("hub", "hub", HUB_ID), HUB_ID)
        self._to_nodes: dict[int, bytes] = {}
        self._now_us = CONFIG_STEP_US
        self._tracks: list[tuple[int, int, NDArray[np.void]]] = []

    def add_node(self, name: str, node_id: int, config: Any, empty_room: Sequence[NDArray[Any]]) -> None:
        """Start a node, write its configuration, and show it the empty room, (n_scans, n_samples)."""
        machine = self.nodes[node_id] = Machine(self._open_board("node", name, node_id), node_id)
        self.names[node_id] = name
        self._to_nodes[node_id] = b""
        machine.configure(config)
        machine.show_empty_room(empty_room)

    def scan(self, node_id: int, samples: NDArray[np.float32], time_us: int) -> NDArray[np.void]:
        """Give a node its next scan (n_samples,), and the hub what it says; its detections (n,)."""
        waiting, self._to_nodes[node_id] = self._to_nodes[node_id], b""
        _, transfers = self.nodes[node_id].step(time_us, waiting, scan=samples, scan_time_us=time_us)
        detections = np.zeros(0, codec.DETECTION)
        for transfer in transfers:
            if transfer.port == codec.DETECTIONS and transfer.kind == codec.MESSAGE:
                _, detections = codec.parse_detections(transfer.payload)
        self.deliver(b"".join(map(codec.frame, transfers)), time_us)
        return detections

    def deliver(self, link: bytes, now_us: int) -> None:
        """Let the hub work at one moment, with what has arrived for it."""
        self._now_us = now_us
        _, transfers = self.hub.step(now_us, link)
        for transfer in transfers:
            report = codec.reported_tracks(transfer)
            if report is not None:
                self._tracks.append(report)
            elif transfer.port == codec.TIME:
                for node_id in self._to_nodes:
                    self._to_nodes[node_id] += codec.frame(transfer)

    def take_tracks(self) -> list[tuple[int, int, NDArray[np.void]]]:
        """Return what the hub has said since the last call: (time_us, frame, rows (n,)) a frame."""
        taken, self._tracks = self._tracks, []
        return taken

    def counters(self) -> dict[str, dict[str, int]]:
        """Let every machine say what it has counted; by machine and name."""
        self.hub.ask_health(self._now_us)
        for node_id, machine in self.nodes.items():
            machine.step(self._now_us, self._to_nodes[node_id])
            self._to_nodes[node_id] = b""
            machine.ask_health(self._now_us)
        return {"hub": self.hub.health} | {
            self.names[node_id]: machine.health for node_id, machine in self.nodes.items()
        }

    def instructions(self) -> dict[str, NDArray[np.int64]]:
        """Return the ticks of each scan of all nodes ("node"), and of each frame ("hub"), in order."""
        return {
            "node": np.array(
                [profile[PROFILE_TOTAL] for node in self.nodes.values() for profile in node.profiles],
                np.int64,
            ),
            "hub": np.array([profile[PROFILE_TOTAL] for profile in self.hub.profiles], np.int64),
        }

    def close(self) -> None:
        """Switch everything off."""
        for machine in (self.hub, *self.nodes.values()):
            machine.board.close()
