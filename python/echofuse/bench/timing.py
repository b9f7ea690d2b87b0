"""Compares the speed of two sides that take turns, so that a busy machine slows both down."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

Run = Callable[[], float]  # one call, and how long it took [s]
Clock = Callable[[], float]  # [s]

MIN_PAIRS = 3
TURN_S = 1e-3  # the least that one side's turn takes, so that the clock's own resolution does not matter
MAX_CALLS = 1000  # of one turn


@dataclass(frozen=True, kw_only=True)
class Case:
    """The same work twice: by the compiled library and by its reference."""

    group: str  # node, hub or frame
    name: str
    core: Run
    reference: Run
    in_step: bool = False  # both go through the same frames: one call a turn, so that pairs are of one frame


@dataclass(frozen=True, kw_only=True)
class Row:
    """What a case measured."""

    group: str
    name: str
    ratio: float  # median over pairs of the reference's time over the library's
    ratio_quartiles: tuple[float, float]
    core_ms: float  # median of one call [ms]: of this run on this machine
    reference_ms: float
    pairs: int


def timed(call: Callable[[], object], clock: Clock = time.perf_counter) -> Run:
    """Return a run of the whole call."""

    def run() -> float:
        begin = clock()
        call()
        return clock() - begin

    return run


def compare(case: Case, seconds: float, clock: Clock = time.perf_counter) -> Row:
    """Let both sides take turns for some seconds, at least `MIN_PAIRS` times, after one warming turn each."""
    end = clock() + seconds
    core_calls, reference_calls = calls_of_a_turn(case.core), calls_of_a_turn(case.reference)
    if case.in_step:
        core_calls = reference_calls = 1
    pairs: list[tuple[float, float]] = []
    while len(pairs) < MIN_PAIRS or clock() < end:
        pairs.append((turn(case.core, core_calls), turn(case.reference, reference_calls)))
    core_s, reference_s = np.array(pairs).T
    low, ratio, high = np.quantile(reference_s / core_s, (0.25, 0.5, 0.75))
    return Row(
        group=case.group,
        name=case.name,
        ratio=float(ratio),
        ratio_quartiles=(float(low), float(high)),
        core_ms=1e3 * float(np.median(core_s)),
        reference_ms=1e3 * float(np.median(reference_s)),
        pairs=len(pairs),
    )


def calls_of_a_turn(run: Run) -> int:
    """Return how many calls fill a turn, judged by the second call: the first one warms up."""
    run()
    return int(np.clip(np.ceil(TURN_S / max(run(), 1e-9)), 1, MAX_CALLS))


def turn(run: Run, calls: int) -> float:
    """Return the mean time of some calls in a row [s]."""
    return sum(run() for _ in range(calls)) / calls


def exponents(sizes: Sequence[float], time_s: Sequence[float]) -> tuple[float, float]:
    """Exponent p of time ~ size^p: fitted over all sizes (log-log), and of the last step alone.

    A constant part lowers the first; the last step shows what large sizes cost.
    """
    log_size, log_time = np.log(np.asarray(sizes, np.float64)), np.log(np.asarray(time_s, np.float64))
    fitted = float(np.polyfit(log_size, log_time, 1)[0])
    return fitted, float((log_time[-1] - log_time[-2]) / (log_size[-1] - log_size[-2]))
