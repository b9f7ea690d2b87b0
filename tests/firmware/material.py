"""What the measured images are fed: the case study, and the worst that `limits.hpp` lets in."""

from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.pipeline import SensorRadar, node_config, scans_in_time_order
from echofuse.simulation.scene import sensor_radar_scene
from echofuse.simulation.sensor_radar import case_study_people, simulate
from echofuse.site import example_site

Values = NDArray[np.float32]
PERIOD_US = 100_000
TRACK_LAYOUT = np.dtype(  # of link::Track in memory
    [("id", "<i4"), ("state", "u1"), ("frames_since_update", "<i4"), ("x_m", "<f4"), ("y_m", "<f4")]
    + [
        (name, "<f4")
        for name in ("vx_mps", "vy_mps", "covariance_xx_m2", "covariance_xy_m2", "covariance_yy_m2")
    ],
    align=True,
)


@dataclass
class Feed:
    """The first step's settings, steps of the empty room, and the steps that are measured."""

    settings: list[float]
    empty_room: list[Values] = field(default_factory=list)
    steps: list[Values] = field(default_factory=list)
    expected: list[bytes] = field(default_factory=list)  # what the library says to each step in this process


@cache
def case_study() -> tuple[list[Feed], Feed]:
    """One person's walk: the feeds of the nodes, and of the hub."""
    site = example_site("sensor_radar")
    recording = simulate(sensor_radar_scene(), case_study_people(1), seed=0)
    radar = SensorRadar(site, recording.nodes)
    nodes = []
    for place, source in zip(site.nodes, recording.nodes, strict=True):
        config = node_config(site, place, source)
        settings = [config.baseline_m, config.delay_offset_s]
        nodes.append(Feed(settings, list(source.reference), list(source.scans)))
    hub = Feed(_site(site.bounds_m, [(n.id, *n.tx_position_m[:2], *n.rx_position_m[:2]) for n in site.nodes]))
    hub.settings[5] = radar.hub_config.ellipse.body_radius_m
    reports: list[list[float]] = [[] for _ in recording.nodes[0].scans]
    for scan in scans_in_time_order(recording.nodes):
        output = radar.scan(scan, recording.nodes[scan.node].scans[scan.index])
        pairs = [float(value) for detection in output.detections for value in detection.tolist()]
        reports[scan.index] += [recording.nodes[scan.node].node_id, scan.index, len(pairs) // 2, *pairs]
        nodes[scan.node].expected.append(np.array(pairs, "<f4").tobytes())
    hub.steps = [np.array(report, np.float32) for report in reports]
    hub.expected = _tracks(radar.hub_config, hub.steps)
    return nodes, hub


def _tracks(config: "_core.SensorRadarHubConfig", steps: list[Values]) -> list[bytes]:
    pipeline = _core.SensorRadarHub()
    assert pipeline.configure(config) == _core.Status.ok
    expected = []
    for index, values in enumerate(steps):
        now_us, at = (index + 1) * PERIOD_US, 0
        while at < len(values):
            node_id, frame, count = map(int, values[at : at + 3])
            pairs = values[at + 3 : at + 3 + 2 * count].reshape(count, 2)
            delay_s, weight = (np.ascontiguousarray(column) for column in pairs.T)
            pipeline.receive(node_id, frame, delay_s, weight, now_us)
            at += 3 + 2 * count
        _, (_, _, tracks), _ = pipeline.poll_with_taps(now_us)
        rows = np.zeros(len(tracks), TRACK_LAYOUT)
        for name in tracks.dtype.names:
            rows[name] = tracks[name]
        expected.append(rows.tobytes())
    return expected


def crowd(n_nodes: int, n_people: int, n_frames: int = 12) -> Feed:
    """People who stand all over a room, each seen by every node: of random places, with 5 cm of noise."""
    random = np.random.default_rng(5)
    angles = 2.0 * np.pi * np.arange(n_nodes) / n_nodes
    nodes = [(i + 1, 0.5, 0.2, 9.5 * np.cos(a), 9.5 * np.sin(a)) for i, a in enumerate(angles)]
    feed = Feed(_site((-10.0, -10.0, 10.0, 10.0), nodes))
    people_m = random.uniform(-6.0, 6.0, (n_people, 2))
    for frame in range(n_frames):
        values: list[float] = []
        for node_id, *places in nodes:
            tx_m, rx_m = np.array(places).reshape(2, 2)
            paths_m = np.hypot(*(people_m - tx_m).T) + np.hypot(*(people_m - rx_m).T)
            delays_s = np.sort(paths_m + random.normal(0.0, 0.05, n_people)) / SPEED_OF_LIGHT_MPS
            values += [node_id, frame, n_people, *np.stack([delays_s, np.full(n_people, 9.0)], 1).ravel()]
        feed.steps.append(np.array(values, np.float32))
    return feed


def _site(area: tuple[float, ...], nodes: list[tuple[float, ...]]) -> list[float]:
    phd = 0.0
    return [*area, phd, 0.18, *(value for node in nodes for value in node)]
