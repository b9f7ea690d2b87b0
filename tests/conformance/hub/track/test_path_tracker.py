"""The core's tracker of paths against the reference, in the plane and in space."""

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.reference.hub.track.path_tracker import PathTracker, paths_and_gradients, paths_by_skin

PERIOD_S, FRAMES = 0.074, 50
RX_M = {
    2: np.array([[-0.4, 0.0], [0.4, 0.0], [0.9, 0.0]]),
    3: 0.39 * np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]),
}
LEAST_M, MOST_M = np.array([-2.4, 0.7, -1.5]), np.array([2.4, 7.0, 2.5])
MARGIN_SHARE = 0.05  # of a margin, what is compared with the coin toss's: 50 responses in float32
COLUMNS = ("x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps")
AXES = ("xx", "xy", "xz", "yy", "yz", "zz")

CASES = {
    "plane": (2, {}, 0.0),
    "plane, growing deviations": (2, {"path_std_growth": 0.3}, 0.0),
    "points in space": (3, {}, 0.0),
    "balls": (3, {}, 0.21),
    "somebody who turns": (2, {"turn_density_m2ps3": 2.0, "turn_begin_probability": 0.02}, 0.0),
    "space, somebody who turns": (3, {"turn_density_m2ps3": 2.0, "acceleration_density_m2ps3": 0.01}, 0.21),
    "upright bodies": (3, {"body_half_height_m": 0.8, "path_std_growth": 0.1}, 0.21),
    "upright bodies in the open": (3, {"body_half_height_m": 0.8}, 0.21),
}


def walk(rng, dimension, rx_m, wall, half_axes_m):  # type: ignore[no-untyped-def]
    """Each receiver's paths (n,) of each response, and where both people are at first."""
    position = rng.uniform([-1.8, 2.0, -0.8], [1.8, 5.5, 1.5], (2, 3))[:, :dimension]
    velocity = rng.uniform(-0.8, 0.8, (2, 3))[:, :dimension]
    for _ in range(FRAMES):
        paths = [[] for _ in rx_m]
        outside = (position < LEAST_M[:dimension] + 0.1) | (position > MOST_M[:dimension] - 0.1)
        velocity = np.where(outside, -velocity, velocity)
        position = position + PERIOD_S * velocity
        for person in position:
            path_m, _ = paths_and_gradients(wall, person, rx_m)
            if half_axes_m is not None:
                path_m = paths_by_skin(wall, person, rx_m, half_axes_m) + 2.0 * half_axes_m[0]
            path_m = path_m + rng.normal(0.0, 0.06) + rng.normal(0.0, 0.05, len(rx_m))
            for r in np.flatnonzero(rng.random(len(rx_m)) < 0.8):
                paths[r].append(path_m[r])
        for of_receiver in paths:
            of_receiver.extend(rng.uniform(2.0, 14.0, rng.poisson(0.4)))
        yield [np.sort(np.array(of_receiver, np.float32)) for of_receiver in paths], position


@pytest.mark.parametrize("case", CASES)
def test_tracks_are_the_references(case):  # type: ignore[no-untyped-def]
    dimension, fields, radius_m = CASES[case]
    rx32 = RX_M[dimension].astype(np.float32)
    rx_m = rx32.astype(np.float64)
    kinds = _core.WallCompensation
    kind = kinds.none if "open" in case else kinds.second_kind
    config, wall = _core.PathTrackerConfig(**fields), _core.WallConfig(compensation=kind)
    corners = [corner[:dimension].astype(np.float32) for corner in (LEAST_M, MOST_M)]
    area_m = np.concatenate(corners).astype(np.float64)
    height_m = fields.get("body_half_height_m", 0.0) or radius_m
    half_axes_m = np.array([radius_m, radius_m, height_m]) if radius_m > 0.0 else None
    of_tracks, of_covariances = "through_wall.track", "through_wall.covariance"
    if "upright" in case:  # at the antennas' height a tall body's own hardly changes the difference of paths
        of_tracks, of_covariances = "hub.track.tall", "hub.track.tall_covariance"
    board, compared, confirmed = Scoreboard(), 0, 0
    for seed in range(4, 8):
        rng = np.random.default_rng(seed)
        tracker = (_core.PathTracker if dimension == 2 else _core.PathTracker3d)()
        assert tracker.configure(config, wall, rx32, *corners, radius_m) == _core.Status.ok
        reference = PathTracker(as_reference(config), as_reference(wall), rx_m, area_m, radius_m)
        for index, (paths, people) in enumerate(walk(rng, dimension, rx_m, as_reference(wall), half_axes_m)):
            where = f"seed {seed}, response {index}"
            status, owners = tracker.update(paths, PERIOD_S)
            assert status == _core.Status.ok
            expected = reference.update([of_receiver.astype(np.float64) for of_receiver in paths], PERIOD_S)
            if index % 20 == 0:
                covariance = (0.02 * np.eye(dimension)).astype(np.float32)
                for person in people:
                    at = (person + rng.normal(0.0, 0.1, dimension)).astype(np.float32)
                    assert tracker.begin(at, covariance) == _core.Status.ok
                    assert reference.begin(at.astype(np.float64), covariance.astype(np.float64))
            margin = MARGIN_SHARE * reference.margin
            tracks = tracker.tracks()
            decided = np.column_stack([tracks[name] for name in ("id", "state", "frames_since_update")])
            of_reference = np.array([(t.id, t.state, t.misses) for t in reference.tracks]).reshape(-1, 3)
            if not (
                board.decisions("", "owners", where, owners, np.concatenate(expected), margin)
                and board.decisions("", "states", where, decided, of_reference, margin)
            ):
                break
            compared += 1
            confirmed += int(np.sum(tracks["state"] == 1))
            places = np.zeros((len(reference.tracks), 6))
            spread = np.zeros((len(reference.tracks), 3, 3))
            for row, track in enumerate(reference.tracks):
                places[row, :dimension] = track.filter.position
                places[row, 3 : 3 + dimension] = track.filter.velocity
                spread[row, :dimension, :dimension] = track.filter.position_covariance
            got = np.column_stack([tracks[name] for name in COLUMNS])
            board.floats("", "tracks", where, got, places, of_tracks)
            got = np.column_stack([tracks[f"covariance_{axes}_m2"] for axes in AXES])
            upper = spread[:, *np.triu_indices(3)]
            board.floats("", "covariances", where, got, upper, of_covariances)
    for row in board.rows():
        assert row.passed, row.failures[:3]
        assert row.excused < 3
    assert compared > 3 * FRAMES
    assert confirmed > compared


def test_a_person_is_where_her_body_and_not_her_skin_is():  # type: ignore[no-untyped-def]
    """An upright body above the antennas reflects below its middle: a ball would be misplaced."""
    rx_m, person, half_axes_m = RX_M[3], np.array([0.4, 3.0, 1.2]), np.array([0.21, 0.21, 0.8])
    wall = _core.WallConfig()
    path_m = paths_by_skin(as_reference(wall), person, rx_m, half_axes_m) + 0.42
    paths = [np.array([path], np.float32) for path in path_m]
    corners = [corner.astype(np.float32) for corner in (LEAST_M, MOST_M)]
    error_m = {}
    for half_height_m in (0.8, 0.0):
        tracker = _core.PathTracker3d()
        config = _core.PathTrackerConfig(body_half_height_m=half_height_m)
        tracker.configure(config, wall, rx_m.astype(np.float32), *corners, 0.21)
        tracker.begin(person.astype(np.float32), (0.02 * np.eye(3)).astype(np.float32))
        for _ in range(40):
            assert tracker.update(paths, PERIOD_S)[0] == _core.Status.ok
        (track,) = tracker.tracks()
        error_m[half_height_m] = np.linalg.norm([track[name] for name in COLUMNS[:3]] - person)
    assert error_m[0.8] < 0.01
    assert error_m[0.0] > 0.1


def test_bad_configurations_are_refused():  # type: ignore[no-untyped-def]
    tracker, config, wall = _core.PathTracker3d(), _core.PathTrackerConfig(), _core.WallConfig()
    rx_m, least_m, most_m = (array.astype(np.float32) for array in (RX_M[3], LEAST_M, MOST_M))
    invalid = _core.Status.invalid_config
    behind = least_m * np.array([1, -1, 1], np.float32)
    out_of_plane = rx_m + np.array([[0, 0.1, 0]], np.float32)
    for refused in (
        (rx_m[:2], least_m, most_m, 0.2),
        (np.repeat(rx_m[:1], 4, axis=0), least_m, most_m, 0.2),
        (out_of_plane, least_m, most_m, 0.2),
        (np.zeros_like(rx_m), least_m, most_m, 0.2),
        (rx_m, most_m, least_m, 0.2),
        (rx_m, behind, most_m, 0.2),
        (rx_m, least_m, most_m * np.float32(np.nan), 0.2),
        (rx_m, least_m, most_m, -0.2),
    ):
        assert tracker.configure(config, wall, *refused) == invalid
    assert tracker.update([np.zeros(0, np.float32)] * 4, PERIOD_S)[0] == _core.Status.not_configured
    assert tracker.configure(config, wall, rx_m, least_m, most_m, 0.2) == _core.Status.ok
    for name in ("path_std_growth", "body_half_height_m"):
        assert _core.PathTrackerConfig(**{name: -0.1}).invalid_field() == name
