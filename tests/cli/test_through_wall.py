"""The case `through-wall` as a user meets it, and what may be wrong with a recording of such a radar."""

import csv
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from echofuse.cli import main
from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.evaluation.behind_wall import path_behind_wall_m
from echofuse.recording import Recording, read, write
from echofuse.simulation.stairs import WALL as STAIRS_WALL
from echofuse.simulation.stairs import simulate_stairs, stairs_scene
from echofuse.simulation.through_wall import simulate_through_wall
from echofuse.simulation.through_wall_scene import case_study_walkers, through_wall_scene
from echofuse.simulation.wall import Wall
from echofuse.site import example_site

DURATION_S = 12.0
RESPONSES = 162  # of 0.074 s
SETTLED = 13  # responses until time zero and background are known
Scans = NDArray[np.float32]


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wall")
    arguments = ["run", "through-wall", "--duration", str(DURATION_S), "--seed", "3", "--out", str(folder)]
    assert main(arguments) == 0
    return folder


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


def counters(folder: Path) -> dict[str, dict[str, int]]:
    return json.loads((folder / "counters.json").read_text())


def metrics(folder: Path) -> dict[str, float]:
    return json.loads((folder / "metrics.json").read_text())


def changed(
    source: Path, target: Path, change: Callable[[Scans], Scans | None], *, node: str = "rx2"
) -> Path:
    """Write a recording again with one node's scans changed, in place or anew."""
    recording = read(source)
    nodes = []
    for each in recording.nodes:
        scans = np.array(each.scans, np.float32)
        if each.name == node:
            other = change(scans)
            scans = scans if other is None else other
        nodes.append(replace(each, scans=scans))
    write(target, replace(recording, nodes=tuple(nodes), outputs=None))
    return target


def processed(recording: Path, folder: Path, *more: str) -> None:
    assert main(["process", str(recording), "--no-report", "--out", str(folder), *more]) == 0


def test_two_people_are_tracked_behind_the_wall(run_folder: Path) -> None:
    found = metrics(run_folder)
    assert found["worst_tracked_fraction"] >= 0.9
    assert found["mean_tracked_fraction"] >= found["worst_tracked_fraction"]
    assert found["crossing_tracked_fraction"] >= 0.8
    assert 0.05 < found["crossing_fraction"] < 0.6
    assert found["rmse_m"] < 0.3
    assert found["frames_evaluated"] == pytest.approx(RESPONSES - 2.0 / 0.074, abs=1.0)
    paired, all_pairs = found["paired_ghosts_per_response"], found["all_pairs_ghosts_per_response"]
    assert found["ghosts_per_response"] <= all_pairs
    assert paired >= 0.0
    beside = json.loads((run_folder / "baseline_metrics.json").read_text())
    assert beside["worst_tracked_fraction"] < found["worst_tracked_fraction"] + 0.05
    assert {row["state"] for row in rows_of(run_folder / "tracks.csv")} >= {"unconfirmed", "confirmed"}


def test_its_reported_ranges_are_the_true_ones(run_folder: Path) -> None:
    """Observations are the paths through the wall, less a body's radius on both legs."""
    recording = read(run_folder / "recording.h5")
    rx1 = recording.nodes[0]
    errors = []
    for person in recording.truth:
        path_m = path_behind_wall_m(person.position_m, rx1.tx_position_m, rx1.rx_position_m, Wall())
        for row in rows_of(run_folder / "observations.csv"):
            if row["node"] == "rx1":
                errors.append(float(row["range_m"]) - np.interp(float(row["time_s"]), person.time_s, path_m))
    near = np.array(errors)[np.abs(errors) < 0.6]
    assert len(near) > RESPONSES - SETTLED
    assert -0.45 < np.median(near) < -0.05


def test_its_report_has_a_picture_of_each_receiver(run_folder: Path) -> None:
    text = (run_folder / "report.html").read_text()
    assert "All responses of a receiver, stage by stage" in text
    assert "<code>worst_tracked_fraction</code>" in text
    assert "2 bistatic" in text
    names = sorted(path.name for path in (run_folder / "figures").iterdir())
    assert names == ["error.png", "responses-01-rx1.png", "responses-02-rx2.png", "room.png"]


def test_it_replays_and_is_processed_alike(
    run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = run_folder / "recording.h5"
    assert main(["verify", str(recording)]) == 0
    assert f"{RESPONSES} frames, all bytes the same" in capsys.readouterr().out
    processed(recording, tmp_path)
    assert (tmp_path / "tracks.csv").read_text() == (run_folder / "tracks.csv").read_text()
    quieter = changed(recording, tmp_path / "other.h5", lambda scans: scans[::-1].copy())
    with_outputs = replace(read(quieter), outputs=read(recording).outputs)
    write(quieter, with_outputs)
    assert main(["verify", str(quieter)]) == 1
    assert "differ" in capsys.readouterr().out


def test_seeds_print_the_columns_of_the_case(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "through-wall", "--people", "0", "--duration", "4", "--seeds", "0-1"]) == 0
    head, *lines = capsys.readouterr().out.splitlines()
    columns = head.split()
    assert {"worst_tracked_fraction", "false_tracks_per_100_s", "all_pairs_ghosts_per_response"} < set(
        columns
    )
    assert [line.split()[0] for line in lines] == ["0", "1", "mean", "KF"]
    for line in lines[:2]:
        row = dict(zip(columns, line.split(), strict=True))
        assert row["confirmed_tracks"] == "0.0000"
        assert row["rmse_m"] == "-"  # nobody is there


def test_a_site_of_ones_own(tmp_path: Path) -> None:
    site = tmp_path / "shed.toml"
    site.write_text(
        "[site]\nname = 'shed'\narea = [-2.0, 0.6, 2.5, 5.5]\n"
        "[site.wall]\nthickness_m = 0.12\nrelative_permittivity = 5.0\n"
        + "".join(
            f"[[node]]\nname = '{name}'\nid = {number}\n"
            f"tx_position_m = [0.2, 0.0, 1.1]\nrx_position_m = [{x}, 0.0, 1.1]\n"
            for number, (name, x) in enumerate((("left", -0.4), ("right", 0.7)), start=11)
        )
        + "[pipeline]\nname = 'through_wall_2d'\n"
        + "[pipeline.target_traces]\nwindow_samples = 8\nleast_hits = 4\n"
    )
    arguments = ["run", str(site), "--people", "1", "--duration", "10", "--no-report", "--out", str(tmp_path)]
    assert main(arguments) == 0
    assert [node.name for node in read(tmp_path / "recording.h5").nodes] == ["left", "right"]
    found = metrics(tmp_path)
    assert found["worst_tracked_fraction"] >= 0.85
    assert found["rmse_m"] < 0.35


def test_too_many_people(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "through-wall", "--people", "5"]) == 2
    assert "--people: expected 0 to 4 behind a wall, found 5" in capsys.readouterr().err


@pytest.mark.parametrize(("case", "period_s"), [("sensor-radar", "0.1"), ("through-wall", "0.074")])
def test_too_short_a_run(capsys: pytest.CaptureFixture[str], case: str, period_s: str) -> None:
    assert main(["run", case, "--duration", "0.05"]) == 2
    assert f"--duration: expected at least one scan, {period_s} s, found 0.05" in capsys.readouterr().err


def test_a_plan_knows_the_sensor_radar_alone_and_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    site = tmp_path / "wall.toml"
    site.write_text(example_site("through_wall").to_toml())
    assert main(["plan", str(site), "--out", str(tmp_path / "out")]) == 2
    assert "pipeline.name: expected sensor_radar" in capsys.readouterr().err


@pytest.fixture(scope="module")
def single_receiver() -> Recording:
    scene = through_wall_scene()
    alone = replace(scene, nodes=scene.nodes[:1])
    recording = simulate_through_wall(alone, case_study_walkers(1), seed=5, duration_s=8.0)
    return replace(recording, pipeline="through_wall_2d")


@pytest.mark.parametrize("site", ["none", "inside", "of two receivers"])
def test_a_single_receiver_still_gives_its_traces(
    single_receiver: Recording, tmp_path: Path, capsys: pytest.CaptureFixture[str], site: str
) -> None:
    """511 samples of an M-sequence, one transmitter and one receiver: nothing to pair."""
    toml = example_site("through_wall").to_toml() if site == "of two receivers" else ""
    if site == "inside":
        toml = (
            "[site]\nname = 'one'\narea = [-2.6, 0.5, 2.6, 6.2]\n[[node]]\nname = 'rx1'\nid = 1\n"
            "tx_position_m = [0, 0, 1.2]\nrx_position_m = [-0.4, 0, 1.2]\n"
            "[pipeline]\nname = 'through_wall_2d'\n"
        )
    write(tmp_path / "one.h5", replace(single_receiver, site_toml=toml))
    assert main(["process", str(tmp_path / "one.h5"), "--out", str(tmp_path / "run")]) == 0
    said = capsys.readouterr().out
    assert "no positions: a position takes 2 receivers that recording and site both know, here is rx1" in said
    rows = rows_of(tmp_path / "run" / "observations.csv")
    assert list(rows[0]) == ["time_s", "node", "range_m", "weight"]
    times = np.array([float(row["time_s"]) for row in rows])
    ranges = np.array([float(row["range_m"]) for row in rows])
    person = single_receiver.truth[0]
    rx1 = single_receiver.nodes[0]
    path_m = path_behind_wall_m(person.position_m, rx1.tx_position_m, rx1.rx_position_m, Wall())
    near = np.abs(ranges - np.interp(times, person.time_s, path_m)) < 0.6
    responses = len(person.time_s)
    assert len(np.unique(times[near])) > 0.85 * (responses - SETTLED)
    assert set(metrics(tmp_path / "run")) == {"path_error_std_m"}
    assert not (tmp_path / "run" / "tracks.csv").exists()
    report = (tmp_path / "run" / "report.html").read_text()
    assert "No positions: a position takes 2 receivers" in report
    assert "responses-01-rx1.png" in {path.name for path in (tmp_path / "run" / "figures").iterdir()}
    assert main(["verify", str(tmp_path / "run" / "recording.h5")]) == 0
    assert f"{responses} frames, all bytes the same" in capsys.readouterr().out


@pytest.fixture(scope="module")
def on_the_stairs() -> Recording:
    """The first receiver's 4095 samples of somebody who climbs."""
    whole = simulate_stairs(stairs_scene(), seed=1, duration_s=6.0)
    return replace(whole, pipeline="through_wall_2d", nodes=whole.nodes[:1])


STAIRWELL = (
    "[site]\nname = 'stairs'\narea = [-1.4, 0.3, 1.4, 6.3]\n[[node]]\nname = 'rx1'\nid = 1\n"
    "tx_position_m = [0, 0, 0]\nrx_position_m = [-0.39, 0, 0]\n"
    "[pipeline]\nname = 'through_wall_2d'\n"
)


def test_of_a_long_sequence_only_the_beginning_is_kept(on_the_stairs: Recording, tmp_path: Path) -> None:
    write(tmp_path / "one.h5", replace(on_the_stairs, site_toml=STAIRWELL + "kept_samples = 700\n"))
    assert main(["process", str(tmp_path / "one.h5"), "--out", str(tmp_path / "run")]) == 0
    rows = rows_of(tmp_path / "run" / "observations.csv")
    times = np.array([float(row["time_s"]) for row in rows])
    ranges = np.array([float(row["range_m"]) for row in rows])
    person, rx1 = on_the_stairs.truth[0], on_the_stairs.nodes[0]
    path_m = path_behind_wall_m(person.position_m, rx1.tx_position_m, rx1.rx_position_m, STAIRS_WALL)
    near = np.abs(ranges - np.interp(times, person.time_s, path_m)) < 0.6
    assert len(np.unique(times[near])) > 0.85 * (len(person.time_s) - SETTLED)
    assert np.max(ranges) < 700 / 7e9 * SPEED_OF_LIGHT_MPS
    assert {path.name for path in (tmp_path / "run" / "figures").iterdir()} >= {"responses-01-rx1.png"}
    assert main(["verify", str(tmp_path / "run" / "recording.h5")]) == 0


@pytest.mark.parametrize(("kept", "key"), [("", "node rx1: "), ("kept_samples = 2000\n", "pipeline.")])
def test_a_long_sequence_of_which_too_much_is_kept_is_one_line(
    on_the_stairs: Recording, tmp_path: Path, capsys: pytest.CaptureFixture[str], kept: str, key: str
) -> None:
    write(tmp_path / "one.h5", replace(on_the_stairs, site_toml=STAIRWELL + kept))
    assert main(["process", str(tmp_path / "one.h5"), "--no-report", "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert f": {key}kept_samples: expected " in said


def test_a_dead_second_receiver_is_told_and_gives_no_position(
    run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    dead = changed(run_folder / "recording.h5", tmp_path / "dead.h5", np.zeros_like)
    processed(dead, tmp_path)
    said = capsys.readouterr().out
    assert f"rx2: dead_responses {RESPONSES} of {RESPONSES}: the same value in every sample" in said
    assert "rx1: " not in said
    assert rows_of(tmp_path / "tracks.csv") == []
    assert {row["node"] for row in rows_of(tmp_path / "observations.csv")} == {"rx1"}


def test_no_cross_talk_is_told_and_gives_no_position(
    run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def unplugged(scans: Scans) -> Scans:
        return np.random.default_rng(0).normal(0.0, 8.0, scans.shape).astype(np.float32)

    processed(changed(run_folder / "recording.h5", tmp_path / "none.h5", unplugged), tmp_path)
    count = counters(tmp_path)["rx2"]["cross_talk_missing"]
    assert count >= RESPONSES - SETTLED
    assert f"rx2: cross_talk_missing {count} of {RESPONSES}: no cross-talk" in capsys.readouterr().out
    assert rows_of(tmp_path / "tracks.csv") == []


def test_a_saturated_receiver_is_told(
    run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = run_folder / "recording.h5"
    full_scale = 1.5 * float(np.max(np.abs(read(recording).nodes[1].scans)))

    def overdriven(scans: Scans) -> None:
        scans[60:80] = np.clip(20.0 * scans[60:80], -full_scale, full_scale)

    site = tmp_path / "site.toml"
    text = example_site("through_wall").to_toml()
    name = 'name = "through_wall_2d"\n'
    site.write_text(text.replace(name, f"{name}full_scale_count = {full_scale:.6f}\n"))
    loud = changed(recording, tmp_path / "loud.h5", overdriven)
    processed(loud, tmp_path, "--site", str(site))
    assert counters(tmp_path)["rx2"]["saturated_responses"] == 20
    said = capsys.readouterr().out
    assert f"rx2: saturated_responses 20 of {RESPONSES}: too many samples at full scale" in said
    rows = rows_of(tmp_path / "observations.csv")
    observed = {round(float(row["time_s"]) / 0.074) for row in rows if row["node"] == "rx2"}
    assert not observed & set(range(60, 80))
    assert observed & set(range(80, 90))  # the background outlived it
    assert metrics(tmp_path)["rmse_m"] < 0.4


def test_a_power_up_in_the_middle_is_told_and_survived(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, site = through_wall_scene(), example_site("through_wall")
    walkers = case_study_walkers(1)
    run = simulate_through_wall(scene, walkers, seed=1, duration_s=12.0, power_up_s=(5.0,))
    write(tmp_path / "twice.h5", replace(run, site_toml=site.to_toml()))
    processed(tmp_path / "twice.h5", tmp_path)
    said = capsys.readouterr().out
    for name in ("rx1", "rx2"):
        assert f"{name}: time_zero_moved 1: the cross-talk moved as after a power-up" in said
        assert counters(tmp_path)[name]["settling_responses"] == 2 * SETTLED
    frame = round(5.0 / 0.074) + 1
    silent_s = 0.074 * np.array([frame, frame + SETTLED])
    times = np.array([float(row["time_s"]) for row in rows_of(tmp_path / "observations.csv")])
    assert not np.any((times > silent_s[0]) & (times < silent_s[1]))
    assert np.sum(times > silent_s[1]) > 60
    assert metrics(tmp_path)["rmse_m"] < 0.5  # nothing was placed by the old time zero


def test_samples_that_are_no_numbers_cost_their_responses(run_folder: Path, tmp_path: Path) -> None:
    def spoilt(scans: Scans) -> None:
        scans[50, 100], scans[51, 7] = np.nan, np.inf

    processed(changed(run_folder / "recording.h5", tmp_path / "spoilt.h5", spoilt), tmp_path)
    assert counters(tmp_path)["rx2"]["rejected_responses"] == 2
    assert counters(tmp_path)["hub"]["lost"] == 2
    assert metrics(tmp_path)["worst_tracked_fraction"] > 0.85


def test_a_truncated_recording_is_refused(
    run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cut = tmp_path / "cut.h5"
    whole = (run_folder / "recording.h5").read_bytes()
    cut.write_bytes(whole[: len(whole) // 2])
    assert main(["process", str(cut), "--no-report", "--out", str(tmp_path)]) == 2
    assert "cut.h5: expected a" in capsys.readouterr().err
