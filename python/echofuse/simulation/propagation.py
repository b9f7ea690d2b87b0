"""From transmitter to receiver: delays and amplitude gains of every path.

A gain is sqrt(received / transmitted power) with the sign of the reflections, at the centre frequency.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.simulation.people import Person, Scatterers, visibility
from echofuse.simulation.scene import RadarNode, Scene, Surface

Array = NDArray[np.float64]

NEAR_FIELD_M = 0.1  # distances below this count as this
DEEPEST_SHADOW = 10.0 ** (-15.0 / 20.0)  # amplitude behind a body [1]: what creeps around it
EDGE_STEEPNESS = 1.2  # of the shadow's edge, in Fresnel radii: 6 dB in the middle of a 6 m path
SHORTEST_FRESNEL_M = 0.03


class Paths(NamedTuple):
    delay_s: Array  # (n,) after transmission
    gain: Array  # (n,) [1]


class Obstacle(NamedTuple):
    """Somebody's upright body, for shadowing."""

    centre_m: Array  # (2,)
    radius_m: float
    top_m: float  # z of the head
    bottom_m: float = -math.inf  # z of the soles, where something can pass below


def obstacle(person: Person, time_s: float) -> Obstacle:
    """Where somebody's body stands at a time."""
    ground_m = float(person.walk.ground_m(time_s))
    return Obstacle(
        person.walk.position_m(time_s),
        person.radius_m,
        ground_m + person.height_m,
        ground_m if person.walk.rises else -math.inf,
    )


class Ways(NamedTuple):
    """Paths and the corners that they pass, for shadowing; short corner lists repeat their last."""

    delay_s: Array  # (n,)
    gain: Array  # (n,)
    corners_m: Array  # (n, 4, 3)


class Station(NamedTuple):
    """An antenna and its mirror images: itself first, then one per surface."""

    image_m: Array  # (n_images, 3)
    reflection: Array  # (n_images,) 1 for the antenna itself
    surfaces: tuple[Surface, ...]  # of the images after the first


def mirror(point_m: Array, surface: Surface) -> Array:
    """The image of a point (3,)."""
    image = point_m.copy()
    image[surface.axis] = 2.0 * surface.offset_m - image[surface.axis]
    return image


def crossing(a_m: Array, b_m: Array, surface: Surface) -> Array:
    """Where the straight line from a (3,) to b (3,) meets a surface."""
    part = (surface.offset_m - a_m[surface.axis]) / (b_m[surface.axis] - a_m[surface.axis])
    return np.asarray(a_m + part * (b_m - a_m))


def station(position_m: tuple[float, float, float], surfaces: tuple[Surface, ...]) -> Station:
    """An antenna with its first-order images."""
    itself = np.array(position_m, dtype=np.float64)
    images = np.stack([itself, *(mirror(itself, surface) for surface in surfaces)])
    return Station(images, np.array([1.0, *(surface.reflection for surface in surfaces)]), surfaces)


def dipole(offset_m: Array) -> Array:
    """Amplitude pattern of an upright dipole towards offsets (..., 3): the cosine of the elevation."""
    length = np.maximum(np.linalg.norm(offset_m, axis=-1), 1e-9)
    return np.asarray(np.linalg.norm(offset_m[..., :2], axis=-1) / length)


def friis_gain(distance_m: ArrayLike, wavelength_m: float) -> Array:
    """lambda / (4 pi d)."""
    return np.asarray(wavelength_m / (4.0 * np.pi * np.maximum(distance_m, NEAR_FIELD_M)))


def radar_gain(
    tx_distance_m: ArrayLike, rx_distance_m: ArrayLike, rcs_m2: ArrayLike, wavelength_m: float
) -> Array:
    """Bistatic radar equation (eq. 1): lambda sqrt(sigma) / ((4 pi)^1.5 l_t l_r)."""
    product = np.maximum(tx_distance_m, NEAR_FIELD_M) * np.maximum(rx_distance_m, NEAR_FIELD_M)
    return np.asarray(wavelength_m * np.sqrt(rcs_m2) / ((4.0 * np.pi) ** 1.5 * product))


def static_ways(scene: Scene, node: RadarNode) -> Ways:
    """Everything of the empty room: direct path, reflections of first and second order, furniture."""
    tx, rx = np.array(node.tx_position_m), np.array(node.rx_position_m)
    wavelength, antennas = scene.wavelength_m(), 10.0 ** (scene.radio.antenna_gain_db / 10.0)
    rows = []
    for factor, corners in reflected_corners(tx, rx, scene.room.surfaces()):
        length = float(np.sum(np.linalg.norm(np.diff(corners, axis=0), axis=1)))
        pattern = dipole(corners[1] - corners[0]) * dipole(corners[-1] - corners[-2])
        rows.append((length, factor * float(friis_gain(length, wavelength) * pattern), corners))
    for piece in scene.furniture:
        at = np.array(piece.position_m)
        there, back = np.linalg.norm(at - tx), np.linalg.norm(rx - at)
        echo = -radar_gain(there, back, piece.rcs_m2, wavelength) * dipole(at - tx) * dipole(rx - at)
        rows.append((float(there + back), float(echo), np.stack([tx, at, rx])))
    corners_m = np.stack([np.concatenate([c, np.repeat(c[-1:], 4 - len(c), axis=0)]) for _, _, c in rows])
    delay_s = np.array([length for length, _, _ in rows]) / SPEED_OF_LIGHT_MPS
    return Ways(delay_s, antennas * np.array([gain for _, gain, _ in rows]), corners_m)


def reflected_corners(tx: Array, rx: Array, surfaces: tuple[Surface, ...]) -> list[tuple[float, Array]]:
    """(product of reflections, corners (2 to 4, 3)) of the direct path and of up to two reflections."""
    found = [(1.0, np.stack([tx, rx]))]
    for first in surfaces:
        image = mirror(tx, first)
        found.append((first.reflection, np.stack([tx, crossing(image, rx, first), rx])))
        for second in surfaces:
            if second == first:
                continue
            last = crossing(mirror(image, second), rx, second)
            before = crossing(image, last, first)
            corners = np.stack([tx, before, last, rx])
            if _is_ordered(corners, first, second):
                found.append((first.reflection * second.reflection, corners))
    return found


def _is_ordered(corners_m: Array, first: Surface, second: Surface) -> bool:
    """Whether a path over two surfaces stays in the room: at an edge only one of the two orders does."""
    if first.axis == second.axis:
        return True
    inside = corners_m[0]
    side = np.sign(inside[second.axis] - second.offset_m)
    return bool(side * (corners_m[1][second.axis] - second.offset_m) >= 0.0)


def shadow(corners_m: Array, obstacles: list[Obstacle], wavelength_m: float) -> Array:
    """Amplitude factor (n,) of paths with corners (n, k, 3): 1 in the clear, edges as soft as Fresnel zones.

    Of each body the segment that it covers most counts; bodies multiply.
    """
    factor = np.ones(len(corners_m))
    start, along = corners_m[:, :-1], np.diff(corners_m, axis=1)  # (n, k - 1, 3)
    length = np.linalg.norm(along, axis=-1)
    passed = np.cumsum(length, axis=1) - length
    total = np.sum(length, axis=1, keepdims=True)
    flat_square = np.maximum(np.sum(along[..., :2] ** 2, axis=-1), 1e-12)
    for body in obstacles:
        to_body = body.centre_m - start[..., :2]
        part = np.clip(np.sum(to_body * along[..., :2], axis=-1) / flat_square, 0.0, 1.0)
        clearance = np.linalg.norm(to_body - part[..., np.newaxis] * along[..., :2], axis=-1)
        before = passed + part * length
        fresnel = np.sqrt(wavelength_m * before * (total - before) / total)
        steep = EDGE_STEEPNESS / np.maximum(fresnel, SHORTEST_FRESNEL_M)
        covered = np.tanh(steep * (body.radius_m - clearance)) + np.tanh(steep * (body.radius_m + clearance))
        height_m = start[..., 2] + part * along[..., 2]
        covered *= 0.25 * (1.0 + np.tanh(steep * (body.top_m - height_m))) * (length > 0.0)
        covered *= 0.5 + 0.5 * np.tanh(steep * (height_m - body.bottom_m))
        factor *= 1.0 - (1.0 - DEEPEST_SHADOW) * np.max(covered, axis=1)
    return factor


def _leg_shadow(antenna: Station, at_m: Array, obstacles: list[Obstacle], wavelength_m: float) -> Array:
    """(n_images,) of the legs from an antenna, over each surface, to a person (3,)."""
    if not obstacles:
        return np.ones(len(antenna.image_m))
    itself = antenna.image_m[0]
    corners = [np.stack([itself, at_m, at_m])]
    for image, surface in zip(antenna.image_m[1:], antenna.surfaces, strict=True):
        corners.append(np.stack([itself, crossing(image, at_m, surface), at_m]))
    return shadow(np.stack(corners), obstacles, wavelength_m)


def echo_paths(
    tx: Station, rx: Station, body: Scatterers, others: list[Obstacle], wavelength_m: float
) -> Paths:
    """A person's echo: straight, and with one reflection before or after it; antenna gains of 0 dB."""
    centre_m = np.mean(body.position_m, axis=0)
    legs = []
    for antenna in (tx, rx):
        offset = antenna.image_m[:, np.newaxis] - body.position_m  # (n_images, n_scatterers, 3)
        distance = np.linalg.norm(offset, axis=-1)
        towards = antenna.image_m - centre_m
        towards = towards / np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-9)
        weight = antenna.reflection * _leg_shadow(antenna, centre_m, others, wavelength_m)
        legs.append((distance, weight[:, np.newaxis] * dipole(offset), towards))
    (tx_m, tx_weight, tx_towards), (rx_m, rx_weight, rx_towards) = legs
    i = np.concatenate([np.arange(len(tx_m)), np.zeros(len(rx_m) - 1, dtype=np.intp)])  # which Tx image
    j = np.concatenate([np.zeros(len(tx_m), dtype=np.intp), np.arange(1, len(rx_m))])  # which Rx image
    seen = visibility(body.facing, body.directivity, tx_towards[i], rx_towards[j])
    gain = -radar_gain(tx_m[i], rx_m[j], body.rcs_m2, wavelength_m) * tx_weight[i] * rx_weight[j] * seen
    return Paths(((tx_m[i] + rx_m[j]) / SPEED_OF_LIGHT_MPS).ravel(), gain.ravel())


def power_gain(paths: Paths) -> float:
    """Sum of the paths' power gains, as if they did not interfere [1]."""
    return math.fsum(paths.gain**2)
