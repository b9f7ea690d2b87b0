"""Lines up the nodes' reports into frames: one frame holds each node's scan of the same instant."""

from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.hub.measure.measurement_selection import Frame

SPEED_OF_LIGHT_MPS = 299_792_458.0
OPEN_FRAMES = 3
FAR_FRAMES = 16


class FrameAssemblerConfig(Protocol):
    deadline_us: int
    dead_after_frames: int
    resync_after_reports: int
    max_delay_s: float


class Report(NamedTuple):
    """A node's report on one scan."""

    node_id: int
    frame: int
    delay_s: NDArray[np.float64]  # (n,) [s]
    weight: NDArray[np.float64]  # (n,)


class ClosedFrame(NamedTuple):
    time_us: int
    number: int
    frame: Frame


@dataclass
class Counters:
    accepted: int = 0
    late: int = 0
    early: int = 0
    doubled: int = 0
    malformed: int = 0
    unknown_node: int = 0
    lost: int = 0
    resynchronised: int = 0
    frames: int = 0
    absent: int = 0
    slow: int = 0


@dataclass
class _Node:
    offset: int | None = None  # hub's frame minus node's frame; None: to be learnt
    live: bool = True
    last_frame: int = -1
    out_of_step: int = 0
    missed: int = 0


@dataclass
class _OpenFrame:
    opened_us: int
    reports: dict[int, Report] = field(default_factory=dict)  # by node index


class FrameAssembler:
    """State: what each node's counter means, and the frames that are open, by number."""

    def __init__(self, config: FrameAssemblerConfig, node_ids: list[int]) -> None:
        self.config, self.node_ids = config, node_ids
        self.nodes = [_Node() for _ in node_ids]
        self.number = 0  # of the oldest frame that may still come
        self.open: dict[int, _OpenFrame] = {}
        self.newest: tuple[int, int] | None = None  # number and time [us] of the newest frame opened
        self.interval_us = 0  # usual time from frame to frame; 0: not known yet
        self.counters = Counters()

    def well_formed(self, report: Report) -> bool:
        delay, weight = report.delay_s, report.weight
        longest = np.float32(self.config.max_delay_s)
        return bool(
            np.all(np.isfinite(delay)) and np.all(delay >= 0) and np.all(delay <= longest)
            and np.all(np.diff(delay) >= 0) and np.all(np.isfinite(weight)) and np.all(weight >= 0)
        )  # fmt: skip

    def receive(self, report: Report, now_us: int) -> bool:
        """Whether the report was a good one of this site; what became of it is in the counters."""
        if report.node_id not in self.node_ids:
            self.counters.unknown_node += 1
            return False
        if not self.well_formed(report):
            self.counters.malformed += 1
            return False
        index = self.node_ids.index(report.node_id)
        node = self.nodes[index]
        if node.offset is not None and report.frame == node.last_frame:
            self.counters.doubled += 1
            return True
        if node.offset is None:
            node.offset = self._lined_up(index, report.frame, now_us)
        target = report.frame + node.offset
        if self._is_out_of_step(target, now_us):
            node.out_of_step += 1
            far = abs(target - self.number) > FAR_FRAMES
            if not far and node.out_of_step < self.config.resync_after_reports:
                if target < self.number:
                    self.counters.late += 1
                else:
                    self.counters.early += 1
                return True
            self.counters.resynchronised += 1
            node.out_of_step = 0
            node.offset = self._lined_up(index, report.frame, now_us)
            target = report.frame + node.offset
        if not self.open:
            while self.number < target:
                self._close({})
        if target not in self.open:
            self._learn_interval(target, now_us)
            self.open[target] = _OpenFrame(now_us)
        frame = self.open[target]
        if index in frame.reports:
            self.counters.doubled += 1
            return True
        frame.reports[index] = report
        node.last_frame, node.out_of_step, node.live = report.frame, 0, True
        self.counters.accepted += 1
        self.counters.slow += 2 * (now_us - frame.opened_us) > self.config.deadline_us
        return True

    def _lined_up(self, index: int, frame: int, now_us: int) -> int:
        """The offset that makes a report one of the frame that is open, or of the next one."""
        oldest = self.open.get(self.number)
        is_next = oldest is not None and (
            index in oldest.reports or 0 < self.interval_us < 2 * (now_us - oldest.opened_us)
        )
        return self.number + int(is_next) - frame

    def _is_out_of_step(self, target: int, now_us: int) -> bool:
        """Whether a report is not one of the frames that are open, and would open none that can be due."""
        if target < self.number or (self.open and target >= self.number + OPEN_FRAMES):
            return True
        if target in self.open or self.newest is None or self.interval_us == 0:
            return False
        number, opened_us = self.newest
        steps = target - number
        return steps > 0 and now_us - opened_us < (steps - 0.5) * self.interval_us

    def _learn_interval(self, number: int, now_us: int) -> None:
        if self.newest is not None:
            steps = number - self.newest[0]
            if steps <= 0:
                return
            step_us = (now_us - self.newest[1]) // steps
            change_us = int((step_us - self.interval_us) / 4)  # as integers divide in C++
            self.interval_us = step_us if self.interval_us == 0 else self.interval_us + change_us
        self.newest = (number, now_us)

    def poll(self, now_us: int) -> ClosedFrame | None:
        """The oldest frame, if all live nodes are in, it is overdue, or two newer ones exist."""
        if not self.open:
            return None
        while self.number not in self.open:
            self._close({})
        frame = self.open[self.number]
        complete = all(index in frame.reports for index, node in enumerate(self.nodes) if node.live)
        overdue = now_us - frame.opened_us >= self.config.deadline_us
        if not (complete or overdue or self.number + OPEN_FRAMES - 1 in self.open):
            return None
        number = self.number
        del self.open[number]
        self._close(frame.reports)
        self.counters.frames += 1
        rows = [
            (index, SPEED_OF_LIGHT_MPS * delay, weight)
            for index, report in sorted(frame.reports.items())
            for delay, weight in zip(report.delay_s, report.weight, strict=True)
        ]
        columns = np.array(rows, dtype=np.float64).reshape(-1, 3).T
        joined = Frame(columns[0].astype(np.intp), columns[1], columns[2], len(frame.reports))
        return ClosedFrame(frame.opened_us, number, joined)

    def _close(self, reports: dict[int, Report]) -> None:
        for index, node in enumerate(self.nodes):
            if index in reports:
                node.missed = 0
            elif node.live:
                self.counters.lost += 1
                node.missed += 1
                node.live = node.missed < self.config.dead_after_frames
            else:
                self.counters.absent += 1
        self.number += 1
