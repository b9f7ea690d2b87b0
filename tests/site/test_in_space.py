"""Sites of the pipeline `through_wall_3d`: the cross of antennas, the box, and the scene of one."""

import numpy as np
import pytest

from echofuse.errors import InputError
from echofuse.pipeline import hub_config
from echofuse.simulation.stairs import stairs_climber, stairs_scene
from echofuse.simulation.through_wall_site import site_scene_behind_wall, site_walkers_behind_wall
from echofuse.site import example_site, parse_site

SITE = example_site("stairs")
TEXT = SITE.to_toml()


def edited(*changes: tuple[str, str]) -> str:
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def problems(text: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        parse_site(text, "stairs.toml")
    return list(caught.value.problems)


def test_the_case_study_is_the_simulated_scene() -> None:
    scene = stairs_scene()
    assert SITE.wall is not None
    assert (SITE.wall.thickness_m, SITE.wall.relative_permittivity) == (
        scene.wall.thickness_m,
        scene.wall.permittivity,
    )
    assert [(node.name, node.id, node.tx_position_m, node.rx_position_m) for node in SITE.nodes] == [
        (node.name, node.node_id, node.tx_position_m, node.rx_position_m) for node in scene.nodes
    ]
    lower_m, upper_m = np.array(SITE.box_m[:3]), np.array(SITE.box_m[3:])
    assert scene.wall.back_m <= SITE.box_m[1] < scene.wall.back_m + 0.1
    climb_m = stairs_climber().position_m(np.linspace(0.0, 24.0, 100))
    assert np.all((climb_m > lower_m + 0.3) & (climb_m < upper_m - 0.3))


def test_it_comes_back_with_its_box() -> None:
    assert parse_site(TEXT) == SITE
    assert SITE.heights_m == (SITE.box_m[2], SITE.box_m[5])
    assert (SITE.bounds_m[0], SITE.bounds_m[3]) == (SITE.box_m[0], SITE.box_m[4])
    with pytest.raises(ValueError, match="in the plane"):
        _ = example_site("through_wall").box_m


def test_the_hub_gets_cross_box_and_wall() -> None:
    config = hub_config(parse_site(edited(("thickness_m = 0.2", "thickness_m = 0.15"))))
    assert config.n_nodes == 4
    assert [round(node.rx.z_m, 3) for node in config.nodes] == [0.0, 0.0, -0.39, 0.39]
    box = config.area
    found = (box.min_x_m, box.min_y_m, box.min_z_m, box.max_x_m, box.max_y_m, box.max_z_m)
    assert found == pytest.approx(SITE.box_m)
    assert config.taylor_3d.wall.thickness_m == pytest.approx(0.15)
    assert config.invalid_field() is None


AREA = f"area = {list(SITE.box_m)}"
WRONG = {
    "an area in the plane": (((AREA, "area = [-1.6, 0.3, 1.6, 6.5]"),), "site.area", "a box in metres"),
    "a polygon": (((AREA, "area = [[0, 1], [2, 1], [2, 3]]"),), "site.area", "a box in metres"),
    "a box upside down": (((AREA, "area = [-1.6, 0.3, 2.0, 1.6, 6.5, -2.0]"),), "site.area", "z_min < z_max"),
    "a box before the wall": (
        ((AREA, "area = [-1.6, 0.1, -2.0, 1.6, 6.5, 2.0]"),),
        "site.area",
        "behind the wall: y above 0.2",
    ),
    "first receiver on the right": (
        (("[-0.39, 0.0, 0.0]", "[0.5, 0.0, 0.0]"),),
        "node[1].rx_position_m",
        "left of the transmitter: x below 0, y = 0, z = 0",
    ),
    "first receiver too high": (
        (("[-0.39, 0.0, 0.0]", "[-0.39, 0.0, 0.1]"),),
        "node[1].rx_position_m",
        "[-0.39, 0.0, 0.0], left of",
    ),
    "arms of two lengths": (
        (("[0.0, 0.0, -0.39]", "[0.0, 0.0, -0.41]"),),
        "node[3].rx_position_m",
        "[0.0, 0.0, -0.39], below the transmitter as far as node[1] is left of it",
    ),
    "off the wall": (
        (("[0.39, 0.0, 0.0]", "[0.39, 0.01, 0.0]"),),
        "node[2].rx_position_m",
        "[0.39, 0.0, 0.0], right of",
    ),
    "two transmitters": (
        (
            (
                "[0.0, 0.0, 0.0]\nrx_position_m = [0.0, 0.0, 0.39]",
                "[0.0, 0.0, 0.1]\nrx_position_m = [0.0, 0.0, 0.39]",
            ),
        ),
        "node[4].tx_position_m",
        "the transmitter of node[1]",
    ),
    "thicker than the first range": (
        (("thickness_m = 0.2", "thickness_m = 0.4"), (AREA, "area = [-1.6, 0.5, -2.0, 1.6, 6.5, 2.0]")),
        "site.wall.thickness_m",
        "a wall before the nearest range",
    ),
    "no wall": (
        (("[site.wall]\nthickness_m = 0.2\nrelative_permittivity = 4.0\n", ""),),
        "site.wall",
        "a table with thickness_m",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_site_is_named(name: str) -> None:
    changes, key, words = WRONG[name]
    (line,) = problems(edited(*changes))
    assert line.startswith(f"stairs.toml: {key}: expected ")
    assert words in line


def test_the_order_of_the_cross_matters() -> None:
    swapped = edited(("[0.0, 0.0, -0.39]", "[0.0, 0.0, +0.39]"), ("[0.0, 0.0, 0.39]", "[0.0, 0.0, -0.39]"))
    keys = [line.split(": ")[1] for line in problems(swapped)]
    assert keys == ["node[3].rx_position_m", "node[4].rx_position_m"]


@pytest.mark.parametrize(("count", "words"), [(3, "at least 4 nodes"), (5, "at most 4 nodes in the cross")])
def test_the_cross_has_four_receivers(count: int, words: str) -> None:
    head, *nodes = TEXT.split("[[node]]")
    last, pipeline = nodes[3].split("[pipeline]")
    nodes[3] = last
    nodes.append('\nname = "rx5"\nid = 5\ntx_position_m = [0, 0, 0]\nrx_position_m = [0.78, 0, 0]\n\n')
    text = "[[node]]".join([head, *nodes[:count]]) + "[pipeline]" + pipeline
    (line,) = problems(text)
    assert words in line


def test_a_box_is_for_positions_in_space_alone() -> None:
    planar = example_site("through_wall").to_toml().replace("[-2.6, 0.5, 2.6, 6.2]", str(list(SITE.box_m)))
    assert problems(planar)[0].startswith("stairs.toml: site.area: expected [x_min, y_min, x_max, y_max] or")


def test_any_site_has_a_scene_and_people_on_its_floor() -> None:
    text = edited((AREA, "area = [-3.0, 0.5, -1.5, 2.0, 5.0, 1.2]"))
    for node in ("-0.39, 0.0, 0.0", "0.39, 0.0, 0.0", "0.0, 0.0, -0.39", "0.0, 0.0, 0.39"):
        assert node in text
    scene = site_scene_behind_wall(parse_site(text))
    assert scene.wall.back_m == pytest.approx(0.5)
    assert (scene.room.lower_m[2], scene.room.upper_m[2]) == (-1.5, 1.2)
    assert [node.rx_position_m for node in scene.nodes] == [node.rx_position_m for node in SITE.nodes]
    assert scene.radar == stairs_scene().radar
    people = site_walkers_behind_wall(scene, 4)
    assert all(scene.holds(person) for person in people)
    for person in people:
        ground_m = person.position_m(np.linspace(0.0, 20.0, 50))[:, 2] - person.centre_height_m
        np.testing.assert_allclose(ground_m, -1.5)
