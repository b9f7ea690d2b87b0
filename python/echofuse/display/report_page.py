"""The HTML of the report: no scripts, nothing from elsewhere, fit for print."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from echofuse.display import setting
from echofuse.display.health import health_lines
from echofuse.display.report_style import STYLE_SHEET
from echofuse.display.ways import WAY_COLUMNS, bound_line, is_of_a_way, way_rows, way_values

if TYPE_CHECKING:
    from echofuse.result import RunResult

NODE_GROUPS = {
    "scan": "One scan through the stages of a node",
    "stack": "All scans of a node",
    "responses": "All responses of a receiver, stage by stage",
}

#: Order, wording and the paper's figures of the metrics; others are printed after these, by their names.
METRICS: dict[str, tuple[str, str]] = {
    "rmse_m": ("Root mean square error", "0.36 m"),
    "p50_m": ("Error that half of the walk keeps", ""),
    "p80_m": ("Error that 80 % of the walk keep", "0.40 m"),
    "bound_ratio": ("Error over the position error bound", ""),
    "tracked_fraction": ("Person has a track, confirmed or silent", ""),
    "confirmed_fraction": ("Frames of the walk with a confirmed track", ""),
    "one_track_fraction": ("Person keeps one and the same confirmed track", ""),
    "count_right_fraction": ("Frames with the right number of tracks", ""),
    "confirmed_count_right_fraction": ("Frames with the right number of confirmed tracks", ""),
    "false_track_fraction": ("Frames with a false confirmed track", ""),
    "worst_tracked_fraction": ("The same, of the person who fares worst", ""),
    "mean_tracked_fraction": ("The same, mean over the people", ""),
    "crossing_tracked_fraction": ("The same while crossing or symmetric, worst person", ""),
    "crossing_fraction": ("Share of the time that people cross or stand symmetric", ""),
    "false_tracks_per_100_s": ("False confirmed tracks in 100 s", ""),
    "confirmed_tracks": ("Tracks that were ever confirmed", ""),
    "ghosts_per_response": ("Ghosts a response among what no track took", ""),
    "paired_ghosts_per_response": ("Ghosts a response after pairing alone", ""),
    "all_pairs_ghosts_per_response": ("Ghosts a response of all pairs of traces", ""),
    "across_p50_m": ("Distance across the marked path, median", ""),
    "across_p90_m": ("Distance across the marked path, 90 % keep", ""),
    "second_track_fraction": ("Frames of the walk with a second confirmed track", ""),
    "standing_confirmed_fraction": ("Frames after the walk with a confirmed track", ""),
    "standing_silent_fraction": ("Frames after the walk with a silent track only", ""),
    "standing_quiet_fraction": ("Frames after the walk without a confirmed track", ""),
    "standing_wander_m": ("Farthest that a track went after the walk", ""),
    "cuboid_fraction": ("Track within the paper's cuboid about the person", ""),
    "position_error_bound_m": ("Position error bound of one response, root mean square", ""),
    "ospa_m": ("OSPA distance", ""),
    "gospa_m": ("GOSPA distance", ""),
    "path_error_std_m": ("Deviation of the nodes' measured paths", ""),
    "frames_evaluated": ("Frames evaluated", ""),
}
NOTE = (
    "The baseline is a Kalman filter with global nearest neighbour on the same points. The paper's figures "
    "are those of its best setting, one person in its own room of 11.5 m × 6 m."
)
NOTE_BEHIND_WALL = (
    "The way beside it is the paper's on the same reports: traces paired, each couple located, and a "
    "Kalman filter with nearest neighbour on these points. A ghost is a located point farther than 1 m from "
    "everybody. Two people cross, or stand symmetric, while their mean paths differ by less than 1 m. "
    "Evaluated from 2 s after the first response."
)
NOTE_IN_SPACE = (
    "The way beside it is the paper's on the same reports: traces paired on each axis, located by the "
    "Taylor-series method (TSM) from 3D-2D, and a Kalman filter with nearest neighbour. Errors are distances "
    "in space. A ghost is a located point farther than 1 m from everybody. Evaluated from 2 s after the "
    "first response."
)
NOTE_WAYS = (
    "All on the same reports. Positions: the nearest one to the person in each response, at most 1 m away; "
    "located is the share of responses that have one. In cuboid: of all responses, within the paper's region "
    "of 1 m x 1 m x 1.8 m about the person."
)
#: Counters that say how much was done rather than that something went wrong.
WORK_DONE = frozenset(
    {"scans", "learning_scans", "responses", "settling_responses", "accepted", "frames", "tuples"}
)


@dataclass(frozen=True, kw_only=True)
class Image:
    """A picture ready for the page."""

    group: str  # "run", or a key of NODE_GROUPS
    heading: str
    caption: str
    png_base64: str


def page(result: RunResult, images: Sequence[Image]) -> str:
    """Return the whole page."""
    title = f"{result.site.name}: {result.recording.pipeline}"
    body = [
        "<header><p class='kind'>echofuse run report</p>"
        f"<h1>{escape(result.site.name)}</h1>{_head(result)}</header>",
        f"<section><h2>Results</h2>{_metrics(result)}</section>",
        *_image_sections(images),
        f"<section><h2>Health</h2>{_counters(result)}</section>",
    ]
    return (
        "<!DOCTYPE html>\n<html lang='en'>\n<head>\n<meta charset='utf-8'>\n"
        "<meta name='viewport' content='width=device-width, initial-scale=1'>\n"
        f"<title>{escape(title)}</title>\n<style>{STYLE_SHEET}</style>\n</head>\n<body>\n<main>\n"
        + "\n".join(body)
        + "\n</main>\n</body>\n</html>\n"
    )


def _head(result: RunResult) -> str:
    nodes = result.recording.nodes
    within_m = setting.monostatic_within_m(result)
    monostatic = sum(setting.is_monostatic(node, within_m) for node in nodes)
    counts = ((len(nodes) - monostatic, "bistatic"), (monostatic, "monostatic"))
    kinds = ", ".join(f"{count} {kind}" for count, kind in counts if count) or "none"
    time_s = setting.elapsed_s(result, result.frame_time_us)
    duration = f"{time_s[-1]:.1f} s" if time_s.size else "0 s"
    if time_s.size > 1:
        duration += f", a frame every {1e3 * float(np.median(np.diff(time_s))):.0f} ms"
    n_people = len(setting.people(result))
    entries = {
        "Pipeline": result.recording.pipeline,
        "Nodes": f"{kinds}: " + ", ".join(node.name for node in nodes),
        "Frames": str(time_s.size),
        "Duration": duration,
        "People": f"{n_people}, their true positions known" if n_people else "true positions not recorded",
        "Recorded": result.recording.created or "not said",
    }
    items = "".join(f"<dt>{escape(key)}</dt><dd>{escape(value)}</dd>" for key, value in entries.items())
    return f"<dl>{items}</dl>"


def _metrics(result: RunResult) -> str:
    why = result.why_no_positions
    said = "" if why is None else f"<p>No positions: {escape(why)}.</p>"
    behind_wall = setting.behind_wall(result)
    both = (result.metrics, result.baseline_metrics)
    given = [key for key in dict.fromkeys(key for table in both for key in table) if not is_of_a_way(key)]
    keys = [key for key in METRICS if key in given] + [key for key in given if key not in METRICS]
    if not keys:
        nothing = "<p>No truth was recorded, so there is nothing to compare the tracks with.</p>"
        return said or nothing
    rows = []
    for key in keys:
        words, paper = METRICS.get(key, ("", ""))
        cells = [_value(key, table.get(key)) for table in both]
        if not behind_wall:
            cells.append(paper or "–")
        rows.append(
            _row(f"{escape(words)} <code>{escape(key)}</code>", [f"<td>{cell}</td>" for cell in cells])
        )
    head = ["Metric", setting.tracker_name(result), setting.baseline_name(result)]
    note = NOTE_BEHIND_WALL if behind_wall else NOTE
    if setting.in_space(result):
        note = NOTE_IN_SPACE
    table = _table("metrics", head if behind_wall else [*head, "Paper"], rows)
    return f"{said}{table}<p class='note'>{note}</p>{_ways(result)}"


def _ways(result: RunResult) -> str:
    """Return the table of ways to positions in space, nothing where there are none."""
    rows = [
        _row(escape(name), [f"<td>{escape(value)}</td>" for value in way_values(values)])
        for name, values in way_rows(result.metrics, setting.tracker_name(result))
    ]
    if not rows:
        return ""
    half = len(WAY_COLUMNS) // 2
    head = [f"{'positions' if at < half else 'tracks'}: {column}" for at, column in enumerate(WAY_COLUMNS)]
    return (
        f"<h3>Before and after tracking</h3>{_table('ways', ['Way', *head], rows)}"
        f"<p class='note'>{NOTE_WAYS} {escape(bound_line(result.metrics))}.</p>"
    )


def _table(kind: str, head: Sequence[str], rows: Sequence[str]) -> str:
    """Return a table; `head` is plain text, `rows` is HTML."""
    cells = "".join(f"<th scope='col'>{escape(text)}</th>" for text in head)
    return f"<table class='{kind}'><thead><tr>{cells}</tr></thead><tbody>{''.join(rows)}</tbody></table>"


def _row(head: str, cells: Sequence[str]) -> str:
    """Return a row; both arguments are HTML."""
    return f"<tr><th scope='row'>{head}</th>{''.join(cells)}</tr>"


def _value(key: str, value: float | None) -> str:
    """Return a metric with its unit, which its name ends in."""
    if value is None or math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞"  # such as the error that 80 % keep when less than 80 % were tracked
    if key.endswith("_fraction"):
        return f"{100.0 * value:.1f} %"
    for suffix, unit in (
        ("_per_100_s", ""),
        ("_mps", " m/s"),
        ("_ms", " ms"),
        ("_ns", " ns"),
        ("_hz", " Hz"),
        ("_m", " m"),
        ("_s", " s"),
    ):
        if key.endswith(suffix):
            return f"{value:.3f}{unit}"
    return f"{value:.0f}" if float(value).is_integer() else f"{value:.3g}"


def _image_sections(images: Sequence[Image]) -> list[str]:
    sections = []
    for image in images:
        if image.group == "run":
            sections.append(f"<section><h2>{escape(image.heading)}</h2>{_figure(image)}</section>")
    for group, title in NODE_GROUPS.items():
        of_nodes = [image for image in images if image.group == group]
        if of_nodes:
            sections.append(f"<section><h2>{escape(title)}</h2>{_node_figures(of_nodes)}</section>")
    return sections


def _node_figures(images: Sequence[Image]) -> str:
    """Return the first node's picture, and the others' folded away."""
    first, *others = [f"<h3>{escape(image.heading)}</h3>{_figure(image)}" for image in images]
    if not others:
        return first
    names = escape(", ".join(image.heading for image in images[1:]))
    return f"{first}<details><summary>The other nodes: {names}</summary>{''.join(others)}</details>"


def _figure(image: Image) -> str:
    return (
        f"<figure><img src='data:image/png;base64,{image.png_base64}' alt='{escape(image.heading)}'>"
        f"<figcaption>{escape(image.caption)}</figcaption></figure>"
    )


def _counters(result: RunResult) -> str:
    nodes = {name: counts for name, counts in result.counters.items() if name != "hub"}
    hub = result.counters.get("hub", {})
    if not nodes and not hub:
        return "<p>No counters were kept.</p>"
    parts = [
        "<p class='note'>Counters of work done are plain; what was rejected, lost or cut is marked when it "
        "is not zero.</p>"
    ]
    said = "".join(f"<li>{escape(line)}</li>" for line in health_lines(result))
    if said:
        parts.append(f"<ul>{said}</ul>")
    if nodes:
        names = list(dict.fromkeys(counter for counts in nodes.values() for counter in counts))
        rows = [
            _row(escape(node), [_count(name, counts.get(name)) for name in names])
            for node, counts in nodes.items()
        ]
        parts.append("<h3>Nodes</h3>" + _table("counters", ["Node", *map(_words, names)], rows))
    if hub:
        rows = [_row(escape(_words(name)), [_count(name, count)]) for name, count in hub.items()]
        parts.append("<h3>Hub</h3>" + _table("counters", ["Counter", "Count"], rows))
    return "".join(parts)


def _count(name: str, count: int | None) -> str:
    if count is None:
        return "<td>–</td>"
    mark = " class='marked'" if count and name not in WORK_DONE else (" class='zero'" if not count else "")
    return f"<td{mark}>{count}</td>"


def _words(name: str) -> str:
    return name.replace("_", " ")
