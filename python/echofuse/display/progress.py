"""A progress bar for what takes longer than two seconds, on a terminal only."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sized
from typing import TYPE_CHECKING, TextIO, TypeVar

if TYPE_CHECKING:
    from rich.progress import Progress

T = TypeVar("T")

PATIENCE_S = 2.0  # what is over sooner shows no bar


def progress(
    iterable: Iterable[T],
    description: str,
    total: int | None = None,
    *,
    stream: TextIO | None = None,
    clock: Callable[[], float] = time.monotonic,
) -> Iterator[T]:
    """Iterate over `iterable` and show how far it is, on `stream` (default: standard error).

    Silent when `stream` is no terminal, when all is done within `PATIENCE_S`, or when rich is not installed.
    """
    stream = sys.stderr if stream is None else stream
    if total is None and isinstance(iterable, Sized):
        total = len(iterable)
    bar = _bar(stream) if stream.isatty() else None
    if bar is None:
        yield from iterable
        return
    task = bar.add_task(description, total=total)
    began_s, shown = clock(), False
    try:
        for done, item in enumerate(iterable):
            if not shown and clock() - began_s > PATIENCE_S:
                bar.start()
                shown = True
            if shown:
                bar.update(task, completed=done)
            yield item
        if shown:
            bar.update(task, completed=total)
    finally:
        if shown:
            bar.stop()


def _bar(stream: TextIO) -> Progress | None:
    try:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
    except ImportError:
        return None
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=Console(file=stream),
    )
