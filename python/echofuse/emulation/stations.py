"""A machine in an emulation: switched on, off and on again, and what it counted in all its lives."""

from collections import Counter
from collections.abc import Callable

from echofuse.emulation import codec
from echofuse.emulation.injection import Effect, InjectionLog
from echofuse.emulation.link import Link, frames_in
from echofuse.emulation.machine import Machine, ScanInput, StepOutput
from echofuse.emulation.radar import RadarEvent, clock_us
from echofuse.emulation.scenario import Fault, RadarFaults
from echofuse.emulation.streams import stream

__all__ = ["NodeStation", "Station", "is_report"]

#: Faults that cut off what a node sends, and those that end its machine.
_ON_THE_LINK = ("silent", "garbage")
_OF_THE_MACHINE = ("crash", "restart")


class Station:
    """The place of one machine."""

    def __init__(self, open_machine: Callable[[], Machine]) -> None:
        self._open_machine = open_machine
        self._counted: Counter[str] = Counter()
        self.machine: Machine | None = None
        self.profiles: list[dict[str, int]] = []  # ticks by stage of each scan or frame, and their "total"
        self.switch_on()

    def switch_on(self) -> None:
        """Start the machine, which knows nothing of an earlier life."""
        self.machine = self._open_machine()
        self._counted["starts"] += 1

    def machine_us(self, now_us: int) -> int:
        """Return what the machine's clock shows at a virtual time [us]."""
        return now_us

    def switch_off(self, now_us: int) -> None:
        """Take what the machine has counted, and end it."""
        if self.machine is not None:
            self._counted.update(self.machine.counters(self.machine_us(now_us)))
            self.machine.close()
        self.machine = None

    def counters(self) -> dict[str, int]:
        """Return what all lives that have ended have counted, and how many there were (`starts`)."""
        return dict(self._counted)

    def close(self) -> None:
        """Give the machine back, whatever its state."""
        if self.machine is not None:
            self.machine.close()
        self.machine = None

    def keep_profile(self, output: StepOutput) -> None:
        """Keep what a step took, if the target counts."""
        if output.total_ticks is not None:
            self.profiles.append(output.profile | {"total": output.total_ticks})


class NodeStation(Station):
    """A node, its clock, and its way to the hub."""

    def __init__(
        self,
        name: str,
        open_machine: Callable[[], Machine],
        *,
        radar: RadarFaults,
        faults: tuple[Fault, ...],
        link: Link,
        seed: int,
        log: InjectionLog,
        begin_us: int,
    ) -> None:
        super().__init__(open_machine)
        self.name, self.link = name, link
        self.reports_made = 0
        self._radar, self._faults, self._log, self._begin_us = radar, faults, log, begin_us
        self._garbage = stream(seed, "fault.garbage", name)

    def machine_us(self, now_us: int) -> int:
        """Return what the node's clock shows at a virtual time [us]."""
        return clock_us(self._radar, now_us)

    def scan(self, event: RadarEvent, scan: ScanInput, *, taps: bool) -> StepOutput | None:
        """Give the node a scan, and its link what it says; None when nothing reaches the node."""
        if self.machine is None:
            fault = self._active(event.ready_us, _OF_THE_MACHINE)
            key = fault.key if fault else "fault.crash"
            self._log.add(key, self.name, event.ready_us, Effect.UNMADE, "off, no scan")
            return None
        if event.missed:
            self._log.add("radar.missed", self.name, event.ready_us, Effect.UNMADE)
            return None
        if event.again:
            self._log.add("radar.doubled", self.name, event.ready_us, Effect.EXTRA)
        output = self.machine.step(self.machine_us(event.ready_us), b"", scan, taps=taps)
        self.keep_profile(output)
        for frame in frames_in(output.link_out):
            self._send(event.ready_us, frame)
        return output

    def _send(self, now_us: int, frame: bytes) -> None:
        report = is_report(frame)
        self.reports_made += report
        fault = self._active(now_us, _ON_THE_LINK)
        if fault is None:
            self.link.send(frame, report=report)
        elif fault.kind == "silent":
            self._log.add(fault.key, self.name, now_us, Effect.MISSING if report else Effect.NOTHING)
        else:
            self._log.add(fault.key, self.name, now_us, Effect.DAMAGED if report else Effect.GARBAGE)
            self.link.send_garbage(self._garbage.bytes(len(frame)))

    def _active(self, now_us: int, kinds: tuple[str, ...]) -> Fault | None:
        """Return the fault of one of these kinds that holds now."""
        since_s = (now_us - self._begin_us) * 1e-6
        for fault in self._faults:
            if fault.kind in kinds and fault.at_s <= since_s < fault.until_s:
                return fault
        return None


def is_report(frame: bytes) -> bool:
    """Whether a frame, with its delimiters, is a node's report on a scan."""
    transfer = codec.parsed(frame.strip(b"\0"))
    return (
        isinstance(transfer, codec.Transfer)
        and transfer.kind == codec.MESSAGE
        and transfer.port == codec.DETECTIONS
    )
