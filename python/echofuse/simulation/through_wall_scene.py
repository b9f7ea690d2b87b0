"""The through-wall paper's case study: antennas, wall, classroom, walkers (docs/through_wall.md)."""

from __future__ import annotations

from dataclasses import dataclass, field

from echofuse.simulation.m_sequence import MSequenceRadar
from echofuse.simulation.people import Person, walkers
from echofuse.simulation.scene import Furniture, Point, RadarNode, Room, rough_walls
from echofuse.simulation.walk import Walk
from echofuse.simulation.wall import Wall


@dataclass(frozen=True, kw_only=True)
class ThroughWallScene:
    """Everything but the people. The antennas stand before the wall, at lower y; the room is behind it."""

    name: str
    nodes: tuple[RadarNode, ...]  # the receivers; all listen to one transmitter
    room: Room  # inside; its front wall is the slab and reflects nothing more
    wall: Wall = field(default_factory=Wall)
    radar: MSequenceRadar = field(default_factory=MSequenceRadar)
    furniture: tuple[Furniture, ...] = ()

    def __post_init__(self) -> None:
        ids = [node.node_id for node in self.nodes]
        if not ids or len(set(ids)) != len(ids):
            raise ValueError("ThroughWallScene.nodes: at least one node, each with a node_id of its own")
        if len({node.tx_position_m for node in self.nodes}) != 1:
            raise ValueError("ThroughWallScene.nodes: expected one transmitter for all")
        for node in self.nodes:
            if not max(node.tx_position_m[1], node.rx_position_m[1]) < self.wall.front_m:
                raise ValueError(f"ThroughWallScene.nodes: {node.name} does not stand before the wall")
            if not node.baseline_m > 0.0:
                raise ValueError(f"ThroughWallScene.nodes: {node.name} stands on the transmitter")
        if self.room.lower_m[1] < self.wall.back_m or self.room.wall_reflections[2] != 0.0:
            raise ValueError(
                "ThroughWallScene.room: expected behind the wall, and its front wall to reflect nothing"
            )
        for piece in self.furniture:
            if piece.position_m[1] < self.wall.back_m:
                raise ValueError(f"ThroughWallScene.furniture: {piece.position_m} is not behind the wall")

    @property
    def scan_period_s(self) -> float:
        return self.radar.response_period_s

    def holds(self, person: Person) -> bool:
        """Whether a person's whole walk keeps the torso between the walls, and soles and head in the room."""
        (left, front, floor), (right, back, ceiling) = self.room.lower_m, self.room.upper_m
        margin_m = person.radius_m
        for point in person.walk.waypoints_m:
            ground_m = point[2] if person.walk.rises else 0.0
            if not (
                left + margin_m <= point[0] <= right - margin_m
                and front + margin_m <= point[1] <= back - margin_m
                and floor <= ground_m <= ceiling - person.height_m
            ):
                return False
        return True


ANTENNA_HEIGHT_M = 1.2  # the device before somebody's chest
ROOM_WIDTH_M, ROOM_DEPTH_M, ROOM_HEIGHT_M = 4.7, 5.62, 3.0
AISLE_M = 1.65 / 2.0  # from the middle of the room to either aisle between the tables
NEAR_M, FAR_M = 1.6, 1.6 + 3.8  # ends of both aisles

# left, right, front (the slab itself), back; plaster on brick, floor and ceiling of concrete.
WALL_REFLECTIONS = (-0.35, -0.35, 0.0, -0.45)
FLOOR_REFLECTION, CEILING_REFLECTION = -0.3, -0.25
ROUGH_WALL_SCATTERERS, ROUGH_WALL_RCS_M2, ROUGH_WALL_SEED = 60, 0.02, 403
# Tables and chairs beside the aisles, a cupboard and a board at the far wall: (x, y from the wall, z, rcs).
CLASSROOM = (
    (0.0, 0.9, 0.7, 0.08),
    (0.2, 2.1, 0.7, 0.10),
    (-0.1, 3.3, 0.7, 0.10),
    (0.1, 4.4, 0.8, 0.15),
    (-1.4, 1.2, 0.7, 0.08),
    (-1.3, 2.6, 0.7, 0.10),
    (-1.5, 3.9, 0.7, 0.10),
    (1.3, 1.4, 0.7, 0.08),
    (1.4, 2.7, 0.7, 0.10),
    (1.5, 4.0, 0.8, 0.12),
    (-2.0, 5.3, 1.0, 0.50),
    (1.2, 5.5, 1.3, 0.30),
)


def antenna_cross(tx_m: Point, spacing_m: float, n_receivers: int) -> tuple[RadarNode, ...]:
    """Receivers around one transmitter: rx1 left, rx2 right, and of four also rx3 below and rx4 above."""
    if n_receivers not in (2, 4):
        raise ValueError(f"n_receivers: {n_receivers}, expected 2 or 4")
    if not spacing_m > 0.0:
        raise ValueError(f"spacing_m: {spacing_m}, expected a positive distance")
    x, y, z = tx_m
    arms = ((-spacing_m, 0.0), (spacing_m, 0.0), (0.0, -spacing_m), (0.0, spacing_m))[:n_receivers]
    return tuple(
        RadarNode(name=f"rx{index}", node_id=index, tx_position_m=tx_m, rx_position_m=(x + right, y, z + up))
        for index, (right, up) in enumerate(arms, start=1)
    )


def through_wall_scene(
    *,
    n_receivers: int = 2,
    spacing_m: float = 0.4,
    order: int = 9,
    clock_hz: float = 4.5e9,
    response_period_s: float = 0.074,
    wall: Wall | None = None,
) -> ThroughWallScene:
    """The paper's classroom behind a wall, Tx at (0, 0): two receivers at its sides, or a cross of four.

    For receivers anywhere else before the wall, replace `nodes`.
    """
    wall = wall or Wall()
    nodes = antenna_cross((0.0, 0.0, ANTENNA_HEIGHT_M), spacing_m, n_receivers)
    half_m, front_m = ROOM_WIDTH_M / 2.0, wall.back_m
    room = Room(
        lower_m=(-half_m, front_m, 0.0),
        upper_m=(half_m, front_m + ROOM_DEPTH_M, ROOM_HEIGHT_M),
        wall_reflections=WALL_REFLECTIONS,
        floor_reflection=FLOOR_REFLECTION,
        ceiling_reflection=CEILING_REFLECTION,
    )
    tables = tuple(Furniture(position_m=(x, front_m + y, z), rcs_m2=rcs_m2) for x, y, z, rcs_m2 in CLASSROOM)
    return ThroughWallScene(
        name="through-wall",
        nodes=nodes,
        room=room,
        wall=wall,
        radar=MSequenceRadar(order=order, clock_hz=clock_hz, response_period_s=response_period_s),
        furniture=tables + rough_walls(room, ROUGH_WALL_SCATTERERS, ROUGH_WALL_RCS_M2, ROUGH_WALL_SEED),
    )


# Pos. 1 to Pos. 2 and back, Pos. 3 to Pos. 4 and back; then two along the side walls.
CASE_STUDY_WALKS = (
    Walk(waypoints_m=((-AISLE_M, NEAR_M), (-AISLE_M, FAR_M)), speed_mps=1.0),
    Walk(waypoints_m=((AISLE_M, FAR_M), (AISLE_M, NEAR_M)), speed_mps=1.1),
    Walk(waypoints_m=((-1.9, 2.0), (-1.9, 5.2)), speed_mps=0.8),
    Walk(waypoints_m=((1.9, 4.9), (1.9, 1.4)), speed_mps=0.9),
)
CASE_STUDY_HEIGHTS_M = (1.82, 1.76, 1.68, 1.90)
CASE_STUDY_DURATION_S = 60.0
BODY_RADIUS_M = 0.2  # torso of 32 cm by 48 cm, a stride of 70 cm: the paper's 30 cm by 70 cm


def case_study_walkers(count: int = 2) -> tuple[Person, ...]:
    """The paper's two people, or up to two more, all walking throughout."""
    return walkers(CASE_STUDY_WALKS, CASE_STUDY_HEIGHTS_M, count, radius_m=BODY_RADIUS_M)
