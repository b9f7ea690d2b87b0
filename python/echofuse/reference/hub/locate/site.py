"""Where the nodes and the watched area are, and how long a path over a person is."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Site(NamedTuple):
    """Foci of each node's ellipses and the watched area."""

    tx_m: Array  # (n_nodes, 2) [m]
    rx_m: Array  # (n_nodes, 2) [m]; equal to tx_m for a monostatic node
    area_m: Array  # (4,) [m] min x, min y, max x, max y


def unit(position_m: Array, from_m: Array) -> Array:
    """Unit vectors (..., 2) that point from `from_m` to `position_m`; zero where they coincide."""
    offset = position_m - from_m
    distance = np.linalg.norm(offset, axis=-1, keepdims=True)
    return np.asarray(np.divide(offset, distance, out=np.zeros_like(offset), where=distance > 0))


def path_m(position_m: Array, tx_m: Array, rx_m: Array, body_radius_m: float = 0.0) -> Array:
    """Predicted path tx -> nearest skin of a round person at `position_m` -> rx [m], (...,).

    ``|z - tx| + |z - rx| - 2 R cos(beta / 2)``; the two unit vectors' sum has the length 2 cos(beta / 2).
    """
    direct = np.linalg.norm(position_m - tx_m, axis=-1) + np.linalg.norm(position_m - rx_m, axis=-1)
    bisector = unit(position_m, tx_m) + unit(position_m, rx_m)
    return np.asarray(direct - body_radius_m * np.linalg.norm(bisector, axis=-1))


def path_gradient(position_m: Array, tx_m: Array, rx_m: Array, body_radius_m: float = 0.0) -> Array:
    """Derivative of `path_m` with respect to the position [1], (..., 2)."""
    u, v = unit(position_m, tx_m), unit(position_m, rx_m)
    gradient = u + v
    if body_radius_m == 0.0:
        return gradient
    to_tx = np.linalg.norm(position_m - tx_m, axis=-1, keepdims=True)
    to_rx = np.linalg.norm(position_m - rx_m, axis=-1, keepdims=True)
    cosine = np.sum(u * v, axis=-1, keepdims=True)
    length = np.linalg.norm(gradient, axis=-1, keepdims=True)
    turn = (v - cosine * u) / to_tx + (u - cosine * v) / to_rx  # d|u + v|/dz times |u + v|
    shrink = np.divide(turn, length, out=np.zeros_like(turn), where=length > 1e-3)
    return np.asarray(gradient - body_radius_m * shrink)


def inside(position_m: Array, area_m: Array) -> tuple[bool, float]:
    """Is the position in the area, and its distance to the nearest edge [m]."""
    gaps = np.concatenate([position_m - area_m[:2], area_m[2:] - position_m])
    return bool(np.all(gaps >= 0)), float(np.min(np.abs(gaps)))


def on_a_line(positions_m: Array, tolerance_m: float) -> bool:
    """Is every position within `tolerance_m` of the line through the two that are farthest apart."""
    gaps = np.linalg.norm(positions_m[:, None] - positions_m[None], axis=-1)
    i, j = np.unravel_index(int(np.argmax(gaps)), gaps.shape)
    if gaps[i, j] <= tolerance_m:
        return True
    along = (positions_m[j] - positions_m[i]) / gaps[i, j]
    across = (positions_m - positions_m[i]) @ np.array([-along[1], along[0]])
    return bool(np.all(np.abs(across) <= tolerance_m))


def invalid_site(site: Site, tolerance_m: float = 0.01) -> str | None:
    """Name of what makes locating impossible, or None.

    Fewer than three nodes, an empty area, two nodes with the same foci, or all antennas on a line that the
    area does not lie beside (a point and its mirror image have the same paths).
    """
    tx, rx, area = site.tx_m, site.rx_m, site.area_m
    if len(tx) < 3:
        return "n_nodes"
    if not (np.isfinite(tx).all() and np.isfinite(rx).all()):
        return "nodes"
    if not (np.isfinite(area).all() and area[0] < area[2] and area[1] < area[3]):
        return "area"
    for i in range(len(tx)):
        for j in range(i):
            alike = max(np.linalg.norm(tx[i] - tx[j]), np.linalg.norm(rx[i] - rx[j]))
            swapped = max(np.linalg.norm(tx[i] - rx[j]), np.linalg.norm(rx[i] - tx[j]))
            if min(alike, swapped) <= tolerance_m:
                return "nodes"
    antennas = np.concatenate([tx, rx])
    if on_a_line(antennas, tolerance_m):
        gaps = np.linalg.norm(antennas - antennas[0], axis=1)
        along = antennas[int(np.argmax(gaps))] - antennas[0]
        corners = np.array([[area[0], area[1]], [area[0], area[3]], [area[2], area[1]], [area[2], area[3]]])
        side = (corners - antennas[0]) @ np.array([-along[1], along[0]])
        if not (np.all(side >= 0) or np.all(side <= 0)):
            return "nodes"
    return None
