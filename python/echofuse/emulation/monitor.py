"""Listens beside the hub, and says what it must have counted.

Independent of the machines: frames are read by the Python codec and reports lined up by the NumPy reference,
at the same virtual times. Whatever the target, its hub's counters have to be these.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict

import numpy as np

from echofuse.emulation import codec
from echofuse.emulation.reception import Receiver
from echofuse.reference.hub.measure.frame_assembler import FrameAssembler, FrameAssemblerConfig, Report

__all__ = ["HubMonitor"]


class HubMonitor:
    """One hub's expected counters, over all its lives."""

    def __init__(self, config: FrameAssemblerConfig, node_ids: Sequence[int]) -> None:
        self._config, self._node_ids = config, list(node_ids)
        self._earlier: Counter[str] = Counter()
        self._begin()

    def step(self, now_us: int, link_in: bytes) -> None:
        """Do what a hub does with its step."""
        self._poll(now_us)
        for transfer in self._receiver.feed(link_in, now_us):
            if transfer.port == codec.DETECTIONS and transfer.kind == codec.MESSAGE:
                time_us, rows = codec.parse_detections(transfer.payload)
                delay_s, weight = rows["delay_s"].astype(np.float64), rows["weight"].astype(np.float64)
                self._assembler.receive(
                    Report(transfer.source, transfer.transfer_id, delay_s, weight, time_us), now_us
                )
                self._poll(now_us)

    def restart(self) -> None:
        """Forget everything but what was counted, as a hub does that restarts."""
        self._earlier = Counter(self.expected())
        self._begin()

    def expected(self) -> dict[str, int]:
        """Return the counters by the names of NodeHealth, of all lives together."""
        now = Counter(asdict(self._assembler.counters))
        now["clock_faults"] = self._clock_faults
        now.update({f"link_{name}": count for name, count in self._receiver.counters().items()})
        now.update(self._earlier)
        return dict(now)

    def _begin(self) -> None:
        self._receiver = Receiver()
        self._assembler = FrameAssembler(self._config, self._node_ids)
        self._frame_us: int | None = None
        self._clock_faults = 0

    def _poll(self, now_us: int) -> None:
        while (closed := self._assembler.poll(now_us)) is not None:
            self._clock_faults += self._frame_us is not None and closed.time_us <= self._frame_us
            self._frame_us = closed.time_us
