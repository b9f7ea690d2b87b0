"""The Taylor-series paper's case study: a person climbs stairs behind a brick wall (docs/stairs.md).

The transmitter is the origin; x runs along the wall, y into the stairwell, z up.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from echofuse.recording import Recording
from echofuse.simulation.m_sequence import MSequenceRadar
from echofuse.simulation.people import TORSO_HEIGHTS, Person
from echofuse.simulation.scene import Furniture, Point, Room, rough_walls
from echofuse.simulation.through_wall import simulate_through_wall
from echofuse.simulation.through_wall_scene import (
    BODY_RADIUS_M,
    CEILING_REFLECTION,
    FLOOR_REFLECTION,
    WALL_REFLECTIONS,
    ThroughWallScene,
    antenna_cross,
)
from echofuse.simulation.walk import Walk
from echofuse.simulation.wall import Wall

Array = NDArray[np.float64]

SPACING_M = 0.39
WALL = Wall(front_m=0.05, thickness_m=0.2, loss_db_per_m=21.3)
RADAR = MSequenceRadar(
    order=12,
    clock_hz=7e9,
    response_period_s=0.074,
    lowest_hz=0.7e9,
    antenna_gain_db=6.0,
    noise_count=2.3,
)

RISE_M, RUN_M, STEPS = 0.16, 0.30, 10  # of each of the two flights, which lie side by side
FLIGHT_RISE_M, FLIGHT_RUN_M = RISE_M * STEPS, RUN_M * STEPS
LANDING_M = -1.2  # z of the half-landing, on the antennas' side
FLOOR_M, UPPER_FLOOR_M = LANDING_M - FLIGHT_RISE_M, LANDING_M + FLIGHT_RISE_M
LINE_M = 0.75  # from the middle of the stairwell to the middle of either flight
NEAR_M = WALL.back_m + 0.75  # the middle of the landing
FOOT_M, HEAD_M = WALL.back_m + 1.5 + FLIGHT_RUN_M, WALL.back_m + 1.5  # both ends of a flight
FAR_M = FOOT_M + 1.1
WIDTH_M, DEPTH_M = 2.8, 1.5 + FLIGHT_RUN_M + 1.5
CEILING_M = UPPER_FLOOR_M + 3.0

# P1 to P8 on the ground: up the left flight towards the wall, across the landing, up the right flight.
POINTS_M: tuple[Point, ...] = (
    (-LINE_M, FAR_M, FLOOR_M),
    (-LINE_M, FOOT_M, FLOOR_M),
    (-LINE_M, HEAD_M, LANDING_M),
    (-LINE_M, NEAR_M, LANDING_M),
    (LINE_M, NEAR_M, LANDING_M),
    (LINE_M, HEAD_M, LANDING_M),
    (LINE_M, FOOT_M, UPPER_FLOOR_M),
    (LINE_M, FAR_M, UPPER_FLOOR_M),
)
SPEED_MPS = 0.5  # along the slope: 88 steps a minute
BODY_SIZE_M = (1.0, 1.0, 1.8)  # the paper's cuboid; the person is as tall

STEP_RCS_M2, STEP_SEED = 0.03, 8  # mean, exponential, of either half of a step's edge
ROUGH_WALL_SCATTERERS, ROUGH_WALL_RCS_M2, ROUGH_WALL_SEED = 80, 0.02, 39


def stairs_scene(
    *, spacing_m: float = SPACING_M, response_period_s: float = RADAR.response_period_s
) -> ThroughWallScene:
    """The stairwell behind the wall, and the paper's cross of four receivers before it."""
    room = Room(
        lower_m=(-WIDTH_M / 2.0, WALL.back_m, FLOOR_M),
        upper_m=(WIDTH_M / 2.0, WALL.back_m + DEPTH_M, CEILING_M),
        wall_reflections=WALL_REFLECTIONS,
        floor_reflection=FLOOR_REFLECTION,
        ceiling_reflection=CEILING_REFLECTION,
    )
    return ThroughWallScene(
        name="stairs",
        nodes=antenna_cross((0.0, 0.0, 0.0), spacing_m, 4),
        room=room,
        wall=WALL,
        radar=replace(RADAR, response_period_s=response_period_s),
        furniture=_steps() + rough_walls(room, ROUGH_WALL_SCATTERERS, ROUGH_WALL_RCS_M2, ROUGH_WALL_SEED),
    )


def stairs_climber(*, speed_mps: float = SPEED_MPS) -> Person:
    """From P1 to P8 without a stop, one step of the stairs a step; and back, if there is time."""
    return Person(
        person_id=1,
        walk=Walk(waypoints_m=POINTS_M, speed_mps=speed_mps),
        height_m=BODY_SIZE_M[2],
        radius_m=BODY_RADIUS_M,
        stride_m=2.0 * math.hypot(RISE_M, RUN_M),
        motion="climbing",
    )


def climb_s(person: Person) -> float:
    """How long a person takes for one way [s]."""
    return person.walk.length_m / person.walk.speed_mps


def body_cuboid(position_m: Array, height_m: float = BODY_SIZE_M[2]) -> tuple[Array, Array]:
    """Lowest and highest corner (n, 3) [m] of the paper's cuboid about true positions (n, 3) of a person.

    It stands on the ground, 1.8 m high however tall the person is, with the torso's axis in its middle.
    """
    size_m = np.array(BODY_SIZE_M)
    lower_m = position_m - np.array([size_m[0] / 2.0, size_m[1] / 2.0, TORSO_HEIGHTS[1] * height_m])
    return lower_m, lower_m + size_m


def simulate_stairs(
    scene: ThroughWallScene,
    *,
    seed: int,
    duration_s: float | None = None,
    person: Person | None = None,
    power_up_s: Sequence[float] = (),
    progress: Callable[[range], Iterable[int]] = iter,
) -> Recording:
    """One climb in memory, or `duration_s` of it; scans (n, 4095) float32 [count] of rx1 to rx4.

    Truth (n, 3) is the axis of the torso, 0.68 of the body's height above the ground. `person`: somebody
    else than `stairs_climber`. Other arguments and errors are those of `simulate_through_wall`, and
    ValueError for fewer than four receivers.
    """
    if len(scene.nodes) < 4:
        raise ValueError(f"scene: {scene.name} has {len(scene.nodes)} receivers, expected 4 or more")
    climber = person or stairs_climber()
    if duration_s is None:
        duration_s = climb_s(climber)
    return simulate_through_wall(
        scene, (climber,), seed=seed, duration_s=duration_s, power_up_s=power_up_s, progress=progress
    )


def _steps() -> tuple[Furniture, ...]:
    """The edges of all steps, each seen as two points."""
    rng = np.random.default_rng(STEP_SEED)
    points: list[Point] = []
    for step in range(1, STEPS + 1):
        for half_m in (-0.3, 0.3):
            points.append((half_m - LINE_M, FOOT_M - (step - 1) * RUN_M, FLOOR_M + step * RISE_M))
            points.append((half_m + LINE_M, HEAD_M + (step - 1) * RUN_M, LANDING_M + step * RISE_M))
    rcs_m2 = rng.exponential(STEP_RCS_M2, len(points))
    return tuple(Furniture(position_m=at, rcs_m2=float(rcs)) for at, rcs in zip(points, rcs_m2, strict=True))
