"""Raw scans to conform on: people in the simulated case study, and stretches of a real recording."""

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.choices import LEARNING, Choice, configure
from echofuse.pipeline import node_config
from echofuse.recording import NodeRecording, Recording
from echofuse.simulation.scene import RadarNode, Scene, sensor_radar_scene
from echofuse.simulation.sensor_radar import SensorRadarSimulation, case_study_people
from echofuse.site import Site, parse_site

EMPTY_ROOM_SCANS = 3
JUDGED_SCANS = 3  # of each input; a node that learns takes others before them
LEARNT_SCANS = int(LEARNING["clutter.learning_scans"])
MAX_SCANS = JUDGED_SCANS + LEARNT_SCANS
STRETCHES = 3  # of each node of a recording
SLIPS = (
    0,
    0,
    12,
    -2,
    5,
)  # [sample] by which the last scan of a seed is late: over and under the search's reach


@dataclass(frozen=True, kw_only=True)
class NodeInput:
    """What one node hears."""

    where: str
    base: "_core.SensorRadarNodeConfig"  # what site and radar say
    empty_room: NDArray[np.float32]  # (k, n_samples) [count]; k may be 0
    scans: NDArray[np.float32]  # (n_scans, n_samples) [count]

    def has_empty_room(self, choice: Choice) -> bool:
        """Whether the background is given; otherwise the node learns it."""
        return len(self.empty_room) > 0 and not choice.learns

    def config(self, choice: Choice) -> "_core.SensorRadarNodeConfig":
        """Return the node's configuration under a choice."""
        config = deepcopy(self.base)
        if not self.has_empty_room(choice):
            configure(config, LEARNING)
        configure(config, choice.settings)
        return config

    def scans_of(self, choice: Choice) -> NDArray[np.float32]:
        """Return the scans that are fed under a choice: the last ones, as many as it needs."""
        if not self.has_empty_room(choice) or "pulse_integrator.pulses_per_scan" in choice.settings:
            return self.scans
        return self.scans[-JUDGED_SCANS:]


def simulated_inputs(seeds: int) -> Iterator[NodeInput]:
    """One node a seed: one to three people, both kinds of nodes, half of them with a shadowed direct path."""
    for seed in range(seeds):
        scene = sensor_radar_scene(monostatic=seed % 2 == 1)
        simulation = SensorRadarSimulation(scene, case_study_people(1 + seed % 3), seed=seed)
        which = seed % len(scene.nodes)
        node = scene.nodes[which]
        first = crossing_frame(node, simulation) - MAX_SCANS // 2 if seed % 4 < 2 else 5 + 2 * seed % 40
        first = max(0, first)
        scans = np.stack([simulation.frame(first + k).scans[which] for k in range(MAX_SCANS)])
        scans[-1] = np.roll(scans[-1], SLIPS[seed % len(SLIPS)])
        yield NodeInput(
            where=f"seed {seed} ({'own' if seed % 2 else 'shared'} Tx, {node.name}, frames from {first})",
            base=node_config_of(scene, node),
            empty_room=simulation.reference(which, EMPTY_ROOM_SCANS),
            scans=scans,
        )


def node_config_of(scene: Scene, node: RadarNode) -> "_core.SensorRadarNodeConfig":
    """Return the configuration of a scene's node."""
    return _core.SensorRadarNodeConfig(
        node_id=node.node_id,
        n_samples=scene.radio.n_samples,
        sample_rate_hz=scene.radio.sample_rate_hz,
        first_sample_s=scene.first_sample_s(node),
        baseline_m=node.baseline_m,
    )


def crossing_frame(node: RadarNode, simulation: SensorRadarSimulation) -> int:
    """The frame in which the first person comes nearest to the line from transmitter to receiver."""
    time_s = np.arange(55) * simulation.scene.scan_period_s
    tx, rx = np.array(node.tx_position_m[:2]), np.array(node.rx_position_m[:2])
    offset = simulation.people[0].walk.position_m(time_s) - tx  # (n, 2)
    along = np.clip(offset @ (rx - tx) / np.sum((rx - tx) ** 2), 0.0, 1.0)
    return int(np.argmin(np.linalg.norm(offset - along[:, None] * (rx - tx), axis=1)))


def recorded_inputs(recording: Recording) -> Iterator[NodeInput]:
    """Stretches of every node's scans, spread over the recording."""
    site = parse_site(recording.site_toml, "the recording's site")
    for node in recording.nodes:
        last = max(0, len(node.scans) - MAX_SCANS)
        for first in np.unique(np.linspace(0, last, STRETCHES).astype(int)):
            yield _stretch(site, node, int(first))


def _stretch(site: Site, node: NodeRecording, first: int) -> NodeInput:
    place = next(place for place in site.nodes if place.id == node.node_id)
    empty = node.scans[:0] if node.reference is None else node.reference[:EMPTY_ROOM_SCANS]
    return NodeInput(
        where=f"{node.name}, scans from {first}",
        base=node_config(site, place, node),
        empty_room=np.ascontiguousarray(empty, np.float32),
        scans=np.ascontiguousarray(node.scans[first : first + MAX_SCANS], np.float32),
    )
