"""What the measured images are fed: the case study, and the worst that `limits.hpp` lets in."""

from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray

from echofuse.pipeline import SensorRadar, node_config, scans_in_time_order
from echofuse.simulation.scene import sensor_radar_scene
from echofuse.simulation.sensor_radar import case_study_people, simulate
from echofuse.site import example_site

Values = NDArray[np.float32]
PERIOD_US = 100_000


@dataclass
class Feed:
    """The first step's settings, steps of the empty room, and the steps that are measured."""

    settings: list[float]
    empty_room: list[Values] = field(default_factory=list)
    steps: list[Values] = field(default_factory=list)
    expected: list[bytes] = field(default_factory=list)  # what the library says to each step in this process


@cache
def case_study() -> tuple[Feed, Feed]:
    """One person's walk: the feeds of the first node, and of the hub."""
    site = example_site("sensor_radar")
    recording = simulate(sensor_radar_scene(), case_study_people(1), seed=0)
    radar = SensorRadar(site, recording.nodes)
    source = recording.nodes[0]
    config = node_config(site, site.nodes[0], source)
    node = Feed([config.baseline_m, config.delay_offset_s], list(source.reference), list(source.scans))
    hub = Feed(_site(site.bounds_m, [(n.id, *n.tx_position_m[:2], *n.rx_position_m[:2]) for n in site.nodes]))
    hub.settings[5] = radar.hub_config.ellipse.body_radius_m
    reports: list[list[float]] = [[] for _ in source.scans]
    for scan in scans_in_time_order(recording.nodes):
        output = radar.scan(scan, recording.nodes[scan.node].scans[scan.index])
        pairs = [float(value) for detection in output.detections for value in detection.tolist()]
        reports[scan.index] += [recording.nodes[scan.node].node_id, scan.index, len(pairs) // 2, *pairs]
        if scan.node == 0:
            node.expected.append(np.array(pairs, "<f4").tobytes())
    hub.steps = [np.array(report, np.float32) for report in reports]
    return node, hub


def worst_case(n_nodes: int, n_detections: int, n_frames: int = 12) -> Feed:
    """Every node sees something everywhere: random paths."""
    random = np.random.default_rng(5)
    angles = 2.0 * np.pi * np.arange(n_nodes) / n_nodes
    area = (-10.0, -10.0, 10.0, 10.0)
    places = [(i + 1, 0.5, 0.2, 9.5 * np.cos(a), 9.5 * np.sin(a)) for i, a in enumerate(angles)]
    feed = Feed(_site(area, places))
    for frame in range(n_frames):
        values: list[float] = []
        for place in places:
            delays = np.sort(random.uniform(40e-9, 110e-9, n_detections))
            values += [place[0], frame, n_detections]
            values += [float(value) for delay in delays for value in (delay, random.uniform(4, 40))]
        feed.steps.append(np.array(values, np.float32))
    return feed


def _site(area: tuple[float, ...], nodes: list[tuple[float, ...]]) -> list[float]:
    phd = 0.0
    return [*area, phd, 0.18, *(value for node in nodes for value in node)]
