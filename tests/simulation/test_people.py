"""People: where they walk and what their bodies look like."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from echofuse.simulation.people import Body, Person, visibility
from echofuse.simulation.propagation import obstacle
from echofuse.simulation.scene import sensor_radar_scene
from echofuse.simulation.sensor_radar import CASE_STUDY_DURATION_S, case_study_people
from echofuse.simulation.walk import Walk

STRAIGHT = Walk(waypoints_m=((0.0, 0.0), (8.0, 6.0)), speed_mps=1.0)


def test_a_walk_covers_its_legs_at_its_speed_and_turns_back() -> None:
    expected_m = np.array([[0.0, 0.0], [4.0, 3.0], [8.0, 6.0], [6.4, 4.8]])
    np.testing.assert_allclose(STRAIGHT.position_m([0.0, 5.0, 10.0, 12.0]), expected_m)
    assert STRAIGHT.heading_rad(5.0) == pytest.approx(np.arctan2(6.0, 8.0))
    assert STRAIGHT.heading_rad(12.0) == pytest.approx(np.arctan2(-6.0, -8.0))


def test_a_stop_holds_the_position_and_the_heading() -> None:
    walk = Walk(waypoints_m=((0.0, 0.0), (10.0, 0.0)), speed_mps=2.0, stops_s=((1.0, 3.0),))
    np.testing.assert_allclose(walk.position_m([1.0, 2.5, 4.0, 5.0])[:, 0], [2.0, 2.0, 2.0, 4.0])
    assert np.hypot(*walk.velocity_mps(2.5)) == 0.0
    assert walk.heading_rad(2.5) == 0.0


def test_a_walk_that_rises_has_its_speed_along_the_slope_and_takes_the_body_with_it() -> None:
    walk = Walk(waypoints_m=((0.0, 0.0, -1.0), (3.0, 0.0, 3.0), (3.0, 5.0, 3.0)), speed_mps=1.0)
    np.testing.assert_allclose(walk.position_m([0.0, 2.5, 5.0, 7.0]), [[0, 0], [1.5, 0], [3, 0], [3, 2]])
    np.testing.assert_allclose(walk.ground_m([0.0, 2.5, 5.0, 7.0, 17.5]), [-1.0, 1.0, 3.0, 3.0, 1.0])
    assert float(np.hypot(*walk.velocity_mps(2.5))) == pytest.approx(0.6)
    level = replace(walk, waypoints_m=((0.0, 0.0), (5.0, 0.0)))
    assert (walk.rises, level.rises) == (True, False)
    np.testing.assert_array_equal(level.ground_m(np.ones(3)), np.zeros(3))
    person = Person(person_id=1, walk=walk)
    np.testing.assert_allclose(
        person.position_m(np.array([2.5]))[0], [1.5, 0.0, 1.0 + person.centre_height_m]
    )
    low, high = (Body(person, np.random.default_rng(0)).scatterers(t).position_m for t in (2.0, 2.5))
    assert np.mean(high[:42, 2] - low[:42, 2]) == pytest.approx(0.4, abs=0.05)  # torso and head
    assert obstacle(person, 2.5).bottom_m == pytest.approx(1.0)
    assert obstacle(person, 2.5).top_m == pytest.approx(1.0 + person.height_m)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"waypoints_m": ((1.0, 1.0), (1.0, 1.0))}, "waypoints_m"),
        ({"waypoints_m": ((1.0, 1.0), (1.0, 2.0, 0.5))}, "waypoints_m: all of"),
        ({"waypoints_m": ((1.0,), (2.0,))}, "waypoints_m: all of"),
        ({"speed_mps": 0.0}, "speed_mps"),
        ({"speed_mps": float("nan")}, "speed_mps"),
        ({"stops_s": ((2.0, 2.0), (3.0, 1.0))}, "stops_s"),
    ],
)
def test_an_impossible_walk_is_refused_by_name(change: dict[str, object], named: str) -> None:
    good: dict[str, object] = {"waypoints_m": ((0.0, 0.0), (1.0, 0.0)), "speed_mps": 1.0}
    with pytest.raises(ValueError, match=named):
        Walk(**{**good, **change})  # type: ignore[arg-type]


def test_the_papers_walk_is_9_15_m_in_61_scans() -> None:
    (person,) = case_study_people(1)
    position = person.position_m(np.array([0.0, 6.1]))
    assert position[0, 0] - position[1, 0] == pytest.approx(9.15)
    assert position[0, 1] == position[1, 1]


def test_nobody_leaves_the_area_and_everybody_keeps_walking_apart() -> None:
    scene, people = sensor_radar_scene(), case_study_people(5)
    time_s = np.arange(0.0, 10.0 * CASE_STUDY_DURATION_S, 0.1)
    tracks = np.stack([person.position_m(time_s)[:, :2] for person in people])  # (5, n, 2)
    assert np.all(tracks >= scene.area_lower_m)
    assert np.all(tracks <= scene.area_upper_m)
    steps = np.linalg.norm(np.diff(tracks, axis=1), axis=2)
    assert np.mean(steps > 0.05) > 0.97
    apart = np.linalg.norm(tracks[:, np.newaxis] - tracks[np.newaxis], axis=3)[np.triu_indices(5, 1)]
    assert np.mean(apart.min(axis=0) >= 0.5) > 0.95


def test_the_bodys_mean_position_is_the_truth() -> None:
    person = Person(person_id=3, walk=STRAIGHT)
    body = Body(person, np.random.default_rng(0))
    times = np.linspace(1.0, 8.0, 141)
    offset = [
        np.mean(body.scatterers(t).position_m, axis=0) - person.position_m(np.array([t]))[0] for t in times
    ]
    np.testing.assert_allclose(np.mean(offset, axis=0)[:2], 0.0, atol=0.04)
    skin = body.scatterers(2.0).position_m
    assert skin[:, 2].min() > -0.05
    assert skin[:, 2].max() < person.height_m
    assert np.max(np.linalg.norm(skin[:36, :2] - person.walk.position_m(2.0), axis=1)) < 1.5 * person.radius_m


def test_limbs_swing_while_walking_and_rest_while_standing() -> None:
    walk = Walk(waypoints_m=((0.0, 0.0), (20.0, 0.0)), speed_mps=1.4, stops_s=((4.0, 4.0),))
    body = Body(Person(person_id=1, walk=walk), np.random.default_rng(1))

    def spread_m(start_s: float) -> float:
        feet = [
            body.scatterers(t).position_m[-1, 0] - walk.position_m(t)[0]
            for t in start_s + np.arange(0, 2, 0.05)
        ]
        return float(np.ptp(feet))

    assert spread_m(1.0) > 0.5
    assert spread_m(5.0) < 0.02


def test_the_mean_cross_section_is_the_persons() -> None:
    body = Body(Person(person_id=1, walk=STRAIGHT, rcs_m2=0.8), np.random.default_rng(2)).scatterers(3.0)
    turn = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)
    around = np.column_stack([np.cos(turn), np.sin(turn), np.zeros(360)])
    seen = visibility(body.facing, body.directivity, around, around)
    assert np.mean(seen**2 @ body.rcs_m2) == pytest.approx(0.8, rel=0.02)


def test_skin_shines_towards_the_one_who_looks() -> None:
    facing, towards = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]), np.array([1.0, 0.0, 0.0])
    front, back = visibility(facing, np.ones(2), towards, towards)
    assert front == pytest.approx(1.0)
    assert back < 0.1
