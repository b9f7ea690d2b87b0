"""One response of a through-wall radar: both receivers and their hub."""

from itertools import count
from typing import Any

import numpy as np

from echofuse import _core
from echofuse.bench.hub_cases import columns
from echofuse.bench.material import accept, accepted, back_and_forth
from echofuse.bench.timing import Case, Run, timed
from echofuse.conformance.comparison import as_reference, to_float64
from echofuse.pipeline import hub_config, node_config
from echofuse.recording import NodeRecording
from echofuse.reference.hub.measure.frame_assembler import Report
from echofuse.reference.hub.through_wall import ThroughWallHub
from echofuse.reference.node.through_wall import ThroughWallNode
from echofuse.simulation.through_wall import simulate_through_wall
from echofuse.simulation.through_wall_scene import case_study_walkers, through_wall_scene
from echofuse.site import example_site

SEED, PEOPLE = 1, 2
RESPONSES = 60  # of which the first ones teach time zero and background
RESPONSE_US = 74_000


def through_wall_frame_case() -> Case:
    """Both receivers process a response each, and the hub what they report."""
    site = example_site("through_wall")
    recording = simulate_through_wall(
        through_wall_scene(),
        case_study_walkers(PEOPLE),
        seed=SEED,
        duration_s=RESPONSES * RESPONSE_US * 1e-6,
    )
    sources = recording.nodes
    configs = [node_config(site, place, source) for place, source in zip(site.nodes, sources, strict=True)]
    hub = hub_config(site)
    return Case(
        group="frame",
        name="through the wall",
        core=_core_frame(configs, hub, sources),
        reference=_reference_frame(configs, hub, sources),
        in_step=True,
    )


def _core_frame(configs: list[Any], hub_config: Any, sources: tuple[NodeRecording, ...]) -> Run:
    nodes, hub = [_core.ThroughWallNode() for _ in configs], _core.ThroughWallHub()
    accept(hub.configure(hub_config))
    for node, config in zip(nodes, configs, strict=True):
        accept(node.configure(config))
    scans = [np.ascontiguousarray(source.scans, np.float32) for source in sources]
    order, numbers = back_and_forth(RESPONSES), count()

    def call() -> object:
        number, index = next(numbers), order()
        now_us = number * RESPONSE_US
        for node, config, heard in zip(nodes, configs, scans, strict=True):
            _, rows = node.process(heard[index], now_us)
            hub.receive(config.node_id, number, *columns(rows), now_us)
        return hub.poll(now_us)

    return timed(accepted(call))


def _reference_frame(configs: list[Any], hub_config: Any, sources: tuple[NodeRecording, ...]) -> Run:
    nodes = [ThroughWallNode(as_reference(config)) for config in configs]
    limits = _core.LIMITS
    hub = ThroughWallHub(as_reference(hub_config), limits["max_points_per_frame"], limits["max_tracks"])
    scans = [to_float64(source.scans) for source in sources]
    order, numbers = back_and_forth(RESPONSES), count()

    def call() -> object:
        number, index = next(numbers), order()
        for node, config, heard in zip(nodes, configs, scans, strict=True):
            delay_s, weight = node.process(heard[index]).taps["detections"].T
            hub.receive(Report(config.node_id, number, delay_s, weight), number * RESPONSE_US)
        return hub.poll(number * RESPONSE_US)

    call()  # as the library did when it was accepted
    return timed(call)
