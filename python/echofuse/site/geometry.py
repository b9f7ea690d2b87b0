"""Geometry that no positioning pipeline can work with."""

import math
from collections.abc import Iterator
from itertools import combinations

import numpy as np

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.site.model import Point2, SiteNode, Wall
from echofuse.site.tables import Problems

__all__ = ["check_area", "check_around", "check_before_wall", "check_nodes"]

SAME_PLACE_M = 1e-3
#: Of the cross, along x and z: where each receiver stands beside the transmitter, in the order of the nodes.
CROSS = ((-1, 0, "left of"), (1, 0, "right of"), (0, -1, "below"), (0, 1, "above"))
ON_A_LINE_M = 1e-2  # greatest distance of a node from the line through all of them
FAR_AWAY_DIAGONALS = 2.0  # a node that far outside the area is a mistake, most likely of units


def check_area(area: tuple[Point2, ...], problems: Problems) -> None:
    """Report an area without content."""
    x, y = np.array(area, np.float64).T
    doubled = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    if abs(doubled) < 2e-6:
        problems.add("site.area", "a polygon with an area above 0 m^2")


def check_nodes(nodes: tuple[SiteNode, ...], area: tuple[Point2, ...], problems: Problems) -> None:
    """Report nodes that are doubled, in one place, or far from the area."""
    for (i, one), (j, other) in combinations(enumerate(nodes, start=1), 2):
        if one.id == other.id:
            problems.add(f"node[{j}].id", f"an id of its own (node[{i}] has it too)", other.id)
        if one.name == other.name:
            problems.add(f"node[{j}].name", f"a name of its own (node[{i}] has it too)", other.name)
        if _apart(one, other) < SAME_PLACE_M:
            problems.add(
                f"node[{j}].rx_position_m",
                f"a place of its own: {one.name} has the same Tx and Rx",
                other.name,
            )
    for i, node in enumerate(nodes, start=1):
        for key, position in (("tx_position_m", node.tx_position_m), ("rx_position_m", node.rx_position_m)):
            if _is_far(position[:2], area):
                problems.add(f"node[{i}].{key}", "a position near the area, in metres", list(position))


def check_around(nodes: tuple[SiteNode, ...], problems: Problems) -> None:
    """Report nodes around an area that all stand on one line."""
    if _spread_m(nodes) < ON_A_LINE_M:
        problems.add(
            "node", "nodes that do not all stand on one line", "a line: both sides of it look the same"
        )


def check_before_wall(
    nodes: tuple[SiteNode, ...],
    area: tuple[Point2, ...],
    wall: Wall | None,
    blind_zone_s: float,
    problems: Problems,
    *,
    dimension: int,
) -> None:
    """Report what is not one transmitter with receivers beside it, before a wall, before the area.

    blind_zone_s: after the cross-talk; echoes that begin within are not reported. dimension: receivers on a
    line along x tell positions in the plane (2), four in a cross those in space (3).
    """
    tx_y = nodes[0].tx_position_m[1]
    before = len(problems.lines)
    (_check_cross if dimension == 3 else _check_line)(nodes, problems)
    if wall is None:
        problems.add("site.wall", "a table with thickness_m and relative_permittivity", "nothing")
        return
    nearest_y = min(y for _, y in area)
    if nearest_y <= tx_y + wall.thickness_m:
        expected = f"an area behind the wall: y above {tx_y + wall.thickness_m:g}, antennas and thickness"
        problems.add("site.area", expected, f"y = {nearest_y:g}")
    if len(problems.lines) > before:
        return
    depth_m = min(_nearest_depth_m(node, wall, blind_zone_s) for node in nodes)
    if depth_m <= wall.thickness_m:
        expected = f"a wall before the nearest range: blind_zone_s = {blind_zone_s:g} ends at {depth_m:.2f} m"
        problems.add("site.wall.thickness_m", expected, wall.thickness_m)


def _check_line(nodes: tuple[SiteNode, ...], problems: Problems) -> None:
    """Report what is not one transmitter with receivers on a line along x."""
    tx_x, tx_y, tx_z = nodes[0].tx_position_m
    for i, node in _with_one_transmitter(nodes, problems):
        rx_x, rx_y, rx_z = node.rx_position_m
        if max(abs(rx_y - tx_y), abs(rx_z - tx_z)) > ON_A_LINE_M or abs(rx_x - tx_x) < ON_A_LINE_M:
            expected = f"a place beside the transmitter, along x: y = {tx_y:g}, z = {tx_z:g}"
            problems.add(f"node[{i}].rx_position_m", expected, list(node.rx_position_m))


def _check_cross(nodes: tuple[SiteNode, ...], problems: Problems) -> None:
    """Report what is not one transmitter in the middle of a cross: nodes left, right, below and above."""
    tx_x, tx_y, tx_z = nodes[0].tx_position_m
    spacing_m = tx_x - nodes[0].rx_position_m[0]
    if spacing_m < ON_A_LINE_M:
        expected = f"a place left of the transmitter: x below {tx_x:g}, y = {tx_y:g}, z = {tx_z:g}"
        problems.add("node[1].rx_position_m", expected, list(nodes[0].rx_position_m))
        return
    for i, node in _with_one_transmitter(nodes, problems):
        along, up, where = CROSS[i - 1]
        place_m = (tx_x + along * spacing_m, tx_y, tx_z + up * spacing_m)
        if math.dist(node.rx_position_m, place_m) > SAME_PLACE_M:
            at = [round(value, 6) for value in place_m]
            expected = f"{at}, {where} the transmitter as far as node[1] is left of it"
            problems.add(f"node[{i}].rx_position_m", expected, list(node.rx_position_m))


def _with_one_transmitter(nodes: tuple[SiteNode, ...], problems: Problems) -> Iterator[tuple[int, SiteNode]]:
    """Yield the nodes from 1 on that listen to the first one's transmitter, and report the others."""
    tx_m = nodes[0].tx_position_m
    for i, node in enumerate(nodes, start=1):
        if math.dist(node.tx_position_m, tx_m) > SAME_PLACE_M:
            expected = f"{list(tx_m)}, the transmitter of node[1]: all receivers listen to one"
            problems.add(f"node[{i}].tx_position_m", expected, list(node.tx_position_m))
        else:
            yield i, node


def _nearest_depth_m(node: SiteNode, wall: Wall, blind_zone_s: float) -> float:
    """Return how deep the nearest echo that a node reports lies, straight between its antennas."""
    baseline_m = math.dist(node.tx_position_m, node.rx_position_m)
    excess_m = wall.thickness_m * (math.sqrt(wall.relative_permittivity) - 1.0)
    path_m = baseline_m + SPEED_OF_LIGHT_MPS * blind_zone_s - 2.0 * excess_m
    return math.sqrt(max(path_m, baseline_m) ** 2 - baseline_m**2) / 2.0


def _apart(one: SiteNode, other: SiteNode) -> float:
    return max(
        math.dist(one.tx_position_m, other.tx_position_m), math.dist(one.rx_position_m, other.rx_position_m)
    )


def _spread_m(nodes: tuple[SiteNode, ...]) -> float:
    """Greatest distance of an antenna from the line that fits all antennas best, in the plane."""
    points = np.array(
        [position[:2] for node in nodes for position in (node.tx_position_m, node.rx_position_m)]
    )
    centred = points - points.mean(axis=0)
    across = np.linalg.svd(centred)[2][1]
    return float(np.max(np.abs(centred @ across)))


def _is_far(point: Point2, area: tuple[Point2, ...]) -> bool:
    vertices = np.array(area)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    outside = np.maximum(0.0, np.maximum(low - point, point - high))
    return bool(np.linalg.norm(outside) > FAR_AWAY_DIAGONALS * np.linalg.norm(high - low))
