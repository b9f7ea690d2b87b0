"""The trackers' Python interface, and that they reach what the project promises."""

import doctest

import numpy as np
import pytest

import echofuse.tracking
from echofuse.evaluation.tracking_benchmark import (
    TrackingScore,
    benchmark_trackers,
    reported_positions,
    score_tracker,
    tracking_scene,
)
from echofuse.tracking import KalmanTracker, PhdConfig, PhdTracker, TrackManagerConfig, TrackState

TRACKERS = [PhdTracker, KalmanTracker]


def test_the_example_runs() -> None:
    result = doctest.testmod(echofuse.tracking)
    assert result.attempted > 0
    assert result.failed == 0


@pytest.mark.parametrize("kind", TRACKERS)
def test_bad_input_is_named_and_changes_nothing(kind: type[PhdTracker | KalmanTracker]) -> None:
    tracker, untouched = kind(), kind()
    point = np.array([[1.0, 2.0]], np.float32)
    for each in (tracker, untouched):
        for _ in range(4):
            each.process(point, 0.1)
    for bad in (np.nan, np.inf):
        with pytest.raises(ValueError, match="finite"):
            tracker.process(np.array([[1.0, bad]], np.float32), 0.1)
    for dt_s in (0.0, -0.1, float("nan")):
        with pytest.raises(ValueError, match="dt_s"):
            tracker.process(point, dt_s)
    with pytest.raises(TypeError):
        tracker.process(point.astype(np.float64), 0.1)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"\(n, 2\)"):
        tracker.process(np.zeros((1, 3), np.float32), 0.1)
    assert np.array_equal(tracker.process(point, 0.1), untouched.process(point, 0.1))


def test_impossible_configurations_are_named() -> None:
    with pytest.raises(ValueError, match=r"PhdConfig\.area_m2"):
        PhdTracker(PhdConfig(area_m2=-1.0))
    with pytest.raises(ValueError, match=r"TrackManagerConfig\.gate_m"):
        KalmanTracker(TrackManagerConfig(gate_m=float("nan")))


@pytest.mark.parametrize("kind", TRACKERS)
def test_one_who_stops_is_held_silently(kind: type[PhdTracker | KalmanTracker]) -> None:
    """A walk of four seconds, then no echo: the same track, silent, near; found again on moving."""
    rng = np.random.default_rng(1)
    tracker = kind(manager=TrackManagerConfig(measurement_std_m=0.1))
    for frame in range(40):
        z = np.array([[1.0 + 0.1 * frame, 2.0]]) + rng.normal(0.0, 0.1, (1, 2))
        tracks = tracker.process(z.astype(np.float32), 0.1)
    identity = int(tracks["id"][0])
    for _ in range(30):
        tracks = tracker.process(np.zeros((0, 2), np.float32), 0.1)
    assert tracks["id"].tolist() == [identity]
    assert tracks["state"].tolist() == [int(TrackState.silent)]
    assert abs(tracks["x_m"][0] - 4.9) < 0.9
    for frame in range(10):
        tracks = tracker.process(np.array([[5.2 + 0.1 * frame, 2.0]], np.float32), 0.1)
    assert tracks["id"].tolist() == [identity]
    assert tracks["state"].tolist() == [int(TrackState.confirmed)]


def benchmark(name: str, seeds: range) -> TrackingScore:
    scores = []
    for seed in seeds:
        tracker = benchmark_trackers(seed + 1)[name]
        scores.append(
            score_tracker(
                tracking_scene(seed), lambda z, dt_s, t=tracker: reported_positions(t.process(z, dt_s))
            )
        )
    return TrackingScore(*np.mean(scores, axis=0))


@pytest.mark.parametrize("name", ["phd", "kalman"])
def test_ten_targets_in_clutter(name: str) -> None:
    """The promise: OSPA <= 0.13 m, number error <= 0.10, means over 20 scenes from their eleventh scan on."""
    score = benchmark(name, range(20))
    assert score.ospa_m <= 0.13
    assert score.number_error <= 0.10
