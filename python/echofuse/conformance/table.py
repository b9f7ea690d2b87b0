"""Prints what was compared: a line a choice, every row that failed, and the tolerances with their reasons."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from echofuse.conformance.comparison import COIN_TOSS_MARGIN, Row, Scoreboard
from echofuse.conformance.tolerances import TOLERANCES

HEADER = ("choice", "taps", "cases", "values", "worst/tol", "of tap", "excused", "verdict")
SHOWN_FAILURES = 3  # of a row


def format_scores(boards: Mapping[str, Scoreboard]) -> str:
    """Return one aligned table: a line a choice of each part (node, hub, ...), then the failing rows."""
    lines: list[tuple[str, ...]] = [HEADER]
    for part, board in boards.items():
        lines.append((part, *[""] * (len(HEADER) - 1)))
        lines += [_line(rows) for rows in _by_choice(board.rows())]
    widths = [max(len(line[column]) for line in lines) for column in range(len(HEADER))]
    text = ["  ".join(_cell(line[k], widths[k], k) for k in range(len(HEADER))).rstrip() for line in lines]
    failed = [row for board in boards.values() for row in board.rows() if not row.passed]
    for row in failed:
        text += ["", f"FAILED: {row.choice}: {row.tap}"]
        text += [f"  {failure}" for failure in row.failures[:SHOWN_FAILURES]]
        if len(row.failures) > SHOWN_FAILURES:
            text.append(f"  and {len(row.failures) - SHOWN_FAILURES} more")
        if row.values == 0:
            text.append("  nothing was compared")
    return "\n".join(text)


def format_tolerances() -> str:
    """Return the tolerance table: quantity, relative, absolute, reason."""
    width = max(len(name) for name in TOLERANCES)
    lines = [f"{'quantity':{width}}  relative  absolute  because"]
    lines += [
        f"{name:{width}}  {row.rtol:8.1g}  {row.atol:8.1g}  {row.reason}" for name, row in TOLERANCES.items()
    ]
    lines.append(f"A decision may differ where the reference's own margin is under {COIN_TOSS_MARGIN:g}.")
    return "\n".join(lines)


def write_json(path: Path, boards: Mapping[str, Scoreboard], about: Mapping[str, Any]) -> None:
    """Write every row and the tolerances."""
    content = {
        **about,
        "passed": all(board.passed for board in boards.values()),
        "coin_toss_margin": COIN_TOSS_MARGIN,
        "rows": {part: board.as_json() for part, board in boards.items()},
        "tolerances": {name: row._asdict() for name, row in TOLERANCES.items()},
    }
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def _by_choice(rows: Iterable[Row]) -> list[list[Row]]:
    grouped: dict[str, list[Row]] = {}
    for row in rows:
        grouped.setdefault(row.choice, []).append(row)
    return list(grouped.values())


def _line(rows: list[Row]) -> tuple[str, ...]:
    worst = max(rows, key=lambda row: row.worst)
    return (
        f"  {rows[0].choice}",
        str(len(rows)),
        str(sum(row.cases for row in rows)),
        str(sum(row.values for row in rows)),
        f"{worst.worst:.3f}",
        worst.tap,
        str(sum(row.excused for row in rows)),
        "ok" if all(row.passed for row in rows) else "FAILED",
    )


def _cell(text: str, width: int, column: int) -> str:
    return text.ljust(width) if column in (0, 5, 7) else text.rjust(width)
