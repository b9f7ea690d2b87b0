"""The through-wall case study as a whole."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from delays import bent_delay_s, clean_responses, peak_s
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.recording import read, write
from echofuse.simulation.fluctuation import RCS_DEVIATION_DB, Aspect, EchoFluctuation
from echofuse.simulation.people import Person
from echofuse.simulation.scene import Furniture
from echofuse.simulation.through_wall import ThroughWallSimulation, simulate_through_wall
from echofuse.simulation.through_wall_scene import (
    CASE_STUDY_WALKS,
    ThroughWallScene,
    case_study_walkers,
    through_wall_scene,
)
from echofuse.simulation.walk import Walk
from echofuse.simulation.wall import Wall

SCENE = through_wall_scene()
QUIET = replace(SCENE, radar=replace(SCENE.radar, noise_count=0.0))
BARE_ROOM = replace(SCENE.room, wall_reflections=(0.0,) * 4, floor_reflection=0.0, ceiling_reflection=0.0)
BARE = replace(QUIET, room=BARE_ROOM, furniture=())
Array = NDArray[np.float64]


def echo_of(scene: ThroughWallScene, people: Sequence[Person], time_s: Array, seed: int = 1) -> Array:
    """What the people change."""
    return clean_responses(scene, people, time_s, seed) - clean_responses(scene, (), np.zeros(1))


def standing(person_id: int, x_m: float, y_m: float) -> Person:
    walk = Walk(waypoints_m=((x_m, y_m), (x_m, y_m + 0.01)), speed_mps=1.0, stops_s=((0.0, 1e6),))
    return Person(person_id=person_id, walk=walk, radius_m=0.2)


def walking(start_m: tuple[float, float], end_m: tuple[float, float]) -> Person:
    return Person(person_id=1, walk=Walk(waypoints_m=(start_m, end_m), speed_mps=1.0), radius_m=0.2)


def test_a_run_is_a_recording_of_the_pipeline(tmp_path: Path) -> None:
    heard: list[range] = []

    def listening(frames: range) -> range:
        heard.append(frames)
        return frames

    run = simulate_through_wall(SCENE, case_study_walkers(2), seed=3, duration_s=0.75, progress=listening)
    assert heard == [range(10)]
    write(tmp_path / "run.h5", run)
    again = read(tmp_path / "run.h5")
    assert again.pipeline == "through_wall_2d"
    for node, name, node_id, x_m in zip(again.nodes, ("rx1", "rx2"), (1, 2), (-0.4, 0.4), strict=True):
        assert (node.name, node.node_id, node.sample_rate_hz) == (name, node_id, 4.5e9)
        np.testing.assert_allclose(node.rx_position_m, [x_m, 0.0, 1.2])
        np.testing.assert_allclose(node.tx_position_m, [0.0, 0.0, 1.2])
        np.testing.assert_allclose(node.time_s, 0.074 * np.arange(10))
        assert (node.scans.shape, node.scans.dtype, node.reference) == ((10, 511), np.float32, None)
    assert [person.id for person in again.truth] == ["1", "2"]
    np.testing.assert_allclose(again.truth[0].position_m[:, 1], 1.6 + 0.074 * np.arange(10))
    np.testing.assert_allclose(again.truth[1].position_m[:, 0], 0.825)


def test_a_run_is_a_function_of_scene_people_and_seed() -> None:
    def scans(seed: int, indices: Sequence[int] = (0, 1, 2)) -> NDArray[np.float32]:
        simulation = ThroughWallSimulation(SCENE, case_study_walkers(2), seed=seed)
        return np.stack([simulation.frame(index).scans for index in indices])

    first = scans(5)
    np.testing.assert_array_equal(first, scans(5))
    np.testing.assert_array_equal(first[::-1], scans(5, (2, 1, 0)))
    assert np.all(np.any(first != scans(6), axis=-1))
    start = ThroughWallSimulation(SCENE, (), seed=5).start_chip(0.0)
    noise = np.roll(first, -start, axis=-1) - clean_responses(
        QUIET, case_study_walkers(2), 0.074 * np.arange(3), 5
    )
    assert np.std(noise) == pytest.approx(SCENE.radar.noise_count, rel=0.05)
    pairs = np.corrcoef(noise.reshape(6, -1)) - np.eye(6)
    assert np.max(np.abs(pairs)) < 0.2  # every receiver and response has noise of its own


@pytest.mark.parametrize("seed", range(4))
def test_cross_talk_is_the_largest_peak_and_six_samples_late(seed: int) -> None:
    run = simulate_through_wall(SCENE, case_study_walkers(2), seed=seed, duration_s=0.75)
    start = ThroughWallSimulation(SCENE, (), seed=seed).start_chip(0.0)
    for node in run.nodes:
        peak = np.argmax(np.abs(node.scans), axis=1)
        np.testing.assert_array_equal(peak, (6 + start) % 511)
        assert np.all(node.scans[:, peak[0]] > 0.0)
    largest = np.sort(np.abs(clean_responses(QUIET, (), np.zeros(1))[0, 0]))[::-1]
    assert largest[0] > 2.0 * largest[1]  # the wall's front comes next


def test_cross_talk_peaks_at_the_antennas_distance() -> None:
    far_wall = replace(BARE, wall=Wall(front_m=3.0), room=replace(BARE.room, lower_m=(-2.35, 3.24, 0.0)))
    response = clean_responses(far_wall, (), np.zeros(1))[0, 1]
    assert peak_s(response, 4.5e9) == pytest.approx(0.4 / SPEED_OF_LIGHT_MPS, abs=5e-12)


def test_the_start_chip_is_drawn_at_every_power_up_for_all_receivers() -> None:
    starts = [ThroughWallSimulation(SCENE, (), seed=seed).start_chip(0.0) for seed in range(200)]
    assert 0 <= min(starts) < 50
    assert 460 < max(starts) < 511
    run = simulate_through_wall(SCENE, (), seed=8, duration_s=2.96, power_up_s=(1.5,))
    peaks = np.stack([np.argmax(node.scans, axis=1) for node in run.nodes])
    np.testing.assert_array_equal(peaks[0], peaks[1])
    before, after = peaks[0][run.nodes[0].time_s < 1.5], peaks[0][run.nodes[0].time_s >= 1.5]
    assert len(set(before)) == len(set(after)) == 1
    assert before[0] != after[0]
    unrotated = [np.mean(np.roll(node.scans, -6 - before[0], axis=1)[:20], axis=0) for node in run.nodes]
    anew = [np.mean(np.roll(node.scans, -6 - after[0], axis=1)[21:], axis=0) for node in run.nodes]
    np.testing.assert_allclose(unrotated, anew, atol=6.0 * SCENE.radar.noise_count * math.sqrt(2.0 / 19.0))


@pytest.mark.parametrize("at_m", [(0.0, 4.0, 1.2), (1.5, 3.5, 1.2), (-1.9, 1.5, 0.4)])
def test_an_echo_through_the_wall_is_as_late_as_snell_says(at_m: tuple[float, float, float]) -> None:
    scene = replace(BARE, furniture=(Furniture(position_m=at_m, rcs_m2=1.0),))
    with_and_without = [clean_responses(each, (), np.zeros(1))[0] for each in (scene, BARE)]
    for node, echo in zip(scene.nodes, with_and_without[0] - with_and_without[1], strict=True):
        legs = [
            bent_delay_s(scene.wall, np.array(antenna), np.array(at_m))
            for antenna in (node.tx_position_m, node.rx_position_m)
        ]
        # Echoes inside the wall, -23 dB and 14 samples later, pull the peak by less than half a picosecond.
        assert peak_s(echo, 4.5e9) == pytest.approx(sum(legs), rel=0.0, abs=1e-12)


def test_a_target_s_echo_falls_with_the_product_of_both_ways() -> None:
    near_m, far_m = 2.0, 5.0
    energies = []
    for y_m in (near_m, far_m):
        scene = replace(BARE, furniture=(Furniture(position_m=(0.0, y_m, 1.2), rcs_m2=1.0),))
        echo = (clean_responses(scene, (), np.zeros(1)) - clean_responses(BARE, (), np.zeros(1)))[0, 0]
        energies.append(np.sum(echo**2))  # the largest sample would depend on the delay's fraction
    expected = (far_m * math.hypot(0.4, far_m)) / (near_m * math.hypot(0.4, near_m))
    assert math.sqrt(energies[0] / energies[1]) == pytest.approx(
        expected, rel=0.05
    )  # 0.4 m aside counts for 2 m: pattern


def test_signal_to_noise_is_31_db_at_2_m_and_15_db_at_the_far_wall() -> None:
    """Power of a response's largest sample after exponential averaging (0.95), over the noise's variance."""
    time_s = 0.074 * np.arange(300)
    near, far = [], []
    for seed in range(6):
        person = walking((0.0, 1.3), (0.0, 5.85))
        responses = clean_responses(QUIET, (person,), time_s, seed)[:, 0]
        average, peak = responses[0], np.empty(len(responses))
        for index, response in enumerate(responses):
            average = 0.95 * average + 0.05 * response
            peak[index] = np.max(np.abs(response - average))
        y_m = person.position_m(time_s)[:, 1]
        settled = time_s > 3.0
        near.append(np.mean(peak[settled & (np.abs(y_m - 2.0) < 0.2)] ** 2))
        far.append(np.mean(peak[settled & (y_m > 5.6)] ** 2))
    noise = SCENE.radar.noise_count**2
    assert 10.0 * np.log10(np.mean(near) / noise) == pytest.approx(
        31.0, abs=2.0
    )  # the budget of docs/through_wall.md
    assert 10.0 * np.log10(np.mean(far) / noise) == pytest.approx(15.0, abs=2.0)


def test_a_person_s_echo_is_as_deep_as_a_body_and_begins_at_the_skin() -> None:
    person = walking((0.0, 2.0), (0.0, 4.0))
    time_s = 0.074 * np.arange(10, 20)
    echo = np.abs(echo_of(BARE, (person,), time_s)[:, 0])
    axis_m = person.position_m(time_s)[:, 1]
    delay_m = axis_m + np.hypot(axis_m, 0.4) + 2.0 * 0.24
    for response, at in zip(echo, delay_m * 4.5e9 / SPEED_OF_LIGHT_MPS, strict=True):
        strong = np.flatnonzero(response > 0.25 * response.max())
        assert 4 <= strong[-1] - strong[0] <= 30
        assert -12.0 <= strong[0] - at <= -1.0  # up to 0.4 m before the torso's axis, half of it is depth
        assert response.max() > 3.0 * np.sort(response)[-40]


def test_a_person_s_echo_fluctuates_while_walking_and_not_while_standing() -> None:
    at_3_m = walking((-0.5, 3.0), (0.5, 3.0))
    moving = np.max(np.abs(echo_of(BARE, (at_3_m,), 0.074 * np.arange(150))), axis=2)
    decibel = 20.0 * np.log10(moving)
    assert np.all((decibel.std(axis=0) > 1.5) & (decibel.std(axis=0) < 6.0))
    still = np.sum(echo_of(BARE, (standing(1, 0.0, 3.0),), 0.074 * np.arange(50)) ** 2, axis=2)
    sway_db = np.std(10.0 * np.log10(still), axis=0)  # the chest moves by millimetres, against other parts
    assert np.all((sway_db > 0.0) & (sway_db < 0.5))


def test_fluctuation_has_its_moments_and_one_lobe_of_correlation() -> None:
    width_m, height_m, wavelength_m = 0.48, 0.6, 0.266
    lobe_rad, upright_rad = wavelength_m / (2.0 * width_m), wavelength_m / (2.0 * height_m)
    pairs = []
    for seed in range(4000):
        one = EchoFluctuation(
            np.random.default_rng(seed), width_m=width_m, height_m=height_m, wavelength_m=wavelength_m
        )
        here, beside, above = Aspect(1.0, 0.2), Aspect(1.0 + lobe_rad, 0.2), Aspect(1.0, 0.2 + upright_rad)
        pairs.append(
            [
                one.amplitude(3.3, here),
                one.amplitude(3.3, beside),
                one.amplitude(3.3, above),
                one.amplitude(3.35, here),
            ]
        )
    amplitude = np.array(pairs)
    decibel = 20.0 * np.log10(amplitude)
    np.testing.assert_allclose(decibel.std(axis=0), RCS_DEVIATION_DB, rtol=0.05)
    np.testing.assert_allclose(np.mean(amplitude**2, axis=0), 1.0, atol=0.05)
    correlation = np.corrcoef(decibel.T)
    assert correlation[0, 1] == pytest.approx(math.exp(-1.0), abs=0.06)
    assert correlation[0, 2] == pytest.approx(math.exp(-1.0), abs=0.06)
    assert correlation[0, 3] > 0.7  # 60 ms later
    flat = EchoFluctuation(np.random.default_rng(0), width_m=width_m, wavelength_m=wavelength_m)
    assert flat.amplitude(3.3, here) == flat.amplitude(3.3, above)


def test_somebody_near_takes_the_light_of_somebody_far() -> None:
    far = standing(2, 0.0, 5.0)
    alone = echo_of(BARE, (far,), np.zeros(1))[0, 0]
    energy = {}
    for name, near in (("before", standing(1, 0.0, 2.0)), ("beside", standing(1, 1.8, 2.0))):
        both = echo_of(BARE, (near, far), np.zeros(1))[0, 0]
        window = slice(145, 175)  # 9.7 to 11.7 m: the far one, both ways and twice the wall
        energy[name] = 10.0 * math.log10(np.sum(both[window] ** 2) / np.sum(alone[window] ** 2))
    assert energy["before"] < -4.0
    assert abs(energy["beside"]) < 1.0


def test_people_shade_the_far_wall() -> None:
    echo = echo_of(QUIET, (standing(1, 0.0, 2.0),), np.zeros(1))[0, 0]
    far_wall = round((2.0 * 6.1 + 0.48) * 4.5e9 / SPEED_OF_LIGHT_MPS)
    empty = clean_responses(QUIET, (), np.zeros(1))[0, 0]
    around = slice(far_wall - 3, far_wall + 6)
    at = far_wall - 3 + int(np.argmax(np.abs(empty[around])))
    assert echo[at] * empty[at] < 0.0
    assert 0.1 < -echo[at] / empty[at] < 0.9


def test_people_s_echoes_go_over_the_room_s_walls_too() -> None:
    mirrors = replace(BARE, room=replace(BARE.room, wall_reflections=(0.0, 0.0, 0.0, -0.45)))
    person = standing(1, 0.0, 3.0)
    over_the_wall = echo_of(mirrors, (person,), np.zeros(1)) - echo_of(BARE, (person,), np.zeros(1))
    there = 3.0 + 0.24
    back = (6.1 - 3.0) + 6.1 + 0.24
    peak = np.argmax(np.abs(over_the_wall[0, 0]))
    assert peak * SPEED_OF_LIGHT_MPS / 4.5e9 == pytest.approx(there + back, abs=0.5)


def test_the_paper_s_paths_have_its_dimensions_and_stay_in_the_room() -> None:
    first, second, *_ = CASE_STUDY_WALKS
    (x1, y1), (x2, y2) = first.waypoints_m
    (x3, y3), (x4, y4) = second.waypoints_m
    assert (x1, y1, x3, y3) == (x2, y4, x4, y2)  # two aisles, walked in opposite directions
    assert x3 - x1 == pytest.approx(1.65)
    assert y2 - y1 == pytest.approx(3.8)
    size_m = np.subtract(SCENE.room.upper_m, SCENE.room.lower_m)
    np.testing.assert_allclose(size_m[:2], [4.7, 5.62])
    for count in range(5):
        people = case_study_walkers(count)
        assert len(people) == count
        assert all(SCENE.holds(person) for person in people)
    time_s = np.arange(0.0, 200.0, 0.05)
    positions = np.stack([person.position_m(time_s)[:, :2] for person in case_study_walkers(4)])
    apart = np.linalg.norm(positions[:, np.newaxis] - positions, axis=-1) + 9.0 * np.eye(4)[..., np.newaxis]
    assert np.min(apart) > 0.8  # nobody walks through anybody


def test_a_cross_of_four_receivers_at_7_ghz() -> None:
    scene = through_wall_scene(n_receivers=4, spacing_m=0.39, order=12, clock_hz=7e9, response_period_s=0.1)
    above_and_below = [node.rx_position_m for node in scene.nodes][2:]
    np.testing.assert_allclose(above_and_below, [(0.0, 0.0, 0.81), (0.0, 0.0, 1.59)], rtol=1e-12)
    run = simulate_through_wall(scene, case_study_walkers(1), seed=2, duration_s=0.2)
    start = ThroughWallSimulation(scene, (), seed=2).start_chip(0.0)
    assert run.pipeline == "through_wall_3d"
    for node in run.nodes:
        assert node.scans.shape == (2, 4095)
        peak = np.argmax(np.abs(node.scans), axis=1)
        np.testing.assert_array_equal(peak, (9 + start) % 4095)  # 0.39 m are 9.1 samples


@pytest.mark.parametrize(
    ("people", "duration_s", "message"),
    [
        ((walking((0.0, 1.0), (0.0, 6.0)),), 1.0, "person 1 walks out of the room"),
        ((standing(1, 0.0, 2.0), standing(1, 1.0, 2.0)), 1.0, "person_id"),
        ((), 0.05, "duration_s"),
    ],
)
def test_impossible_runs_are_refused(people: Sequence[Person], duration_s: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        simulate_through_wall(SCENE, people, seed=0, duration_s=duration_s)


def test_impossible_scenes_are_refused() -> None:
    (first, second), room = SCENE.nodes, SCENE.room
    for change, message in (
        ({"nodes": ()}, "at least one"),
        ({"nodes": (first, replace(second, node_id=1))}, "node_id"),
        ({"nodes": (first, replace(second, tx_position_m=(0.0, 0.1, 1.2)))}, "one transmitter"),
        ({"nodes": (replace(first, rx_position_m=(0.0, 0.3, 1.2)),)}, "rx1 does not stand before the wall"),
        ({"nodes": (replace(first, rx_position_m=first.tx_position_m),)}, "rx1 stands on the transmitter"),
        ({"wall": Wall(thickness_m=0.5)}, "behind the wall"),
        ({"room": replace(room, wall_reflections=(0.0, 0.0, -0.3, 0.0))}, "front wall"),
        ({"furniture": (Furniture(position_m=(0.0, 0.3, 1.0), rcs_m2=1.0),)}, "not behind the wall"),
    ):
        with pytest.raises(ValueError, match=message):
            replace(SCENE, **change)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="n_receivers: 3"):
        through_wall_scene(n_receivers=3)
    with pytest.raises(ValueError, match="count: 5, expected 0 to 4"):
        case_study_walkers(5)
