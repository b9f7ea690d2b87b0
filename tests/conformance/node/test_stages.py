"""The node's stages one by one: core against reference on the same inputs, every choice."""

import numpy as np
import pytest
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.reference.node.scan.cfar import averaging_factor, cfar, ordered_factor, ordered_rank
from echofuse.reference.node.scan.clutter import ClutterFilter, rectified
from echofuse.reference.node.scan.direct_path import direct_path
from echofuse.reference.node.scan.noise_floor import NoiseFloor
from echofuse.reference.node.scan.pulse_integrator import PulseIntegrator
from echofuse.reference.node.scan.range_clusters import range_clusters

SEEDS = range(20)
CFAR_METHODS = ("double_threshold_buffer", "cell_averaging", "global_average", "ordered_statistic")


def amplitudes(rng: np.random.Generator, n_samples: int) -> NDArray[np.float32]:
    """(n_samples,) rectified noise with a few echoes, some with a loud start."""
    d = np.maximum(0.0, rng.normal(0.0, 1.0, n_samples))
    for _ in range(3):
        begin = int(rng.integers(0, n_samples))
        rise = np.exp(-np.abs(np.arange(n_samples) - begin) / 6.0)
        d += rng.uniform(2.0, 30.0) * rise * rng.uniform(0.5, 1.0, n_samples)
    if rng.random() < 0.3:
        d[: int(rng.integers(1, 30))] *= 1e4
    return d.astype(np.float32)


def passed(board: Scoreboard) -> bool:
    return bool(board.rows()) and all(row.passed for row in board.rows())


@pytest.mark.parametrize("pulses_per_scan", [1, 2, 7])
def test_pulse_integrator(pulses_per_scan: int) -> None:
    config = _core.PulseIntegratorConfig(pulses_per_scan=pulses_per_scan)
    core, reference, board = _core.PulseIntegrator(), PulseIntegrator(config), Scoreboard()
    assert core.configure(config) == _core.Status.ok
    for seed in SEEDS:
        pulse = np.random.default_rng(seed).normal(0.0, 100.0, 50).astype(np.float32)
        status, got = core.process(pulse)
        expected = reference.process(pulse.astype(np.float64))
        assert status == _core.Status.ok
        assert (got is None) == (expected is None)
        if got is not None and expected is not None:
            board.floats("mean", "scan", f"pulse {seed}", got, expected, "node.scan")
    assert passed(board)


@pytest.mark.parametrize("search", ["serial_backward", "threshold_crossing", "jump_back_search_forward"])
def test_direct_path(search: str) -> None:
    config = _core.DirectPathConfig(search=getattr(_core.DirectPathSearch, search), window_samples=40)
    core, board, n_found = _core.DirectPathSearcher(), Scoreboard(), 0
    assert core.configure(config) == _core.Status.ok
    for seed in range(60):
        rng = np.random.default_rng(seed)
        n = 600
        envelope = rng.rayleigh(1.0, n)
        arrival = rng.uniform(30, 500)
        envelope += rng.uniform(0.0, 40.0) * np.exp(-0.5 * ((np.arange(n) - arrival) / 6.0) ** 2)
        scan = envelope.astype(np.float32)
        status, got = core.process(scan)
        expected = direct_path(scan.astype(np.float64), as_reference(config))
        assert status == _core.Status.ok
        same = board.decisions(search, "found", f"seed {seed}", [got.found], [expected.found], 1.0)
        if same and expected.margin > 1e-5:
            n_found += got.found
            assert got.peak_sample == expected.peak_sample
            board.floats(
                search,
                "direct_path",
                f"seed {seed}",
                [got.toa_samples, got.threshold],
                [expected.toa_samples, expected.threshold],
                "node.direct_path",
            )
    assert passed(board), board.as_json()
    assert 20 < n_found < 60


@pytest.mark.parametrize("empty_room_scans", [0, 1, 5])
@pytest.mark.parametrize("lag", [1, 3])
@pytest.mark.parametrize(
    "method",
    [
        "empty_room_envelope",
        "empty_room_scan",
        "empty_room_shadowed",
        "exponential_average",
        "frame_difference",
    ],
)
def test_clutter(method: str, lag: int, empty_room_scans: int) -> None:
    config = _core.ClutterConfig(
        method=getattr(_core.ClutterMethod, method),
        learning_scans=4,
        difference_lag_scans=lag,
        averaging_factor=0.9,
        shadow_window_samples=11,
    )
    core, reference, board = _core.ClutterFilter(), ClutterFilter(as_reference(config)), Scoreboard()
    assert core.configure(config, 64) == _core.Status.ok
    rng = np.random.default_rng(7)
    background = rng.normal(0.0, 1000.0, 64)
    for round_ in range(2):  # what is learnt live gives way to an empty room given later
        for index in range(24):
            samples = (background + rng.normal(0.0, 100.0, 64)).astype(np.float32)
            assert core.ready() == reference.ready
            status, got = core.process(samples)
            assert status == _core.Status.ok
            expected = reference.process(samples.astype(np.float64))
            # scale: the background, which the residual is the small difference of
            both = np.concatenate([[5000.0], got]), np.concatenate([[5000.0], expected])
            board.floats(method, "residual", f"round {round_}, scan {index}", *both, "node.clutter")
            assert np.array_equal(_core.rectify(got), rectified(got.astype(np.float64)).astype(np.float32))
        for _ in range(empty_room_scans):
            empty = (background + 500.0 + rng.normal(0.0, 100.0, 64)).astype(np.float32)
            assert core.add_empty_room(empty) == _core.Status.ok
            reference.add_empty_room(empty.astype(np.float64))
    assert passed(board), board.as_json()


@pytest.mark.parametrize("method", CFAR_METHODS)
@pytest.mark.parametrize(("training", "guard", "buffer"), [(1, 0, 1), (12, 2, 25), (64, 16, 60)])
def test_cfar(method: str, training: int, guard: int, buffer: int) -> None:
    config = _core.CfarConfig(
        method=getattr(_core.CfarMethod, method),
        training_cells_per_side=training,
        guard_cells_per_side=guard,
        buffer_samples=buffer,
        false_alarm_probability=1e-2,
        local_factor=3.0,
        global_factor=0.5,
        max_rises=2,
    )
    core, board, n_hits = _core.CfarDetector(), Scoreboard(), 0
    assert core.configure(config) == _core.Status.ok
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        d = amplitudes(rng, int(rng.integers(core.min_samples(), 500)))
        for _ in range(2):  # no state
            status, threshold, decisions = core.process(d)
            assert status == _core.Status.ok
        expected = cfar(d.astype(np.float64), as_reference(config))
        where = f"seed {seed}"
        if board.decisions(method, "decisions", where, decisions, expected.decisions, expected.margin):
            n_hits += int(decisions.sum())
            # relative to itself: an array's largest threshold would hide the small ones
            ratio = (threshold.astype(np.float64) + 1e-12) / (expected.threshold + 1e-12)
            board.floats(method, "threshold", where, ratio, np.ones_like(ratio), "node.cfar.threshold")
    assert passed(board), board.as_json()
    assert n_hits > 20


def test_cfar_factors() -> None:
    board = Scoreboard()
    for probability in (0.5, 1e-2, 1e-4, 1e-6, 1e-9):
        exact = float(np.float32(probability))
        for method in ("cell_averaging", "ordered_statistic"):
            core = _core.CfarDetector()
            config = _core.CfarConfig(
                method=getattr(_core.CfarMethod, method),
                false_alarm_probability=probability,
                training_cells_per_side=64,
            )
            assert core.configure(config) == _core.Status.ok
            for n in (1, 2, 3, 16, 50, 127, 128):
                expected = averaging_factor(n, exact)
                if method == "ordered_statistic":
                    expected = ordered_factor(n, ordered_rank(n, 0.75), exact)
                where = f"{n} cells, {probability}"
                board.floats(method, "factor", where, [core.factor(n)], [expected], "node.cfar.factor")
    assert passed(board), board.as_json()


def test_noise_floor() -> None:
    config = _core.NoiseFloorConfig(factor=6.0, averaging_factor=0.8)
    core, reference, board = _core.NoiseFloor(), NoiseFloor(as_reference(config)), Scoreboard()
    assert core.configure(config) == _core.Status.ok
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        d = amplitudes(rng, 200) if seed != 3 else np.zeros(200, np.float32)
        threshold = rng.uniform(0.0, 40.0, 200).astype(np.float32)
        status, got = core.process(d, threshold)
        assert status == _core.Status.ok
        expected = reference.process(d.astype(np.float64), threshold.astype(np.float64))
        board.floats("floor", "threshold", f"scan {seed}", got, expected, "node.noise_floor")
    assert passed(board), board.as_json()


@pytest.mark.parametrize("representative", ["leading_edge", "median"])
def test_range_clusters(representative: str) -> None:
    board, n_clusters = Scoreboard(), 0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(1, 500))
        config = _core.RangeClusterConfig(
            representative=getattr(_core.ClusterRepresentative, representative),
            merge_distance_s=float(rng.integers(8, 80)),
            min_weight=int(rng.integers(1, 5)),
        )
        if config.invalid_field() is not None:
            config.merge_distance_s = config.merge_distance_s * 1e-2
        core = _core.RangeClusterer()
        assert core.configure(config, 100.0) == _core.Status.ok
        d = rng.uniform(0.0, 1.0, n).astype(np.float32)
        hit_from = rng.choice([0.0, 0.5, 0.9, 0.99])
        threshold = np.full(n, np.float32(hit_from**2))
        decisions = (d.astype(np.float64) ** 2 > threshold).astype(np.uint8)
        for _ in range(2):  # no state
            status, got = core.process(decisions, d, threshold)
            assert status == _core.Status.ok
        expected = range_clusters(
            decisions, d.astype(np.float64), threshold.astype(np.float64), 100.0, as_reference(config)
        )
        n_clusters += len(expected)
        rows = np.array(expected, dtype=np.float64).reshape(-1, 4)
        members = np.stack([got["weight"], got["first_sample"], got["last_sample"]], axis=1)
        if board.decisions(representative, "members", f"seed {seed}", members, rows[:, 1:], 1.0):
            board.floats(
                representative,
                "position",
                f"seed {seed}",
                got["position_samples"],
                rows[:, 0],
                "node.range_cluster.position",
            )
    assert passed(board), board.as_json()
    assert n_clusters > 200
