"""Through the wall with an M-sequence radar: raw impulse responses of every receiver, with ground truth."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from datetime import UTC, datetime
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.recording import NodeRecording, Pulse, Recording
from echofuse.simulation.fluctuation import Aspect, EchoFluctuation
from echofuse.simulation.m_sequence import MSequenceFrontend
from echofuse.simulation.people import Body, Person, Scatterers, visibility
from echofuse.simulation.propagation import (
    Obstacle,
    Paths,
    crossing,
    friis_gain,
    obstacle,
    radar_gain,
    reflected_corners,
    shadow,
    station,
)
from echofuse.simulation.scene import RadarNode
from echofuse.simulation.sensor_radar import Purpose, SimulatedFrame, n_frames, person_truth
from echofuse.simulation.synthesis import Spectrum, path_spectrum
from echofuse.simulation.through_wall_scene import ThroughWallScene
from echofuse.simulation.wall import Rays, refracted, reverberation, transmission, wall_response

Array = NDArray[np.float64]


class _StaticPaths(NamedTuple):
    """The empty room behind the wall, as one receiver hears it."""

    delay_s: Array  # (n,)
    gain: Array  # (n,)
    corners_m: Array  # (n, 4, 3) for shadows; short lists repeat their last


class _Legs(NamedTuple):
    """From each antenna (the transmitter first) and its mirror images to a body."""

    rays: Rays  # (n_antennas, n_images, n_scatterers)
    weight: Array  # (n_antennas, n_images, n_scatterers) pattern, wall, reflection, shadow [1]
    towards: Array  # (n_antennas, n_images, 3) unit vectors from the body's middle, not refracted


class ThroughWallSimulation:
    """A pure function of (scene, people, seed, power_up_s), evaluated response by response, in any order."""

    def __init__(
        self,
        scene: ThroughWallScene,
        people: Sequence[Person],
        *,
        seed: int,
        power_up_s: Sequence[float] = (),
    ) -> None:
        """power_up_s: when the device loses its power for a moment and begins anew at another chip."""
        if len({person.person_id for person in people}) != len(people):
            raise ValueError("people: each needs a person_id of its own")
        floor_m = scene.room.lower_m[2]
        for person in people:
            if not person.walk.rises and floor_m != 0.0:
                raise ValueError(
                    f"people: person {person.person_id} needs waypoints (x, y, z): "
                    f"the floor is at z = {floor_m:g} m"
                )
            if not scene.holds(person):
                raise ValueError(f"people: person {person.person_id} walks out of the room")
        self.scene, self.people, self.seed = scene, tuple(people), seed
        self.power_up_s = tuple(sorted(power_up_s))
        self.frontend = MSequenceFrontend(scene.radar)
        self._bodies = [Body(person, self._rng(Purpose.BODY, person.person_id, 0)) for person in people]
        places = [scene.nodes[0].tx_position_m, *(node.rx_position_m for node in scene.nodes)]
        one_height = len({z for _, _, z in places}) == 1  # then all look from the same elevation
        self._fluctuations = [
            EchoFluctuation(
                self._rng(Purpose.BODY, person.person_id, 1),
                width_m=person.width_m,
                height_m=0.0 if one_height else person.torso_height_m,
                wavelength_m=scene.radar.wavelength_m,
            )
            for person in people
        ]
        self._antennas = [station(place, scene.room.surfaces()) for place in places]
        self._image_m = np.stack([antenna.image_m for antenna in self._antennas])  # (n_antennas, n_images, 3)
        self._outside = [self.spectrum(outside_paths(scene, node)) for node in scene.nodes]
        self._static = [_static_paths(scene, node) for node in scene.nodes]
        self._ringing = self._two_passes(0.0, 0.0)

    def start_chip(self, time_s: float) -> int:
        """In which sample the responses begin, of every receiver; drawn anew at each power-up."""
        power_ups = sum(time_s >= at_s for at_s in self.power_up_s)
        rng = self._rng(Purpose.START_CHIP, 0, power_ups)
        return int(rng.integers(self.scene.radar.n_samples))

    def frame(self, index: int) -> SimulatedFrame:
        """The responses of all receivers, taken at one moment."""
        time_s = index * self.scene.scan_period_s
        start_chip = self.start_chip(time_s)
        scans = [
            self.frontend.response(channel, start_chip, self._rng(Purpose.SCAN, node.node_id, index))
            for node, channel in zip(self.scene.nodes, self.channels(time_s), strict=True)
        ]
        return SimulatedFrame(index=index, time_s=np.full(len(scans), time_s), scans=np.stack(scans))

    def channels(self, time_s: float) -> list[Spectrum]:
        """Gain of each receiver's channel over frequency, (n_bins,): cross-talk, wall, room, people."""
        obstacles = [obstacle(person, time_s) for person in self.people]
        bodies = [body.scatterers(time_s) for body in self._bodies]
        legs = [
            self._legs(body, obstacles[:which] + obstacles[which + 1 :]) for which, body in enumerate(bodies)
        ]
        frequency_hz, found = self.frontend.frequency_hz, []
        for rx, (outside, static) in enumerate(zip(self._outside, self._static, strict=True), start=1):
            shaded = static.gain * shadow(static.corners_m, obstacles, self.scene.radar.wavelength_m)
            channel = outside + self._ringing * self.spectrum(Paths(static.delay_s, shaded))
            for which, (body, its_legs) in enumerate(zip(bodies, legs, strict=True)):
                sine = np.mean(its_legs.rays.sine[[0, rx], 0], axis=1)
                east, north, up = its_legs.towards[0, 0] + its_legs.towards[rx, 0]
                aspect = Aspect(math.atan2(north, east), math.atan2(up, math.hypot(east, north)))
                gait_cycles = self.people[which].gait_cycles(time_s)
                channel += (
                    self._two_passes(float(sine[0]), float(sine[1]))
                    * self._fluctuations[which].response(gait_cycles, aspect, frequency_hz)
                    * self.spectrum(self._echo(body, its_legs, rx))
                )
            found.append(channel)
        return found

    def spectrum(self, paths: Paths) -> Spectrum:
        """(n_bins,) of the front-end's grid."""
        return path_spectrum(
            paths.delay_s,
            paths.gain,
            first_bin=0,
            n_bins=len(self.frontend.frequency_hz),
            bin_spacing_hz=self.frontend.bin_spacing_hz,
        )

    def _legs(self, body: Scatterers, others: list[Obstacle]) -> _Legs:
        wall, radar = self.scene.wall, self.scene.radar
        offset = self._image_m[:, :, np.newaxis] - body.position_m  # (n_antennas, n_images, n_scatterers, 3)
        across_m, air_m = np.hypot(offset[..., 0], offset[..., 2]), np.abs(offset[..., 1]) - wall.thickness_m
        rays = refracted(wall, across_m, air_m)
        middle_m = np.mean(body.position_m, axis=0)
        weight = self._leg_weights(middle_m, others)[..., np.newaxis] * radar.pattern(rays.sine)
        towards = self._image_m - middle_m
        towards /= np.linalg.norm(towards, axis=-1, keepdims=True)
        return _Legs(rays, weight * transmission(wall, rays), towards)

    def _leg_weights(self, at_m: Array, others: list[Obstacle]) -> Array:
        """(n_antennas, n_images) reflection, and shadows of other people on the way to (3,)."""
        corners = []
        for antenna in self._antennas:
            itself = antenna.image_m[0]
            corners.append((itself, at_m, at_m))
            for image, surface in zip(antenna.image_m[1:], antenna.surfaces, strict=True):
                corners.append((itself, crossing(image, at_m, surface), at_m))
        shaded = shadow(np.array(corners), others, self.scene.radar.wavelength_m)
        return np.asarray(shaded.reshape(self._image_m.shape[:2]) * self._antennas[0].reflection)

    def _echo(self, body: Scatterers, legs: _Legs, rx: int) -> Paths:
        """Straight through the wall, and with one reflection in the room before or after the body."""
        n_images = self._image_m.shape[1]
        last = np.arange(1, n_images)
        i = np.concatenate([[0], last, np.zeros_like(last)])  # which Tx image
        j = np.concatenate([[0], np.zeros_like(last), last])  # which Rx image
        rays, weight, towards = legs
        seen = visibility(body.facing, body.directivity, towards[0, i], towards[rx, j])
        wavelength_m = self.scene.radar.wavelength_m
        gain = -radar_gain(rays.length_m[0, i], rays.length_m[rx, j], body.rcs_m2, wavelength_m)
        delay_s = rays.delay_s[0, i] + rays.delay_s[rx, j]
        return Paths(delay_s.ravel(), (gain * weight[0, i] * weight[rx, j] * seen).ravel())

    def _two_passes(self, there: float, back: float) -> Spectrum:
        """Echoes inside the wall on the way in and on the way out, for the sines of both angles."""
        wall, frequency_hz = self.scene.wall, self.frontend.frequency_hz
        return np.asarray(reverberation(wall, there, frequency_hz) * reverberation(wall, back, frequency_hz))

    def _rng(self, purpose: Purpose, who: int, which: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, int(purpose), who, which])


def outside_paths(scene: ThroughWallScene, node: RadarNode) -> Paths:
    """What never enters the room: cross-talk, and the wall's own echoes."""
    radar, wall = scene.radar, scene.wall
    (x, y, z), (rx_x, rx_y, rx_z) = node.tx_position_m, node.rx_position_m
    air_m = 2.0 * wall.front_m - y - rx_y
    echoes, sine = wall_response(wall, math.hypot(rx_x - x, rx_z - z), air_m, radar.wavelength_m)
    delay_s = np.append(node.baseline_m / SPEED_OF_LIGHT_MPS, echoes.delay_s)
    return Paths(
        delay_s, np.append(radar.crosstalk_gain(node.baseline_m), echoes.gain * radar.pattern(sine) ** 2)
    )


def _static_paths(scene: ThroughWallScene, node: RadarNode) -> _StaticPaths:
    """The room's walls, with up to two reflections, and its furniture. Angles of shadows: not refracted."""
    radar, wall = scene.radar, scene.wall
    tx, rx = np.array(node.tx_position_m), np.array(node.rx_position_m)
    delay_s, gain, all_corners = [], [], []
    for factor, corners in reflected_corners(tx, rx, scene.room.surfaces()):
        if len(corners) == 2 or np.any(corners[1:-1, 1] < wall.back_m):
            continue  # the direct path; and what would not go through the wall
        x_m, y_m, z_m = np.sum(np.abs(np.diff(corners, axis=0)), axis=0)
        ray = refracted(wall, np.hypot(x_m, z_m), y_m - 2.0 * wall.thickness_m, 2)
        through = radar.pattern(ray.sine) ** 2 * transmission(wall, ray, 2)
        delay_s.append(float(ray.delay_s))
        gain.append(float(factor * friis_gain(ray.length_m, radar.wavelength_m) * through))
        all_corners.append(np.concatenate([corners, np.repeat(corners[-1:], 4 - len(corners), axis=0)]))
    for piece in scene.furniture:
        at = np.array(piece.position_m)
        offset = np.stack([tx, rx]) - at
        rays = refracted(wall, np.hypot(offset[:, 0], offset[:, 2]), np.abs(offset[:, 1]) - wall.thickness_m)
        through = radar.pattern(rays.sine) * transmission(wall, rays)
        there_m, back_m = rays.length_m
        delay_s.append(float(np.sum(rays.delay_s)))
        gain.append(-float(radar_gain(there_m, back_m, piece.rcs_m2, radar.wavelength_m) * np.prod(through)))
        all_corners.append(np.stack([tx, at, rx, rx]))
    corners_m = np.stack(all_corners) if all_corners else np.zeros((0, 4, 3))
    return _StaticPaths(np.array(delay_s), np.array(gain), corners_m)


def simulate_through_wall(
    scene: ThroughWallScene,
    people: Sequence[Person],
    *,
    seed: int,
    duration_s: float,
    power_up_s: Sequence[float] = (),
    progress: Callable[[range], Iterable[int]] = iter,
) -> Recording:
    """A whole run in memory: scans (n, 2^order - 1) float32 [count] a receiver, not yet rotated to time zero.

    power_up_s: when the start chip changes. `progress` goes through the frames, and may show how far it is.
    Raises ValueError for people outside the room and for less than one response.
    """
    simulation = ThroughWallSimulation(scene, people, seed=seed, power_up_s=power_up_s)
    radar, total = scene.radar, n_frames(scene.scan_period_s, duration_s)
    scans = np.empty((len(scene.nodes), total, radar.n_samples), dtype=np.float32)
    for index in progress(range(total)):
        scans[:, index] = simulation.frame(index).scans
    time_s: Array = np.arange(total, dtype=np.float64) * scene.scan_period_s
    nodes = tuple(
        NodeRecording(
            name=node.name,
            node_id=node.node_id,
            sample_rate_hz=radar.clock_hz,
            first_sample_s=0.0,  # once rotated to time zero
            tx_position_m=np.array(node.tx_position_m),
            rx_position_m=np.array(node.rx_position_m),
            pulse=Pulse(kind="m_sequence", centre_hz=radar.clock_hz / 4.0, bandwidth_hz=radar.clock_hz / 2.0),
            time_s=time_s,
            scans=scans[which],
        )
        for which, node in enumerate(scene.nodes)
    )
    return Recording(
        pipeline=f"through_wall_{'2d' if len(nodes) == 2 else '3d'}",
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        site_toml="",
        nodes=nodes,
        truth=tuple(person_truth(person, time_s) for person in people),
    )
