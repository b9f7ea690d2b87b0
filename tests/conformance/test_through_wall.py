"""The through-wall node against its reference: it passes on the library, and fails by tap and response."""

from collections import Counter
from copy import deepcopy
from typing import Any

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance import conform
from echofuse.conformance.choices import THROUGH_WALL_HUB_CHOICES, THROUGH_WALL_NODE_CHOICES, Choice
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.conformance.sensor_radar import Scores
from echofuse.conformance.table import format_scores
from echofuse.conformance.target import HubTarget, InProcessTarget, NodeAnswer, NodeTarget, Scan, ScanTarget
from echofuse.conformance.through_wall import ThroughWallPlan, steps
from echofuse.conformance.through_wall_hub_inputs import (
    ThroughWallHubInput,
    simulated_through_wall_reports,
)
from echofuse.conformance.through_wall_hub_taps import THROUGH_WALL_HUB_TAPS, conform_through_wall_hub
from echofuse.conformance.through_wall_inputs import AT, KINDS, LASTS, ThroughWallInput, simulated_responses
from echofuse.conformance.through_wall_taps import THROUGH_WALL_NODE_TAPS, conform_through_wall_node
from echofuse.errors import InputError
from echofuse.reference.node.through_wall import ThroughWallNode

DEFAULT = Choice(name="default")


@pytest.fixture(scope="module")
def inputs() -> list[ThroughWallInput]:
    """One of each kind."""
    return list(simulated_responses(len(KINDS)))


def test_every_kind_of_response_is_judged_or_counted_as_the_reference_does(
    inputs: list[ThroughWallInput],
) -> None:
    seen: dict[str, Counter[str]] = {}
    for kind, heard in zip(KINDS, inputs, strict=True):
        config = heard.config(DEFAULT)
        core, reference = _core.ThroughWallNode(), ThroughWallNode(as_reference(config))
        assert core.configure(config) == _core.Status.ok
        states = seen[kind] = Counter()
        for index, response in enumerate(heard.responses):
            status, detections = core.process(response, index)
            report = reference.process(response.astype(np.float64))
            assert (status, core.report_ready()) == (_core.Status.ok, True)
            assert core.ready() == reference.ready
            assert len(detections) == len(report.detections)
            assert report.state == "judged" or len(detections) == 0
            states[report.state] += 1
            states["detections"] += len(detections)
        counted = core.counters()
        assert counted["responses"] == len(heard.responses)
        for state in ("dead", "saturated", "settling"):
            assert counted[f"{state}_responses"] == states[state]
        assert counted["cross_talk_missing"] == states["cross_talk_missing"]
        assert counted["time_zero_moved"] == (kind == "power-up")
        assert counted["rejected_responses"] == counted["truncated_detections"] == 0
        assert states["detections"] > 5
    assert all(states["settling"] == 13 for kind, states in seen.items() if kind != "power-up")
    assert seen["power-up"]["settling"] == 26
    assert seen["power-up"]["cross_talk_missing"] == 2  # until the third says that the cross-talk has moved
    assert seen["saturated"]["saturated"] == LASTS
    assert seen["dead"]["dead"] == LASTS
    assert seen["no cross-talk"]["cross_talk_missing"] == LASTS - 1


def test_the_library_agrees_with_the_reference(inputs: list[ThroughWallInput]) -> None:
    board = Scoreboard()
    conform_through_wall_node(board, DEFAULT, InProcessTarget(), inputs)
    assert board.passed, format_scores({"node": board})
    assert [row.tap for row in board.rows()] == list(THROUGH_WALL_NODE_TAPS)


@pytest.mark.slow
def test_the_library_agrees_under_every_choice() -> None:
    scores, plan = Scores(), ThroughWallPlan(seeds=10)
    assert len(list(steps(InProcessTarget(), plan, scores))) == plan.steps()
    assert scores.passed, format_scores(scores.boards)
    rows = scores.boards["through-wall node"].rows()
    assert len(rows) == len(THROUGH_WALL_NODE_CHOICES) * len(THROUGH_WALL_NODE_TAPS)
    assert sum(row.excused for row in rows) <= 2


class WrongNode:
    """A node that shows one value wrong in one response."""

    def __init__(self, node: ScanTarget, tap: str, where: Any, factor: float, offset: float) -> None:
        self.node, self.tap, self.where, self.factor, self.offset = node, tap, where, factor, offset
        self.heard = 0

    def process(self, scan: Scan, time_us: int) -> NodeAnswer | None:
        answer = self.node.process(scan, time_us)
        assert answer is not None
        if self.heard == AT:
            values = answer.taps[self.tap]
            values[self.where] = self.factor * values[self.where] + self.offset
        self.heard += 1
        return answer

    def close(self) -> None:
        self.node.close()


class WrongTarget:
    """The library but for one value of one tap."""

    name = "wrong"

    def __init__(self, *wrong: Any) -> None:
        self.wrong, self.right = wrong, InProcessTarget()

    def node(self, config: Any) -> NodeTarget:
        raise NotImplementedError

    def hub(self, config: Any) -> HubTarget:
        raise NotImplementedError

    def through_wall_node(self, config: Any) -> ScanTarget:
        return WrongNode(self.right.through_wall_node(config), *self.wrong)

    def close(self) -> None:
        self.right.close()


@pytest.mark.parametrize(
    ("tap", "where", "factor", "offset", "named"),
    [
        ("time_zero", 1, 1.0, 1.0, "element 1"),
        ("time_zero", 2, 1.0, 1e-3, "element 0"),
        ("rotated", 200, 1.0, 1.0, "element 200"),
        ("subtracted", 300, 1.0, 0.1, "element 300"),
        ("envelope", 310, 1.0, 0.1, "element 310"),
        ("enhanced", 60, 1.01, 0.0, "element 60"),
        ("decisions", 400, -1.0, 1.0, "element 400"),
        ("target_traces", (0, 1), 1.0, 1.0, "element 0"),
        ("leading_edges", (0, 0), 1.0, 0.01, "element 0"),
        ("detections", (0, 0), 1.001, 0.0, "element 0"),
    ],
)
def test_a_node_that_is_wrong_in_one_place_fails_there(
    inputs: list[ThroughWallInput], tap: str, where: Any, factor: float, offset: float, named: str
) -> None:
    board = Scoreboard()
    conform_through_wall_node(board, DEFAULT, WrongTarget(tap, where, factor, offset), inputs[:1])
    rows = [row for row in board.rows() if row.failures]
    assert [row.tap for row in rows] == [tap]
    assert len(rows[0].failures) == 1
    assert named in rows[0].failures[0]
    assert f"response {AT} of it" in rows[0].failures[0]


def possible_words() -> dict[str, set[str]]:
    """Every field that is a choice: its name, and the words that the node takes beside the default."""
    found: dict[str, set[str]] = {}
    for stage in _core.ThroughWallNodeConfig.fields():
        for field in getattr(getattr(_core.ThroughWallNodeConfig(), stage), "fields", tuple)():
            default = getattr(getattr(_core.ThroughWallNodeConfig(), stage), field)
            for word, value in getattr(default, "__members__", {}).items():
                config = _core.ThroughWallNodeConfig()
                setattr(getattr(config, stage), field, value)
                if value != default and config.invalid_field() is None:
                    found.setdefault(f"{stage}.{field}", set()).add(word)
    return found


def test_every_choice_of_every_stage_is_conformed() -> None:
    words = possible_words()
    assert set(words) == {"clutter.method", "envelope.method", "gaussian_cfar.spread", "leading_edge.rule"}
    for key, others in words.items():
        conformed = {choice.settings[key] for choice in THROUGH_WALL_NODE_CHOICES if key in choice.settings}
        assert conformed == others, key
    names = [choice.name for choice in THROUGH_WALL_NODE_CHOICES]
    assert len(set(names)) == len(names)


def test_conform_compares_the_case(tmp_path: Any, capsys: Any) -> None:
    assert conform(["through-wall"], seeds=1, out=tmp_path)
    assert "through-wall node" in capsys.readouterr().out
    assert (tmp_path / "conformance.json").exists()
    with pytest.raises(InputError, match="--recording"):
        conform(["through-wall"], seeds=1, recording=tmp_path)


@pytest.fixture(scope="module")
def reports() -> list[ThroughWallHubInput]:
    """Two, three and four receivers."""
    return list(simulated_through_wall_reports(4))


@pytest.mark.parametrize("choice", THROUGH_WALL_HUB_CHOICES, ids=lambda choice: choice.name)
def test_the_hub_agrees_with_the_reference(choice: Choice, reports: list[ThroughWallHubInput]) -> None:
    board = Scoreboard()
    conform_through_wall_hub(board, choice, InProcessTarget(), reports)
    assert board.passed, format_scores({"hub": board})
    assert [row.tap for row in board.rows()] == list(THROUGH_WALL_HUB_TAPS)


def test_a_hub_that_follows_otherwise_is_found_out(reports: list[ThroughWallHubInput]) -> None:
    class Otherwise(InProcessTarget):
        def through_wall_hub(self, config: "_core.ThroughWallHubConfig") -> HubTarget:
            other = deepcopy(config)
            other.path_tracker.cut_off = 1.6
            return super().through_wall_hub(other)

    board = Scoreboard()
    conform_through_wall_hub(board, Choice(name="default"), Otherwise(), reports[:1])
    failed = [row for row in board.rows() if row.failures]
    assert [row.tap for row in failed] == ["tracks"]
    assert "seed 0 (2 receivers, 1 people), frame" in failed[0].failures[0]
