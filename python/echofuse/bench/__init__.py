"""C++ against the NumPy reference, per stage and per frame; and how the particle filter's time grows.

Both sides take turns in one process, and only ratios of turns that follow each other are compared: a machine
that others use as well slows both down. The library is called through its Python binding, so that its time
includes the call and the copies of arrays into it: what a stage takes on a device is less, and the ratios of
quick stages are lower bounds.
"""

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from typing import Any

from echofuse.bench.frame_cases import frame_case
from echofuse.bench.hub_cases import hub_cases
from echofuse.bench.material import case_study
from echofuse.bench.node_cases import node_cases
from echofuse.bench.phd_scaling import MAX_EXPONENT, Growth, phd_growths
from echofuse.bench.through_wall_cases import through_wall_frame_case
from echofuse.bench.timing import Case, Row, compare
from echofuse.display.progress import progress

__all__ = ["MIN_FRAME_RATIO", "bench"]

MIN_FRAME_RATIO = 20.0
FRAME_SHARE = 0.15  # of the time
GROWTH_SHARE = 0.15
NOTE = (
    "Ratios are medians over pairs of turns in one run. C++ times include the call from Python and its\n"
    "copies. The reference is written to be obvious, not fast: ratios are in the thousands where it is a\n"
    "loop, and near one where NumPy does it in one call. Times are of this run, and no promise."
)


def bench(seconds: float = 45.0) -> dict[str, Any]:
    """Measure, print the tables, and return them as plain data.

    Parameters
    ----------
    seconds
        About how long to measure [s]. Every case runs at least a few times, however little that is.
    """
    material = case_study()
    cases = [*node_cases(material.nodes[0]), *hub_cases(material)]
    share_s = seconds * (1.0 - FRAME_SHARE - GROWTH_SHARE) / len(cases)
    rows = [compare(case, share_s) for case in _shown(cases)]
    frame = compare(frame_case(material), 0.5 * seconds * FRAME_SHARE)
    response = compare(through_wall_frame_case(), 0.5 * seconds * FRAME_SHARE)
    growths = list(phd_growths(seconds * GROWTH_SHARE))
    _print_rows([*rows, frame, response])
    _print_growths(growths)
    fast, linear = (
        min(frame.ratio, response.ratio) >= MIN_FRAME_RATIO,
        all(each.linear for each in growths if each.judged),
    )
    ratios = f"{frame.ratio:.0f} and {response.ratio:.0f} times as fast"
    print(f"\nwhole frame, through the wall: {ratios}, {_verdict(fast)} (at least {MIN_FRAME_RATIO:g})")
    print(f"particle PHD: p up to {_largest(growths):.2f}, {_verdict(linear)} (at most {MAX_EXPONENT:g})")
    print(f"\n{NOTE}")
    return {
        "note": NOTE,
        "stages": [asdict(row) for row in rows],
        "whole_frame": asdict(frame) | {"least_ratio": MIN_FRAME_RATIO},
        "through_wall_frame": asdict(response) | {"least_ratio": MIN_FRAME_RATIO},
        "phd_growth": [asdict(each) | {"most_exponent": MAX_EXPONENT} for each in growths],
        "passed": fast and linear,
    }


def _shown(cases: Sequence[Case]) -> Iterable[Case]:
    return progress(cases, "measuring", len(cases))


def _print_rows(rows: Sequence[Row]) -> None:
    width = max(len(row.name) for row in rows)
    heads = f"{'ratio':>7s}  {'(quartiles)':>15s}  {'C++ [ms]':>9s}  {'NumPy [ms]':>10s}  pairs"
    print(f"{'':5s}  {'stage':{width}s}  {heads}")
    for row in rows:
        quartiles = "({:.3g} - {:.3g})".format(*row.ratio_quartiles)
        print(
            f"{row.group:5s}  {row.name:{width}s}  {row.ratio:7.1f}  {quartiles:>15s}  {row.core_ms:9.4f}  "
            f"{row.reference_ms:10.3f}  {row.pairs:5d}"
        )


def _print_growths(growths: Sequence[Growth]) -> None:
    print("\nparticle PHD, one frame (predict, update, resample): time ~ size^p")
    for each in growths:
        times = "  ".join(f"{size}: {ms:.3f} ms" for size, ms in zip(each.sizes, each.time_ms, strict=True))
        about = "" if each.judged else "   (not judged)"
        print(f"p = {each.exponent:5.2f}, last step {each.last_exponent:5.2f}   {each.axis}   {times}{about}")


def _largest(growths: Sequence[Growth]) -> float:
    return max(max(each.exponent, each.last_exponent) for each in growths if each.judged)


def _verdict(passed: bool) -> str:
    return "passes" if passed else "FAILS"
