"""Compares one tap of a target with the reference, and keeps the score: one row a choice and tap."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echofuse.conformance.tolerances import TOLERANCES

#: A decision may differ where the reference itself was this close (relative) to deciding otherwise.
COIN_TOSS_MARGIN = 1e-5


@dataclass(kw_only=True)
class Row:
    """What was compared of one tap under one choice, over all inputs."""

    choice: str  # such as "cfar.method=ordered_statistic"
    tap: str  # a name of TapId, or a quantity of the tolerance table
    cases: int = 0  # calls compared
    values: int = 0  # floats or decisions compared
    worst: float = 0.0  # largest deviation over its tolerance; <= 1 passes
    excused: int = 0  # values that differ where the reference's margin is a coin toss
    failures: list[str] = field(default_factory=list)  # which input, which sample, both values

    @property
    def passed(self) -> bool:
        """Whether everything agreed, and anything was compared at all."""
        return self.values > 0 and not self.failures


class Scoreboard:
    """Rows by (choice, tap), in the order of their first comparison."""

    def __init__(self) -> None:
        self._rows: dict[tuple[str, str], Row] = {}

    @property
    def passed(self) -> bool:
        """Whether there are rows, and all of them passed."""
        return bool(self._rows) and all(row.passed for row in self._rows.values())

    def rows(self) -> list[Row]:
        """Return all rows so far."""
        return list(self._rows.values())

    def as_json(self) -> list[dict[str, Any]]:
        """Return the rows as plain data."""
        return [asdict(row) | {"passed": row.passed} for row in self.rows()]

    def row(self, choice: str, tap: str) -> Row:
        """Return the row, made at its first mention: a tap that never comes is 'nothing compared'."""
        return self._rows.setdefault((choice, tap), Row(choice=choice, tap=tap))

    def shows(self, choice: str, where: str, taps: Iterable[str], shown: Mapping[str, object]) -> bool:
        """Whether a target shows all taps; one that it does not is a failure of that tap."""
        missing = [tap for tap in taps if tap not in shown]
        for tap in missing:
            self.row(choice, tap).failures.append(f"{where}: the target shows no such tap")
        return not missing

    def floats(
        self,
        choice: str,
        tap: str,
        where: str,
        target: ArrayLike,
        reference: ArrayLike,
        tolerance: str,
        margin: ArrayLike = np.inf,
        scale: ArrayLike | None = None,
    ) -> bool:
        """Compare two arrays of any shape within the row of the tolerance table; return whether they agree.

        `scale`: what the relative tolerance is relative to, if not the reference's largest magnitude;
        one value, or one a value.

        `margin` belongs to the reference's decisions on which the values rest: in a coin toss, values
        may differ, and are counted as excused.
        """
        row = self.row(choice, tap)
        got, expected = np.atleast_1d(to_float64(target)), np.atleast_1d(to_float64(reference))
        row.cases += 1
        if got.shape != expected.shape:
            row.failures.append(f"{where}: shape {got.shape} instead of {expected.shape}")
            return False
        row.values += got.size
        if got.size == 0:
            return True
        limit = TOLERANCES[tolerance]
        magnitude = float(np.max(np.abs(expected))) if scale is None else to_float64(scale)
        allowed = np.maximum(limit.atol + limit.rtol * magnitude, 1e-300)
        excess = np.abs(got - expected) / allowed
        excess[~np.isfinite(got)] = np.inf
        tossed = np.broadcast_to(np.abs(np.asarray(margin, np.float64)) < COIN_TOSS_MARGIN, got.shape)
        excused = tossed & (excess > 1.0)
        row.excused += int(np.count_nonzero(excused))
        excess = np.where(excused, 0.0, excess)
        worst = int(np.argmax(excess))
        row.worst = max(row.worst, float(excess.flat[worst]))
        if excess.flat[worst] > 1.0:
            row.failures.append(
                f"{where}: element {worst} is {got.flat[worst]:.9g}, "
                f"the reference says {expected.flat[worst]:.9g} "
                f"({excess.flat[worst]:.3g} times the tolerance)"
            )
            return False
        return not np.any(excused)

    def decisions(
        self, choice: str, tap: str, where: str, target: ArrayLike, reference: ArrayLike, margin: ArrayLike
    ) -> bool:
        """Compare decisions of one shape; `margin` is the reference's distance from deciding otherwise.

        Returns whether they are identical, so that what depends on them may be compared. Another number of
        decisions (of clusters, say) is excused when one decision that made them was a coin toss.
        """
        row = self.row(choice, tap)
        got, expected = np.atleast_1d(target), np.atleast_1d(reference)
        row.cases += 1
        margins = np.abs(np.asarray(margin, np.float64))
        if got.shape != expected.shape:
            if np.min(margins, initial=np.inf) < COIN_TOSS_MARGIN:
                row.excused += 1
            else:
                row.failures.append(f"{where}: shape {got.shape} instead of {expected.shape}")
            return False
        row.values += got.size
        differs = got != expected
        if not np.any(differs):
            return True
        margins = np.broadcast_to(margins, got.shape)
        excused = differs & (margins < COIN_TOSS_MARGIN)
        row.excused += int(np.count_nonzero(excused))
        for index in np.flatnonzero(differs & ~excused)[:1]:
            row.failures.append(
                f"{where}: element {index} is {got.flat[index]}, the reference says {expected.flat[index]} "
                f"(margin {margins.flat[index]:.3g})"
            )
        return False


class TapComparison:
    """What a node showed of one scan, `got`, beside what the reference did, `expected`, by tap."""

    tolerances: str  # what their names begin with

    def __init__(self, board: Scoreboard, choice: str, where: str) -> None:
        self.board, self.choice, self.where = board, choice, where
        self.got: Mapping[str, NDArray[Any]] = {}
        self.expected: Mapping[str, NDArray[np.float64]] = {}

    def floats(
        self,
        tap: str,
        tolerance: str,
        got: ArrayLike | None = None,
        expected: ArrayLike | None = None,
        *,
        margin: ArrayLike = np.inf,
        scale: ArrayLike | None = None,
    ) -> bool:
        """Compare a tap, or `got` and `expected` of it; see `Scoreboard.floats`."""
        if got is None or expected is None:
            got, expected = self.got[tap], self.expected[tap]
        name = f"{self.tolerances}.{tolerance}"
        return self.board.floats(self.choice, tap, self.where, got, expected, name, margin, scale)

    def decisions(
        self,
        tap: str,
        got: ArrayLike | None = None,
        expected: ArrayLike | None = None,
        *,
        margin: ArrayLike = np.inf,
    ) -> bool:
        """Compare a tap, or `got` and `expected` of it; see `Scoreboard.decisions`."""
        if got is None or expected is None:
            got, expected = self.got[tap], self.expected[tap]
        return self.board.decisions(self.choice, tap, self.where, got, expected, margin)


def as_reference(config: object) -> Any:
    """Return a `_core` configuration as the reference takes it: float64 numbers, choices as words."""
    return SimpleNamespace(
        **{name: _plain(getattr(config, name)) for name in config.fields()}  # type: ignore[attr-defined]
    )


def _plain(value: object) -> Any:
    if hasattr(value, "fields"):
        return as_reference(value)
    if hasattr(value, "__members__"):  # a bound enum
        return str(value.name)  # type: ignore[attr-defined]
    if isinstance(value, Iterable) and not isinstance(value, str):
        return [_plain(item) for item in value]
    return value


def to_float64(values: ArrayLike) -> NDArray[np.float64]:
    """Return what a target gave as the reference's input."""
    return np.asarray(values, np.float64)
