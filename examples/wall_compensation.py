"""What a wall does to positions, and what compensation leaves of it: the table of docs/through_wall.md.

python examples/wall_compensation.py
"""

import numpy as np

from echofuse import _core
from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.simulation.wall import Wall, refracted

RX_X_M = np.array([-0.4, 0.4], np.float32)
THICKNESS_M, PERMITTIVITY = 0.24, 4.0
PLACES_M = [(x, y) for x in np.linspace(-2.1, 2.1, 15) for y in np.linspace(0.7, 5.9, 14)]  # people's middles
KIND = _core.WallCompensation


def paths(x_m, y_m):
    """Paths (2,) [m] from the transmitter over a place to the receivers, by the simulation's rays."""
    wall = Wall(thickness_m=THICKNESS_M, permittivity=PERMITTIVITY)
    across_m = np.abs(x_m - np.array([0.0, *RX_X_M]))
    delay_s = refracted(wall, across_m, np.full(3, y_m - THICKNESS_M)).delay_s
    return ((delay_s[0] + delay_s[1:]) * SPEED_OF_LIGHT_MPS).astype(np.float32)


def errors(kind, thickness_m, permittivity):
    """Position errors (n, 2) [m] over the room with what is believed of the wall."""
    wall = _core.WallConfig(thickness_m=thickness_m, relative_permittivity=permittivity, compensation=kind)
    locator = _core.LineLocator()
    if locator.configure(_core.LineLocatorConfig(wall=wall), RX_X_M) != _core.Status.ok:
        raise RuntimeError("impossible configuration")
    found = [locator.process(paths(*place), np.ones(2, np.float32))[1].position_m for place in PLACES_M]
    return np.array(found) - np.array(PLACES_M)


def main():
    """Print the table."""
    print("| compensation | thickness | permittivity | mean [m] | 95 % [m] | largest [m] | mean depth [m] |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    believed = [(1.0, 1.0), (1.2, 1.0), (0.8, 1.0), (1.0, 1.2), (1.0, 0.8), (1.2, 1.2), (0.8, 0.8)]
    for thickness, permittivity in believed:
        for kind in (KIND.none, KIND.first_kind, KIND.second_kind):
            if kind == KIND.none and (thickness, permittivity) != (1.0, 1.0):
                continue  # which believes nothing
            error = errors(kind, thickness * THICKNESS_M, permittivity * PERMITTIVITY)
            distance = np.hypot(*error.T)
            size = f"{distance.mean():.3f} | {np.quantile(distance, 0.95):.3f} | {distance.max():.3f}"
            about = f"{thickness - 1.0:+.0%} | {permittivity - 1.0:+.0%}".replace("+0%", "true")
            print(f"| {kind.name} | {about} | {size} | {error[:, 1].mean():+.3f} |")


if __name__ == "__main__":
    main()
