"""The measuring itself on a clock of its own, and one short run of everything."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from echofuse.bench import bench
from echofuse.bench.phd_scaling import AXES, Axis, FollowingFilter, growth
from echofuse.bench.timing import MIN_PAIRS, Case, calls_of_a_turn, compare, exponents, timed

STAGES = {
    "node": (
        "pulse_integrator", "envelope.method", "direct_path.search", "alignment, estimate",
        "alignment, shift", "clutter.method", "cfar.method", "noise_floor",
        "range_clusters.representative", "whole node",
    ),
    "hub": (
        "frame_assembler", "ellipse fix", "selection.method", "point_clusters.distance", "phd, predict",
        "phd, update", "phd, resample", "peaks (EM)", "track_manager", "kalman_tracker", "whole hub",
    ),
}  # fmt: skip


class Clock:
    """Time passes only as told, and faster while others use the machine."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self.load = 1.0
        self.log: list[str] = []

    def __call__(self) -> float:
        return self.now_s

    def work(self, name: str, seconds: float) -> None:
        self.log.append(name)
        self.now_s += seconds * self.load


def case_of(clock: Clock, core_s: float, reference_s: float) -> Case:
    return Case(
        group="node",
        name="known",
        core=timed(lambda: clock.work("core", core_s), clock),
        reference=timed(lambda: clock.work("reference", reference_s), clock),
    )


def test_the_ratio_of_known_times() -> None:
    clock = Clock()
    row = compare(case_of(clock, 0.002, 0.05), 1.0, clock)
    assert row.ratio == pytest.approx(25.0)
    assert row.core_ms == pytest.approx(2.0)
    assert row.reference_ms == pytest.approx(50.0)
    assert row.pairs > MIN_PAIRS


def test_the_sides_take_turns() -> None:
    clock = Clock()
    row = compare(case_of(clock, 0.002, 0.05), 1.0, clock)
    assert clock.log[-2 * row.pairs :] == ["core", "reference"] * row.pairs


def test_a_load_that_comes_and_goes_leaves_the_ratio_alone() -> None:
    clock = Clock()

    def loaded(name: str, seconds: float) -> None:
        clock.load = 1.0 + int(clock.now_s / 0.5) % 5  # up to five times slower, for half a second each
        clock.work(name, seconds)

    case = Case(
        group="hub",
        name="loaded",
        core=timed(lambda: loaded("core", 0.001), clock),
        reference=timed(lambda: loaded("reference", 0.03), clock),
    )
    row = compare(case, 20.0, clock)
    assert row.ratio == pytest.approx(30.0)
    assert row.reference_ms > 40.0  # absolute times are worth little then


def test_sides_in_step_make_the_same_number_of_calls() -> None:
    clock = Clock()
    case = replace(case_of(clock, 0.0001, 0.05), in_step=True)
    assert compare(case, 1.0, clock).ratio == pytest.approx(500.0)
    assert clock.log.count("core") == clock.log.count("reference")


def test_slow_cases_run_a_few_times_anyway() -> None:
    clock = Clock()
    assert compare(case_of(clock, 1.0, 10.0), 0.0, clock).pairs == MIN_PAIRS


@pytest.mark.parametrize(("seconds", "calls"), [(1e-4, 10), (5e-4, 2), (1.0, 1), (1e-9, 1000)])
def test_a_turn_is_long_enough_for_the_clock(seconds: float, calls: int) -> None:
    clock = Clock()
    assert calls_of_a_turn(timed(lambda: clock.work("core", seconds), clock)) == calls


@pytest.mark.parametrize("power", [0.5, 1.0, 2.0])
def test_exponents_of_power_laws(power: float) -> None:
    sizes = (250, 500, 1000, 2000)
    fitted, last = exponents(sizes, [3e-6 * size**power for size in sizes])
    assert fitted == pytest.approx(power)
    assert last == pytest.approx(power)


def test_a_constant_part_hides_in_the_fit_but_less_in_the_last_step() -> None:
    sizes = (1, 2, 4, 8, 16)
    fitted, last = exponents(sizes, [30.0 + size**2 for size in sizes])
    assert fitted < 1.1 < last


@pytest.mark.parametrize("axis", AXES, ids=lambda axis: axis.name.split(" (")[0])
def test_the_filters_follow_what_they_are_said_to(axis: Axis) -> None:
    """An exponent against targets is worth nothing if the filter follows fewer of them."""
    for size in axis.sizes:
        crowd = axis.crowd(size)
        following = FollowingFilter(crowd, seed=size)
        numbers = []
        for _ in range(5):
            following.frame()
            numbers.append(following.number)
        assert abs(np.mean(numbers) - crowd.targets) <= max(0.5, 0.1 * crowd.targets)


def test_growth_is_measured_in_rounds() -> None:
    measured = growth(AXES[0], 0.0)
    assert measured.sizes == AXES[0].sizes
    assert min(measured.time_ms) > 0.0
    assert measured.time_ms[-1] > measured.time_ms[0]


def test_every_stage_and_choice_is_measured_and_the_frame_is_20_times_as_fast() -> None:
    table: Any = json.loads(json.dumps(bench(0.0)))
    names = [(row["group"], row["name"]) for row in table["stages"]]
    assert len(set(names)) == len(names)
    for group, stages in STAGES.items():
        for stage in stages:
            assert any(g == group and name.startswith(stage) for g, name in names), stage
    assert [name.split("=")[1] for _, name in names if name.startswith("cfar.method")] == [
        "double_threshold_buffer",
        "cell_averaging",
        "global_average",
        "ordered_statistic",
    ]
    assert min(row["ratio"] for row in table["stages"]) > 0.0
    assert table["whole_frame"]["ratio"] >= 20.0
    assert table["through_wall_frame"]["ratio"] >= 20.0
    judged = [each["axis"].split()[0] for each in table["phd_growth"] if each["judged"]]
    assert judged == ["particles", "targets", "measurements"]
