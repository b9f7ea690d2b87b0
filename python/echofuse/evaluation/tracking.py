"""How well tracks follow people whose true positions are known at all times.

Definitions. Evaluated are the frames after the first `settle_s` seconds. A person is present in the frames
within her own true times. A track is alive when it is confirmed or silent; unconfirmed ones are the tracker's
own business. In each frame alive tracks and present people are matched one to one, at the least sum of
distances, each cut off at `gate_m`; a pair farther apart than that is no match. Distances are those in the
plane of the floor, or in space where the pipeline's positions have a height.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echofuse.recording.model import PersonTruth

__all__ = [
    "CONFIRMED",
    "SILENT",
    "Matches",
    "TrackingMetrics",
    "empirical_cdf",
    "error_quantile_m",
    "evaluate_tracks",
    "match_tracks",
    "places_m",
    "true_positions",
]

CONFIRMED = 1  # link::TrackState
SILENT = 2


@dataclass(frozen=True, kw_only=True)
class TrackingMetrics:
    """Flat, names carry units; NaN where nothing could be measured."""

    rmse_m: float  # over matched pairs, each at most gate_m
    p50_m: float  # error that half of all (frame, person) pairs keep; an unmatched person's is infinite
    p80_m: float  # error that 80 % keep
    tracked_fraction: float  # of (frame, person) pairs, matched with an alive track
    confirmed_fraction: float  # of (frame, person) pairs, matched with a confirmed track
    one_track_fraction: (
        float  # of each person's frames, the most that one track id matched confirmed; worst person
    )
    count_right_fraction: float  # of frames with as many alive tracks as people
    confirmed_count_right_fraction: float  # of frames with as many confirmed tracks as people
    false_track_fraction: float  # of frames with a confirmed track that matches nobody
    bound_ratio: float  # rmse over the root mean square of the position error bound at the same pairs
    frames_evaluated: int

    def as_dict(self) -> dict[str, float]:
        """Return all metrics by name."""
        return {name: float(value) for name, value in asdict(self).items()}


@dataclass(frozen=True, kw_only=True, eq=False)
class Matches:
    """Who is who, frame by frame."""

    frames: NDArray[np.intp]  # (n_frames,) the evaluated frames
    present: NDArray[np.bool_]  # (n_frames, n_people)
    error_m: NDArray[np.float64]  # (n_frames, n_people) distance to the matched track, infinite without one
    track_id: NDArray[np.int64]  # (n_frames, n_people) -1 without a match
    confirmed: NDArray[np.bool_]  # (n_frames, n_people) whether the matched track is confirmed
    n_alive: NDArray[np.int64]  # (n_frames,) confirmed and silent tracks
    n_confirmed: NDArray[np.int64]  # (n_frames,)
    n_false: NDArray[np.int64]  # (n_frames,) confirmed tracks that match nobody


def evaluate_tracks(
    tracks: NDArray[np.void],
    frame_time_s: ArrayLike,
    truth: Sequence[PersonTruth],
    *,
    gate_m: float = 1.0,
    settle_s: float = 1.0,
    bound_m: ArrayLike | None = None,
    dimension: int = 2,
) -> TrackingMetrics:
    """Return the metrics of tracks (n,) [recording.TRACK_DTYPE] against the truth.

    frame_time_s: (n_frames,) on the clock of the truth; frame f of the tracks is its element f.
    bound_m: position error bound, a number or (n_frames, n_people), for the ratio. dimension: 2 in the plane,
    3 in space.
    """
    matches = match_tracks(tracks, frame_time_s, truth, gate_m=gate_m, settle_s=settle_s, dimension=dimension)
    present, matched = matches.present, np.isfinite(matches.error_m)
    n_pairs, n_frames = int(present.sum()), matches.frames.size
    errors = matches.error_m[present]
    rmse_m = float(np.sqrt(np.mean(matches.error_m[matched] ** 2))) if matched.any() else np.nan
    n_people = present.sum(axis=1)

    def of_frames(hits: NDArray[np.bool_]) -> float:
        return float(np.mean(hits)) if n_frames else np.nan

    def of_pairs(hits: NDArray[np.bool_]) -> float:
        return float(hits.sum() / n_pairs) if n_pairs else np.nan

    return TrackingMetrics(
        rmse_m=rmse_m,
        p50_m=error_quantile_m(errors, 0.5),
        p80_m=error_quantile_m(errors, 0.8),
        tracked_fraction=of_pairs(matched),
        confirmed_fraction=of_pairs(matches.confirmed),
        one_track_fraction=_one_track_fraction(matches),
        count_right_fraction=of_frames(matches.n_alive == n_people),
        confirmed_count_right_fraction=of_frames(matches.n_confirmed == n_people),
        false_track_fraction=of_frames(matches.n_false > 0),
        bound_ratio=rmse_m / _rms_bound_m(bound_m, np.size(frame_time_s), matches),
        frames_evaluated=n_frames,
    )


def match_tracks(
    tracks: NDArray[np.void],
    frame_time_s: ArrayLike,
    truth: Sequence[PersonTruth],
    *,
    gate_m: float = 1.0,
    settle_s: float = 1.0,
    dimension: int = 2,
) -> Matches:
    """Match alive tracks with present people in every frame after the first `settle_s`."""
    time_s = np.asarray(frame_time_s, np.float64)
    frames = np.flatnonzero(time_s >= time_s[0] + settle_s) if time_s.size else np.zeros(0, np.intp)
    positions, present = true_positions(truth, time_s[frames])
    positions = positions[..., :dimension]
    alive = tracks[(tracks["state"] == CONFIRMED) | (tracks["state"] == SILENT)]
    alive = alive[np.argsort(alive["frame"], kind="stable")]
    starts = np.searchsorted(alive["frame"], frames, side="left")
    ends = np.searchsorted(alive["frame"], frames, side="right")
    shape = present.shape
    error_m, track_id = np.full(shape, np.inf), np.full(shape, -1, np.int64)
    confirmed = np.zeros(shape, np.bool_)
    n_alive, n_confirmed, n_false = (np.zeros(frames.size, np.int64) for _ in range(3))
    for row, (start, end) in enumerate(zip(starts, ends, strict=True)):
        here = alive[start:end]
        people = np.flatnonzero(present[row])
        chosen, columns, distance = _assign(places_m(here, dimension), positions[row, people], gate_m)
        error_m[row, people[columns]] = distance
        track_id[row, people[columns]] = here["id"][chosen]
        confirmed[row, people[columns]] = here["state"][chosen] == CONFIRMED
        n_alive[row] = here.size
        n_confirmed[row] = np.sum(here["state"] == CONFIRMED)
        n_false[row] = n_confirmed[row] - np.sum(here["state"][chosen] == CONFIRMED)
    return Matches(
        frames=frames,
        present=present,
        error_m=error_m,
        track_id=track_id,
        confirmed=confirmed,
        n_alive=n_alive,
        n_confirmed=n_confirmed,
        n_false=n_false,
    )


def true_positions(
    truth: Sequence[PersonTruth], time_s: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return positions (n_times, n_people, 3) [m], interpolated, and who is there (n_times, n_people)."""
    positions = np.full((time_s.size, len(truth), 3), np.nan)
    present = np.zeros((time_s.size, len(truth)), np.bool_)
    for index, person in enumerate(truth):
        if person.time_s.size == 0:
            continue
        # Frames close a little after the scans from which they are made.
        slack_s = 1e-6 + (float(np.median(np.diff(person.time_s))) if person.time_s.size > 1 else 0.0)
        present[:, index] = (time_s >= person.time_s[0] - 1e-6) & (time_s <= person.time_s[-1] + slack_s)
        for axis in range(3):
            positions[:, index, axis] = np.interp(time_s, person.time_s, person.position_m[:, axis])
    return positions, present


def places_m(rows: NDArray[np.void], dimension: int) -> NDArray[np.float64]:
    """Return the positions (n, dimension) [m] of tracks or points (n,)."""
    return np.column_stack([rows[name] for name in ("x_m", "y_m", "z_m")[:dimension]]).astype(np.float64)


def error_quantile_m(errors_m: ArrayLike, fraction: float) -> float:
    """Return the least error that `fraction` of all errors keep; infinite when too many are infinite."""
    errors = np.sort(np.asarray(errors_m, np.float64).ravel())
    if errors.size == 0:
        return np.nan
    rank = int(np.ceil(fraction * errors.size - 1e-9))
    return float(errors[max(rank, 1) - 1])


def empirical_cdf(errors_m: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return ascending finite errors (n,) [m] and the fraction of all errors that are at most that (n,)."""
    errors = np.sort(np.asarray(errors_m, np.float64).ravel())
    finite = errors[np.isfinite(errors)]
    return finite, np.arange(1, finite.size + 1) / max(errors.size, 1)


def _assign(
    points_m: NDArray[np.float64], people_m: NDArray[np.float64], gate_m: float
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64]]:
    """Return the matched rows of points, the matched people and their distances [m]."""
    from scipy.optimize import linear_sum_assignment  # heavy; only who evaluates needs it

    distance = np.linalg.norm(points_m[:, np.newaxis] - people_m[np.newaxis], axis=-1)
    rows, columns = linear_sum_assignment(np.minimum(distance, gate_m))
    chosen = distance[rows, columns] < gate_m
    return rows[chosen], columns[chosen], distance[rows[chosen], columns[chosen]]


def _one_track_fraction(matches: Matches) -> float:
    """Return, of the person who fares worst, the share of frames with the same confirmed track."""
    fractions = []
    for person in range(matches.present.shape[1]):
        n_present = int(matches.present[:, person].sum())
        if n_present:
            ids = matches.track_id[matches.confirmed[:, person], person]
            longest = int(np.unique(ids, return_counts=True)[1].max()) if ids.size else 0
            fractions.append(longest / n_present)
    return min(fractions, default=np.nan)


def _rms_bound_m(bound_m: ArrayLike | None, n_frames: int, matches: Matches) -> float:
    if bound_m is None:
        return np.nan
    shape = (n_frames, matches.present.shape[1])
    at_pairs = np.broadcast_to(np.asarray(bound_m, np.float64), shape)[matches.frames]
    at_pairs = at_pairs[np.isfinite(matches.error_m)]
    return float(np.sqrt(np.mean(at_pairs**2))) if at_pairs.size else np.nan
