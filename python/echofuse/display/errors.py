"""The errors that are drawn: the same frames, matches and distances as those of the metrics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from echofuse.display import setting
from echofuse.display.tracks import CONFIRMED, shown

if TYPE_CHECKING:
    from echofuse.result import RunResult


@dataclass(frozen=True, kw_only=True)
class Errors:
    """The errors of one tracker."""

    over_time_m: NDArray[np.float64]  # (n_frames, n_lines) a line a person or track, NaN without
    counted_m: NDArray[np.float64]  # (n,) of the distribution, infinite for a person without a track


def localisation_errors(result: RunResult, tracks: NDArray[np.void]) -> Errors | None:
    """Return the errors of tracks against the people, else across the marked path, else None."""
    if result.recording.truth:
        return _against_people(result, tracks)
    path_m = setting.truth_path_m(result.site)
    return None if path_m is None else _across_path(result, tracks, path_m)


def people_present(result: RunResult) -> NDArray[np.int64] | None:
    """Return how many people were there (n_frames,), None when nobody knows."""
    from echofuse.evaluation.tracking import true_positions

    if not result.recording.truth:
        return None
    _, present = true_positions(result.recording.truth, setting.frame_time_s(result))
    return np.asarray(present.sum(axis=1), dtype=np.int64)


def people_counted(result: RunResult, tracks: NDArray[np.void]) -> NDArray[np.int64]:
    """Return how many tracks were confirmed or silent in each frame (n_frames,)."""
    n_frames = result.frame_time_us.size
    return np.bincount(shown(tracks)["frame"], minlength=n_frames)[:n_frames].astype(np.int64)


def walking_frames(result: RunResult) -> tuple[int, int]:
    """Return the first and the last frame in which the person of a marked path walked."""
    last = result.frame_time_us.size - 1
    truth = result.site.truth
    if truth is None or truth.walking_scans is None:
        return 0, last
    return truth.walking_scans[0], min(truth.walking_scans[1], last)


def _against_people(result: RunResult, tracks: NDArray[np.void]) -> Errors:
    from echofuse.evaluation.tracking import match_tracks
    from echofuse.metrics import dimension_of, settle_s

    matches = match_tracks(
        tracks,
        setting.frame_time_s(result),
        result.recording.truth,
        settle_s=settle_s(result.site.pipeline),
        dimension=dimension_of(result.site),
    )
    over_time_m = np.full((result.frame_time_us.size, len(result.recording.truth)), np.nan)
    over_time_m[matches.frames] = np.where(np.isfinite(matches.error_m), matches.error_m, np.nan)
    return Errors(over_time_m=over_time_m, counted_m=matches.error_m[matches.present])


def _across_path(result: RunResult, tracks: NDArray[np.void], path_m: NDArray[np.float64]) -> Errors:
    from echofuse.evaluation.path import distance_to_path_m

    confirmed = tracks[tracks["state"] == CONFIRMED]
    across_m = distance_to_path_m(np.column_stack([confirmed["x_m"], confirmed["y_m"]]), path_m)
    ids, line = np.unique(confirmed["id"], return_inverse=True)
    over_time_m = np.full((result.frame_time_us.size, ids.size), np.nan)
    over_time_m[confirmed["frame"], line] = across_m
    first, last = walking_frames(result)
    walking = (confirmed["frame"] >= first) & (confirmed["frame"] <= last)
    return Errors(over_time_m=over_time_m, counted_m=across_m[walking])
