"""The case `stairs` as a user meets it: a run, its table of ways, its replay, and other sites in space."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from echofuse.cli import main
from echofuse.display.ways import WAYS
from echofuse.recording import read
from echofuse.site import example_site

DURATION_S = 13.0  # to the other side of the landing
RESPONSES = 175  # of 0.074 s


@pytest.fixture(scope="module")
def said(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """The folder of a run, and what it printed."""
    from contextlib import redirect_stdout
    from io import StringIO

    folder, printed = tmp_path_factory.mktemp("stairs"), StringIO()
    with redirect_stdout(printed):
        arguments = ["run", "stairs", "--duration", str(DURATION_S), "--seed", "3", "--out", str(folder)]
        assert main(arguments) == 0
    return folder, printed.getvalue()


def metrics(folder: Path) -> dict[str, float]:
    return json.loads((folder / "metrics.json").read_text())


def test_the_climber_is_tracked_in_space(said: tuple[Path, str]) -> None:
    folder, _ = said
    found = metrics(folder)
    assert found["frames_evaluated"] == pytest.approx(RESPONSES - 2.0 / 0.074, abs=1.0)
    assert found["tracked_fraction"] > 0.8
    assert found["cuboid_fraction"] > 0.7
    assert found["rmse_m"] < 0.6
    assert found["bound_ratio"] == pytest.approx(found["rmse_m"] / found["position_error_bound_m"], rel=0.3)
    with (folder / "tracks.csv").open() as file:
        rows = list(csv.DictReader(file))
    height_m = np.array([float(row["z_m"]) for row in rows])
    assert np.ptp(height_m) > 1.0  # it climbs
    truth = read(folder / "recording.h5").truth[0]
    time_s = np.array([float(row["time_s"]) for row in rows])
    true_m = np.interp(time_s, truth.time_s, truth.position_m[:, 2])
    assert np.median(np.abs(height_m - true_m)) < 0.4


def test_every_way_stands_in_the_table(said: tuple[Path, str]) -> None:
    folder, printed = said
    found = metrics(folder)
    lines = printed.splitlines()
    for way, label in WAYS.items():
        (line,) = [line for line in lines if line.startswith(f"{label} ")]
        assert f"{found[f'{way}_points_rmse_m']:.3f}" in line
        assert f"{found[f'{way}_track_rmse_m']:.3f}" in line
        assert 0.1 < found[f"{way}_points_rmse_m"] < 1.0
        assert found[f"{way}_points_located_fraction"] > 0.3
    assert f"position: {found['position_error_bound_m']:.3f} m" in printed
    # TSM takes off what the approximation is too deep by.
    assert found["tsm_from_approximate_points_rmse_m"] == pytest.approx(
        found["tsm_from_three_d_two_d_points_rmse_m"], rel=0.05
    )
    beside = json.loads((folder / "baseline_metrics.json").read_text())
    assert beside["rmse_m"] == pytest.approx(found["tsm_from_three_d_two_d_track_rmse_m"])


def test_its_report_has_the_papers_pictures(said: tuple[Path, str]) -> None:
    folder, _ = said
    names = sorted(path.name for path in (folder / "figures").iterdir())
    assert names == [
        "error.png",
        *(f"responses-{number:02d}-rx{number}.png" for number in (1, 2, 3, 4)),
        "room.png",
        "space-1-three_d_two_d.png",
        "space-2-tsm_from_three_d_two_d.png",
        "space-3-tracker.png",
    ]
    assert "<h3>Before and after tracking</h3>" in (folder / "report.html").read_text()


def test_it_replays_and_is_processed_alike(
    said: tuple[Path, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, _ = said
    recording = folder / "recording.h5"
    assert main(["verify", str(recording)]) == 0
    assert f"{RESPONSES} frames, all bytes the same" in capsys.readouterr().out
    assert main(["process", str(recording), "--no-report", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "tracks.csv").read_text() == (folder / "tracks.csv").read_text()
    assert metrics(tmp_path) == metrics(folder)


def test_seeds_print_a_line_each_their_mean_and_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "stairs", "--duration", "5", "--seeds", "0-1"]) == 0
    head, *lines = capsys.readouterr().out.splitlines()
    columns = head.split()
    assert {"rmse_m", "cuboid_fraction", "position_error_bound_m"} < set(columns)
    assert [line.split()[0] for line in lines[:4]] == ["0", "1", "mean", "KF"]
    seeds = [dict(zip(columns, line.split(), strict=True)) for line in lines[:3]]
    values = [float(row["rmse_m"]) for row in seeds]
    assert values[2] == pytest.approx((values[0] + values[1]) / 2.0, abs=1e-4)
    assert [line for line in lines if line.startswith("TSM from 3D-2D ")]
    (line,) = [line for line in lines if line.startswith("Path tracker ")]
    assert f"{values[2]:.3f}" in line


@pytest.mark.parametrize("people", ["0", "2"])
def test_one_person_climbs(capsys: pytest.CaptureFixture[str], people: str) -> None:
    assert main(["run", "stairs", "--people", people]) == 2
    assert f"--people: expected 1 on the stairs, found {people}" in capsys.readouterr().err


def own_site(path: Path, box: list[float]) -> Path:
    text = example_site("stairs").to_toml()
    path.write_text(text.replace(str(list(example_site("stairs").box_m)), str(box)))
    return path


def test_a_site_of_ones_own_has_people_on_the_floor_of_its_box(tmp_path: Path) -> None:
    site = own_site(tmp_path / "cellar.toml", [-2.0, 0.4, -1.3, 2.0, 5.5, 1.7])
    arguments = ["run", str(site), "--people", "1", "--duration", "9", "--no-report", "--out", str(tmp_path)]
    assert main(arguments) == 0
    truth = read(tmp_path / "recording.h5").truth[0]
    np.testing.assert_allclose(truth.position_m[:, 2], -1.3 + 0.68 * (truth.height_m or 0.0))
    assert metrics(tmp_path)["tracked_fraction"] > 0.5


def test_a_box_too_low_for_people_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    site = own_site(tmp_path / "low.toml", [-2.0, 0.4, -0.5, 2.0, 5.5, 0.9])
    assert main(["run", str(site), "--no-report", "--out", str(tmp_path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "site.area: expected room for the people who are simulated" in line
