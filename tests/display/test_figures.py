"""The pictures show the right things at the right places; how they look was judged by eye."""

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.colors import same_color

from echofuse.display import setting, style
from echofuse.display.error_figure import error_figure
from echofuse.display.plan_figure import plan_figure
from echofuse.display.room_figure import room_figure
from echofuse.display.scan_figure import scan_figure
from echofuse.display.stack_figure import stack_figure
from echofuse.result import RunResult

SPEED_OF_LIGHT_MPS = 299_792_458.0


def test_scan_marks_the_true_echo_in_every_panel(run: RunResult) -> None:
    figure = scan_figure(run, "rx4")
    person = run.recording.truth[0].position_m[run.shown_frame, :2]
    node = run.recording.nodes[3]
    path_m = np.linalg.norm(person - node.tx_position_m[:2]) + np.linalg.norm(person - node.rx_position_m[:2])
    assert len(figure.axes) == 6
    for axes in figure.axes:
        marks = [line.get_xdata()[0] for line in axes.lines if same_color(line.get_color(), style.TRUTH)]
        np.testing.assert_allclose(marks, [path_m / SPEED_OF_LIGHT_MPS * 1e9])


def test_scan_shows_residual_against_the_root_of_the_threshold(run: RunResult) -> None:
    residual, threshold = scan_figure(run, "rx4").axes[3].lines[:2]
    np.testing.assert_array_equal(residual.get_ydata(), run.shown_taps["rx4"]["residual"])
    np.testing.assert_allclose(
        np.square(threshold.get_ydata()), run.shown_taps["rx4"]["threshold"], rtol=1e-6
    )
    np.testing.assert_allclose(residual.get_xdata(), run.stacks["rx4"].delay_s * 1e9)


@pytest.mark.parametrize(
    "missing", ["envelope", "residual", "threshold", "decisions", "range_clusters", "scan"]
)
def test_scan_lives_without_a_tap(run: RunResult, tmp_path: Path, missing: str) -> None:
    taps = {name: values for name, values in run.shown_taps["rx4"].items() if name != missing}
    style.save_png(scan_figure(replace(run, shown_taps={"rx4": taps}), "rx4"), tmp_path / "scan.png")
    assert (tmp_path / "scan.png").stat().st_size > 10_000


def test_scan_without_empty_room_and_truth_says_so(run: RunResult) -> None:
    nodes = tuple(replace(node, reference=None) for node in run.recording.nodes)
    bare = replace(run, recording=replace(run.recording, nodes=nodes, truth=()))
    figure = scan_figure(bare, "rx4")
    assert "learns its background" in figure.axes[0].texts[0].get_text()
    assert not any(same_color(line.get_color(), style.TRUTH) for axes in figure.axes for line in axes.lines)


def test_stack_shows_every_cluster(run: RunResult) -> None:
    figure = stack_figure(run, "rx2")
    drawn = figure.axes[3].collections[0].get_offsets()
    stack = run.stacks["rx2"]
    samples = np.concatenate(stack.clusters)[:, 0]
    expected_ns = np.interp(samples, np.arange(stack.delay_s.size), stack.delay_s) * 1e9
    np.testing.assert_allclose(drawn[:, 0], expected_ns, rtol=1e-6)
    assert drawn[:, 1].min() >= 0.0
    assert drawn[:, 1].max() <= 6.0 + 1e-9


def test_room_is_to_scale_and_tells_states_apart(run: RunResult) -> None:
    axes = room_figure(run).axes[0]
    assert axes.get_aspect() == 1.0
    colour = style.track_colour(1)
    lines = [line for line in axes.lines if same_color(line.get_color(), colour) and len(line.get_xdata())]
    assert {line.get_linestyle() for line in lines} == {"-", "--"}
    drawn = np.concatenate([line.get_xdata() for line in lines])
    told = run.tracks[run.tracks["state"] > 0]
    assert set(told["x_m"].tolist()) == set(drawn.tolist())


def test_a_track_that_ran_away_does_not_shrink_the_room(run: RunResult) -> None:
    wild = run.tracks.copy()
    wild["x_m"][-1] = 900.0
    assert room_figure(replace(run, tracks=wild)).axes[0].get_xlim()[1] < 13.0


def test_cdf_ends_at_the_tracked_share(run: RunResult) -> None:
    half = run.tracks[run.tracks["frame"] < 35]
    axes = error_figure(replace(run, tracks=half)).axes[0]
    curve = next(line for line in axes.lines if same_color(line.get_color(), style.TRACKER))
    assert curve.get_ydata()[-1] == pytest.approx(25 / 51)  # of the frames 10 to 60, tracked in 10 to 34


def test_no_truth_leaves_only_the_number_of_people(run: RunResult) -> None:
    blind = replace(run, recording=replace(run.recording, truth=()))
    figure = error_figure(blind)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["Number of people"]


@pytest.mark.parametrize("covered", [True, False])
def test_plan(tmp_path: Path, covered: bool) -> None:
    x_m, y_m = np.linspace(0.0, 4.0, 21), np.linspace(0.0, 6.0, 31)
    shape = (31, 21)
    bound_m = np.full(shape, np.inf)
    if covered:
        bound_m[:, 5:] = np.geomspace(0.02, 2.0, 16)
    snr_db = np.stack([np.add.outer(-2.0 * y_m, 0.0 * x_m) + 20.0] * 3)
    blind = np.zeros((3, *shape), dtype=bool)
    blind[0, :4, :4] = True
    figure = plan_figure(
        x_m=x_m,
        y_m=y_m,
        position_error_bound_m=bound_m,
        n_covering_pairs=np.full(shape, 3 if covered else 0),
        blind=blind,
        snr_db=snr_db,
        tx_position_m=np.array([[0.0, 0.0], [0.0, 0.0], [4.0, 6.0]]),
        rx_position_m=np.array([[4.0, 0.0], [0.0, 6.0], [4.0, 6.0]]),
        names=["a", "b", "c"],
        site_name="tall room",
    )
    style.save_png(figure, tmp_path / "plan.png")
    shares = figure.axes[3].lines[0].get_ydata() if covered else [0.0]
    assert max(shares) == pytest.approx(16 / 21 if covered else 0.0)


def test_true_person_away_is_not_marked(make_run: Callable[..., RunResult]) -> None:
    run = make_run(n_frames=5)
    (person,) = setting.people(run)
    assert np.isnan(person.at(np.array([0.0, 1e6]))).all()
    assert np.isfinite(person.at(person.time_s)).all()


def test_drawing_leaves_matplotlib_as_it_was(run: RunResult) -> None:
    before = dict(matplotlib.rcParams)
    room_figure(run)
    assert dict(matplotlib.rcParams) == before


@pytest.mark.parametrize(
    ("statement", "module"),
    [
        ("import echofuse.display.report, echofuse.display.room_figure", "matplotlib"),
        ("from echofuse.display import style\nwith style.look(): style.new_figure(2.0)", "matplotlib.pyplot"),
    ],
)
def test_nothing_is_loaded_that_is_not_used(statement: str, module: str) -> None:
    code = f"import sys\n{statement}\nsys.exit({module!r} in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
