"""People behind a wall, as receivers before it see them: true paths, and how well these tell a position."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.evaluation.limits import covariance_bound_m2
from echofuse.evaluation.tracking import Matches, places_m, true_positions
from echofuse.recording.model import PersonTruth
from echofuse.simulation.wall import Wall, refracted

__all__ = [
    "CLOSE_PATHS_M",
    "GHOST_M",
    "close_in_path",
    "false_track_ids",
    "ghosts_per_frame",
    "path_behind_wall_m",
    "position_error_bound_behind_wall_m",
    "tracked_fractions",
]

LEAST_AIR_M = 0.01  # of a ray behind the wall
CLOSE_PATHS_M = 1.0  # two people whose mean paths differ by less cross, or stand symmetric about the antennas
GHOST_M = 1.0  # a located point farther than this from everybody is a ghost

Array = NDArray[np.float64]


def path_behind_wall_m(position_m: ArrayLike, tx_m: ArrayLike, rx_m: ArrayLike, wall: Wall) -> Array:
    """Return the paths Tx, person, Rx (...,) [m]: the speed of light times the refracted delay.

    position_m: (..., 3) behind the wall; tx_m, rx_m: (3,) before it. The wall's normal is y; where exactly it
    stands between antennas and person makes no difference.
    """
    position = np.asarray(position_m, np.float64)
    return np.asarray(sum(_leg(position, end, wall)[0] for end in (tx_m, rx_m)))


def position_error_bound_behind_wall_m(
    position_m: ArrayLike,
    tx_m: ArrayLike,
    rx_m: ArrayLike,
    path_sigma_m: float,
    wall: Wall,
    *,
    dimension: int = 2,
) -> Array:
    """Return the least root mean square error (...,) [m] of a position from the paths of n receivers.

    position_m: (..., 3); tx_m, rx_m: (n, 3). dimension: 3, or 2 for the error of x and y where the height is
    known. A ray's gradient is its direction in the air behind the wall, so the information is that of bent
    ellipsoids: the covariance of `taylor_3d` in space and of `line_locator` in the plane.
    """
    position = np.asarray(position_m, np.float64)
    gradients = [
        _leg(position, tx, wall)[1] + _leg(position, rx, wall)[1]
        for tx, rx in zip(np.asarray(tx_m), np.asarray(rx_m), strict=True)
    ]
    covariance = covariance_bound_m2(np.stack(gradients, axis=-2)[..., :dimension] / path_sigma_m)
    return np.asarray(np.sqrt(np.trace(covariance, axis1=-2, axis2=-1)))


def close_in_path(path_m: Array, present: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return who crosses another one, or stands symmetric to another, (n_frames, n_people).

    path_m: (n_frames, n_people) mean over the receivers; present: the same shape. Both people's paths differ
    by less than CLOSE_PATHS_M then, and one receiver sees them as one.
    """
    apart = np.abs(path_m[:, :, np.newaxis] - path_m[:, np.newaxis, :])
    both = present[:, :, np.newaxis] & present[:, np.newaxis, :]
    both &= ~np.eye(path_m.shape[1], dtype=bool)
    return np.asarray(np.any((apart < CLOSE_PATHS_M) & both, axis=2))


def tracked_fractions(matches: Matches, of: NDArray[np.bool_] | None = None) -> Array:
    """Return each person's share of frames with a match (n_people,), NaN of one who is in none.

    of: (n_frames, n_people) the frames that count, beside those in which the person is present.
    """
    counted = matches.present if of is None else matches.present & of
    matched = np.isfinite(matches.error_m) & counted
    frames = counted.sum(axis=0)
    return np.where(frames > 0, matched.sum(axis=0) / np.maximum(frames, 1), np.nan)


def false_track_ids(tracks: NDArray[np.void], matches: Matches, confirmed_state: int = 1) -> list[int]:
    """Return the tracks that match nobody in most of the evaluated frames in which they are confirmed."""
    confirmed = tracks[(tracks["state"] == confirmed_state) & np.isin(tracks["frame"], matches.frames)]
    row = np.searchsorted(matches.frames, confirmed["frame"])
    matched = np.any(matches.track_id[row] == confirmed["id"][:, np.newaxis], axis=1)
    ids = np.unique(confirmed["id"])
    return [int(which) for which in ids if np.mean(matched[confirmed["id"] == which]) < 0.5]


def ghosts_per_frame(
    points: NDArray[np.void],
    frames: NDArray[np.intp],
    frame_time_s: Array,
    truth: Sequence[PersonTruth],
    *,
    dimension: int = 2,
) -> float:
    """Return how many of the located points (n,) a frame lie farther than GHOST_M from everybody.

    frames: those that count; frame_time_s: (n_frames,) of all.
    """
    counted = points[np.isin(points["frame"], frames)]
    positions, present = true_positions(truth, frame_time_s[counted["frame"]])
    place = places_m(counted, dimension)
    distance = np.linalg.norm(positions[..., :dimension] - place[:, np.newaxis], axis=-1)
    nearest = np.min(np.where(present, distance, np.inf), axis=1, initial=np.inf)
    return float(np.sum(nearest > GHOST_M) / frames.size) if frames.size else float("nan")


def _leg(position_m: Array, end_m: ArrayLike, wall: Wall) -> tuple[Array, Array]:
    """Return the optical length (...,) [m] between an antenna and positions, and its gradient (..., 3)."""
    offset = position_m - np.asarray(end_m, np.float64)
    across_m = np.hypot(offset[..., 0], offset[..., 2])
    air_m = np.maximum(np.abs(offset[..., 1]) - wall.thickness_m, LEAST_AIR_M)
    rays = refracted(wall, across_m, air_m)
    along, up = (
        rays.sine * np.divide(offset[..., axis], across_m, out=np.zeros_like(across_m), where=across_m > 0.0)
        for axis in (0, 2)
    )
    deep = np.sqrt(1.0 - rays.sine**2) * np.sign(offset[..., 1])
    return rays.delay_s * SPEED_OF_LIGHT_MPS, np.stack([along, deep, up], axis=-1)
