"""The comparison for pipelines behind a wall: the node, and the hub in the plane or in space."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from echofuse import _core
from echofuse.conformance.choices import (
    STAIRS_NODE_CHOICES,
    THROUGH_WALL_3D_HUB_CHOICES,
    THROUGH_WALL_HUB_CHOICES,
    THROUGH_WALL_NODE_CHOICES,
    Choice,
)
from echofuse.conformance.sensor_radar import Scores
from echofuse.conformance.target import ConformanceTarget
from echofuse.conformance.through_wall_hub_inputs import (
    LINES_M,
    ThroughWallHubInput,
    simulated_climb_reports,
    simulated_through_wall_reports,
)
from echofuse.conformance.through_wall_hub_taps import conform_through_wall_hub
from echofuse.conformance.through_wall_inputs import simulated_responses
from echofuse.conformance.through_wall_taps import conform_through_wall_node


@dataclass(frozen=True, kw_only=True)
class ThroughWallPlan:
    """How much is compared, of the pipeline `through_wall_2d` unless said otherwise."""

    case: str = "through-wall"  # what its parts are called
    seeds: int = 20
    node_choices: Sequence[Choice] = THROUGH_WALL_NODE_CHOICES
    hub_choices: Sequence[Choice] = THROUGH_WALL_HUB_CHOICES
    reports: Callable[[int], Iterable[ThroughWallHubInput]] = simulated_through_wall_reports  # of seeds
    least_reports: int = len(LINES_M)  # seeds, for every kind of site

    def steps(self) -> int:
        """How many steps the comparison has."""
        return len(self.node_choices) + len(self.hub_choices)


def stairs_plan(seeds: int) -> ThroughWallPlan:
    """Of the pipeline `through_wall_3d`: a climb on the stairs."""
    return ThroughWallPlan(
        case="stairs",
        seeds=seeds,
        node_choices=STAIRS_NODE_CHOICES,
        hub_choices=THROUGH_WALL_3D_HUB_CHOICES,
        reports=simulated_climb_reports,
        least_reports=1,
    )


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
        conform_through_wall_node(scores.board(f"{plan.case} node"), choice, target, heard)
        yield
    reports = list(plan.reports(max(plan.seeds, plan.least_reports)))
    for choice in plan.hub_choices:
        conform_through_wall_hub(scores.board(f"{plan.case} hub"), choice, target, reports)
        yield
