"""The progress bar shows itself to people who wait, and to nobody else."""

import io
import sys
from collections.abc import Callable, Iterator

import pytest

from echofuse.display.progress import progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def ticking(step_s: float) -> Callable[[], float]:
    """Return a clock that goes on by `step_s` at each look."""
    now = iter(range(10_000))
    return lambda: step_s * next(now)


def test_pipe_sees_nothing() -> None:
    pipe = io.StringIO()
    assert list(progress([3, 1, 2], "work", stream=pipe, clock=ticking(10.0))) == [3, 1, 2]
    assert pipe.getvalue() == ""


def test_quick_work_shows_nothing() -> None:
    terminal = Terminal()
    assert list(progress(range(10), "work", stream=terminal, clock=ticking(0.01))) == list(range(10))
    assert terminal.getvalue() == ""


def test_slow_work_shows_how_far_it_is() -> None:
    terminal = Terminal()
    assert list(progress(range(10), "drawing", stream=terminal, clock=ticking(1.0))) == list(range(10))
    assert "drawing" in terminal.getvalue()
    assert "10/10" in terminal.getvalue()


def test_generator_without_length() -> None:
    def items() -> Iterator[int]:
        yield from (1, 2, 3, 4)

    terminal = Terminal()
    assert list(progress(items(), "drawing", stream=terminal, clock=ticking(3.0))) == [1, 2, 3, 4]
    assert "drawing" in terminal.getvalue()


def test_without_rich(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("rich.console", "rich.progress"):
        monkeypatch.setitem(sys.modules, module, None)
    terminal = Terminal()
    assert list(progress(range(5), "work", stream=terminal, clock=ticking(3.0))) == list(range(5))
    assert terminal.getvalue() == ""


def test_bar_is_gone_after_an_error() -> None:
    def failing() -> Iterator[int]:
        yield from range(5)
        raise RuntimeError

    terminal = Terminal()
    with pytest.raises(RuntimeError):
        list(progress(failing(), "work", stream=terminal, clock=ticking(3.0)))
    assert list(progress(range(3), "again", stream=terminal, clock=ticking(3.0))) == [0, 1, 2]
