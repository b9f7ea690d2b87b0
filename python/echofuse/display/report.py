"""The report of a run: one HTML file that can be mailed alone, and its pictures beside it as PNG."""

from __future__ import annotations

import base64
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from echofuse.display import report_page
from echofuse.display.progress import progress

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from echofuse.result import RunResult

FIGURES_FOLDER = "figures"
SHOWN_WAYS = ("three_d_two_d", "tsm_from_three_d_two_d")  # of those that the run's tracker is compared with


@dataclass(frozen=True, kw_only=True)
class _Picture:
    """A picture that is still to be drawn."""

    file_name: str
    group: str  # of report_page.GROUPS
    heading: str
    caption: str
    draw: Callable[[], Figure]


def write_report(result: RunResult, folder: Path) -> Path:
    """Write `folder/report.html`, its pictures embedded and also in `folder/figures/`; return its path."""
    pictures = _pictures(result)
    figures = folder / FIGURES_FOLDER
    figures.mkdir(parents=True, exist_ok=True)
    images = [_drawn(picture, figures) for picture in progress(pictures, "drawing the report", len(pictures))]
    report = folder / "report.html"
    report.write_text(report_page.page(result, images), encoding="utf-8")
    return report


def _drawn(picture: _Picture, figures: Path) -> report_page.Image:
    from echofuse.display import style

    path = figures / picture.file_name
    style.save_png(picture.draw(), path)
    return report_page.Image(
        group=picture.group,
        heading=picture.heading,
        caption=picture.caption,
        png_base64=base64.b64encode(path.read_bytes()).decode("ascii"),
    )


def _pictures(result: RunResult) -> list[_Picture]:
    """Return the pictures that this run has the data for, in the order of the report."""
    from echofuse.display import captions
    from echofuse.display.error_figure import error_figure
    from echofuse.display.room_figure import room_figure

    whole_run = [
        _Picture(
            file_name="room.png",
            group="run",
            heading="The room",
            caption=captions.room(result),
            draw=partial(room_figure, result),
        ),
    ]
    if result.why_no_positions is None:
        whole_run.append(
            _Picture(
                file_name="error.png",
                group="run",
                heading="The error",
                caption=captions.error(result),
                draw=partial(error_figure, result),
            )
        )
        whole_run += _pictures_in_space(result)
    numbered = list(enumerate((node.name for node in result.recording.nodes), start=1))
    numbered.sort(key=lambda pair: -_heaviest_cluster(result, pair[1]))  # the clearest example comes first
    return whole_run + [
        picture for number, name in numbered for picture in _pictures_of_node(result, number, name)
    ]


def _pictures_in_space(result: RunResult) -> list[_Picture]:
    """Return those of the paper's two ways and of the run's tracker, none of a pipeline in the plane."""
    from echofuse.display import captions, setting
    from echofuse.display.space_figure import space_figure
    from echofuse.display.ways import WAYS

    if not setting.in_space(result):
        return []
    shown = [
        (way, WAYS[way], result.compared_points[way], result.compared_tracks[way])
        for way in SHOWN_WAYS
        if way in result.compared_tracks
    ]
    tracker = setting.tracker_name(result)
    return [
        _Picture(
            file_name=f"space-{number}-{way}.png",
            group="run",
            heading=f"{name} in space",
            caption=captions.space(result, way),
            draw=partial(space_figure, result, points, tracks, name=name),
        )
        for number, (way, name, points, tracks) in enumerate(
            [*shown, ("tracker", tracker, None, result.tracks)], start=1
        )
    ]


def _heaviest_cluster(result: RunResult, name: str) -> float:
    """Return the greatest weight that node `name` reports in the shown frame."""
    clusters = result.shown_taps.get(name, {}).get("range_clusters")
    if clusters is None or clusters.size == 0:
        return 0.0
    return float(clusters.reshape(-1, 4)[:, 1].max())


def _pictures_of_node(result: RunResult, number: int, name: str) -> list[_Picture]:
    from echofuse.display import captions
    from echofuse.display.response_figure import response_figure
    from echofuse.display.scan_figure import scan_figure
    from echofuse.display.stack_figure import stack_figure

    suffix = f"{number:02d}-{_file_part(name)}.png"
    if name in result.responses:
        return [
            _Picture(
                file_name=f"responses-{suffix}",
                group="responses",
                heading=name,
                caption=captions.responses(result, name),
                draw=partial(response_figure, result, name),
            )
        ]
    pictures = []
    if name in result.shown_taps:
        pictures.append(
            _Picture(
                file_name=f"scan-{suffix}",
                group="scan",
                heading=name,
                caption=captions.scan(result, name),
                draw=partial(scan_figure, result, name),
            )
        )
    if name in result.stacks and result.stacks[name].residual.size > 0:
        pictures.append(
            _Picture(
                file_name=f"stack-{suffix}",
                group="stack",
                heading=name,
                caption=captions.stack(result, name),
                draw=partial(stack_figure, result, name),
            )
        )
    return pictures


def _file_part(name: str) -> str:
    """Return a node's name as part of a file's name: letters, digits, hyphens and underscores only."""
    return "".join(
        letter if letter.isascii() and (letter.isalnum() or letter in "-_") else "_" for letter in name
    )
