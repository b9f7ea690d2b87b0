"""Track manager and Kalman tracker: core against reference, every choice."""

import itertools

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.evaluation.tracking_benchmark import tracking_scene
from echofuse.reference.estimation.kalman import ConstantVelocityFilter
from echofuse.reference.hub.track.kalman_tracker import KalmanTracker
from echofuse.reference.hub.track.track_manager import Step, TrackEstimate, TrackManager

SEEDS = range(20)
N_FRAMES = 40
MAX_TRACKS = _core.LIMITS["max_tracks"]


def compare(
    board: Scoreboard, choice: str, where: str, tracks: np.ndarray, step: Step, tolerance: str
) -> bool:
    """Compare tracks after a frame; False when a coin toss fell differently."""
    filters: list[ConstantVelocityFilter] = [t.filter for t in step.tracks]
    expected = np.array([[t.id, t.state, t.frames_since_update] for t in step.tracks], int).reshape(-1, 3)
    got = np.column_stack([tracks["id"], tracks["state"], tracks["frames_since_update"]])
    if not board.decisions(choice, "tracks", where, got, expected, step.margin):
        return False
    states = np.array([f.state[[0, 2, 1, 3]] for f in filters]).reshape(-1, 4)
    covariances = np.array([f.covariance[[0, 0, 2], [0, 2, 2]] for f in filters]).reshape(-1, 3)
    names = ("x_m", "y_m", "vx_mps", "vy_mps")
    board.floats(choice, "states", where, np.column_stack([tracks[n] for n in names]), states, tolerance)
    parts = ("covariance_xx_m2", "covariance_xy_m2", "covariance_yy_m2")
    got_covariances = np.column_stack([tracks[n] for n in parts])
    board.floats(choice, "covariances", where, got_covariances, covariances, "estimation.kalman.covariance")
    return True


@pytest.mark.parametrize(
    ("association", "update"),
    list(itertools.product(["per_pair", "hypothesis_cost"], ["estimate", "kalman"])),
)
@pytest.mark.parametrize("cost_max_m", [0.3, 5.0])
def test_track_manager(association: str, update: str, cost_max_m: float) -> None:
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
        core = _core.TrackManager()
        assert core.configure(config) == _core.Status.ok
        reference = TrackManager(as_reference(config), MAX_TRACKS)
        rng = np.random.default_rng(seed)
        scene = tracking_scene(
            seed, n_targets=5, n_scans=N_FRAMES, side_m=10.0, clutter_per_scan=3.0, detection_probability=0.7
        )
        for frame, z in enumerate(scene.measurements):
            points = np.zeros((len(z), 7), np.float32)
            points[:, :2] = z
            points[:, 2:4] = rng.normal(0.0, 1.0, (len(z), 2))
            points[:, [4, 6]] = rng.uniform(0.01, 0.1, (len(z), 2))
            estimates = [
                TrackEstimate(p[:2], p[2:4], np.array([[p[4], p[5]], [p[5], p[6]]]))
                for p in points.astype(np.float64)
            ]
            _, tracks = core.process(points, scene.dt_s)
            step = reference.process(estimates, scene.dt_s)
            where = f"seed {seed}, frame {frame}"
            if not compare(board, association, where, tracks, step, "hub.track.kalman"):
                break
            compared += 1
        assert core.dropped_births == reference.dropped_births
    assert {row.tap: row.failures for row in board.rows() if row.failures} == {}
    assert compared > 0.9 * len(SEEDS) * N_FRAMES


@pytest.mark.parametrize("gate_sigma", [0.0, 3.0])
def test_kalman_tracker(gate_sigma: float) -> None:
    board = Scoreboard()
    for seed in SEEDS:
        config = _core.TrackManagerConfig(
            update=_core.TrackUpdate.kalman, gate_sigma=gate_sigma, measurement_std_m=0.1, gate_m=0.8
        )
        core = _core.KalmanTracker()
        assert core.configure(config) == _core.Status.ok
        reference = KalmanTracker(as_reference(config), MAX_TRACKS)
        scene = tracking_scene(
            seed, n_targets=4, n_scans=N_FRAMES, side_m=10.0, clutter_per_scan=2.0, detection_probability=0.8
        )
        for frame, z in enumerate(scene.measurements):
            _, tracks = core.process(z, scene.dt_s)
            step = reference.process(z.astype(np.float64), scene.dt_s)
            if not compare(board, "", f"seed {seed}, frame {frame}", tracks, step, "hub.track.kalman"):
                break
    assert {row.tap: row.failures for row in board.rows() if row.failures} == {}
