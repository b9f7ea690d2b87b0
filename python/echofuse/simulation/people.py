"""Walking people as clouds of scatterers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from echofuse.simulation.walk import Walk

Array = NDArray[np.float64]

TORSO_AZIMUTHS = 12  # 8 cm of skin between neighbours, about a wavelength
TORSO_HEIGHTS = (0.58, 0.68, 0.78)  # x height: pelvis, waist, chest
TORSO_WIDTH_TO_DEPTH = 1.5
HEAD_AZIMUTHS = 6
RCS_SHARES = {"torso": 0.60, "head": 0.06, "arm": 0.07, "leg": 0.10}  # of the person's; two arms, two legs
DIRECTIVITY = {"torso": 1.0, "head": 1.0, "arm": 0.7, "leg": 0.3}  # 1: seen from its own side alone
SKIN_ROUGHNESS_M = 0.01
RCS_SPREAD_DB = 2.0
CREEPING = 0.05  # amplitude of skin on the far side [1]
BREATHING_M, BREATHING_HZ = 0.004, 0.27
SWAY_M = 0.004  # of somebody who stands


@dataclass(frozen=True, kw_only=True)
class Person:
    """Somebody in the room. Truth is the axis of the torso, at its middle height."""

    person_id: int
    walk: Walk
    height_m: float = 1.85
    radius_m: float = 0.18  # mean of the torso's half width and half depth; also the shadow's half width
    rcs_m2: float = 0.8  # mean over all directions, whole body
    gait_phase: float = 0.0  # [cycle] at time 0
    stride_m: float | None = None  # of a cycle of two steps; None: as Boulic et al. 1990 on level ground
    motion: str = "walking"

    def __post_init__(self) -> None:
        if not (self.height_m > 0.0 and self.radius_m > 0.0 and self.rcs_m2 >= 0.0):
            raise ValueError("Person: height_m and radius_m must be positive, rcs_m2 not negative")
        if self.stride_m is not None and not self.stride_m > 0.0:
            raise ValueError("Person.stride_m: must be positive")

    @property
    def centre_height_m(self) -> float:
        return TORSO_HEIGHTS[1] * self.height_m

    @property
    def width_m(self) -> float:
        """Of the torso."""
        return 2.0 * _half_axes(self.radius_m)[1]

    @property
    def torso_height_m(self) -> float:
        """From hips to shoulders, the share of it in the gait model of Boulic et al. 1990."""
        return 0.288 * self.height_m

    @property
    def leg_m(self) -> float:
        """From hip to sole, in which Boulic et al. 1990 measure speed and stride."""
        return 0.491 * self.height_m

    def gait_cycles(self, time_s: float) -> float:
        """Cycles of two steps since the start, and the phase then."""
        nominal_hz = self.walk.speed_mps / self.leg_m
        stride_m = self.stride_m or 1.346 * math.sqrt(nominal_hz) * self.leg_m
        return self.gait_phase + float(self.walk.distance_m(time_s)) / stride_m

    def position_m(self, time_s: Array) -> Array:
        """time_s (n,) -> (n, 3)."""
        ground = self.walk.position_m(time_s)
        return np.column_stack([ground, self.walk.ground_m(time_s) + self.centre_height_m])


def walkers(
    walks: Sequence[Walk], heights_m: Sequence[float], count: int, *, radius_m: float = Person.radius_m
) -> tuple[Person, ...]:
    """The first `count` of a scene's people, ids from 1.

    The first one's cross section is a Person's, the others' go with the square of their height.
    """
    if not 0 <= count <= len(walks):
        raise ValueError(f"count: {count}, expected 0 to {len(walks)}")
    return tuple(
        Person(
            person_id=index + 1,
            walk=walk,
            height_m=height_m,
            radius_m=radius_m,
            rcs_m2=Person.rcs_m2 * (height_m / heights_m[0]) ** 2,
            gait_phase=0.23 * index,
        )
        for index, (walk, height_m) in enumerate(zip(walks[:count], heights_m, strict=False))
    )


class Scatterers(NamedTuple):
    """A body at one moment."""

    position_m: Array  # (n, 3)
    facing: Array  # (n, 3) outward unit vectors, horizontal
    directivity: Array  # (n,) 0: seen from all around, 1: from its own side alone
    rcs_m2: Array  # (n,) seen face to face


def visibility(facing: Array, directivity: Array, to_tx: Array, to_rx: Array) -> Array:
    """Amplitude factor of scatterers (n,) for unit directions to Tx (..., 3) and Rx (..., 3) -> (..., n).

    Skin shines where it faces the bisector of the two directions (cos^2, a specular patch); both must see it.
    """
    sum_of_both = to_tx + to_rx
    length = np.linalg.norm(sum_of_both, axis=-1, keepdims=True)
    bisector = sum_of_both / np.maximum(length, 0.3)  # no bisector when looking through the body
    specular = np.maximum(bisector @ facing.T, 0.0) ** 2
    lit = np.clip(4.0 * (to_tx @ facing.T) + 1.0, 0.0, 1.0) * np.clip(
        4.0 * (to_rx @ facing.T) + 1.0, 0.0, 1.0
    )
    own_side = np.maximum(specular * lit, CREEPING)
    return np.asarray(1.0 - directivity + directivity * own_side)


class Gait(NamedTuple):
    """Joint angles [rad] of one side of the body."""

    hip: float
    knee: float
    shoulder: float
    elbow: float


def gait(phase: float, relative_speed_hz: float) -> Gait:
    """Angles at a phase [cycle] since this side's heel strike; they vanish with the speed (leg lengths / s).

    Sinusoids and one bump fitted to the control points of Boulic et al. 1990 (hip 25/-15 deg, knee 3/70 deg).
    """
    stride = min(1.0, relative_speed_hz / 0.5)
    swing = (phase % 1.0 - 0.45) / 0.5
    knee_bump = math.sin(math.pi * swing) ** 2 if 0.0 < swing < 1.0 else 0.0
    cosine = math.cos(2.0 * math.pi * phase)
    return Gait(
        hip=math.radians(stride * (5.0 + 20.0 * cosine)),
        knee=math.radians(3.0 + stride * 67.0 * knee_bump),
        shoulder=math.radians(-9.88 * min(relative_speed_hz, 3.0) * cosine),
        elbow=math.radians(10.0 + stride * 15.0 * (1.0 - cosine)),
    )


class Body:
    """One person's skin and limbs; random only in its small irregularities, drawn once."""

    def __init__(self, person: Person, rng: np.random.Generator) -> None:
        self.person = person
        names = ["torso"] * (TORSO_AZIMUTHS * len(TORSO_HEIGHTS)) + ["head"] * HEAD_AZIMUTHS
        for limb, count in (("arm", 3), ("leg", 5)):
            names += [limb] * (2 * count)
        self._parts = np.array(names)
        self._directivity = np.array([DIRECTIVITY[name] for name in names])
        self._roughness_m = SKIN_ROUGHNESS_M * rng.standard_normal(len(names))
        self._facing = self._local_facing()
        self._rcs_m2 = self._share_rcs(10.0 ** (RCS_SPREAD_DB / 10.0 * rng.standard_normal(len(names))))

    def scatterers(self, time_s: float) -> Scatterers:
        """The body in the room at a time."""
        person = self.person
        speed_mps = float(np.hypot(*person.walk.velocity_mps(time_s)))
        heading = person.walk.heading_rad(time_s)
        forward = np.array([math.cos(heading), math.sin(heading), 0.0])
        left = np.array([-forward[1], forward[0], 0.0])
        frame = np.stack([forward, left, np.array([0.0, 0.0, 1.0])])
        local = self._local_position(time_s, speed_mps) + self._roughness_m[:, np.newaxis] * self._facing
        ground = np.append(person.walk.position_m(time_s), person.walk.ground_m(time_s))
        return Scatterers(ground + local @ frame, self._facing @ frame, self._directivity, self._rcs_m2)

    def _local_facing(self) -> Array:
        """(n, 3) outward directions, x forward and y left: ellipse normals, and sideways for the limbs."""
        depth, width = _half_axes(self.person.radius_m)
        torso = np.array([(math.cos(a) / depth, math.sin(a) / width, 0.0) for a in _azimuths(TORSO_AZIMUTHS)])
        head = np.array([(math.cos(a), math.sin(a), 0.0) for a in _azimuths(HEAD_AZIMUTHS)])
        sides = [(0.0, side, 0.0) for count in (3, 5) for side in (-1.0, 1.0) for _ in range(count)]
        facing = np.concatenate([np.tile(torso, (len(TORSO_HEIGHTS), 1)), head, np.array(sides)])
        return np.asarray(facing / np.linalg.norm(facing, axis=1, keepdims=True))

    def _share_rcs(self, irregularity: Array) -> Array:
        """(n,) [m^2] such that each part has its share, as the mean over directions of the incoherent sum."""
        turn = _azimuths(72)
        around = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(72)])
        mean_power = np.mean(visibility(self._facing, self._directivity, around, around) ** 2, axis=0)
        rcs_m2 = np.empty(len(irregularity))
        for part, share in RCS_SHARES.items():
            mine = self._parts == part
            both = share * (2.0 if part in ("arm", "leg") else 1.0)
            rcs_m2[mine] = both * irregularity[mine] / np.sum(irregularity[mine] * mean_power[mine])
        return rcs_m2 * self.person.rcs_m2

    def _local_position(self, time_s: float, speed_mps: float) -> Array:
        """(n, 3) in the body's own frame, origin on the ground under the centre; roughness not included."""
        person = self.person
        phase = person.gait_cycles(time_s)
        speed_hz = speed_mps / person.leg_m
        trunk, limbs = self._trunk(time_s), []
        for limb in (_arm, _leg):
            for side, shift in ((-1.0, 0.0), (1.0, 0.5)):  # right, left
                limbs.append(limb(person, side, gait(phase + shift, speed_hz)))
        return np.concatenate([trunk, *limbs]) + _sway(phase, speed_hz, time_s, person.person_id)

    def _trunk(self, time_s: float) -> Array:
        """(n, 3) torso rings and head; the chest breathes."""
        height_m = self.person.height_m
        depth, width = _half_axes(self.person.radius_m)
        rings = []
        for level, fraction in enumerate(TORSO_HEIGHTS):
            breath = BREATHING_M * level / 2.0 * math.sin(2.0 * math.pi * BREATHING_HZ * time_s)
            for a in _azimuths(TORSO_AZIMUTHS):
                rings.append(((depth + breath) * math.cos(a), width * math.sin(a), fraction * height_m))
        head_m = 0.055 * height_m
        rings += [
            (head_m * math.cos(a), head_m * math.sin(a), 0.935 * height_m) for a in _azimuths(HEAD_AZIMUTHS)
        ]
        return np.array(rings)


def _azimuths(count: int) -> Array:
    return 2.0 * np.pi * np.arange(count) / count


def _half_axes(radius_m: float) -> tuple[float, float]:
    """(half depth, half width) with the mean `radius_m` and the ratio of a torso."""
    depth = 2.0 * radius_m / (1.0 + TORSO_WIDTH_TO_DEPTH)
    return depth, depth * TORSO_WIDTH_TO_DEPTH


def _sway(phase: float, speed_hz: float, time_s: float, person_id: int) -> Array:
    """(3,) of the whole body about the straight line: with the steps while walking, slowly while standing."""
    walking = min(1.0, speed_hz / 0.5)
    idle = SWAY_M * (1.0 - walking)
    return np.array(
        [
            -0.021 * walking * math.sin(4.0 * math.pi * phase) + idle * math.sin(1.9 * time_s + person_id),
            -0.032 * walking * math.sin(2.0 * math.pi * (phase - 0.1)) + idle * math.sin(1.3 * time_s),
            0.015 * min(speed_hz, 3.0) * math.sin(2.0 * math.pi * (2.0 * phase - 0.35)),
        ]
    )


def _swing(angle: float, length_m: float) -> Array:
    """(3,) a hanging segment, turned forward by an angle."""
    return length_m * np.array([math.sin(angle), 0.0, -math.cos(angle)])


def _arm(person: Person, side: float, angles: Gait) -> Array:
    """(3, 3) upper arm, forearm, hand."""
    height_m = person.height_m
    shoulder = np.array([0.0, side * 1.2 * person.radius_m, 0.80 * height_m])
    elbow = shoulder + _swing(angles.shoulder, 0.188 * height_m)
    hand = elbow + _swing(angles.shoulder + angles.elbow, 0.152 * height_m)
    return np.stack([(shoulder + elbow) / 2.0, (elbow + hand) / 2.0, hand])


def _leg(person: Person, side: float, angles: Gait) -> Array:
    """(5, 3) two of the thigh, two of the shank, foot."""
    height_m = person.height_m
    hip = np.array([0.0, side * 0.0955 * height_m / 1.5, 0.52 * height_m])
    knee = hip + _swing(angles.hip, 0.245 * height_m)
    ankle = knee + _swing(angles.hip - angles.knee, 0.246 * height_m)
    toe = ankle + np.array([0.07 * height_m, 0.0, -0.02 * height_m])
    return np.stack(
        [hip + (knee - hip) * 0.4, hip + (knee - hip) * 0.8, knee + (ankle - knee) * 0.4, ankle, toe]
    )
