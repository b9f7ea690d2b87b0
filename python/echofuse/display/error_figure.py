"""How far off the tracks were, and how many there were (Fig. 8 of the paper, and what it leaves out)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from echofuse.display import setting, style
from echofuse.display.errors import (
    Errors,
    localisation_errors,
    people_counted,
    people_present,
    walking_frames,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from echofuse.result import RunResult

PAPER_ERROR_M = 0.40  # track A of the paper: 80 % of the walk under this
PAPER_FRACTION = 0.80
SHORTEST_AXIS_M = 0.5  # so that the paper's point is always inside


def error_figure(result: RunResult) -> Figure:
    """Draw the error's cdf, the error over time and the number of people, of tracker and baseline."""
    tracker, baseline = setting.tracker_name(result), setting.baseline_name(result)
    series = (
        (tracker, style.TRACKER, 1.6, localisation_errors(result, result.tracks)),
        (baseline, style.BASELINE, 1.0, localisation_errors(result, result.baseline_tracks)),
    )
    time_s = setting.elapsed_s(result, result.frame_time_us)
    with style.look():
        known = series[0][3] is not None
        figure = style.new_figure(4.6 if known else 2.8)
        if known:
            grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 1.35), height_ratios=(1.25, 1.0))
            cdf = figure.add_subplot(grid[:, 0])
            _draw_cdf(cdf, series, marked=not setting.people(result))
            if not setting.behind_wall(result):
                _mark_paper(cdf, marked=not setting.people(result))
            over_time = figure.add_subplot(grid[0, 1])
            _draw_over_time(over_time, time_s, series, walking_frames(result))
            number = figure.add_subplot(grid[1, 1], sharex=over_time)
            number.set_title("(c) Number of people")
        else:
            number = figure.subplots()
            number.set_title("Number of people")
        _draw_number(number, result, time_s, names=(tracker, baseline))
        style.legend_below(figure, number, columns=5)
    return figure


Series = tuple[tuple[str, str, float, Errors | None], ...]


def _draw_cdf(axes: Axes, series: Series, *, marked: bool) -> None:
    from echofuse.evaluation.tracking import empirical_cdf

    axes.set_title("(a) Distribution of the error")
    widest_m = SHORTEST_AXIS_M
    for _, colour, width, errors in series:
        ascending, fraction = empirical_cdf(np.empty(0) if errors is None else errors.counted_m)
        if ascending.size == 0:
            continue
        axes.step(
            np.r_[0.0, ascending], np.r_[0.0, fraction], where="post", color=colour, linewidth=width, zorder=3
        )
        widest_m = max(widest_m, float(np.percentile(ascending, 99.0)))
    axes.set_xlim(0.0, 1.05 * widest_m)
    axes.set_ylim(0.0, 1.02)
    axes.set_yticks(np.linspace(0.0, 1.0, 6), [f"{percent} %" for percent in range(0, 101, 20)])
    axes.set_xlabel("distance across the marked path [m]" if marked else "localisation error [m]")
    axes.set_ylabel("share of confirmed positions" if marked else "share of all frames")


def _mark_paper(axes: Axes, *, marked: bool) -> None:
    axes.plot(
        [0.0, PAPER_ERROR_M, PAPER_ERROR_M],
        [PAPER_FRACTION, PAPER_FRACTION, 0.0],
        color=style.QUIET,
        linewidth=0.8,
        linestyle=":",
        zorder=2,
    )
    axes.plot([PAPER_ERROR_M], [PAPER_FRACTION], "D", color=style.INK, markersize=5.5, zorder=4)
    axes.annotate(
        f"paper{' (error in the plane)' if marked else ''}: 80 % under 0.40 m",
        (PAPER_ERROR_M, 0.03),
        (-4, 0),
        textcoords="offset points",
        ha="right",
        va="bottom",
        fontsize=8.0,
        zorder=5,
    )


def _draw_over_time(
    axes: Axes, time_s: NDArray[np.float64], series: Series, walking: tuple[int, int]
) -> None:
    axes.set_title("(b) Error over time")
    highest_m = 0.0
    for _, colour, width, errors in reversed(series):
        if errors is None or not np.isfinite(errors.over_time_m).any():
            continue
        axes.plot(time_s, errors.over_time_m, color=colour, linewidth=0.75 * width)
        highest_m = max(highest_m, float(np.nanmax(errors.over_time_m)))
    for start, end in ((0, walking[0]), (walking[1], time_s.size - 1)):
        if 0 <= start < end < time_s.size:
            axes.axvspan(time_s[start], time_s[end], color=style.GRID, alpha=0.6, linewidth=0.0, zorder=0)
    axes.set_ylim(0.0, 1.1 * max(highest_m, PAPER_ERROR_M))
    axes.set_ylabel("error [m]")
    axes.tick_params(labelbottom=False)


def _draw_number(
    axes: Axes, result: RunResult, time_s: NDArray[np.float64], *, names: tuple[str, str]
) -> None:
    from matplotlib.ticker import MaxNLocator

    true_number = people_present(result)
    counts = [people_counted(result, tracks) for tracks in (result.tracks, result.baseline_tracks)]
    if true_number is not None:
        axes.step(
            time_s, true_number, where="mid", color="#c3c7ce", linewidth=5.0, label="true number", zorder=1
        )
    for count, name, colour, width in zip(
        counts, names, (style.TRACKER, style.BASELINE), (1.6, 1.0), strict=True
    ):
        axes.step(time_s, count, where="mid", color=colour, linewidth=width, label=name, zorder=3)
    everything = [*counts] if true_number is None else [*counts, true_number]
    axes.set_ylim(-0.15, max([1.0, *(float(count.max(initial=0)) for count in everything)]) + 0.35)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("time [s]")
    axes.set_ylabel("people")
    if time_s.size > 1:
        axes.set_xlim(time_s[0], time_s[-1])
