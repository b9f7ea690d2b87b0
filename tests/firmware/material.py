"""What the measured images are fed: the case study, and the worst that `limits.hpp` lets in."""

from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from echofuse import _core
from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.emulation import codec
from echofuse.emulation.codec import Transfer
from echofuse.pipeline import SensorRadar, hub_config, node_config, scans_in_time_order
from echofuse.recording import NodeRecording, Recording
from echofuse.simulation.scene import sensor_radar_scene
from echofuse.simulation.sensor_radar import case_study_people, simulate
from echofuse.site import example_site

SITE = example_site("sensor_radar")
PERIOD_US = 100_000


@dataclass
class HubFeed:
    """A hub's configuration, and what the link brings it: the reports of each frame."""

    config: Any
    frames: list[bytes]


@cache
def case_study() -> Recording:
    """One person's walk."""
    return simulate(sensor_radar_scene(), case_study_people(1), seed=0)


def node_of_the_case_study() -> tuple[Any, NodeRecording]:
    """Return the configuration and the scans of its first node."""
    source = case_study().nodes[0]
    (place,) = (place for place in SITE.nodes if place.id == source.node_id)
    return node_config(SITE, place, source), source


def hub_of_the_case_study() -> HubFeed:
    """Return what the nodes report on it."""
    nodes = case_study().nodes
    radar = SensorRadar(SITE, nodes)
    frames: dict[int, bytes] = defaultdict(bytes)
    for scan in scans_in_time_order(nodes):
        source = nodes[scan.node]
        found = radar.scan(scan, source.scans[scan.index]).detections
        frames[scan.index] += _report(source.node_id, scan.index, found["delay_s"], found["weight"])
    return HubFeed(hub_config(SITE), list(frames.values()))


def crowd(n_nodes: int, n_people: int, n_frames: int = 12) -> HubFeed:
    """People who stand all over a room, each seen by every node: of random places, with 5 cm of noise."""
    random = np.random.default_rng(5)
    angles = 2.0 * np.pi * np.arange(n_nodes) / n_nodes
    tx_m = np.tile([0.5, 0.2], (n_nodes, 1))
    rx_m = 9.5 * np.stack([np.cos(angles), np.sin(angles)], 1)
    config = _core.SensorRadarHubConfig()
    config.set_nodes(list(range(1, n_nodes + 1)), np.float32(tx_m), np.float32(rx_m))
    config.set_area(-10.0, -10.0, 10.0, 10.0)
    config.phd.area_m2 = 400.0
    config.ellipse.body_radius_m = 0.18
    people_m = random.uniform(-6.0, 6.0, (n_people, 2))
    feed = HubFeed(config, [])
    for frame in range(n_frames):
        reports = b""
        for node in range(n_nodes):
            paths_m = np.hypot(*(people_m - tx_m[node]).T) + np.hypot(*(people_m - rx_m[node]).T)
            delays_s = np.sort(paths_m + random.normal(0.0, 0.05, n_people)) / SPEED_OF_LIGHT_MPS
            reports += _report(node + 1, frame, delays_s, np.full(n_people, 9))
        feed.frames.append(reports)
    return feed


def _report(node_id: int, frame: int, delay_s: Any, weight: Any) -> bytes:
    payload = codec.detections_payload((frame + 1) * PERIOD_US, delay_s, weight)
    return codec.frame(Transfer(node_id, codec.DETECTIONS, frame, payload))
