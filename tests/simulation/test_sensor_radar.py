"""The case study as a whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import hilbert

from echofuse.simulation.people import Person
from echofuse.simulation.propagation import echo_paths
from echofuse.simulation.scene import Scene, sensor_radar_scene
from echofuse.simulation.sensor_radar import (
    SensorRadarSimulation,
    case_study_people,
    n_frames,
    simulate,
    simulate_frames,
)
from echofuse.simulation.walk import Walk

SCENE = sensor_radar_scene()
STEADY = replace(
    SCENE, radio=replace(SCENE.radio, timing_jitter_s=0.0, lock_slip_probability=0.0, quantise=False)
)


def crossing_walker(scene: Scene) -> Person:
    """Walks across the line from the shared Tx to rx3, which is x = 5.75, at t = 2 s."""
    assert scene.nodes[2].tx_position_m[0] == scene.nodes[2].rx_position_m[0] == 5.75
    return Person(person_id=1, walk=Walk(waypoints_m=((3.75, 3.0), (7.75, 3.0)), speed_mps=1.0))


def test_a_run_has_the_shapes_of_a_recording() -> None:
    heard: list[range] = []

    def listening(frames: range) -> range:
        heard.append(frames)
        return frames

    run = simulate(
        SCENE,
        case_study_people(2),
        duration_s=0.3,
        seed=4,
        n_reference=2,
        progress=listening,
    )
    assert heard == [range(3)]
    assert len(run.nodes) == 6
    assert [person.id for person in run.truth] == ["1", "2"]
    for node in run.nodes:
        assert node.scans.shape == (3, 1920)
        assert node.reference.shape == (2, 1920)
        assert node.scans.dtype == node.reference.dtype == np.float32
        np.testing.assert_allclose(node.time_s, [0.0, 0.1, 0.2])
    truth = run.truth[0]
    np.testing.assert_allclose(truth.position_m[:, 0], [10.3, 10.15, 10.0])
    assert truth.position_m.shape == (3, 3)
    assert n_frames(SCENE.scan_period_s, 6.1) == 61


def test_a_run_is_a_function_of_scene_people_and_seed() -> None:
    def scans(scene: Scene, seed: int) -> dict[str, NDArray[np.float32]]:
        frame = list(simulate_frames(scene, case_study_people(1), duration_s=0.2, seed=seed))[1]
        return {node.name: scan for node, scan in zip(scene.nodes, frame.scans, strict=True)}

    first, again = scans(SCENE, 5), scans(SCENE, 5)
    turned = scans(replace(SCENE, nodes=SCENE.nodes[::-1]), 5)
    other = scans(SCENE, 6)
    for name, scan in first.items():
        np.testing.assert_array_equal(scan, again[name])
        np.testing.assert_array_equal(scan, turned[name])
        assert np.any(scan != other[name])


def test_frames_do_not_depend_on_which_came_before() -> None:
    one, other = (SensorRadarSimulation(SCENE, case_study_people(1), seed=1) for _ in range(2))
    one.frame(0)
    np.testing.assert_array_equal(one.frame(7).scans, other.frame(7).scans)


def test_the_reference_holds_no_person_and_the_scans_do() -> None:
    empty = SensorRadarSimulation(STEADY, (), seed=2)
    peopled = SensorRadarSimulation(STEADY, case_study_people(3), seed=2)
    sigma = STEADY.radio.noise_deviation_v * STEADY.radio.count_per_volt
    for which in range(len(STEADY.nodes)):
        reference = peopled.reference(which, 5)
        np.testing.assert_array_equal(reference, empty.reference(which, 5))
        noise = (reference[1:] - reference[0]) / np.sqrt(2.0)  # nothing but noise changes in an empty room
        assert np.std(noise) == pytest.approx(sigma, rel=0.05)
        change = peopled.frame(10).scans[which] - reference[0]
        assert np.max(np.abs(change)) > 20.0 * sigma


def test_every_node_has_its_own_room_and_its_own_noise() -> None:
    run = simulate(STEADY, (), duration_s=0.1, seed=2, n_reference=1)
    head = slice(0, 280)  # before the direct path: noise alone
    noise = [scan[head] for node in run.nodes for scan in (node.scans[0], node.reference[0])]
    off_diagonal = np.corrcoef(noise)[np.triu_indices(len(noise), 1)]
    assert np.max(np.abs(off_diagonal)) < 0.5
    for node in run.nodes:
        assert np.corrcoef(node.scans[0], node.reference[0])[0, 1] > 0.999


def test_a_person_on_the_line_of_sight_dims_the_direct_path() -> None:
    simulation = SensorRadarSimulation(STEADY, (crossing_walker(STEADY),), seed=0)
    direct_db = [20.0 * np.log10(simulation.paths(2, t).gain[0]) for t in (0.0, 2.0, 4.0)]
    assert direct_db[0] == pytest.approx(direct_db[2], abs=0.01)
    assert 4.0 < direct_db[0] - direct_db[1] < 15.0


def test_a_person_leaves_ghosts_that_are_negative_peaks() -> None:
    simulation = SensorRadarSimulation(STEADY, (crossing_walker(STEADY),), seed=0)
    empty = np.abs(hilbert(np.mean(simulation.reference(2, 10), axis=0)))
    difference = np.abs(hilbert(simulation.frame(20).scans[2])) - empty
    late = slice(400, 1900)  # well after the direct path
    assert difference[late].min() < -0.3 * empty[late].max()


@pytest.mark.parametrize("monostatic", [False, True])
def test_the_echo_follows_the_truth(monostatic: bool) -> None:
    scene = replace(sensor_radar_scene(monostatic=monostatic), furniture=(), radio=STEADY.radio)
    people = case_study_people(1)
    simulation = SensorRadarSimulation(scene, people, seed=3)
    room = SensorRadarSimulation(scene, (), seed=3)
    errors = []
    for index in (5, 25, 45, 58):
        frame = simulation.frame(index)
        quiet = room.frame(index)
        for which, node in enumerate(scene.nodes):
            change = np.abs(hilbert(frame.scans[which] - quiet.scans[which]))  # same noise, other people
            x = people[0].position_m(frame.time_s[which : which + 1])[0]
            path_m = np.linalg.norm(x - node.tx_position_m) + np.linalg.norm(x - node.rx_position_m)
            first = int(np.flatnonzero(change > 0.3 * change.max())[0])
            delay_s = scene.first_sample_s(node) + first / scene.radio.sample_rate_hz
            errors.append(delay_s * 299_792_458.0 - path_m)
    errors_m = np.array(errors)
    near_line = errors_m < -0.7  # the shadow on the direct path comes first there
    assert np.mean(near_line) < 0.25
    assert -0.6 < np.median(errors_m[~near_line]) < 0.0  # skin is nearer than the body's axis
    assert np.max(errors_m) < 0.5


def test_the_echos_snr_is_what_the_link_budget_says() -> None:
    """E N_s / N_0 = chi sigma / (l_t l_r)^2 with chi = 74.2 dB m^2; a body fluctuates about its mean RCS."""
    simulation = SensorRadarSimulation(STEADY, case_study_people(1), seed=1)
    radio, wavelength_m = STEADY.radio, STEADY.wavelength_m()
    chi = radio.integrated_energy_ratio() * wavelength_m**2 / (4.0 * np.pi) ** 3
    assert 10.0 * np.log10(chi) == pytest.approx(74.2, abs=0.2)
    ratio_db, snr_db = [], []
    for index in range(0, 61, 4):
        body = simulation._bodies[0].scatterers(0.1 * index)
        for listener in simulation._listeners:
            echo = echo_paths(listener.tx, listener.rx, body, [], wavelength_m)
            straight = type(echo)(echo.delay_s[: len(body.rcs_m2)], echo.gain[: len(body.rcs_m2)])
            scan = simulation._frontend.receive(straight, listener.first_sample_s)
            energy_j = np.sum(scan**2) / radio.impedance_ohm / radio.sample_rate_hz * radio.pulses_per_scan
            x = case_study_people(1)[0].position_m(np.array([0.1 * index]))[0]
            legs = [np.linalg.norm(x - p) for p in (listener.node.tx_position_m, listener.node.rx_position_m)]
            snr = energy_j / radio.noise_density_w_per_hz
            snr_db.append(10.0 * np.log10(snr))
            ratio_db.append(10.0 * np.log10(snr * (legs[0] * legs[1]) ** 2 / (0.8 * chi)))
    assert np.median(ratio_db) == pytest.approx(0.0, abs=3.0)
    assert 1.5 < np.std(ratio_db) < 5.0
    assert min(snr_db) > 25.0
    assert max(snr_db) < 62.0


def test_monostatic_nodes_take_turns() -> None:
    scene = sensor_radar_scene(monostatic=True)
    frame = SensorRadarSimulation(scene, (), seed=0).frame(3)
    gaps = np.diff(np.sort(frame.time_s))
    np.testing.assert_allclose(gaps, 20480 * 1920 / 16.384e9)  # the paper's 2.4 ms
    assert frame.time_s.min() == pytest.approx(0.3)


def test_a_person_who_stops_gives_nearly_the_same_scan_again() -> None:
    walk = Walk(waypoints_m=((3.0, 3.0), (9.0, 3.0)), speed_mps=1.0, stops_s=((1.0, 5.0),))
    simulation = SensorRadarSimulation(STEADY, (Person(person_id=1, walk=walk),), seed=0)

    def change(first: int, second: int) -> float:
        return float(np.std(simulation.frame(second).scans - simulation.frame(first).scans))

    assert change(30, 31) < 0.2 * change(3, 4)


def test_bad_scenes_and_counts_are_refused_by_name() -> None:
    twin = replace(SCENE.nodes[1], node_id=SCENE.nodes[0].node_id)
    with pytest.raises(ValueError, match="node_id"):
        replace(SCENE, nodes=(SCENE.nodes[0], twin))
    with pytest.raises(ValueError, match="outside the room"):
        replace(SCENE, nodes=(replace(SCENE.nodes[0], rx_position_m=(-5.0, 0.0, 1.0)),))
    with pytest.raises(ValueError, match="scan_period_s"):
        replace(SCENE, scan_period_s=1e-3)
    with pytest.raises(ValueError, match="count"):
        case_study_people(6)
    with pytest.raises(ValueError, match="person_id"):
        SensorRadarSimulation(SCENE, case_study_people(1) * 2, seed=0)
    with pytest.raises(ValueError, match="duration_s"):
        n_frames(SCENE.scan_period_s, 0.05)
