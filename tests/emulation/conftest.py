"""Material of the emulation's tests: the case study's walk, once for all of them."""

from dataclasses import replace

import pytest

from echofuse.recording import Recording
from echofuse.simulation.scene import sensor_radar_scene
from echofuse.simulation.sensor_radar import case_study_people, simulate
from echofuse.site import Site, example_site


@pytest.fixture(scope="session")
def site() -> Site:
    return example_site("sensor_radar")


@pytest.fixture(scope="session")
def walk() -> Recording:
    """The whole walk of one person, 61 scans of each node."""
    return simulate(sensor_radar_scene(), case_study_people(1), seed=0)


@pytest.fixture(scope="session")
def short_walk(walk: Recording) -> Recording:
    """Its first 30 scans."""
    nodes = tuple(replace(node, scans=node.scans[:30], time_s=node.time_s[:30]) for node in walk.nodes)
    return replace(walk, nodes=nodes)
