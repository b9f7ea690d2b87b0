"""What a site can see before anything is installed: the maps of `echofuse plan` (Figs. 3 and 4)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.display import style
from echofuse.display.room_figure import draw_nodes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SNR_STEPS = 8  # about as many Cassini ovals
TOA_STEPS = 6  # about as many ellipses
MARGIN_SHARE = 0.12  # of the larger side, for the names of nodes
COLOUR_BAR_BOX = (1.02, 0.0, 0.03, 1.0)
BOUND_PERCENTILES = (1.0, 99.0)  # of the colour scale


def plan_figure(
    *,
    x_m: NDArray[np.float64],
    y_m: NDArray[np.float64],
    position_error_bound_m: NDArray[np.float64],
    n_covering_pairs: NDArray[np.int64],
    blind: NDArray[np.bool_],
    snr_db: NDArray[np.float64],
    tx_position_m: NDArray[np.float64],
    rx_position_m: NDArray[np.float64],
    names: Sequence[str],
    site_name: str = "",
    shown_pair: int = 0,
) -> Figure:
    """Draw the maps of a site.

    x_m (n_x,), y_m (n_y,): the grid.
    position_error_bound_m, n_covering_pairs: (n_y, n_x), the bound not finite where too few pairs cover.
    blind, snr_db: (n_pairs, n_y, n_x), a pair's blind zone and its SNR [dB].
    tx_position_m, rx_position_m: (n_pairs, 2) or (n_pairs, 3). names: of the pairs. shown_pair: whose Cassini
    ovals and iso-ToA ellipses are drawn.
    """
    names = list(names)
    tx_m = np.asarray(tx_position_m, dtype=np.float64)[:, :2]
    rx_m = np.asarray(rx_position_m, dtype=np.float64)[:, :2]
    everything = np.concatenate([tx_m, rx_m, [[x_m[0], y_m[0]], [x_m[-1], y_m[-1]]]])
    low, high = everything.min(axis=0), everything.max(axis=0)
    margin = MARGIN_SHARE * float(np.max(high - low))
    low, high = low - margin, high + margin
    with style.look():
        aspect = float((high[1] - low[1]) / (high[0] - low[0]))
        figure = style.new_figure(min(max(2.0 * 4.3 * aspect + 1.4, 5.0), 14.0))
        panels = figure.subplots(2, 2)
        _draw_bound(figure, panels[0, 0], x_m, y_m, position_error_bound_m)
        _draw_pairs(figure, panels[0, 1], x_m, y_m, n_covering_pairs, blind)
        _draw_one_pair(
            panels[1, 0],
            x_m,
            y_m,
            snr_db=snr_db[shown_pair],
            blind=_of_pair(blind, shown_pair),
            tx_m=tx_m[shown_pair],
            rx_m=rx_m[shown_pair],
            name=names[shown_pair],
        )
        _draw_share(panels[1, 1], position_error_bound_m)
        for axes in (panels[0, 0], panels[0, 1], panels[1, 0]):
            draw_nodes(axes, names=names, tx_m=tx_m, rx_m=rx_m)
            axes.set_xlim(low[0], high[0])
            axes.set_ylim(low[1], high[1])
            axes.set_aspect("equal")
            axes.grid(False)
            axes.set_xlabel("x [m]")
            axes.set_ylabel("y [m]")
        if site_name:
            figure.suptitle(site_name, fontsize=11.0, fontweight="bold", x=0.01, ha="left")
        style.legend_below(figure, panels[1, 0], columns=6)
    return figure


def _of_pair(blind: NDArray[np.bool_], pair: int) -> NDArray[np.bool_]:
    return blind if blind.ndim == 2 else np.asarray(blind[pair])


def _edges(centres: NDArray[np.float64]) -> tuple[float, float]:
    half = 0.5 * float(centres[1] - centres[0]) if centres.size > 1 else 0.5
    return float(centres[0]) - half, float(centres[-1]) + half


def _hatch(axes: Axes, x_m: NDArray[np.float64], y_m: NDArray[np.float64], mask: NDArray[np.bool_]) -> None:
    """Hatch where mask (n_y, n_x) holds."""
    if mask.any():
        drawn = axes.contourf(
            x_m, y_m, mask.astype(np.float64), levels=[0.5, 1.5], colors="none", hatches=["////"]
        )
        drawn.set_edgecolor(style.QUIET)
        drawn.set_linewidth(0.0)


def _draw_bound(
    figure: Figure,
    axes: Axes,
    x_m: NDArray[np.float64],
    y_m: NDArray[np.float64],
    bound_m: NDArray[np.float64],
) -> None:
    from matplotlib.colors import LogNorm
    from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

    axes.set_title("(a) Attainable position error (bound)")
    finite = bound_m[np.isfinite(bound_m) & (bound_m > 0.0)]
    low, high = np.percentile(finite, BOUND_PERCENTILES) if finite.size else np.array([0.01, 1.0])
    high = max(float(high), 1.5 * float(low))
    drawn = axes.imshow(
        np.where(np.isfinite(bound_m), bound_m, np.nan),
        origin="lower",
        extent=(*_edges(x_m), *_edges(y_m)),
        norm=LogNorm(low, high),
        cmap=style.AMPLITUDE_MAP + "_r",
        interpolation="nearest",
    )
    _hatch(axes, x_m, y_m, ~np.isfinite(bound_m))
    bar = figure.colorbar(drawn, cax=axes.inset_axes(COLOUR_BAR_BOX), extend="both")
    bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    bar.ax.yaxis.set_major_formatter(ScalarFormatter(useMathText=False))
    bar.ax.yaxis.set_minor_formatter(NullFormatter())
    bar.set_label("[m], logarithmic", fontsize=8.0)


def _draw_pairs(
    figure: Figure,
    axes: Axes,
    x_m: NDArray[np.float64],
    y_m: NDArray[np.float64],
    n_pairs: NDArray[np.int64],
    blind: NDArray[np.bool_],
) -> None:
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm

    axes.set_title("(b) Pairs that cover; blind zones outlined")
    most = max(int(n_pairs.max(initial=0)), 1)
    shades = colormaps["cividis"].resampled(most + 1)
    drawn = axes.imshow(
        n_pairs,
        origin="lower",
        extent=(*_edges(x_m), *_edges(y_m)),
        cmap=shades,
        norm=BoundaryNorm(np.arange(-0.5, most + 1.0), most + 1),
        interpolation="nearest",
    )
    for mask in blind if blind.ndim == 3 else blind[None]:
        if mask.any() and not mask.all():
            axes.contour(x_m, y_m, mask.astype(np.float64), levels=[0.5], colors="white", linewidths=0.7)
    bar = figure.colorbar(drawn, cax=axes.inset_axes(COLOUR_BAR_BOX))
    bar.set_ticks(np.unique(np.linspace(0, most, min(most, 8) + 1).round()).tolist())
    bar.ax.minorticks_off()
    bar.set_label("pairs", fontsize=8.0)


def _draw_one_pair(
    axes: Axes,
    x_m: NDArray[np.float64],
    y_m: NDArray[np.float64],
    *,
    snr_db: NDArray[np.float64],
    blind: NDArray[np.bool_],
    tx_m: NDArray[np.float64],
    rx_m: NDArray[np.float64],
    name: str,
) -> None:
    from matplotlib.ticker import MaxNLocator

    axes.set_title(f"(c) One pair, {name}: Cassini ovals and iso-ToA ellipses")
    place = np.stack(np.meshgrid(x_m, y_m), axis=-1)
    path_m = np.linalg.norm(place - tx_m, axis=-1) + np.linalg.norm(place - rx_m, axis=-1)
    toa_ns = path_m / SPEED_OF_LIGHT_MPS * 1e9
    edges_x, edges_y = _edges(x_m), _edges(y_m)
    axes.fill(
        np.array(edges_x)[[0, 1, 1, 0]],
        np.array(edges_y)[[0, 0, 1, 1]],
        facecolor="#f4f6f9",
        edgecolor="#b9c0ca",
        linewidth=1.0,
        zorder=0,
    )
    _hatch(axes, x_m, y_m, blind)
    finite = snr_db[np.isfinite(snr_db)]
    if finite.size:
        low, high = np.percentile(finite, [3.0, 98.0])
        levels = MaxNLocator(SNR_STEPS, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
        ovals = axes.contour(
            x_m, y_m, snr_db, levels=levels, colors=style.CURRENT, linewidths=1.0, linestyles="-"
        )
        axes.clabel(ovals, fmt="%g dB", fontsize=7.0)
    levels = MaxNLocator(TOA_STEPS, steps=[1, 2, 2.5, 5, 10]).tick_values(
        float(toa_ns.min()), float(toa_ns.max())
    )
    ellipses = axes.contour(
        x_m, y_m, toa_ns, levels=levels, colors=style.THRESHOLD, linewidths=0.9, linestyles="--"
    )
    axes.clabel(ellipses, fmt="%g ns", fontsize=7.0)
    axes.plot([tx_m[0], rx_m[0]], [tx_m[1], rx_m[1]], color=style.QUIET, linewidth=0.7, linestyle=":")
    axes.plot([], [], color=style.CURRENT, label="equal SNR (Cassini oval)")
    axes.plot([], [], color=style.THRESHOLD, linestyle="--", label="equal ToA (ellipse)")
    axes.fill(
        [],
        [],
        facecolor="none",
        edgecolor=style.QUIET,
        hatch="////",
        linewidth=0.0,
        label="hatched: blind zone; in (a) no fix",
    )


def _draw_share(axes: Axes, bound_m: NDArray[np.float64]) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

    axes.set_title("(d) Share of the area that reaches an error")
    finite = np.sort(bound_m[np.isfinite(bound_m) & (bound_m > 0.0)])
    axes.set_ylim(0.0, 1.02)
    axes.set_yticks(np.linspace(0.0, 1.0, 6), [f"{percent} %" for percent in range(0, 101, 20)])
    axes.set_xlabel("position error bound [m]")
    axes.set_ylabel("share of the area")
    if finite.size == 0:
        return
    axes.plot(finite, np.arange(1, finite.size + 1) / bound_m.size, color=style.CURRENT, linewidth=1.6)
    axes.set_xscale("log")
    axes.set_xlim(finite[0] / 1.1, np.percentile(finite, 99.5) * 1.1)
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(ScalarFormatter())
    axes.xaxis.set_minor_formatter(NullFormatter())
    for share in (0.5, 0.9):
        rank = int(np.ceil(share * bound_m.size)) - 1
        if rank < finite.size:
            axes.plot([finite[rank]], [share], "o", color=style.CURRENT, markersize=5)
            axes.annotate(
                f"{100.0 * share:.0f} %: {finite[rank]:.3g} m",
                (finite[rank], share),
                (8, -4),
                textcoords="offset points",
                fontsize=8.0,
                va="top",
            )
