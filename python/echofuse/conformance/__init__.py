"""Reference against target, tap by tap: is what runs on a device what the papers say?"""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

__all__ = ["CASES", "conform"]

CASES = ("sensor-radar", "through-wall", "stairs")
Progress = Callable[[Iterator[None], str, int], Iterator[None]]


def conform(
    cases: Sequence[str] = ("sensor-radar",),
    *,
    target: str = "inprocess",
    seeds: int | None = None,
    recording: Path | None = None,
    out: Path | None = None,
    progress: Progress | None = None,
) -> bool:
    """Compare a target with the reference and print the table; return whether all agreed.

    A tap that was never compared does not agree.

    Parameters
    ----------
    cases
        Of `CASES`.
    target
        "inprocess", "process", "cortex-m7", or the address of a board.
    seeds
        How many simulated inputs; by default 20, and 3 on the Cortex-M7.
    recording
        A recording of a sensor radar to compare on as well (with its site inside); by default the real walk,
        where it is there.
    out
        Folder for ``conformance.json`` and ``tolerances.txt``.
    progress
        Wraps the steps for a progress bar: called with (steps, description, how many).
    """
    from echofuse.errors import InputError, problem

    for case in cases:
        if case not in CASES:
            raise InputError(problem("conform", case, f"a case of {', '.join(CASES)}"))
    from echofuse.conformance.command import conform_cases

    return conform_cases(cases, target=target, seeds=seeds, recording=recording, out=out, progress=progress)
