"""One scan of one node through all its stages (Fig. 5 of the paper)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from echofuse.display import setting, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from echofuse.result import RunResult

INSET_HALF_WIDTH_NS = 4.0
INSET_BOX = (0.60, 0.62, 0.39, 0.33)  # upper right: late echoes are weak, so nothing lies beneath


def scan_figure(result: RunResult, name: str) -> Figure:
    """Draw the shown frame's scan of node `name`, stage by stage; delays in ns."""
    from matplotlib.ticker import MaxNLocator

    taps = result.shown_taps[name]
    view = _View(result, name)
    with style.look():
        figure, panels = style.new_panels(3, 2, 7.4, legend=True)
        _draw_empty_room(panels[0, 0], view)
        _draw_scan(panels[0, 1], view, taps)
        _draw_envelopes(panels[1, 0], view, taps)
        _draw_residual(panels[1, 1], view, taps)
        _draw_decisions(panels[2, 0], view, taps)
        _draw_clusters(panels[2, 1], view, taps)
        for axes in panels.flat:
            axes.yaxis.set_label_coords(-0.115, 0.5)
            view.mark_truth(axes)
            axes.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10], integer=axes is panels[2, 1]))
        panels[2, 0].set_yticks([0, 1])
        for axes in panels[2]:
            axes.set_xlabel("delay [ns]")
        panels[0, 0].set_xlim(view.delay_ns[0], view.delay_ns[-1])
        _shared_legend(figure, view)
    return figure


class _View:
    """The delay axis of one node's scan, its empty room, and where the true echoes lie on it."""

    def __init__(self, result: RunResult, name: str) -> None:
        node = setting.node_by_name(result, name)
        taps = result.shown_taps[name]
        lengths = [taps[tap].size for tap in ("scan", "envelope", "residual") if tap in taps]
        n_samples = lengths[0] if lengths else int(node.scans.shape[1])
        self.delay_ns: NDArray[np.float64] = setting.sample_delay_s(result, name, n_samples) * 1e9
        self.empty_room: NDArray[np.float64] | None = None  # (n_reference, n_samples)
        if (
            node.reference is not None
            and node.reference.shape[0] > 0
            and node.reference.shape[1] == n_samples
        ):
            self.empty_room = np.asarray(node.reference, dtype=np.float64)
        self.true_ns: list[float] = []
        if result.frame_time_us.size:
            now_s = setting.frame_time_s(result)[[result.shown_frame]]
            delays = [
                setting.echo_delay_s(node, person.at(now_s))[0] * 1e9 for person in setting.people(result)
            ]
            self.true_ns = [float(delay) for delay in delays if np.isfinite(delay)]

    def sample_to_ns(self, position_samples: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return delays [ns] of sub-sample positions [sample]."""
        return np.asarray(np.interp(position_samples, np.arange(self.delay_ns.size), self.delay_ns))

    def mark_truth(self, axes: Axes) -> None:
        """Mark the true echoes' delays."""
        for delay_ns in self.true_ns:
            axes.axvline(delay_ns, color=style.TRUTH, linewidth=0.9, linestyle=(0, (4, 2)), zorder=1)


def _draw_empty_room(axes: Axes, view: _View) -> None:
    axes.set_title("(a) Empty room: scan")
    axes.set_ylabel("amplitude [count]")
    if view.empty_room is None:
        _say(axes, "none recorded:\nthe node learns its background")
        return
    axes.plot(view.delay_ns, view.empty_room[0], color=style.EMPTY_ROOM, linewidth=0.6)


def _draw_scan(axes: Axes, view: _View, taps: dict[str, NDArray[Any]]) -> None:
    axes.set_title("(b) Empty room and current scan")
    axes.set_ylabel("amplitude [count]")
    scan = _tap(taps, "scan")
    if scan is None:
        _say(axes, "no scan in this frame")
        return

    empty = None if view.empty_room is None else view.empty_room[0]
    if empty is not None:
        axes.plot(view.delay_ns, empty, color=style.EMPTY_ROOM, linewidth=0.9)
    axes.plot(view.delay_ns, scan, color=style.CURRENT, linewidth=0.5)
    _inset(axes, view, scan, empty)


def _draw_envelopes(axes: Axes, view: _View, taps: dict[str, NDArray[Any]]) -> None:
    axes.set_title("(c) Envelopes")
    axes.set_ylabel("amplitude [count]")
    current = _tap(taps, "envelope")
    if current is None:
        _say(axes, "no envelope: clutter is removed\nbefore the envelope is taken")
        return
    empty = (
        None if view.empty_room is None else np.mean([_envelope(scan) for scan in view.empty_room], axis=0)
    )

    if empty is not None:
        axes.plot(view.delay_ns, empty, color=style.EMPTY_ROOM, linewidth=1.6)
    axes.plot(view.delay_ns, current, color=style.CURRENT, linewidth=0.8)
    axes.set_ylim(bottom=0.0)
    direct_path = _tap(taps, "direct_path")
    if direct_path is not None and direct_path.size >= 2 and direct_path[0] > 0.0:
        at_ns = view.sample_to_ns(direct_path[1:2])[0]
        height = float(np.interp(at_ns, view.delay_ns, current))
        axes.plot(
            [at_ns], [height], marker="^", markersize=5, color=style.THRESHOLD, linestyle="none", zorder=4
        )
    alignment = _tap(taps, "alignment")
    if alignment is not None and alignment.size >= 2:
        axes.text(
            0.99,
            0.36,
            f"aligned by {alignment[0]:.2f} samples\ncorrelation {alignment[1]:.3f}",
            fontsize=7.5,
            transform=axes.transAxes,
            ha="right",
            va="center",
            color=style.QUIET,
        )
    _inset(axes, view, current, empty)


def _draw_residual(axes: Axes, view: _View, taps: dict[str, NDArray[Any]]) -> None:
    axes.set_title("(d) After clutter removal, with the detector's threshold")
    axes.set_ylabel("amplitude [count]")
    residual, threshold = _tap(taps, "residual"), _tap(taps, "threshold")
    if residual is None:
        _say(axes, "no residual in this frame:\nthe background is being learnt")
        return
    axes.plot(view.delay_ns, residual, color=style.CURRENT, linewidth=0.8)
    if threshold is not None:
        level = np.sqrt(np.maximum(threshold, 0.0))
        axes.plot(view.delay_ns, level, color=style.THRESHOLD, linewidth=0.9)
        finite = level[np.isfinite(level)]
        usual = float(np.percentile(finite, 95.0)) if finite.size else 0.0
        axes.set_ylim(0.0, 1.08 * max(float(residual.max()), min(usual, 3.0 * float(residual.max())), 1e-9))
    else:
        axes.set_ylim(bottom=0.0)


def _draw_decisions(axes: Axes, view: _View, taps: dict[str, NDArray[Any]]) -> None:
    axes.set_title("(e) Decisions")
    axes.set_ylabel("hit")
    decisions = _tap(taps, "decisions")
    axes.set_ylim(-0.05, 1.25)
    if decisions is None:
        _say(axes, "no decisions in this frame")
        return
    axes.fill_between(
        view.delay_ns,
        decisions > 0,
        step="mid",
        color=style.HIT,
        linewidth=0.6,
        edgecolor=style.HIT,
        zorder=3,
    )


def _draw_clusters(axes: Axes, view: _View, taps: dict[str, NDArray[Any]]) -> None:
    axes.set_title("(f) Clusters: what the node reports")
    axes.set_ylabel("weight [hits]")
    rows = _tap(taps, "range_clusters")
    if rows is None or rows.size == 0:
        axes.set_ylim(0.0, 1.0)
        _say(axes, "no cluster in this frame")
        return
    position, weight, first, last = rows.reshape(-1, 4).T
    at_ns = view.sample_to_ns(position)
    axes.hlines(
        weight,
        view.sample_to_ns(first),
        view.sample_to_ns(last),
        color=style.HIT,
        linewidth=4.0,
        alpha=0.35,
        zorder=2,
    )
    axes.vlines(at_ns, 0.0, weight, color=style.HIT, linewidth=1.3, zorder=3)
    axes.plot(at_ns, weight, "o", color=style.HIT, markersize=4.5, zorder=3)
    axes.set_ylim(0.0, 1.3 * float(weight.max()))
    free_from_ns = -np.inf
    for x, y in zip(at_ns, weight, strict=True):  # label what has room for a label
        if x - free_from_ns < 0.06 * (view.delay_ns[-1] - view.delay_ns[0]):
            continue
        axes.annotate(f"{x:.1f} ns", (x, y), (4, 4), textcoords="offset points", fontsize=7.5, zorder=4)
        free_from_ns = x


def _inset(axes: Axes, view: _View, current: NDArray[np.float64], empty: NDArray[np.float64] | None) -> None:
    """Show the surroundings of the first true echo larger, when it is known."""
    if not view.true_ns:
        return
    low, high = view.true_ns[0] - INSET_HALF_WIDTH_NS, view.true_ns[0] + INSET_HALF_WIDTH_NS
    inside = (view.delay_ns >= low) & (view.delay_ns <= high)
    if inside.sum() < 3:
        return
    zoom = axes.inset_axes(INSET_BOX)
    if empty is not None:
        zoom.plot(view.delay_ns[inside], empty[inside], color=style.EMPTY_ROOM, linewidth=2.0)
    zoom.plot(view.delay_ns[inside], current[inside], color=style.CURRENT, linewidth=0.8)
    view.mark_truth(zoom)
    peak = 1.15 * float(np.abs(current[inside]).max())
    zoom.set_xlim(low, high)
    zoom.set_ylim(-peak if float(current.min()) < 0.0 else 0.0, peak)
    zoom.set_xticks([round(low) + 1, round(high) - 1])
    zoom.set_yticks([])
    zoom.tick_params(labelsize=7, pad=1.5)
    zoom.grid(False)
    for spine in zoom.spines.values():
        spine.set_visible(True)
    zoom.set_title("around the true echo", fontsize=7.5, fontweight="normal", loc="right", pad=2.0)


def _shared_legend(figure: Figure, view: _View) -> None:
    from matplotlib.lines import Line2D

    entries = [Line2D([], [], color=style.CURRENT, label="current scan")]
    if view.empty_room is not None:
        entries.append(Line2D([], [], color=style.EMPTY_ROOM, label="empty room"))
    entries.append(Line2D([], [], color=style.THRESHOLD, label="square root of the threshold"))
    entries.append(Line2D([], [], color=style.THRESHOLD, marker="^", linestyle="none", label="direct path"))
    entries.append(Line2D([], [], color=style.HIT, label="decisions, clusters"))
    if view.true_ns:
        entries.append(Line2D([], [], color=style.TRUTH, linestyle=(0, (4, 2)), label="true echo"))
    figure.legend(handles=entries, loc="lower center", ncols=len(entries), columnspacing=1.4)


def _envelope(scan: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the magnitude (n,) of the analytic signal of scan (n,)."""
    n = scan.size
    gain = np.zeros(n)
    gain[0] = 1.0
    gain[1 : (n + 1) // 2] = 2.0
    if n % 2 == 0:
        gain[n // 2] = 1.0
    return np.asarray(np.abs(np.fft.ifft(np.fft.fft(scan - scan.mean()) * gain)))


def _tap(taps: dict[str, NDArray[Any]], name: str) -> NDArray[np.float64] | None:
    values = taps.get(name)
    return None if values is None else np.asarray(values, dtype=np.float64)


def _say(axes: Axes, text: str) -> None:
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", color=style.QUIET)
