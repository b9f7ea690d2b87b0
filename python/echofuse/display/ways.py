"""The table of the ways to positions in space: errors before and after tracking, beside the bound."""

import math
from collections.abc import Mapping, Sequence

__all__ = ["WAYS", "WAY_COLUMNS", "bound_line", "is_of_a_way", "way_lines", "way_rows", "way_values"]

#: Names of `baselines.WAYS[3]`, in the order of the table.
WAYS = {
    "three_d_two_d": "3D-2D",
    "tsm_from_three_d_two_d": "TSM from 3D-2D",
    "approximate": "A-3D-2D",
    "tsm_from_approximate": "TSM from A-3D-2D",
}
POINTS = ("points_rmse_m", "points_located_fraction", "points_cuboid_fraction")
TRACK = ("track_rmse_m", "track_tracked_fraction", "track_cuboid_fraction")
OWN = ("rmse_m", "tracked_fraction", "cuboid_fraction")
WAY_COLUMNS = ("RMSE [m]", "located", "in cuboid", "RMSE [m]", "tracked", "in cuboid")
BOUND = "position_error_bound_m"


def is_of_a_way(name: str) -> bool:
    """Whether a metric is of one of the table's ways, and not of the run's own."""
    return any(name.startswith(f"{way}_") for way in WAYS)


def way_rows(metrics: Mapping[str, float], tracker: str) -> list[tuple[str, list[float | None]]]:
    """Return a name and six values a way, None where there are none; no rows without positions in space.

    tracker: what the run's own is called, which has no points of its own.
    """
    rows = [
        (label, [metrics.get(f"{way}_{column}") for column in (*POINTS, *TRACK)])
        for way, label in WAYS.items()
        if f"{way}_{POINTS[0]}" in metrics
    ]
    nothing: list[float | None] = [None] * len(POINTS)
    return [*rows, (tracker, nothing + [metrics.get(name) for name in OWN])] if rows else []


def bound_line(metrics: Mapping[str, float]) -> str:
    """Return the bound of one response's position in words, empty when it is not known."""
    if BOUND not in metrics:
        return ""
    return (
        f"Cramér-Rao bound of one response's position: {metrics[BOUND]:.3f} m (root mean square), "
        f"at paths with a deviation of {metrics['path_error_std_m']:.3f} m"
    )


def way_lines(metrics: Mapping[str, float], tracker: str) -> list[str]:
    """Return the table as lines for a terminal."""
    rows = way_rows(metrics, tracker)
    if not rows:
        return []
    wide = max(len(label) for label, _ in rows)
    lines = [f"{'':{wide}s}  {'positions':>31s}  {'tracks':>31s}", " " * wide + "  " + _cells(WAY_COLUMNS)]
    for label, values in rows:
        lines.append(f"{label:{wide}s}  " + _cells(way_values(values)))
    bound = bound_line(metrics)
    return [*lines, bound] if bound else lines


def way_values(values: Sequence[float | None]) -> list[str]:
    """Return a row's values as text, by WAY_COLUMNS; "-" of what there is none."""
    return [_value(column, value) for column, value in enumerate(values)]


def _cells(texts: Sequence[str]) -> str:
    return "  ".join(f"{text:>9s}" for text in texts)


def _value(column: int, value: float | None) -> str:
    if value is None or math.isnan(value):
        return "-"
    return f"{value:.3f}" if column % 3 == 0 else f"{100.0 * value:.1f} %"
