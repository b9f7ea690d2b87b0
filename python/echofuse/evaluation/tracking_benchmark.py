"""Trackers alone: targets in a square, measurements with misses and clutter, and the score of a tracker."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from echofuse.evaluation.ospa import ospa
from echofuse.tracking import (
    KalmanTracker,
    MixtureConfig,
    PhdConfig,
    PhdTracker,
    TrackManagerConfig,
    TrackState,
)


class TrackingScene(NamedTuple):
    """Targets alive throughout and what a sensor says of them, scan by scan."""

    dt_s: float
    truth: NDArray[np.float64]  # (n_scans, n_targets, 2) [m]
    measurements: list[NDArray[np.float32]]  # n_scans arrays (m, 2) [m], in random order


class TrackingScore(NamedTuple):
    """Means over the scans after the first ones, and over all scans."""

    ospa_m: float
    number_error: float  # mean of |estimated - true number|
    ospa_all_m: float
    number_error_all: float


def tracking_scene(
    seed: int,
    *,
    n_targets: int = 10,
    n_scans: int = 100,
    dt_s: float = 0.2,
    side_m: float = 20.0,
    speed_mps: float = 1.0,
    acceleration_density_m2ps3: float = 0.01,
    mirrored: bool = False,
    detection_probability: float = 0.95,
    clutter_per_scan: float = 10.0,
    measurement_std_m: float = 0.1,
) -> TrackingScene:
    """Draw a scene of targets of nearly constant velocity in a square, and Poisson clutter uniform over it.

    Each target starts anywhere, in any direction, at a speed normal around ``speed_mps`` (deviation a tenth).
    Paths that leave the square are drawn anew; with ``mirrored`` they are reflected at its walls in no time,
    which is a harder test than people are.
    """
    rng = np.random.default_rng(seed)
    velocity_steps = np.sqrt(acceleration_density_m2ps3 * dt_s)
    paths: list[NDArray[np.float64]] = []
    while len(paths) < n_targets:
        heading, speed = rng.uniform(0.0, 2.0 * np.pi), speed_mps * (1.0 + 0.1 * rng.standard_normal())
        start = speed * np.array([np.cos(heading), np.sin(heading)])
        kicks = velocity_steps * rng.standard_normal((n_scans - 1, 2))
        velocity = start + np.concatenate([np.zeros((1, 2)), np.cumsum(kicks, axis=0)])
        moves = dt_s * (velocity[:-1] + 0.5 * kicks)
        path = rng.uniform(0.0, side_m, 2) + np.concatenate([np.zeros((1, 2)), np.cumsum(moves, axis=0)])
        if mirrored:
            path = side_m - np.abs(np.mod(path, 2.0 * side_m) - side_m)
        if path.min() >= 0.0 and path.max() <= side_m:
            paths.append(path)
    truth = np.stack(paths, axis=1)
    measurements = []
    for position in truth:
        seen = position[rng.random(n_targets) < detection_probability]
        noisy = seen + measurement_std_m * rng.standard_normal(seen.shape)
        clutter = rng.uniform(0.0, side_m, (rng.poisson(clutter_per_scan), 2))
        measurements.append(rng.permutation(np.concatenate([noisy, clutter])).astype(np.float32))
    return TrackingScene(dt_s, truth, measurements)


def score_tracker(
    scene: TrackingScene,
    process: Callable[[NDArray[np.float32], float], NDArray[np.floating]],
    *,
    first_scan: int = 10,
    cutoff_m: float = 1.0,
    order: float = 2.0,
) -> TrackingScore:
    """Score ``process(measurements, dt_s) -> positions (n, 2)`` of the reported tracks [m].

    No tracker can tell ten targets from ten clutter points in the first scan, and each silent scan there
    costs a number error of ten; so the scans from ``first_scan`` on are scored apart.
    """
    errors, numbers = [], []
    for true, measured in zip(scene.truth, scene.measurements, strict=True):
        estimated = process(measured, scene.dt_s)
        errors.append(ospa(estimated, true, cutoff_m=cutoff_m, order=order).distance)
        numbers.append(abs(len(estimated) - len(true)))
    return TrackingScore(
        ospa_m=float(np.mean(errors[first_scan:])),
        number_error=float(np.mean(numbers[first_scan:])),
        ospa_all_m=float(np.mean(errors)),
        number_error_all=float(np.mean(numbers)),
    )


def reported_positions(tracks: NDArray[np.void]) -> NDArray[np.float64]:
    """Take the positions (n, 2) [m] of the confirmed and silent ones out of a tracker's structured array."""
    reported = tracks[tracks["state"] != int(TrackState.unconfirmed)]
    return np.column_stack([reported["x_m"], reported["y_m"]]).astype(np.float64)


def benchmark_trackers(tracker_seed: int = 1) -> dict[str, PhdTracker | KalmanTracker]:
    """Make the PHD and the Kalman tracker as configured for `tracking_scene`'s defaults."""
    config = PhdConfig(
        detection_probability=0.95,
        clutter_per_frame=10.0,
        birth_per_frame=0.1,
        area_m2=400.0,
        measurement_std_m=0.1,
        acceleration_density_m2ps3=0.02,
        newborn_velocity_std_mps=1.0,
        newborn_per_measurement=50,
        seed=tracker_seed,
    )
    tracks = TrackManagerConfig(
        silent_velocity_time_s=2.0, silent_time_max_s=3.0, acceleration_density_m2ps3=0.02
    )
    kalman = TrackManagerConfig(
        gate_m=0.6,
        confirm_updates=4,
        silent_time_min_s=0.6,
        silent_velocity_time_s=2.0,
        silent_time_max_s=3.0,
        acceleration_density_m2ps3=0.02,
        measurement_std_m=0.1,
        velocity_std_mps=1.0,
    )
    return {
        "phd": PhdTracker(config, tracks, MixtureConfig(initial_std_m=0.1)),
        "kalman": KalmanTracker(kalman),
    }


def _positions_after(
    tracker: PhdTracker | KalmanTracker, measurements: NDArray[np.float32], dt_s: float
) -> NDArray[np.float64]:
    return reported_positions(tracker.process(measurements, dt_s))


def main() -> None:
    """Print both trackers' mean scores: ``python -m echofuse.evaluation.tracking_benchmark``."""
    parser = argparse.ArgumentParser(description="Score the trackers on the ten-target scene.")
    parser.add_argument("--seeds", type=int, default=20, help="scenes 0 to SEEDS - 1")
    parser.add_argument("--mirrored", action="store_true", help="targets bounce off the walls")
    arguments = parser.parse_args()
    print(f"{'tracker':8} {'OSPA':>7} {'number':>7} {'OSPA, all':>10} {'number, all':>12} {'ms/scan':>8}")
    for name in ("phd", "kalman"):
        started, scores = time.perf_counter(), []
        for seed in range(arguments.seeds):
            tracker = benchmark_trackers(seed + 1)[name]
            scene = tracking_scene(seed, mirrored=arguments.mirrored)
            scores.append(score_tracker(scene, partial(_positions_after, tracker)))
        milliseconds = 10.0 * (time.perf_counter() - started) / arguments.seeds
        mean = np.mean(scores, axis=0)
        print(f"{name:8} {mean[0]:7.3f} {mean[1]:7.3f} {mean[2]:10.3f} {mean[3]:12.3f} {milliseconds:8.2f}")


if __name__ == "__main__":
    main()
