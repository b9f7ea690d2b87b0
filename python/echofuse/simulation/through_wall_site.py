"""A scene around any through-wall site: its antennas, its wall, and its area as an empty room behind it."""

from dataclasses import replace

from echofuse.simulation.m_sequence import MSequenceRadar
from echofuse.simulation.people import Person
from echofuse.simulation.scene import Point, RadarNode, Room, rough_walls
from echofuse.simulation.stairs import RADAR as STAIRS_RADAR
from echofuse.simulation.through_wall_scene import (
    ANTENNA_HEIGHT_M,
    BODY_RADIUS_M,
    CEILING_REFLECTION,
    FLOOR_REFLECTION,
    ROOM_HEIGHT_M,
    ROUGH_WALL_RCS_M2,
    ROUGH_WALL_SCATTERERS,
    ROUGH_WALL_SEED,
    WALL_REFLECTIONS,
    ThroughWallScene,
    case_study_walkers,
    through_wall_scene,
)
from echofuse.simulation.wall import Wall
from echofuse.site import Site

__all__ = ["site_scene_behind_wall", "site_walkers_behind_wall"]


def site_scene_behind_wall(site: Site) -> ThroughWallScene:
    """Return a site's antennas, wall and room, with the case study's radio and plaster.

    The site does not say where the wall stands: it ends where the area begins. In the plane a height of 0
    stands for one not given and becomes that of the case study's device. A site in space has the radio of the
    case study in space, and the room is its box.
    """
    assert site.wall is not None, "the loader has seen to it"
    x_min, y_min, x_max, y_max = site.bounds_m
    in_space = site.heights_m is not None
    z_min, z_max = site.heights_m or (0.0, ROOM_HEIGHT_M)
    lift_m = 0.0 if in_space or site.nodes[0].tx_position_m[2] else ANTENNA_HEIGHT_M
    wall = Wall(
        front_m=y_min - site.wall.thickness_m,
        thickness_m=site.wall.thickness_m,
        permittivity=site.wall.relative_permittivity,
    )
    room = Room(
        lower_m=(x_min, wall.back_m, z_min),
        upper_m=(x_max, y_max, z_max),
        wall_reflections=WALL_REFLECTIONS,
        floor_reflection=FLOOR_REFLECTION,
        ceiling_reflection=CEILING_REFLECTION,
    )
    nodes = tuple(
        RadarNode(
            name=node.name,
            node_id=node.id,
            tx_position_m=_lifted(site.nodes[0].tx_position_m, lift_m),
            rx_position_m=_lifted(node.rx_position_m, lift_m),
        )
        for node in site.nodes
    )
    return ThroughWallScene(
        name=site.name,
        nodes=nodes,
        room=room,
        wall=wall,
        radar=STAIRS_RADAR if in_space else MSequenceRadar(),
        furniture=rough_walls(room, ROUGH_WALL_SCATTERERS, ROUGH_WALL_RCS_M2, ROUGH_WALL_SEED),
    )


def site_walkers_behind_wall(scene: ThroughWallScene, count: int) -> tuple[Person, ...]:
    """Return the case study's people on the floor, their walks stretched from its room to the scene's.

    They keep their pace.
    """
    model, room = through_wall_scene().room, scene.room
    floor_m = room.lower_m[2]

    def stretched(point_m: tuple[float, ...]) -> tuple[float, ...]:
        x, y = (_stretched(point_m[axis], model, room, axis) for axis in (0, 1))
        return (x, y, floor_m) if floor_m else (x, y)

    return tuple(
        replace(
            person,
            walk=replace(person.walk, waypoints_m=tuple(stretched(at_m) for at_m in person.walk.waypoints_m)),
        )
        for person in case_study_walkers(count)
    )


def _lifted(position_m: Point, by_m: float) -> Point:
    x, y, z = position_m
    return x, y, z + by_m


def _stretched(value_m: float, model: Room, room: Room, axis: int) -> float:
    """Return where a coordinate lies between a room's walls, a body's radius from each, in another room."""
    (low, high), (to_low, to_high) = (
        (of.lower_m[axis] + BODY_RADIUS_M, of.upper_m[axis] - BODY_RADIUS_M) for of in (model, room)
    )
    return to_low + (value_m - low) / (high - low) * (to_high - to_low)
