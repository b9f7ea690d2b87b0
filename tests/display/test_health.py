"""What counters tell in words, on the command line and in the report."""

from dataclasses import replace

import pytest

from echofuse.display.health import health_lines
from echofuse.display.report_page import page
from echofuse.result import RunResult

WELL = {
    "responses": 810,
    "dead_responses": 0,
    "saturated_responses": 0,
    "cross_talk_missing": 0,
    "settling_responses": 24,
    "rejected_responses": 0,
    "time_zero_moved": 0,
    "truncated_detections": 0,
}


def lines(run: RunResult, **counts: int) -> list[str]:
    return health_lines(replace(run, counters={"hub": {"lost": 3}, "rx1": WELL, "rx2": WELL | counts}))


def test_nothing_is_said_of_healthy_nodes(run: RunResult) -> None:
    assert health_lines(run) == []
    assert lines(run) == []


@pytest.mark.parametrize(
    ("counter", "words"),
    [
        ("dead_responses", "5 of 810: the same value in every sample"),
        ("saturated_responses", "5 of 810: too many samples at full scale"),
        ("cross_talk_missing", "5 of 810: no cross-talk where it belongs"),
        ("time_zero_moved", "5: the cross-talk moved as after a power-up"),
        ("rejected_responses", "5: samples that are not finite, or too few"),
        ("truncated_detections", "5: more echoes than a report holds"),
    ],
)
def test_a_counter_is_told_with_its_node_and_meaning(run: RunResult, counter: str, words: str) -> None:
    (line,) = lines(run, **{counter: 5})
    assert line.startswith(f"rx2: {counter} {words}")


def test_a_receiver_that_judged_nothing_is_told(run: RunResult) -> None:
    assert lines(run, responses=30, settling_responses=24) == []
    (line,) = lines(run, responses=20, settling_responses=20)
    assert line.startswith(
        "rx2: settling_responses 20 of 20: time zero and background were still being learnt"
    )


def test_the_report_says_the_same(run: RunResult) -> None:
    ill = replace(run, counters={"<b>": WELL | {"dead_responses": 810}, "hub": {}})
    assert "<li>&lt;b&gt;: dead_responses 810 of 810: the same value in every sample" in page(ill, [])
