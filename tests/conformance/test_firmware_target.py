"""Conformance of firmware: it agrees on its taps, and one that is configured otherwise is found out."""

import json
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from echofuse.cli import main
from echofuse.conformance.choices import (
    NODE_CHOICES,
    STAIRS_NODE_CHOICES,
    THROUGH_WALL_3D_HUB_CHOICES,
    THROUGH_WALL_HUB_CHOICES,
    THROUGH_WALL_NODE_CHOICES,
    Choice,
)
from echofuse.conformance.comparison import Row, Scoreboard
from echofuse.conformance.firmware_target import FirmwareConformanceTarget
from echofuse.conformance.hub_inputs import simulated_hub_inputs
from echofuse.conformance.hub_taps import conform_hub
from echofuse.conformance.inputs import simulated_inputs
from echofuse.conformance.node_taps import conform_node
from echofuse.conformance.through_wall_hub_inputs import (
    simulated_climb_reports,
    simulated_through_wall_reports,
)
from echofuse.conformance.through_wall_hub_taps import conform_through_wall_hub
from echofuse.conformance.through_wall_inputs import simulated_responses
from echofuse.conformance.through_wall_taps import conform_through_wall_node

DEFAULT = Choice(name="default")


@pytest.fixture
def target() -> Iterator[FirmwareConformanceTarget]:
    with closing(FirmwareConformanceTarget("process")) as opened:
        yield opened


def failed(board: Scoreboard) -> list[Row]:
    return [row for row in board.rows() if not row.passed]


def test_one_board_takes_one_choice_after_the_other(target: FirmwareConformanceTarget) -> None:
    """What the one before has left in it, filters, background, counters, would show."""
    board = Scoreboard()
    for choice in NODE_CHOICES[:8]:
        conform_node(board, choice, target, list(simulated_inputs(1)))
    for tracker in ("kalman", "range", "phd"):
        choice = Choice(name=tracker, settings={"tracker": tracker})
        conform_hub(board, choice, target, list(simulated_hub_inputs(1)))
    for choice in THROUGH_WALL_NODE_CHOICES[:4]:
        heard = simulated_responses(2, long_sequence=choice.long_sequence)
        conform_through_wall_node(board, choice, target, list(heard))
    for choice in THROUGH_WALL_HUB_CHOICES[:4]:
        conform_through_wall_hub(board, choice, target, list(simulated_through_wall_reports(2)))
    for choice in THROUGH_WALL_3D_HUB_CHOICES[:4]:
        conform_through_wall_hub(board, choice, target, list(simulated_climb_reports(2)))
    assert [row.failures for row in board.rows() if row.failures] == []


class OtherwiseConfigured(FirmwareConformanceTarget):
    """Boards of which one register is changed behind the comparison's back."""

    def __init__(self, role: str, register: str, value: object) -> None:
        super().__init__("process")
        self.role, self.register, self.value = role, register, value

    def _machine(self, pipeline: str, role: str, config: Any) -> Any:
        opened = super()._machine(pipeline, role, config)
        if role == self.role:
            written = opened.machine.write_register(self.register, self.value)
            assert written == pytest.approx(self.value)
        opened.machine.write_register("echofuse.apply", False)
        if opened.machine.write_register("echofuse.apply", True) is not True:
            opened.machine.step(1)
        return opened


@pytest.mark.parametrize(
    ("register", "value", "tap"),
    [
        ("envelope.hilbert_half_length_samples", 9, "envelope"),
        ("cfar.local_factor", 5.01, "threshold"),
        ("range_clusters.merge_distance_s", 1e-9, "range_clusters"),
    ],
)
def test_a_node_that_is_configured_otherwise_fails_there(register: str, value: object, tap: str) -> None:
    board = Scoreboard()
    with closing(OtherwiseConfigured("node", register, value)) as target:
        conform_node(board, DEFAULT, target, list(simulated_inputs(2)))
    assert tap in [row.tap for row in failed(board)]
    assert "the reference says" in failed(board)[0].failures[0] or "shape" in failed(board)[0].failures[0]


@pytest.mark.parametrize(
    ("register", "value", "tap"),
    [("selection.support_gate_m", 0.2, "selected"), ("phd.seed", np.uint64(2), "predicted")],
)
def test_a_hub_that_is_configured_otherwise_fails_there(register: str, value: object, tap: str) -> None:
    board = Scoreboard()
    with closing(OtherwiseConfigured("hub", register, value)) as target:
        conform_hub(board, DEFAULT, target, list(simulated_hub_inputs(2)))
    assert tap in [row.tap for row in failed(board)]


@pytest.mark.parametrize(
    ("register", "value", "tap"),
    [
        ("clutter.averaging_factor", 0.949, "subtracted"),
        ("gaussian_cfar.deviations", 0.72, "decisions"),
        ("leading_edge.fraction", 0.501, "leading_edges"),
    ],
)
def test_a_receiver_that_is_configured_otherwise_fails_there(register: str, value: object, tap: str) -> None:
    board = Scoreboard()
    with closing(OtherwiseConfigured("node", register, value)) as target:
        conform_through_wall_node(board, DEFAULT, target, list(simulated_responses(2)))
    assert tap in [row.tap for row in failed(board)]


@pytest.mark.parametrize(
    ("register", "value", "tap"),
    [("line_locator.wall.thickness_m", 0.2, "points"), ("path_tracker.cut_off", 1.6, "tracks")],
)
def test_a_hub_behind_a_wall_that_is_configured_otherwise_fails_there(
    register: str, value: object, tap: str
) -> None:
    board = Scoreboard()
    with closing(OtherwiseConfigured("hub", register, value)) as target:
        conform_through_wall_hub(board, DEFAULT, target, list(simulated_through_wall_reports(2)))
    assert tap in [row.tap for row in failed(board)]


@pytest.mark.parametrize(
    ("register", "value", "tap"),
    [
        ("taylor_3d.wall.thickness_m", 0.25, "points"),
        ("path_tracker.cut_off", 1.6, "tracks"),
        ("nodes.3.rx.z_m", 0.3905, "points"),
    ],
)
def test_a_hub_in_space_that_is_configured_otherwise_fails_there(
    register: str, value: object, tap: str
) -> None:
    board = Scoreboard()
    with closing(OtherwiseConfigured("hub", register, value)) as target:
        conform_through_wall_hub(board, DEFAULT, target, list(simulated_climb_reports(2)))
    assert tap in [row.tap for row in failed(board)]


STAIRS_ROWS = 10 * len(STAIRS_NODE_CHOICES) + 4 * len(THROUGH_WALL_3D_HUB_CHOICES)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "rows"), [("sensor-radar", 436), ("through-wall", 208), ("stairs", STAIRS_ROWS)]
)
@pytest.mark.parametrize("name", ["process", "cortex-m7"])
def test_every_tap_of_every_choice_agrees(name: str, case: str, rows: int, tmp_path: Path) -> None:
    assert main(["conform", case, "--target", name, "--seeds", "2", "--out", str(tmp_path)]) == 0
    report = json.loads((tmp_path / "conformance.json").read_text())
    assert (report["target"], report["passed"]) == (name, True)
    assert sum(len(table) for table in report["rows"].values()) == rows


def test_an_image_that_is_missing_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setenv("ECHOFUSE_FIRMWARE", str(tmp_path))
    assert main(["conform", "--target", "process", "--seeds", "1"]) == 1
    assert capsys.readouterr().err.count("\n") == 1
