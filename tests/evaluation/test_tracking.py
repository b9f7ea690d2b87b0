"""Metrics of tracks, by hand."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from echofuse.evaluation.path import distance_to_path_m, evaluate_path
from echofuse.evaluation.tracking import empirical_cdf, error_quantile_m, evaluate_tracks
from echofuse.recording import TRACK_DTYPE, PersonTruth

UNCONFIRMED, CONFIRMED, SILENT = 0, 1, 2
TIME_S = 0.1 * np.arange(31)  # frames 10 to 30 are evaluated: 21 of them


def track(frames: object, x_m: object, y_m: object, *, id: int = 1, state: object = CONFIRMED) -> np.ndarray:
    rows = np.zeros(np.size(frames), TRACK_DTYPE)
    rows["frame"], rows["x_m"], rows["y_m"], rows["id"], rows["state"] = frames, x_m, y_m, id, state
    return rows


def person(id: str = "1", y_m: float = 0.0, first: int = 0, last: int = 30) -> PersonTruth:
    time_s = TIME_S[first : last + 1]
    position = np.column_stack([time_s, np.full(time_s.size, y_m), np.ones(time_s.size)])
    return PersonTruth(id=id, time_s=time_s, position_m=position)


ALL = np.arange(31)


def test_a_perfect_track() -> None:
    metrics = evaluate_tracks(track(ALL, TIME_S, 0.0), TIME_S, [person()])
    assert metrics.frames_evaluated == 21
    assert metrics.rmse_m == pytest.approx(0.0, abs=1e-6)
    assert metrics.tracked_fraction == metrics.confirmed_fraction == metrics.one_track_fraction == 1.0
    assert metrics.count_right_fraction == metrics.confirmed_count_right_fraction == 1.0
    assert metrics.false_track_fraction == 0.0
    assert np.isnan(metrics.bound_ratio)


def test_errors_and_their_bound() -> None:
    errors = np.where(ALL % 2 == 0, 0.1, 0.3)  # 11 and 10 of the evaluated frames
    metrics = evaluate_tracks(track(ALL, TIME_S, errors), TIME_S, [person()], bound_m=0.05)
    assert metrics.rmse_m == pytest.approx(np.sqrt((11 * 0.01 + 10 * 0.09) / 21), rel=1e-5)
    assert metrics.p50_m == pytest.approx(0.1, rel=1e-5)
    assert metrics.p80_m == pytest.approx(0.3, rel=1e-5)
    assert metrics.bound_ratio == pytest.approx(metrics.rmse_m / 0.05)
    per_frame = np.where(ALL >= 10, 0.05, 77.0)[
        :, np.newaxis
    ]  # the bound of frames not evaluated does not matter
    assert evaluate_tracks(
        track(ALL, TIME_S, errors), TIME_S, [person()], bound_m=per_frame
    ).bound_ratio == pytest.approx(metrics.bound_ratio)


def test_a_missing_track_counts_against_the_quantiles() -> None:
    frames = ALL[ALL < 24]  # 14 of 21: two thirds
    metrics = evaluate_tracks(track(frames, TIME_S[frames], 0.1), TIME_S, [person()])
    assert metrics.tracked_fraction == pytest.approx(14 / 21)
    assert metrics.count_right_fraction == pytest.approx(14 / 21)
    assert metrics.rmse_m == pytest.approx(0.1, rel=1e-5)
    assert metrics.p50_m == pytest.approx(0.1, rel=1e-5)
    assert metrics.p80_m == np.inf


def test_states() -> None:
    """Silent tracks are alive but not confirmed; unconfirmed ones do not count at all."""
    state = np.full(31, CONFIRMED)
    state[10:13], state[13:15] = SILENT, UNCONFIRMED
    metrics = evaluate_tracks(track(ALL, TIME_S, 0.0, state=state), TIME_S, [person()])
    assert metrics.tracked_fraction == pytest.approx(19 / 21)
    assert metrics.confirmed_fraction == metrics.one_track_fraction == pytest.approx(16 / 21)
    assert metrics.count_right_fraction == pytest.approx(19 / 21)
    assert metrics.confirmed_count_right_fraction == pytest.approx(16 / 21)


def test_false_tracks() -> None:
    real = track(ALL, TIME_S, 0.0)
    ghost = track([5, 11, 12], 2.0, 3.0, id=9)  # one before the evaluation
    silent_ghost = track([15, 16], 2.0, 3.0, id=8, state=SILENT)
    metrics = evaluate_tracks(np.concatenate([ghost, silent_ghost, real]), TIME_S, [person()])
    assert metrics.false_track_fraction == pytest.approx(2 / 21)
    assert metrics.count_right_fraction == pytest.approx(17 / 21)
    assert metrics.confirmed_count_right_fraction == pytest.approx(19 / 21)
    assert metrics.one_track_fraction == 1.0


def test_a_track_beyond_the_gate_is_false() -> None:
    metrics = evaluate_tracks(track(ALL, TIME_S, 1.01), TIME_S, [person()])
    assert metrics.tracked_fraction == 0.0
    assert metrics.false_track_fraction == 1.0
    assert metrics.count_right_fraction == 1.0
    assert np.isnan(metrics.rmse_m)
    assert evaluate_tracks(track(ALL, TIME_S, 1.01), TIME_S, [person()], gate_m=1.1).tracked_fraction == 1.0


def test_a_change_of_identity_breaks_the_one_track() -> None:
    ids = np.where(ALL < 17, 1, 2)  # 7 frames and 14
    tracks = track(ALL, TIME_S, 0.0)
    tracks["id"] = ids
    metrics = evaluate_tracks(tracks, TIME_S, [person()])
    assert metrics.confirmed_fraction == 1.0
    assert metrics.one_track_fraction == pytest.approx(14 / 21)


def test_several_people_are_assigned_at_the_least_cost() -> None:
    """Nearest first would pair the first track with the wrong person and lose the other one."""
    people = [person("1", 0.0), person("2", 1.0)]
    tracks = np.concatenate([track(ALL, TIME_S, 0.45, id=1), track(ALL, TIME_S, -0.5, id=2)])
    metrics = evaluate_tracks(tracks, TIME_S, people)
    assert metrics.tracked_fraction == metrics.one_track_fraction == 1.0
    assert metrics.rmse_m == pytest.approx(np.sqrt((0.55**2 + 0.5**2) / 2), rel=1e-5)


def test_people_come_and_go() -> None:
    people = [person("1"), person("2", 3.0, first=20)]  # there in 11 of the 21 frames
    metrics = evaluate_tracks(track(ALL, TIME_S, 0.0), TIME_S, people)
    assert metrics.tracked_fraction == pytest.approx(21 / 32)
    assert metrics.count_right_fraction == pytest.approx(10 / 21)
    assert metrics.one_track_fraction == 0.0  # the worst person's


def test_nobody_there() -> None:
    nothing = track([], [], [])
    metrics = evaluate_tracks(nothing, TIME_S, [])
    assert metrics.count_right_fraction == 1.0
    assert metrics.false_track_fraction == 0.0
    assert np.isnan(metrics.tracked_fraction)
    assert evaluate_tracks(track(ALL, 0.0, 0.0), TIME_S, []).false_track_fraction == 1.0
    assert evaluate_tracks(nothing, [], []).frames_evaluated == 0
    assert evaluate_tracks(nothing, TIME_S, [person()]).tracked_fraction == 0.0
    assert set(metrics.as_dict()) >= {"rmse_m", "p50_m", "p80_m", "tracked_fraction", "count_right_fraction"}


@given(st.lists(st.floats(0.0, 5.0) | st.just(np.inf), min_size=1, max_size=40))
def test_cdf_and_quantiles_agree(errors: list[float]) -> None:
    values, fractions = empirical_cdf(errors)
    assert_array_equal(values, np.sort([error for error in errors if np.isfinite(error)]))
    for value, fraction in zip(values, fractions, strict=True):
        assert error_quantile_m(errors, fraction) == value
        assert np.mean(np.asarray(errors) <= value) >= fraction - 1e-12
    assert error_quantile_m(errors, 1.0) == max(errors)


TRIANGLE = np.array([[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [1.0, -1.0]])


def test_distance_to_a_path() -> None:
    points = [[1.2, 0.0], [0.9, -0.3], [0.0, 1.25], [0.1, 0.1], [1.3, 1.4], [-1.0, 1.0], [1.0, -3.0]]
    expected = [0.2, 0.1, 0.25, 0.1 * np.sqrt(2), 0.5, 0.0, 2.0]
    assert_allclose(distance_to_path_m(points, TRIANGLE), expected, atol=1e-12)
    open_path = TRIANGLE[:3]
    assert distance_to_path_m([[0.0, 0.0]], open_path) == pytest.approx([1.0])  # not closed by itself
    assert distance_to_path_m(np.zeros((0, 2)), TRIANGLE).size == 0


@given(
    st.tuples(st.floats(-4, 4), st.floats(-4, 4)),
    st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3)), min_size=2, max_size=6),
)
def test_distance_to_a_path_against_its_points(
    point: tuple[float, float], path: list[tuple[float, float]]
) -> None:
    vertices = np.array(path)
    fractions = np.linspace(0.0, 1.0, 801)[:, np.newaxis]
    dense = np.concatenate([start + fractions * (end - start) for start, end in pairwise(vertices)])
    nearest = np.min(np.linalg.norm(dense - point, axis=1))
    (distance,) = distance_to_path_m([point], vertices)
    assert distance <= nearest + 1e-9
    assert distance >= nearest - 0.02  # points lie at most 8.5 m / 800 apart


def test_path_metrics() -> None:
    walking = np.arange(10, 90)  # the walk is 0 to 99, then 100 to 119 standing
    across = np.where(walking < 50, 0.05, 0.15)  # 40 each
    tracks = np.concatenate(
        [
            track(walking, 1.0 + across, 0.0),
            track([40, 41, 42, 43], 1.0, 0.5, id=2),
            track(np.arange(90, 110), 1.15, 0.0, state=SILENT),
            track([118], 1.15, 0.4, id=3),
            track(np.arange(110, 114), 9.0, 9.0, id=4, state=UNCONFIRMED),
        ]
    )
    metrics = evaluate_path(tracks, 120, TRIANGLE, walking=(0, 99))
    assert metrics.across_p50_m == pytest.approx(0.05, rel=1e-5)
    assert metrics.across_p90_m == pytest.approx(0.15, rel=1e-5)
    assert metrics.confirmed_fraction == pytest.approx(0.80)
    assert metrics.second_track_fraction == pytest.approx(0.04)
    assert metrics.standing_confirmed_fraction == pytest.approx(1 / 20)
    assert metrics.standing_silent_fraction == pytest.approx(10 / 20)
    assert metrics.standing_quiet_fraction == pytest.approx(19 / 20)
    assert metrics.standing_wander_m == pytest.approx(0.4, rel=1e-5)


def test_path_metrics_without_tracks() -> None:
    metrics = evaluate_path(track([], [], []), 120, TRIANGLE, walking=(0, 99))
    assert metrics.confirmed_fraction == 0.0
    assert np.isnan(metrics.across_p50_m)
    assert metrics.standing_wander_m == 0.0
    assert metrics.standing_quiet_fraction == 1.0
