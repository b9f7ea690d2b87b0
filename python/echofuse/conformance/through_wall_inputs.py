"""Responses to conform a through-wall node on: people in simulated case studies, and what may go wrong."""

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.choices import Choice, configure
from echofuse.simulation.stairs import stairs_climber, stairs_scene
from echofuse.simulation.through_wall import ThroughWallSimulation
from echofuse.simulation.through_wall_scene import case_study_walkers, through_wall_scene
from echofuse.site import apply_settings, example_site

KINDS = ("plain", "power-up", "saturated", "dead", "no cross-talk")  # of a seed, by turns
SETTLED = 13  # responses until time zero and background are known, by default
RESPONSES = SETTLED + 24  # past the 20 of which the background is a plain mean
AT = SETTLED + 4  # where something goes wrong
LASTS = 3  # responses


@dataclass(frozen=True, kw_only=True)
class ThroughWallInput:
    """What one receiver hears."""

    where: str
    base: "_core.ThroughWallNodeConfig"
    responses: NDArray[np.float32]  # (n_responses, n_samples) [count]

    def config(self, choice: Choice) -> "_core.ThroughWallNodeConfig":
        """Return the node's configuration under a choice."""
        config = deepcopy(self.base)
        configure(config, choice.settings)
        return config


def simulated_responses(seeds: int, *, long_sequence: bool = False) -> Iterator[ThroughWallInput]:
    """One receiver a seed, one to four people; every kind of trouble by turns.

    long_sequence: one person on the stairs, 4095 samples, as the stairs' site says how to process them.
    """
    scene = stairs_scene() if long_sequence else through_wall_scene()
    for seed in range(seeds):
        kind = KINDS[seed % len(KINDS)]
        first = 17 * seed % 60
        again_s = ((first + AT - 0.5) * scene.scan_period_s,) if kind == "power-up" else ()
        people = (stairs_climber(),) if long_sequence else case_study_walkers(1 + seed % 4)
        simulation = ThroughWallSimulation(scene, people, seed=seed, power_up_s=again_s)
        which = seed % len(scene.nodes)
        node, total = scene.nodes[which], AT + RESPONSES if again_s else RESPONSES
        responses = np.stack([simulation.frame(first + k).scans[which] for k in range(total)])
        full_scale = 1.1 * float(np.max(np.abs(responses)))
        wrong = responses[AT : AT + LASTS]  # a view
        if kind == "saturated":
            wrong[:] = np.clip(5.0 * wrong, -full_scale, full_scale)
        elif kind == "dead":
            wrong[:] = 0.0
        elif kind == "no cross-talk":
            wrong[1:] = np.random.default_rng(seed).normal(0.0, 8.0, wrong[1:].shape)
        config = _core.ThroughWallNodeConfig(
            node_id=node.node_id,
            n_samples=scene.radar.n_samples,
            sample_rate_hz=scene.radar.clock_hz,
            baseline_m=node.baseline_m,
            full_scale_count=full_scale,
        )
        if long_sequence:
            apply_settings(config, example_site("stairs").settings)
        yield ThroughWallInput(
            where=f"seed {seed} ({kind}, {node.name}, responses from {first})",
            base=config,
            responses=np.ascontiguousarray(responses, np.float32),
        )
