"""A position in space from a cross of four receivers, as two ellipses in each of two planes (3D-2D, A-3D-2D).

The transmitter is the origin; receivers 1 and 2 lie at -d and d on x (along the wall), 3 and 4 at -d and d on
z (upwards); y > 0 is the depth (Taylor-series paper, section 1; closed form of algorithms 4.2 and 4.3).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MIN_DEPTH_M = 0.02
CLIP = 1e-6  # relative: a path is at least (1 + CLIP) d, two differ by (1 - CLIP) 2 d at most


class Planar3dFix(NamedTuple):
    status: str  # fix | clipped
    position_m: Array  # (3,) [m]
    margin: float  # least relative distance of a decision from flipping


def clip_pair(path_m: Array, spacing_m: float) -> tuple[Array, bool, float]:
    """Bring two paths (2,) [m] to where their ellipses meet: the paths, whether they moved, and margin."""
    least, most = spacing_m * (1.0 + CLIP), 2.0 * spacing_m * (1.0 - CLIP)
    clipped = np.maximum(path_m, least)
    margin = float(np.min(np.abs(path_m / least - 1.0)))
    excess = abs(clipped[0] - clipped[1]) - most
    margin = min(margin, abs(excess) / most)
    moved = bool(np.any(clipped != path_m)) or excess > 0.0
    if excess > 0.0:
        middle = 0.5 * (clipped[0] + clipped[1])
        sign = np.sign(clipped[0] - clipped[1])
        clipped = middle + sign * 0.5 * most * np.array([1.0, -1.0])
    return clipped, moved, margin


def along_axis(path_m: Array, spacing_m: float) -> tuple[float, float]:
    """Coordinate along the axis of two receivers, and distance to the transmitter, from paths (2,) [m]."""
    (d1, d2), d = path_m, spacing_m
    along = (d1 - d2) * (d1 * d2 + d**2) / (2 * d * (d1 + d2))
    return along, (d1**2 + d2**2 - 2 * d**2) / (2 * (d1 + d2))


def planar_3d(method: str, spacing_m: float, path_m: Array) -> Planar3dFix:
    """Locate by method three_d_two_d or approximate, from finite paths (4,) [m]."""
    pair1, moved1, margin1 = clip_pair(path_m[:2], spacing_m)
    pair2, moved2, margin2 = clip_pair(path_m[2:], spacing_m)
    x, range1 = along_axis(pair1, spacing_m)
    z, range2 = along_axis(pair2, spacing_m)
    if method == "three_d_two_d":
        squares = np.array([range1, range2]) ** 2 - x**2 - z**2
    else:
        squares = np.array([range1**2 - x**2, range2**2 - z**2])
    y = float(np.mean(np.sqrt(np.maximum(squares, 0.0))))
    clipped = moved1 or moved2 or bool(np.any(squares < 0.0)) or y < MIN_DEPTH_M
    least = float(np.min(np.abs(squares))) / (range1**2 + range2**2)
    margin = min(margin1, margin2, least, abs(y / MIN_DEPTH_M - 1.0))
    position = np.array([x, max(y, MIN_DEPTH_M), z])
    return Planar3dFix("clipped" if clipped else "fix", position, margin)
