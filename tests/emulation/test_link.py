"""The emulated link: what happens to frames, and that everything that happens is written down."""

from collections import Counter

import numpy as np
import pytest

from echofuse.emulation import codec
from echofuse.emulation.clock import VirtualClock
from echofuse.emulation.injection import Effect, InjectionLog, NotAppliedError
from echofuse.emulation.link import Link, frames_in
from echofuse.emulation.reception import Receiver
from echofuse.emulation.scenario import LinkFaults

N_FRAMES, PERIOD_US = 400, 100_000
Arrivals = list[tuple[int, bytes, bool]]


def report(number: int) -> bytes:
    payload = codec.detections_payload(number * PERIOD_US, np.array([2e-8, 3e-8]), np.array([10, 20]))
    return codec.frame(codec.Transfer(7, codec.DETECTIONS, number, payload))


def carried(seed: int = 0, n_frames: int = N_FRAMES, **faults: float) -> tuple[Arrivals, InjectionLog]:
    clock, log, arrivals = VirtualClock(), InjectionLog(), []
    link = Link(
        "rx1",
        LinkFaults(**faults),  # type: ignore[arg-type]
        seed=seed,
        log=log,
        clock=clock,
        deliver=lambda data, intact: arrivals.append((clock.now_us, data, intact)),
    )
    for number in range(n_frames):
        clock.at(number * PERIOD_US, lambda number=number: link.send(report(number), report=True))
    clock.run()
    link.finish()
    clock.run()
    return arrivals, log


def numbers(arrivals: Arrivals) -> list[int]:
    found = [codec.parsed(data.strip(b"\0")) for _, data, intact in arrivals if intact]
    return [transfer.transfer_id for transfer in found if isinstance(transfer, codec.Transfer)]


def test_without_faults_frames_arrive_as_they_were_sent() -> None:
    arrivals, log = carried()
    assert arrivals == [(number * PERIOD_US, report(number), True) for number in range(N_FRAMES)]
    assert log.entries == []


def test_lost_frames_are_in_the_log_one_by_one() -> None:
    arrivals, log = carried(loss=0.1)
    assert 25 <= len(log.entries) <= 55
    assert log.effects(Effect.MISSING) == len(log.entries) == N_FRAMES - len(arrivals)
    came = set(numbers(arrivals))
    assert {entry.time_us // PERIOD_US for entry in log.entries} == set(range(N_FRAMES)) - came


def test_damaged_frames_are_rejected_by_any_reader() -> None:
    arrivals, log = carried(bit_error_rate=1e-3)
    receiver = Receiver()
    stream = b"".join(data for _, data, _ in arrivals) + b"\0"
    taken = list(receiver.feed(stream, 0))
    assert len(taken) == N_FRAMES - len(log.entries)
    assert log.effects(Effect.DAMAGED) == len(log.entries) > 100
    counters = receiver.counters()
    assert sum(counters.values()) - counters["frames"] >= len(log.entries)


def test_doubled_frames_are_repetitions() -> None:
    arrivals, log = carried(doubled=0.2)
    receiver = Receiver()
    for time_us, data, _ in arrivals:
        list(receiver.feed(data, time_us))
    assert receiver.counters()["frames"] == N_FRAMES
    assert receiver.counters()["repeated"] == len(log.entries) > 50


def test_late_frames_are_late_by_what_was_asked() -> None:
    arrivals, log = carried(late=0.2, late_us=50_000)
    lateness = Counter(time_us - number * PERIOD_US for (time_us, _, _), number in _with_numbers(arrivals))
    assert lateness == {0: N_FRAMES - len(log.entries), 50_000: len(log.entries)}


def test_a_reordered_frame_comes_right_after_the_next_one() -> None:
    arrivals, log = carried(reorder=0.1)
    found = numbers(arrivals)
    assert sorted(found) == list(range(N_FRAMES))
    overtaken = [number for place, number in enumerate(found) if place and found[place - 1] > number]
    assert len(overtaken) in (len(log.entries), len(log.entries) - 1)  # the last one has nobody behind it
    assert len(overtaken) > 20


def test_a_slow_line_delays_by_length_and_queues() -> None:
    arrivals, _ = carried(n_frames=3, latency_us=5000, bandwidth_bps=8000.0)
    duration_us = 1000 * len(report(0))
    assert duration_us < PERIOD_US
    assert [time_us for time_us, _, _ in arrivals] == [
        number * PERIOD_US + duration_us + 5000 for number in range(3)
    ]
    arrivals, _ = carried(n_frames=3, bandwidth_bps=1600.0)
    assert [time_us for time_us, _, _ in arrivals] == [5 * duration_us * (number + 1) for number in range(3)]


def test_one_fault_does_not_shift_another() -> None:
    _, alone = carried(loss=0.1)
    _, together = carried(loss=0.1, late=0.3, doubled=0.3, reorder=0.2, bit_error_rate=1e-4)
    assert [entry for entry in together.entries if entry.kind == "link.loss"] == alone.entries
    assert carried(loss=0.1, late=0.3)[0] == carried(loss=0.1, late=0.3)[0]
    assert carried(seed=1, loss=0.1)[1].entries != alone.entries


def test_a_fault_that_never_came_about_is_an_error() -> None:
    _, log = carried(n_frames=2, loss=1e-6)
    with pytest.raises(NotAppliedError, match=r"scenario x: never applied in this run: link\.loss"):
        log.check_all_applied("scenario x")


def test_frames_are_found_in_what_a_machine_sends() -> None:
    assert frames_in(report(1) + report(2)) == [report(1), report(2)]
    assert frames_in(b"") == []


def _with_numbers(arrivals: Arrivals) -> list[tuple[tuple[int, bytes, bool], int]]:
    return list(zip(arrivals, numbers(arrivals), strict=True))
