"""All responses of one through-wall receiver, stage by stage (Figs. 5 and 6 of the through-wall paper)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.display import setting, style
from echofuse.display.stack_figure import Extent, draw_decibel, draw_hits, draw_share, draw_truth

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from echofuse.recording import NodeRecording
    from echofuse.result import RunResult

BEYOND_AREA = 1.1  # of the delay to the farthest corner of the area: what is shown
TRUE_PATH = "#c3c7ce"
TRACES = "#b9c0ca"


def response_figure(result: RunResult, name: str) -> Figure:
    """Draw node `name`'s responses and what each stage makes of them, over delay [ns] and time [s]."""
    stack, node = result.responses[name], setting.node_by_name(result, name)
    n_responses = len(stack.decisions)
    start_s = setting.frame_time_s(result)[0] if result.frame_time_us.size else float(node.time_s[0])
    time_s = np.asarray(node.time_s, np.float64)[:n_responses] - start_s
    half_row_s = 0.5 * (float(np.median(np.diff(time_s))) if time_s.size > 1 else 1.0)
    rows_s = (float(time_s[0]) - half_row_s, float(time_s[-1]) + half_row_s)
    raw: Extent = (0.0, (node.scans.shape[1] - 1) / node.sample_rate_hz * 1e9, *rows_s)
    extent: Extent = (float(stack.delay_s[0]) * 1e9, float(stack.delay_s[-1]) * 1e9, *rows_s)
    images = stack.images
    truth_ns = _true_delays_ns(result, node)
    with style.look():
        figure, panels = style.new_panels(
            4, 2, 12.0, legend=False, right_in=0.85, share_x=False, share_y=True
        )
        draw_decibel(figure, panels[0, 0], np.abs(node.scans[:n_responses]), raw)
        draw_decibel(figure, panels[0, 1], np.abs(images["rotated"]), extent)
        draw_decibel(figure, panels[1, 0], np.abs(images["subtracted"]), extent)
        draw_share(figure, panels[1, 1], np.abs(images["enhanced"]), extent)
        draw_hits(panels[2, 0], stack.decisions, extent)
        _draw_traces(panels[2, 1], stack.delays, time_s)
        _draw_associated(panels[3, 0], result, node, time_s)
        frames_s = setting.elapsed_s(result, result.frame_time_us)
        people = enumerate(result.recording.truth)
        draw_truth(panels[3, 1], frames_s, [(person.id, truth_ns[:, index]) for index, person in people])
        if result.recording.truth:
            panels[3, 1].legend(loc="upper left", title="person", title_fontsize=8.0)
        titles = (
            "Raw responses, from any chip on",
            "Turned to time zero",
            "Background subtracted",
            "Weak echoes enhanced",
            "Detector",
            "Traces of targets, and their leading edges",
            "Associated delays" if result.why_no_positions is None else "Reported delays",
            "True delay of the echo",
        )
        shown_ns = min(extent[1], BEYOND_AREA * _farthest_ns(result, node))
        for letter, title, axes in zip("abcdefgh", titles, panels.flat, strict=True):
            axes.set_title(f"({letter}) {title}")
            axes.set_xlim(extent[0], raw[1] if letter == "a" else shown_ns)
            axes.set_ylim(extent[2], extent[3])
        for axes in panels[3]:
            axes.set_xlabel("delay [ns]")
        for axes in panels[:, 0]:
            axes.set_ylabel("time [s]")
    return figure


def _true_delays_ns(result: RunResult, node: NodeRecording) -> NDArray[np.float64]:
    """Return each person's delay through the wall (n_frames, n_people) [ns], NaN when she is not there."""
    from echofuse.evaluation.tracking import true_positions
    from echofuse.metrics import true_path_m, wall_of

    people = result.recording.truth
    positions, present = true_positions(people, setting.frame_time_s(result))
    if not people:
        return np.zeros((len(positions), 0))
    path_m = true_path_m(node, np.nan_to_num(positions), wall_of(result.site))
    return np.where(present, path_m / SPEED_OF_LIGHT_MPS * 1e9, np.nan)


def _farthest_ns(result: RunResult, node: NodeRecording) -> float:
    corners_m = setting.area_corners_m(result.site)
    return float(np.max(setting.echo_delay_s(node, corners_m))) * 1e9


def _draw_traces(
    axes: Axes, delays: dict[str, list[NDArray[np.float64]]], time_s: NDArray[np.float64]
) -> None:
    for tap, colour, label in (
        ("target_traces", TRACES, "trace"),
        ("leading_edges", style.HIT, "leading edge"),
    ):
        _dots(axes, [rows[:, 0] * 1e9 for rows in delays[tap]], time_s, colour, label)
    if axes.collections:
        axes.legend(loc="upper left", markerscale=3.0, handlelength=1.0, handletextpad=0.2)


def _draw_associated(axes: Axes, result: RunResult, node: NodeRecording, time_s: NDArray[np.float64]) -> None:
    reported = result.responses[node.name].delays["detections"]
    _dots(axes, [rows[:, 0] * 1e9 for rows in reported], time_s, TRACES, "reported")
    places = [place.id for place in result.site.nodes]
    if result.associated.size and node.node_id in places:
        own = result.associated[result.associated["node"] == places.index(node.node_id)]
        at_s = setting.elapsed_s(result, result.frame_time_us)[own["frame"]]
        at_ns = own["path_m"] / SPEED_OF_LIGHT_MPS * 1e9
        owner = np.maximum(own["owner"], -1)  # one colour for all couples of no track
        for which in np.unique(owner[owner != 0]):
            colour = style.track_colour(int(which)) if which > 0 else style.QUIET
            chosen = owner == which
            axes.scatter(at_ns[chosen], at_s[chosen], s=2.4, color=colour, linewidths=0, rasterized=True)
        axes.scatter([], [], s=2.4, color=style.track_colour(1), label="of a track")
        axes.scatter([], [], s=2.4, color=style.QUIET, label="paired")
    if axes.collections:
        axes.legend(loc="upper left", markerscale=3.0, handlelength=1.0, handletextpad=0.2)


def _dots(
    axes: Axes, at_ns: list[NDArray[np.float64]], time_s: NDArray[np.float64], colour: str, label: str
) -> None:
    counts = [len(row) for row in at_ns]
    if sum(counts) == 0:
        return
    axes.scatter(
        np.concatenate(at_ns),
        np.repeat(time_s[: len(counts)], counts),
        s=2.0,
        color=colour,
        linewidths=0,
        rasterized=True,
        label=label,
    )
