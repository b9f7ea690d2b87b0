"""Couples of traces: core against reference, every choice, over runs of responses."""

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.reference.hub.measure.trace_pairing import TracePairing


@pytest.mark.parametrize("closing", ["exact", "printed"])
@pytest.mark.parametrize("rule", ["assignment", "all_pairs"])
def test_trace_pairing(rule, closing):  # type: ignore[no-untyped-def]
    board, completed, frames = Scoreboard(), 0, 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        config = _core.TracePairingConfig(
            rule=getattr(_core.PairingRule, rule),
            closing=getattr(_core.ClosingRule, closing),
            correction_samples=int(rng.integers(1, 3)),
        )
        core, reference = _core.TracePairing(), TracePairing(as_reference(config))
        assert core.configure(config) == _core.Status.ok
        people = rng.uniform(60.0, 400.0, (4, 1)) + rng.uniform(-6.0, 6.0, (4, 2))
        for response in range(30):
            people = people + rng.uniform(-1.0, 1.0, people.shape)
            delays = []
            for receiver in range(2):
                seen = people[rng.random(4) < 0.8, receiver]
                traces = np.sort(np.concatenate([seen, rng.uniform(60.0, 400.0, rng.integers(3))]))
                delays.append((traces / 4.5e9).astype(np.float32))
            status, couples = core.process(*delays)
            step = reference.process(*(d.astype(np.float64) for d in delays))
            assert status == _core.Status.ok
            where = f"seed {seed}, response {response}"
            expected = [c.completions for c in step.couples]
            same = board.decisions(
                rule, "couples", where, couples["completions"], np.array(expected, int), step.margin
            )
            delay = np.array([c.delay_s for c in step.couples]).reshape(-1, 2)
            got = np.column_stack([couples["delay1_s"], couples["delay2_s"]])
            if not same or not board.floats(
                rule, "delay", where, got, delay, "hub.pairing.delay", step.margin
            ):
                break
            completed += sum(expected)
            frames += 1
    for row in board.rows():
        assert row.passed, row.failures[:3]
    assert frames > 1000
    assert (completed > 100) == (rule == "assignment")


def test_bad_input_is_refused():  # type: ignore[no-untyped-def]
    core = _core.TracePairing()
    one, many = np.full(1, 3e-8, np.float32), np.full(17, 3e-8, np.float32)
    assert core.process(one, one)[0] == _core.Status.not_configured
    assert core.configure(_core.TracePairingConfig()) == _core.Status.ok
    for bad in (many, one * np.nan):
        status, couples = core.process(one, bad)
        assert (status, len(couples)) == (_core.Status.invalid_input, 0)
    assert len(core.process(one, one)[1]) == 1
