"""A scene around any site: its nodes in a plain room, and people who walk through its area."""

import math
from dataclasses import replace

from echofuse.simulation.people import Person
from echofuse.simulation.scene import (
    NODE_HEIGHT_M,
    ROUGH_WALL_RCS_M2,
    ROUGH_WALL_SCATTERERS,
    ROUGH_WALL_SEED,
    Point,
    RadarNode,
    Room,
    Scene,
    rough_walls,
    sensor_radar_scene,
)
from echofuse.simulation.sensor_radar import case_study_people
from echofuse.site import Site

FREE_FLOOR_M = 1.3  # between the outermost node or the area, and the walls
LEAST_ANTENNA_SPACING_M = 0.1  # of a node that sends and receives in one place


def site_scene(site: Site) -> Scene:
    """Return the site's nodes in a room of its own size, with the case study's walls and radio.

    A height of 0 stands for one not given and becomes that of a tripod.
    """
    x_min, y_min, x_max, y_max = site.bounds_m
    nodes = tuple(
        RadarNode(
            name=node.name,
            node_id=node.id,
            tx_position_m=_apart(_on_tripod(node.tx_position_m), _on_tripod(node.rx_position_m)),
            rx_position_m=_on_tripod(node.rx_position_m),
        )
        for node in site.nodes
    )
    points = [point for node in nodes for point in (node.tx_position_m, node.rx_position_m)]
    xs, ys = [x_min, x_max, *(x for x, _, _ in points)], [y_min, y_max, *(y for _, y, _ in points)]
    model = sensor_radar_scene()
    room = Room(
        lower_m=(min(xs) - FREE_FLOOR_M, min(ys) - FREE_FLOOR_M, 0.0),
        upper_m=(max(xs) + FREE_FLOOR_M, max(ys) + FREE_FLOOR_M, model.room.upper_m[2]),
        wall_reflections=model.room.wall_reflections,
        floor_reflection=model.room.floor_reflection,
        ceiling_reflection=model.room.ceiling_reflection,
    )
    return Scene(
        name=site.name,
        area_lower_m=(x_min, y_min),
        area_upper_m=(x_max, y_max),
        room=room,
        nodes=nodes,
        furniture=rough_walls(room, ROUGH_WALL_SCATTERERS, ROUGH_WALL_RCS_M2, ROUGH_WALL_SEED),
    )


def site_people(scene: Scene, count: int) -> tuple[Person, ...]:
    """Return the case study's people, their walks stretched from its area to the scene's, their pace kept."""
    model = sensor_radar_scene()

    def stretched(point_m: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(
            low + (value - model_low) / (model_high - model_low) * (high - low)
            for value, model_low, model_high, low, high in zip(
                point_m,
                model.area_lower_m,
                model.area_upper_m,
                scene.area_lower_m,
                scene.area_upper_m,
                strict=True,
            )
        )

    return tuple(
        replace(
            person,
            walk=replace(
                person.walk, waypoints_m=tuple(stretched(point_m) for point_m in person.walk.waypoints_m)
            ),
        )
        for person in case_study_people(count)
    )


def _on_tripod(point_m: Point) -> Point:
    x, y, z = point_m
    return (x, y, z if z != 0.0 else NODE_HEIGHT_M)


def _apart(tx_m: Point, rx_m: Point) -> Point:
    if math.dist(tx_m, rx_m) >= LEAST_ANTENNA_SPACING_M:
        return tx_m
    return (rx_m[0] - LEAST_ANTENNA_SPACING_M, rx_m[1], rx_m[2])
