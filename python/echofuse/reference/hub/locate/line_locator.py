"""A position before a line of antennas: two ellipses in closed form, least squares for more.

The transmitter is the origin, x runs along the antennas, y > 0 is the depth (through-wall paper, section 2).
"""

from itertools import combinations
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.hub.locate.wall import Ray, WallConfig, normal_excess_m, ray

Array = NDArray[np.float64]

MIN_DEPTH_M = 0.02
MIN_DETERMINANT = 1e-6  # relative; below, two receivers say the same
CONVERGED_STEP_M = 1e-4
MAX_ITERATIONS = 10
MAX_STEP_M = 1.0
MIN_CONDITION = 1e-6  # det / trace^2 of the information; below, the geometry is singular


class LineLocatorConfig(Protocol):
    wall: WallConfig
    path_std_m: float


class LineFix(NamedTuple):
    status: str  # fix | no_intersection | too_near_axis | singular
    position_m: Array  # (2,) [m]
    covariance_m2: Array  # (2, 2) [m^2]
    iterations: int
    converged: bool
    margin: float  # least relative distance of a decision from flipping


def two_ellipses(path_m: Array, rx_x_m: Array) -> LineFix:
    """Intersect two ellipses: path_m (2,) and rx_x_m (2,), receivers' abscissae [m]."""
    (d1, d2), (x1, x2) = path_m, rx_x_m
    nothing = LineFix("no_intersection", np.zeros(2), np.zeros((2, 2)), 0, True, 1.0)
    beyond = path_m / np.abs(rx_x_m) - 1.0
    if not np.all(beyond > 0):
        return nothing._replace(margin=float(np.min(np.abs(beyond))))
    k1, k2 = (path_m**2 - rx_x_m**2) / 2
    determinant = x1 * d2 - x2 * d1
    size = abs(x1) * d2 + abs(x2) * d1
    margin = min(float(np.min(beyond)), abs(abs(determinant) / (MIN_DETERMINANT * size) - 1.0))
    if not abs(determinant) > MIN_DETERMINANT * size:
        return nothing._replace(margin=margin)
    x = -(k1 * d2 - k2 * d1) / determinant
    r0 = (x1 * x + k1) / d1
    legs = np.array([r0, d1 - r0, d2 - r0])
    y2 = r0**2 - x**2
    margin = min(margin, float(np.min(np.abs(legs)) / d1), abs(y2) / r0**2)
    if not (np.all(legs > 0) and y2 >= 0):
        return nothing._replace(margin=margin)
    y = np.sqrt(y2)
    margin = min(margin, abs(y2 - MIN_DEPTH_M**2) / r0**2)
    status = "fix" if y >= MIN_DEPTH_M else "too_near_axis"
    return LineFix(status, np.array([x, y]), np.zeros((2, 2)), 0, True, margin)


def rays(wall: WallConfig, position_m: Array, antenna_x_m: Array) -> list[Ray]:
    """One ray an antenna."""
    return [ray(wall, abs(position_m[0] - x), position_m[1]) for x in antenna_x_m]


def path_and_gradient(wall: WallConfig, position_m: Array, rx_x_m: Array) -> tuple[Array, Array]:
    """Paths tx -> position -> rx (n,) [m] with the wall's delay, and their gradients (n, 2)."""
    antennas = np.concatenate([[0.0], rx_x_m])
    found = rays(wall, position_m, antennas)
    optical = np.array([r.optical_m for r in found])
    sign = np.where(position_m[0] < antennas, -1.0, 1.0)
    direction = np.array([r.direction for r in found]) * np.stack([sign, np.ones_like(sign)], axis=1)
    return optical[0] + optical[1:], direction[0] + direction[1:]


def behind_wall(wall: WallConfig, path_m: Array, rx_x_m: Array) -> LineFix:
    """Intersect two ellipses of the paths less the wall's delay at the last fix, until it stays."""
    fix = two_ellipses(path_m - 2.0 * normal_excess_m(wall), rx_x_m)
    margin = fix.margin
    if wall.compensation != "second_kind":
        return fix
    for iteration in range(1, MAX_ITERATIONS + 1):
        if fix.status != "fix":
            return fix._replace(margin=margin)
        excess = np.array([r.excess_m for r in rays(wall, fix.position_m, np.concatenate([[0.0], rx_x_m]))])
        moved = two_ellipses(path_m - excess[0] - excess[1:], rx_x_m)
        margin = min(margin, moved.margin)
        step = float(np.linalg.norm(moved.position_m - fix.position_m))
        fix = moved._replace(
            iterations=iteration, margin=margin, converged=moved.status != "fix" or step < CONVERGED_STEP_M
        )
        if fix.converged:
            break
    return fix


def condition(information: Array) -> float:
    """det / trace^2 of a 2 x 2 matrix."""
    return float(np.linalg.det(information) / np.trace(information) ** 2)


def locate_on_line(config: LineLocatorConfig, rx_x_m: Array, path_m: Array, weight: Array) -> LineFix:
    """Locate from n >= 2 paths (n,) [m] of relative inverse variance weight (n,); weight 0: no path."""
    used = np.flatnonzero(weight > 0)
    fix, least, second, margin = None, np.inf, np.inf, 1.0
    for pair in combinations(used, 2):
        chosen = list(pair)
        candidate = behind_wall(config.wall, path_m[chosen], rx_x_m[chosen])
        margin = min(margin, candidate.margin)
        cost = np.inf
        if candidate.status == "fix":
            predicted, _ = path_and_gradient(config.wall, candidate.position_m, rx_x_m[used])
            cost = float(np.sum(weight[used] * (path_m[used] - predicted) ** 2))
        if fix is None or cost < least:
            fix, least, second = candidate, cost, least
        else:
            second = min(second, cost)
    assert fix is not None, "two paths at least"
    if fix.status != "fix":
        return fix._replace(margin=margin)
    position, iterations, converged = fix.position_m, fix.iterations, fix.converged
    if len(used) > 2:
        iterations, converged = 0, False
    while True:
        predicted, gradient = path_and_gradient(config.wall, position, rx_x_m[used])
        information = gradient.T @ (weight[used, None] * gradient)
        margin = min(margin, abs(condition(information) / MIN_CONDITION - 1.0))
        if not condition(information) > MIN_CONDITION:
            return fix._replace(status="singular", margin=margin)
        if len(used) == 2 or converged or iterations == MAX_ITERATIONS:
            break
        step = np.linalg.solve(information, gradient.T @ (weight[used] * (path_m[used] - predicted)))
        length = float(np.linalg.norm(step))
        position = position + step * min(1.0, MAX_STEP_M / max(length, 1e-12))
        position = np.array([position[0], max(position[1], MIN_DEPTH_M)])
        iterations += 1
        converged = length < CONVERGED_STEP_M
    covariance: Array = config.path_std_m**2 * np.asarray(np.linalg.inv(information), dtype=np.float64)
    return LineFix("fix", position, covariance, iterations, converged, margin)
