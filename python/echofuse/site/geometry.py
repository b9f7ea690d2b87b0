"""Geometry that no positioning pipeline can work with."""

import math
from itertools import combinations

import numpy as np

from echofuse.site.model import Point2, SiteNode
from echofuse.site.tables import Problems

__all__ = ["check_area", "check_nodes"]

SAME_PLACE_M = 1e-3
ON_A_LINE_M = 1e-2  # greatest distance of a node from the line through all of them
FAR_AWAY_DIAGONALS = 2.0  # a node that far outside the area is a mistake, most likely of units


def check_area(area: tuple[Point2, ...], problems: Problems) -> None:
    """Report an area without content."""
    x, y = np.array(area, np.float64).T
    doubled = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    if abs(doubled) < 2e-6:
        problems.add("site.area", "a polygon with an area above 0 m^2")


def check_nodes(
    nodes: tuple[SiteNode, ...], area: tuple[Point2, ...], least: int, problems: Problems
) -> None:
    """Report nodes that are too few, doubled, in one place, on one line, or far from the area."""
    if len(nodes) < least:
        problems.add("node", f"at least {least} nodes, the fewest that locate a person", f"{len(nodes)}")
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
    if len(nodes) >= least and _spread_m(nodes) < ON_A_LINE_M:
        problems.add(
            "node", "nodes that do not all stand on one line", "a line: both sides of it look the same"
        )
    for i, node in enumerate(nodes, start=1):
        for key, position in (("tx_position_m", node.tx_position_m), ("rx_position_m", node.rx_position_m)):
            if _is_far(position[:2], area):
                problems.add(f"node[{i}].{key}", "a position near the area, in metres", list(position))


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
