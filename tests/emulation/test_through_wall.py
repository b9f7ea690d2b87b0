"""Faults before a wall, where each of two receivers counts: all are in a counter, and tracks come back."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest

from echofuse import _core
from echofuse.emulation.run import emulate
from echofuse.emulation.scenario_file import example_scenarios, load_scenario, parse_scenario
from echofuse.pipeline import process_recording
from echofuse.recording import Recording
from echofuse.result import RunResult
from echofuse.simulation.through_wall import simulate_through_wall
from echofuse.simulation.through_wall_scene import case_study_walkers, through_wall_scene
from echofuse.site import example_site

SITE = example_site("through_wall")
DURATION_S = 12.0
NODE = _core.ThroughWallNodeConfig()
SETTLING = NODE.time_zero.learning_responses + NODE.clutter.learning_scans  # responses

#: The scenarios of the package that name no receiver of another site, and those of a second receiver.
PACKAGED = (
    *("lost", "bit-errors", "jitter", "late", "too-late", "reordered", "doubled", "hub-restart", "slow-link"),
    *("stranger", "garbage"),
)
OWN = {
    "restart": '[[fault]]\nkind = "restart"\nnode = "rx2"\nat_s = 4.0\nuntil_s = 4.3\n',
    "silent": '[[fault]]\nkind = "silent"\nnode = "rx2"\nat_s = 6.0\nuntil_s = 7.0\n',
    "radar": "[radar.rx1]\nmissed = 0.05\n[radar.rx2]\ndoubled = 0.05\n",
}

#: The counters of trouble that a scenario moves, by how often each kind of fault was applied.
LAWS: dict[str, Callable[[Mapping[str, int]], dict[str, int]]] = {
    "lost": lambda n: {"lost": n["link.loss"]},
    "doubled": lambda n: {"link_repeated": n["link.doubled"]},
    "stranger": lambda n: {"unknown_node": n["fault.stranger"]},
    "jitter": lambda n: {},
    "slow-link": lambda n: {},
    "hub-restart": lambda n: {},
}
TROUBLE = (
    "late",
    "early",
    "doubled",
    "malformed",
    "unknown_node",
    "lost",
    "absent",
    "slow",
    "resynchronised",
)
TROUBLE += ("clock_faults", "link_repeated")


@pytest.fixture(scope="module")
def walk() -> Recording:
    return simulate_through_wall(through_wall_scene(), case_study_walkers(2), seed=0, duration_s=DURATION_S)


def run(walk: Recording, name: str, target: str = "inprocess") -> RunResult:
    scenario = parse_scenario(OWN[name]) if name in OWN else load_scenario(name)
    return emulate(walk, SITE, scenario, 0, target)


def injected(result: RunResult) -> Mapping[str, int]:
    assert result.emulation is not None
    assert result.emulation.account.problems == []
    return result.emulation.log.applied()


def test_every_name_is_a_scenario() -> None:
    assert set(PACKAGED) <= set(example_scenarios())


def test_without_faults_the_result_is_that_of_the_pipeline(walk: Recording) -> None:
    emulated, plain = emulate(walk, SITE), process_recording(walk, SITE)
    for table in ("tracks", "detections", "points", "baseline_tracks"):
        assert getattr(emulated, table).tobytes() == getattr(plain, table).tobytes(), table
    np.testing.assert_array_equal(emulated.outputs().frame_hash, plain.outputs().frame_hash)
    assert emulated.metrics == plain.metrics
    assert injected(emulated) == {}


@pytest.mark.parametrize("name", [*PACKAGED, *OWN])
def test_every_fault_is_in_a_counter_and_people_stay_tracked(walk: Recording, name: str) -> None:
    result = run(walk, name)
    applied, hub = injected(result), result.counters["hub"]
    assert applied
    if name in LAWS:
        expected = LAWS[name](applied)
        assert {key: hub[key] for key in TROUBLE if hub.get(key)} == expected
    assert result.metrics["tracked_fraction"] >= 0.9
    assert result.metrics["false_tracks_per_100_s"] == 0.0


def test_a_receiver_that_restarts_settles_anew(walk: Recording) -> None:
    result = run(walk, "restart")
    counted = result.counters["rx2"]
    assert (counted["starts"], counted["settling_responses"]) == (2, 2 * SETTLING)
    assert result.counters["rx1"]["settling_responses"] == SETTLING
    hub = result.counters["hub"]
    assert hub["lost"] == len(walk.nodes[1].scans) - counted["responses"] == 4
    assert hub["resynchronised"] == 1


@pytest.mark.slow
@pytest.mark.parametrize("target", ["process", "cortex-m7"])
@pytest.mark.parametrize("name", ["lost", "late", "doubled", "restart", "hub-restart"])
def test_firmware_says_the_same_under_the_same_faults(walk: Recording, name: str, target: str) -> None:
    here, there = run(walk, name), run(walk, name, target)
    assert set(injected(there)) == set(injected(here))  # firmware sends heartbeats, which have faults too
    assert there.tracks.tobytes() == here.tracks.tobytes()
    np.testing.assert_array_equal(there.detections, here.detections)
    for machine, counted in here.counters.items():
        own = [key for key in counted if not key.startswith("link_")]
        assert {key: there.counters[machine][key] for key in own} == {key: counted[key] for key in own}
