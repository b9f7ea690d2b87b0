"""The whole node: every tap of core and reference from the same raw scans, every choice."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.comparison import COIN_TOSS_MARGIN, Scoreboard, as_reference
from echofuse.reference.node.node import SensorRadarNode

Scan = NDArray[np.float32]
SAMPLE_RATE_HZ = 16.384e9
N_SAMPLES = 500


def room(
    rng: np.random.Generator,
) -> tuple[Callable[[float], NDArray[np.float64]], Callable[[float, float], Scan]]:
    """A random empty room, and its scan with a person's echo at a sample and a timing error."""
    k = np.arange(N_SAMPLES)
    places = np.concatenate([[110.0], rng.uniform(125, N_SAMPLES, 15)])
    gains = np.concatenate([[3000.0], rng.normal(0.0, 400.0, 15)])

    def pulse(place: float) -> NDArray[np.float64]:
        x = k - place
        return np.exp(-0.5 * (x / 5.0) ** 2) * np.cos(2.0 * np.pi * 0.262 * x)

    def empty(late: float) -> NDArray[np.float64]:
        clutter = sum((g * pulse(p + late) for g, p in zip(gains, places, strict=True)), np.zeros(N_SAMPLES))
        return clutter + rng.normal(0.0, 5.0, N_SAMPLES)

    def with_person(place: float, late: float) -> Scan:
        echo = 300.0 * pulse(place + late) + 150.0 * pulse(place + late + 17.0)
        return (empty(late) + echo).astype(np.float32)

    return empty, with_person


CHOICES: list[dict[str, Any]] = [
    {},
    *({"clutter.method": m} for m in ("empty_room_scan", "exponential_average", "frame_difference")),
    {"clutter.method": "frame_difference", "clutter.difference_lag_scans": 3, "noise_floor.factor": 8.0},
    *({"cfar.method": m} for m in ("cell_averaging", "global_average", "ordered_statistic")),
    *({"direct_path.search": m} for m in ("threshold_crossing", "jump_back_search_forward")),
    *({"alignment.method": m} for m in ("integer", "none")),
    {"envelope.method": "square_low_pass"},
    {"range_clusters.representative": "median"},
    {"time_zero": "recorded", "first_sample_s": 7e-9},
    {"pulse_integrator.pulses_per_scan": 2},
]


def configured(choice: dict[str, Any]) -> Any:
    config = _core.SensorRadarNodeConfig(n_samples=N_SAMPLES, sample_rate_hz=SAMPLE_RATE_HZ, baseline_m=3.0)
    config.direct_path.noise_samples = 40
    config.clutter.learning_scans = 4
    for key, value in choice.items():
        *stage, field = key.split(".")
        owner = getattr(config, stage[0]) if stage else config
        members = getattr(type(getattr(owner, field)), "__members__", {})
        setattr(owner, field, members.get(value, value) if isinstance(value, str) else value)
    return config


def compare_scan(
    board: Scoreboard, name: str, where: str, core: Any, reference: SensorRadarNode, scan: Scan
) -> int:
    """One scan through both; the number of detections compared."""
    status, detections, taps = core.process_with_taps(scan, 0)
    report = reference.process(scan.astype(np.float64))
    assert status == _core.Status.ok
    assert core.report_ready() == (report is not None)
    if report is None:
        assert taps == {}
        assert len(detections) == 0
        return 0
    assert set(taps) == set(report.taps)
    if min(float(report.margins["alignment"]), float(report.margins["direct_path"])) < COIN_TOSS_MARGIN:
        return 0
    for tap in ("scan", "envelope", "direct_path", "alignment", "aligned", "residual", "threshold"):
        board.floats(name, tap, where, taps[tap], report.taps[tap], f"node.{tap}")
    same = board.decisions(
        name, "decisions", where, taps["decisions"], report.taps["decisions"], report.margins["decisions"]
    )
    if not same:
        return 0
    board.floats(
        name,
        "range_clusters",
        where,
        taps["range_clusters"],
        report.taps["range_clusters"],
        "node.range_clusters",
    )
    delays, weights = report.detections[:, 0], report.detections[:, 1]
    board.floats(name, "detections", where, detections["delay_s"], delays, "node.detections")
    board.floats(name, "detections", where, taps["detections"][:, 0], delays, "node.detections")
    assert np.array_equal(detections["weight"], weights)
    return len(detections)


@pytest.mark.parametrize("learns", [False, True], ids=["empty_room", "learnt"])
@pytest.mark.parametrize(
    "choice", CHOICES, ids=lambda choice: "-".join(map(str, choice.values())) or "default"
)
def test_node(choice: dict[str, Any], learns: bool) -> None:
    config, board, n_detections = configured(choice), Scoreboard(), 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        empty, with_person = room(rng)
        core, reference = _core.SensorRadarNode(), SensorRadarNode(as_reference(config))
        assert core.configure(config) == _core.Status.ok
        for _ in range(0 if learns else 3):
            scan = empty(float(rng.normal(0.0, 1.5))).astype(np.float32)
            assert core.set_empty_room(scan) == _core.Status.ok
            reference.set_empty_room(scan.astype(np.float64))
        for index in range((7 if learns else 4) * config.pulse_integrator.pulses_per_scan):
            jitter = float(rng.normal(0.0, 1.5)) + (12.0 if index % 7 == 3 else 0.0)
            scan = with_person(200.0 + 60.0 * (index % 4), jitter)
            n_detections += compare_scan(
                board, str(choice), f"seed {seed}, scan {index}", core, reference, scan
            )
    failures = [row.failures for row in board.rows() if row.failures]
    assert not failures, failures[:3]
    assert sum(row.excused for row in board.rows()) <= 2
    assert n_detections >= 20


def test_recording_conforms(real_walk: NDArray[np.float32]) -> None:
    """real_walk (n_scans, n_samples): the chain that serves on the real recording."""
    config = _core.SensorRadarNodeConfig(n_samples=real_walk.shape[1], sample_rate_hz=1.0 / 61.04e-12)
    config.time_zero = _core.TimeZero.recorded
    config.first_sample_s = 7.3e-9
    config.alignment.method = _core.AlignmentMethod.none
    config.clutter.method = _core.ClutterMethod.frame_difference
    config.clutter.difference_lag_scans = 4
    config.noise_floor.factor = 16.0
    core, reference, board = _core.SensorRadarNode(), SensorRadarNode(as_reference(config)), Scoreboard()
    assert core.configure(config) == _core.Status.ok
    n_detections = sum(
        compare_scan(board, "real walk", f"scan {index}", core, reference, scan)
        for index, scan in enumerate(real_walk)
    )
    failures = [row.failures for row in board.rows() if row.failures]
    assert not failures, failures[:3]
    assert n_detections >= 60
