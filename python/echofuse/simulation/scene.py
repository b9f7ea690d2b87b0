"""What stands still: room, furniture, nodes, and the radio they share. Metres, seconds, hertz, watts."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.simulation.radio import Pulse, Radio

Point = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class Surface:
    """A wall, floor or ceiling: the plane where coordinate `axis` (0 = x, 1 = y, 2 = z) is `offset_m`."""

    name: str
    axis: int
    offset_m: float
    reflection: float  # amplitude coefficient [1], negative: the echo is turned over


@dataclass(frozen=True, kw_only=True)
class Room:
    """A box. A reflection of 0 takes that surface away."""

    lower_m: Point
    upper_m: Point
    wall_reflections: tuple[float, float, float, float]  # left, right, front (low y), back (high y) [1]
    floor_reflection: float = 0.0
    ceiling_reflection: float = 0.0

    def surfaces(self) -> tuple[Surface, ...]:
        """The surfaces that reflect."""
        left, right, front, back = self.wall_reflections
        every = (
            Surface(name="left", axis=0, offset_m=self.lower_m[0], reflection=left),
            Surface(name="right", axis=0, offset_m=self.upper_m[0], reflection=right),
            Surface(name="front", axis=1, offset_m=self.lower_m[1], reflection=front),
            Surface(name="back", axis=1, offset_m=self.upper_m[1], reflection=back),
            Surface(name="floor", axis=2, offset_m=self.lower_m[2], reflection=self.floor_reflection),
            Surface(name="ceiling", axis=2, offset_m=self.upper_m[2], reflection=self.ceiling_reflection),
        )
        return tuple(surface for surface in every if surface.reflection != 0.0)


@dataclass(frozen=True, kw_only=True)
class Furniture:
    """A static point scatterer."""

    position_m: Point
    rcs_m2: float


@dataclass(frozen=True, kw_only=True)
class RadarNode:
    """A receiver and the transmitter that it listens to: shared (bistatic) or its own (monostatic)."""

    name: str
    node_id: int
    tx_position_m: Point
    rx_position_m: Point

    @property
    def baseline_m(self) -> float:
        return math.dist(self.tx_position_m, self.rx_position_m)


@dataclass(frozen=True, kw_only=True)
class Scene:
    """Everything but the people."""

    name: str
    area_lower_m: tuple[float, float]
    area_upper_m: tuple[float, float]
    room: Room
    nodes: tuple[RadarNode, ...]
    furniture: tuple[Furniture, ...] = ()
    pulse: Pulse = field(default_factory=Pulse)
    radio: Radio = field(default_factory=Radio)
    scan_period_s: float = 0.1

    def __post_init__(self) -> None:
        ids = [node.node_id for node in self.nodes]
        if not ids or len(set(ids)) != len(ids):
            raise ValueError("Scene.nodes: at least one node, each with a node_id of its own")
        for node in self.nodes:
            if not (self.encloses(node.tx_position_m) and self.encloses(node.rx_position_m)):
                raise ValueError(f"Scene.nodes: {node.name} stands outside the room")
        if not self.scan_period_s > self.radio.scan_duration_s * len(self.transmitters()):
            raise ValueError(
                "Scene.scan_period_s: too short for the scans of all transmitters, one after another"
            )

    def encloses(self, point_m: Point) -> bool:
        """Whether a point lies inside the room."""
        sides = zip(self.room.lower_m, point_m, self.room.upper_m, strict=True)
        return all(low < value < high for low, value, high in sides)

    def transmitters(self) -> tuple[Point, ...]:
        """The different transmitters; they take turns, so their order is their place in the frame."""
        return tuple(sorted({node.tx_position_m for node in self.nodes}))

    def first_sample_s(self, node: RadarNode) -> float:
        """Delay of sample 0 after transmission: the receiver locks on the direct path and keeps its place."""
        return node.baseline_m / SPEED_OF_LIGHT_MPS - self.radio.direct_path_at_s

    def wavelength_m(self) -> float:
        return SPEED_OF_LIGHT_MPS / self.pulse.centre_hz


NODE_HEIGHT_M = 1.0  # tripods
CASE_STUDY_TX_M = (5.75, 0.0, NODE_HEIGHT_M)  # middle of the front side
CASE_STUDY_RX_M = (
    (0.0, 1.5, NODE_HEIGHT_M),
    (1.9, 6.0, NODE_HEIGHT_M),
    (5.75, 6.0, NODE_HEIGHT_M),
    (9.6, 6.0, NODE_HEIGHT_M),
    (11.5, 4.5, NODE_HEIGHT_M),
    (11.5, 1.0, NODE_HEIGHT_M),
)
MONOSTATIC_ANTENNA_SPACING_M = 0.3  # the two antenna ports of one module

# The room of the case study around its 11.5 m x 6 m area: 1.2 to 1.6 m of free floor, plaster walls.
CASE_STUDY_ROOM = Room(
    lower_m=(-1.4, -1.2, 0.0),
    upper_m=(13.1, 7.4, 3.0),
    wall_reflections=(-0.45, -0.40, -0.35, -0.45),
    floor_reflection=-0.3,
    ceiling_reflection=-0.25,
)
# Cupboards, radiators, screens and a door frame, between the area and the walls, as (x, y, z, rcs).
CASE_STUDY_FURNITURE = tuple(
    Furniture(position_m=(x, y, z), rcs_m2=rcs)
    for x, y, z, rcs in (
        (-1.1, 0.2, 0.9, 0.30),
        (-1.0, 3.1, 0.7, 0.50),
        (-0.9, 6.7, 1.4, 0.20),
        (2.6, 7.1, 0.8, 0.40),
        (4.4, -0.9, 0.6, 0.10),
        (7.4, 7.0, 1.2, 0.60),
        (8.1, -1.0, 0.9, 0.25),
        (10.9, 6.8, 0.7, 0.30),
        (12.4, 5.6, 1.5, 0.15),
        (12.8, 2.7, 0.8, 0.50),
        (12.2, -0.7, 1.1, 0.35),
        (1.3, -0.8, 1.3, 0.15),
    )
)


ROUGH_WALL_SCATTERERS = 80
ROUGH_WALL_RCS_M2 = 0.02  # mean, exponential: sockets, frames, joints
ROUGH_WALL_SEED = 410  # the room is the same in every run


def rough_walls(room: Room, count: int, mean_rcs_m2: float, seed: int) -> tuple[Furniture, ...]:
    """Weak point scatterers all over the walls: the diffuse part of the empty room's echo."""
    rng = np.random.default_rng(seed)
    (left, front, floor), (right, back, ceiling) = room.lower_m, room.upper_m
    width, depth = right - left, back - front
    points = []
    for along, height, rcs in zip(
        rng.uniform(0.0, 2.0 * (width + depth), count),
        rng.uniform(floor + 0.1, ceiling - 0.1, count),
        rng.exponential(mean_rcs_m2, count),
        strict=True,
    ):
        if along < 2.0 * width:
            at = (left + along % width, front if along < width else back, height)
        else:
            rest = along - 2.0 * width
            at = (left if rest < depth else right, front + rest % depth, height)
        points.append(Furniture(position_m=at, rcs_m2=float(rcs)))
    return tuple(points)


def sensor_radar_scene(*, monostatic: bool = False) -> Scene:
    """The case study: 11.5 m x 6 m, one Tx and six Rx at the sides, or six monostatic nodes there."""
    nodes = []
    for index, rx_m in enumerate(CASE_STUDY_RX_M, start=1):
        along_y = rx_m[0] in (0.0, 11.5)
        step = MONOSTATIC_ANTENNA_SPACING_M
        own_tx_m = (rx_m[0], rx_m[1] - step, rx_m[2]) if along_y else (rx_m[0] - step, rx_m[1], rx_m[2])
        tx_m = own_tx_m if monostatic else CASE_STUDY_TX_M
        nodes.append(RadarNode(name=f"rx{index}", node_id=index, tx_position_m=tx_m, rx_position_m=rx_m))
    return Scene(
        name="sensor-radar",
        area_lower_m=(0.0, 0.0),
        area_upper_m=(11.5, 6.0),
        room=CASE_STUDY_ROOM,
        nodes=tuple(nodes),
        furniture=CASE_STUDY_FURNITURE
        + rough_walls(CASE_STUDY_ROOM, ROUGH_WALL_SCATTERERS, ROUGH_WALL_RCS_M2, ROUGH_WALL_SEED),
    )
