"""Sites of the pipeline `through_wall_2d`: what antennas, wall and area must be, and the scene of one."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from echofuse.errors import InputError
from echofuse.pipeline import configured_node, hub_config, node_config, nominal_source
from echofuse.simulation.through_wall_scene import through_wall_scene
from echofuse.simulation.through_wall_site import site_scene_behind_wall, site_walkers_behind_wall
from echofuse.site import Site, example_site, parse_site

SITE = example_site("through_wall")
TEXT = SITE.to_toml()


def problems(text: str, *, few_nodes: bool = False) -> list[str]:
    with pytest.raises(InputError) as caught:
        parse_site(text, "wall.toml", few_nodes=few_nodes)
    return list(caught.value.problems)


def edited(old: str, new: str) -> str:
    assert old in TEXT
    return TEXT.replace(old, new, 1)


def receiver(number: int, x_m: float) -> str:
    return (
        f'[[node]]\nname = "rx{number}"\nid = {number}\n'
        f"tx_position_m = [0.0, 0.0, 1.2]\nrx_position_m = [{x_m}, 0.0, 1.2]\n"
    )


def test_the_case_study_is_the_simulated_scene() -> None:
    scene = through_wall_scene()
    assert SITE.wall is not None
    assert (SITE.wall.thickness_m, SITE.wall.relative_permittivity) == (
        scene.wall.thickness_m,
        scene.wall.permittivity,
    )
    assert [(node.name, node.id, node.tx_position_m, node.rx_position_m) for node in SITE.nodes] == [
        (node.name, node.node_id, node.tx_position_m, node.rx_position_m) for node in scene.nodes
    ]
    x_min, y_min, x_max, y_max = SITE.bounds_m
    assert scene.wall.back_m <= y_min < scene.wall.back_m + 0.05
    assert x_min <= scene.room.lower_m[0] < scene.room.upper_m[0] <= x_max
    assert scene.room.upper_m[1] <= y_max


def test_it_comes_back() -> None:
    assert parse_site(TEXT) == SITE


def test_configurations_have_what_site_and_recording_say() -> None:
    thick = parse_site(edited("thickness_m = 0.24", "thickness_m = 0.2"))
    config = hub_config(thick)
    assert config.line_locator.wall.thickness_m == pytest.approx(0.2)
    assert config.line_locator.wall.relative_permittivity == pytest.approx(4.0)
    source = replace(
        nominal_source(SITE, SITE.nodes[0]), sample_rate_hz=4e9, scans=np.zeros((0, 255), np.float32)
    )
    node = node_config(SITE, SITE.nodes[0], source)
    assert (node.n_samples, node.sample_rate_hz, node.node_id) == (255, 4e9, 1)
    assert node.baseline_m == pytest.approx(0.4)
    assert node.max_delay_s == pytest.approx(41.7e-9)
    assert (node.target_traces.window_samples, node.target_traces.least_hits) == (8, 4)


WALL = "[site.wall]\nthickness_m = 0.24\nrelative_permittivity = 4.0\n"
ALONE = TEXT.split('[[node]]\nname = "rx2"')[0] + '[pipeline]\nname = "through_wall_2d"\n'
WRONG = {
    "no wall": (
        edited(WALL, ""),
        "site.wall",
        "a table with thickness_m and relative_permittivity",
    ),
    "two transmitters": (
        edited("[0.0, 0.0, 1.2]\nrx_position_m = [0.4", "[0.1, 0.0, 1.2]\nrx_position_m = [0.4"),
        "node[2].tx_position_m",
        "the transmitter of node[1]",
    ),
    "receiver before the line": (
        edited("[0.4, 0.0, 1.2]", "[0.4, 0.1, 1.2]"),
        "node[2].rx_position_m",
        "beside the transmitter, along x: y = 0, z = 1.2",
    ),
    "receiver above the line": (
        edited("[0.4, 0.0, 1.2]", "[0.4, 0.0, 1.6]"),
        "node[2].rx_position_m",
        "beside the transmitter",
    ),
    "receiver on the transmitter": (
        edited("[0.4, 0.0, 1.2]", "[0.0, 0.0, 1.2]"),
        "node[2].rx_position_m",
        "beside the transmitter",
    ),
    "area before the wall": (
        edited("[-2.6, 0.5, 2.6, 6.2]", "[-2.6, 0.2, 2.6, 6.2]"),
        "site.area",
        "behind the wall: y above 0.24",
    ),
    "area behind the antennas' back": (
        edited("[-2.6, 0.5, 2.6, 6.2]", "[-2.6, -6.2, 2.6, -0.5]"),
        "site.area",
        "behind the wall",
    ),
    "thicker than the first range": (
        edited("thickness_m = 0.24", "thickness_m = 0.4"),
        "site.wall.thickness_m",
        "a wall before the nearest range: blind_zone_s = 2.7e-09 ends at",
    ),
    "denser than the first range": (
        edited("relative_permittivity = 4.0", "relative_permittivity = 9.0"),
        "site.wall.thickness_m",
        "a wall before the nearest range",
    ),
    "time zero of a node": (
        edited("id = 2\n", 'id = 2\ntime_zero = "recorded"\n'),
        "node[2].time_zero",
        "no such setting: the cross-talk tells time zero",
    ),
    "one receiver": (ALONE, "node", "at least 2 nodes"),
    "nine receivers": (
        TEXT + "".join(receiver(number, 0.1 + 0.1 * number) for number in range(4, 11)),
        "node",
        "at most 8 nodes",
    ),
    "thickness as a setting": (
        TEXT + "[pipeline.line_locator.wall]\nthickness_m = 0.3\n",
        "pipeline.line_locator.wall.thickness_m",
        "the site itself says it",
    ),
    "unknown compensation": (
        TEXT + '[pipeline.line_locator.wall]\ncompensation = "third_kind"\n',
        "pipeline.line_locator.wall.compensation",
        "one of none, first_kind, second_kind",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_site_is_named(name: str) -> None:
    text, key, words = WRONG[name]
    (line,) = problems(text)
    assert line.startswith(f"wall.toml: {key}: expected ")
    assert words in line


def kept(value: str) -> str:
    return edited('name = "through_wall_2d"', f'name = "through_wall_2d"\nkept_samples = {value}')


@pytest.mark.parametrize("value", ["-1", "40", "1921", "4095"])
def test_to_keep_too_few_or_too_many_samples_is_named(value: str) -> None:
    (line,) = problems(kept(value))
    assert line.startswith("wall.toml: pipeline.kept_samples: expected a possible value (")
    assert line.endswith(f"at most 1920; 0: all), found {value}")


def test_a_site_that_keeps_too_little_of_a_long_sequence_is_named() -> None:
    for settings, rate_hz, key in (
        (TEXT, 7e9, "kept_samples"),
        (kept("90"), 7e9, "kept_samples"),  # 28 samples to the end of the blind zone, and 64 of noise
        (kept("90"), 4.5e9, None),
        (kept("700"), 7e9, None),
    ):
        site = parse_site(settings, "wall.toml")
        source = replace(
            nominal_source(site, site.nodes[0]),
            sample_rate_hz=rate_hz,
            scans=np.zeros((0, 4095), np.float32),
        )
        if key is None:
            configured_node(site, node_config(site, site.nodes[0], source), source)
            continue
        with pytest.raises(InputError) as caught:
            node_config(site, site.nodes[0], source)
        (line,) = caught.value.problems
        assert line == (
            f"{site.name}: node rx1: {key}: expected what scans of 4095 samples at {rate_hz:g} Hz allow"
        )


def test_a_longer_blind_zone_lets_a_thick_wall_pass() -> None:
    thick = edited("thickness_m = 0.24", "thickness_m = 0.4").replace("0.5, 2.6", "0.7, 2.6")
    assert len(problems(thick)) == 1
    longer = thick.replace('name = "through_wall_2d"', 'name = "through_wall_2d"\nblind_zone_s = 4.5e-9')
    assert parse_site(longer).settings["blind_zone_s"] == 4.5e-9


def test_one_receiver_is_enough_for_ranges() -> None:
    assert len(parse_site(ALONE.replace(WALL, ""), few_nodes=True).nodes) == 1
    assert "at least 2 nodes" in problems(ALONE.replace(WALL, ""))[0]


def _moved(x_m: float) -> Site:
    """Another room: five receivers, a thin wall, the antennas not at the origin."""
    text = (
        "[site]\nname = 'shed'\narea = [8.0, 2.4, 12.0, 5.0]\n"
        "[site.wall]\nthickness_m = 0.1\nrelative_permittivity = 6.0\n"
    )
    for number, offset_m in enumerate((-0.6, -0.3, 0.3, 0.6, 0.9), start=1):
        text += (
            f'[[node]]\nname = "n{number}"\nid = {number}\n'
            f"tx_position_m = [{x_m}, 2.0]\nrx_position_m = [{x_m + offset_m}, 2.0]\n"
        )
    return parse_site(text + "[pipeline]\nname = 'through_wall_2d'\n")


def test_any_site_has_a_scene_and_people_in_it() -> None:
    site = _moved(10.0)
    scene = site_scene_behind_wall(site)
    assert scene.wall.thickness_m == 0.1
    assert scene.wall.back_m == pytest.approx(2.4)
    assert [node.rx_position_m for node in scene.nodes] == [
        (x, 2.0, 1.2) for x in (9.4, 9.7, 10.3, 10.6, 10.9)
    ]
    people = site_walkers_behind_wall(scene, 4)
    assert all(scene.holds(person) for person in people)
    model = site_walkers_behind_wall(through_wall_scene(), 4)
    assert [person.walk.speed_mps for person in people] == [person.walk.speed_mps for person in model]
    # the people keep the order in which they stand beside each other
    places = [person.walk.waypoints_m[0][0] for person in people]
    assert sorted(range(4), key=places.__getitem__) == [2, 0, 1, 3]
    assert all(second - first > 0.3 for first, second in pairwise(sorted(places)))
