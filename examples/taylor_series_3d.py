"""How accurate the closed forms and the Taylor-series method are: the tables of docs/taylor_series_3d.md.

python examples/taylor_series_3d.py [DRAWS]    (draws a table row, 20000 if left out)
"""

import sys
from collections import Counter

import numpy as np

from echofuse import _core

SPACING_M = 0.39
CROSS_M = SPACING_M * np.array([[-1, 0, 0], [1, 0, 0], [0, 0, -1], [0, 0, 1]], np.float32)  # (4, 3)
CORNERS_M = np.array([[-0.6, 0, -0.6], [0.6, 0, -0.6], [-0.6, 0, 0.6], [0.6, 0, 0.6]], np.float32)
ORIGIN = np.zeros(3, np.float32)
START = _core.Taylor3dStart
METHOD = _core.Planar3dMethod


def paths(at, rx_m=CROSS_M):
    """Paths (n,) [m] from the origin over a place (3,) to receivers (n, 3)."""
    return np.linalg.norm(at) + np.linalg.norm(at - rx_m, axis=1)


def bound(at, std_m, rx_m=CROSS_M):
    """Cramer-Rao bound of the position error [m], from paths of standard deviations (n,)."""
    units = [(at - antenna) / np.linalg.norm(at - antenna) for antenna in [ORIGIN, *rx_m]]
    rows = (units[0] + np.array(units[1:])) / std_m[:, None]
    return np.sqrt(np.trace(np.linalg.inv(rows.T @ rows)))


def taylor(start, rx_m=CROSS_M):
    """Make a configured Taylor-series method with nothing in the way."""
    made = _core.Taylor3d()
    wall = _core.WallConfig(compensation=_core.WallCompensation.none)
    if made.configure(_core.Taylor3dConfig(wall=wall, start=start), ORIGIN, rx_m) != _core.Status.ok:
        raise RuntimeError("impossible configuration")
    return made


def rms(found, at):
    """Root mean square of the position error [m]."""
    return np.sqrt(np.mean(np.sum((np.array(found) - at) ** 2, axis=1)))


def accuracy(at, std_m, draws, rng):
    """Errors [m] of A-3D-2D, 3D-2D, and the Taylor-series method from either, and the fixes that diverged."""
    at, std_m = np.array(at), np.array(std_m)
    noisy = (paths(at) + std_m * rng.standard_normal((draws, 4))).astype(np.float32)
    variance = (std_m**2).astype(np.float32)
    errors = [
        rms([_core.planar_3d(method, SPACING_M, path).position_m for path in noisy], at)
        for method in (METHOD.approximate, METHOD.three_d_two_d)
    ]
    diverging = 0
    for start in (START.approximate, START.three_d_two_d):
        made = taylor(start)
        fixes = [made.process(path, variance, ORIGIN)[1] for path in noisy]
        errors.append(rms([fix.position_m for fix in fixes], at))
        diverging += sum(fix.status != _core.Taylor3dStatus.converged for fix in fixes)
    return *errors, bound(at, std_m), diverging


def table_of_accuracy(draws, rng):
    """Print what equal and unequal deviations do."""
    print(
        "| place [m] | paths' deviations [mm] | A-3D-2D | 3D-2D | TSM from A-3D-2D | TSM | bound | not (c) |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for at in [(0.0, 4.0, 0.0), (1.5, 4.0, 0.8), (0.3, 2.0, 1.2)]:
        for std_mm in [(5, 5, 5, 5), (20, 20, 20, 20), (5, 5, 5, 20), (5, 20, 5, 20)]:
            *errors, diverging = accuracy(at, np.array(std_mm) / 1000, draws, rng)
            cells = " | ".join(f"{error:.4f}" for error in errors)
            print(f"| {at} | {', '.join(map(str, std_mm))} | {cells} | {diverging} |")


def table_of_receivers(draws, rng):
    """Print what receivers beyond the cross add, at equal deviations of 20 mm."""
    print("| receivers | TSM | bound |\n|---|---|---|")
    at = np.array([1.5, 4.0, 0.8])
    for n in range(4, 9):
        rx_m = np.concatenate([CROSS_M, CORNERS_M[: n - 4]])
        made, std_m = taylor(START.three_d_two_d, rx_m), np.full(n, 0.02)
        noisy = (paths(at, rx_m) + std_m * rng.standard_normal((draws, n))).astype(np.float32)
        variance = (std_m**2).astype(np.float32)
        found = [made.process(path, variance, ORIGIN)[1].position_m for path in noisy]
        print(f"| {n} | {rms(found, at):.4f} | {bound(at, std_m, rx_m):.4f} |")


def table_of_starts(draws, rng):
    """Print how a given start ends, over a room and without noise."""
    print("| start is off by [m] | stopped by (c), right | (c), elsewhere | (a) | (d) | singular |")
    print("|---|---|---|---|---|---|")
    made, stop = taylor(START.given), _core.Taylor3dStatus
    for off_m in (1, 2, 3, 5):
        ends = Counter()
        for _ in range(draws):
            at, direction = rng.uniform([-2, 2, -1], [2, 6, 1]), rng.standard_normal(3)
            given = at + off_m * direction / np.linalg.norm(direction)
            _, fix = made.process(
                paths(at).astype(np.float32), np.ones(4, np.float32), given.astype(np.float32)
            )
            right = np.linalg.norm(np.array(fix.position_m) - at) < 1e-2
            ends[fix.status, fix.status == stop.converged and right] += 1
        counts = [
            ends[stop.converged, True],
            ends[stop.converged, False],
            *(ends[status, False] for status in (stop.diverging, stop.iteration_limit, stop.singular)),
        ]
        print(f"| {off_m} | " + " | ".join(f"{100 * count / draws:.1f} %" for count in counts) + " |")


if __name__ == "__main__":
    n_draws = int(sys.argv[1]) if len(sys.argv) > 1 else 20000
    for table in (table_of_accuracy, table_of_receivers, table_of_starts):
        table(n_draws, np.random.default_rng(2))
        print()
