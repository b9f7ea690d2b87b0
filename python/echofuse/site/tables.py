"""One table of a TOML file being checked: takes keys out, notes problems, reports what nobody asked for."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Any

from echofuse.errors import problem

__all__ = ["Problems", "Table", "finite_number", "suggestion"]


@dataclass
class Problems:
    """What is wrong with one file, one line each."""

    source: str
    lines: list[str] = field(default_factory=list)

    def add(self, key: str, expected: str, found: object = None) -> None:
        self.lines.append(problem(self.source, key, expected, found))


def suggestion(key: str, known: Sequence[str]) -> str:
    """Return what an unknown key should have been: the closest known one, or all of them."""
    close = get_close_matches(key, known, n=1, cutoff=0.6)
    return f"a known key (did you mean {close[0]}?)" if close else f"one of {', '.join(known) or 'no keys'}"


def finite_number(value: Any) -> bool:
    """Whether a TOML value is a finite number (and no truth value)."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


class Table:
    """Takes typed values out of a table. Everything wrong becomes a problem and yields None."""

    def __init__(self, values: Any, name: str, problems: Problems) -> None:
        self.name = name
        self.problems = problems
        self.known: list[str] = []
        self.values: dict[str, Any] = {}
        if isinstance(values, dict):
            self.values = values
        else:
            problems.add(name, "a table", values)

    def key(self, key: str) -> str:
        return f"{self.name}.{key}"

    def wrong(self, key: str, expected: str, found: object = None) -> None:
        self.problems.add(self.key(key), expected, found)

    def take(self, key: str, expected: str, *, required: bool) -> Any:
        """Return a raw value, or None; a required one that is missing is a problem."""
        self.known.append(key)
        if key not in self.values and required:
            self.wrong(key, expected, "nothing")
        return self.values.get(key)

    def string(self, key: str, *, required: bool = False) -> str | None:
        value = self.take(key, "a string", required=required)
        if value is None or (isinstance(value, str) and value):
            return value
        self.wrong(key, "a string", value)
        return None

    def integer(self, key: str, low: int, high: int, *, required: bool = False) -> int | None:
        expected = f"an integer from {low} to {high}"
        value = self.take(key, expected, required=required)
        if value is None or (isinstance(value, int) and not isinstance(value, bool) and low <= value <= high):
            return value
        self.wrong(key, expected, value)
        return None

    def number(self, key: str, low: float, high: float, unit: str, *, required: bool = False) -> float | None:
        expected = f"a number [{unit}] from {low:g} to {high:g}"
        value = self.take(key, expected, required=required)
        if value is None:
            return None
        if finite_number(value) and low <= value <= high:
            return float(value)
        self.wrong(key, expected, value)
        return None

    def numbers(
        self, key: str, counts: Sequence[int], expected: str, *, required: bool = False
    ) -> list[float] | None:
        value = self.take(key, expected, required=required)
        if value is None:
            return None
        if isinstance(value, list) and len(value) in counts and all(finite_number(item) for item in value):
            return [float(item) for item in value]
        self.wrong(key, expected, value)
        return None

    def points(
        self, key: str, least: int, expected: str, *, required: bool = False
    ) -> list[tuple[float, float]] | None:
        """Return a list of at least `least` points (x, y)."""
        value = self.take(key, expected, required=required)
        if value is None:
            return None
        if isinstance(value, list) and len(value) >= least and all(_is_point(item) for item in value):
            return [(float(x), float(y)) for x, y in value]
        self.wrong(key, expected, value)
        return None

    def finish(self) -> None:
        """Report the keys that nobody took."""
        for key in self.values:
            if key not in self.known:
                self.wrong(key, suggestion(key, self.known), "an unknown key")


def _is_point(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(finite_number(item) for item in value)
