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
HUB_RESTARTS = ("hub-restart", "all")  # the hub has no track until it has confirmed one again


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
    assert metrics["false_track_fraction"] == 0.0
    if name in HUB_RESTARTS:
        assert metrics["tracked_fraction"] >= 0.7
    else:
        assert metrics["tracked_fraction"] >= 0.95
        assert metrics["count_right_fraction"] >= 0.95


def test_without_faults_the_result_is_that_of_the_pipeline(walk: Recording, site: Site) -> None:
    emulated, plain = emulate(walk, site), process_recording(walk, site)
    for table in ("tracks", "detections", "points", "baseline_tracks"):
        np.testing.assert_array_equal(getattr(emulated, table), getattr(plain, table))
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
    assert result.counters["rx4"]["starts"] == (2 if name == "restart" else 1)


@pytest.mark.parametrize("name", ["too-late", "reordered", "radar"])
def test_what_comes_out_of_step_is_missing_in_its_frame(walk: Recording, site: Site, name: str) -> None:
    """A report that comes too late or too early counts for what came and for what was missing."""
    result = run(walk, site, name)
    hub, log = result.counters["hub"], log_of(result)
    extra = log.effects(Effect.EXTRA)
    assert hub["frames"] == 61
    assert hub["lost"] + hub["absent"] == hub["late"] + hub["early"] + log.effects(Effect.UNMADE) - extra
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


def test_faults_on_the_firmware_are_those_in_this_process(walk: Recording, site: Site) -> None:
    for name in ("lost", "all"):
        here, there = run(walk, site, name), run(walk, site, name, target="process")
        assert problems(there) == []
        np.testing.assert_array_equal(there.tracks, here.tracks)


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
    for seed in range(1, 21):
        try:
            result = run(walk, site, name, seed)
        except NotAppliedError:
            continue
        assert problems(result) == []
        check_track(result, name)
