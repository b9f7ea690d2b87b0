"""One look for all pictures: sizes, colours and symbols.

The colours stay apart for colour-blind readers.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH_IN = 10.0  # of every picture: the report shows all at the same scale
DOTS_PER_INCH = 130

INK = "#1a1a1a"
QUIET = "#6b6f76"  # what the eye may skip: grid labels, blind zones, notes
GRID = "#dfe1e5"
TRUTH = "#000000"
CURRENT = "#0072b2"  # the current scan and what is made of it
EMPTY_ROOM = "#8a8f98"
THRESHOLD = "#d55e00"
HIT = "#009e73"  # decisions and clusters
POINT = "#9aa5b1"  # points handed to the tracker
TRACKER = "#0072b2"  # the configured tracker, where one colour stands for all its tracks
BASELINE = "#d55e00"  # the Kalman filter, everywhere
TRACK_CYCLE = ("#0072b2", "#009e73", "#aa4499", "#332288", "#999933", "#56b4e9", "#882255")  # by track id
AMPLITUDE_MAP = "cividis"

TRANSMITTER_MARKER = "v"
RECEIVER_MARKER = "s"
MONOSTATIC_MARKER = "D"
TRACK_STATE_LINE = {0: ":", 1: "-", 2: "--"}  # unconfirmed, confirmed, silent
PERSON_DASHES: tuple[Any, ...] = ("-", (0, (6, 2)), (0, (6, 2, 1, 2)), (0, (2, 2)), (0, (1, 1)))

_SETTINGS: Any = {  # matplotlib types the keys, in releases that differ
    "font.family": ["DejaVu Sans"],  # comes with matplotlib: the same picture everywhere
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titley": 1.0,  # fixed: looking for a free place costs a third of the drawing time
    "axes.titlepad": 5.0,
    "axes.labelsize": 9.0,
    "axes.labelcolor": INK,
    "axes.edgecolor": QUIET,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.limits": (-3, 6),
    "grid.color": GRID,
    "grid.linewidth": 0.6,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "legend.handlelength": 2.2,
    "lines.linewidth": 1.1,
    "text.color": INK,
    "figure.facecolor": "white",
    "axes.facecolor": "white",
    "savefig.facecolor": "white",
    "hatch.linewidth": 0.6,
    "path.simplify": True,
}


@contextmanager
def look() -> Iterator[None]:
    """Apply the look while a picture is drawn or saved; nothing outside is changed."""
    import matplotlib

    with matplotlib.rc_context(_SETTINGS):
        yield


def new_figure(height_in: float) -> Figure:
    """Return an empty figure that lays itself out; call it within `look()`."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    layout = ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.06, wspace=0.03, hspace=0.03)
    return Figure(figsize=(WIDTH_IN, height_in), dpi=DOTS_PER_INCH, layout=layout)


def new_panels(
    n_rows: int,
    n_columns: int,
    height_in: float,
    *,
    legend: bool,
    right_in: float = 0.1,
    share_x: bool = True,
    share_y: bool = False,
) -> tuple[Figure, Any]:
    """Return a figure and its axes (n_rows, n_columns) in fixed places: faster than one laid out."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH_IN, height_in), dpi=DOTS_PER_INCH)
    spacing = figure.add_gridspec(
        n_rows,
        n_columns,
        left=0.75 / WIDTH_IN,
        right=1.0 - right_in / WIDTH_IN,
        bottom=(0.82 if legend else 0.5) / height_in,
        top=1.0 - 0.35 / height_in,
        hspace=0.22,
        wspace=0.17 if share_x else 0.3,
    )
    return figure, spacing.subplots(squeeze=False, sharex=share_x, sharey=share_y)


def save_png(figure: Figure, path: Path) -> None:
    """Write `figure` as PNG."""
    with look():
        figure.savefig(path, format="png", pil_kwargs={"compress_level": 4})


def track_colour(track_id: int) -> str:
    """Return the colour of a track: the same in every picture of a run."""
    return TRACK_CYCLE[track_id % len(TRACK_CYCLE)]


def person_dashes(index: int) -> Any:
    """Return the dashes of the `index`-th person's true path."""
    return PERSON_DASHES[index % len(PERSON_DASHES)]


def legend_below(figure: Figure, axes: Axes, *, columns: int) -> None:
    """Put the legend of `axes` under the figure, outside of the data, each label once."""
    handles, labels = axes.get_legend_handles_labels()
    once = dict(zip(labels, handles, strict=True))
    if once:
        figure.legend(list(once.values()), list(once), loc="outside lower center", ncols=columns)
