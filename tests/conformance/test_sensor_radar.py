"""The comparison itself: it passes on the library, and fails, by tap and sample, on one that is wrong."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance import conform
from echofuse.conformance.choices import HUB_CHOICES, NODE_CHOICES, Choice
from echofuse.conformance.comparison import Row, Scoreboard
from echofuse.conformance.hub_inputs import simulated_hub_inputs
from echofuse.conformance.hub_taps import MEASURE_TAPS, PHD_TAPS, conform_hub
from echofuse.conformance.inputs import simulated_inputs
from echofuse.conformance.node_taps import NODE_TAPS, conform_node
from echofuse.conformance.sensor_radar import Plan, real_walk, run
from echofuse.conformance.table import format_scores, format_tolerances, write_json
from echofuse.conformance.target import (
    HubAnswer,
    HubTarget,
    InProcessTarget,
    NodeAnswer,
    NodeTarget,
    Report,
    Scan,
)

DEFAULT = Choice(name="default")


class WrongNode:
    """A node that shows one value wrong in its second scan."""

    def __init__(self, node: NodeTarget, tap: str, spoil: Any) -> None:
        self.node, self.tap, self.spoil, self.scans = node, tap, spoil, 0

    def set_empty_room(self, scan: Scan) -> None:
        self.node.set_empty_room(scan)

    def process(self, scan: Scan, time_us: int) -> NodeAnswer | None:
        answer = self.node.process(scan, time_us)
        self.scans += 1
        if answer is not None and self.scans == 2:
            self.spoil(answer.taps[self.tap])
        return answer

    def close(self) -> None:
        self.node.close()


class WrongHub:
    """A hub that shows one value wrong in its fifth frame."""

    def __init__(self, hub: HubTarget, tap: str, spoil: Any) -> None:
        self.hub, self.tap, self.spoil, self.frames = hub, tap, spoil, 0

    def receive(self, report: Report, now_us: int) -> None:
        self.hub.receive(report, now_us)

    def poll(self, now_us: int) -> HubAnswer | None:
        answer = self.hub.poll(now_us)
        if answer is not None:
            self.frames += 1
            if self.frames == 5:
                self.spoil(answer.taps[self.tap])
        return answer

    def close(self) -> None:
        self.hub.close()


class WrongTarget:
    """The library but for one value of one tap."""

    name = "wrong"

    def __init__(self, tap: str, spoil: Any) -> None:
        self.tap, self.spoil, self.right = tap, spoil, InProcessTarget()

    def node(self, config: Any) -> NodeTarget:
        return WrongNode(self.right.node(config), self.tap, self.spoil)

    def hub(self, config: Any) -> HubTarget:
        return WrongHub(self.right.hub(config), self.tap, self.spoil)

    def close(self) -> None:
        self.right.close()


def add(where: Any, value: float) -> Any:
    def spoil(array: Any) -> None:
        array[where] += value

    return spoil


def scale(where: Any, factor: float) -> Any:
    def spoil(array: Any) -> None:
        array[where] *= factor

    return spoil


def flip(sample: int) -> Any:
    def spoil(array: Any) -> None:
        array[sample] = 1.0 - array[sample]

    return spoil


def failed(board: Scoreboard) -> list[Row]:
    return [row for row in board.rows() if not row.passed]


@pytest.mark.parametrize(
    ("tap", "spoil", "named"),
    [
        ("envelope", add(700, 0.05), "element 700"),
        ("alignment", add(0, 0.01), "element 0"),
        ("residual", add(555, 1.0), "element 555"),
        ("threshold", scale(900, 1.1), "element 900"),
        ("decisions", flip(432), "element 432"),
        ("range_clusters", add((0, 1), 1.0), "element 0"),
        ("detections", add((0, 0), 1e-11), "element 0"),
    ],
)
def test_a_node_that_is_wrong_in_one_place_fails_there(tap: str, spoil: Any, named: str) -> None:
    board = Scoreboard()
    conform_node(board, DEFAULT, WrongTarget(tap, spoil), list(simulated_inputs(1)))
    rows = failed(board)
    assert [row.tap for row in rows] == [tap]
    assert len(rows[0].failures) == 1
    assert named in rows[0].failures[0]
    assert "seed 0" in rows[0].failures[0]
    assert "scan 1" in rows[0].failures[0]
    shown = format_scores({"node": board})
    assert f"FAILED: default: {tap}" in shown
    assert named in shown


@pytest.mark.parametrize(
    ("tap", "spoil", "named"),
    [
        ("frame", add((0, 0), 1.0), "element 0"),
        ("points", add((0, 0), 0.01), "element 0"),
        ("predicted", add((17, 0), 0.001), "element 68"),
        ("updated", add((3, 4), 0.01), "element 3"),
        ("peaks", add((0, 1), 0.01), "element 1"),
        ("resampled", add((9, 4), 0.01), "element 9"),
        ("tracks", add((0, 1), 1.0), "element 1"),
    ],
)
def test_a_hub_that_is_wrong_in_one_place_fails_there(tap: str, spoil: Any, named: str) -> None:
    board = Scoreboard()
    conform_hub(board, DEFAULT, WrongTarget(tap, spoil), list(simulated_hub_inputs(1)))
    row = next(row for row in failed(board) if row.tap == tap)
    assert named in row.failures[0]
    assert "frame 4" in row.failures[0]


def test_a_target_without_a_tap_fails() -> None:
    class Silent(WrongNode):
        def process(self, scan: Scan, time_us: int) -> NodeAnswer | None:
            answer = self.node.process(scan, time_us)
            if answer is not None:
                del answer.taps["residual"]
            return answer

    class SilentTarget(WrongTarget):
        def node(self, config: Any) -> NodeTarget:
            return Silent(self.right.node(config), "", None)

    board = Scoreboard()
    conform_node(board, DEFAULT, SilentTarget("", None), list(simulated_inputs(1)))
    assert {row.tap for row in failed(board)} >= {"residual", "decisions"}
    assert "no such tap" in next(row for row in failed(board) if row.tap == "residual").failures[0]


def test_a_coin_toss_is_excused_and_nothing_else() -> None:
    board = Scoreboard()
    assert not board.decisions("c", "t", "here", [0, 1, 1], [0, 1, 0], [1.0, 1.0, 9e-6])
    assert board.passed
    assert board.row("c", "t").excused == 1
    assert not board.decisions("c", "t", "here", [0, 1, 1], [0, 1, 0], [1.0, 1.0, 1.1e-5])
    assert not board.passed
    assert "element 2 is 1, the reference says 0" in board.row("c", "t").failures[0]


def test_floats_that_are_no_numbers_fail() -> None:
    board = Scoreboard()
    assert not board.floats("c", "t", "here", [1.0, np.nan], [1.0, 1.0], "sensor_radar.scan")
    assert not board.floats("c", "t", "here", [1.0], [1.0, 1.0], "sensor_radar.scan")
    assert [row.passed for row in board.rows()] == [False]


def enumerations(config: Any, prefix: str = "") -> dict[str, set[str]]:
    """Every field that is a choice, of a configuration and its stages: its name and all words."""
    found: dict[str, set[str]] = {}
    for name in config.fields():
        value = getattr(config, name)
        if hasattr(value, "__members__"):
            found[prefix + name] = set(value.__members__)
        elif hasattr(value, "fields"):
            found |= enumerations(value, f"{prefix}{name}.")
    return found


@pytest.mark.parametrize(
    ("config", "choices"),
    [
        (_core.SensorRadarNodeConfig(), NODE_CHOICES),
        (_core.SensorRadarHubConfig(), HUB_CHOICES),
    ],
    ids=["node", "hub"],
)
def test_every_choice_of_every_stage_is_conformed(config: Any, choices: Any) -> None:
    for key, words in enumerations(config).items():
        *stages, name = key.split(".")
        owner = config
        for stage in stages:
            owner = getattr(owner, stage)
        conformed = {getattr(owner, name).name} | {
            choice.settings[key] for choice in choices if key in choice.settings
        }
        assert conformed == words, key
    names = [choice.name for choice in choices]
    assert len(set(names)) == len(names)


@pytest.mark.slow
def test_the_library_agrees_with_the_reference(tmp_path: Any) -> None:
    scores = run(InProcessTarget(), Plan(seeds=2, end_to_end_frames=8))
    table = format_scores(scores.boards)
    assert scores.passed, table
    node, hub = scores.boards["node"], scores.boards["hub"]
    assert len(node.rows()) == len(NODE_CHOICES) * len(NODE_TAPS)
    assert {row.tap for row in hub.rows()} == {*MEASURE_TAPS, *PHD_TAPS, "tracks"}
    write_json(tmp_path / "conformance.json", scores.boards, {"seeds": 2})
    written = json.loads((tmp_path / "conformance.json").read_text())
    assert written["passed"]
    assert len(written["rows"]["node"]) == len(node.rows())
    assert "sensor_radar.residual" in format_tolerances()


@pytest.mark.slow
def test_the_library_agrees_on_the_real_walk() -> None:
    walk = real_walk()
    if walk is None:
        pytest.skip("no p410-triangle in ../shared/data or $ECHOFUSE_DATA")
    choices = ("default", "clutter.method=exponential_average, learnt", "cfar.method=cell_averaging")
    plan = Plan(
        seeds=0,
        recording=walk,
        node_choices=[choice for choice in NODE_CHOICES if choice.name in choices],
        hub_choices=[DEFAULT, replace(DEFAULT, name="kalman", settings={"tracker": "kalman"})],
        end_to_end_frames=0,
    )
    scores = run(InProcessTarget(), plan)
    assert scores.passed, format_scores(scores.boards)


def test_an_unknown_case_is_named() -> None:
    from echofuse.errors import InputError

    with pytest.raises(InputError, match="breathing-1"):
        conform(["breathing-1"])
