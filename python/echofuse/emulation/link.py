"""One node's way to the hub: carries whole frames, each with whatever happens to it."""

from collections.abc import Callable

import numpy as np

from echofuse.emulation.clock import VirtualClock
from echofuse.emulation.injection import Effect, InjectionLog
from echofuse.emulation.scenario import LinkFaults
from echofuse.emulation.streams import stream

__all__ = ["Link", "frames_in"]

Deliver = Callable[[bytes, bool], None]  # bytes, and whether they are an intact frame

_CHANCES = ("loss", "reorder", "doubled", "late")


def frames_in(data: bytes) -> list[bytes]:
    """Return the frames in what a machine put on the link, each with its delimiters."""
    return [b"\0" + part + b"\0" for part in data.split(b"\0") if part]


class Link:
    """A link; `deliver` is called at the virtual time at which bytes arrive.

    Nothing else happens to a lost frame; a damaged one is not doubled, a late one not overtaken on top.
    """

    def __init__(
        self,
        node: str,
        faults: LinkFaults,
        *,
        seed: int,
        log: InjectionLog,
        clock: VirtualClock,
        deliver: Deliver,
    ) -> None:
        self._node, self._faults, self._log, self._clock, self._deliver = node, faults, log, clock, deliver
        # What else a machine sends has streams of its own: the same reports are lost on every target.
        self._chance = {
            (name, report): stream(seed, f"link.{name}{'' if report else '.other'}", node)
            for name in (*_CHANCES, "bit_error_rate")
            for report in (True, False)
        }
        self._free_us = 0  # when the line is free again
        self._held: list[tuple[bytes, bool, bool]] = []  # frames that the next one overtakes
        for name in (*_CHANCES, "bit_error_rate"):
            if getattr(faults, name) > 0.0:
                log.want(f"link.{name}", "*")
        for name in ("latency_us", "bandwidth_bps"):
            if getattr(faults, name) > 0:
                log.want(f"link.{name}", node)

    def send(self, frame: bytes, *, report: bool) -> None:
        """Carry a frame, with its delimiters. report: whether the hub waits for it."""
        faults, now_us = self._faults, self._clock.now_us
        happens = {name: self._chance[name, report].random() < getattr(faults, name) for name in _CHANCES}
        flips = self._chance["bit_error_rate", report].random(8 * len(frame)) < faults.bit_error_rate
        if happens["loss"]:
            self._write("link.loss", Effect.MISSING if report else Effect.NOTHING)
            return
        intact = not flips.any()
        if not intact:
            detail = f"{int(flips.sum())} of {len(flips)} bits"
            self._write("link.bit_error_rate", Effect.DAMAGED if report else Effect.GARBAGE, detail)
            frame = (np.frombuffer(frame, np.uint8) ^ np.packbits(flips)).tobytes()
        copies = [frame] * (2 if happens["doubled"] and intact else 1)
        if len(copies) == 2:
            self._write("link.doubled", Effect.REPEATED if report else Effect.ECHOED)
        arrivals_us = [self._arrival_us(now_us, len(copy)) for copy in copies]
        if happens["late"]:
            self._write("link.late", Effect.DELAYED if report else Effect.NOTHING, f"{faults.late_us} us")
            arrivals_us = [arrival_us + faults.late_us for arrival_us in arrivals_us]
        elif happens["reorder"] and not self._held:
            self._held = [(copy, intact, report) for copy in copies]
            return
        for copy, arrival_us in zip(copies, arrivals_us, strict=True):
            self._arrive(arrival_us, copy, intact)
        self._release(arrivals_us[-1])

    def send_garbage(self, data: bytes) -> None:
        """Carry bytes that are no frame; nothing more happens to them."""
        self._arrive(self._arrival_us(self._clock.now_us, len(data)), data, False)

    def finish(self) -> None:
        """Let go of a frame that waits to be overtaken, when nothing more is sent."""
        self._release(self._clock.now_us)

    def _release(self, time_us: int) -> None:
        for copy, intact, _ in self._held:
            self._arrive(time_us, copy, intact)
        if self._held:
            self._write("link.reorder", Effect.DELAYED if self._held[0][2] else Effect.NOTHING)
        self._held = []

    def _arrival_us(self, now_us: int, n_bytes: int) -> int:
        """Return when a frame arrives that waits for those before it; the line is taken until it is out."""
        faults = self._faults
        begin_us = max(now_us, self._free_us)
        duration_us = round(8e6 * n_bytes / faults.bandwidth_bps) if faults.bandwidth_bps else 0
        self._free_us = begin_us + duration_us
        for name in ("latency_us", "bandwidth_bps"):
            if getattr(faults, name) > 0:
                self._log.count(f"link.{name}", self._node)
        return self._free_us + faults.latency_us

    def _arrive(self, time_us: int, data: bytes, intact: bool) -> None:
        self._clock.at(time_us, lambda: self._deliver(data, intact))

    def _write(self, kind: str, effect: Effect, detail: str = "") -> None:
        self._log.add(kind, self._node, self._clock.now_us, effect, detail)
