"""Laws of the frame assembler: nothing is dropped uncounted, whatever a link does."""

import numpy as np
import pytest
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


def test_a_node_that_counts_anew_costs_nothing():  # type: ignore[no-untyped-def]
    stage, reported = assembler(), []
    for k in range(20):
        now = k * 100_000
        for node in range(4):
            frame = k if node != 2 or k < 10 else k - 10
            stage.receive(node, frame, DELAY, WEIGHT, now)
        while (closed := stage.poll(now + 90_000)[1]) is not None:
            reported.append(closed[2])
    assert reported == [4] * 20
    assert (stage.counters.late, stage.counters.resynchronised) == (0, 1)


@pytest.mark.parametrize(("set_back_us", "n_late"), [(800_000, 2), (5_000_000, 0)])
def test_a_clock_that_is_set_back_is_learnt_anew(set_back_us, n_late):  # type: ignore[no-untyped-def]
    """At once, when it is off by more than any link delays a report; else by its third report."""
    stage, reported = assembler(resync_after_reports=3), []
    for k in range(100, 140):
        now = k * 100_000
        for node in range(4):
            time = now - (set_back_us if node == 2 and k >= 120 else 0)
            stage.receive(node, k, DELAY, WEIGHT, now, time)
        while (closed := stage.poll(now + 90_000)[1]) is not None:
            reported.append(closed[2])
    assert reported == [4] * 20 + [3] * n_late + [4] * (20 - n_late)
    assert (stage.counters.late, stage.counters.resynchronised) == (n_late, 0)


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


def test_a_scan_counted_twice_is_told_by_its_time():  # type: ignore[no-untyped-def]
    stage, reported = assembler(), []
    for k in range(20):
        now = k * 100_000
        for node in range(4):
            stage.receive(node, k + int(node == 1 and k > 10), DELAY, WEIGHT, now)
            if (node, k) == (1, 10):
                stage.receive(1, 11, DELAY, WEIGHT, now + 5_000)
        while (closed := stage.poll(now + 90_000)[1]) is not None:
            reported.append(closed[2])
    assert reported == [4] * 20
    assert (stage.counters.doubled, stage.counters.resynchronised) == (1, 1)


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


def test_a_scan_that_a_node_missed_costs_no_other_report():  # type: ignore[no-untyped-def]
    """Its counter is one behind from then on; its clock is not."""
    stage, reported = assembler(), []
    for k in range(20):
        for node in range(4):
            if node != 1 or k != 10:
                stage.receive(node, k - int(node == 1 and k > 10), DELAY, WEIGHT, k * 100_000)
        while (closed := stage.poll(k * 100_000 + 90_000)[1]) is not None:
            reported.append(closed[2])
    assert reported == [4] * 10 + [3] + [4] * 9
    assert (stage.counters.lost, stage.counters.late, stage.counters.resynchronised) == (1, 0, 1)


@given(
    seed=st.integers(0, 2**32 - 1),
    clocks_us=st.lists(st.integers(1, 10**12), min_size=4, max_size=4),
    late_us=st.integers(0, 60_000),
)
def test_a_report_that_is_held_up_is_in_the_frame_of_its_scan(seed, clocks_us, late_us):  # type: ignore[no-untyped-def]
    """Also when it is the first that the hub ever hears: from the third frame on all scans stand together."""
    rng = np.random.default_rng(seed)
    arrivals = []
    for k in range(20):
        for node in range(4):
            late = late_us if rng.random() < 0.2 or (k == 0 and node == 0) else 0
            arrival = k * 100_000 + int(rng.integers(0, 5_000)) + 1_000 * node + late
            arrivals.append((arrival, node, k))
    stage, frames = assembler(), {}
    for arrival, node, k in sorted(arrivals):
        before = stage.counters.accepted
        delay = np.array([1e-9 * (k + 1)], np.float32)
        stage.receive(node, 7 * node + k, delay, WEIGHT, arrival, clocks_us[node] + k * 100_000)
        assert stage.counters.accepted == before + 1 or k < 2
        while (closed := stage.poll(arrival)[1]) is not None:
            frames[closed[1]] = np.rint(closed[3]["path_m"] / 0.299792458).astype(int) - 1
    settled = [scans for scans in frames.values() if scans.size and scans.max() > 2]
    assert all(np.all(scans == scans[0]) for scans in settled)


def outage(away, *, restarted, n_frames=60):  # type: ignore[no-untyped-def]
    """The stage after frames 20 to 39 without some nodes; its frames as (time_us, n_reported)."""
    stage, closed = assembler(), []
    for k in range(n_frames):
        for node in range(4):
            if node in away and 20 <= k < 40:
                continue
            number = k - 40 if restarted and node in away and k >= 40 else k
            stage.receive(node, number, DELAY, WEIGHT, k * 100_000)
            while (frame := stage.poll(k * 100_000)[1]) is not None:
                closed.append((frame[0], frame[2]))
        while (frame := stage.poll(k * 100_000 + 90_000)[1]) is not None:
            closed.append((frame[0], frame[2]))
    return stage, closed


@pytest.mark.parametrize("restarted", [False, True])
def test_after_a_power_cut_of_all_no_report_is_dropped(restarted):  # type: ignore[no-untyped-def]
    """The hub learns nothing wrong from the pause, and waits for all from the first one that is back."""
    stage, closed = outage({0, 1, 2, 3}, restarted=restarted)
    assert closed == [(k * 100_000, 4) for k in (*range(20), *range(40, 60))]
    counters = stage.counters
    assert (counters.accepted, counters.late, counters.early) == (160, 0, 0)
    assert counters.lost + counters.absent == 80
    assert counters.resynchronised == (4 if restarted else 0)


@pytest.mark.parametrize("restarted", [False, True])
def test_who_comes_back_last_in_its_frame_disturbs_nobody(restarted):  # type: ignore[no-untyped-def]
    """Its first report finds its frame closed without it; the next frame waits."""
    stage, closed = outage({3}, restarted=restarted)
    assert closed == [(k * 100_000, 3 if 20 <= k <= 40 else 4) for k in range(60)]
    counters = stage.counters
    assert (counters.accepted, counters.late, counters.early) == (219, 1, 0)
    assert (counters.lost, counters.absent) == (10, 11)
    assert counters.resynchronised == int(restarted)


def test_who_comes_back_too_late_is_given_up_at_once():  # type: ignore[no-untyped-def]
    """One report behind the deadline buys one frame's wait, not ten."""
    stage, _ = outage({3}, restarted=False, n_frames=40)
    stage.receive(3, 39, DELAY, WEIGHT, 39 * 100_000 + 90_000, 39 * 100_000)
    assert stage.counters.late == 1
    waited = []
    for k in range(40, 44):
        for node in range(3):
            stage.receive(node, k, DELAY, WEIGHT, k * 100_000)
        waited.append(stage.poll(k * 100_000)[1] is None)
        while stage.poll(k * 100_000 + 80_000)[1] is not None:
            pass
    assert waited == [True, False, False, False]
