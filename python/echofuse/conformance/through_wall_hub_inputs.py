"""Reports to conform a through-wall hub on: people walk behind a wall, and receivers hear most of them."""

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.choices import Choice, configure
from echofuse.conformance.comparison import as_reference
from echofuse.conformance.hub_inputs import Instant
from echofuse.conformance.target import Report
from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.pipeline import hub_config
from echofuse.reference.hub.track.path_tracker import paths_and_gradients
from echofuse.simulation.people import TORSO_HEIGHTS
from echofuse.simulation.stairs import climb_s, stairs_climber
from echofuse.site import example_site

Array = NDArray[np.float64]
PathHubConfig = _core.ThroughWallHubConfig | _core.ThroughWall3dHubConfig

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
    base: PathHubConfig
    instants: tuple[Instant, ...]

    def config(self, choice: Choice) -> PathHubConfig:
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
        rx_m = np.column_stack([line_m, np.zeros(len(line_m))])
        ids = [10 + r for r in range(len(line_m))]
        config.set_nodes(
            ids, np.tile(tx_m, (len(ids), 1)).astype(np.float32), (rx_m + tx_m).astype(np.float32)
        )
        config.set_area(*(np.array(AREA_M) + np.tile(tx_m, 2)))
        people_m = _to_and_fro(rng, 1 + seed % 3)
        yield ThroughWallHubInput(
            where=f"seed {seed} ({len(ids)} receivers, {1 + seed % 3} people)",
            base=config,
            instants=tuple(_instants(rng, config, config.line_locator.wall, rx_m, people_m)),
        )


def simulated_climb_reports(seeds: int) -> Iterator[ThroughWallHubInput]:
    """The stairs' cross of four receivers; one who climbs, and every other seed one who comes down too."""
    config, climber = hub_config(example_site("stairs")), stairs_climber()
    tx_m, rx_m = (
        np.array([[at.x_m, at.y_m, at.z_m] for at in (getattr(node, which) for node in config.nodes)])
        for which in ("tx", "rx")
    )
    torso_m, way_s = TORSO_HEIGHTS[1] * climber.height_m, climb_s(climber)
    time_s = PERIOD_US * 1e-6 * np.arange(FRAMES)
    for seed in range(seeds):
        rng = np.random.default_rng([seed, 404])
        begin_s = rng.uniform(0.0, way_s - time_s[-1], 1 + seed % 2) + way_s * np.arange(1 + seed % 2)
        at_s = time_s[:, None] + begin_s
        height_m = climber.walk.ground_m(at_s) + torso_m
        people_m = np.concatenate([climber.walk.position_m(at_s), height_m[..., None]], axis=-1) - tx_m[0]
        yield ThroughWallHubInput(
            where=f"seed {seed} (the stairs from {begin_s[0]:.1f} s, {1 + seed % 2} people)",
            base=config,
            instants=tuple(_instants(rng, config, config.taylor_3d.wall, rx_m - tx_m, people_m)),
        )


def _to_and_fro(rng: np.random.Generator, people: int) -> Array:
    """Where people are from the transmitter, (FRAMES, people, 2) [m]."""
    x_m, y_m = rng.uniform(-1.8, 1.8, people), rng.uniform(1.5, 5.0, people)
    speed_mps = rng.uniform(0.5, 1.3, people) * rng.choice([-1.0, 1.0], people)
    places = []
    for _ in range(FRAMES):
        y_m = y_m + speed_mps * PERIOD_US * 1e-6
        speed_mps = np.where((y_m < 1.2) | (y_m > 5.6), -speed_mps, speed_mps)
        places.append(np.column_stack([x_m, y_m]))
    return np.array(places)


def _instants(
    rng: np.random.Generator, config: PathHubConfig, wall: Any, rx_m: Array, people_m: Array
) -> Iterator[Instant]:
    """What receivers (n, d) report of people (FRAMES, people, d), both from the transmitter [m]."""
    n, wall = len(rx_m), as_reference(wall)
    for frame, positions_m in enumerate(people_m):
        paths: list[list[float]] = [[] for _ in rx_m]
        for position_m in positions_m:
            true_m, _ = paths_and_gradients(wall, position_m, rx_m)
            error_m = rng.normal(0.0, COMMON_STD_M) + rng.normal(0.0, OWN_STD_M, n)
            error_m += np.where(rng.random(n) < GROSS, rng.normal(0.0, GROSS_STD_M, n), 0.0)
            for r in np.flatnonzero(rng.random(n) < HEARD):
                paths[r].append(float(true_m[r] + error_m[r] - 2.0 * config.body_radius_m))
        for of_receiver in paths:
            of_receiver.extend(rng.uniform(1.5, 12.5, rng.poisson(FALSE_TRACES)))
        reports = tuple(
            _report(rng, config.nodes[r].node_id, frame, np.sort(of_receiver))
            for r, of_receiver in enumerate(paths)
            if rng.random() >= LOST_REPORTS
        )
        yield Instant(time_us=1_000_000 + frame * PERIOD_US, reports=reports)


def _report(rng: np.random.Generator, node_id: int, frame: int, paths_m: NDArray[np.float64]) -> Report:
    weight = rng.integers(4, 9, len(paths_m)).astype(np.float32)
    return Report(node_id, frame, (paths_m / SPEED_OF_LIGHT_MPS).astype(np.float32), weight)
