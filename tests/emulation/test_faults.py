"""Each fault alone and all together on the case study: the track is kept, and every fault is in a counter."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest

from echofuse.emulation.injection import Effect, InjectionLog, NotAppliedError
from echofuse.emulation.reception import REJECTED
from echofuse.emulation.run import emulate
from echofuse.emulation.scenario_file import example_scenarios, load_scenario, parse_scenario
from echofuse.pipeline import process_recording
from echofuse.recording import Recording
from echofuse.result import RunResult
from echofuse.site import Site

RMSE_M, RMSE_TWO_SILENT_M = 0.30, 0.45
#: Where there is no track for a while: until the hub has confirmed one again, or while no node reports.
#: With all faults at once two nodes in three report then: three good frames in a row may be long in coming.
INTERRUPTED = {"hub-restart": 0.9, "power-cut": 0.7, "all": 0.5}
MEAN_TRACKED = {"hub-restart": 0.9, "power-cut": 0.7, "all": 0.8}


def run(walk: Recording, site: Site, name: str, seed: int = 0, target: str = "inprocess") -> RunResult:
    return emulate(walk, site, load_scenario(name), seed, target)


def log_of(result: RunResult) -> InjectionLog:
    assert result.emulation is not None
    return result.emulation.log


def problems(result: RunResult) -> list[str]:
    assert result.emulation is not None
    return list(result.emulation.account.problems)


def check_track(result: RunResult, name: str) -> None:
    metrics = result.metrics
    assert metrics["rmse_m"] <= (RMSE_TWO_SILENT_M if name in ("silent-two", "all") else RMSE_M)
    assert metrics["false_track_fraction"] <= (0.05 if name == "all" else 0.0)
    if name in INTERRUPTED:
        assert metrics["tracked_fraction"] >= INTERRUPTED[name]
    else:
        assert metrics["tracked_fraction"] >= 0.95
        assert metrics["count_right_fraction"] >= 0.95


def test_without_faults_the_result_is_that_of_the_pipeline(walk: Recording, site: Site) -> None:
    emulated, plain = emulate(walk, site), process_recording(walk, site)
    for table in ("tracks", "detections", "points", "baseline_tracks"):
        assert getattr(emulated, table).tobytes() == getattr(plain, table).tobytes(), table
    np.testing.assert_array_equal(emulated.outputs().frame_hash, plain.outputs().frame_hash)
    assert emulated.metrics == plain.metrics
    for machine, counters in plain.counters.items():
        assert {name: emulated.counters[machine][name] for name in counters} == counters
    assert problems(emulated) == []
    assert log_of(emulated).applied() == {}


@pytest.mark.parametrize("name", sorted(example_scenarios()))
def test_a_track_is_kept_and_every_fault_is_in_a_counter(walk: Recording, site: Site, name: str) -> None:
    result = run(walk, site, name)
    assert problems(result) == []
    assert log_of(result).applied()
    check_track(result, name)


#: The counters of trouble that a scenario moves, by how often each kind of fault was applied.
Law = Callable[[Mapping[str, int]], dict[str, int]]
LAWS: dict[str, Law] = {
    "lost": lambda n: {"lost": n["link.loss"]},
    "bit-errors": lambda n: {"lost": n["link.bit_error_rate"]},
    "jitter": lambda n: {},
    "drift": lambda n: {},
    "slow-link": lambda n: {},
    "late": lambda n: {"slow": n["link.late"]},
    "doubled": lambda n: {"link_repeated": n["link.doubled"]},
    "silent-one": lambda n: {"lost": 10, "absent": n["fault.silent"] - 10},
    "silent-two": lambda n: {"lost": 20, "absent": n["fault.silent"] - 20},
    "restart": lambda n: {"lost": n["fault.restart"] - 2, "resynchronised": 1},
    "power-cut": lambda n: {"lost": 60, "absent": n["fault.restart"] - 12 - 60, "resynchronised": 6},
    "hub-restart": lambda n: {},
    "garbage": lambda n: {"lost": 10, "absent": n["fault.garbage"] - 10},
    "stranger": lambda n: {"unknown_node": n["fault.stranger"]},
}
TROUBLE = (
    *("late", "early", "doubled", "malformed", "unknown_node", "lost", "absent", "slow", "resynchronised"),
    *("clock_faults", "link_repeated"),
)


@pytest.mark.parametrize("name", sorted(LAWS))
def test_a_fault_alone_moves_its_counters_by_exactly_so_much(walk: Recording, site: Site, name: str) -> None:
    result = run(walk, site, name)
    hub, log = result.counters["hub"], log_of(result)
    moved = {counter: hub[counter] for counter in TROUBLE if hub[counter]}
    assert moved == {key: value for key, value in LAWS[name](log.applied()).items() if value}
    rejected = sum(hub[f"link_{reason}"] for reason in REJECTED)
    assert rejected >= log.effects(Effect.DAMAGED)
    assert (rejected > 0) == (name in ("bit-errors", "garbage"))
    assert hub["starts"] == (2 if name == "hub-restart" else 1)
    assert result.counters["rx4"]["starts"] == (2 if name in ("restart", "power-cut") else 1)


def test_a_radar_that_counts_wrong_costs_what_it_missed(walk: Recording, site: Site) -> None:
    result = run(walk, site, "radar")
    hub, log = result.counters["hub"], log_of(result)
    assert 0 < log.effects(Effect.UNMADE) == hub["lost"]
    assert 0 < log.effects(Effect.EXTRA) == hub["doubled"] + hub["late"]  # when all others are in
    assert 0 < hub["resynchronised"] <= log.effects(Effect.UNMADE) + log.effects(Effect.EXTRA)
    assert (hub["early"], hub["absent"]) == (0, 0)


@pytest.mark.parametrize("name", ["too-late", "reordered"])
def test_what_comes_out_of_step_is_missing_in_its_frame(walk: Recording, site: Site, name: str) -> None:
    """A report that comes out of step counts for what came and for what was missing."""
    hub = run(walk, site, name).counters["hub"]
    assert hub["frames"] == 61
    assert hub["lost"] + hub["absent"] == hub["late"] + hub["early"] + hub["doubled"]
    assert hub["late"] > 0


def test_the_same_seed_gives_the_same_bytes(walk: Recording, site: Site) -> None:
    first, again, other = (run(walk, site, "all", seed) for seed in (4, 4, 5))
    np.testing.assert_array_equal(first.outputs().frame_hash, again.outputs().frame_hash)
    assert log_of(first).entries == log_of(again).entries
    assert first.counters == again.counters
    assert log_of(first).entries != log_of(other).entries


def test_one_more_fault_does_not_shift_the_others(walk: Recording, site: Site) -> None:
    text = load_scenario("lost").text
    alone = log_of(emulate(walk, site, parse_scenario(text), 3)).entries
    more = text + 'doubled = 0.2\n[radar]\njitter_us = 100\n[[fault]]\nkind = "stranger"\nnode_id = 99\n'
    together = log_of(emulate(walk, site, parse_scenario(more), 3)).entries
    lost = [(entry.node, round(entry.time_us, -5)) for entry in together if entry.kind == "link.loss"]
    assert sorted(lost) == sorted((entry.node, entry.time_us) for entry in alone)


@pytest.mark.parametrize("name", sorted(example_scenarios()))
def test_faults_on_the_firmware_are_accounted_for_as_well(walk: Recording, site: Site, name: str) -> None:
    result = run(walk, site, name, target="process")
    assert problems(result) == []
    check_track(result, name)
    if name != "reordered":  # there a heartbeat may be what overtakes a report
        assert result.tracks.tobytes() == run(walk, site, name).tracks.tobytes()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["all", "power-cut"])
def test_faults_on_the_bare_machine_are_those_in_this_process(walk: Recording, site: Site, name: str) -> None:
    here, there = run(walk, site, name), run(walk, site, name, target="cortex-m7")
    assert problems(there) == []
    for column in ("frame", "id", "state", "frames_since_update"):
        np.testing.assert_array_equal(there.tracks[column], here.tracks[column])
    for column in ("x_m", "y_m"):
        np.testing.assert_allclose(there.tracks[column], here.tracks[column], atol=1e-3)


#: Faults that meet. The track may be lost, but no report is in no counter.
MEETING = {
    "copies that come late": (
        "[radar]\njitter_us = 5000\n"
        "[link]\ndoubled = 0.5\nlate = 0.5\nlate_us = 100000\nbandwidth_bps = 64000\n"
    ),
    "two strangers of one id": '[[fault]]\nkind = "stranger"\nnode_id = 99\n' * 2,
    "all nodes silent": "".join(
        f'[[fault]]\nkind = "silent"\nnode = "rx{i}"\nat_s = 2.0\nuntil_s = 3.5\n' for i in range(1, 7)
    ),
    "the last node comes back": '[[fault]]\nkind = "silent"\nnode = "rx6"\nat_s = 1.0\nuntil_s = 3.0\n',
    "two restarts of the hub with doubled reports": (
        "[link]\ndoubled = 0.5\n"
        '[[fault]]\nkind = "hub_restart"\nat_s = 2.02\n[[fault]]\nkind = "hub_restart"\nat_s = 4.0\n'
    ),
    "half of the reports lost": "[link]\nloss = 0.5\n",
    "every bit in a thousand": "[link]\nbit_error_rate = 1e-3\n",
    "a second of latency": "[link]\nlatency_us = 1000000\n",
    "a line too slow for its reports": "[link]\nbandwidth_bps = 4000\n",
}


@pytest.mark.parametrize("target", ["inprocess", "process"])
@pytest.mark.parametrize("name", sorted(MEETING))
def test_faults_that_meet_are_accounted_for(walk: Recording, site: Site, name: str, target: str) -> None:
    assert problems(emulate(walk, site, parse_scenario(MEETING[name]), 0, target)) == []


def test_a_fault_that_never_came_about_is_an_error(short_walk: Recording, site: Site) -> None:
    with pytest.raises(NotAppliedError, match=r"scenario silent-one: never applied .*: fault\.silent of rx3"):
        run(short_walk, site, "silent-one")


def test_a_node_that_the_site_does_not_list_is_a_stranger(short_walk: Recording, site: Site) -> None:
    smaller = replace(site, nodes=site.nodes[:5])
    result = emulate(short_walk, smaller)
    assert result.counters["hub"]["unknown_node"] == 30
    assert problems(result) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(example_scenarios()))
def test_a_track_is_kept_whatever_the_seed(walk: Recording, site: Site, name: str) -> None:
    seeds = range(1, 21)
    not_applied, tracked = 0, []
    for seed in seeds:
        try:
            result = run(walk, site, name, seed)
        except NotAppliedError:
            not_applied += 1
            continue
        assert problems(result) == []
        check_track(result, name)
        tracked.append(result.metrics["tracked_fraction"])
    assert not_applied <= 1
    assert np.mean(tracked) >= MEAN_TRACKED.get(name, 0.95)
