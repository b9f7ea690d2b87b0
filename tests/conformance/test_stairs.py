"""Nodes and hub of the stairs against their references: they pass on the library, and fail by tap."""

from collections.abc import Iterator
from copy import deepcopy
from typing import Any

import pytest

from echofuse import _core
from echofuse.conformance import conform
from echofuse.conformance.choices import STAIRS_NODE_CHOICES, THROUGH_WALL_3D_HUB_CHOICES, Choice
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.conformance.hub_reference import reference_report
from echofuse.conformance.sensor_radar import Scores
from echofuse.conformance.table import format_scores
from echofuse.conformance.target import HubTarget, InProcessTarget
from echofuse.conformance.through_wall import stairs_plan, steps
from echofuse.conformance.through_wall_hub_inputs import ThroughWallHubInput, simulated_climb_reports
from echofuse.conformance.through_wall_hub_taps import (
    DEADLINE_US,
    THROUGH_WALL_HUB_TAPS,
    conform_through_wall_hub,
)
from echofuse.pipeline import hub_config
from echofuse.reference.hub.through_wall_3d import ThroughWall3dHub
from echofuse.site import example_site

DEFAULT = Choice(name="default")


@pytest.fixture(scope="module")
def reports() -> list[ThroughWallHubInput]:
    """One who climbs, and two of whom one comes down."""
    return list(simulated_climb_reports(2))


@pytest.mark.parametrize("choice", THROUGH_WALL_3D_HUB_CHOICES, ids=lambda choice: choice.name)
def test_the_hub_agrees_with_the_reference(choice: Choice, reports: list[ThroughWallHubInput]) -> None:
    board = Scoreboard()
    conform_through_wall_hub(board, choice, InProcessTarget(), reports)
    assert board.passed, format_scores({"hub": board})
    assert [row.tap for row in board.rows()] == list(THROUGH_WALL_HUB_TAPS)
    assert sum(row.excused for row in board.rows()) == 0
    (frames,) = (row.cases for row in board.rows() if row.tap == "associated")
    assert frames == sum(len(heard.instants) for heard in reports)


def test_the_hub_counts_what_the_reference_does(reports: list[ThroughWallHubInput]) -> None:
    first_pairs = Choice(name="paper", settings={"track_aided": False})
    for heard in reports:
        config, hub = heard.config(first_pairs), _core.ThroughWall3dHub()
        assert hub.configure(config) == _core.Status.ok
        capacities = _core.LIMITS["max_points_per_frame"], _core.LIMITS["max_tracks"]
        reference = ThroughWall3dHub(as_reference(config), *capacities)
        for instant in heard.instants:
            for report in instant.reports:
                hub.receive(report.node_id, report.frame, report.delay_s, report.weight, instant.time_us)
                reference.receive(reference_report(report), instant.time_us)
            for now_us in (instant.time_us, instant.time_us + DEADLINE_US):
                hub.poll(now_us)
                reference.poll(now_us)
        counted = hub.counters()
        assert (counted["quads"], counted["clipped"]) == (reference.quads, reference.clipped)
        assert counted["quads"] > 30
        assert counted["accepted"] == sum(len(instant.reports) for instant in heard.instants)


@pytest.mark.slow
def test_the_library_agrees_under_every_choice() -> None:
    scores, plan = Scores(), stairs_plan(5)
    assert len(list(steps(InProcessTarget(), plan, scores))) == plan.steps()
    assert scores.passed, format_scores(scores.boards)
    assert list(scores.boards) == ["stairs node", "stairs hub"]
    assert sum(row.excused for board in scores.boards.values() for row in board.rows()) <= 2


@pytest.mark.parametrize(
    ("field", "value", "tap"),
    [
        ("path_tracker.cut_off", 1.6, "tracks"),
        ("path_tracker.body_half_height_m", 0.3, "tracks"),
        ("range_difference_m", 0.02, "associated"),
    ],
)
def test_a_hub_that_follows_otherwise_is_found_out(
    field: str, value: float, tap: str, reports: list[ThroughWallHubInput]
) -> None:
    class Otherwise(InProcessTarget):
        def through_wall_3d_hub(self, config: "_core.ThroughWall3dHubConfig") -> HubTarget:
            other = deepcopy(config)
            owner = other.path_tracker if field.startswith("path_tracker.") else other
            setattr(owner, field.rpartition(".")[2], value)
            return super().through_wall_3d_hub(other)

    board = Scoreboard()
    conform_through_wall_hub(board, DEFAULT, Otherwise(), reports)
    failed = {row.tap: row for row in board.rows() if row.failures}
    assert tap in failed
    assert "seed 0 (the stairs from" in failed[tap].failures[0]


def words_beside_the_default(config: Any, where: str = "") -> Iterator[tuple[str, str]]:
    """Every choice of every stage: (field, word), without the words that are impossible."""
    for name in config.fields():
        value, path = getattr(config, name), f"{where}.{name}".lstrip(".")
        if hasattr(value, "fields"):
            yield from words_beside_the_default(value, path)
        for word, other in getattr(value, "__members__", {}).items():
            changed = deepcopy(config)
            setattr(changed, name, other)
            if other != value and changed.invalid_field() is None:
                yield path, word


def test_every_choice_of_the_hub_is_conformed() -> None:
    site = hub_config(example_site("stairs"))
    chosen = {pair for choice in THROUGH_WALL_3D_HUB_CHOICES for pair in choice.settings.items()}
    left_out = set(words_beside_the_default(site)) - chosen
    assert left_out == {
        ("trace_pairing.closing", "printed"),  # locates nobody
        ("taylor_3d.start", "given"),  # of which the hub has none
        ("taylor_3d.range_kind", "one_way"),  # no paths
        ("tracks.association", "hypothesis_cost"),  # of track manager and Kalman filter, conformed
        ("tracks.update", "kalman"),  # with the sensor radar's hub
    }
    for choices in (THROUGH_WALL_3D_HUB_CHOICES, STAIRS_NODE_CHOICES):
        assert len({choice.name for choice in choices}) == len(choices)


def test_conform_compares_the_case(tmp_path: Any, capsys: Any) -> None:
    assert conform(["stairs"], seeds=1, out=tmp_path)
    printed = capsys.readouterr().out
    assert "stairs node" in printed
    assert "stairs hub" in printed
    assert (tmp_path / "conformance.json").exists()
