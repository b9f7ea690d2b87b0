"""Laws of the frame assembler: nothing is dropped uncounted, whatever a link does."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from echofuse import _core

NODES = [_core.NodeSite(node_id=i, rx=_core.Point(x_m=i)) for i in range(4)]
DELAY, WEIGHT = np.array([2e-8], np.float32), np.array([9.0], np.float32)
EVENTS = st.lists(
    st.tuples(st.integers(0, 5), st.integers(0, 30), st.integers(0, 120_000), st.booleans()), max_size=80
)


def assembler(**fields) -> _core.FrameAssembler:  # type: ignore[no-untyped-def]
    stage = _core.FrameAssembler()
    assert stage.configure(_core.FrameAssemblerConfig(**fields), NODES) == _core.Status.ok
    return stage


def outcome(counters) -> int:  # type: ignore[no-untyped-def]
    names = ("accepted", "late", "early", "doubled", "malformed", "unknown_node")
    return sum(getattr(counters, name) for name in names)


@given(events=EVENTS)
def test_every_report_has_exactly_one_fate(events):  # type: ignore[no-untyped-def]
    stage, now, given_out = assembler(), 0, 0
    last = -1
    for sent, (node, frame, wait, damaged) in enumerate(events, start=1):
        now += wait
        delay = np.array([np.nan], np.float32) if damaged and frame % 3 == 0 else DELAY
        stage.receive(node, frame, delay, WEIGHT, now)
        assert outcome(stage.counters) == sent
        while True:
            status, closed = stage.poll(now)
            assert status == _core.Status.ok
            if closed is None:
                break
            assert closed[1] > last
            last = closed[1]
            assert closed[2] == len(closed[3])
            given_out += closed[2]
    while (closed := stage.poll(now + 10**9)[1]) is not None:
        given_out += closed[2]
    assert given_out == stage.counters.accepted


@given(
    latency=st.lists(st.integers(0, 20_000), min_size=4, max_size=4),
    offsets=st.lists(st.integers(0, 2**32 - 1), min_size=4, max_size=4),
)
def test_a_steady_link_loses_nothing(latency, offsets):  # type: ignore[no-untyped-def]
    """Counters may start anywhere, and wrap."""
    stage, n_frames = assembler(), 12
    arrivals = sorted((k * 100_000 + latency[node], node, k) for k in range(n_frames) for node in range(4))
    closed = []
    for now, node, k in arrivals:
        stage.receive(node, (offsets[node] + k) % 2**32, DELAY, WEIGHT, now)
        frame = stage.poll(now)[1]
        if frame is not None:
            closed.append(frame)
    assert [frame[2] for frame in closed] == [4] * n_frames
    assert stage.counters.lost == 0


def test_a_dead_node_is_not_waited_for_and_comes_back():  # type: ignore[no-untyped-def]
    stage = assembler(dead_after_frames=3)
    waits = []
    for k in range(8):
        now = k * 100_000
        for node in range(3):
            stage.receive(node, k, DELAY, WEIGHT, now)
        waits.append(stage.poll(now)[1] is None)
        if waits[-1]:
            assert stage.poll(now + 80_000)[1] is not None
    assert waits == [True, True, True, False, False, False, False, False]
    for node in (3, 0, 1, 2):
        stage.receive(node, 8, DELAY, WEIGHT, 800_000)
    assert stage.poll(800_000)[1][2] == 4


def test_a_restarted_node_is_lined_up_anew():  # type: ignore[no-untyped-def]
    stage = assembler(resync_after_reports=3)
    reported = []
    for k in range(20):
        now = k * 100_000
        for node in range(4):
            frame = k if node != 2 or k < 10 else k - 10
            stage.receive(node, frame, DELAY, WEIGHT, now)
        while (closed := stage.poll(now + 90_000)[1]) is not None:
            reported.append(closed[2])
    assert reported == [4] * 10 + [3] * 2 + [4] * 8
    assert stage.counters.late == 2
    assert stage.counters.resynchronised == 1


def test_a_restart_after_a_while_is_seen_at_once():  # type: ignore[no-untyped-def]
    stage, reported = assembler(), []
    for k in range(40):
        for node in range(4):
            frame = k if node != 2 or k < 25 else k - 25
            stage.receive(node, frame, DELAY, WEIGHT, k * 100_000)
        while (closed := stage.poll(k * 100_000 + 90_000)[1]) is not None:
            reported.append(closed[2])
    assert reported == [4] * 40
    assert stage.counters.late == 0
    assert stage.counters.resynchronised == 1


def test_a_scan_counted_twice_holds_up_nobody_else():  # type: ignore[no-untyped-def]
    """Its node is out of step for two reports, and then lined up anew."""
    stage, reported = assembler(), []
    for k in range(20):
        now = k * 100_000
        for node in range(4):
            stage.receive(node, k + int(node == 1 and k > 10), DELAY, WEIGHT, now)
        if k == 10:
            while (closed := stage.poll(now)[1]) is not None:
                reported.append(closed[2])
            stage.receive(1, 11, DELAY, WEIGHT, now + 5_000)
        while (closed := stage.poll(now + 90_000)[1]) is not None:
            reported.append(closed[2])
    assert reported == [4] * 11 + [3] + [4] * 8
    assert stage.counters.early == 2
    assert stage.counters.resynchronised == 1


@given(events=EVENTS)
def test_every_report_that_is_missing_is_counted(events):  # type: ignore[no-untyped-def]
    """Of the frames up to the newest closed one, every node's report was accepted, lost or absent."""
    stage, now, number = assembler(), 0, -1
    for node, frame, wait, _ in events:
        now += wait
        stage.receive(node, frame, DELAY, WEIGHT, now)
        while (closed := stage.poll(now)[1]) is not None:
            number = closed[1]
    while (closed := stage.poll(now + 10**9)[1]) is not None:
        number = closed[1]
    counters = stage.counters
    assert counters.accepted + counters.lost + counters.absent == len(NODES) * (number + 1)
    assert counters.frames <= number + 1
