"""All scans of one node, stacked (Fig. 6 of the paper)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from echofuse.display import setting, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    from echofuse.recording import NodeRecording
    from echofuse.result import NodeStack, RunResult

MAX_ROWS = 600  # of an image: what the screen resolves
MAX_COLUMNS = 700
FLOOR_PERCENTILE = 50.0  # of the positive residuals: the darkest colour
CEILING_PERCENTILE = 99.8

Extent = tuple[float, float, float, float]  # of an image: delay from and to [ns], time from and to [s]


def stack_figure(result: RunResult, name: str) -> Figure:
    """Draw node `name`'s true echoes, residuals, decisions and clusters over delay [ns] and time [s]."""
    stack = result.stacks[name]
    node = setting.node_by_name(result, name)
    time_s = _scan_time_s(result, node, stack)
    delay_ns = np.asarray(stack.delay_s, dtype=np.float64) * 1e9
    half_row_s = 0.5 * (float(np.median(np.diff(time_s))) if time_s.size > 1 else 1.0)
    extent = (
        float(delay_ns[0]),
        float(delay_ns[-1]),
        float(time_s[0]) - half_row_s if time_s.size else 0.0,
        float(time_s[-1]) + half_row_s if time_s.size else 1.0,
    )
    truth = _true_delays_ns(result, node)
    frames_s = setting.elapsed_s(result, result.frame_time_us)
    with style.look():
        figure, panels = style.new_panels(2, 2, 6.4, legend=False, right_in=0.85, share_y=True)
        panels[0, 0].set_title("(a) True delay of the echo")
        draw_truth(panels[0, 0], frames_s, truth)
        if len(truth) > 1:
            panels[0, 0].legend(
                loc="upper right", title="person", title_fontsize=8.0, frameon=True, edgecolor="none"
            )
        panels[0, 1].set_title("(b) After clutter removal")
        draw_decibel(figure, panels[0, 1], stack.residual, extent, "residual ")
        panels[1, 0].set_title("(c) Decisions")
        draw_hits(panels[1, 0], stack.decisions, extent)
        _draw_clusters(panels[1, 1], stack, time_s, delay_ns, frames_s, truth)
        for axes in panels.flat:
            axes.set_xlim(extent[0], extent[1])
            axes.set_ylim(extent[2], extent[3])
        for axes in panels[1]:
            axes.set_xlabel("delay [ns]")
        for axes in panels[:, 0]:
            axes.set_ylabel("time [s]")
    return figure


def shrink_by_maximum(image: NDArray[Any], *, max_rows: int, max_columns: int) -> NDArray[Any]:
    """Return image (n_rows, n_columns) reduced to at most the given size; thin echoes survive as maxima."""
    for axis, limit in ((0, max_rows), (1, max_columns)):
        length = image.shape[axis]
        if length > limit:
            starts = np.unique(np.linspace(0, length, limit, endpoint=False).astype(np.intp))
            image = np.asarray(np.maximum.reduceat(image, starts, axis=axis))
    return image


def _scan_time_s(result: RunResult, node: NodeRecording, stack: NodeStack) -> NDArray[np.float64]:
    """Return the scans' times (n_scans,) since the first frame [s]."""
    n_scans = stack.residual.shape[0]
    if n_scans == result.frame_time_us.size:
        return setting.elapsed_s(result, result.frame_time_us)
    time_s = np.asarray(node.time_s, dtype=np.float64)[:n_scans]
    start_s = setting.frame_time_s(result)[0] if result.frame_time_us.size else time_s[0]
    return np.asarray(time_s - start_s)


def _true_delays_ns(result: RunResult, node: NodeRecording) -> list[tuple[str, NDArray[np.float64]]]:
    """Return (name, delay (n_frames,) [ns]) of each person."""
    frames_s = setting.frame_time_s(result)
    return [
        (person.name, setting.echo_delay_s(node, person.at(frames_s)) * 1e9)
        for person in setting.people(result)
    ]


def draw_truth(
    axes: Axes, frames_s: NDArray[np.float64], truth: list[tuple[str, NDArray[np.float64]]]
) -> None:
    """Draw people's delays (n_frames,) [ns] by name over the frames' times, or say that none is known."""
    if not truth:
        axes.text(
            0.5,
            0.5,
            "the recording holds no truth",
            transform=axes.transAxes,
            ha="center",
            va="center",
            color=style.QUIET,
        )
    for index, (name, delay_ns) in enumerate(truth):
        axes.plot(
            delay_ns,
            frames_s,
            color=style.TRUTH,
            linewidth=1.6,
            linestyle=style.person_dashes(index),
            label=name,
        )


def draw_decibel(figure: Figure, axes: Axes, image: NDArray[Any], extent: Extent, what: str = "") -> None:
    """Draw amplitudes (n_rows, n_columns) [count] in decibels, from the median of those above 0 up."""
    from matplotlib.colors import Normalize

    image = shrink_by_maximum(image, max_rows=MAX_ROWS, max_columns=MAX_COLUMNS)
    positive = image[image > 0.0]
    low, high = (
        np.percentile(positive, [FLOOR_PERCENTILE, CEILING_PERCENTILE])
        if positive.size
        else np.array([0.1, 1.0])
    )
    high = max(float(high), 1.001 * float(low))
    decibel = 20.0 * np.log10(np.maximum(image, low) / high)
    least = Normalize(float(20.0 * np.log10(low / high)), 0.0)
    _draw_image(figure, axes, decibel, extent, least, f"{what}[dB re {high:,.0f} count]")


def draw_share(figure: Figure, axes: Axes, image: NDArray[Any], extent: Extent) -> None:
    """Draw values (n_rows, n_columns) from 0 to 1."""
    from matplotlib.colors import Normalize

    image = shrink_by_maximum(image, max_rows=MAX_ROWS, max_columns=MAX_COLUMNS)
    _draw_image(figure, axes, image, extent, Normalize(0.0, 1.0), "of the largest from there on")


def draw_hits(axes: Axes, decisions: NDArray[Any], extent: Extent) -> None:
    """Draw decisions (n_rows, n_columns): what is above 0."""
    from matplotlib.colors import ListedColormap

    image = shrink_by_maximum(decisions, max_rows=MAX_ROWS, max_columns=MAX_COLUMNS)
    axes.imshow(
        image > 0,
        origin="lower",
        aspect="auto",
        extent=extent,
        cmap=ListedColormap(["#ffffff", style.HIT]),
        vmin=0,
        vmax=1,
        interpolation="nearest",
    )


def _draw_image(
    figure: Figure, axes: Axes, image: NDArray[Any], extent: Extent, norm: Normalize, label: str
) -> None:
    drawn = axes.imshow(
        image,
        origin="lower",
        aspect="auto",
        extent=extent,
        cmap=style.AMPLITUDE_MAP,
        interpolation="nearest",
        norm=norm,
    )
    axes.grid(False)
    bar = figure.colorbar(drawn, cax=axes.inset_axes((1.02, 0.0, 0.025, 1.0)))
    bar.set_label(label, fontsize=8.0)
    bar.outline.set_visible(False)


def _draw_clusters(
    axes: Axes,
    stack: NodeStack,
    time_s: NDArray[np.float64],
    delay_ns: NDArray[np.float64],
    frames_s: NDArray[np.float64],
    truth: list[tuple[str, NDArray[np.float64]]],
) -> None:
    axes.set_title("(d) Clusters" + (", over the true delay" if truth else ""))
    rows = [np.asarray(clusters, dtype=np.float64).reshape(-1, 4) for clusters in stack.clusters]
    for _, true_ns in truth:
        axes.plot(true_ns, frames_s, color="#c3c7ce", linewidth=6.0, zorder=1)
    counts = [len(row) for row in rows]
    if sum(counts) == 0:
        return
    table = np.concatenate(rows)
    at_ns = np.interp(table[:, 0], np.arange(delay_ns.size), delay_ns)
    at_s = np.repeat(time_s[: len(rows)], counts)
    size = 3.0 + 14.0 * np.sqrt(table[:, 1] / table[:, 1].max())
    if len(rows) > 200:
        size = 0.3 * size
    axes.scatter(at_ns, at_s, s=size, color=style.HIT, linewidths=0, rasterized=True)
