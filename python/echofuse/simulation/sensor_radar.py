"""The sensor-radar paper's case study: raw scans of every node, with ground truth."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from echofuse.recording import NodeRecording, PersonTruth, Pulse, Recording
from echofuse.simulation.people import Body, Person, walkers
from echofuse.simulation.propagation import (
    Paths,
    Station,
    Ways,
    echo_paths,
    obstacle,
    shadow,
    static_ways,
    station,
)
from echofuse.simulation.radar_frontend import RadarFrontend
from echofuse.simulation.scene import RadarNode, Scene
from echofuse.simulation.walk import Walk

CASE_STUDY_DURATION_S = 6.1  # 61 scans
REFERENCE_SCANS = 20


class Purpose(IntEnum):
    """What a random stream is for: streams are seeded by (seed, purpose, who, which)."""

    BODY = 1
    SCAN = 2
    REFERENCE = 3
    START_CHIP = 4


@dataclass(frozen=True, kw_only=True)
class SimulatedFrame:
    """One scan of every node, in the scene's order."""

    index: int
    time_s: NDArray[np.float64]  # (n_nodes,) when each node's scan was taken
    scans: NDArray[np.float32]  # (n_nodes, n_samples) [count]


class _Listener:
    """One node with what of its paths never changes."""

    def __init__(self, scene: Scene, node: RadarNode) -> None:
        surfaces = scene.room.surfaces()
        self.node = node
        self.static: Ways = static_ways(scene, node)
        self.tx: Station = station(node.tx_position_m, surfaces)
        self.rx: Station = station(node.rx_position_m, surfaces)
        self.first_sample_s = scene.first_sample_s(node)
        self.turn = scene.transmitters().index(node.tx_position_m)


class SensorRadarSimulation:
    """A pure function of (scene, people, seed), evaluated scan by scan, in any order."""

    def __init__(self, scene: Scene, people: Sequence[Person], *, seed: int) -> None:
        if len({person.person_id for person in people}) != len(people):
            raise ValueError("people: each needs a person_id of its own")
        self.scene, self.people, self.seed = scene, tuple(people), seed
        self._frontend = RadarFrontend(scene.pulse, scene.radio)
        self._listeners = [_Listener(scene, node) for node in scene.nodes]
        self._bodies = [Body(person, self._rng(Purpose.BODY, person.person_id, 0)) for person in people]

    def frame(self, index: int) -> SimulatedFrame:
        """The scans of one frame; the transmitters take turns within it."""
        turns = np.array([listener.turn for listener in self._listeners])
        time_s = index * self.scene.scan_period_s + turns * self.scene.radio.scan_duration_s
        scans = [
            self._frontend.scan(
                self.paths(which, float(time_s[which])),
                listener.first_sample_s,
                self._rng(Purpose.SCAN, listener.node.node_id, index),
            )
            for which, listener in enumerate(self._listeners)
        ]
        return SimulatedFrame(index=index, time_s=time_s, scans=np.stack(scans))

    def reference(self, which: int, n_scans: int = REFERENCE_SCANS) -> NDArray[np.float32]:
        """(n_scans, n_samples) [count] of a node before anybody came in."""
        listener = self._listeners[which]
        empty = Paths(listener.static.delay_s, listener.static.gain)
        return np.stack(
            [
                self._frontend.scan(
                    empty, listener.first_sample_s, self._rng(Purpose.REFERENCE, listener.node.node_id, index)
                )
                for index in range(n_scans)
            ]
        )

    def paths(self, which: int, time_s: float) -> Paths:
        """Every path of a node at a time: the room as the people shade it, and the people's echoes."""
        listener, wavelength_m = self._listeners[which], self.scene.wavelength_m()
        obstacles = [obstacle(person, time_s) for person in self.people]
        static = listener.static
        delays = [static.delay_s]
        gains = [static.gain * shadow(static.corners_m, obstacles, wavelength_m)]
        antennas = 10.0 ** (self.scene.radio.antenna_gain_db / 10.0)
        for index, body in enumerate(self._bodies):
            others = obstacles[:index] + obstacles[index + 1 :]
            echo = echo_paths(listener.tx, listener.rx, body.scatterers(time_s), others, wavelength_m)
            delays.append(echo.delay_s)
            gains.append(antennas * echo.gain)
        return Paths(np.concatenate(delays), np.concatenate(gains))

    def _rng(self, purpose: Purpose, who: int, which: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, int(purpose), who, which])


def n_frames(scan_period_s: float, duration_s: float) -> int:
    """How many whole scan periods fit."""
    count = int(duration_s / scan_period_s + 1e-6)
    if count < 1:
        raise ValueError("duration_s: shorter than one scan period")
    return count


def simulate_frames(
    scene: Scene, people: Sequence[Person], *, duration_s: float = CASE_STUDY_DURATION_S, seed: int = 0
) -> Iterator[SimulatedFrame]:
    """Frame by frame, for a live emulation."""
    simulation = SensorRadarSimulation(scene, people, seed=seed)
    return (simulation.frame(index) for index in range(n_frames(scene.scan_period_s, duration_s)))


def simulate(
    scene: Scene,
    people: Sequence[Person],
    *,
    duration_s: float = CASE_STUDY_DURATION_S,
    seed: int = 0,
    n_reference: int = REFERENCE_SCANS,
    progress: Callable[[range], Iterable[int]] = iter,
) -> Recording:
    """A whole run in memory; `progress` goes through the frames, and may show how far it is."""
    simulation = SensorRadarSimulation(scene, people, seed=seed)
    total, radio, pulse = n_frames(scene.scan_period_s, duration_s), scene.radio, scene.pulse
    scans = np.empty((len(scene.nodes), total, radio.n_samples), dtype=np.float32)
    time_s = np.empty((len(scene.nodes), total))
    for index in progress(range(total)):
        frame = simulation.frame(index)
        scans[:, index], time_s[:, index] = frame.scans, frame.time_s
    nodes = tuple(
        NodeRecording(
            name=node.name,
            node_id=node.node_id,
            sample_rate_hz=radio.sample_rate_hz,
            first_sample_s=scene.first_sample_s(node),
            tx_position_m=np.array(node.tx_position_m),
            rx_position_m=np.array(node.rx_position_m),
            pulse=Pulse(kind=pulse.kind, centre_hz=pulse.centre_hz, bandwidth_hz=pulse.bandwidth_hz),
            time_s=time_s[which],
            scans=scans[which],
            reference=simulation.reference(which, n_reference),
        )
        for which, node in enumerate(scene.nodes)
    )
    frame_time_s: NDArray[np.float64] = np.arange(total, dtype=np.float64) * scene.scan_period_s
    truths = tuple(person_truth(person, frame_time_s) for person in people)
    return Recording(
        pipeline="sensor_radar",
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        site_toml="",
        nodes=nodes,
        truth=truths,
    )


def person_truth(person: Person, time_s: NDArray[np.float64]) -> PersonTruth:
    """A person's truth at times (n,)."""
    return PersonTruth(
        id=str(person.person_id),
        time_s=time_s,
        position_m=person.position_m(time_s),
        motion=person.motion,
        height_m=person.height_m,
    )


# The paper's walk: 9.15 m from right to left at 1.5 m/s, y chosen (Fig. 7 is a picture); then neighbours
# that keep apart.
CASE_STUDY_WALKS = (
    Walk(waypoints_m=((10.3, 2.6), (1.15, 2.6)), speed_mps=1.5),
    Walk(waypoints_m=((1.4, 4.6), (10.2, 4.4)), speed_mps=1.4),
    Walk(waypoints_m=((2.0, 0.9), (9.4, 1.1)), speed_mps=1.1),
    Walk(waypoints_m=((9.9, 5.4), (2.0, 5.5)), speed_mps=1.2),
    Walk(waypoints_m=((3.2, 3.5), (10.4, 3.6)), speed_mps=1.0),
)
CASE_STUDY_HEIGHTS_M = (1.85, 1.72, 1.65, 1.78, 1.90)


def case_study_people(count: int = 1) -> tuple[Person, ...]:
    """The paper's person and up to four others, all walking throughout."""
    return walkers(CASE_STUDY_WALKS, CASE_STUDY_HEIGHTS_M, count)
