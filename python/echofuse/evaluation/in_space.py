"""Points and tracks against people in space, and against the Taylor-series paper's region of a body.

A person's point is the nearest of a frame, if it is not farther than `POINT_MATCH_M`; her track is the
matched one (`tracking.match_tracks`). A frame without either counts as outside of the region.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from echofuse.evaluation.tracking import Matches, places_m, true_positions
from echofuse.recording.model import PersonTruth
from echofuse.simulation.stairs import BODY_SIZE_M, body_cuboid

__all__ = ["POINT_MATCH_M", "cuboid_fraction", "nearest_points_m", "rms_m", "tracks_of_matches_m"]

POINT_MATCH_M = 1.0  # as the tracks' gate

Array = NDArray[np.float64]


def nearest_points_m(
    points: NDArray[np.void], frames: NDArray[np.intp], frame_time_s: Array, truth: Sequence[PersonTruth]
) -> Array:
    """Return each person's point (n_frames, n_people, 3) [m], NaN where there is none or the person is away.

    points: (n,) [result.POINT_DTYPE]; frames: (n_frames,) that count; frame_time_s: of all frames.
    """
    positions, present = true_positions(truth, frame_time_s[frames])
    nearest_m = np.full(positions.shape, np.nan)
    for row, frame in enumerate(frames):
        here_m = places_m(points[points["frame"] == frame], 3)
        if not len(here_m):
            continue
        distance_m = np.linalg.norm(here_m - positions[row, :, np.newaxis], axis=-1)  # (n_people, n_points)
        near = present[row] & (np.min(distance_m, axis=1) <= POINT_MATCH_M)
        nearest_m[row, near] = here_m[np.argmin(distance_m[near], axis=1)]
    return nearest_m


def tracks_of_matches_m(tracks: NDArray[np.void], matches: Matches) -> Array:
    """Return where each person's matched track is (n_frames, n_people, 3) [m], NaN without one."""
    at_m = np.full((*matches.track_id.shape, 3), np.nan)
    matched = matches.track_id >= 0
    wanted = _keys(matches.frames[np.nonzero(matched)[0]], matches.track_id[matched])
    keys = _keys(tracks["frame"], tracks["id"])
    order = np.argsort(keys)
    at_m[matched] = places_m(tracks[order[np.searchsorted(keys[order], wanted)]], 3)
    return at_m


def rms_m(at_m: Array, frames: NDArray[np.intp], frame_time_s: Array, truth: Sequence[PersonTruth]) -> float:
    """Return how far at_m (n_frames, n_people, 3) is from the people, root mean square [m]; NaN of none."""
    positions, _ = true_positions(truth, frame_time_s[frames])
    squares = np.sum((at_m - positions) ** 2, axis=-1)
    known = np.isfinite(squares)
    return float(np.sqrt(np.mean(squares[known]))) if known.any() else float("nan")


def cuboid_fraction(
    at_m: Array, frames: NDArray[np.intp], frame_time_s: Array, truth: Sequence[PersonTruth]
) -> float:
    """Return the share of a person's frames in which at_m (n_frames, n_people, 3) lies in her cuboid."""
    positions, present = true_positions(truth, frame_time_s[frames])
    inside = np.zeros(present.shape, np.bool_)
    for index, person in enumerate(truth):
        lower_m, upper_m = body_cuboid(positions[:, index], person.height_m or BODY_SIZE_M[2])
        here_m = at_m[:, index]
        inside[:, index] = np.all((here_m >= lower_m) & (here_m <= upper_m), axis=-1)
    return float(inside[present].sum() / present.sum()) if present.any() else float("nan")


def _keys(frame: NDArray[np.integer], track_id: NDArray[np.integer]) -> NDArray[np.int64]:
    """Return one number a frame and track (n,)."""
    return np.asarray(frame, np.int64) << 32 | np.asarray(track_id, np.int64)
