"""Firmware beside the reference: configured by registers, its taps by the board's trace."""

from typing import Any

import numpy as np

from echofuse import _core
from echofuse.conformance.target import (
    HubAnswer,
    HubTarget,
    NodeAnswer,
    NodeTarget,
    Report,
    Scan,
    ScanTarget,
)
from echofuse.emulation import codec
from echofuse.emulation.firmware import HUB_ID, Machine
from echofuse.emulation.machine import by_frame, named_taps
from echofuse.emulation.targets import BoardOpener

PAUSE_US = 10_000_000  # between two inputs, longer than any link remembers a transfer


class FirmwareConformanceTarget:
    """Boards of one kind. One is used again for the next input, after it was configured anew."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._openers: dict[str, BoardOpener] = {}  # by pipeline
        self._free: dict[tuple[str, str], list[FirmwareUnderTest]] = {}  # by pipeline and role

    def node(self, config: "_core.SensorRadarNodeConfig") -> NodeTarget:
        """See `ConformanceTarget`."""
        return FirmwareNode(self, self._machine("sensor_radar", "node", config))

    def through_wall_node(self, config: "_core.ThroughWallNodeConfig") -> ScanTarget:
        """See `ConformanceTarget`."""
        return FirmwareNode(self, self._machine("through_wall_2d", "node", config))

    def hub(self, config: "_core.SensorRadarHubConfig") -> HubTarget:
        """See `ConformanceTarget`."""
        return FirmwareHub(self, self._machine("sensor_radar", "hub", config))

    def through_wall_hub(self, config: "_core.ThroughWallHubConfig") -> HubTarget:
        """See `ConformanceTarget`."""
        return FirmwareHub(self, self._machine("through_wall_2d", "hub", config))

    def through_wall_3d_hub(self, config: "_core.ThroughWall3dHubConfig") -> HubTarget:
        """See `ConformanceTarget`."""
        return FirmwareHub(self, self._machine("through_wall_3d", "hub", config))

    def give_back(self, machine: "FirmwareUnderTest") -> None:
        """Take a machine that has answered its input."""
        self._free[machine.pipeline, machine.role].append(machine)

    def close(self) -> None:
        """See `ConformanceTarget`."""
        for machines in self._free.values():
            while machines:
                machines.pop().machine.board.close()
        for opener in self._openers.values():
            opener.close()

    def _machine(self, pipeline: str, role: str, config: Any) -> "FirmwareUnderTest":
        free = self._free.setdefault((pipeline, role), [])
        machine = free.pop() if free else FirmwareUnderTest(self._opener(pipeline), pipeline, role)
        machine.configure(config)
        return machine

    def _opener(self, pipeline: str) -> BoardOpener:
        if pipeline not in self._openers:
            self._openers[pipeline] = BoardOpener(self.name, pipeline)
        return self._openers[pipeline]


class FirmwareUnderTest:
    """A board, and how far its clock is ahead of an input's."""

    def __init__(self, open_board: BoardOpener, pipeline: str, role: str) -> None:
        node_id = open_board.free_id() if role == "node" else HUB_ID
        self.pipeline, self.role = pipeline, role
        self.machine = Machine(open_board(role, role, node_id), node_id)
        self._begin_us = self._now_us = 0

    def configure(self, config: Any) -> None:
        """Put a configuration in force; nothing is left of what came before."""
        self._begin_us = self._now_us + PAUSE_US
        self.machine.configure(config)

    def step(
        self, time_us: int, link: bytes = b"", scan: Scan | None = None
    ) -> tuple[list[tuple[str, Any]], list[codec.Transfer]]:
        """Let the board work at a time of the input; its taps and its messages."""
        self._now_us = self._begin_us + time_us
        output, transfers = self.machine.step(
            self._now_us, link, scan=scan, scan_time_us=self._now_us, taps=True
        )
        messages = [transfer for transfer in transfers if transfer.kind == codec.MESSAGE]
        return named_taps(output.taps), messages

    def input_us(self, board_us: int) -> int:
        """Return the input's time of what the board's clock showed."""
        return board_us - self._begin_us


class FirmwareNode:
    """A node's firmware."""

    def __init__(self, target: FirmwareConformanceTarget, board: FirmwareUnderTest) -> None:
        self._target, self._board = target, board

    def set_empty_room(self, scan: Scan) -> None:
        """See `NodeTarget`."""
        self._board.machine.show_empty_room([scan])

    def process(self, scan: Scan, time_us: int) -> NodeAnswer | None:
        """See `NodeTarget`."""
        taps, messages = self._board.step(time_us, scan=scan)
        for transfer in messages:
            if transfer.port == codec.DETECTIONS:
                _, rows = codec.parse_detections(transfer.payload)
                columns = [rows[name].astype(np.float64) for name in ("delay_s", "weight")]
                return NodeAnswer(np.stack(columns, axis=1), dict(taps))
        return None

    def close(self) -> None:
        """See `NodeTarget`."""
        self._target.give_back(self._board)


class FirmwareHub:
    """A hub's firmware. It closes a frame as soon as it can; `poll` hands out what it has closed."""

    def __init__(self, target: FirmwareConformanceTarget, board: FirmwareUnderTest) -> None:
        self._target, self._board = target, board
        self._answers: list[HubAnswer] = []

    def receive(self, report: Report, now_us: int) -> None:
        """See `HubTarget`."""
        payload = codec.detections_payload(0, report.delay_s, report.weight)
        transfer = codec.Transfer(report.node_id, codec.DETECTIONS, report.frame, payload)
        self._step(now_us, codec.frame(transfer))

    def poll(self, now_us: int) -> HubAnswer | None:
        """See `HubTarget`."""
        if not self._answers:
            self._step(now_us, b"")
        return self._answers.pop(0) if self._answers else None

    def close(self) -> None:
        """See `HubTarget`."""
        self._target.give_back(self._board)

    def _step(self, now_us: int, link: bytes) -> None:
        shown, messages = self._board.step(now_us, link)
        frames = by_frame(shown)
        for transfer in messages:
            report = codec.reported_tracks(transfer)
            if report is not None:
                time_us, frame, tracks = report
                taps = next(frames, {})
                self._answers.append(HubAnswer(self._board.input_us(time_us), frame, tracks, taps))
