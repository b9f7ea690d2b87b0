"""How well tracks keep to a path that was walked at unknown times: the distance across it."""

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echofuse.evaluation.tracking import CONFIRMED, SILENT, error_quantile_m

__all__ = ["PathMetrics", "distance_to_path_m", "evaluate_path"]


@dataclass(frozen=True, kw_only=True)
class PathMetrics:
    """Flat, names carry units; NaN where nothing could be measured. Frames count from 0."""

    across_p50_m: float  # distance across the path, over all confirmed tracks of the walking frames
    across_p90_m: float
    confirmed_fraction: float  # of the walking frames with a confirmed track
    second_track_fraction: float  # of the walking frames with more than one confirmed track
    standing_confirmed_fraction: float  # of the frames after the walk with a confirmed track
    standing_silent_fraction: float  # of the frames after the walk with a silent track and no confirmed one
    standing_quiet_fraction: float  # of the frames after the walk with no confirmed track
    standing_wander_m: float  # how far from the end of the walk any later track got, silent ones included

    def as_dict(self) -> dict[str, float]:
        """Return all metrics by name."""
        return {name: float(value) for name, value in asdict(self).items()}


def evaluate_path(
    tracks: NDArray[np.void], n_frames: int, path_m: ArrayLike, *, walking: tuple[int, int]
) -> PathMetrics:
    """Return the metrics of tracks (n,) [recording.TRACK_DTYPE] against a polyline path_m (n_vertices, 2).

    walking: first and last frame of the walk; in the frames after it the person stands still where the
    confirmed track was last (or, if there was none, at the end of the path).
    """
    first, last = walking
    confirmed = tracks[tracks["state"] == CONFIRMED]
    silent = tracks[tracks["state"] == SILENT]
    on_walk = confirmed[(confirmed["frame"] >= first) & (confirmed["frame"] <= last)]
    across_m = distance_to_path_m(_points(on_walk), path_m)
    per_frame = np.bincount(confirmed["frame"], minlength=n_frames)[:n_frames]
    silent_per_frame = np.bincount(silent["frame"], minlength=n_frames)[:n_frames]
    walk, standing = per_frame[first : last + 1], per_frame[last + 1 :]
    standing_silent = silent_per_frame[last + 1 :]
    return PathMetrics(
        across_p50_m=error_quantile_m(across_m, 0.5),
        across_p90_m=error_quantile_m(across_m, 0.9),
        confirmed_fraction=_mean(walk > 0),
        second_track_fraction=_mean(walk > 1),
        standing_confirmed_fraction=_mean(standing > 0),
        standing_silent_fraction=_mean((standing == 0) & (standing_silent > 0)),
        standing_quiet_fraction=_mean(standing == 0),
        standing_wander_m=_wander_m(np.concatenate([confirmed, silent]), on_walk, last, path_m),
    )


def distance_to_path_m(points_m: ArrayLike, path_m: ArrayLike) -> NDArray[np.float64]:
    """Return the distance (n,) [m] of points (n, 2) to the nearest point of a polyline (n_vertices, 2)."""
    points = np.asarray(points_m, np.float64).reshape(-1, 1, 2)
    vertices = np.asarray(path_m, np.float64)
    start, along = vertices[:-1], np.diff(vertices, axis=0)
    length2 = np.sum(along**2, axis=1)
    offset = points - start  # (n, n_segments, 2)
    fraction = np.sum(offset * along, axis=-1) / np.where(length2 > 0.0, length2, 1.0)
    nearest = start + np.clip(fraction, 0.0, 1.0)[..., np.newaxis] * along
    return np.asarray(np.min(np.linalg.norm(points - nearest, axis=-1), axis=1))


def _wander_m(alive: NDArray[np.void], on_walk: NDArray[np.void], last: int, path_m: ArrayLike) -> float:
    later = _points(alive[alive["frame"] > last])
    if len(later) == 0:
        return 0.0
    if on_walk.size:
        newest = on_walk[on_walk["frame"] == on_walk["frame"].max()]
        end = _points(newest)[np.argmin(newest["id"])]  # the oldest track, should there be several
    else:
        end = np.asarray(path_m, np.float64)[-1]
    return float(np.max(np.linalg.norm(later - end, axis=1)))


def _points(tracks: NDArray[np.void]) -> NDArray[np.float64]:
    return np.column_stack([tracks["x_m"], tracks["y_m"]]).astype(np.float64)


def _mean(hits: NDArray[np.bool_]) -> float:
    return float(np.mean(hits)) if hits.size else np.nan
