"""Laws of pairing traces, and the checked numbers of algorithms.md 5.6."""

import numpy as np
import pytest

from echofuse import _core

CLOCK_HZ = 4.5e9
SEPARATION_M = 12.0 * 299792458.0 / CLOCK_HZ  # m = 12 + correction, as in algorithms.md


def stage(**fields) -> _core.TracePairing:  # type: ignore[no-untyped-def]
    made = _core.TracePairing()
    config = _core.TracePairingConfig(separation_m=SEPARATION_M, clock_hz=CLOCK_HZ, **fields)
    assert made.configure(config) == _core.Status.ok
    return made


def samples(made, first, second):  # type: ignore[no-untyped-def]
    status, couples = made.process(*(np.array(n, np.float32) / np.float32(CLOCK_HZ) for n in (first, second)))
    assert status == _core.Status.ok
    return [(c["delay1_s"] * CLOCK_HZ, c["delay2_s"] * CLOCK_HZ, int(c["completions"])) for c in couples]


@pytest.mark.parametrize("apart", range(-13, 14))
def test_closing_rules_have_the_checked_errors(apart):  # type: ignore[no-untyped-def]
    ((first, second, _),) = samples(stage(), [200], [200 + apart])
    assert (first, second) == pytest.approx((200, 200 + apart), abs=1e-3)
    ((first, second, _),) = samples(stage(closing=_core.ClosingRule.printed), [200], [200 + apart])
    outwards = 5.5 if apart >= 0 else -5.5
    assert (first, second) == pytest.approx((199 - outwards, 199 + apart + outwards), abs=1e-3)


def test_traces_beyond_the_limit_are_no_couple():  # type: ignore[no-untyped-def]
    assert len(samples(stage(), [200], [214])) == 1
    assert samples(stage(), [200], [215]) == []


def test_all_pairs_shows_the_ghosts_that_assignment_avoids():  # type: ignore[no-untyped-def]
    first, second = [200, 208], [203, 206]
    assert [c[:2] for c in samples(stage(), first, second)] == [
        pytest.approx((200, 203), abs=1e-3),
        pytest.approx((208, 206), abs=1e-3),
    ]
    assert len(samples(stage(rule=_core.PairingRule.all_pairs), first, second)) == 4


@pytest.mark.parametrize("limit", [0, 1, 3])
def test_a_lonely_trace_is_completed_for_some_responses_only(limit):  # type: ignore[no-untyped-def]
    made = stage(completion_limit=limit)
    assert len(samples(made, [200], [206])) == 1
    completions = [samples(made, [201], []) for _ in range(5)]
    assert [len(c) for c in completions] == [1] * limit + [0] * (5 - limit)
    for n, couples in enumerate(completions[:limit]):
        assert couples[0] == pytest.approx((200, 206, n + 1), abs=1e-3)


def test_only_a_trace_near_the_last_couple_is_completed():  # type: ignore[no-untyped-def]
    for trace, completed in ((196, True), (210, True), (195, False), (211, False)):
        made = stage()
        samples(made, [200], [206])
        assert bool(samples(made, [], [trace])) == completed


def test_a_false_alarm_beside_a_couple_copies_nothing():  # type: ignore[no-untyped-def]
    made = stage()
    samples(made, [200], [206])
    assert len(samples(made, [200, 204], [206])) == 1


def test_reset_forgets():  # type: ignore[no-untyped-def]
    made = stage()
    samples(made, [200], [206])
    made.reset()
    assert samples(made, [200], []) == []
