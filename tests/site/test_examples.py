"""The site files that come with the package, against the compiled library and the simulation."""

import pytest

from echofuse.errors import InputError
from echofuse.simulation.scene import sensor_radar_scene
from echofuse.site import apply_settings, example_site, example_sites, parse_site
from echofuse.site.stages import MEASURED, PIPELINES


@pytest.mark.parametrize("name", sorted(example_sites()))
def test_an_example_loads_and_comes_back(name: str) -> None:
    site = example_site(name)
    assert parse_site(site.to_toml()) == site


def test_the_case_study_is_the_simulated_scene() -> None:
    site, scene = example_site("sensor_radar"), sensor_radar_scene()
    assert site.bounds_m == (*scene.area_lower_m, *scene.area_upper_m)
    assert [(node.name, node.id, node.tx_position_m, node.rx_position_m) for node in site.nodes] == [
        (node.name, node.node_id, node.tx_position_m, node.rx_position_m) for node in scene.nodes
    ]


def test_the_real_walk_has_its_path() -> None:
    truth = example_site("p410_triangle").truth
    assert truth is not None
    assert truth.path_m == ((1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (1.0, -1.0))
    assert truth.walking_scans == (30, 740)


@pytest.mark.parametrize("name", ["sensor_radar", "through_wall", "stairs"])
def test_every_compiled_setting_can_be_said(name: str) -> None:
    """Each field of the compiled defaults, written as TOML, loads and changes nothing."""
    site = example_site(name)
    for config in PIPELINES[site.pipeline].default_configs():
        assert config.invalid_field() in {None, *MEASURED}
        said = type(site)(**{**vars(site), "settings": _as_settings(config)})
        back = parse_site(said.to_toml())
        fresh = type(config)()
        apply_settings(fresh, back.settings)
        assert fresh == config


def test_compiled_settings_are_checked() -> None:
    text = example_site("sensor_radar").to_toml()
    stage = '[pipeline.cfar]\nmethod = "cell_averging"\nfalse_alarm_probability = 2.0\n'
    with pytest.raises(InputError) as caught:
        parse_site(text + stage, "x.toml")
    keys = sorted(line.split(": ")[1] for line in caught.value.problems)
    assert keys == ["pipeline.cfar.false_alarm_probability", "pipeline.cfar.method"]


def _as_settings(config: object) -> dict[str, object]:
    settings = {}
    for field in config.fields():
        value = getattr(config, field)
        if field in MEASURED:
            continue
        if hasattr(value, "fields"):
            settings[field] = _as_settings(value)
        else:
            settings[field] = value.name if hasattr(value, "name") else value
    return settings
