"""Lines up the nodes' reports into frames: one frame holds each node's scan of the same instant."""

from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.hub.measure.measurement_selection import Frame

SPEED_OF_LIGHT_MPS = 299_792_458.0
OPEN_FRAMES = 3
FAR_FRAMES = 16  # farther behind than any link delays a report
LAG_LEAK = 1024  # a node's clock may lose one part in so many against the hub's
INTERVAL_LEAST_US, INTERVAL_MOST_US = 1_000, 10_000_000


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
    time_us: int = 0  # of the scan, the node's clock; 0: not known


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
class _Heard:
    """A node's newest report."""

    frame: int  # by the node's counter
    time_us: int  # by its clock
    arrived_us: int
    lag_us: (
        int  # least time from clock to arrival so far: the clock's offset and what the link takes at least
    )
    number: int  # of the frame it belongs to


@dataclass
class _Node:
    heard: _Heard | None = None
    offset: int | None = None  # number minus frame of its report accepted last, modulo 2^32
    live: bool = True
    out_of_step: int = 0  # reports in a row
    missed: int = 0  # frames in a row


@dataclass
class _OpenFrame:
    opened_us: int
    reports: dict[int, Report] = field(default_factory=dict)  # by node index


class FrameAssembler:
    """State: where each node's newest report belongs, and the frames that are open, by number."""

    def __init__(self, config: FrameAssemblerConfig, node_ids: list[int]) -> None:
        self.config, self.node_ids = config, node_ids
        self.nodes = [_Node() for _ in node_ids]
        self.number = 0  # of the oldest frame that may still come
        self.open: dict[int, _OpenFrame] = {}
        self.interval_us = 0  # usual time from frame to frame; 0: not known yet
        self.odd_intervals = 0  # in a row that were not like it
        self.counters = Counters()

    def well_formed(self, report: Report) -> bool:
        delay, weight = report.delay_s, report.weight
        longest = np.float32(self.config.max_delay_s)
        return bool(
            np.all(np.isfinite(delay)) and np.all(delay >= 0) and np.all(delay <= longest)
            and np.all(np.diff(delay) >= 0) and np.all(np.isfinite(weight)) and np.all(weight >= 0)
            and 0 <= report.time_us < 2**56
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
        if node.heard is not None and report.frame == node.heard.frame:
            self.counters.doubled += 1
            return True
        number = self._placed(index, report.frame, report.time_us or now_us, now_us)
        if number < self.number:
            self._late(node)
            return True
        if self.open and number >= self.number + OPEN_FRAMES:
            self.counters.early += 1
            return True
        if not self.open:
            while self.number < number:
                self._close({})
        if number not in self.open:
            self.open[number] = _OpenFrame(now_us)
            if not any(other.live for other in self.nodes):
                for other in self.nodes:  # all were away: so all may be back
                    other.live, other.missed = True, 0
        frame = self.open[number]
        if index in frame.reports:
            self.counters.doubled += 1
            node.out_of_step += 1
            return True
        frame.reports[index] = report
        offset = (number - report.frame) % 2**32
        self.counters.resynchronised += node.offset not in (None, offset)
        node.offset, node.out_of_step, node.live = offset, 0, True
        self.counters.accepted += 1
        self.counters.slow += 2 * (now_us - frame.opened_us) > self.config.deadline_us
        return True

    def _late(self, node: _Node) -> None:
        self.counters.late += 1
        if not node.live:  # nobody waited for it: the next frame does, and gives up at once if it is in vain
            node.live, node.missed = True, self.config.dead_after_frames - 1

    def _placed(self, index: int, frame: int, time_us: int, now_us: int) -> int:
        """The number of the frame that a scan belongs to; the node's newest report is of this scan."""
        node = self.nodes[index]
        lag_us = now_us - time_us
        if node.heard is not None:
            self._learn_interval(frame - node.heard.frame, time_us - node.heard.time_us)
            leak_us = (now_us - node.heard.arrived_us) // LAG_LEAK
            lag_us = min(lag_us, node.heard.lag_us + leak_us)
        number = self._due(index, time_us + lag_us)
        if number < self.number:
            node.out_of_step += 1
            far = self.number - number > FAR_FRAMES
            if far or node.out_of_step >= self.config.resync_after_reports:  # its clock is another one
                lag_us, node.out_of_step = now_us - time_us, 0
                number = self._due(index, now_us)
        node.heard = _Heard(frame, time_us, now_us, lag_us, number)
        return number

    def _due(self, index: int, scan_us: int) -> int:
        """The number of the frame at a time of the hub's clock: the median of what the other nodes say."""
        heard = [(i, node.heard) for i, node in enumerate(self.nodes) if node.heard is not None]
        if not heard or self.interval_us == 0:
            return max(self.open, default=self.number)
        newest = max(other.number for _, other in heard)
        recent = [(i, other) for i, other in heard if newest - other.number <= FAR_FRAMES]
        others = [other for i, other in recent if i != index] or [other for _, other in recent]
        since_us = sorted(
            (other.number - newest) * self.interval_us + scan_us - (other.time_us + other.lag_us)
            for other in others
        )
        median_us = since_us[(len(since_us) - 1) // 2]
        return newest + (2 * median_us + self.interval_us) // (2 * self.interval_us)

    def _learn_interval(self, frames: int, elapsed_us: int) -> None:
        frames = (frames + 2**31) % 2**32 - 2**31  # counters wrap
        if not 1 <= frames <= FAR_FRAMES or elapsed_us <= 0:
            return
        interval_us = elapsed_us // frames
        if not INTERVAL_LEAST_US <= interval_us <= INTERVAL_MOST_US:
            return
        change_us = interval_us - self.interval_us
        if 4 * abs(change_us) <= self.interval_us:
            self.interval_us += int(change_us / 8)  # as integers divide in C++
            self.odd_intervals = 0
            return
        self.odd_intervals += (
            1  # a scan missed or counted twice, a clock that is set; or all have another pace
        )
        if self.interval_us == 0 or self.odd_intervals >= 2 * len(self.nodes):
            self.interval_us, self.odd_intervals = interval_us, 0

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
