"""Track manager and Kalman tracker: core against reference, every choice, in the plane and in space."""

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.evaluation.tracking_benchmark import tracking_scene
from echofuse.reference.hub.track.kalman_tracker import KalmanTracker
from echofuse.reference.hub.track.track_manager import Step, TrackEstimate, TrackManager

SEEDS = range(20)
N_FRAMES = 40
MAX_TRACKS = _core.LIMITS["max_tracks"]
MANAGERS = {2: _core.TrackManager, 3: _core.TrackManager3d}
TRACKERS = {2: _core.KalmanTracker, 3: _core.KalmanTracker3d}
TRACKS = {2: 39, 3: 42}  # the taps


def state_names(dimension: int) -> list[str]:
    """Fields of a track."""
    axes = "xyz"[:dimension]
    return [f"{axis}_m" for axis in axes] + [f"v{axis}_mps" for axis in axes]


def compare(
    board: Scoreboard, choice: str, where: str, tracks: NDArray[np.void], step: Step, dimension: int
) -> bool:
    """Compare tracks after a frame; False when a coin toss fell differently."""
    expected = np.array([[t.id, t.state, t.frames_since_update] for t in step.tracks], int).reshape(-1, 3)
    got = np.column_stack([tracks["id"], tracks["state"], tracks["frames_since_update"]])
    if not board.decisions(choice, "tracks", where, got, expected, step.margin):
        return False
    filters = [t.filter for t in step.tracks]
    states = np.array([[*f.position, *f.velocity] for f in filters]).reshape(-1, 2 * dimension)
    got_states = np.column_stack([tracks[name] for name in state_names(dimension)])
    board.floats(choice, "states", where, got_states, states, "hub.track.kalman")
    axes, lower = "xyz"[:dimension], np.tril_indices(dimension)
    covariances = np.array([f.position_covariance[lower] for f in filters]).reshape(-1, len(lower[0]))
    names = [f"covariance_{axes[column]}{axes[row]}_m2" for row, column in zip(*lower, strict=True)]
    got_covariances = np.column_stack([tracks[name] for name in names])
    board.floats(choice, "covariances", where, got_covariances, covariances, "estimation.kalman.covariance")
    return True


def with_height(rng: np.random.Generator, points: NDArray[np.float32], dimension: int) -> NDArray[np.float32]:
    """Points of the plane (m, 2) as (m, dimension)."""
    heights = rng.uniform(0.8, 1.4, (len(points), dimension - 2))
    return np.column_stack([points, heights]).astype(np.float32)


@pytest.mark.parametrize(
    ("association", "update"),
    list(itertools.product(["per_pair", "hypothesis_cost"], ["estimate", "kalman"])),
)
@pytest.mark.parametrize("cost_max_m", [0.3, 5.0])
@pytest.mark.parametrize("dimension", [2, 3])
def test_track_manager(dimension: int, association: str, update: str, cost_max_m: float) -> None:
    board = Scoreboard()
    compared = 0
    for seed in SEEDS:
        config = _core.TrackManagerConfig(
            association=getattr(_core.AssociationRule, association),
            update=getattr(_core.TrackUpdate, update),
            cost_max_m=cost_max_m,
            measurement_std_m=0.1,
            silent_time_min_s=0.6,
            silent_time_max_s=2.0,
        )
        core = MANAGERS[dimension]()
        assert core.configure(config) == _core.Status.ok
        reference = TrackManager(as_reference(config), MAX_TRACKS)
        rng = np.random.default_rng(seed)
        scene = tracking_scene(
            seed, n_targets=5, n_scans=N_FRAMES, side_m=10.0, clutter_per_scan=3.0, detection_probability=0.7
        )
        for frame, z in enumerate(scene.measurements):
            position = with_height(rng, z, dimension)
            velocity = rng.normal(0.0, 1.0, position.shape).astype(np.float32)
            root = rng.normal(0.0, 0.2, (len(z), dimension, dimension))
            spread = (root @ root.transpose(0, 2, 1) + 0.01 * np.eye(dimension)).astype(np.float32)
            rows, columns = np.tril_indices(dimension)
            points = np.column_stack([position, velocity, spread[:, rows, columns]])
            exact = (of.astype(np.float64) for of in (position, velocity, spread))
            estimates = list(map(TrackEstimate, *exact))
            _, tracks = core.process(points, scene.dt_s)
            step = reference.process(estimates, scene.dt_s)
            where = f"seed {seed}, frame {frame}"
            if not compare(board, association, where, tracks, step, dimension):
                break
            compared += 1
        assert core.dropped_births == reference.dropped_births
    assert {row.tap: row.failures for row in board.rows() if row.failures} == {}
    assert compared > 0.9 * len(SEEDS) * N_FRAMES


@pytest.mark.parametrize("gate_sigma", [0.0, 3.0])
@pytest.mark.parametrize("dimension", [2, 3])
def test_kalman_tracker(dimension: int, gate_sigma: float) -> None:
    board = Scoreboard()
    for seed in SEEDS:
        config = _core.TrackManagerConfig(
            update=_core.TrackUpdate.kalman, gate_sigma=gate_sigma, measurement_std_m=0.1, gate_m=0.8
        )
        core = TRACKERS[dimension]()
        assert core.configure(config) == _core.Status.ok
        reference = KalmanTracker(as_reference(config), MAX_TRACKS)
        rng = np.random.default_rng(seed)
        scene = tracking_scene(
            seed, n_targets=4, n_scans=N_FRAMES, side_m=10.0, clutter_per_scan=2.0, detection_probability=0.8
        )
        for frame, z in enumerate(scene.measurements):
            points = with_height(rng, z, dimension)
            _, tracks, taps = core.process_with_taps(points, scene.dt_s)
            names = ["id", "state", *state_names(dimension), "frames_since_update"]
            shown = np.column_stack([tracks[name] for name in names])
            np.testing.assert_array_equal(taps[TRACKS[dimension]], shown)
            step = reference.process(points.astype(np.float64), scene.dt_s)
            if not compare(board, "", f"seed {seed}, frame {frame}", tracks, step, dimension):
                break
    assert {row.tap: row.failures for row in board.rows() if row.failures} == {}
