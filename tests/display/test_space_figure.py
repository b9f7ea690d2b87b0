"""The pictures in space show what was located and tracked where it was; how they look was judged by eye."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import same_color
from numpy.typing import NDArray

from echofuse.display import setting, style
from echofuse.display.report import write_report
from echofuse.display.room_figure import room_figure
from echofuse.display.space_figure import REGION, space_figure
from echofuse.display.ways import way_lines
from echofuse.metrics import measure, true_path_m, wall_of
from echofuse.recording import DETECTION_DTYPE, TRACK_DTYPE, NodeRecording, PersonTruth, Recording
from echofuse.result import POINT_DTYPE, RunResult
from echofuse.simulation.stairs import POINTS_M, stairs_climber
from echofuse.site import example_site

PERIOD_S, N_FRAMES = 0.074, 320
TIME_S = PERIOD_S * np.arange(N_FRAMES)
TIME_US = np.round(TIME_S * 1e6).astype(np.int64)
CLIMB_M = stairs_climber().position_m(TIME_S)
OFFSET_M = {
    "three_d_two_d": 0.4,
    "approximate": 0.5,
    "tsm_from_three_d_two_d": 0.3,
    "tsm_from_approximate": 0.2,
}
SIGMA_M = 0.03


def _rows(dtype: np.dtype, frames: NDArray[np.intp], above_m: float) -> NDArray[np.void]:
    rows = np.zeros(frames.size, dtype)
    rows["frame"], rows["time_us"] = frames, TIME_US[frames]
    for axis, name in enumerate(("x_m", "y_m", "z_m")):
        rows[name] = CLIMB_M[frames, axis]
    rows["z_m"] += above_m
    if dtype == TRACK_DTYPE:
        rows["id"], rows["state"] = 5, 1
        rows["state"][100:110] = 2
    return rows


@pytest.fixture(scope="module")
def climb() -> RunResult:
    """Somebody climbs; each way says so an offset too high, from frame 30 or 40 on, every second point."""
    site, rng = example_site("stairs"), np.random.default_rng(0)
    nodes, detections = [], []
    for index, place in enumerate(site.nodes):
        node = NodeRecording(
            name=place.name,
            node_id=place.id,
            sample_rate_hz=7e9,
            first_sample_s=0.0,
            tx_position_m=np.array(place.tx_position_m),
            rx_position_m=np.array(place.rx_position_m),
            time_s=TIME_S,
            scans=np.zeros((N_FRAMES, 4), np.float32),
        )
        rows = np.zeros(N_FRAMES, DETECTION_DTYPE)
        rows["frame"], rows["node"], rows["time_us"] = np.arange(N_FRAMES), index, TIME_US
        path_m = true_path_m(node, CLIMB_M[:, np.newaxis], wall_of(site))[:, 0]
        rows["delay_s"] = (path_m + rng.normal(0.0, SIGMA_M, N_FRAMES)) / setting.SPEED_OF_LIGHT_MPS
        nodes.append(node)
        detections.append(rows)
    points = {way: _rows(POINT_DTYPE, np.arange(30, N_FRAMES, 2), off_m) for way, off_m in OFFSET_M.items()}
    tracks = {
        way: _rows(TRACK_DTYPE, np.arange(40, N_FRAMES), off_m / 2.0) for way, off_m in OFFSET_M.items()
    }
    result = RunResult(
        site=site,
        recording=Recording(
            pipeline="through_wall_3d",
            created="2024-05-01T10:00:00Z",
            site_toml="",
            nodes=tuple(nodes),
            truth=(PersonTruth(id="1", time_s=TIME_S, position_m=CLIMB_M, height_m=1.8),),
        ),
        frame_time_us=TIME_US,
        detections=np.concatenate(detections),
        points=points["three_d_two_d"][:5],
        tracks=_rows(TRACK_DTYPE, np.arange(40, N_FRAMES), 0.1),
        baseline_tracks=tracks["tsm_from_three_d_two_d"],
        metrics={},
        baseline_metrics={},
        compared_points=points,
        compared_tracks=tracks,
    )
    measure(result)
    return result


def test_every_way_is_measured_before_and_after_tracking(climb: RunResult) -> None:
    found = climb.metrics
    frames = np.flatnonzero(TIME_S >= 2.0)
    located = np.isin(frames, np.arange(30, N_FRAMES, 2)).mean()
    tracked = np.mean(frames >= 40)
    for way, off_m in OFFSET_M.items():
        assert found[f"{way}_points_rmse_m"] == pytest.approx(off_m, rel=1e-4)
        assert found[f"{way}_points_located_fraction"] == pytest.approx(located)
        assert found[f"{way}_points_cuboid_fraction"] == pytest.approx(located)
        assert found[f"{way}_track_rmse_m"] == pytest.approx(off_m / 2.0, rel=1e-4)
        assert found[f"{way}_track_tracked_fraction"] == pytest.approx(tracked)
        assert found[f"{way}_track_cuboid_fraction"] == pytest.approx(tracked)
    assert found["rmse_m"] == pytest.approx(0.1, rel=1e-4)
    assert found["cuboid_fraction"] == pytest.approx(tracked)
    assert climb.baseline_metrics["rmse_m"] == pytest.approx(0.15, rel=1e-4)
    assert found["path_error_std_m"] == pytest.approx(SIGMA_M, rel=0.1)
    assert 0.1 < found["position_error_bound_m"] < 0.5
    assert found["bound_ratio"] == pytest.approx(found["rmse_m"] / found["position_error_bound_m"], rel=0.1)


def test_the_table_has_a_line_a_way_and_the_bound(climb: RunResult) -> None:
    lines = way_lines(climb.metrics, "Path tracker")
    assert [line.split("  ")[0] for line in lines[2:]] == [
        "3D-2D",
        "TSM from 3D-2D",
        "A-3D-2D",
        "TSM from A-3D-2D",
        "Path tracker",
        lines[-1],
    ]
    assert lines[2].split()[:2] == ["3D-2D", "0.400"]
    assert lines[6].split()[2:6] == ["-", "-", "-", "0.100"]
    assert f"position: {climb.metrics['position_error_bound_m']:.3f} m" in lines[-1]
    assert way_lines({"rmse_m": 0.1}, "PHD filter") == []


def test_points_and_tracks_are_drawn_where_they_are(climb: RunResult) -> None:
    points, tracks = climb.compared_points["three_d_two_d"], climb.compared_tracks["three_d_two_d"]
    figure = space_figure(climb, points, tracks, name="3D-2D")
    spatial, plan, spatial_track, plan_track, height = figure.axes
    assert [axes.name for axes in figure.axes] == ["3d", "rectilinear", "3d", "rectilinear", "rectilinear"]
    assert plan.get_title(loc="left") == "(b) 3D-2D: positions from above"
    expected = np.column_stack([points[name] for name in ("x_m", "y_m", "z_m")])
    dots = spatial.collections[-1]
    np.testing.assert_allclose(np.column_stack(dots._offsets3d), expected, atol=1e-6)
    np.testing.assert_allclose(plan.collections[-1].get_offsets(), expected[:, :2], atol=1e-6)
    seen = np.column_stack([points["time_us"] * 1e-6, points["z_m"]])
    np.testing.assert_allclose(height.collections[-1].get_offsets(), seen, atol=1e-6)
    colour = style.track_colour(5)
    for axes in (plan_track, height):
        lines = [line for line in axes.lines if same_color(line.get_color(), colour)]
        assert [line.get_linestyle() for line in lines] == ["-", "--", "-"]
    drawn = [np.array(line.get_data_3d()) for line in spatial_track.lines[1:]]
    assert drawn[0][2, 0] == pytest.approx(CLIMB_M[40, 2] + 0.2, abs=1e-6)
    assert np.allclose(plan.get_aspect(), 1.0)


def test_the_region_is_the_cuboid_along_the_path(climb: RunResult) -> None:
    figure = space_figure(climb, None, climb.tracks, name="Path tracker")
    assert len(figure.axes) == 3
    plan, height = figure.axes[1:]
    fills = [patch.get_path() for patch in plan.patches if same_color(patch.get_facecolor(), REGION)]
    inside_m = np.concatenate([CLIMB_M[:, :2] + off for off in ((0.49, 0.0), (0.0, -0.49), (-0.49, 0.49))])
    covered = np.any([path.contains_points(inside_m) for path in fills], axis=0)
    assert covered.all()
    outside_m = np.array([(0.0, 3.0), (-1.3, 3.0), (0.0, 0.45), (0.75, 6.4)])
    assert not np.any([path.contains_points(outside_m) for path in fills])
    band = height.collections[0].get_paths()[0].get_extents()
    assert (band.ymin, band.ymax) == pytest.approx((POINTS_M[0][2], POINTS_M[-1][2] + 1.8))


def test_without_truth_there_is_no_region(climb: RunResult) -> None:
    blind = replace(climb, recording=replace(climb.recording, truth=()))
    figure = space_figure(blind, None, climb.tracks, name="Path tracker")
    assert not [patch for patch in figure.axes[1].patches if same_color(patch.get_facecolor(), REGION)]


def test_a_track_that_ran_away_leaves_the_picture(climb: RunResult) -> None:
    wild = climb.tracks.copy()
    wild["z_m"][50:60] = 90.0
    spatial = space_figure(climb, None, wild, name="Path tracker").axes[0]
    drawn_m = np.concatenate([np.array(line.get_data_3d()).T for line in spatial.lines])
    assert np.nanmax(drawn_m[:, 2]) < 5.0
    assert spatial.get_zlim()[1] < 5.0


def test_antennas_above_each_other_share_a_name_on_the_floor_plan(climb: RunResult) -> None:
    names = {text.get_text() for text in room_figure(climb).axes[0].texts}
    assert {"rx1", "rx2", "rx3, rx4, Tx"} <= names


def test_the_report_shows_both_of_the_papers_ways_and_ours(climb: RunResult, tmp_path: Path) -> None:
    text = write_report(climb, tmp_path).read_text(encoding="utf-8")
    assert "<th scope='row'>TSM from A-3D-2D</th><td>0.200</td>" in text
    assert "Cramér-Rao bound of one response" in text
    assert "<code>three_d_two_d_points_rmse_m</code>" not in text  # in the table of ways instead
    assert "<h2>TSM from 3D-2D in space</h2>" in text
    assert sorted(path.name for path in (tmp_path / "figures").iterdir()) == [
        "error.png",
        "room.png",
        "space-1-three_d_two_d.png",
        "space-2-tsm_from_three_d_two_d.png",
        "space-3-tracker.png",
    ]
