"""Intersection of ellipses in the plane (sensor-radar paper, eqs. 16-23), and its Gauss-Newton refinement."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.hub.locate.site import path_gradient, path_m

Array = NDArray[np.float64]

N_START_SAMPLES = 32  # points on the smallest ellipse where no closed form exists
MIN_CONDITION = 1e-6  # det / trace^2 of a 2 x 2 normal matrix; below, the geometry is singular
CONVERGED_STEP_M = 1e-4
EVERYWHERE = np.array([-np.inf, -np.inf, np.inf, np.inf])


class EllipseConfig(Protocol):
    refinement: str  # gauss_newton | none
    max_iterations: int
    max_step_m: float
    body_radius_m: float
    robust_scale_m: float


class Ellipses(NamedTuple):
    """One measured path a row; `weight` is its relative inverse variance."""

    tx_m: Array  # (n, 2) [m]
    rx_m: Array  # (n, 2) [m]
    path_m: Array  # (n,) [m]
    weight: Array  # (n,) [1]


class EllipseFix(NamedTuple):
    position_m: Array  # (2,) [m]
    range_residual_m: float  # RR: root mean square of measured minus predicted path
    equation_residual_m3: float  # RE of (25); nan unless all share one transmitter
    iterations: int
    margin: float  # least relative distance of a decision (singular or not, which start) from flipping
    converged: bool


class Start(NamedTuple):
    position_m: Array
    equation_residual_m3: float
    margin: float


def range_residuals(position_m: Array, ellipses: Ellipses, body_radius_m: float) -> Array:
    """Measured minus predicted path [m], (n,)."""
    return ellipses.path_m - path_m(position_m, ellipses.tx_m, ellipses.rx_m, body_radius_m)


def range_residual_m(position_m: Array, ellipses: Ellipses, body_radius_m: float) -> float:
    """RR of algorithms 6.7 [m]: median equal to the error of one path, for any number of ellipses >= 3."""
    residuals = range_residuals(position_m, ellipses, body_radius_m)
    return float(np.sqrt(np.mean(residuals**2)))


def condition(normal: Array) -> float:
    """det / trace^2 of a 2 x 2 normal matrix: 1/4 when round, 0 when singular."""
    trace = float(np.trace(normal))
    return float(np.linalg.det(normal)) / trace**2 if trace > 0 else 0.0


def linear_system(ellipses: Ellipses, path: Array) -> tuple[Array, Array] | None:
    """A (n - 1, 2) and g (n - 1,) of (22), or differences of monostatic nodes' circles; None: neither."""
    x, x_t = ellipses.rx_m, ellipses.tx_m
    k = int(np.argmin(path))
    others = np.arange(len(path)) != k
    if np.all(x_t == x_t[0]):
        p = 0.5 * (path**2 - np.sum(x**2, axis=1) + np.sum(x_t**2, axis=1))  # (18)
        a = path[:, None] * (x[k] - x_t[0]) - path[k] * (x - x_t[0])  # (21)
        g = path[k] * p - path * p[k]
        return a[others], g[others]
    if np.all(x_t == x):
        r = 0.5 * path
        a = 2.0 * (x - x[k])
        g = r[k] ** 2 - r**2 + np.sum(x**2, axis=1) - np.sum(x[k] ** 2)
        return a[others], g[others]
    return None


def sampled_start(ellipses: Ellipses, path: Array, area_m: Array) -> Start | None:
    """Of points on the smallest ellipse and in the area, the one with the least residual."""
    k = int(np.argmin(path))
    tx, rx, major = ellipses.tx_m[k], ellipses.rx_m[k], 0.5 * path[k]
    half_baseline = 0.5 * float(np.linalg.norm(rx - tx))
    if major <= half_baseline:
        return None
    minor = np.sqrt(major**2 - half_baseline**2)
    along = (rx - tx) / (2 * half_baseline) if half_baseline > 0 else np.array([1.0, 0.0])
    across = np.array([-along[1], along[0]])
    angle = (
        2 * np.pi * (np.arange(N_START_SAMPLES) + 0.5) / N_START_SAMPLES
    )  # off the axes: nodes are on walls
    points = (
        0.5 * (tx + rx) + np.outer(major * np.cos(angle), along) + np.outer(minor * np.sin(angle), across)
    )
    residuals = [path - path_m(point, ellipses.tx_m, ellipses.rx_m) for point in points]
    costs = np.array([float(np.sum(residual**2)) for residual in residuals])
    costs[~np.all((points >= area_m[:2]) & (points <= area_m[2:]), axis=1)] = np.inf
    best = int(np.argmin(costs))
    if not np.isfinite(costs[best]):
        return None
    second = float(np.min(np.delete(costs, best)))
    edge = np.concatenate([points - area_m[:2], area_m[2:] - points], axis=1)
    lead = (second - costs[best]) / max(second, 1e-12) if np.isfinite(second) else 1.0
    margin = min(float(lead), float(np.min(np.abs(edge))))
    return Start(points[best], float("nan"), margin)


def start(ellipses: Ellipses, body_radius_m: float, area_m: Array) -> Start | None:
    """(23) where it exists, else the best sample of the smallest ellipse.

    With a body radius the paths are first widened by 2 R, the offset of an echo straight back.
    """
    path = ellipses.path_m + 2.0 * body_radius_m
    system = linear_system(ellipses, path)
    margin = 1.0
    if system is not None:
        a, g = system
        normal = a.T @ a
        margin = abs(condition(normal) / MIN_CONDITION - 1.0)
        if condition(normal) > MIN_CONDITION:
            position = np.asarray(np.linalg.solve(normal, a.T @ g), dtype=np.float64)
            shared = bool(np.all(ellipses.tx_m == ellipses.tx_m[0]))
            error = float(np.linalg.norm(a @ position - g)) if shared else float("nan")
            return Start(position, error, margin)
    sampled = sampled_start(ellipses, path, area_m)
    return sampled and sampled._replace(margin=min(margin, sampled.margin))


def refine(config: EllipseConfig, ellipses: Ellipses, position_m: Array, robust: bool) -> EllipseFix | None:
    """Gauss-Newton on the paths from a start; None: singular.

    With `robust` (and a scale) each path's weight is divided by 1 + (residual / scale)^2, so that one foul
    path does not pull the fix.
    """
    position = np.array(position_m, dtype=np.float64)
    iterations, margin, converged = 0, 1.0, False
    while iterations < config.max_iterations and not converged:
        residuals = range_residuals(position, ellipses, config.body_radius_m)
        jacobian = path_gradient(position, ellipses.tx_m, ellipses.rx_m, config.body_radius_m)
        weight = ellipses.weight
        if robust and config.robust_scale_m > 0:
            weight = weight / (1.0 + (residuals / config.robust_scale_m) ** 2)
        normal = jacobian.T @ (weight[:, None] * jacobian)
        margin = min(margin, abs(condition(normal) / MIN_CONDITION - 1.0))
        if not condition(normal) > MIN_CONDITION:
            return None
        step = np.linalg.solve(normal, jacobian.T @ (weight * residuals))
        length = float(np.linalg.norm(step))
        if length > config.max_step_m:
            step *= config.max_step_m / length
        position = position + step
        iterations += 1
        converged = length < CONVERGED_STEP_M
    residual = range_residual_m(position, ellipses, config.body_radius_m)
    return EllipseFix(position, residual, float("nan"), iterations, margin, converged)


def ellipse_least_squares(
    config: EllipseConfig, ellipses: Ellipses, area_m: Array = EVERYWHERE
) -> EllipseFix | None:
    """Locate one person from n >= 3 paths; None: the geometry is singular."""
    begin = start(ellipses, config.body_radius_m, area_m)
    if begin is None:
        return None
    if config.refinement == "none":
        residual = range_residual_m(begin.position_m, ellipses, config.body_radius_m)
        return EllipseFix(begin.position_m, residual, begin.equation_residual_m3, 0, begin.margin, True)
    fix = refine(config, ellipses, begin.position_m, robust=False)
    if fix is None:
        return None
    return fix._replace(equation_residual_m3=begin.equation_residual_m3, margin=min(begin.margin, fix.margin))
