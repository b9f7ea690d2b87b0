"""The whole comparison for the pipeline `sensor_radar`."""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from echofuse.conformance.choices import HUB_CHOICES, NODE_CHOICES, Choice
from echofuse.conformance.comparison import Scoreboard
from echofuse.conformance.end_to_end import FRAMES, conform_end_to_end
from echofuse.conformance.hub_inputs import HubInput, recorded_hub_inputs, simulated_hub_inputs
from echofuse.conformance.hub_taps import conform_hub
from echofuse.conformance.inputs import NodeInput, recorded_inputs, simulated_inputs
from echofuse.conformance.node_taps import conform_node
from echofuse.conformance.target import ConformanceTarget
from echofuse.recording import Recording

REAL_WALK = Path("p410-triangle")  # in the folder of data


def data_folder() -> Path:
    """Return where recorded data may lie: $ECHOFUSE_DATA, or ../shared/data beside the checkout."""
    return Path(os.environ.get("ECHOFUSE_DATA", "../shared/data"))


def real_walk() -> Recording | None:
    """Return the real walk, or None where it is not there."""
    folder = data_folder() / REAL_WALK
    if not folder.is_dir():
        return None
    from echofuse.recording.importers import import_logger

    return import_logger(folder)


@dataclass(frozen=True, kw_only=True)
class Plan:
    """How much is compared."""

    seeds: int = 20
    recording: Recording | None = None
    node_choices: Sequence[Choice] = NODE_CHOICES
    hub_choices: Sequence[Choice] = HUB_CHOICES
    end_to_end_frames: int = FRAMES  # 0: none

    def steps(self) -> int:
        """How many steps the comparison has."""
        ticks = len(self.node_choices) + len(self.hub_choices)
        return ticks + (self.end_to_end_frames + 2 if self.end_to_end_frames else 0)


@dataclass
class Scores:
    """What was compared, by part of the pipeline."""

    boards: dict[str, Scoreboard] = field(default_factory=dict)

    def board(self, part: str) -> Scoreboard:
        """Return the scoreboard of a part, made at its first mention."""
        return self.boards.setdefault(part, Scoreboard())

    @property
    def passed(self) -> bool:
        """Whether all rows of all parts passed, and every tap was compared."""
        return bool(self.boards) and all(board.passed for board in self.boards.values())


def steps(target: ConformanceTarget, plan: Plan, scores: Scores) -> Iterator[None]:
    """Compare in `plan.steps()` steps; what is found goes into `scores`."""
    node_inputs: list[NodeInput] = list(simulated_inputs(plan.seeds))
    hub_inputs: list[HubInput] = list(simulated_hub_inputs(plan.seeds))
    if plan.recording is not None:
        node_inputs += recorded_inputs(plan.recording)
        hub_inputs += recorded_hub_inputs(plan.recording)
    for choice in plan.node_choices:
        conform_node(scores.board("node"), choice, target, node_inputs)
        yield
    for choice in plan.hub_choices:
        conform_hub(scores.board("hub"), choice, target, hub_inputs)
        yield
    if plan.end_to_end_frames:
        yield from conform_end_to_end(scores.board("all"), target, plan.end_to_end_frames)


def run(target: ConformanceTarget, plan: Plan) -> Scores:
    """Compare a target with the reference."""
    scores = Scores()
    for _ in steps(target, plan, scores):
        pass
    return scores
