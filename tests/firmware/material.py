"""What the measured images are fed: the case studies, and the worst that `limits.hpp` lets in."""

import math
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
from echofuse.simulation.stairs import simulate_stairs, stairs_scene
from echofuse.simulation.through_wall import simulate_through_wall
from echofuse.simulation.through_wall_scene import case_study_walkers, through_wall_scene
from echofuse.site import Site, example_site

SITE, BEFORE_A_WALL = example_site("sensor_radar"), example_site("through_wall")
BESIDE_STAIRS = example_site("stairs")
PERIOD_US = 100_000
RESPONSE_PERIOD_US = 74_000
THROUGH_WALL_S = 9.0  # in which both people walk, meet and turn
STAIRS_S = 4.5  # from the lower floor to the middle of the first flight
CLIMB_S = 12.0  # and on, across the landing


@dataclass
class NodeFeed:
    """A node's configuration, and its radar."""

    config: Any
    source: NodeRecording
    period_us: int = PERIOD_US


@dataclass
class HubFeed:
    """A hub's configuration, and what the link brings it: the reports of each frame."""

    config: Any
    frames: list[bytes]
    period_us: int = PERIOD_US


@cache
def case_study() -> Recording:
    """One person's walk."""
    return simulate(sensor_radar_scene(), case_study_people(1), seed=0)


@cache
def through_wall_case_study() -> Recording:
    """Two people behind the wall."""
    return simulate_through_wall(
        through_wall_scene(), case_study_walkers(2), seed=0, duration_s=THROUGH_WALL_S
    )


@cache
def stairs(duration_s: float = STAIRS_S) -> Recording:
    """One person on the stairs."""
    return simulate_stairs(stairs_scene(), seed=0, duration_s=duration_s)


def sensor_radar_node() -> NodeFeed:
    """Return the case study's first node."""
    return _first_node(SITE, case_study(), PERIOD_US)


def sensor_radar_hub() -> HubFeed:
    """Return what the case study's nodes report."""
    return _reports(SITE, case_study(), PERIOD_US)


def through_wall_node() -> NodeFeed:
    """Return the case study's first receiver."""
    return _first_node(BEFORE_A_WALL, through_wall_case_study(), RESPONSE_PERIOD_US)


def stairs_node(kept_samples: int) -> NodeFeed:
    """Return the stairs' first receiver, which keeps so many of 4095 samples, from power-up to mid-flight."""
    source = stairs().nodes[0]
    config = _core.ThroughWallNodeConfig(
        node_id=source.node_id,
        n_samples=source.scans.shape[1],
        kept_samples=kept_samples,
        sample_rate_hz=source.sample_rate_hz,
        baseline_m=math.dist(source.tx_position_m, source.rx_position_m),
    )
    return NodeFeed(config, source, RESPONSE_PERIOD_US)


def through_wall_hub() -> HubFeed:
    """Return what the case study's two receivers report."""
    return _reports(BEFORE_A_WALL, through_wall_case_study(), RESPONSE_PERIOD_US)


def through_wall_3d_hub() -> HubFeed:
    """Return what the stairs' four receivers report."""
    return _reports(BESIDE_STAIRS, stairs(CLIMB_S), RESPONSE_PERIOD_US)


def _first_node(site: Site, recording: Recording, period_us: int) -> NodeFeed:
    source = recording.nodes[0]
    (place,) = (place for place in site.nodes if place.id == source.node_id)
    return NodeFeed(node_config(site, place, source), source, period_us)


def _reports(site: Site, recording: Recording, period_us: int) -> HubFeed:
    radar = SensorRadar(site, recording.nodes)
    frames: dict[int, bytes] = defaultdict(bytes)
    for scan in scans_in_time_order(recording.nodes):
        source = recording.nodes[scan.node]
        found = radar.scan(scan, source.scans[scan.index]).detections
        frames[scan.index] += _report(
            source.node_id, scan.index, found["delay_s"], found["weight"], period_us
        )
    return HubFeed(hub_config(site), list(frames.values()), period_us)


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


def traces_at_random(n_receivers: int, n_frames: int = 12) -> HubFeed:
    """Receivers on a line before the wall, whose reports are full of anything."""
    random = np.random.default_rng(5)
    rx_m = np.zeros((n_receivers, 2), np.float32)
    rx_m[:, 0] = np.delete(
        np.linspace(-0.4, 0.4, n_receivers + 1), n_receivers // 2
    )  # the transmitter's place
    config = _core.ThroughWallHubConfig()
    config.set_nodes(list(range(1, n_receivers + 1)), np.zeros_like(rx_m), rx_m)
    config.set_area(-2.35, 0.48, 2.35, 6.10)
    return _full_of_anything(config, random, n_frames)


def cross_at_random(n_frames: int = 12) -> HubFeed:
    """The stairs' four receivers, likewise."""
    return _full_of_anything(hub_config(BESIDE_STAIRS), np.random.default_rng(5), n_frames)


def _full_of_anything(config: Any, random: np.random.Generator, n_frames: int) -> HubFeed:
    feed = HubFeed(config, [], RESPONSE_PERIOD_US)
    for frame in range(n_frames):
        reports = b""
        for node in config.nodes[: config.n_nodes]:
            delays_s = np.sort(random.uniform(1.2e-8, 4e-8, 16))
            reports += _report(node.node_id, frame, delays_s, np.full(16, 9), RESPONSE_PERIOD_US)
        feed.frames.append(reports)
    return feed


def _report(node_id: int, frame: int, delay_s: Any, weight: Any, period_us: int = PERIOD_US) -> bytes:
    payload = codec.detections_payload((frame + 1) * period_us, delay_s, weight)
    return codec.frame(Transfer(node_id, codec.DETECTIONS, frame, payload))
