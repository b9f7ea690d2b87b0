"""The through-wall pictures show each stage's values where they belong; how they look was judged by eye."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import same_color

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.display import style
from echofuse.display.error_figure import error_figure
from echofuse.display.report import write_report
from echofuse.display.report_page import page
from echofuse.display.response_figure import response_figure
from echofuse.display.room_figure import room_figure
from echofuse.evaluation.behind_wall import path_behind_wall_m
from echofuse.recording import DETECTION_DTYPE, TRACK_DTYPE, NodeRecording, PersonTruth, Recording
from echofuse.result import ASSOCIATED_DTYPE, POINT_DTYPE, ResponseStack, RunResult
from echofuse.simulation.wall import Wall
from echofuse.site import example_site

RATE_HZ = 4.5e9
N_SAMPLES, N_KEPT, N_RESPONSES = 511, 300, 40
PERIOD_S = 0.074
C = SPEED_OF_LIGHT_MPS
COLOURS = {0: style.QUIET, 7: style.track_colour(7)}


@pytest.fixture(scope="module")
def walled() -> RunResult:
    """One person walks away; every response of both receivers has one trace, from 20 on it is of a track."""
    site = example_site("through_wall")
    time_s = 100.0 + PERIOD_S * np.arange(N_RESPONSES)
    time_us = np.round(time_s * 1e6).astype(np.int64)
    walk = np.column_stack([np.full(N_RESPONSES, -0.8), 2.0 + time_s - 100.0, np.ones(N_RESPONSES)])
    rng = np.random.default_rng(0)
    nodes, stacks, paths = [], {}, []
    for place in site.nodes:
        path_m = path_behind_wall_m(walk, place.tx_position_m, place.rx_position_m, Wall())
        paths.append(path_m)
        scans = rng.normal(0.0, 8.0, (N_RESPONSES, N_SAMPLES)).astype(np.float32)
        echo = np.round(path_m / C * RATE_HZ).astype(int)
        images = {name: np.zeros_like(scans[:, :N_KEPT]) for name in ("rotated", "subtracted", "enhanced")}
        for image in images.values():
            image[np.arange(N_RESPONSES), echo] = -0.5  # signed: what is drawn is its magnitude
        decisions = (images["enhanced"] < 0).astype(np.uint8)
        rows = [np.array([[path / C, 8.0]]) for path in path_m]
        stacks[place.name] = ResponseStack(
            images=images,
            decisions=decisions,
            delays={"target_traces": rows, "leading_edges": rows, "detections": rows},
            delay_s=np.arange(N_KEPT) / RATE_HZ,
        )
        nodes.append(
            NodeRecording(
                name=place.name,
                node_id=place.id,
                sample_rate_hz=RATE_HZ,
                first_sample_s=0.0,
                tx_position_m=np.array(place.tx_position_m),
                rx_position_m=np.array(place.rx_position_m),
                time_s=time_s,
                scans=scans,
            )
        )
    associated = np.zeros((N_RESPONSES, 2), ASSOCIATED_DTYPE)
    associated["frame"], associated["node"] = np.arange(N_RESPONSES)[:, np.newaxis], [0, 1]
    associated["path_m"] = np.column_stack(paths)
    associated["owner"][5:20], associated["owner"][20:] = -1, 7  # of nobody before
    tracks = np.zeros(N_RESPONSES - 20, TRACK_DTYPE)
    tracks["frame"], tracks["id"], tracks["state"] = np.arange(20, N_RESPONSES), 7, 1
    tracks["x_m"], tracks["y_m"] = walk[20:, 0] + 0.1, walk[20:, 1]
    return RunResult(
        site=site,
        recording=Recording(
            pipeline="through_wall_2d",
            created="2024-05-01T10:00:00Z",
            site_toml="",
            nodes=tuple(nodes),
            truth=(PersonTruth(id="1", time_s=time_s, position_m=walk),),
        ),
        frame_time_us=time_us,
        detections=np.zeros(0, DETECTION_DTYPE),
        points=np.zeros(0, POINT_DTYPE),
        tracks=tracks,
        baseline_tracks=tracks[:3],
        metrics={"rmse_m": 0.1, "worst_tracked_fraction": 0.5, "false_tracks_per_100_s": 1.25},
        baseline_metrics={"rmse_m": 0.2},
        associated=associated.ravel(),
        counters={"hub": {"frames": N_RESPONSES}, "rx1": {"responses": N_RESPONSES}},
        responses=stacks,
    )


def test_every_stage_has_its_panel(walled: RunResult) -> None:
    figure = response_figure(walled, "rx2")
    panels = figure.axes[:8]
    titles = [axes.get_title(loc="left") for axes in panels]
    assert [title[:3] for title in titles] == [f"({letter})" for letter in "abcdefgh"]
    assert [len(axes.images) for axes in panels] == [1, 1, 1, 1, 1, 0, 0, 0]
    assert panels[0].get_xlim()[1] == pytest.approx((N_SAMPLES - 1) / RATE_HZ * 1e9)
    for axes, n_samples in zip(panels[:5], (N_SAMPLES, *[N_KEPT] * 4), strict=True):
        assert axes.images[0].get_array().shape[1] == n_samples
        assert axes.images[0].get_extent()[1] == pytest.approx((n_samples - 1) / RATE_HZ * 1e9)
    enhanced = panels[3].images[0].get_array()
    assert enhanced.max() == pytest.approx(0.5)
    assert np.count_nonzero(panels[4].images[0].get_array()) == N_RESPONSES


def test_traces_couples_and_truth_lie_on_each_other(walled: RunResult) -> None:
    panels = response_figure(walled, "rx2").axes
    node = walled.recording.nodes[1]
    walk = walled.recording.truth[0].position_m
    expected_ns = path_behind_wall_m(walk, node.tx_position_m, node.rx_position_m, Wall()) / C * 1e9
    elapsed_s = PERIOD_S * np.arange(N_RESPONSES)
    for dots in panels[5].collections:
        np.testing.assert_allclose(dots.get_offsets(), np.column_stack([expected_ns, elapsed_s]), rtol=1e-6)
    (truth,) = panels[7].lines
    np.testing.assert_allclose(truth.get_xdata(), expected_ns, rtol=1e-9)
    reported, paired, of_seven = panels[6].collections[:3]
    assert len(reported.get_offsets()) == N_RESPONSES
    for dots, owner, frames in ((paired, 0, slice(5, 20)), (of_seven, 7, slice(20, None))):
        assert same_color(dots.get_facecolor()[0], COLOURS[owner])
        np.testing.assert_allclose(dots.get_offsets()[:, 0], expected_ns[frames], rtol=1e-5)


def test_without_a_second_receiver_only_reports_are_shown(walled: RunResult) -> None:
    alone = replace(walled, associated=walled.associated[:0], why_no_positions="one receiver only")
    panel = response_figure(alone, "rx1").axes[6]
    assert panel.get_title(loc="left") == "(g) Reported delays"
    assert len(panel.collections) == 1
    assert "There are no positions: one receiver only" not in page(alone, [])
    assert "No positions: one receiver only" in page(alone, [])


def test_the_wall_stands_before_the_area(walled: RunResult) -> None:
    axes = room_figure(walled).axes[0]
    (wall,) = [patch for patch in axes.patches if str(patch.get_label()).startswith("wall")]
    assert wall.get_label() == "wall, 24 cm"
    assert (wall.get_xy()[:, 1].min(), wall.get_xy()[:, 1].max()) == pytest.approx((0.26, 0.5))
    labels = axes.get_legend_handles_labels()[1]
    assert {"Tx", "Rx", "Pairing, then Kalman"} <= set(labels)  # 0.4 m apart, and yet two antennas


def test_errors_begin_after_settling_and_name_no_other_paper(walled: RunResult) -> None:
    figure = error_figure(walled)
    assert not figure.axes[0].texts
    drawn = [line for line in figure.axes[0].lines if same_color(line.get_color(), style.TRACKER)]
    settled = np.count_nonzero(PERIOD_S * np.arange(N_RESPONSES) >= 2.0)
    assert drawn[0].get_ydata()[-1] == pytest.approx(min(settled, 20) / settled)


def test_the_report_compares_with_pairing_and_not_with_the_other_paper(
    walled: RunResult, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("report")
    text = write_report(walled, folder).read_text()
    assert "<th scope='col'>Pairing, then Kalman</th></tr>" in text
    assert "11.5 m" not in text
    assert "2 bistatic: rx1, rx2" in text
    assert "<td>1.250</td>" in text
    assert "<td>50.0 %</td>" in text
    assert sorted(path.name for path in (folder / "figures").iterdir()) == [
        "error.png",
        "responses-01-rx1.png",
        "responses-02-rx2.png",
        "room.png",
    ]
