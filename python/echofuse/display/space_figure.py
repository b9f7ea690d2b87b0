"""Positions and tracks in space, on the floor plan and over time (Figs. 5 to 12 of the Taylor-series paper).

Yellow is the paper's region of the true positions: its cuboid about the person, along the whole path.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from echofuse.display import setting, style
from echofuse.display.room_figure import draw_site
from echofuse.display.tracks import shown, stretches

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.gridspec import SubplotSpec

    from echofuse.result import RunResult

REGION, REGION_EDGE = "#fdf3c0", "#d8b21f"
WALL, WALL_EDGE = "#e4d5c9", "#a58c7a"
STRAIGHT_M = 0.02  # what a path may bend within one leg of its region
MARGIN_M = 0.25
VIEW = {"elev": 14.0, "azim": -24.0}  # from the right, so that paths up and down lie apart

Array = NDArray[np.float64]


def space_figure(
    result: RunResult, points: NDArray[np.void] | None, tracks: NDArray[np.void], *, name: str
) -> Figure:
    """Draw what one way located, POINT_DTYPE, and tracked, TRACK_DTYPE, in a run in space.

    points: None of a way that has none of its own; name: of the way, in titles.
    """
    parts = [("positions", points, None), ("track", None, tracks)][0 if points is not None else 1 :]
    with style.look():
        figure = style.new_figure(4.6 * len(parts) + 2.5)
        grid = figure.add_gridspec(
            len(parts) + 1, 2, height_ratios=[*[4.6] * len(parts), 2.0], width_ratios=(1.25, 1.0)
        )
        letters = iter("abcdefgh")
        for row, (what, dots, lines) in enumerate(parts):
            title = f"{name}: {what}"
            _draw_in_space(figure, grid[row, 0], result, dots, lines, f"({next(letters)}) {title} in space")
            plan = figure.add_subplot(grid[row, 1])
            _draw_plan(plan, result, dots, lines)
            plan.set_title(f"({next(letters)}) {title} from above")
        height = figure.add_subplot(grid[len(parts), :])
        _draw_height(height, result, points, tracks)
        height.set_title(f"({next(letters)}) Height over time")
        style.legend_below(figure, height, columns=6)
    return figure


def _draw_in_space(
    figure: Figure,
    place: SubplotSpec,
    result: RunResult,
    points: NDArray[np.void] | None,
    tracks: NDArray[np.void] | None,
    title: str,
) -> None:
    """Draw axes in space; all three at one scale, the wall and the antennas with them."""
    low, high = _extent(result)
    axes: Any = figure.add_subplot(place, projection="3d")
    for legs in _legs(result):
        _draw_region_in_space(axes, legs)
    _draw_wall_in_space(axes, result, low, high)
    for person in result.recording.truth:
        axes.plot(*person.position_m.T, color=style.INK, linewidth=1.0)
    ends = np.array([end for node in result.site.nodes for end in (node.tx_position_m, node.rx_position_m)])
    for at_m, marker in ((ends[1::2], style.RECEIVER_MARKER), (ends[:1], style.TRANSMITTER_MARKER)):
        axes.scatter(*at_m.T, marker=marker, s=16, color=style.INK, depthshade=False)
    if points is not None:
        axes.scatter(*_columns(points), s=6, color=style.CURRENT, alpha=0.75, linewidths=0, depthshade=False)
    for stretch in [] if tracks is None else stretches(shown(tracks)):
        at_m = np.array(_columns(stretch.rows))
        inside = np.all((low <= at_m.T) & (high >= at_m.T), axis=1)
        at_m[:, ~inside] = np.nan  # nothing clips there
        axes.plot(*at_m, color=style.track_colour(stretch.track_id), linewidth=1.8, **_line(stretch.state))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=1.25)
    axes.view_init(**VIEW)
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
    axes.xaxis.set_major_locator(_whole_metres())
    axes.set_title(title)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))


def _draw_plan(
    axes: Axes, result: RunResult, points: NDArray[np.void] | None, tracks: NDArray[np.void] | None
) -> None:
    """Draw the projection into the x-y plane."""
    from scipy.spatial import ConvexHull

    draw_site(axes, result)
    outlines = [leg[:, :2] for legs in _legs(result) for leg in legs]
    outlines = [corners[ConvexHull(corners).vertices] for corners in outlines]
    for zorder, edge in ((0.8, {"edgecolor": REGION_EDGE, "linewidth": 1.4}), (0.9, {"linewidth": 0.0})):
        for corners in outlines:  # twice, so that the legs together have one outline
            axes.fill(*corners.T, facecolor=REGION, zorder=zorder, **edge)
    for person in result.recording.truth:
        axes.plot(*person.position_m[:, :2].T, color=style.INK, linewidth=1.0, zorder=2)
    if points is not None:
        axes.scatter(points["x_m"], points["y_m"], zorder=2.5, **_dots())
    for stretch in [] if tracks is None else stretches(shown(tracks)):
        axes.plot(
            stretch.rows["x_m"],
            stretch.rows["y_m"],
            color=style.track_colour(stretch.track_id),
            linewidth=1.8,
            zorder=3,
            **_line(stretch.state),
        )
    low, high = _extent(result)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="x [m]", ylabel="y [m]")
    axes.set_aspect("equal")


def _draw_height(
    axes: Axes, result: RunResult, points: NDArray[np.void] | None, tracks: NDArray[np.void]
) -> None:
    from echofuse.simulation.stairs import BODY_SIZE_M, body_cuboid

    start_s = setting.frame_time_s(result)[:1]
    for person in result.recording.truth:
        time_s = person.time_s - start_s if start_s.size else person.time_s
        lower_m, upper_m = body_cuboid(person.position_m, person.height_m or BODY_SIZE_M[2])
        axes.fill_between(
            time_s,
            lower_m[:, 2],
            upper_m[:, 2],
            facecolor=REGION,
            edgecolor=REGION_EDGE,
            label="region of the true positions",
            zorder=1,
        )
        axes.plot(
            time_s, person.position_m[:, 2], color=style.INK, linewidth=1.0, label="true path", zorder=2
        )
    if points is not None and points.size:
        at_s = setting.elapsed_s(result, points["time_us"])
        axes.scatter(at_s, points["z_m"], label="positions", zorder=2.5, **_dots())
    for stretch in stretches(shown(tracks)):
        axes.plot(
            setting.elapsed_s(result, stretch.rows["time_us"]),
            stretch.rows["z_m"],
            color=style.track_colour(stretch.track_id),
            linewidth=1.8,
            label=f"track {stretch.track_id}" if stretch.state == 1 else None,
            zorder=3,
            **_line(stretch.state),
        )
    low, high = _extent(result)
    axes.set(ylim=(low[2], high[2]), xlabel="time [s]", ylabel="z [m]")


def _legs(result: RunResult) -> list[list[Array]]:
    """Return each person's region as corners (16, 3) [m] of the cuboid at both ends of each straight leg."""
    from echofuse.simulation.stairs import BODY_SIZE_M, body_cuboid

    found = []
    for person in result.recording.truth:
        if not person.time_s.size:
            continue
        turns = _turns(person.position_m)
        lower_m, upper_m = body_cuboid(person.position_m[turns], person.height_m or BODY_SIZE_M[2])
        corners = np.stack(np.meshgrid(*[[0.0, 1.0]] * 3, indexing="ij"), axis=-1).reshape(8, 3)
        cuboids = lower_m[:, np.newaxis] + corners * (upper_m - lower_m)[:, np.newaxis]
        pairs = zip(cuboids, cuboids[1:] if len(turns) > 1 else cuboids, strict=False)
        found.append([np.concatenate(pair) for pair in pairs])
    return found


def _turns(path_m: Array) -> list[int]:
    """Return where a path (n, 3) bends, its ends included (Ramer-Douglas-Peucker)."""
    kept, open_legs = {0, len(path_m) - 1}, [(0, len(path_m) - 1)]
    while open_legs:
        first, last = open_legs.pop()
        leg = path_m[first : last + 1] - path_m[first]
        length2 = float(leg[-1] @ leg[-1])
        along = np.clip(leg @ leg[-1] / length2, 0.0, 1.0) if length2 > 0.0 else np.zeros(len(leg))
        off_m = np.linalg.norm(leg - along[:, np.newaxis] * leg[-1], axis=1)
        farthest = int(np.argmax(off_m))
        if off_m[farthest] > STRAIGHT_M:
            kept.add(first + farthest)
            open_legs += [(first, first + farthest), (first + farthest, last)]
    return sorted(kept)


def _draw_region_in_space(axes: Any, legs: list[Array]) -> None:
    """Draw the hull of each leg's two cuboids, with the edges at which two of its faces meet."""
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
    from scipy.spatial import ConvexHull

    for corners in legs:
        hull = ConvexHull(corners)
        edges = [
            corners[list(set(one) & set(hull.simplices[other]))]
            for index, one in enumerate(hull.simplices)
            for other in hull.neighbors[index]
            if other > index and not np.allclose(hull.equations[index], hull.equations[other], atol=1e-6)
        ]
        faces = corners[hull.simplices]
        axes.add_collection3d(Poly3DCollection(faces, facecolor="#f3cf3f", alpha=0.1, linewidths=0))
        axes.add_collection3d(Line3DCollection(edges, colors=REGION_EDGE, linewidths=0.6, alpha=0.8))


def _draw_wall_in_space(axes: Any, result: RunResult, low: Array, high: Array) -> None:
    """Draw the wall's back, where the area begins."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    y = result.site.bounds_m[1]
    (left, _, bottom), (right, _, top) = low, high
    sheet = [(left, y, bottom), (right, y, bottom), (right, y, top), (left, y, top)]
    axes.add_collection3d(
        Poly3DCollection([sheet], facecolor=WALL, edgecolor=WALL_EDGE, alpha=0.25, linewidths=0.7)
    )


def _columns(rows: NDArray[np.void]) -> tuple[Array, Array, Array]:
    return tuple(rows[name].astype(np.float64) for name in ("x_m", "y_m", "z_m"))  # type: ignore[return-value]


def _dots() -> dict[str, Any]:
    return {"s": 7, "color": style.CURRENT, "alpha": 0.75, "linewidths": 0, "rasterized": True}


def _line(state: int) -> dict[str, Any]:
    return {"linestyle": style.TRACK_STATE_LINE[state]}


def _whole_metres() -> Any:
    from matplotlib.ticker import MultipleLocator

    return MultipleLocator(1.0)


def _extent(result: RunResult) -> tuple[Array, Array]:
    """Return the corners of what is shown: the box and the antennas."""
    x_min, y_min, z_min, x_max, y_max, z_max = result.site.box_m
    ends = [end for node in result.site.nodes for end in (node.tx_position_m, node.rx_position_m)]
    parts = np.array([(x_min, y_min, z_min), (x_max, y_max, z_max), *ends])
    return parts.min(axis=0) - MARGIN_M, parts.max(axis=0) + MARGIN_M
