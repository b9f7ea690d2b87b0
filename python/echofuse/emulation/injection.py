"""What an emulation did to the machines, one entry a fault, and what each must lead to."""

from collections import Counter
from collections.abc import Iterable
from enum import Enum
from typing import NamedTuple

from echofuse.errors import TargetError

__all__ = ["Effect", "Injection", "InjectionLog", "NotAppliedError"]


class Effect(Enum):
    """What a fault leads to, as the hub sees it (docs/emulation.md)."""

    NOTHING = "nothing"  # it must not show in any counter
    MISSING = "missing"  # a report never comes
    DAMAGED = "damaged"  # a frame comes that no reader may accept; a report in it is missing too
    GARBAGE = "garbage"  # as DAMAGED, but of bytes that never were a frame
    REPEATED = "repeated"  # a report comes twice
    ECHOED = "echoed"  # another frame comes twice
    DELAYED = "delayed"  # a report comes, later than it should
    UNMADE = "unmade"  # a node gets no scan, so it makes no report
    EXTRA = "extra"  # a node gets a scan once more, and makes a report too many
    RESTARTED = "restarted"  # a machine forgets everything
    STRANGE = "strange"  # a report comes from a node that the site does not list


class Injection(NamedTuple):
    """One fault."""

    kind: str  # the scenario's key, such as "link.loss"
    node: str  # name
    time_us: int  # virtual [us]
    effect: Effect
    detail: str = ""


class NotAppliedError(TargetError):
    """A scenario's faults that never came about in a run."""


class InjectionLog:
    """All faults of a run. Those that never stop (jitter, drift) are only counted."""

    def __init__(self) -> None:
        self.entries: list[Injection] = []
        self._applied: Counter[tuple[str, str]] = Counter()
        self._wanted: list[tuple[str, str]] = []

    def want(self, kind: str, node: str) -> None:
        """Note that a scenario asks for a kind of fault of a node ("*": of any)."""
        self._wanted.append((kind, node))

    def add(self, kind: str, node: str, time_us: int, effect: Effect, detail: str = "") -> None:
        """Write one fault down."""
        self.entries.append(Injection(kind, node, time_us, effect, detail))
        self._applied[kind, node] += 1

    def count(self, kind: str, node: str) -> None:
        """Count one application of a fault that is always there and must not show in any counter."""
        self._applied[kind, node] += 1

    def applied(self) -> dict[str, int]:
        """Return how often each kind was applied, by name."""
        total: Counter[str] = Counter()
        for (kind, _), count in self._applied.items():
            total[kind] += count
        return dict(sorted(total.items()))

    def effects(self, *effects: Effect, kinds: Iterable[str] | None = None) -> int:
        """Return how many faults have one of these effects (of these kinds)."""
        chosen = None if kinds is None else set(kinds)
        return sum(
            entry.effect in effects and (chosen is None or entry.kind in chosen) for entry in self.entries
        )

    def check_all_applied(self, source: str) -> None:
        """Raise when something that the scenario asks for never happened."""
        missing = []
        for kind, node in self._wanted:
            count = self.applied().get(kind, 0) if node == "*" else self._applied[kind, node]
            if count == 0:
                missing.append(kind if node == "*" else f"{kind} of {node}")
        if missing:
            raise NotAppliedError(
                f"{source}: never applied in this run: {', '.join(sorted(set(missing)))}; "
                "make the run longer or the fault more likely"
            )
