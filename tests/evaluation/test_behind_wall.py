"""Paths, bounds and metrics behind a wall: against the reference of the hub, and by hand."""

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from echofuse.evaluation.behind_wall import (
    close_in_path,
    false_track_ids,
    ghosts_per_frame,
    path_behind_wall_m,
    position_error_bound_behind_wall_m,
    tracked_fractions,
)
from echofuse.evaluation.limits import position_error_bound_m
from echofuse.evaluation.tracking import match_tracks
from echofuse.recording import TRACK_DTYPE, PersonTruth
from echofuse.reference.hub.locate.line_locator import locate_on_line, path_and_gradient
from echofuse.result import POINT_DTYPE
from echofuse.simulation.wall import Wall

RX_X_M = np.array([-0.4, 0.4])
TX_M = np.zeros((2, 3))
RX_M = np.array([[x, 0.0, 0.0] for x in RX_X_M])
WALL = Wall(thickness_m=0.24, permittivity=4.0)
SECOND_KIND = SimpleNamespace(thickness_m=0.24, relative_permittivity=4.0, compensation="second_kind")
PLACES = [(0.0, 2.0), (1.9, 1.4), (-0.825, 5.4), (2.3, 0.7)]
TIME_S = 0.1 * np.arange(31)  # frames 10 to 30 are evaluated


@pytest.mark.parametrize("place", PLACES)
def test_paths_and_bound_are_those_of_the_line_locator(place: tuple[float, float]) -> None:
    expected, _ = path_and_gradient(SECOND_KIND, np.array(place), RX_X_M)
    at_m = np.array([*place, 0.0])
    paths = [path_behind_wall_m(at_m, tx, rx, WALL) for tx, rx in zip(TX_M, RX_M, strict=True)]
    assert_allclose(paths, expected, atol=1e-7)
    config = SimpleNamespace(wall=SECOND_KIND, path_std_m=0.05)
    covariance = locate_on_line(config, RX_X_M, expected, np.ones(2)).covariance_m2
    bound = position_error_bound_behind_wall_m(at_m, TX_M, RX_M, 0.05, WALL)
    assert_allclose(bound, np.sqrt(np.trace(covariance)), rtol=1e-4)


def test_a_wall_of_air_leaves_the_bound_as_it_is() -> None:
    places = np.array([[*place, 0.0] for place in PLACES])
    air = Wall(thickness_m=0.24, permittivity=1.0)
    bound = position_error_bound_behind_wall_m(places, TX_M, RX_M, 0.05, air)
    assert_allclose(bound, position_error_bound_m(places[:, :2], TX_M[:, :2], RX_M[:, :2], 0.05), rtol=1e-6)


def test_height_counts_for_the_path_and_mirrors_are_alike() -> None:
    left, right = (path_behind_wall_m(np.array([x, 3.0, 0.5]), TX_M[0], TX_M[0], WALL) for x in (-1.0, 1.0))
    level = path_behind_wall_m(np.array([1.0, 3.0, 0.0]), TX_M[0], TX_M[0], WALL)
    assert left == pytest.approx(float(right))
    assert right > level + 0.05


def test_who_crosses_or_stands_symmetric() -> None:
    path_m = np.array([[4.0, 4.9, 9.0], [4.0, 5.1, 9.0], [4.0, 4.1, 4.2]])
    present = np.array([[True, True, True], [True, True, True], [True, False, True]])
    expected = [[True, True, False], [False, False, False], [True, False, True]]
    assert_array_equal(close_in_path(path_m, present), expected)


def _track(frames: object, x_m: object, *, id: int, state: int = 1) -> np.ndarray:
    rows = np.zeros(np.size(frames), TRACK_DTYPE)
    rows["frame"], rows["x_m"], rows["id"], rows["state"] = frames, x_m, id, state
    return rows


def _person(x_m: float, id: str) -> PersonTruth:
    return PersonTruth(id=id, time_s=TIME_S, position_m=np.tile([x_m, 0.0, 1.0], (TIME_S.size, 1)))


def test_each_person_counts_alone() -> None:
    people = [_person(0.0, "1"), _person(5.0, "2")]
    tracks = np.concatenate([_track(np.arange(31), 0.1, id=1), _track(np.arange(24, 31), 5.0, id=2)])
    matches = match_tracks(tracks, TIME_S, people)
    assert_allclose(tracked_fractions(matches), [1.0, 7 / 21])
    late = np.zeros((21, 2), bool)
    late[-14:, 1] = True
    assert_allclose(tracked_fractions(matches, late), [np.nan, 0.5])


def test_a_track_is_false_if_it_mostly_matches_nobody() -> None:
    people = [_person(0.0, "1")]
    wandering = _track(np.arange(11, 20), [0.0, 0.0, 0.0, *[4.0] * 6], id=3)  # alone with the person at first
    tracks = np.concatenate(
        [
            _track(np.arange(20, 31), [9.0, *[0.2] * 10], id=1),  # astray once
            wandering,
            _track(np.arange(31), 7.0, id=4, state=0),  # never confirmed
            _track(np.arange(5), 8.0, id=5),  # before the evaluation begins
            _track(np.arange(15, 20), 6.0, id=6),
        ]
    )
    assert false_track_ids(tracks, match_tracks(tracks, TIME_S, people)) == [3, 6]


def test_ghosts_are_points_far_from_everybody() -> None:
    points = np.zeros(5, POINT_DTYPE)
    points["frame"] = [3, 12, 12, 12, 20]
    points["x_m"] = [9.0, 0.9, 2.5, 4.1, 9.0]  # the first one too early
    frames = np.arange(10, 31)
    people = [_person(0.0, "1"), _person(5.0, "2")]
    assert ghosts_per_frame(points, frames, TIME_S, people) == pytest.approx(2 / 21)
    assert ghosts_per_frame(points, frames, TIME_S, people[:1]) == pytest.approx(3 / 21)
    assert ghosts_per_frame(points, frames, TIME_S, []) == pytest.approx(4 / 21)
