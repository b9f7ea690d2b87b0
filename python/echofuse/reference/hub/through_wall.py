"""The hub of the pipeline `through_wall_2d`: reports in, tracks out (through-wall paper, section 3)."""

from typing import Protocol

import numpy as np

from echofuse.reference.hub.hub import Area, NodeSite
from echofuse.reference.hub.locate.line_locator import (
    LineFix,
    LineLocatorConfig,
    locate_on_line,
    path_and_gradient,
)
from echofuse.reference.hub.path_hub import OpenFrame, PathHub, PathHubConfig, Target

BETWEEN_DEVIATIONS = 3.0  # of a further receiver's path from what a couple predicts


class ThroughWallHubConfig(PathHubConfig, Protocol):
    nodes: list[NodeSite]
    n_nodes: int
    area: Area
    line_locator: LineLocatorConfig


class ThroughWallHub(PathHub):
    """Receivers on a line: couples of the two outer ones are located, and explain further traces."""

    def __init__(self, config: ThroughWallHubConfig, max_points: int, max_tracks: int) -> None:
        self.config = config
        nodes, area = config.nodes[: config.n_nodes], config.area
        tx_m = np.array([nodes[0].tx.x_m, nodes[0].tx.y_m])
        self.rx_x_m = np.array([node.rx.x_m for node in nodes]) - tx_m[0]
        self.outer = (int(np.argmin(self.rx_x_m)), int(np.argmax(self.rx_x_m)))
        super().__init__(
            config,
            config.line_locator.wall,
            [node.node_id for node in nodes],
            tx_m,
            np.column_stack([self.rx_x_m, np.zeros(len(nodes))]),
            np.array([area.min_x_m, area.min_y_m, area.max_x_m, area.max_y_m]),
            max_points=max_points,
            max_tracks=max_tracks,
        )
        self.pairing = self.trace_pairing(float(np.ptp(self.rx_x_m)))

    def find_targets(self, frame: OpenFrame) -> None:
        """Pair the traces of the outer receivers, and locate couples."""
        paired = self.pairing.process(*(frame.free_delays(r) for r in self.outer))
        frame.decide("associated", paired.margin)
        frame.decide("points", paired.margin)
        for couple in paired.couples[: self.max_points]:
            target = Target(frame, self.config.trace_pairing)
            target.take(couple, self.outer)
            fix = self._locate(target)
            frame.decide("points", fix.margin)
            if fix.status == "fix":
                self.keep(frame, target, fix.position_m, fix.covariance_m2)

    def _locate(self, target: Target) -> LineFix:
        """Locate a couple, and again with what it explains of further receivers' traces."""
        locator, n = self.config.line_locator, len(self.rx_x_m)
        fix = locate_on_line(locator, self.rx_x_m, target.path_m, target.used)
        if fix.status != "fix" or n == 2:
            return fix
        predicted, gradient = path_and_gradient(locator.wall, fix.position_m, self.rx_x_m)
        for r in range(n):
            if r not in self.outer:
                variance = gradient[r] @ fix.covariance_m2 @ gradient[r] + locator.path_std_m**2
                target.use(r, predicted[r], BETWEEN_DEVIATIONS * float(np.sqrt(variance)))
        return locate_on_line(locator, self.rx_x_m, target.path_m, target.used)
