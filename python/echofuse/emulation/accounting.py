"""Injected faults against counters: every fault is in a counter, and no other counter moves.

Three laws, each exact (docs/emulation.md):

1. The hub's counters of reports and of its link are those of `HubMonitor`, which heard the same bytes.
2. Conservation. Of the frames that came intact to a running hub, each was taken or is a repetition. Of the
   reports that nodes made and a link doubled, each has one fate: lost, damaged or withheld on the way (in
   the log), unheard because there was no hub, a repetition, or in one of the hub's counters of outcomes. And
   each node has counted as many scans or responses as it made reports.
3. A counter of trouble that is not zero belongs to a kind of fault that was applied.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from echofuse.emulation.injection import Effect, InjectionLog
from echofuse.emulation.reception import REJECTED

__all__ = ["MAY_MOVE", "Account", "CounterRow", "FaultRow", "account"]

_REJECTED = tuple(f"link_{name}" for name in REJECTED)
_MISSING = ("lost", "absent")
_OUT_OF_STEP = ("slow", "late", "early", "doubled", "resynchronised", "clock_faults", *_MISSING)

#: Which of the hub's counters of trouble each kind of fault may move. Those of timing move none as long as
#: they stay under half of the assembler's deadline.
MAY_MOVE: Mapping[str, tuple[str, ...]] = {
    "radar.period_us": _OUT_OF_STEP,
    "radar.frame_duration_us": _OUT_OF_STEP,
    "radar.jitter_us": _OUT_OF_STEP,
    "radar.clock_offset_us": (),
    "radar.drift_ppm": _OUT_OF_STEP,
    "radar.adc_bits": (),
    "radar.adc_full_scale": (),
    "radar.missed": ("resynchronised", *_MISSING),
    "radar.doubled": ("resynchronised", "doubled", "late"),
    "link.latency_us": _OUT_OF_STEP,
    "link.bandwidth_bps": _OUT_OF_STEP,
    "link.loss": _MISSING,
    "link.bit_error_rate": (*_REJECTED, *_MISSING),
    "link.reorder": _OUT_OF_STEP,
    "link.doubled": ("link_repeated",),
    "link.late": _OUT_OF_STEP,
    "fault.silent": _MISSING,
    "fault.crash": _MISSING,
    "fault.restart": ("resynchronised", "late", *_MISSING),
    "fault.hub_restart": _OUT_OF_STEP,
    "fault.garbage": (*_REJECTED, *_MISSING),
    "fault.stranger": ("unknown_node",),
}
#: Counters of trouble. The others tell of work, and move in every run.
TROUBLE = (
    *("late", "early", "doubled", "malformed", "unknown_node", "lost", "absent", "slow", "resynchronised"),
    *("clock_faults", "undecodable", "link_repeated", *_REJECTED),
)
_OUTCOMES = ("accepted", "late", "early", "doubled", "malformed", "unknown_node")


class FaultRow(NamedTuple):
    """One kind of fault."""

    kind: str
    injected: int
    counted_in: tuple[str, ...]  # the hub's counters that it moved, or may have moved with others


class CounterRow(NamedTuple):
    """One counter of one machine."""

    machine: str
    name: str
    expected: int
    counted: int


@dataclass(frozen=True, kw_only=True)
class Account:
    """What was injected, what was counted, and what does not agree."""

    faults: Sequence[FaultRow]
    counters: Sequence[CounterRow]
    problems: Sequence[str] = field(default_factory=tuple)  # empty: everything is accounted for

    def text(self) -> str:
        """Return the two tables, and what does not agree."""
        lines = [f"{'fault':24s} {'injected':>8s}  counted in"]
        for fault in self.faults:
            where = ", ".join(fault.counted_in) or "no counter, as it must"
            lines.append(f"{fault.kind:24s} {fault.injected:8d}  {where}")
        lines.append(f"{'counter':32s} {'expected':>8s} {'counted':>8s}")
        lines += [
            f"{row.machine + '.' + row.name:32s} {row.expected:8d} {row.counted:8d}"
            for row in self.counters
            if row.expected or row.counted
        ]
        verdict = "every fault is accounted for, and no other counter moved"
        return "\n".join([*lines, *(f"NOT ACCOUNTED FOR: {line}" for line in self.problems or ())]) + (
            "" if self.problems else f"\n{verdict}"
        )


def account(
    *,
    log: InjectionLog,
    expected: Mapping[str, int],
    counters: Mapping[str, Mapping[str, int]],
    made: Mapping[str, int],
    made_by_strangers: int,
    heard_intact: int,
    heard_reports: int,
    unheard_reports: int,
) -> Account:
    """Compare a run's log with its counters.

    expected: the hub's counters, by HubMonitor. made: reports of each node of the site.
    made_by_strangers: reports of recorded nodes that the site does not list.
    heard_intact: intact frames that reached a running hub; heard_reports: those of them that are reports.
    unheard_reports: intact ones that came while there was no hub.
    """
    hub = counters["hub"]
    rows = [CounterRow("hub", name, value, hub.get(name, 0)) for name, value in sorted(expected.items())]
    for node, count in made.items():
        taken = "responses" if "responses" in counters[node] else "scans"  # as its pipeline calls them
        rows.append(CounterRow(node, taken, count, counters[node].get(taken, 0)))
        rows.append(CounterRow(node, f"rejected_{taken}", 0, counters[node].get(f"rejected_{taken}", 0)))
    problems = [
        f"{row.machine}.{row.name}: expected {row.expected}, counted {row.counted}"
        for row in rows
        if row.expected != row.counted
    ]
    problems += _not_conserved(
        log, hub, sum(made.values()) + made_by_strangers, heard_intact, heard_reports, unheard_reports
    )
    applied = log.applied()
    moved = [name for name in TROUBLE if hub.get(name, 0)]
    allowed = _may_move(applied, hub) | ({"unknown_node"} if made_by_strangers else set())
    problems += [f"hub.{name}: {hub[name]}, and no fault moves it" for name in moved if name not in allowed]
    faults = [
        FaultRow(kind, count, tuple(name for name in MAY_MOVE[kind] if name in moved))
        for kind, count in applied.items()
    ]
    return Account(faults=faults, counters=rows, problems=problems)


def _may_move(applied: Mapping[str, int], hub: Mapping[str, int]) -> set[str]:
    """Return the counters of trouble that the faults of a run may move."""
    allowed = {name for kind in applied for name in MAY_MOVE[kind]}
    if hub.get("absent", 0):  # who was given up and comes back finds its frame closed without it
        allowed.add("late")
    return allowed


def _not_conserved(
    log: InjectionLog,
    hub: Mapping[str, int],
    made: int,
    heard_intact: int,
    heard_reports: int,
    unheard_reports: int,
) -> list[str]:
    """Return which sums do not come out (law 2)."""
    problems = []
    repeated, outcomes = hub.get("link_repeated", 0), sum(hub.get(name, 0) for name in _OUTCOMES)
    taken = hub.get("link_frames", 0) + repeated
    if taken != heard_intact:
        problems.append(f"of {heard_intact} intact frames that arrived the hub's link has {taken}")
    doubled, echoed = log.effects(Effect.REPEATED), log.effects(Effect.ECHOED)
    if repeated > doubled + echoed:
        problems.append(f"{doubled + echoed} frames were doubled, and link_repeated is {repeated}")
    sent = made + log.effects(Effect.STRANGE) + doubled
    ended = log.effects(Effect.MISSING, Effect.DAMAGED)
    if sent - ended != heard_reports + unheard_reports:
        problems.append(
            f"of {sent} reports {ended} ended on the way, {heard_reports} came to the hub and "
            f"{unheard_reports} while there was none"
        )
    # A hub that was away has missed some of the doubled frames that are no reports.
    others = outcomes + repeated - heard_reports
    least = 0 if "fault.hub_restart" in log.applied() else echoed
    if not least <= others <= echoed:
        problems.append(
            f"of {heard_reports} reports that came {outcomes + repeated - echoed} are in the hub's counters"
        )
    return problems
