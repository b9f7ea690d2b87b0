"""A position in space by the Taylor-series method: weighted Gauss-Newton with the paper's stop rules.

Taylor-series paper, sections 3 and 4; wall as in algorithms 5.7; covariance as in algorithms 8.2.
"""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.hub.locate.planar_3d import MIN_DEPTH_M, planar_3d
from echofuse.reference.hub.locate.wall import WallConfig, normal_excess_m, ray

Array = NDArray[np.float64]

MIN_PIVOT = 3e-6  # of the information's Cholesky factor, relative to its diagonal; below, it is singular


class Taylor3dConfig(Protocol):
    wall: WallConfig
    start: str  # three_d_two_d | approximate | given
    range_kind: str  # bistatic | one_way
    min_step_m: float
    max_iterations: int  # 0: the start itself


class Taylor3dFix(NamedTuple):
    status: str  # converged | diverging | iteration_limit | singular | no_start
    position_m: Array  # (3,) [m]
    covariance_m2: Array  # (3, 3) [m^2]
    range_residual_m: float
    iterations: int
    margin: float  # least relative distance of a decision from flipping


def leg(wall: WallConfig, in_plane: bool, position_m: Array, antenna_m: Array) -> tuple[float, Array]:
    """Optical path from an antenna (3,) to a position (3,) [m], and its gradient (3,)."""
    offset = position_m - antenna_m
    if not in_plane:
        distance = float(np.linalg.norm(offset))
        return distance, offset / distance if distance > 0.0 else np.zeros(3)
    lateral = float(np.hypot(offset[0], offset[2]))
    found = ray(wall, lateral, float(offset[1]))
    along, across = found.direction
    per_lateral = 1.0 / lateral if lateral > 0.0 else 0.0
    return found.optical_m, np.array(
        [along * offset[0] * per_lateral, across, along * offset[2] * per_lateral]
    )


def antennas_in_plane(config: Taylor3dConfig, tx_m: Array, rx_m: Array) -> bool:
    """Whether all antennas lie in the plane y = 0."""
    return bool(np.all(rx_m[:, 1] == 0.0) and (config.range_kind == "one_way" or tx_m[1] == 0.0))


def ranges_and_gradient(
    config: Taylor3dConfig, tx_m: Array, rx_m: Array, position_m: Array
) -> tuple[Array, Array]:
    """Ranges (n,) [m] of a position (3,), of receivers (n, 3), and their gradients (n, 3): (3) and (6)."""
    in_plane = antennas_in_plane(config, tx_m, rx_m)
    legs = [leg(config.wall, in_plane, position_m, rx) for rx in rx_m]
    range_m, gradient = np.array([r for r, _ in legs]), np.array([g for _, g in legs])
    if config.range_kind == "bistatic":
        to_tx, direction = leg(config.wall, in_plane, position_m, tx_m)
        range_m, gradient = range_m + to_tx, gradient + direction
    return range_m, gradient


def smallest_pivot(information: Array) -> float:
    """Least squared diagonal element of the Cholesky factor, relative to the matrix's diagonal."""
    diagonal = np.diag(information)
    if not np.all(diagonal > 0.0):
        return 0.0
    try:
        return float(np.min(np.diag(np.linalg.cholesky(information)) ** 2 / diagonal))
    except np.linalg.LinAlgError:
        return 0.0


def initial(config: Taylor3dConfig, rx_m: Array, range_m: Array, given_m: Array) -> Array:
    """Step 0: the start (3,) [m], by the cross of the first four receivers unless it is given."""
    if config.start == "given":
        return given_m
    excess = 2.0 * normal_excess_m(config.wall)
    return planar_3d(config.start, float(rx_m[1, 0]), range_m[:4] - excess).position_m


def taylor_3d(
    config: Taylor3dConfig, tx_m: Array, rx_m: Array, range_m: Array, variance_m2: Array, given_m: Array
) -> Taylor3dFix:
    """Locate from ranges (n,) [m] of variances (n,) [m^2]; an infinite variance: no range."""
    used = np.isfinite(variance_m2)
    nothing = Taylor3dFix("no_start", np.zeros(3), np.zeros((3, 3)), 0.0, 0, 1.0)
    if config.start != "given" and not np.all(used[:4]):
        return nothing
    position = np.array(initial(config, rx_m, range_m, given_m), dtype=np.float64)
    in_plane = antennas_in_plane(config, tx_m, rx_m)
    if in_plane:
        position[1] = max(position[1], MIN_DEPTH_M)
    root_weight = 1.0 / np.sqrt(variance_m2[used])
    previous, margin, iterations = np.inf, 1.0, 0
    status = "" if config.max_iterations > 0 else "iteration_limit"
    while True:
        predicted, gradient = ranges_and_gradient(config, tx_m, rx_m, position)
        rows, residual = gradient[used] * root_weight[:, None], (range_m - predicted)[used]
        information = rows.T @ rows
        pivot = smallest_pivot(information)
        margin = min(margin, abs(pivot / MIN_PIVOT - 1.0))
        if not pivot > MIN_PIVOT:
            return nothing._replace(status="singular", iterations=iterations, margin=margin)
        if status:
            break
        step = np.linalg.lstsq(rows, residual * root_weight, rcond=None)[0]  # (8)
        length = float(np.linalg.norm(step))
        if np.isfinite(previous):
            margin = min(margin, abs(length / previous - 1.0))
        if not length < previous:  # rule a
            status = "diverging"
            continue
        position = position + step  # (9)
        if in_plane:
            position[1] = max(position[1], MIN_DEPTH_M)
        iterations, previous = iterations + 1, length
        if length <= config.min_step_m:  # rule c; else b
            status = "converged"
        elif iterations == config.max_iterations:  # rule d
            margin = min(margin, abs(length / config.min_step_m - 1.0))
            status = "iteration_limit"
    covariance: Array = np.asarray(np.linalg.inv(information), dtype=np.float64)
    rms = float(np.sqrt(np.mean(residual**2)))
    return Taylor3dFix(status, position, covariance, rms, iterations, margin)
