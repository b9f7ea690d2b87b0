"""Particle PHD filter and its chain: every tap against the reference, step by step from the core's state."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.evaluation.tracking_benchmark import tracking_scene
from echofuse.reference.hub.track.phd_tracker import PhdTracker, estimates, find_peaks

SEEDS = range(20)
N_FRAMES = 12
PREDICTED, UPDATED, RESAMPLED, PEAKS, TRACKS = 35, 36, 37, 38, 39
UNCONFIRMED = 0

CHOICES: dict[str, tuple[dict[str, Any], dict[str, Any], dict[str, Any]]] = {
    "default": ({}, {}, {}),
    "resampling=proportional": ({"resampling": _core.ResamplingChance.proportional}, {}, {}),
    "initialisation=k_means_plus_plus": (
        {},
        {"initialisation": _core.PeakInitialisation.k_means_plus_plus, "restarts": 1},
        {},
    ),
    "association=hypothesis_cost": ({}, {}, {"association": _core.AssociationRule.hypothesis_cost}),
    "update=kalman": ({}, {}, {"update": _core.TrackUpdate.kalman, "measurement_std_m": 0.1}),
    "mass_average_frames=3": ({"mass_average_frames": 3}, {}, {}),
    "no background": ({}, {"background_density_per_m2": 0.0}, {}),
}


def compare_frame(
    board: Scoreboard,
    choice: str,
    where: str,
    core: Any,
    reference: PhdTracker,
    z: NDArray[np.float32],
    dt_s: float,
) -> bool:
    """Compare all taps of a frame; the reference takes each stage's input from the core. False: stop."""
    status, tracks, taps = core.process_with_taps(z, dt_s)
    assert status == _core.Status.ok
    phd = reference.phd

    predicted = phd.predict(dt_s)
    board.floats(choice, "predicted", where, taps[PREDICTED][:, :4], predicted[:, :4], "hub.track.moved")
    board.floats(choice, "predicted", where, taps[PREDICTED][:, 4], predicted[:, 4], "hub.track.weight")

    phd.particles = taps[PREDICTED].astype(np.float64)
    update = phd.update(z.astype(np.float64))
    board.floats(choice, "updated", where, taps[UPDATED][:, :4], update.particles[:, :4], "hub.track.moved")
    board.floats(choice, "updated", where, taps[UPDATED][:, 4], update.particles[:, 4], "hub.track.weight")
    board.floats(choice, "mass", where, core.mass, update.mass, "hub.track.mass")
    peaks_got = taps[PEAKS]
    if not board.decisions(choice, "number", where, len(peaks_got), update.number, update.number_margin):
        return False

    phd.particles = taps[UPDATED].astype(np.float64)
    given = update._replace(particles=phd.particles)
    peaks = find_peaks(given, z.astype(np.float64), reference.em, phd.peak_seed)
    if peaks is not None:
        expected = np.column_stack([peaks.mean, peaks.velocity])
        if not board.floats(
            choice, "peaks", where, peaks_got[:, :4], expected, "hub.track.peak", peaks.margin
        ):
            return False

    drawn = phd.resample()
    expected_positions = given.particles[drawn.indices, 0].astype(np.float32)
    if board.decisions(choice, "resampled", where, taps[RESAMPLED][:, 0], expected_positions, drawn.margin):
        board.floats(
            choice, "resampled weight", where, taps[RESAMPLED][:, 4], phd.particles[:, 4], "hub.track.weight"
        )
    phd.particles = taps[RESAMPLED].astype(np.float64)

    step = reference.manager.process(estimates(peaks), dt_s)
    rows = [[t.id, t.state, t.frames_since_update, *t.filter.state[[0, 2, 1, 3]]] for t in step.tracks]
    table = np.array(rows, np.float64).reshape(-1, 7)
    decided = np.column_stack([tracks["id"], tracks["state"], tracks["frames_since_update"]])
    if not board.decisions(choice, "tracks", where, decided, table[:, :3].astype(int), step.margin):
        return False
    moved = np.column_stack([tracks[name] for name in ("x_m", "y_m", "vx_mps", "vy_mps")])
    board.floats(choice, "track states", where, moved, table[:, 3:], "hub.track.track")
    shown = np.column_stack([decided[:, :2], moved, decided[:, 2]]).astype(np.float32)
    assert np.array_equal(taps[TRACKS].reshape(-1, 7), shown)
    return True


@pytest.mark.parametrize("choice", CHOICES)
def test_every_tap(choice: str) -> None:
    board = Scoreboard()
    compared = 0
    for seed in SEEDS:
        phd_settings, em_settings, track_settings = CHOICES[choice]
        phd = _core.PhdConfig(
            area_m2=100.0, measurement_std_m=0.1, birth_per_frame=0.1, particles_per_target=200, seed=seed + 7
        )
        em, manager = _core.MixtureConfig(**em_settings), _core.TrackManagerConfig(**track_settings)
        for name, value in phd_settings.items():
            setattr(phd, name, value)
        core = _core.PhdTracker()
        assert core.configure(phd, em, manager) == _core.Status.ok
        limits = type("Limits", (), _core.LIMITS)
        reference = PhdTracker(
            as_reference(phd), as_reference(em), as_reference(manager), limits, _core.LIMITS["max_tracks"]
        )
        scene = tracking_scene(
            seed, n_targets=3, n_scans=N_FRAMES, side_m=10.0, clutter_per_scan=2.0, detection_probability=0.85
        )
        for frame, z in enumerate(scene.measurements):
            if not compare_frame(
                board, choice, f"seed {seed}, frame {frame}", core, reference, z, scene.dt_s
            ):
                break
            compared += 1
    assert {row.tap: row.failures for row in board.rows() if row.failures} == {}
    assert compared > 0.8 * len(SEEDS) * N_FRAMES  # a coin toss ends a seed; few may


def test_capacities_are_kept() -> None:
    """More points than a frame may have: the first are used, and it is said."""
    limits = _core.LIMITS
    rng = np.random.default_rng(0)
    tracker = _core.PhdTracker()
    phd = _core.PhdConfig(particles_per_target=limits["max_particles"], newborn_per_measurement=1024)
    assert tracker.configure(phd, _core.MixtureConfig(), _core.TrackManagerConfig()) == _core.Status.ok
    points = rng.uniform(0.0, 10.0, (limits["max_points_per_frame"] + 9, 2)).astype(np.float32)
    for _ in range(3):
        status, tracks, taps = tracker.process_with_taps(points, 0.1)
        assert status == _core.Status.truncated
        assert len(taps[UPDATED]) <= limits["max_particles"] + limits["max_newborn_particles"]
        assert len(taps[RESAMPLED]) == limits["max_particles"]
        assert len(tracks) <= limits["max_tracks"]
