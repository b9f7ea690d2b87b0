"""Site files: what loads, what comes back out, and what is refused with which words."""

import re
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from echofuse.errors import InputError
from echofuse.site import Site, SiteNode, apply_settings, load_site, parse_site

Load = Callable[[str], Site]

NODES = """
[[node]]
name = "a"
id = 1
tx_position_m = [5, 0]
rx_position_m = [0.0, 3.0]

[[node]]
name = "b"
id = 2
radar = "p410"
tx_position_m = [5.0, 0.0, 1.0]
rx_position_m = [5.0, 6.0, 1.5]
time_zero = "recorded"
delay_offset_s = -2e-10
transmit_delay_s = 1e-8

[[node]]
name = "c"
id = 3
tx_position_m = [10.0, 3.0]
rx_position_m = [10.0, 3.0]
"""
HEAD = '[site]\nname = "hall"\narea = [0, 0, 10, 6]\n'
PIPELINE = '[pipeline]\nname = "sensor_radar"\n'
GOOD = HEAD + NODES + PIPELINE


def problems(load: Load, text: str) -> list[str]:
    """Return the lines with which a text is refused."""
    with pytest.raises(InputError) as caught:
        load(text)
    lines = str(caught.value).split("\n")
    assert lines == list(caught.value.problems)
    for line in lines:
        assert re.match(r"hall\.toml: .*expected ", line), line
    return lines


def problem(load: Load, text: str) -> str:
    (line,) = problems(load, text)
    return line


def test_a_site_loads(load: Load) -> None:
    site = load(GOOD)
    assert (site.name, site.pipeline, site.settings) == ("hall", "sensor_radar", {})
    assert site.area == ((0.0, 0.0), (10.0, 0.0), (10.0, 6.0), (0.0, 6.0))
    assert site.bounds_m == (0.0, 0.0, 10.0, 6.0)
    assert site.nodes[0] == SiteNode(
        name="a", id=1, tx_position_m=(5.0, 0.0, 0.0), rx_position_m=(0.0, 3.0, 0.0)
    )
    assert site.nodes[1] == SiteNode(
        name="b",
        id=2,
        radar="p410",
        tx_position_m=(5.0, 0.0, 1.0),
        rx_position_m=(5.0, 6.0, 1.5),
        time_zero="recorded",
        delay_offset_s=-2e-10,
        transmit_delay_s=1e-8,
    )
    assert site.nodes[0].settings() == {}
    assert site.nodes[1].settings() == {"time_zero": "recorded", "delay_offset_s": -2e-10}


FULL = (
    HEAD.replace("[0, 0, 10, 6]", "[[0, 0], [10, 0], [5, 6]]")
    + "wall = { thickness_m = 0.24, relative_permittivity = 4 }\n"
    + NODES
    + PIPELINE
    + 'blind_zone_s = 2e-9\ntracker = "ordered_statistic"\n'
    + '[pipeline.cfar]\nmethod = "ordered_statistic"\ntraining_cells_per_side = 8\n'
    + "[pipeline.selection]\nmin_weight = 56\nuse_area = false\nweights = [3, 4.5]\n"
    + "[truth]\npath_m = [[1, 1], [2, 2], [3, 1]]\nwalking_scans = [3, 90]\n"
)


def test_everything_that_can_be_said_comes_back(load: Load) -> None:
    site = load(FULL)
    assert site.wall is not None
    assert site.truth is not None
    assert site.truth.walking_scans == (3, 90)
    again = load(site.to_toml())
    assert again == site
    assert again.to_toml() == site.to_toml()


@given(name=st.text(min_size=1).filter(lambda text: text.isprintable()), x=st.floats(-5.0, 5.0))
def test_any_name_and_number_comes_back(name: str, x: float) -> None:
    site = Site(
        name=name,
        nodes=tuple(
            SiteNode(name=f"{name.replace('/', '')}{i}", id=i, tx_position_m=place, rx_position_m=place)
            for i, place in enumerate([(x, 0.0, 0.0), (x + 1.0, 0.0, 0.0), (0.0, 9.0, 0.0)])
        ),
        area=((0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)),
        pipeline="sensor_radar",
    )
    assert parse_site(site.to_toml(), "hall.toml", (NoFields(), NoFields())) == site


class NoFields:
    def fields(self) -> tuple[str, ...]:
        return ()

    def invalid_field(self) -> None:
        return None


def test_settings_reach_the_configurations(load: Load, configs: tuple) -> None:
    site = load(FULL)
    node, hub = configs  # changed by the check, as the caller's own would be
    node.cfar.training_cells_per_side = 16
    apply_settings(node, site.settings)
    apply_settings(hub, site.settings)
    assert node.blind_zone_s == 2e-9
    assert node.cfar.method.name == "ordered_statistic"
    assert node.cfar.training_cells_per_side == 8
    assert node.cfar.false_alarm_probability == 1e-4  # not said: the class's own default stays
    assert hub.selection.min_weight == 56.0
    assert hub.selection.use_area is False
    assert hub.selection.weights == [3.0, 4.5]
    with pytest.raises(ValueError, match="a number"):
        apply_settings(node, {"blind_zone_s": "long"})


STAGES = {
    "unknown stage": ("[pipeline.cfra]\n", "pipeline.cfra", "did you mean cfar?"),
    "unknown scalar": ("blind_zone = 1\n", "pipeline.blind_zone", "did you mean blind_zone_s?"),
    "unknown, nothing close": ("zzz = 1\n", "pipeline.zzz", "one of blind_zone_s, delay_offset_s"),
    "unknown field": ("[pipeline.cfar]\nmetod = 1\n", "pipeline.cfar.metod", "did you mean method?"),
    "wrong unit": (
        "[pipeline.selection]\nmerge_distance_m = 1\n",
        "pipeline.selection.merge_distance_m",
        "did you mean merge_distance_s?",
    ),
    "unknown choice": (
        '[pipeline.cfar]\nmethod = "cell"\n',
        "pipeline.cfar.method",
        "one of cell_averaging, ordered_statistic, found cell",
    ),
    "choice as number": ("[pipeline.cfar]\nmethod = 1\n", "pipeline.cfar.method", "one of cell_averaging"),
    "text for a number": ('blind_zone_s = "1.5 ns"\n', "pipeline.blind_zone_s", "a number"),
    "truth for a number": ("blind_zone_s = true\n", "pipeline.blind_zone_s", "a number"),
    "NaN": ("blind_zone_s = nan\n", "pipeline.blind_zone_s", "a number, found nan"),
    "beyond float32": ("blind_zone_s = 1e60\n", "pipeline.blind_zone_s", "a number"),
    "fraction for a count": (
        "[pipeline.cfar]\ntraining_cells_per_side = 2.5\n",
        "pipeline.cfar.training_cells_per_side",
        "an integer",
    ),
    "number for a truth": (
        "[pipeline.selection]\nuse_area = 1\n",
        "pipeline.selection.use_area",
        "true or false",
    ),
    "short list": (
        "[pipeline.selection]\nweights = [1]\n",
        "pipeline.selection.weights",
        "a list of 2 values",
    ),
    "list of text": (
        '[pipeline.selection]\nweights = [1, "x"]\n',
        "pipeline.selection.weights",
        "a list of 2, each a number",
    ),
    "impossible in a stage": (
        "[pipeline.cfar]\ntraining_cells_per_side = 0\n",
        "pipeline.cfar.training_cells_per_side",
        "a possible value",
    ),
    "impossible": ("blind_zone_s = -1\n", "pipeline.blind_zone_s", "a possible value"),
    "stage as number": ("cfar = 1\n", "pipeline.cfar", "a table"),
    "measured": ("n_samples = 1920\n", "pipeline.n_samples", "the recording"),
    "measured in a stage": (
        "[pipeline.cfar]\nsample_rate_hz = 1e9\n",
        "pipeline.cfar.sample_rate_hz",
        "the recording",
    ),
}


@pytest.mark.parametrize("name", STAGES)
def test_a_wrong_setting_is_named(load: Load, name: str) -> None:
    text, key, words = STAGES[name]
    line = problem(load, GOOD + text)
    assert line.startswith(f"hall.toml: {key}: expected ")
    assert words in line


def edited(old: str, new: str) -> str:
    assert old in GOOD
    return GOOD.replace(old, new, 1)


FILES = {
    "no name": (edited('name = "hall"\n', ""), "site.name", "a string, found nothing"),
    "name is a number": (edited('"hall"', "5"), "site.name", "a string"),
    "no area": (edited("area = [0, 0, 10, 6]\n", ""), "site.area", "x_min"),
    "area backwards": (edited("[0, 0, 10, 6]", "[10, 0, 0, 6]"), "site.area", "x_min < x_max"),
    "area of three": (edited("[0, 0, 10, 6]", "[0, 0, 10]"), "site.area", "[x_min, y_min, x_max, y_max]"),
    "area of two points": (edited("[0, 0, 10, 6]", "[[0, 0], [1, 1]]"), "site.area", "at least three points"),
    "area without content": (
        edited("[0, 0, 10, 6]", "[[0, 0], [5, 0], [10, 0]]"),
        "site.area",
        "an area above 0",
    ),
    "infinite area": (edited("[0, 0, 10, 6]", "[0, 0, inf, 6]"), "site.area", "[x_min"),
    "unknown table": (GOOD + "[wall]\n", "wall", "one of site, node, pipeline, truth"),
    "unknown key": (
        edited('name = "hall"', 'name = "hall"\narea_m = 1'),
        "site.area_m",
        "did you mean area?",
    ),
    "unknown node key": (
        edited("id = 1", "id = 1\ntx_position_cm = [1, 2]"),
        "node[1].tx_position_cm",
        "tx_position_m?",
    ),
    "no id": (edited("id = 2\n", ""), "node[2].id", "an integer from 0 to 65534, found nothing"),
    "id as text": (edited("id = 2\n", 'id = "2"\n'), "node[2].id", "an integer"),
    "negative id": (edited("id = 2\n", "id = -2\n"), "node[2].id", "an integer from 0"),
    "one coordinate": (edited("[5, 0]", "[5]"), "node[1].tx_position_m", "two or three finite numbers"),
    "NaN position": (edited("[5, 0]", "[5, nan]"), "node[1].tx_position_m", "two or three finite numbers"),
    "position as text": (
        edited("[5, 0]", '"5 m, 0 m"'),
        "node[1].tx_position_m",
        "two or three finite numbers",
    ),
    "slash in a name": (edited('name = "a"', 'name = "a/b"'), "node[1].name", "without a slash"),
    "nanoseconds": (
        edited("transmit_delay_s = 1e-8", "transmit_delay_s = 10"),
        "node[2].transmit_delay_s",
        "[s]",
    ),
    "unknown time zero": (
        edited('"recorded"', '"rcorded"'),
        "node[2].time_zero",
        "one of direct_path, recorded",
    ),
    "time zero is a number": (edited('"recorded"', "3"), "node[2].time_zero", "a string"),
    "unknown pipeline": (edited('"sensor_radar"', '"sensor"'), "pipeline.name", "one of sensor_radar"),
    "no pipeline name": (edited('name = "sensor_radar"\n', ""), "pipeline.name", "a string"),
    "wall without thickness": (
        edited("[[node]]", "[site.wall]\nrelative_permittivity = 4\n[[node]]"),
        "site.wall.thickness_m",
        "a number [m]",
    ),
    "path of one point": (GOOD + "[truth]\npath_m = [[1, 1]]\n", "truth.path_m", "at least two points"),
    "scans backwards": (
        GOOD + "[truth]\npath_m = [[1, 1], [2, 2]]\nwalking_scans = [9, 3]\n",
        "truth.walking_scans",
        "two ascending integers",
    ),
    # geometry
    "same id": (edited("id = 3", "id = 1"), "node[3].id", "an id of its own (node[1] has it too)"),
    "same name": (edited('name = "c"', 'name = "a"'), "node[3].name", "a name of its own"),
    "centimetres": (
        edited("[0.0, 3.0]", "[0.0, 300.0]"),
        "node[1].rx_position_m",
        "near the area, in metres",
    ),
}


@pytest.mark.parametrize("name", FILES)
def test_a_wrong_file_is_named(load: Load, name: str) -> None:
    text, key, words = FILES[name]
    line = problem(load, text)
    assert line.startswith(f"hall.toml: {key}: expected ")
    assert words in line


def node_text(number: int, tx: tuple[float, float], rx: tuple[float, float]) -> str:
    return (
        f'[[node]]\nname = "n{number}"\nid = {number}\n'
        f"tx_position_m = {list(tx)}\nrx_position_m = {list(rx)}\n"
    )


def site_text(*places: tuple[tuple[float, float], tuple[float, float]]) -> str:
    nodes = (node_text(number, tx, rx) for number, (tx, rx) in enumerate(places, start=1))
    return HEAD + "".join(nodes) + PIPELINE


def test_nodes_in_one_place(load: Load) -> None:
    shared = (5.0, 0.0)
    text = site_text((shared, (0.0, 3.0)), (shared, (5.0, 6.0)), (shared, (0.0, 3.0)), (shared, (10.0, 1.0)))
    assert "node[3].rx_position_m: expected a place of its own: n1" in problem(load, text)
    load(site_text((shared, (0.0, 3.0)), (shared, (5.0, 6.0)), (shared, (10.0, 1.0))))  # one Tx is no mistake


@pytest.mark.parametrize("slope", [0.0, 0.5, 1e9])
def test_nodes_on_a_line(load: Load, slope: float) -> None:
    places = [(t, slope * t) if slope < 1e9 else (3.0, t) for t in (0.0, 2.0, 5.0, 9.0)]
    assert "do not all stand on one line" in problem(load, site_text(*((place, place) for place in places)))
    lifted = [*places[:-1], (places[-1][0] + 0.5, places[-1][1] + 1.0)]
    load(site_text(*((place, place) for place in lifted)))


def test_too_few_nodes(load: Load) -> None:
    for count in (0, 1, 2):
        places = [((0.0, 0.0), (0.0, 0.0)), ((9.0, 1.0), (9.0, 1.0))][:count]
        line = problem(load, site_text(*places))
        assert "at least 3 nodes" in line
        assert line.endswith(f"found {count}")


def test_too_many_nodes(load: Load) -> None:
    places = [((float(i % 5), float(i // 5)), (float(i % 5), float(i // 5))) for i in range(17)]
    assert "at most 16 nodes" in problem(load, site_text(*places))


def test_all_problems_come_together(load: Load) -> None:
    text = (
        edited("[0, 0, 10, 6]", "[0, 0]").replace("id = 1\n", "").replace('"recorded"', '"never"')
        + "colour = 1\n[pipeline.cfar]\nmethod = 3\n"
    )
    keys = [line.split(": ")[1] for line in problems(load, text)]
    assert sorted(keys) == [
        "node[1].id",
        "node[2].time_zero",
        "pipeline.cfar.method",
        "pipeline.colour",
        "site.area",
    ]


def test_all_impossible_values_of_a_stage_come_together(load: Load) -> None:
    stage = "[pipeline.cfar]\ntraining_cells_per_side = 0\nfalse_alarm_probability = -1\n"
    lines = problems(load, GOOD + "blind_zone_s = -1\n" + stage)
    keys = ["blind_zone_s", "cfar.false_alarm_probability", "cfar.training_cells_per_side"]
    assert sorted(line.split(": ")[1] for line in lines) == [f"pipeline.{key}" for key in keys]


def test_no_toml(load: Load, tmp_path) -> None:
    assert "expected TOML" in problem(load, "[site\n")
    with pytest.raises(InputError, match=r"nothing\.toml: expected a site file"):
        load_site(tmp_path / "nothing.toml")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"binary\.toml: expected a site file"):
        load_site(tmp_path / "binary.toml")


@pytest.mark.parametrize(
    "text", ["site = 1\n", "node = 1\n", "pipeline = 1\n", "truth = 1\n", "node = [1, 2, 3]\n"]
)
def test_tables_of_another_type(load: Load, text: str) -> None:
    key = text.split(" ")[0]
    assert any(line.startswith(f"hall.toml: {key}") for line in problems(load, text))
