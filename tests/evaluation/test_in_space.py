"""Points, tracks and the paper's cuboid in space, by hand; paths and bound against the reference."""

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from echofuse.evaluation.behind_wall import (
    ghosts_per_frame,
    path_behind_wall_m,
    position_error_bound_behind_wall_m,
)
from echofuse.evaluation.in_space import cuboid_fraction, nearest_points_m, rms_m, tracks_of_matches_m
from echofuse.evaluation.limits import position_error_bound_m
from echofuse.evaluation.tracking import evaluate_tracks, match_tracks
from echofuse.recording import TRACK_DTYPE, PersonTruth
from echofuse.reference.hub.locate.taylor_3d import ranges_and_gradient, taylor_3d
from echofuse.result import POINT_DTYPE
from echofuse.simulation.wall import Wall

TIME_S = 0.1 * np.arange(31)  # frames 10 to 30 are evaluated
FRAMES = np.arange(10, 31)
CROSS_M = 0.39 * np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
TX_M = np.zeros((4, 3))
WALL = Wall(thickness_m=0.2, permittivity=4.0)
METHOD = SimpleNamespace(
    wall=SimpleNamespace(thickness_m=0.2, relative_permittivity=4.0, compensation="second_kind"),
    start="given",
    range_kind="bistatic",
    min_step_m=1e-4,
    max_iterations=20,
)
PLACES = [(0.0, 2.0, 0.0), (-0.75, 5.85, -1.58), (0.75, 1.0, 1.2), (1.5, 4.0, 0.8)]


def climber() -> PersonTruth:
    """From z = 0 up by 3 m, 1.8 m tall."""
    place = np.column_stack([np.zeros(31), np.full(31, 4.0), np.linspace(0.0, 3.0, 31)])
    return PersonTruth(id="1", time_s=TIME_S, position_m=place, height_m=1.8)


def rows(dtype: np.dtype, frames: object, offset_m: tuple[float, float, float], **fields: int) -> np.ndarray:
    """Rows at the climber's place and an offset."""
    frames = np.atleast_1d(frames)
    made = np.zeros(frames.size, dtype)
    made["frame"] = frames
    for axis, name in enumerate(("x_m", "y_m", "z_m")):
        made[name] = climber().position_m[frames, axis] + offset_m[axis]
    for name, value in fields.items():
        made[name] = value
    return made


@pytest.mark.parametrize("place", PLACES)
def test_paths_and_bound_are_those_of_the_taylor_series_method(place: tuple[float, float, float]) -> None:
    at_m = np.array(place)
    expected_m, _ = ranges_and_gradient(METHOD, TX_M[0], CROSS_M, at_m)
    paths_m = [path_behind_wall_m(at_m, tx, rx, WALL) for tx, rx in zip(TX_M, CROSS_M, strict=True)]
    assert_allclose(paths_m, expected_m, atol=1e-7)
    fix = taylor_3d(METHOD, TX_M[0], CROSS_M, expected_m, np.full(4, 0.03**2), at_m)
    bound_m = position_error_bound_behind_wall_m(at_m, TX_M, CROSS_M, 0.03, WALL, dimension=3)
    assert_allclose(bound_m, np.sqrt(np.trace(fix.covariance_m2)), rtol=1e-4)


def test_a_wall_of_air_leaves_the_bound_in_space_as_it_is() -> None:
    air = Wall(thickness_m=0.2, permittivity=1.0)
    bound_m = position_error_bound_behind_wall_m(np.array(PLACES), TX_M, CROSS_M, 0.03, air, dimension=3)
    assert_allclose(bound_m, position_error_bound_m(np.array(PLACES), TX_M, CROSS_M, 0.03), rtol=1e-6)


def test_a_known_height_makes_the_plane_surer() -> None:
    in_space, in_the_plane = (
        position_error_bound_behind_wall_m(np.array(PLACES), TX_M, CROSS_M, 0.03, WALL, dimension=dimension)
        for dimension in (3, 2)
    )
    assert np.all(in_the_plane < 0.9 * in_space)


def test_a_track_above_a_person_is_hers_in_the_plane_alone() -> None:
    above = rows(TRACK_DTYPE, np.arange(31), (0.0, 0.3, 1.2), id=1, state=1)
    assert evaluate_tracks(above, TIME_S, [climber()]).rmse_m == pytest.approx(0.3, rel=1e-5)
    assert np.isnan(evaluate_tracks(above, TIME_S, [climber()], dimension=3).rmse_m)
    near = rows(TRACK_DTYPE, np.arange(31), (0.0, 0.3, 0.4), id=1, state=1)
    scores = evaluate_tracks(near, TIME_S, [climber()], dimension=3, bound_m=0.25)
    assert scores.rmse_m == pytest.approx(0.5, rel=1e-5)
    assert scores.bound_ratio == pytest.approx(2.0, rel=1e-5)


def test_a_person_has_the_nearest_point_of_a_frame_within_a_metre() -> None:
    points = np.concatenate(
        [
            rows(POINT_DTYPE, np.arange(5, 20), (0.3, 0.0, 0.4)),
            rows(POINT_DTYPE, np.arange(15, 20), (0.0, -0.2, 0.0)),  # nearer
            rows(POINT_DTYPE, np.arange(15, 31), (0.0, 0.0, 1.1)),  # too far
        ]
    )
    at_m = nearest_points_m(points, FRAMES, TIME_S, [climber()])
    offset_m = at_m[:, 0] - climber().position_m[FRAMES]
    assert_allclose(offset_m[:5], np.tile([0.3, 0.0, 0.4], (5, 1)), atol=1e-6)
    assert_allclose(offset_m[5:10], np.tile([0.0, -0.2, 0.0], (5, 1)), atol=1e-6)
    assert np.all(np.isnan(offset_m[10:]))
    expected_m = np.sqrt((5 * 0.5**2 + 5 * 0.2**2) / 10)
    assert rms_m(at_m, FRAMES, TIME_S, [climber()]) == pytest.approx(expected_m, rel=1e-5)
    assert np.isnan(rms_m(at_m[10:], FRAMES[10:], TIME_S, [climber()]))


def test_nobody_there_has_no_point() -> None:
    late = PersonTruth(id="1", time_s=TIME_S[20:], position_m=climber().position_m[20:], height_m=1.8)
    points = rows(POINT_DTYPE, np.arange(31), (0.0, 0.0, 0.0))
    at_m = nearest_points_m(points, FRAMES, TIME_S, [late])
    assert np.all(np.isnan(at_m[:10]))
    assert np.all(np.isfinite(at_m[10:]))
    assert cuboid_fraction(at_m, FRAMES, TIME_S, [late]) == 1.0


def test_tracks_of_matches_are_where_the_matched_track_is() -> None:
    tracks = np.concatenate(
        [
            rows(TRACK_DTYPE, np.arange(12, 31), (2.0, 0.0, 0.0), id=3, state=1),  # of nobody
            rows(TRACK_DTYPE, np.arange(0, 20), (0.1, 0.0, 0.0), id=7, state=1),
            rows(TRACK_DTYPE, np.arange(25, 31), (0.0, 0.0, -0.5), id=9, state=2),
        ]
    )
    matches = match_tracks(tracks, TIME_S, [climber()], dimension=3)
    offset_m = tracks_of_matches_m(tracks, matches)[:, 0] - climber().position_m[FRAMES]
    assert_allclose(offset_m[:10], np.tile([0.1, 0.0, 0.0], (10, 1)), atol=1e-6)
    assert np.all(np.isnan(offset_m[10:15]))
    assert_allclose(offset_m[15:], np.tile([0.0, 0.0, -0.5], (6, 1)), atol=1e-6)


@pytest.mark.parametrize(
    ("offset_m", "inside"),
    [
        ((0.49, 0.0, 0.0), True),
        ((0.51, 0.0, 0.0), False),
        ((0.0, -0.49, 0.0), True),
        ((0.0, 0.0, -1.21), True),  # at the soles: the axis of the torso is 1.224 m above them
        ((0.0, 0.0, -1.23), False),
        ((0.0, 0.0, 0.57), True),
        ((0.0, 0.0, 0.58), False),
    ],
)
def test_the_cuboid_is_a_metre_wide_and_stands_on_the_ground(
    offset_m: tuple[float, float, float], inside: bool
) -> None:
    at_m = (climber().position_m[FRAMES] + offset_m)[:, np.newaxis]
    assert cuboid_fraction(at_m, FRAMES, TIME_S, [climber()]) == float(inside)


def test_a_frame_without_a_position_is_outside_of_the_cuboid() -> None:
    at_m = climber().position_m[FRAMES][:, np.newaxis].copy()
    at_m[:7] = np.nan
    assert cuboid_fraction(at_m, FRAMES, TIME_S, [climber()]) == pytest.approx(14 / 21)
    assert np.isnan(cuboid_fraction(at_m[:, :0], FRAMES, TIME_S, []))


def test_a_ghost_may_be_one_by_its_height_alone() -> None:
    points = rows(POINT_DTYPE, np.arange(31), (0.0, 0.0, 1.5))
    assert ghosts_per_frame(points, FRAMES, TIME_S, [climber()], dimension=3) == 1.0
    assert ghosts_per_frame(points, FRAMES, TIME_S, [climber()]) == 0.0
