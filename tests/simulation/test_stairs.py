"""The stairs behind the wall: geometry, delays, power, and the body that climbs."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from delays import bent_delay_s, clean_responses, peak_s
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.recording import read, write
from echofuse.simulation.fluctuation import Aspect, EchoFluctuation
from echofuse.simulation.people import Body, Person
from echofuse.simulation.scene import Furniture
from echofuse.simulation.stairs import (
    BODY_SIZE_M,
    FLOOR_M,
    POINTS_M,
    RADAR,
    RISE_M,
    RUN_M,
    SPACING_M,
    SPEED_MPS,
    UPPER_FLOOR_M,
    WALL,
    body_cuboid,
    simulate_stairs,
    stairs_climber,
    stairs_scene,
)
from echofuse.simulation.through_wall import ThroughWallSimulation, simulate_through_wall
from echofuse.simulation.through_wall_scene import ThroughWallScene, case_study_walkers, through_wall_scene
from echofuse.simulation.walk import Walk

Array = NDArray[np.float64]
SCENE, CLIMBER = stairs_scene(), stairs_climber()
CLIMB_S = CLIMBER.walk.length_m / SPEED_MPS
QUIET = replace(SCENE, radar=replace(SCENE.radar, noise_count=0.0))
BARE = replace(
    QUIET,
    room=replace(SCENE.room, wall_reflections=(0.0,) * 4, floor_reflection=0.0, ceiling_reflection=0.0),
    furniture=(),
)


def point_echoes(at_m: tuple[float, float, float]) -> Array:
    """(4, n_samples) [count] of 1 m^2 in an otherwise empty place."""
    scene = replace(BARE, furniture=(Furniture(position_m=at_m, rcs_m2=1.0),))
    return np.asarray((clean_responses(scene, (), np.zeros(1)) - clean_responses(BARE, (), np.zeros(1)))[0])


def body_echoes(scene: ThroughWallScene, time_s: Array, seed: int) -> Array:
    """(n, 4, n_samples) [count] of what the climber changes, without noise."""
    return clean_responses(scene, (CLIMBER,), time_s, seed) - clean_responses(scene, (), np.zeros(1))


def climbing(start_m: tuple[float, float, float], end_m: tuple[float, float, float]) -> Person:
    return replace(CLIMBER, walk=Walk(waypoints_m=(start_m, end_m), speed_mps=0.5))


def test_a_run_is_a_recording_of_the_pipeline(tmp_path: Path) -> None:
    write(tmp_path / "run.h5", simulate_stairs(SCENE, seed=3, duration_s=0.4))
    run = read(tmp_path / "run.h5")
    assert run.pipeline == "through_wall_3d"
    cross = ((-0.39, 0.0, 0.0), (0.39, 0.0, 0.0), (0.0, 0.0, -0.39), (0.0, 0.0, 0.39))
    for index, (node, rx_m) in enumerate(zip(run.nodes, cross, strict=True), start=1):
        assert (node.name, node.node_id, node.sample_rate_hz) == (f"rx{index}", index, 7e9)
        np.testing.assert_allclose(node.tx_position_m, np.zeros(3))
        np.testing.assert_allclose(node.rx_position_m, rx_m)
        np.testing.assert_allclose(node.time_s, 0.074 * np.arange(5))
        assert (node.scans.shape, node.scans.dtype) == ((5, 4095), np.float32)
    (truth,) = run.truth
    assert (truth.position_m.shape, truth.height_m, truth.motion) == ((5, 3), 1.8, "climbing")


def test_a_run_is_a_function_of_scene_and_seed() -> None:
    first, again, other = (simulate_stairs(SCENE, seed=seed, duration_s=0.3) for seed in (5, 5, 6))
    for node, same, different in zip(first.nodes, again.nodes, other.nodes, strict=True):
        np.testing.assert_array_equal(node.scans, same.scans)
        assert np.all(np.any(node.scans != different.scans, axis=1))
    responses = ThroughWallSimulation(SCENE, (CLIMBER,), seed=5).frame(3).scans  # in any order
    np.testing.assert_array_equal(responses, np.stack([node.scans[3] for node in first.nodes]))


def test_one_climb_goes_from_the_first_point_to_the_last() -> None:
    slow = replace(SCENE, radar=replace(SCENE.radar, order=7))  # fewer samples, the same walk
    (truth,) = simulate_stairs(slow, seed=0).truth
    assert len(truth.time_s) == int(CLIMB_S / 0.074)
    above_ground = np.array([0.0, 0.0, CLIMBER.centre_height_m])
    np.testing.assert_allclose(truth.position_m[0], np.array(POINTS_M[0]) + above_ground)
    assert math.dist(truth.position_m[-1], np.array(POINTS_M[7]) + above_ground) < 2.0 * 0.074 * SPEED_MPS
    after = CLIMBER.position_m(np.array([CLIMB_S, 2.0 * CLIMB_S])) - above_ground
    np.testing.assert_allclose(after, [POINTS_M[7], POINTS_M[0]], atol=1e-9)


def test_the_climb_has_constant_speed_and_the_stairs_slope() -> None:
    time_s = np.arange(0.0, CLIMB_S, 0.01)
    position_m = CLIMBER.position_m(time_s)
    speed_mps = np.linalg.norm(np.diff(position_m, axis=0), axis=1) / 0.01
    corners_s = np.cumsum([math.dist(a, b) for a, b in pairwise(POINTS_M)]) / SPEED_MPS
    straight = np.all(np.abs(time_s[:-1, np.newaxis] + 0.005 - corners_s) > 0.01, axis=1)
    np.testing.assert_allclose(speed_mps[straight], SPEED_MPS, rtol=1e-9)
    slope = np.diff(position_m[:, 2]) / np.linalg.norm(np.diff(position_m[:, :2], axis=0), axis=1)
    climbing = straight & (slope > 1e-9)
    np.testing.assert_allclose(slope[climbing], RISE_M / RUN_M)
    assert 0.01 * np.sum(climbing) == pytest.approx(2 * 10 * math.hypot(RISE_M, RUN_M) / SPEED_MPS, abs=0.1)
    np.testing.assert_allclose(UPPER_FLOOR_M - FLOOR_M, 20 * RISE_M)
    assert 0.60 <= 2.0 * RISE_M + RUN_M <= 0.65  # Blondel's rule
    cycles = CLIMBER.gait_cycles(CLIMB_S) - CLIMBER.gait_cycles(0.0)
    assert cycles == pytest.approx(12.0 / (2.0 * math.hypot(RISE_M, RUN_M)))


@pytest.mark.parametrize("seed", range(3))
def test_the_body_stays_within_the_paper_s_cuboid(seed: int) -> None:
    body = Body(CLIMBER, np.random.default_rng(seed))
    time_s = np.linspace(0.0, CLIMB_S, 400)
    lower_m, upper_m = body_cuboid(CLIMBER.position_m(time_s), CLIMBER.height_m)
    np.testing.assert_allclose(upper_m - lower_m, np.tile(BODY_SIZE_M, (400, 1)))
    np.testing.assert_allclose(lower_m[:, 2], CLIMBER.walk.ground_m(time_s))
    skin_m = np.stack([body.scatterers(t).position_m for t in time_s])  # (400, n, 3)
    tallest_m = np.ptp(skin_m[..., 2], axis=1)
    assert np.all((tallest_m > 1.5) & (tallest_m < 1.8))
    outside_m = np.maximum(lower_m[:, np.newaxis] - skin_m, skin_m - upper_m[:, np.newaxis])
    assert np.max(outside_m) < 0.03  # a toe, at times
    assert np.mean(np.all(outside_m < 0.0, axis=2)) > 0.999


@pytest.mark.parametrize(
    "at_m", [(0.0, 2.0, 0.0), (-0.75, 5.85, -1.58), (0.75, 5.0, 1.6), (0.75, 1.0, 1.2), (-1.2, 0.6, -0.5)]
)
def test_echoes_are_as_late_as_snell_says_in_every_plane(at_m: tuple[float, float, float]) -> None:
    for node, echo in zip(BARE.nodes, point_echoes(at_m), strict=True):
        legs_s = [
            bent_delay_s(WALL, np.array(antenna), np.array(at_m))
            for antenna in (node.tx_position_m, node.rx_position_m)
        ]
        assert (peak_s(echo, 7e9) - sum(legs_s)) * 7e9 == pytest.approx(0.0, abs=1e-3)  # samples
        straight_m = math.dist(node.tx_position_m, at_m) + math.dist(at_m, node.rx_position_m)
        assert sum(legs_s) * SPEED_OF_LIGHT_MPS >= straight_m + 2.0 * 0.2  # two walls, and more if slanted


def test_receivers_above_and_below_hear_a_high_place_as_left_and_right_hear_one_aside() -> None:
    """The cross looks the same after a quarter turn about the wall's normal."""
    left, right, below, above = point_echoes((0.9, 3.0, 0.0))
    turned = point_echoes((0.0, 3.0, 0.9))
    scale = float(np.max(np.abs(left)))
    for was, now in ((left, turned[2]), (right, turned[3]), (below, turned[0]), (above, turned[1])):
        np.testing.assert_allclose(now, was, atol=1e-9 * scale)
    assert np.max(np.abs(left - right)) > 0.5 * scale


def test_cross_talk_is_the_largest_peak_and_nine_samples_late() -> None:
    run = simulate_stairs(SCENE, seed=1, duration_s=0.6, power_up_s=(0.3,))
    simulation = ThroughWallSimulation(SCENE, (), seed=1, power_up_s=(0.3,))
    starts = [simulation.start_chip(float(t)) for t in run.nodes[0].time_s]
    assert len(set(starts)) == 2
    for node in run.nodes:
        peak = np.argmax(np.abs(node.scans), axis=1)
        np.testing.assert_array_equal(peak, (9 + np.array(starts)) % 4095)  # 0.39 m are 9.1 samples
    response = clean_responses(QUIET, (), np.zeros(1))[0, 0]
    largest = np.sort(np.abs(response))[::-1]
    assert largest[0] > 2.0 * largest[1]
    assert peak_s(response, 7e9) * SPEED_OF_LIGHT_MPS == pytest.approx(SPACING_M, abs=0.01)


def test_a_point_has_the_power_of_the_radar_equation() -> None:
    echo = point_echoes((0.0, 3.0, 0.0))[0]
    wavelength_m = SPEED_OF_LIGHT_MPS / 1.75e9
    rx_m = math.hypot(3.0, 0.39)
    free = wavelength_m / ((4.0 * math.pi) ** 1.5 * 3.0 * rx_m)
    antennas = 10.0 ** (6.0 / 10.0) * (2.8 / math.hypot(2.8, 0.36))  # cosine: about where the bent ray goes
    wall = (8.0 / 9.0 * 10.0 ** (-21.3 * 0.2 / 20.0)) ** 2
    assert np.max(np.abs(echo)) == pytest.approx(4e5 * free * antennas * wall, rel=0.2)  # between two samples
    far = point_echoes((0.0, 6.0, 0.0))[0]
    ratio = math.sqrt(np.sum(echo**2) / np.sum(far**2))
    assert ratio == pytest.approx(6.0 * math.hypot(6.0, 0.39) / (3.0 * rx_m), rel=0.03)


def test_noise_is_that_of_a_receiver_with_10_db_after_one_sequence() -> None:
    thermal_w = 1.380649e-23 * 290.0 * 10.0 * RADAR.clock_hz / 2.0
    expected = RADAR.count_at_unit_gain * math.sqrt(thermal_w / 1e-3 / RADAR.n_samples)  # 1 mW sent
    assert RADAR.noise_count == pytest.approx(expected, rel=0.03)
    noise = simulate_stairs(SCENE, seed=2, duration_s=0.2)
    clean = clean_responses(QUIET, (CLIMBER,), 0.074 * np.arange(2), 2)
    start = ThroughWallSimulation(SCENE, (), seed=2).start_chip(0.0)
    left = np.stack([np.roll(node.scans, -start, axis=1) for node in noise.nodes], axis=1) - clean
    assert np.std(left) == pytest.approx(RADAR.noise_count, rel=0.02)
    assert np.max(np.abs(np.corrcoef(left.reshape(8, -1)) - np.eye(8))) < 0.1


def test_signal_to_noise_on_the_stairs_is_that_of_the_page() -> None:
    """At P1, in mid-flight, on the landing, in mid-flight, at P8."""
    time_s = np.array([0.0, 5.6, 10.6, 18.4, 24.0])
    echoes = np.stack([body_echoes(BARE, time_s, seed) for seed in range(8)])  # (8, 5, 4, n_samples)
    peak = np.mean(np.max(np.abs(echoes), axis=3) ** 2, axis=(0, 2))
    decibel = 10.0 * np.log10(peak) - 20.0 * math.log10(RADAR.noise_count)
    np.testing.assert_allclose(decibel, [18.0, 28.5, 43.0, 28.5, 18.0], atol=2.0)  # docs/stairs.md
    # And in all, energy is that of a point of the person's cross section, whichever side it sees.
    places = [tuple(float(value) for value in at) for at in CLIMBER.position_m(time_s)]
    points = np.array([np.mean(np.sum(point_echoes((x, y, z)) ** 2, axis=1)) for x, y, z in places])
    cross_section_m2 = np.mean(np.sum(echoes**2, axis=3), axis=(0, 2)) / points
    assert np.all(np.abs(10.0 * np.log10(cross_section_m2 / CLIMBER.rcs_m2)) < 3.0)


def test_the_echo_begins_at_the_skin_and_ends_with_the_body_s_tail() -> None:
    time_s = np.array([2.0, 5.0, 8.0, 17.0, 21.0])
    for at, echoes in zip(CLIMBER.position_m(time_s), np.abs(body_echoes(BARE, time_s, 4)), strict=True):
        for node, echo in zip(BARE.nodes, echoes, strict=True):
            antennas_m = np.array([node.tx_position_m, node.rx_position_m])
            axis_s = sum(bent_delay_s(WALL, antenna_m, at) for antenna_m in antennas_m)
            strong = np.flatnonzero(echo > 0.25 * np.max(echo)) - axis_s * 7e9
            assert -24 < strong[0] < 0  # half a metre before the axis, there and back
            assert strong[-1] < 60


def test_each_receiver_sees_the_fluctuation_from_its_own_side(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Aspect] = []

    def respond(self: EchoFluctuation, cycles: float, aspect: Aspect, frequency_hz: Array) -> Array:
        assert self.amplitude(cycles, aspect) != self.amplitude(cycles, Aspect(aspect.azimuth_rad, 1.0))
        seen.append(aspect)
        return np.ones(len(frequency_hz))

    monkeypatch.setattr(EchoFluctuation, "response", respond)
    clean_responses(BARE, (CLIMBER,), np.array([17.0]))
    middle_m = np.mean(Body(CLIMBER, np.random.default_rng(0)).scatterers(17.0).position_m, axis=0)
    for node, aspect in zip(BARE.nodes, seen, strict=True):
        ways = np.array([node.tx_position_m, node.rx_position_m]) - middle_m
        east, north, up = np.sum(ways / np.linalg.norm(ways, axis=1, keepdims=True), axis=0)
        assert aspect.azimuth_rad == pytest.approx(math.atan2(north, east), abs=0.01)
        assert aspect.elevation_rad == pytest.approx(math.atan2(up, math.hypot(east, north)), abs=0.01)
    assert seen[3].elevation_rad - seen[2].elevation_rad > 0.1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"duration_s": 0.05}, "duration_s"),
        ({"scene": through_wall_scene()}, "through-wall has 2 receivers, expected 4"),
        ({"person": case_study_walkers(1)[0]}, r"needs waypoints \(x, y, z\): the floor is at z = -2.8 m"),
        ({"person": climbing((0.0, 2.0, -3.0), (0.0, 3.0, 0.0))}, "walks out of the room"),
        ({"person": climbing((0.0, 2.0, 0.0), (0.0, 3.0, 2.0))}, "walks out of the room"),
    ],
)
def test_impossible_runs_are_refused(change: dict[str, object], message: str) -> None:
    arguments: dict[str, object] = {"scene": SCENE, "seed": 0, "duration_s": 1.0, **change}
    with pytest.raises(ValueError, match=message):
        simulate_stairs(**arguments)  # type: ignore[arg-type]


def test_impossible_scenes_and_people_are_refused() -> None:
    with pytest.raises(ValueError, match=r"spacing_m: 0\.0, expected a positive"):
        stairs_scene(spacing_m=0.0)
    with pytest.raises(ValueError, match="response_period_s"):
        stairs_scene(response_period_s=0.0)
    with pytest.raises(ValueError, match="speed_mps"):
        stairs_climber(speed_mps=0.0)
    with pytest.raises(ValueError, match="stride_m"):
        replace(CLIMBER, stride_m=0.0)


def test_any_place_before_the_wall_will_do_for_a_receiver() -> None:
    extra = replace(SCENE.nodes[0], name="rx5", node_id=5, rx_position_m=(0.6, -0.1, 0.6))
    run = simulate_through_wall(
        replace(SCENE, nodes=(*SCENE.nodes, extra)), (CLIMBER,), seed=1, duration_s=0.2
    )
    assert run.pipeline == "through_wall_3d"
    start = ThroughWallSimulation(SCENE, (), seed=1).start_chip(0.0)
    at = round(math.hypot(0.6, 0.1, 0.6) * 7e9 / SPEED_OF_LIGHT_MPS)
    assert np.argmax(np.abs(run.nodes[4].scans[0])) == (at + start) % 4095
