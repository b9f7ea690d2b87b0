"""The room from above: nodes, true paths, points and tracks (Fig. 7 of the paper)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from echofuse.display import setting, style
from echofuse.display.tracks import shown, stretches

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from echofuse.result import RunResult

MARGIN_M = 0.7  # around everything, for the names of nodes
NAMED_TRACKS = 5  # in the legend; more are lumped together
MAX_HEIGHT_IN = 8.0


def room_figure(result: RunResult) -> Figure:
    """Draw the site from above with everything that was tracked in it; both axes in metres at one scale."""
    low, high = _extent(result)
    with style.look():
        height = (style.WIDTH_IN - 0.9) * float((high[1] - low[1]) / (high[0] - low[0])) + 1.15
        figure = style.new_figure(min(max(height, 4.0), MAX_HEIGHT_IN))
        axes = figure.subplots()
        draw_site(axes, result)
        _draw_truth(axes, result)
        _draw_points(axes, result)
        _draw_tracks(axes, result)
        _draw_baseline(axes, result)
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_aspect("equal")
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
        style.legend_below(figure, axes, columns=5)
    return figure


def draw_site(axes: Axes, result: RunResult) -> None:
    """Draw area and nodes."""
    area = setting.area_outline_m(result.site)
    axes.fill(
        area[:, 0],
        area[:, 1],
        facecolor="#f4f6f9",
        edgecolor="#b9c0ca",
        linewidth=1.0,
        label="watched area",
        zorder=0,
    )
    _draw_wall(axes, result, area)
    draw_nodes(
        axes,
        names=[node.name for node in result.recording.nodes],
        tx_m=np.array([node.tx_position_m[:2] for node in result.recording.nodes], dtype=np.float64).reshape(
            -1, 2
        ),
        rx_m=np.array([node.rx_position_m[:2] for node in result.recording.nodes], dtype=np.float64).reshape(
            -1, 2
        ),
        monostatic_within_m=setting.monostatic_within_m(result),
    )


def _draw_wall(axes: Axes, result: RunResult, area: NDArray[np.float64]) -> None:
    """Draw the wall as a band that ends where the area begins; where it stands, the site does not say."""
    wall = result.site.wall
    if wall is None or not setting.behind_wall(result):
        return
    (x_min, y_min), (x_max, _) = area.min(axis=0), area.max(axis=0)
    axes.fill(
        [x_min, x_max, x_max, x_min],
        [y_min - wall.thickness_m, y_min - wall.thickness_m, y_min, y_min],
        facecolor="#e4d5c9",
        edgecolor="#a58c7a",
        hatch="///",
        linewidth=0.7,
        label=f"wall, {100.0 * wall.thickness_m:.0f} cm",
        zorder=0.5,
    )


def draw_nodes(
    axes: Axes,
    *,
    names: list[str],
    tx_m: NDArray[np.float64],
    rx_m: NDArray[np.float64],
    monostatic_within_m: float = setting.MONOSTATIC_WITHIN_M,
) -> None:
    """Draw receivers (n, 2) with their names, and transmitters (n, 2), each place once."""
    if not names:
        return
    own = np.linalg.norm(tx_m - rx_m, axis=1) < monostatic_within_m
    middle = np.concatenate([tx_m, rx_m]).mean(axis=0)
    symbol: dict[str, Any] = {"linestyle": "none", "markersize": 7, "color": style.INK, "zorder": 5}
    kinds = ((own, style.MONOSTATIC_MARKER, "node (Tx and Rx)"), (~own, style.RECEIVER_MARKER, "Rx"))
    for chosen, marker, label in kinds:
        if chosen.any():
            axes.plot(*rx_m[chosen].T, marker=marker, label=label, **symbol)
    transmitters = np.unique(tx_m[~own].round(3), axis=0)
    if transmitters.size:
        axes.plot(
            *transmitters.T,
            marker=style.TRANSMITTER_MARKER,
            label="Tx",
            linestyle="none",
            markersize=9,
            markerfacecolor="white",
            markeredgecolor=style.INK,
            markeredgewidth=1.4,
            zorder=5,
        )
    named: dict[tuple[float, ...], list[str]] = {}  # by place: one above the other share a line
    for name, position in zip(names, rx_m.round(3), strict=True):
        named.setdefault(tuple(position), []).append(name)
    for index, position in enumerate(transmitters, start=1):
        named.setdefault(tuple(position), []).append("Tx" if len(transmitters) == 1 else f"Tx {index}")
    for place, here in named.items():
        _name_outwards(axes, ", ".join(here), np.array(place), middle)


def _name_outwards(axes: Axes, name: str, position: NDArray[np.float64], middle: NDArray[np.float64]) -> None:
    """Write a name beside its symbol, on the side away from the middle of the network."""
    away = position - middle
    sideways = abs(away[0]) > 1.6 * abs(away[1])
    step = (11.0 * float(np.sign(away[0])), 0.0) if sideways else (0.0, 11.0 * float(np.sign(away[1]) or 1.0))
    axes.annotate(
        name,
        (float(position[0]), float(position[1])),
        step,
        textcoords="offset points",
        fontsize=8.5,
        ha=("left" if step[0] > 0 else "right") if sideways else "center",
        va="center" if sideways else ("bottom" if step[1] > 0 else "top"),
        zorder=6,
        annotation_clip=True,
    )


def _draw_truth(axes: Axes, result: RunResult) -> None:
    persons = setting.people(result)
    paths = [person.position_m for person in persons]
    label = "true path"
    if not paths:
        site_path = setting.truth_path_m(result.site)
        paths = [] if site_path is None else [site_path]
        label = "marked path"
    for index, path in enumerate(paths):
        axes.plot(
            path[:, 0],
            path[:, 1],
            color="#c3c7ce",
            linewidth=6.0,
            solid_capstyle="round",
            zorder=1,
            label=label if index == 0 else None,
        )
        axes.plot(
            path[0, 0], path[0, 1], "o", color="white", markeredgecolor=style.INK, markersize=5.5, zorder=4
        )
        if len(paths) > 1:
            axes.annotate(
                persons[index].name,
                (path[0, 0], path[0, 1]),
                (6, 6),
                textcoords="offset points",
                fontsize=8.0,
                color=style.QUIET,
                zorder=6,
            )
    if paths:
        axes.plot(
            [], [], "o", color="white", markeredgecolor=style.INK, markersize=5.5, label="start of the path"
        )


def _draw_points(axes: Axes, result: RunResult) -> None:
    if result.points.size:
        axes.scatter(
            result.points["x_m"],
            result.points["y_m"],
            s=9,
            color=style.POINT,
            alpha=0.6,
            linewidths=0,
            label="points that no track took"
            if setting.behind_wall(result)
            else "points given to the tracker",
            zorder=1.5,
            rasterized=True,
        )


def _draw_tracks(axes: Axes, result: RunResult) -> None:
    told = shown(result.tracks)
    ids, lengths = np.unique(told["id"], return_counts=True)
    named = set(ids[np.argsort(-lengths)][:NAMED_TRACKS].tolist())
    for stretch in stretches(told):
        label = f"track {stretch.track_id}" if stretch.track_id in named else "other tracks"
        axes.plot(
            stretch.rows["x_m"],
            stretch.rows["y_m"],
            color=style.track_colour(stretch.track_id),
            linewidth=1.9,
            linestyle=style.TRACK_STATE_LINE[stretch.state],
            label=label if stretch.state == 1 else None,
            zorder=3,
        )
    if (told["state"] == 2).any():
        axes.plot([], [], color=style.QUIET, linewidth=1.9, linestyle="--", label="track is silent")


def _draw_baseline(axes: Axes, result: RunResult) -> None:
    for stretch in stretches(shown(result.baseline_tracks)):
        axes.plot(
            stretch.rows["x_m"],
            stretch.rows["y_m"],
            color=style.BASELINE,
            linewidth=0.8,
            linestyle=style.TRACK_STATE_LINE[stretch.state],
            zorder=2.5,
            label=setting.baseline_name(result) if stretch.state == 1 else None,
        )


def _extent(result: RunResult) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the corners of what is shown: site, nodes and true paths, not the tracks that ran away."""
    parts = [np.asarray(node.rx_position_m, dtype=np.float64)[None, :2] for node in result.recording.nodes]
    parts += [np.asarray(node.tx_position_m, dtype=np.float64)[None, :2] for node in result.recording.nodes]
    parts += [person.position_m for person in setting.people(result)]
    parts.append(setting.area_outline_m(result.site))
    path = setting.truth_path_m(result.site)
    if path is not None:
        parts.append(path)
    everything = np.concatenate(parts)
    return np.nanmin(everything, axis=0) - MARGIN_M, np.nanmax(everything, axis=0) + MARGIN_M
