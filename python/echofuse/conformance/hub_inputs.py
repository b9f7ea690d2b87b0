"""Reports to conform a hub on: what nodes say about simulated people, and about a real recording."""

from collections.abc import Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.choices import Choice, configure
from echofuse.conformance.inputs import node_config_of
from echofuse.conformance.target import InProcessTarget as Nodes
from echofuse.conformance.target import NodeTarget, Report
from echofuse.pipeline import hub_config, node_config
from echofuse.recording import Recording
from echofuse.simulation.scene import Scene, sensor_radar_scene
from echofuse.simulation.sensor_radar import SensorRadarSimulation, case_study_people
from echofuse.site import parse_site

PEOPLE_FRAMES = 6  # in a row, so that tracks are confirmed
GAPS_US = (700_000, 700_000)  # frames without anybody: silent, then dead
SCAN_PERIOD_US = 100_000
EMPTY_ROOM_SCANS = 5
STRETCHES = 3  # of a recording
NOBODY: NDArray[np.float32] = np.empty(0, np.float32)


@dataclass(frozen=True, kw_only=True)
class Instant:
    """Reports that come at one time of the hub's clock."""

    time_us: int
    reports: tuple[Report, ...]
    has_people: bool = True


@dataclass(frozen=True, kw_only=True)
class HubInput:
    """What a hub hears."""

    where: str
    base: "_core.SensorRadarHubConfig"  # what the site says
    shared_transmitter: bool
    instants: tuple[Instant, ...]
    stand_in: bool = False  # only for choices that need one transmitter, so that they too see every seed

    def config(self, choice: Choice) -> "_core.SensorRadarHubConfig":
        """Return the hub's configuration under a choice."""
        config = deepcopy(self.base)
        configure(config, choice.settings)
        return config


def simulated_hub_inputs(seeds: int) -> Iterator[HubInput]:
    """One site a seed, in turn of one transmitter, of monostatic nodes, of both; one to three people.

    Where that is not one transmitter, the same seed with one stands in.
    """
    for seed in range(seeds):
        kind = ("shared Tx", "own Tx", "mixed")[seed % 3]
        yield simulated_hub_input(seed, kind)
        if kind != "shared Tx":
            yield replace(simulated_hub_input(seed, "shared Tx"), stand_in=True)


def simulated_hub_input(seed: int, kind: str) -> HubInput:
    """Return what a hub hears of one seed at a site of one kind."""
    scene = scene_of(kind)
    people = case_study_people(1 + (seed % 5 == 3) + 2 * (seed % 10 == 7))
    simulation = SensorRadarSimulation(scene, people, seed=seed)
    nodes = [_listening_node(simulation, which) for which in range(len(scene.nodes))]
    first = 8 + 2 * seed % 40
    scans = [simulation.frame(first + k).scans for k in range(PEOPLE_FRAMES + 1)]
    heard = [[_hear(node, scan) for node, scan in zip(nodes, frame, strict=True)] for frame in scans]
    ids = [node.node_id for node in scene.nodes]
    return HubInput(
        where=f"seed {seed} ({kind}, {len(people)} people, frames from {first})",
        base=hub_config_of(scene),
        shared_transmitter=kind == "shared Tx",
        instants=tuple(_disturbed(_sequence(ids, heard), seed)),
    )


def scene_of(kind: str) -> Scene:
    """The case study with one transmitter, with monostatic nodes, or half of each."""
    shared, own = sensor_radar_scene(), sensor_radar_scene(monostatic=True)
    if kind == "mixed":
        return replace(shared, nodes=shared.nodes[:3] + own.nodes[3:])
    return shared if kind == "shared Tx" else own


def recorded_hub_inputs(recording: Recording) -> Iterator[HubInput]:
    """Stretches of a recording, heard by nodes that listened to everything before."""
    site = parse_site(recording.site_toml, "the recording's site")
    places = {place.id: place for place in site.nodes}
    nodes = []
    for source in recording.nodes:
        node = Nodes().node(node_config(site, places[source.node_id], source))
        for scan in source.reference if source.reference is not None else ():
            node.set_empty_room(np.ascontiguousarray(scan, np.float32))
        nodes.append(node)
    count = min(len(source.scans) for source in recording.nodes)
    heard = [
        [_hear(node, source.scans[k]) for node, source in zip(nodes, recording.nodes, strict=True)]
        for k in range(count)
    ]
    ids = [source.node_id for source in recording.nodes]
    transmitters = {place.tx_position_m for place in site.nodes}
    for first in np.linspace(0, count, STRETCHES + 2).astype(int)[1:-1]:
        yield HubInput(
            where=f"scans from {first}",
            base=hub_config(site),
            shared_transmitter=len(transmitters) == 1,
            instants=tuple(_sequence(ids, heard[first : first + PEOPLE_FRAMES + 1])),
        )


def _listening_node(simulation: SensorRadarSimulation, which: int) -> NodeTarget:
    node = Nodes().node(node_config_of(simulation.scene, simulation.scene.nodes[which]))
    for scan in simulation.reference(which, EMPTY_ROOM_SCANS):
        node.set_empty_room(scan)
    return node


def _hear(node: NodeTarget, scan: NDArray[np.generic]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    answer = node.process(np.ascontiguousarray(scan, np.float32), 0)
    if answer is None:
        return NOBODY, NOBODY
    delay_s, weight = np.ascontiguousarray(answer.detections.T, np.float32)
    return np.ascontiguousarray(delay_s), np.ascontiguousarray(weight)


def hub_config_of(scene: Scene, choice: Choice | None = None) -> "_core.SensorRadarHubConfig":
    """Return the configuration of a scene's hub."""
    config = _core.SensorRadarHubConfig()
    config.set_nodes(
        [node.node_id for node in scene.nodes],
        np.array([node.tx_position_m[:2] for node in scene.nodes], np.float32),
        np.array([node.rx_position_m[:2] for node in scene.nodes], np.float32),
    )
    config.set_area(*scene.area_lower_m, *scene.area_upper_m)
    configure(config, {} if choice is None else choice.settings)
    return config


def _sequence(
    ids: Sequence[int], heard: Sequence[Sequence[tuple[NDArray[np.float32], NDArray[np.float32]]]]
) -> Iterator[Instant]:
    """People, then two long steps without anybody, then people again."""
    time_us, nobody = 0, [(NOBODY, NOBODY)] * len(ids)
    steps = [(SCAN_PERIOD_US, frame) for frame in heard[:-1]]
    steps += [(gap, nobody) for gap in GAPS_US] + [(SCAN_PERIOD_US, heard[-1])]
    for number, (step_us, frame) in enumerate(steps):
        time_us += step_us
        reports = (Report(node_id, 1000 + number, *said) for node_id, said in zip(ids, frame, strict=True))
        yield Instant(time_us=time_us, reports=tuple(reports), has_people=frame is not nobody)


def _disturbed(instants: Iterator[Instant], seed: int) -> Iterator[Instant]:
    """What links do: a report lost, one doubled, one of a stranger, one malformed."""
    for number, instant in enumerate(instants):
        reports = list(instant.reports)
        first = reports[0]
        if number == 1:
            reports.insert(1, first)
        if number == 2:
            reports.append(replace(first, node_id=999))
        if number == 3 and seed % 2 == 0:
            del reports[seed % len(reports)]
        if number == 4 and seed % 2 == 1 and len(first.delay_s) > 0:
            reports[0] = replace(first, delay_s=first.delay_s * np.float32(np.nan))
        yield replace(instant, reports=tuple(reports))
