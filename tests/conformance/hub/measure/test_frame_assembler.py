"""The core's frame assembler against the reference, over links that delay, lose, repeat and damage."""

from dataclasses import asdict

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.reference.hub.measure.frame_assembler import FrameAssembler, Report

PERIOD_US = 100_000


def deliveries(rng, n_nodes, n_frames):  # type: ignore[no-untyped-def]
    """(arrival_us, node_id, frame, delay_s, weight, time_us) in the order of arrival."""
    found = []
    clock_us = rng.integers(0, 10**9, size=n_nodes) * int(rng.random() < 0.8)  # or no clock
    first = rng.integers(0, 1000, size=n_nodes)
    power_cut = rng.random() < 0.3  # of all nodes at once
    for node in range(n_nodes):
        restart = rng.integers(n_frames) if rng.random() < 0.4 else n_frames
        restart_at = int(rng.choice([0, 5000]))
        restart = 45 if power_cut else restart
        for k in range(n_frames):
            if rng.random() < 0.1 or (node == 0 and 20 <= k < 35) or (power_cut and 25 <= k < 45):
                continue
            counter = int(first[node] + k) if k < restart else int(restart_at + k - restart)
            n = int(rng.integers(0, 5))
            delay = np.sort(rng.uniform(1e-8, 6e-8, n)).astype(np.float32)
            if n and rng.random() < 0.03:
                delay[0] = rng.choice(np.array([np.nan, np.inf, -1e-9, 1.0], np.float32))
            arrival = k * PERIOD_US + int(rng.exponential(25_000))
            node_id = 10 + node if rng.random() > 0.02 else 99
            weight = rng.uniform(4, 20, n).astype(np.float32)
            since_us = k * PERIOD_US if k < restart else (k - restart) * PERIOD_US
            time_us = int(clock_us[node] + since_us) if clock_us[node] else 0
            for copy in range(1 + int(rng.random() < 0.05)):
                found.append((arrival + 3000 * copy, node_id, counter, delay, weight, time_us))
    return sorted(found, key=lambda item: (item[0], item[1], item[2]))


@pytest.mark.parametrize("resync_after_reports", [2, 10])
def test_assembler(resync_after_reports):  # type: ignore[no-untyped-def]
    board, seen = Scoreboard(), dict.fromkeys(_counters(_core.FrameAssembler()), 0)
    for seed in range(25):
        rng = np.random.default_rng(seed)
        n_nodes = int(rng.integers(3, 7))
        config = _core.FrameAssemblerConfig(resync_after_reports=resync_after_reports, dead_after_frames=5)
        nodes = [
            _core.NodeSite(node_id=10 + i, tx=_core.Point(x_m=i), rx=_core.Point(x_m=i, y_m=1.0))
            for i in range(n_nodes)
        ]
        stage = _core.FrameAssembler()
        assert stage.configure(config, nodes) == _core.Status.ok
        reference = FrameAssembler(as_reference(config), [node.node_id for node in nodes])
        for arrival, node_id, counter, delay, weight, time_us in deliveries(rng, n_nodes, 60):
            report = Report(node_id, counter, delay.astype(np.float64), weight.astype(np.float64), time_us)
            good = reference.receive(report, arrival)
            status = stage.receive(node_id, counter, delay, weight, arrival, time_us)
            assert status == (_core.Status.ok if good else _core.Status.invalid_input)
            while True:
                expected = reference.poll(arrival)
                status, got = stage.poll(arrival)
                assert status == _core.Status.ok
                assert (got is None) == (expected is None)
                if expected is None:
                    break
                assert got[:3] == (expected.time_us, expected.number, expected.frame.n_reported)
                where = f"{seed} {expected.number}"
                board.decisions("", "node", where, got[3]["node_index"], expected.frame.node_index, 1.0)
                board.floats("", "path", where, got[3]["path_m"], expected.frame.path_m, "hub.frame.path")
                np.testing.assert_array_equal(got[3]["weight"], expected.frame.weight)
        assert _counters(stage) == asdict(reference.counters)
        for name, value in _counters(stage).items():
            seen[name] += value
    assert all(seen.values()), f"a fault that never came: {seen}"
    for row in board.rows():
        assert row.passed, row.failures[:3]


def _counters(stage):  # type: ignore[no-untyped-def]
    names = (
        "accepted",
        "late",
        "early",
        "doubled",
        "malformed",
        "unknown_node",
        "lost",
        "resynchronised",
        "frames",
        "absent",
        "slow",
    )
    return {name: getattr(stage.counters, name) for name in names}
