"""A run that no radar made: people walk through a room, every table filled as a pipeline would."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from echofuse.recording import DETECTION_DTYPE, TRACK_DTYPE, NodeRecording, PersonTruth, Recording
from echofuse.result import POINT_DTYPE, NodeStack, RunResult
from echofuse.site import Site, SiteNode

SPEED_OF_LIGHT_MPS = 299_792_458.0
SAMPLE_RATE_HZ = 16.384e9
CENTRE_HZ = 4.3e9
TX_M = (5.75, 0.0, 1.0)
RX_M = (
    (0.0, 1.5, 1.0),
    (1.9, 6.0, 1.0),
    (5.75, 6.0, 1.0),
    (9.6, 6.0, 1.0),
    (11.5, 4.5, 1.0),
    (11.5, 1.0, 1.0),
)


def _pulse(time_s: NDArray[np.float64], at_s: NDArray[np.float64] | float) -> NDArray[np.float64]:
    """A burst at 4.3 GHz, 0.3 ns wide."""
    late = time_s - at_s
    return np.asarray(np.exp(-0.5 * (late / 0.3e-9) ** 2) * np.cos(2 * np.pi * CENTRE_HZ * late))


def _burst(time_s: NDArray[np.float64], at_s: float, width_s: float = 0.4e-9) -> NDArray[np.float64]:
    return np.asarray(np.exp(-0.5 * ((time_s - at_s) / width_s) ** 2))


class Walker:
    """One person on a straight line through the room."""

    def __init__(self, index: int, time_s: NDArray[np.float64]) -> None:
        start, end = ((10.7, 3.4 - 1.0 * index), (1.5, 2.0 + 1.2 * index))
        share = ((time_s - time_s[0]) / (time_s[-1] - time_s[0]))[:, None]
        flat = (1.0 - share) * np.array(start) + share * np.array(end)
        self.position_m = np.column_stack([flat, np.ones(time_s.size)])


def _echo_s(position_m: NDArray[np.float64], rx_m: tuple[float, float, float]) -> float:
    tx, rx = np.array(TX_M[:2]), np.array(rx_m[:2])
    return (
        float(np.linalg.norm(position_m[:2] - tx) + np.linalg.norm(position_m[:2] - rx)) / SPEED_OF_LIGHT_MPS
    )


def _make_node(
    index: int, walkers: list[Walker], time_s: NDArray[np.float64], n_samples: int, rng: np.random.Generator
) -> tuple[NodeRecording, NodeStack]:
    rx_m = RX_M[index % len(RX_M)]
    baseline_s = float(np.linalg.norm(np.array(rx_m) - np.array(TX_M))) / SPEED_OF_LIGHT_MPS
    first_s = baseline_s - 8e-9
    delay_s = first_s + np.arange(n_samples) / SAMPLE_RATE_HZ
    room = 20_000.0 * _pulse(delay_s, baseline_s)
    for _ in range(60):
        late_s = baseline_s + rng.exponential(15e-9)
        room += rng.normal(0.0, 5_000.0) * np.exp(-(late_s - baseline_s) / 18e-9) * _pulse(delay_s, late_s)
    residual = np.abs(rng.normal(0.0, 25.0, (time_s.size, n_samples))).astype(np.float32)
    scans = np.empty((time_s.size, n_samples), dtype=np.float32)
    clusters = []
    for frame in range(time_s.size):
        scans[frame] = room + rng.normal(0.0, 40.0, n_samples)
        found = []
        echoes = [(_echo_s(w.position_m[frame], rx_m) + rng.normal(0.0, 0.2e-9), 700.0) for w in walkers]
        if rng.random() < 0.3:
            echoes.append((baseline_s + rng.uniform(2e-9, 60e-9), 350.0))
        for at_s, strength in echoes:
            if rng.random() < 0.08:
                continue
            scans[frame] += strength * _pulse(delay_s, at_s)
            residual[frame] += strength * _burst(delay_s, at_s)
            sample = (at_s - first_s) * SAMPLE_RATE_HZ
            found.append(
                (sample, max(4.0, strength / 30.0), max(sample - 6, 0.0), min(sample + 14, n_samples - 1.0))
            )
        clusters.append(np.array(sorted(found), dtype=np.float32).reshape(-1, 4))
    node = NodeRecording(
        name=f"rx{index + 1}",
        node_id=index + 1,
        sample_rate_hz=SAMPLE_RATE_HZ,
        first_sample_s=first_s,
        tx_position_m=np.array(TX_M),
        rx_position_m=np.array(rx_m),
        time_s=time_s,
        scans=scans,
        reference=(room + rng.normal(0.0, 40.0, (5, n_samples))).astype(np.float32),
    )
    decisions = (residual > 200.0).astype(np.uint8)
    return node, NodeStack(residual=residual, decisions=decisions, clusters=clusters, delay_s=delay_s)


def _taps(node: NodeRecording, stack: NodeStack, frame: int) -> dict[str, NDArray[Any]]:
    scan = node.scans[frame].astype(np.float32)
    envelope = np.convolve(np.abs(scan), np.hanning(9) / np.hanning(9).sum() * 1.57, mode="same").astype(
        np.float32
    )
    clusters = stack.clusters[frame]
    threshold = np.full(scan.size, 150.0**2, dtype=np.float32) * (
        1.0 + 0.5 * np.hanning(scan.size).astype(np.float32)
    )
    detections = np.column_stack(
        [np.interp(clusters[:, 0], np.arange(scan.size), stack.delay_s), clusters[:, 1]]
    )
    return {
        "scan": scan,
        "envelope": envelope,
        "direct_path": np.array([1.0, 8e-9 * SAMPLE_RATE_HZ - 6, 2000.0], dtype=np.float32),
        "alignment": np.array([0.3, 0.98], dtype=np.float32),
        "aligned": envelope,
        "residual": stack.residual[frame],
        "threshold": threshold,
        "decisions": stack.decisions[frame].astype(np.float32),
        "range_clusters": clusters,
        "detections": detections.astype(np.float32),
    }


def _tracks(
    walkers: list[Walker], time_us: NDArray[np.int64], noise_m: float, rng: np.random.Generator
) -> NDArray[np.void]:
    rows = []
    for frame, now_us in enumerate(time_us):
        for index, walker in enumerate(walkers):
            if frame < 2 + 3 * index:
                continue
            share = frame / len(time_us)
            state = 0 if frame < 4 + 3 * index else (2 if 0.45 < share < 0.55 and index == 0 else 1)
            x, y = walker.position_m[frame, :2] + rng.normal(0.0, noise_m, 2)
            moving = (x, y, np.nan, -1.5, 0.0, np.nan)
            covariance = (0.01, 0.0, 0.01, np.nan, np.nan, np.nan)
            rows.append((frame, now_us, index + 1, state, 0, *moving, *covariance))
    return np.array(rows, dtype=TRACK_DTYPE)


def make_result(
    *, n_frames: int = 61, n_people: int = 1, n_nodes: int = 6, n_samples: int = 1920, seed: int = 0
) -> RunResult:
    """Return a run of the case study's shape."""
    rng = np.random.default_rng(seed)
    time_s = 100.0 + 0.1 * np.arange(n_frames)
    time_us = np.round(time_s * 1e6).astype(np.int64)
    walkers = [Walker(index, time_s) for index in range(n_people)]
    nodes, stacks = [], {}
    for index in range(n_nodes):
        node, stack = _make_node(index, walkers, time_s, n_samples, rng)
        nodes.append(node)
        stacks[node.name] = stack
    shown = n_frames // 2
    points = np.array(
        [
            (
                *(frame, time_us[frame]),
                *(walker.position_m[frame, :2] + rng.normal(0.0, 0.12, 2)),
                *(np.nan, 4.0, 80.0),
            )
            for frame in range(n_frames)
            for walker in walkers
            if rng.random() < 0.9
        ],
        dtype=POINT_DTYPE,
    )
    detections = np.array(
        [
            (frame, number, time_us[frame], _echo_s(walker.position_m[frame], RX_M[number % 6]), 23.0)
            for frame in range(n_frames)
            for number in range(n_nodes)
            for walker in walkers
        ],
        dtype=DETECTION_DTYPE,
    )
    truth = tuple(
        PersonTruth(id=f"{index + 1}", time_s=time_s, position_m=walker.position_m)
        for index, walker in enumerate(walkers)
    )
    site = Site(
        name="sensor-radar",
        area=((0.0, 0.0), (11.5, 0.0), (11.5, 6.0), (0.0, 6.0)),
        pipeline="sensor_radar",
        nodes=tuple(
            SiteNode(
                name=node.name, id=node.node_id, tx_position_m=TX_M, rx_position_m=RX_M[index % len(RX_M)]
            )
            for index, node in enumerate(nodes)
        ),
    )
    return RunResult(
        site=site,
        recording=Recording(
            pipeline="sensor_radar",
            created="2024-05-01T10:00:00Z",
            site_toml="",
            nodes=tuple(nodes),
            truth=truth,
        ),
        frame_time_us=time_us,
        detections=detections,
        points=points,
        tracks=_tracks(walkers, time_us, 0.07, rng),
        baseline_tracks=_tracks(walkers, time_us, 0.13, rng),
        metrics={
            "rmse_m": 0.098,
            "p50_m": 0.08,
            "p80_m": 0.13,
            "tracked_fraction": 0.98,
            "count_right_fraction": 0.97,
            "false_track_fraction": 0.0,
            "bound_ratio": 2.4,
            "ospa_m": 0.12,
            "gospa_m": 0.2,
        },
        baseline_metrics={
            "rmse_m": 0.18,
            "p50_m": 0.15,
            "p80_m": 0.24,
            "tracked_fraction": 0.97,
            "count_right_fraction": 0.96,
            "false_track_fraction": 0.01,
            "ospa_m": 0.2,
            "gospa_m": 0.3,
        },
        counters={
            "hub": {
                "frames": n_frames,
                "late": 0,
                "lost": 2,
                "doubled": 0,
                "unknown_node": 0,
                "dropped_tuples": 0,
            },
            **{
                node.name: {"scans": n_frames, "rejected_scans": 0, "direct_path_missing": 0}
                for node in nodes
            },
        },
        stacks=stacks,
        shown_frame=shown,
        shown_taps={node.name: _taps(node, stacks[node.name], shown) for node in nodes},
    )


@pytest.fixture(scope="session")
def make_run() -> Callable[..., RunResult]:
    """Return `make_result`."""
    return make_result


@pytest.fixture(scope="session")
def run() -> RunResult:
    """One person, 61 frames, six receivers."""
    return make_result()
