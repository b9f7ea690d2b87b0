"""What is drawn is what the tables say."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from echofuse.display.errors import localisation_errors, people_counted, people_present, walking_frames
from echofuse.display.stack_figure import shrink_by_maximum
from echofuse.display.tracks import CONFIRMED, SILENT, shown, stretches
from echofuse.evaluation.tracking import error_quantile_m, evaluate_tracks
from echofuse.recording import TRACK_DTYPE
from echofuse.result import RunResult
from echofuse.site import TruePath


def rows(*frame_id_state: tuple[int, int, int]) -> np.ndarray:
    table = np.zeros(len(frame_id_state), dtype=TRACK_DTYPE)
    for row, (frame, track_id, state) in zip(table, frame_id_state, strict=True):
        row["frame"], row["id"], row["state"] = frame, track_id, state
    return table


def test_stretches_split_at_states_gaps_and_tracks() -> None:
    tracks = rows((0, 1, 1), (0, 2, 1), (1, 1, 1), (2, 1, 2), (3, 1, 2), (6, 1, 1), (7, 1, 1))
    found = [(s.track_id, s.state, s.rows["frame"].tolist()) for s in stretches(tracks)]
    assert found == [
        (1, CONFIRMED, [0, 1, 2]),  # reaches to where the next state takes over, so that the line has no hole
        (1, SILENT, [2, 3]),  # the track was lost after this: nothing is drawn to frame 6
        (1, CONFIRMED, [6, 7]),
        (2, CONFIRMED, [0]),
    ]


def test_unconfirmed_tracks_are_not_shown() -> None:
    assert shown(rows((0, 1, 0), (1, 1, 1), (2, 1, 2)))["frame"].tolist() == [1, 2]


@given(st.integers(1, 40), st.integers(1, 40), st.integers(1, 12), st.integers(1, 12), st.integers(0, 999))
def test_shrinking_loses_no_echo(
    n_rows: int, n_columns: int, max_rows: int, max_columns: int, seed: int
) -> None:
    image = np.random.default_rng(seed).uniform(0.0, 1.0, (n_rows, n_columns))
    small = shrink_by_maximum(image, max_rows=max_rows, max_columns=max_columns)
    assert small.shape == (min(n_rows, max_rows), min(n_columns, max_columns))
    assert small.max() == image.max()
    assert np.isin(small, image).all()


def test_errors_are_those_of_the_metrics(make_run: Callable[..., RunResult]) -> None:
    run = make_run(n_people=3)
    errors = localisation_errors(run, run.tracks)
    metrics = evaluate_tracks(run.tracks, run.frame_time_us * 1e-6, run.recording.truth)
    assert errors is not None
    assert errors.over_time_m.shape == (61, 3)
    assert error_quantile_m(errors.counted_m, 0.8) == metrics.p80_m
    np.testing.assert_allclose(np.sqrt(np.nanmean(errors.over_time_m**2)), metrics.rmse_m)


def test_marked_path_counts_only_the_walk(make_run: Callable[..., RunResult]) -> None:
    run = make_run()
    path = TruePath(path_m=((10.7, 3.4), (1.5, 2.0)), walking_scans=(10, 40))
    run = replace(run, site=replace(run.site, truth=path), recording=replace(run.recording, truth=()))
    errors = localisation_errors(run, run.tracks)
    confirmed = run.tracks[run.tracks["state"] == CONFIRMED]
    walking = (confirmed["frame"] >= 10) & (confirmed["frame"] <= 40)
    assert walking_frames(run) == (10, 40)
    assert errors is not None
    assert errors.counted_m.size == walking.sum()
    along = np.array([-9.2, -1.4]) / np.hypot(9.2, 1.4)
    offset = np.column_stack([confirmed["x_m"] - 10.7, confirmed["y_m"] - 3.4])
    across = np.abs(offset[:, 0] * along[1] - offset[:, 1] * along[0])
    np.testing.assert_allclose(np.sort(errors.counted_m), np.sort(across[walking]), rtol=1e-4, atol=1e-6)


def test_numbers_of_people(make_run: Callable[..., RunResult]) -> None:
    run = make_run(n_people=2)
    present, counted = people_present(run), people_counted(run, run.tracks)
    assert present is not None
    assert present.tolist() == [2] * 61
    assert counted[0] == 0
    assert counted[-1] == 2
    assert people_present(replace(run, recording=replace(run.recording, truth=()))) is None
