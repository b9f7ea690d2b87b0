"""Paths: delays, amplitudes, reflections, shadows."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.simulation.people import Scatterers
from echofuse.simulation.propagation import Obstacle, echo_paths, shadow, static_ways, station
from echofuse.simulation.scene import RadarNode, Room, Scene, sensor_radar_scene

WAVELENGTH_M = SPEED_OF_LIGHT_MPS / 4.3e9
ROOM = Room(lower_m=(-1.0, -2.0, 0.0), upper_m=(13.0, 8.0, 3.0), wall_reflections=(-0.5, -0.4, -0.3, -0.2))
NO_ROOM = replace(ROOM, wall_reflections=(0.0, 0.0, 0.0, 0.0))


def scene_of(tx: tuple[float, float, float], rx: tuple[float, float, float], room: Room = NO_ROOM) -> Scene:
    node = RadarNode(name="a", node_id=1, tx_position_m=tx, rx_position_m=rx)
    return Scene(name="t", area_lower_m=(0.0, 0.0), area_upper_m=(12.0, 6.0), room=room, nodes=(node,))


def point_target(x: float, y: float, z: float, rcs_m2: float = 1.0) -> Scatterers:
    return Scatterers(
        np.array([[x, y, z]]), np.array([[1.0, 0.0, 0.0]]), np.zeros(1), np.array([rcs_m2])
    )  # seen from all around


def test_direct_path_is_friis_at_the_geometric_delay() -> None:
    for distance in (1.0, 2.0, 8.0):
        scene = scene_of((1.0, 1.0, 1.0), (1.0 + distance, 1.0, 1.0))
        ways = static_ways(scene, scene.nodes[0])
        assert ways.delay_s * SPEED_OF_LIGHT_MPS == pytest.approx([distance])
        assert ways.gain == pytest.approx([WAVELENGTH_M / (4.0 * math.pi * distance)])


def test_echo_is_the_bistatic_radar_equation() -> None:
    tx, rx = station((0.0, 0.0, 1.0), ()), station((6.0, 0.0, 1.0), ())
    for x, y in ((3.0, 4.0), (0.0, 3.0), (6.0, 5.0)):
        there, back = math.hypot(x, y), math.hypot(x - 6.0, y)
        echo = echo_paths(tx, rx, point_target(x, y, 1.0, 0.7), [], WAVELENGTH_M)
        power = WAVELENGTH_M**2 * 0.7 / ((4.0 * math.pi) ** 3 * (there * back) ** 2)
        assert echo.gain**2 == pytest.approx([power], rel=1e-9, abs=0.0)
        assert echo.delay_s * SPEED_OF_LIGHT_MPS == pytest.approx([there + back])


def test_wall_reflections_stand_at_their_image_distances() -> None:
    scene = scene_of((2.0, 1.0, 1.0), (9.0, 4.0, 1.0), ROOM)
    ways = static_ways(scene, scene.nodes[0])
    found = {
        round(float(length), 9): float(gain)
        for length, gain in zip(ways.delay_s * SPEED_OF_LIGHT_MPS, ways.gain, strict=True)
    }
    rho = {(0, -1): -0.5, (0, 1): -0.4, (1, -1): -0.3, (1, 1): -0.2}
    expected: dict[float, float] = {}
    images_x = {(): 2.0, ((0, -1),): -4.0, ((0, 1),): 24.0, ((0, -1), (0, 1)): 30.0, ((0, 1), (0, -1)): -26.0}
    images_y = {(): 1.0, ((1, -1),): -5.0, ((1, 1),): 15.0, ((1, -1), (1, 1)): 21.0, ((1, 1), (1, -1)): -19.0}
    for over_x, x in images_x.items():
        for over_y, y in images_y.items():
            if len(over_x) + len(over_y) > 2:
                continue
            distance = math.hypot(x - 9.0, y - 4.0)
            factor = math.prod(rho[wall] for wall in (*over_x, *over_y))
            expected[round(distance, 9)] = factor * WAVELENGTH_M / (4.0 * math.pi * distance)
    assert len(expected) == 1 + 4 + 8 == len(ways.gain)
    assert found == pytest.approx(expected, rel=1e-6, abs=0.0)


def test_reflected_paths_stay_in_the_room() -> None:
    scene = sensor_radar_scene()
    for node in scene.nodes:
        corners = static_ways(scene, node).corners_m
        assert np.all(corners >= np.array(scene.room.lower_m) - 1e-9)
        assert np.all(corners <= np.array(scene.room.upper_m) + 1e-9)


def test_echo_bounces_once_off_each_wall_on_either_leg() -> None:
    tx, rx, at = (2.0, 1.0, 1.0), (9.0, 4.0, 1.0), np.array([6.0, 2.0, 1.0])
    surfaces = ROOM.surfaces()
    echo = echo_paths(
        station(tx, surfaces), station(rx, surfaces), point_target(6.0, 2.0, 1.0), [], WAVELENGTH_M
    )

    def legs(p: tuple[float, float, float]) -> list[float]:
        images = [
            p,
            (-2.0 - p[0], p[1], 1.0),
            (26.0 - p[0], p[1], 1.0),
            (p[0], -4.0 - p[1], 1.0),
            (p[0], 16.0 - p[1], 1.0),
        ]
        return [math.dist(image, at) for image in images]

    there, back = legs(tx), legs(rx)
    lengths = [t + back[0] for t in there] + [there[0] + b for b in back[1:]]
    np.testing.assert_allclose(echo.delay_s * SPEED_OF_LIGHT_MPS, lengths)
    ratio = echo.gain[1] / echo.gain[0]  # over the left wall to the person
    assert ratio == pytest.approx(-0.5 * there[0] / there[1])


def test_shadow_deepens_smoothly_as_a_person_crosses_the_line_of_sight() -> None:
    corners = np.array([[[0.0, 0.0, 1.0], [6.0, 0.0, 1.0]]])

    def behind(x: float, y: float, height_m: float = 1.8) -> float:
        return float(shadow(corners, [Obstacle(np.array([x, y]), 0.18, height_m)], WAVELENGTH_M)[0])

    across = [behind(3.0, y) for y in np.linspace(0.0, 3.0, 61)]
    assert np.all(np.diff(across) > -1e-12)
    assert 4.0 < -20.0 * math.log10(across[0]) < 12.0
    assert across[-1] == pytest.approx(1.0, abs=1e-4)
    assert np.max(np.abs(np.diff(across))) < 0.1
    assert -20.0 * math.log10(behind(0.1, 0.18)) == pytest.approx(4.6, abs=0.2)  # half covered, 15 dB at most
    assert behind(0.5, 0.0) < behind(3.0, 0.0)  # near an antenna the shadow is darker
    assert behind(-0.5, 0.0) == pytest.approx(1.0, abs=1e-3)  # behind the antenna there is none
    assert behind(3.0, 0.0, height_m=0.4) > 0.95  # nor over a low body
    on_stairs = [Obstacle(np.array([3.0, 0.0]), 0.18, soles_m + 1.8, soles_m) for soles_m in (0.2, 1.0, 1.6)]
    over, half, under = (float(shadow(corners, [body], WAVELENGTH_M)[0]) for body in on_stairs)
    assert over == pytest.approx(across[0], abs=0.02)
    assert 1.0 - half == pytest.approx(0.5 * (1.0 - across[0]), abs=0.02)
    assert under > 0.95  # nor below the feet


def test_two_bodies_shade_more_than_one_and_others_shade_an_echo() -> None:
    near, far = Obstacle(np.array([2.0, 0.0]), 0.18, 1.8), Obstacle(np.array([4.0, 0.0]), 0.18, 1.8)
    corners = np.array([[[0.0, 0.0, 1.0], [6.0, 0.0, 1.0]]])
    one, both = shadow(corners, [near], WAVELENGTH_M)[0], shadow(corners, [near, far], WAVELENGTH_M)[0]
    assert both == pytest.approx(one**2)
    tx, rx, body = station((0.0, 0.0, 1.0), ()), station((0.0, 5.0, 1.0), ()), point_target(6.0, 0.0, 1.0)
    clear, shaded = (echo_paths(tx, rx, body, others, WAVELENGTH_M).gain[0] for others in ([], [near]))
    assert abs(shaded) == pytest.approx(abs(clear) * one, rel=1e-3, abs=0.0)
