"""The stages of a through-wall receiver one by one, every choice: core against reference."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.reference.node.scan.gaussian_cfar import delay_samples, gaussian_cfar
from echofuse.reference.node.scan.leading_edge import leading_edge
from echofuse.reference.node.scan.target_traces import target_traces
from echofuse.reference.node.scan.time_zero import TimeZero
from echofuse.reference.node.scan.weak_signal import WeakSignal

N_SAMPLES = 511
EXPECTED_SAMPLES = 6.0  # 0.4 m at 4.5 GHz


def passed(board: Scoreboard) -> bool:
    return bool(board.rows()) and all(row.passed for row in board.rows())


def responses(
    rng: np.random.Generator, n: int, power_up: int, n_samples: int = N_SAMPLES
) -> NDArray[np.float32]:
    """(n, n_samples) cross-talk, a wall and its echoes, noise; turned by another start at power_up."""
    k = np.arange(n_samples)
    plain = np.zeros(n_samples)
    for delay, height in ((6.3, 1000.0), (11.8, -620.0), (17.0, 300.0), (60.0, 40.0), (200.0, 9.0)):
        plain += height * np.sinc(k - delay) * np.exp(-(((k - delay) / 12.0) ** 2))
    starts = np.where(np.arange(n) < power_up, rng.integers(n_samples), rng.integers(n_samples))
    turned = [np.roll(plain, start) + rng.normal(0.0, 1.0, n_samples) for start in starts]
    return np.array(turned, np.float32)


@pytest.mark.parametrize("moved_responses", [1, 3])
@pytest.mark.parametrize(("n_samples", "kept"), [(N_SAMPLES, 0), (N_SAMPLES, 120), (4095, 700)])
def test_time_zero(n_samples: int, kept: int, moved_responses: int) -> None:
    config = _core.TimeZeroConfig(moved_responses=moved_responses)
    board, seen = Scoreboard(), {"found": 0, "moved": 0}
    for seed in range(20):
        rng = np.random.default_rng(seed)
        core, reference = _core.TimeZeroFinder(), TimeZero(as_reference(config), EXPECTED_SAMPLES)
        assert core.configure(config, n_samples, EXPECTED_SAMPLES) == _core.Status.ok
        for index, response in enumerate(responses(rng, 40, power_up=22, n_samples=n_samples)):
            if index in (15, 33):
                response = rng.normal(0.0, 1.0, n_samples).astype(np.float32)  # without cross-talk
            status, got, rotated = core.process(response, kept)
            expected = reference.process(response.astype(np.float64), kept)
            assert status == _core.Status.ok
            where = f"seed {seed}, response {index}"
            decided = [got.found, got.moved, got.rotation_samples]
            judged = [expected.found, expected.moved, expected.rotation]
            assert board.decisions("time zero", "decisions", where, decided, judged, expected.margin)
            board.floats(
                "time zero",
                "fraction",
                where,
                got.fraction_samples,
                expected.fraction_samples,
                "node.time_zero",
            )
            np.testing.assert_array_equal(rotated, expected.response.astype(np.float32))
            assert len(rotated) == (kept or n_samples)
            seen["found"] += got.found
            seen["moved"] += got.moved
    assert passed(board), board.as_json()
    assert seen["moved"] == 20 if moved_responses == 3 else seen["moved"] > 20
    assert seen["found"] > 200


@pytest.mark.parametrize("floor_factor", [0.0, 4.0])
def test_weak_signal(floor_factor: float) -> None:
    config = _core.WeakSignalConfig(floor_factor=floor_factor, averaging_factor=0.8)
    board = Scoreboard()
    core, reference = _core.WeakSignalEnhancer(), WeakSignal(as_reference(config))
    assert core.configure(config, N_SAMPLES) == _core.Status.ok
    rng = np.random.default_rng(3)
    for index in range(30):
        samples = rng.normal(0.0, 1.0, N_SAMPLES) * np.exp(-np.arange(N_SAMPLES) / 60.0) * 1e3
        samples += rng.normal(0.0, 1.0, N_SAMPLES)
        if index == 7:
            samples[-70:] = 0.0  # nothing at all behind some sample
        given = samples.astype(np.float32)
        status, got = core.process(given)
        assert status == _core.Status.ok
        expected = reference.process(given.astype(np.float64))
        board.floats("enhanced", "residual", f"response {index}", got, expected, "node.weak_signal")
        board.floats("noise", "noise", f"response {index}", core.noise(), reference.noise, "node.weak_signal")
    assert passed(board), board.as_json()


@pytest.mark.parametrize("spread", ["standard_deviation", "rms"])
@pytest.mark.parametrize(("fast", "slow"), [(0.3, 0.02), (0.5, 0.01), (1.0, 1.0)])
def test_gaussian_cfar(spread: str, fast: float, slow: float) -> None:
    config = _core.GaussianCfarConfig(
        fast_factor=fast, slow_factor=slow, spread=getattr(_core.ClutterSpread, spread), deviations=0.7
    )
    core, board, n_hits = _core.GaussianCfarDetector(), Scoreboard(), 0
    assert core.configure(config) == _core.Status.ok
    assert core.delay_samples() == pytest.approx(delay_samples(config), rel=1e-6)
    for seed in range(20):
        rng = np.random.default_rng(seed)
        samples = rng.normal(0.0, 1.0, int(rng.integers(1, 511)))
        for _ in range(3):
            samples[rng.integers(len(samples)) :][:20] *= 6.0
        given = samples.astype(np.float32)
        status, got = core.process(given)
        assert status == _core.Status.ok
        expected = gaussian_cfar(given.astype(np.float64), as_reference(config))
        board.decisions(spread, "decisions", f"seed {seed}", got, expected.decisions, expected.margin)
        n_hits += int(got.sum())
    assert passed(board), board.as_json()
    assert n_hits > 100 or fast == slow  # the fast mean is the slow one


@pytest.mark.parametrize("density_correction", [False, True])
@pytest.mark.parametrize(("window", "least"), [(15, 5), (1, 1), (40, 2)])
def test_target_traces(window: int, least: int, density_correction: bool) -> None:
    config = _core.TargetTraceConfig(
        window_samples=window, least_hits=least, density_correction=density_correction
    )
    core, board, n_traces = _core.TargetTracer(), Scoreboard(), 0
    assert core.configure(config) == _core.Status.ok
    for seed in range(60):
        rng = np.random.default_rng(seed)
        decisions = (rng.random(200) < rng.choice([0.02, 0.1, 0.2])).astype(np.uint8)
        for begin in rng.integers(0, 200, 2):
            decisions[begin : begin + 20] = rng.random(len(decisions[begin : begin + 20])) < 0.7
        status, got = core.process(decisions)
        expected = target_traces(decisions, as_reference(config))
        cut = len(expected.weight) > 16
        assert status == (_core.Status.truncated if cut else _core.Status.ok)
        board.decisions("weight", "detections", f"seed {seed}", got["weight"], expected.weight[:16], 1.0)
        board.floats(
            "toa",
            "detections",
            f"seed {seed}",
            got["toa_samples"],
            expected.toa_samples[:16],
            "node.target_trace",
        )
        n_traces += len(got)
    assert passed(board), board.as_json()
    assert n_traces > 60


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"fraction": 0.3, "before_samples": 0, "after_samples": 30},
        {"fraction": 0.9, "before_samples": 600, "after_samples": 0},
        {"rule": _core.EdgeRule.contrast},
        {"rule": _core.EdgeRule.contrast, "mean_samples": 1, "before_samples": 40, "after_samples": 40},
        {"rule": _core.EdgeRule.contrast, "mean_samples": 300, "before_samples": 200, "after_samples": 200},
    ],
)
def test_leading_edge(settings: dict[str, Any]) -> None:
    config = _core.LeadingEdgeConfig(**settings)
    tracer, core, board, n_moved = _core.TargetTracer(), _core.LeadingEdge(), Scoreboard(), 0
    assert tracer.configure(_core.TargetTraceConfig()) == core.configure(config) == _core.Status.ok
    for seed in range(60):
        rng = np.random.default_rng(seed)
        envelope = np.abs(rng.normal(0.0, 1.0, N_SAMPLES))
        for begin in rng.integers(0, N_SAMPLES, 3):
            envelope[begin : begin + 12] += rng.uniform(3.0, 30.0) * np.hanning(24)[:12][: N_SAMPLES - begin]
        given = envelope.astype(np.float32)
        _, traces = tracer.process((given > 2.5).astype(np.uint8))
        status, got = core.process(given, traces)
        assert status == _core.Status.ok
        expected = leading_edge(
            given.astype(np.float64), traces["toa_samples"].astype(np.float64), as_reference(config)
        )
        if expected.margin < 1e-5:
            continue
        np.testing.assert_array_equal(got["weight"], traces["weight"])
        row = "node.largest_step" if "rule" in settings else "node.leading_edge"
        board.floats("toa", "detections", f"seed {seed}", got["toa_samples"], expected.toa_samples, row)
        n_moved += int(np.sum(got["toa_samples"] != traces["toa_samples"]))
    assert passed(board), board.as_json()
    assert n_moved > 60
