"""Reports to conform a through-wall hub on: people walk behind a wall, and receivers hear most of them."""

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.choices import Choice, configure
from echofuse.conformance.comparison import as_reference
from echofuse.conformance.hub_inputs import Instant
from echofuse.conformance.target import Report
from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.reference.hub.locate.line_locator import path_and_gradient

LINES_M = ((-0.4, 0.4), (0.4, -0.4), (-0.4, 0.4, 0.9), (-0.6, -0.3, 0.3, 0.6))  # receivers', by turns
AREA_M = (-2.35, 0.48, 2.35, 6.1)
TRANSMITTER_M = ((0.0, 0.0), (1.3, -0.2))  # by turns
FRAMES, PERIOD_US = 70, 74_000
HEARD, LOST_REPORTS, GROSS = 0.8, 0.03, 0.1  # probabilities
OWN_STD_M, COMMON_STD_M, GROSS_STD_M = 0.05, 0.08, 0.3
FALSE_TRACES = 0.4  # a receiver and response


@dataclass(frozen=True, kw_only=True)
class ThroughWallHubInput:
    """What the receivers of one site report."""

    where: str
    base: "_core.ThroughWallHubConfig"
    instants: tuple[Instant, ...]

    def config(self, choice: Choice) -> "_core.ThroughWallHubConfig":
        """Return the hub's configuration under a choice."""
        config = deepcopy(self.base)
        configure(config, choice.settings)
        return config


def simulated_through_wall_reports(seeds: int) -> Iterator[ThroughWallHubInput]:
    """Two to four receivers by turns, one to three people who walk to and fro."""
    for seed in range(seeds):
        rng = np.random.default_rng([seed, 402])
        line_m = np.array(LINES_M[seed % len(LINES_M)])
        tx_m = np.array(TRANSMITTER_M[seed % len(TRANSMITTER_M)])
        config = _core.ThroughWallHubConfig()
        rx_m = np.column_stack([line_m + tx_m[0], np.full(len(line_m), tx_m[1])])
        ids = [10 + r for r in range(len(line_m))]
        config.set_nodes(ids, np.tile(tx_m, (len(ids), 1)).astype(np.float32), rx_m.astype(np.float32))
        config.set_area(*(np.array(AREA_M) + np.tile(tx_m, 2)))
        heard = _paths_heard(rng, config, line_m, 1 + seed % 3)
        instants = []
        for frame, paths_m in enumerate(heard):
            reports = tuple(
                _report(rng, ids[r], frame, paths)
                for r, paths in enumerate(paths_m)
                if rng.random() >= LOST_REPORTS
            )
            instants.append(Instant(time_us=1_000_000 + frame * PERIOD_US, reports=reports))
        where = f"seed {seed} ({len(ids)} receivers, {1 + seed % 3} people)"
        yield ThroughWallHubInput(where=where, base=config, instants=tuple(instants))


def _paths_heard(
    rng: np.random.Generator, config: "_core.ThroughWallHubConfig", line_m: NDArray[np.float64], people: int
) -> Iterator[list[NDArray[np.float64]]]:
    """Each receiver's paths (n,) [m] of each response."""
    wall = as_reference(config).line_locator.wall
    x_m, y_m = rng.uniform(-1.8, 1.8, people), rng.uniform(1.5, 5.0, people)
    speed_mps = rng.uniform(0.5, 1.3, people) * rng.choice([-1.0, 1.0], people)
    for _ in range(FRAMES):
        y_m += speed_mps * PERIOD_US * 1e-6
        speed_mps = np.where((y_m < 1.2) | (y_m > 5.6), -speed_mps, speed_mps)
        paths: list[list[float]] = [[] for _ in line_m]
        for position_m in zip(x_m, y_m, strict=True):
            true_m, _ = path_and_gradient(wall, np.array(position_m), line_m)
            error_m = rng.normal(0.0, COMMON_STD_M) + rng.normal(0.0, OWN_STD_M, len(line_m))
            error_m += np.where(
                rng.random(len(line_m)) < GROSS, rng.normal(0.0, GROSS_STD_M, len(line_m)), 0.0
            )
            for r in np.flatnonzero(rng.random(len(line_m)) < HEARD):
                paths[r].append(float(true_m[r] + error_m[r] - 2.0 * config.body_radius_m))
        for of_receiver in paths:
            of_receiver.extend(rng.uniform(1.5, 12.5, rng.poisson(FALSE_TRACES)))
        yield [np.sort(of_receiver) for of_receiver in paths]


def _report(rng: np.random.Generator, node_id: int, frame: int, paths_m: NDArray[np.float64]) -> Report:
    weight = rng.integers(4, 9, len(paths_m)).astype(np.float32)
    return Report(node_id, frame, (paths_m / SPEED_OF_LIGHT_MPS).astype(np.float32), weight)
