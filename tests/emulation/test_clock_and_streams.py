"""The virtual clock, and random streams that do not disturb each other."""

import numpy as np
import pytest

from echofuse.emulation.clock import VirtualClock
from echofuse.emulation.streams import stream


def test_events_happen_by_time_and_then_by_insertion() -> None:
    clock, seen = VirtualClock(), []
    for time_us, name in ((20, "late"), (10, "first"), (10, "second"), (20, "later")):
        clock.at(time_us, lambda name=name: seen.append((clock.now_us, name)))
    clock.run()
    assert seen == [(10, "first"), (10, "second"), (20, "late"), (20, "later")]
    assert not clock.waiting


def test_an_event_may_add_others_but_none_in_the_past() -> None:
    clock, seen = VirtualClock(), []

    def first() -> None:
        clock.at(clock.now_us, lambda: seen.append(clock.now_us))
        clock.at(clock.now_us + 5, lambda: seen.append(clock.now_us))
        with pytest.raises(ValueError, match="before"):
            clock.at(clock.now_us - 1, first)

    clock.at(7, first)
    clock.run()
    assert seen == [7, 12]


def test_streams_repeat_and_differ() -> None:
    keys = [
        (0, "link.loss", "rx1"),
        (0, "link.loss", "rx2"),
        (0, "link.late", "rx1"),
        (1, "link.loss", "rx1"),
    ]
    draws = [stream(*key).random(50) for key in keys]
    for key, draw in zip(keys, draws, strict=True):
        np.testing.assert_array_equal(stream(*key).random(50), draw)
    assert len({draw.tobytes() for draw in draws}) == len(keys)
