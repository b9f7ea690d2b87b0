"""The comparison for the pipeline `through_wall_2d`: its node, and its hub."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from echofuse import _core
from echofuse.conformance.choices import THROUGH_WALL_HUB_CHOICES, THROUGH_WALL_NODE_CHOICES, Choice
from echofuse.conformance.sensor_radar import Scores
from echofuse.conformance.target import ConformanceTarget
from echofuse.conformance.through_wall_hub_inputs import LINES_M, simulated_through_wall_reports
from echofuse.conformance.through_wall_hub_taps import conform_through_wall_hub
from echofuse.conformance.through_wall_inputs import simulated_responses
from echofuse.conformance.through_wall_taps import conform_through_wall_node


@dataclass(frozen=True, kw_only=True)
class ThroughWallPlan:
    """How much is compared."""

    seeds: int = 20
    node_choices: Sequence[Choice] = THROUGH_WALL_NODE_CHOICES
    hub_choices: Sequence[Choice] = THROUGH_WALL_HUB_CHOICES

    def steps(self) -> int:
        """How many steps the comparison has."""
        return len(self.node_choices) + len(self.hub_choices)


def steps(target: ConformanceTarget, plan: ThroughWallPlan, scores: Scores) -> Iterator[None]:
    """Compare in `plan.steps()` steps; what is found goes into `scores`."""
    # An image or a board that is missing is told before a minute of simulation.
    target.through_wall_node(_core.ThroughWallNodeConfig()).close()
    inputs = {
        long: list(simulated_responses(plan.seeds, long_sequence=long))
        for long in {choice.long_sequence for choice in plan.node_choices}
    }
    for choice in plan.node_choices:
        heard = inputs[choice.long_sequence]
        conform_through_wall_node(scores.board("through-wall node"), choice, target, heard)
        yield
    reports = list(simulated_through_wall_reports(max(plan.seeds, len(LINES_M))))
    for choice in plan.hub_choices:
        conform_through_wall_hub(scores.board("through-wall hub"), choice, target, reports)
        yield
