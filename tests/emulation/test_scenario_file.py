"""Scenario files: what they say, and how they are refused."""

from pathlib import Path

import pytest

from echofuse.emulation.scenario import Scenario
from echofuse.emulation.scenario_file import check_nodes, example_scenarios, load_scenario, parse_scenario
from echofuse.errors import InputError
from echofuse.site import Site


def test_an_empty_file_has_no_faults() -> None:
    assert parse_scenario("", name="no-fault") == Scenario()


def test_a_node_takes_what_its_own_table_does_not_say_from_all() -> None:
    scenario = parse_scenario("[radar]\njitter_us = 5\nmissed = 0.1\n[radar.rx3]\nmissed = 0.5\n")
    assert scenario.radar_of("rx1").missed == 0.1
    assert (scenario.radar_of("rx3").missed, scenario.radar_of("rx3").jitter_us) == (0.5, 5.0)


@pytest.mark.parametrize("name", sorted(example_scenarios()))
def test_each_scenario_of_the_package_loads_and_fits_the_case_study(name: str, site: Site) -> None:
    check_nodes(load_scenario(name), site, tuple(node.name for node in site.nodes), name)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("[radra]", "scenario: radra: expected a known key (did you mean radar?)"),
        ("[link]\nlos = 0.1", "scenario: link.los: expected a known key (did you mean loss?)"),
        ("[link.rx1]\nlos = 0.1", "scenario: link.rx1.los: expected a known key (did you mean loss?)"),
        ("[link]\nloss = 1.5", "scenario: link.loss: expected a number [1] from 0 to 1, found 1.5"),
        ('[link]\nloss = "much"', "scenario: link.loss: expected a number [1] from 0 to 1, found much"),
        ("[radar]\nadc_bits = 8.5", "scenario: radar.adc_bits: expected an integer from 0 to 24, found 8.5"),
        ("radar = 3", "scenario: radar: expected a table, found 3"),
        ('[[fault]]\nkind = "explode"', "scenario: fault[1].kind: expected one of silent, crash"),
        ("[[fault]]", "scenario: fault[1].kind: expected one of silent, crash"),
        ('[[fault]]\nkind = "silent"', "scenario: fault[1].node: expected a string, found nothing"),
        (
            '[[fault]]\nkind = "silent"\nnode = "rx1"\nat_s = 2.0\nuntil_s = 1.0',
            "scenario: fault[1].until_s: expected a time after at_s (2), found 1.0",
        ),
        ("[link", "scenario: expected TOML"),
    ],
)
def test_what_is_wrong_is_one_line_with_file_and_key(text: str, expected: str) -> None:
    with pytest.raises(InputError) as refused:
        parse_scenario(text)
    assert len(refused.value.problems) == 1
    assert refused.value.problems[0].startswith(expected)


def test_everything_wrong_is_reported_together() -> None:
    with pytest.raises(InputError) as refused:
        parse_scenario("[link]\nloss = -1\nlate = 2\n[radar]\nmised = 0.5\n")
    assert len(refused.value.problems) == 3


def test_a_scenario_and_a_site_that_do_not_fit(site: Site) -> None:
    text = (
        "[radar.rx9]\nmissed = 0.5\n"
        '[[fault]]\nkind = "silent"\nnode = "rx8"\n'
        '[[fault]]\nkind = "stranger"\nnode_id = 3\n'
    )
    with pytest.raises(InputError) as refused:
        check_nodes(parse_scenario(text), site, ("rx1", "rx2"), "x")
    assert [line.split(": expected")[0] for line in refused.value.problems] == [
        "x: radar.rx9",
        "x: fault[1].node",
        "x: fault[2].node_id",
    ]


def test_a_scenario_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="lost, "):
        load_scenario("no-such-scenario")
    with pytest.raises(InputError, match="a scenario file"):
        load_scenario(tmp_path / "missing.toml")
