"""The virtual clock: the only time of an emulation, and what is to happen when.

Time is an integer number of microseconds. Events of the same time happen in the order in which they were put
in, so a run depends on nothing but its inputs.
"""

import heapq
from collections.abc import Callable
from typing import NamedTuple

__all__ = ["VirtualClock"]

Action = Callable[[], None]


class _Event(NamedTuple):
    time_us: int
    order: int  # of insertion; no two are equal, so actions are never compared
    action: Action


class VirtualClock:
    """A clock that goes from event to event."""

    def __init__(self, start_us: int = 0) -> None:
        self._now_us = start_us
        self._order = 0
        self._events: list[_Event] = []

    @property
    def now_us(self) -> int:
        """The time of the event that is happening [us]."""
        return self._now_us

    @property
    def waiting(self) -> bool:
        """Whether something is still to happen."""
        return bool(self._events)

    def at(self, time_us: int, action: Action) -> None:
        """Let `action` happen at a time [us] that is not in the past."""
        if time_us < self._now_us:
            raise ValueError(f"time_us: {time_us} is before {self._now_us}")
        heapq.heappush(self._events, _Event(time_us, self._order, action))
        self._order += 1

    def run(self) -> None:
        """Let everything happen, also what is added meanwhile, until nothing is left."""
        while self._events:
            event = heapq.heappop(self._events)
            self._now_us = event.time_us
            event.action()
