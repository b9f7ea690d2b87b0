"""The metrics of a run, from its tables and whatever truth its recording or its site holds."""

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.evaluation.behind_wall import (
    close_in_path,
    false_track_ids,
    ghosts_per_frame,
    path_behind_wall_m,
    position_error_bound_behind_wall_m,
    tracked_fractions,
)
from echofuse.evaluation.in_space import cuboid_fraction, nearest_points_m, rms_m, tracks_of_matches_m
from echofuse.evaluation.limits import position_error_bound_m
from echofuse.evaluation.path import evaluate_path
from echofuse.evaluation.tracking import CONFIRMED, Matches, evaluate_tracks, match_tracks, true_positions
from echofuse.recording import NodeRecording
from echofuse.result import RunResult
from echofuse.simulation.wall import Wall
from echofuse.site import PIPELINES, Site

PATH_MATCH_M = 0.6  # a detection this near a person's path is the person's
#: Of a metric of another way, by `baselines.WAYS`; what is not here is its own.
WAY_PREFIX = {"assignment": "paired"}
SETTLE_S = 1.0  # of a simulated run; tracks need some frames to begin
SETTLE_BEHIND_WALL_S = 2.0  # 13 responses of 0.074 s learn time zero and background; then tracks begin


def settle_s(pipeline: str) -> float:
    """Return how long after the first frame a run of a pipeline is evaluated from [s]."""
    return SETTLE_BEHIND_WALL_S if PIPELINES[pipeline].behind_wall else SETTLE_S


def dimension_of(site: Site) -> int:
    """Return 3 where a site's pipeline tells positions in space, 2 where it tells them in the plane."""
    return PIPELINES[site.pipeline].dimension


def measure(result: RunResult) -> None:
    """Fill `result.metrics` and `result.baseline_metrics`; without positions, with what paths alone tell."""
    truth, site = result.recording.truth, result.site
    if result.why_no_positions is not None:
        if truth:
            result.metrics["path_error_std_m"] = path_error_std_m(result)
        return
    if truth or site.truth is None:
        frame_time_s = result.frame_time_us.astype(np.float64) * 1e-6
        sigma_m = path_error_std_m(result)
        bound_m = _bounds_m(result, frame_time_s, sigma_m)
        after_s, dimension = settle_s(site.pipeline), dimension_of(site)
        for tracks, metrics in _both(result):
            scores = evaluate_tracks(
                tracks, frame_time_s, truth, bound_m=bound_m, settle_s=after_s, dimension=dimension
            )
            metrics.update(scores.as_dict() if truth else _without_truth(scores.as_dict()))
            if PIPELINES[site.pipeline].behind_wall:
                metrics.update(_behind_wall(result, tracks, frame_time_s))
            if truth and dimension == 3:
                metrics["cuboid_fraction"] = _track_scores(result, tracks, frame_time_s)["cuboid_fraction"]
        if truth:
            result.metrics["path_error_std_m"] = sigma_m
            result.metrics.update(_ghosts(result, frame_time_s))
        if truth and dimension == 3:
            result.metrics.update(_ways_in_space(result, frame_time_s, bound_m))
    else:
        path = site.truth
        n_frames = len(result.frame_time_us)
        walking = path.walking_scans or (0, n_frames - 1)
        for tracks, metrics in _both(result):
            metrics.update(evaluate_path(tracks, n_frames, path.path_m, walking=walking).as_dict())


def path_error_std_m(result: RunResult) -> float:
    """Return the robust deviation of the people's measured paths from the true ones, bias removed [m].

    NaN without truth. It stands for what a node's range is worth: the extended, swinging body, not the noise,
    limits it, so the position error bound is stated for this figure.
    """
    people, nodes = result.recording.truth, result.recording.nodes
    if not people or not len(result.detections):
        return float("nan")
    errors = []
    for index, node in enumerate(nodes):
        rows = result.detections[result.detections["node"] == index]
        positions, present = true_positions(people, rows["time_us"] * 1e-6)
        path_m = true_path_m(node, positions, wall_of(result.site))
        error = rows["delay_s"][:, np.newaxis] * SPEED_OF_LIGHT_MPS - path_m
        error[~present] = np.inf
        nearest = error[np.arange(len(rows)), np.argmin(np.abs(error), axis=1)]
        errors.append(nearest[np.abs(nearest) < PATH_MATCH_M])
    matched = np.concatenate(errors)
    spread = np.percentile(matched, [15.87, 84.13]) if matched.size else (np.nan, np.nan)
    return float(spread[1] - spread[0]) / 2.0


def true_path_m(
    node: NodeRecording, positions_m: NDArray[np.float64], wall: Wall | None = None
) -> NDArray[np.float64]:
    """Return the paths Tx -> person -> Rx (n, n_people) of positions_m (n, n_people, 3) [m].

    wall: what the rays are refracted by, with its delay, if there is one between.
    """
    if wall is not None:
        return path_behind_wall_m(positions_m, node.tx_position_m, node.rx_position_m, wall)
    legs = (np.linalg.norm(positions_m - end, axis=-1) for end in (node.tx_position_m, node.rx_position_m))
    return np.asarray(sum(legs))


def wall_of(site: Site) -> Wall | None:
    """Return the wall between a site's antennas and its people, None when there is none."""
    if site.wall is None or not PIPELINES[site.pipeline].behind_wall:
        return None
    return Wall(thickness_m=site.wall.thickness_m, permittivity=site.wall.relative_permittivity)


def _bounds_m(
    result: RunResult, frame_time_s: NDArray[np.float64], sigma_m: float
) -> NDArray[np.float64] | None:
    """Return the bound of one frame's position error where each person was, (n_frames, n_people) [m]."""
    if not np.isfinite(sigma_m) or sigma_m <= 0.0:
        return None
    people, nodes, wall = result.recording.truth, result.site.nodes, wall_of(result.site)
    positions, present = true_positions(people, frame_time_s)
    place_m = np.nan_to_num(positions)
    tx_m, rx_m = (
        np.array([getattr(node, end) for node in nodes]) for end in ("tx_position_m", "rx_position_m")
    )
    if wall is None:
        bound_m = position_error_bound_m(place_m[..., :2], tx_m[:, :2], rx_m[:, :2], sigma_m)
    else:
        bound_m = position_error_bound_behind_wall_m(
            place_m, tx_m, rx_m, sigma_m, wall, dimension=dimension_of(result.site)
        )
    return np.where(present, bound_m, np.nan)


def _behind_wall(
    result: RunResult, tracks: NDArray[np.void], frame_time_s: NDArray[np.float64]
) -> dict[str, float]:
    """Return what is asked of a through-wall pipeline beside the metrics of tracks (docs/through_wall.md)."""
    people = result.recording.truth
    matches = _matches(result, tracks, frame_time_s)
    duration_s = float(np.ptp(frame_time_s[matches.frames])) if matches.frames.size else 0.0
    confirmed = tracks[(tracks["state"] == CONFIRMED) & np.isin(tracks["frame"], matches.frames)]
    found = {"confirmed_tracks": float(len(np.unique(confirmed["id"])))}
    if not people:
        return found
    positions, _ = true_positions(people, frame_time_s[matches.frames])
    known = [node for node in result.recording.nodes if node.node_id in {p.id for p in result.site.nodes}]
    paths_m = [true_path_m(node, positions, wall_of(result.site)) for node in known]
    close = close_in_path(np.mean(paths_m, axis=0), matches.present)
    shares, crossing = tracked_fractions(matches), tracked_fractions(matches, close)
    known_shares = np.isfinite(shares)
    false_tracks = len(false_track_ids(tracks, matches))
    return found | {
        "worst_tracked_fraction": _least(shares),
        "mean_tracked_fraction": float(np.mean(shares[known_shares])) if known_shares.any() else np.nan,
        "crossing_tracked_fraction": _least(crossing),
        "crossing_fraction": float(np.mean(close[matches.present])) if matches.present.any() else np.nan,
        "false_tracks_per_100_s": 100.0 * false_tracks / duration_s if duration_s > 0.0 else float("nan"),
    }


def _ghosts(result: RunResult, frame_time_s: NDArray[np.float64]) -> dict[str, float]:
    """Return the ghosts a response of the run's own points, of pairing alone, and of all pairs."""
    if not PIPELINES[result.site.pipeline].behind_wall:
        return {}
    frames = _settled_frames(result, frame_time_s)
    tables = {"": result.points} | {
        f"{WAY_PREFIX.get(way, way)}_": rows for way, rows in result.compared_points.items()
    }
    dimension = dimension_of(result.site)
    return {
        f"{prefix}ghosts_per_response": ghosts_per_frame(
            rows, frames, frame_time_s, result.recording.truth, dimension=dimension
        )
        for prefix, rows in tables.items()
    }


def _ways_in_space(
    result: RunResult, frame_time_s: NDArray[np.float64], bound_m: NDArray[np.float64] | None
) -> dict[str, float]:
    """Return what each other way located and tracked, and the bound, in space (docs/stairs.md)."""
    people, frames = result.recording.truth, _settled_frames(result, frame_time_s)
    found = {}
    if bound_m is not None:
        squares = bound_m[frames] ** 2
        known = np.isfinite(squares)
        found["position_error_bound_m"] = float(np.sqrt(np.mean(squares[known]))) if known.any() else np.nan
    for way, points in result.compared_points.items():
        at_m = nearest_points_m(points, frames, frame_time_s, people)
        present = true_positions(people, frame_time_s[frames])[1]
        located = np.isfinite(at_m[..., 0])[present]
        scores = {
            "rmse_m": rms_m(at_m, frames, frame_time_s, people),
            "located_fraction": float(np.mean(located)) if located.size else float("nan"),
            "cuboid_fraction": cuboid_fraction(at_m, frames, frame_time_s, people),
        }
        found.update({f"{way}_points_{name}": value for name, value in scores.items()})
    for way, tracks in result.compared_tracks.items():
        scores = _track_scores(result, tracks, frame_time_s)
        found.update({f"{way}_track_{name}": value for name, value in scores.items()})
    return found


def _track_scores(
    result: RunResult, tracks: NDArray[np.void], frame_time_s: NDArray[np.float64]
) -> dict[str, float]:
    people, matches = result.recording.truth, _matches(result, tracks, frame_time_s)
    at_m = tracks_of_matches_m(tracks, matches)
    tracked = np.isfinite(matches.error_m)[matches.present]
    return {
        "rmse_m": rms_m(at_m, matches.frames, frame_time_s, people),
        "tracked_fraction": float(np.mean(tracked)) if tracked.size else float("nan"),
        "cuboid_fraction": cuboid_fraction(at_m, matches.frames, frame_time_s, people),
    }


def _matches(result: RunResult, tracks: NDArray[np.void], frame_time_s: NDArray[np.float64]) -> Matches:
    return match_tracks(
        tracks,
        frame_time_s,
        result.recording.truth,
        settle_s=settle_s(result.site.pipeline),
        dimension=dimension_of(result.site),
    )


def _settled_frames(result: RunResult, frame_time_s: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the frames that are evaluated."""
    if not frame_time_s.size:
        return np.zeros(0, np.intp)
    return np.flatnonzero(frame_time_s >= frame_time_s[0] + settle_s(result.site.pipeline))


def _least(shares: NDArray[np.float64]) -> float:
    """Return the least share of those that are known."""
    return float(np.min(shares[np.isfinite(shares)], initial=np.inf)) if np.isfinite(shares).any() else np.nan


def _both(result: RunResult) -> list[tuple[NDArray[np.void], dict[str, float]]]:
    return [(result.tracks, result.metrics), (result.baseline_tracks, result.baseline_metrics)]


def _without_truth(scores: dict[str, float]) -> dict[str, float]:
    """Keep what means something when it is not known who was there."""
    return {"frames_evaluated": scores["frames_evaluated"]}
