"""The metrics of a run, from its tables and whatever truth its recording or its site holds."""

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.evaluation.limits import position_error_bound_m
from echofuse.evaluation.path import evaluate_path
from echofuse.evaluation.tracking import evaluate_tracks, true_positions
from echofuse.recording import NodeRecording, PersonTruth
from echofuse.result import RunResult

PATH_MATCH_M = 0.6  # a detection this near a person's path is the person's
SETTLE_S = 1.0  # of a simulated run; tracks need some frames to begin


def measure(result: RunResult) -> None:
    """Fill `result.metrics` and `result.baseline_metrics`."""
    truth, site = result.recording.truth, result.site
    if truth or site.truth is None:
        frame_time_s = result.frame_time_us.astype(np.float64) * 1e-6
        sigma_m = path_error_std_m(result)
        bound_m = _bounds_m(result, frame_time_s, sigma_m)
        for tracks, metrics in _both(result):
            scores = evaluate_tracks(tracks, frame_time_s, truth, bound_m=bound_m, settle_s=SETTLE_S)
            metrics.update(scores.as_dict() if truth else _without_truth(scores.as_dict()))
        if truth:
            result.metrics["path_error_std_m"] = sigma_m
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
        error = rows["delay_s"][:, np.newaxis] * SPEED_OF_LIGHT_MPS - true_path_m(node, positions, people)
        error[~present] = np.inf
        nearest = error[np.arange(len(rows)), np.argmin(np.abs(error), axis=1)]
        errors.append(nearest[np.abs(nearest) < PATH_MATCH_M])
    matched = np.concatenate(errors)
    spread = np.percentile(matched, [15.87, 84.13]) if matched.size else (np.nan, np.nan)
    return float(spread[1] - spread[0]) / 2.0


def true_path_m(
    node: NodeRecording, positions_m: NDArray[np.float64], people: tuple[PersonTruth, ...]
) -> NDArray[np.float64]:
    """Return the paths Tx -> person -> Rx of positions_m (n, n_people, 2), at the people's heights [m]."""
    heights = np.array([float(np.mean(person.position_m[:, 2])) for person in people])
    points = np.dstack([positions_m, np.broadcast_to(heights, positions_m.shape[:2])])
    legs = (np.linalg.norm(points - end, axis=-1) for end in (node.tx_position_m, node.rx_position_m))
    return np.asarray(sum(legs))


def _bounds_m(
    result: RunResult, frame_time_s: NDArray[np.float64], sigma_m: float
) -> NDArray[np.float64] | None:
    """Return the bound of one frame's position error where each person was, (n_frames, n_people) [m]."""
    if not np.isfinite(sigma_m) or sigma_m <= 0.0:
        return None
    positions, present = true_positions(result.recording.truth, frame_time_s)
    tx_m = np.array([node.tx_position_m[:2] for node in result.site.nodes])
    rx_m = np.array([node.rx_position_m[:2] for node in result.site.nodes])
    bound_m = position_error_bound_m(np.nan_to_num(positions), tx_m, rx_m, sigma_m)
    return np.where(present, bound_m, np.nan)


def _both(result: RunResult) -> list[tuple[NDArray[np.void], dict[str, float]]]:
    return [(result.tracks, result.metrics), (result.baseline_tracks, result.baseline_metrics)]


def _without_truth(scores: dict[str, float]) -> dict[str, float]:
    """Keep what means something when it is not known who was there."""
    return {"frames_evaluated": scores["frames_evaluated"]}
