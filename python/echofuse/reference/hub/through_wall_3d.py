"""The hub of the pipeline `through_wall_3d`: reports in, tracks in space out (Taylor-series paper)."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.reference.estimation.assignment import assign, assignment_margin
from echofuse.reference.hub.locate.planar_3d import along_axis, planar_3d
from echofuse.reference.hub.locate.taylor_3d import Taylor3dConfig, taylor_3d
from echofuse.reference.hub.locate.wall import normal_excess_m
from echofuse.reference.hub.measure.trace_pairing import Couple
from echofuse.reference.hub.path_hub import OpenFrame, PathHub, PathHubConfig, Target

Array = NDArray[np.float64]

ALONG, UP = (0, 1), (2, 3)  # receivers on x and on z


class Point3(Protocol):
    x_m: float
    y_m: float
    z_m: float


class NodeSite3d(Protocol):
    node_id: int
    tx: Point3
    rx: Point3


class Box(Protocol):
    min_x_m: float
    min_y_m: float
    min_z_m: float
    max_x_m: float
    max_y_m: float
    max_z_m: float


class ThroughWall3dHubConfig(PathHubConfig, Protocol):
    nodes: list[NodeSite3d]
    n_nodes: int
    area: Box
    range_difference_m: float
    taylor_3d: Taylor3dConfig
    path_std_m: float


def as_array(point: Point3) -> Array:
    """Return a point as (3,) [m]."""
    return np.array([point.x_m, point.y_m, point.z_m])


class ThroughWall3dHub(PathHub):
    """A cross of receivers: couples of both axes that say the same distance are located in space."""

    def __init__(self, config: ThroughWall3dHubConfig, max_points: int, max_tracks: int) -> None:
        self.config = config
        area, tx_m = config.area, as_array(config.nodes[0].tx)
        arms_m = np.array([as_array(node.rx) for node in config.nodes]) - tx_m
        self.spacing_m = float(np.mean(np.abs([arms_m[0, 0], arms_m[1, 0], arms_m[2, 2], arms_m[3, 2]])))
        x, z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
        self.rx_m = self.spacing_m * np.array([-x, x, -z, z])
        super().__init__(
            config,
            config.taylor_3d.wall,
            [node.node_id for node in config.nodes],
            tx_m,
            self.rx_m,
            np.array([area.min_x_m, area.min_y_m, area.min_z_m, area.max_x_m, area.max_y_m, area.max_z_m]),
            max_points=max_points,
            max_tracks=max_tracks,
        )
        self.pairings = [self.trace_pairing(2.0 * self.spacing_m) for _ in (ALONG, UP)]
        self.quads = self.clipped = 0

    def find_targets(self, frame: OpenFrame) -> None:
        """Pair traces on each axis, couples over both, and locate these."""
        config, couples = self.config, []
        for pairing, receivers in zip(self.pairings, (ALONG, UP), strict=True):
            paired = pairing.process(*(frame.free_delays(r) for r in receivers))
            frame.decide("points", paired.margin)
            couples.append(paired.couples[: self.max_points])
        variance_m2 = np.full(4, config.path_std_m**2)
        for along, up in self._quads(frame, *couples)[: self.max_points]:
            self.quads += 1
            target = Target(frame, config.trace_pairing)
            target.take(along, ALONG)
            target.take(up, UP)
            self._note_start(frame, target.path_m)
            fix = taylor_3d(config.taylor_3d, np.zeros(3), self.rx_m, target.path_m, variance_m2, np.zeros(3))
            frame.decide("points", fix.margin)
            if fix.status != "singular":
                self.keep(frame, target, fix.position_m, fix.covariance_m2)

    def _range_m(self, couple: Couple) -> float:
        """Distance from the transmitter that a couple says [m]."""
        path_m = SPEED_OF_LIGHT_MPS * np.array(couple.delay_s)
        excess_m = 2.0 * normal_excess_m(self.config.taylor_3d.wall)
        return along_axis(path_m - excess_m, self.spacing_m)[1]

    def _quads(self, frame: OpenFrame, along: list[Couple], up: list[Couple]) -> list[tuple[Couple, Couple]]:
        """Pair couples of both axes that say the same distance: all, or at the least total difference."""
        limit = self.config.range_difference_m
        apart = np.abs(np.subtract.outer([self._range_m(c) for c in along], [self._range_m(c) for c in up]))
        if apart.size == 0:
            return []
        frame.decide("points", float(np.min(np.abs(apart / limit - 1.0))))
        if self.config.trace_pairing.rule == "all_pairs":
            return [(along[i], up[k]) for i, k in np.argwhere(apart <= limit)]
        cap = 2.0 * limit
        cost = np.where(apart <= limit, apart, cap)
        column = assign(cost)
        frame.decide("points", assignment_margin(cost, column, np.full(len(along), cap)))
        return [(along[i], up[k]) for i, k in enumerate(column) if k >= 0 and cost[i, k] < cap]

    def _note_start(self, frame: OpenFrame, path_m: Array) -> None:
        excess_m = 2.0 * normal_excess_m(self.config.taylor_3d.wall)
        start = planar_3d(self.config.taylor_3d.start, self.spacing_m, path_m - excess_m)
        frame.decide("points", start.margin)
        self.clipped += start.status == "clipped"
