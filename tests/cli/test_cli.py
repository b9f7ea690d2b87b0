"""The command line as a user meets it: what it writes, what it says, and how it refuses."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

from echofuse.cli import main
from echofuse.recording import read
from echofuse.site import example_site


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    assert main(["run", "sensor-radar", "--seed", "3", "--no-report", "--out", str(folder)]) == 0
    return folder


def failing(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Return the message of a command that must refuse its input."""
    assert main(list(arguments)) == 2
    message = capsys.readouterr().err
    assert message.startswith("echofuse: ")
    assert "Traceback" not in message
    return message


def test_a_run_leaves_its_folder(run_folder: Path) -> None:
    metrics = json.loads((run_folder / "metrics.json").read_text())
    assert metrics["rmse_m"] < 0.15
    assert metrics["tracked_fraction"] > 0.95
    with (run_folder / "tracks.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["time_s", "track_id", "state", "x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps"]
    confirmed = [row for row in rows if row["state"] == "confirmed"]
    assert len(confirmed) > 40
    # The walk goes from right to left at 1.5 m/s.
    speeds = [float(row["vx_mps"]) for row in confirmed[10:]]
    assert -1.9 < np.mean(speeds) < -1.1


def test_verify_proves_the_replay_and_finds_a_changed_sample(
    run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    recording = run_folder / "recording.h5"
    assert main(["verify", str(recording)]) == 0
    assert "61 frames, all bytes the same" in capsys.readouterr().out
    changed = tmp_path / "changed.h5"
    changed.write_bytes(recording.read_bytes())
    with h5py.File(changed, "r+") as file:
        file["nodes/rx2/scans"][30] *= 0.5
    assert main(["verify", str(changed)]) == 1
    assert "differ" in capsys.readouterr().out


def test_process_gives_what_run_gave(run_folder: Path, tmp_path: Path) -> None:
    arguments = ["process", str(run_folder / "recording.h5"), "--no-report", "--out", str(tmp_path)]
    assert main(arguments) == 0
    assert (tmp_path / "tracks.csv").read_text() == (run_folder / "tracks.csv").read_text()


def test_a_node_that_the_site_does_not_know_is_counted(run_folder: Path, tmp_path: Path) -> None:
    site = example_site("sensor_radar")
    smaller = tmp_path / "smaller.toml"
    smaller.write_text(type(site)(**{**vars(site), "nodes": site.nodes[:5]}).to_toml())
    recording = str(run_folder / "recording.h5")
    assert main(["process", recording, "--site", str(smaller), "--no-report", "--out", str(tmp_path)]) == 0
    counters = json.loads((tmp_path / "counters.json").read_text())
    assert counters["hub"]["unknown_node"] == 61
    assert main(["verify", str(tmp_path / "recording.h5")]) == 0  # by the site that it was processed with
    assert json.loads((tmp_path / "metrics.json").read_text())["tracked_fraction"] > 0.9


def test_bad_samples_cost_their_scans_and_nothing_else(run_folder: Path, tmp_path: Path) -> None:
    spoilt = tmp_path / "spoilt.h5"
    spoilt.write_bytes((run_folder / "recording.h5").read_bytes())
    with h5py.File(spoilt, "r+") as file:
        scans = file["nodes/rx1/scans"]
        scans[20, 100] = np.nan
        scans[21, 7] = np.inf
    assert main(["process", str(spoilt), "--no-report", "--out", str(tmp_path)]) == 0
    counters = json.loads((tmp_path / "counters.json").read_text())
    assert counters["rx1"]["rejected_scans"] == 2
    assert counters["hub"]["lost"] == 2
    assert json.loads((tmp_path / "metrics.json").read_text())["tracked_fraction"] > 0.95


def test_several_pulses_make_one_frame(run_folder: Path, tmp_path: Path) -> None:
    site = tmp_path / "pulses.toml"
    site.write_text(
        example_site("sensor_radar").to_toml() + "\n[pipeline.pulse_integrator]\npulses_per_scan = 2\n"
    )
    recording = str(run_folder / "recording.h5")
    assert main(["process", recording, "--site", str(site), "--no-report", "--out", str(tmp_path)]) == 0
    counters = json.loads((tmp_path / "counters.json").read_text())["hub"]
    assert counters["frames"] == 30  # of 61 pulses; the last one waits for its second
    assert counters["accepted"] == 6 * 30
    assert counters["lost"] == counters["late"] == counters["early"] == counters["resynchronised"] == 0


def test_other_geometry_rate_and_number_of_nodes_need_a_site_file_alone(tmp_path: Path) -> None:
    """Four nodes with their own transmitters around another room, scans resampled to 12 GHz."""
    corners = [(0.0, 0.0), (7.0, 0.0), (7.0, 5.0), (0.0, 5.0)]
    nodes = "".join(
        f'[[node]]\nname = "n{number}"\nid = {number}\ntime_zero = "recorded"\n'
        f"tx_position_m = [{x}, {y}, 1.0]\nrx_position_m = [{x + 0.2}, {y}, 1.0]\n"
        for number, (x, y) in enumerate(corners, start=11)
    )
    settings = (
        '[pipeline]\nname = "sensor_radar"\n[pipeline.clutter]\nmethod = "empty_room_scan"\n'
        "[pipeline.ellipse]\nbody_radius_m = 0.2\n"
    )
    site = tmp_path / "room.toml"
    site.write_text('[site]\nname = "another room"\narea = [0.0, 0.0, 7.0, 5.0]\n' + nodes + settings)
    assert main(["run", str(site), "--no-report", "--out", str(tmp_path / "fast")]) == 0
    recording = read(tmp_path / "fast" / "recording.h5")
    slower = tmp_path / "slower.h5"
    _resample(tmp_path / "fast" / "recording.h5", slower, 12e9)
    assert main(["process", str(slower), "--no-report", "--out", str(tmp_path / "slow")]) == 0
    for folder in ("fast", "slow"):
        metrics = json.loads((tmp_path / folder / "metrics.json").read_text())
        assert metrics["tracked_fraction"] > 0.9, folder
        assert metrics["rmse_m"] < 0.3, folder
    assert len(recording.nodes) == 4


def test_refusals_name_file_key_and_what_was_expected(
    run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "SITE.toml" in failing(capsys, "run", "no-such-case")
    assert "missing.h5" in failing(capsys, "process", str(tmp_path / "missing.h5"))
    text = tmp_path / "text.h5"
    text.write_text("not a recording")
    assert "text.h5" in failing(capsys, "process", str(text))
    site = tmp_path / "site.toml"
    good = example_site("sensor_radar").to_toml()
    site.write_text(good + "\n[pipeline.cfra]\nlocal_factor = 3.0\n")
    message = failing(capsys, "process", str(run_folder / "recording.h5"), "--site", str(site))
    assert "site.toml: pipeline.cfra" in message
    assert "cfar" in message
    assert "outputs" in failing(capsys, "verify", _without_outputs(run_folder, tmp_path))
    walk = example_site("p410_triangle").to_toml()
    site.write_text(walk)
    message = failing(capsys, "process", str(run_folder / "recording.h5"), "--site", str(site))
    assert "expected ids of the recording's nodes" in message


def test_a_reader_who_leaves_early_sees_no_traceback(tmp_path: Path) -> None:
    site = tmp_path / "site.toml"
    site.write_text(example_site("sensor_radar").to_toml())
    command = [sys.executable, "-u", "-m", "echofuse.cli", "plan", str(site), "--out", str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait() == 1


def test_plan_draws_the_site(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    site = tmp_path / "site.toml"
    site.write_text(example_site("sensor_radar").to_toml())
    assert main(["plan", str(site), "--out", str(tmp_path)]) == 0
    assert (tmp_path / "plan.png").stat().st_size > 20_000
    metrics = json.loads((tmp_path / "metrics.json").read_text())
    assert 0.9 < metrics["covered_fraction"] <= 1.0
    assert 0.02 < metrics["position_error_bound_p50_m"] < 0.06
    assert "position_error_bound_p50_m" in capsys.readouterr().out


def _without_outputs(run_folder: Path, tmp_path: Path) -> str:
    stripped = tmp_path / "stripped.h5"
    stripped.write_bytes((run_folder / "recording.h5").read_bytes())
    with h5py.File(stripped, "r+") as file:
        del file["outputs"]
    return str(stripped)


def _resample(source: Path, target: Path, sample_rate_hz: float) -> None:
    """Write a recording again as a slower sampler would have made it (band-limited, by FFT)."""
    from dataclasses import replace

    from scipy.signal import resample

    from echofuse.recording import write

    recording = read(source)
    nodes = []
    for node in recording.nodes:
        n_samples = round(node.scans.shape[1] * sample_rate_hz / node.sample_rate_hz)
        assert node.reference is not None
        nodes.append(
            replace(
                node,
                sample_rate_hz=n_samples / node.scans.shape[1] * node.sample_rate_hz,
                scans=resample(node.scans, n_samples, axis=1).astype(np.float32),
                reference=resample(node.reference, n_samples, axis=1).astype(np.float32),
            )
        )
    write(target, replace(recording, nodes=tuple(nodes), outputs=None))


def test_a_run_with_faults_tells_them_and_can_be_verified(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    faults = tmp_path / "mine.toml"
    faults.write_text("[link]\nloss = 0.1\n")
    arguments = ["run", "sensor-radar", "--no-report", "--faults", str(faults), "--out", str(tmp_path)]
    assert main(arguments) == 0
    said = capsys.readouterr().out
    assert "every fault is accounted for, and no other counter moved" in said
    with (tmp_path / "injections.csv").open() as file:
        rows = list(csv.DictReader(file))
    hub = json.loads((tmp_path / "counters.json").read_text())["hub"]
    assert len(rows) == hub["lost"] > 10
    assert {row["kind"] for row in rows} == {"link.loss"}
    emulated = read(tmp_path / "recording.h5").emulated
    assert emulated is not None
    assert (emulated.scenario, emulated.seed) == ("mine", 0)
    assert main(["verify", str(tmp_path / "recording.h5")]) == 0
    assert "61 frames, all bytes the same" in capsys.readouterr().out
    faults.write_text("[link]\nlos = 0.1\n")
    assert "mine.toml: link.los: expected a known key (did you mean loss?)" in failing(capsys, *arguments)
    assert "lost" in failing(capsys, "run", "sensor-radar", "--faults", "no-such-scenario")


def test_too_few_receivers_for_positions_still_give_their_ranges(
    run_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lonely = tmp_path / "lonely.h5"
    lonely.write_bytes((run_folder / "recording.h5").read_bytes())
    with h5py.File(lonely, "r+") as file:
        for number in range(2, 7):
            del file[f"nodes/rx{number}"]
        del file["outputs"]
    assert main(["process", str(lonely), "--out", str(tmp_path / "run")]) == 0
    said = capsys.readouterr().out
    assert "no positions: a position takes 3 receivers that recording and site both know, here is rx1" in said
    with (run_folder / "observations.csv").open() as file:
        expected = [row for row in csv.DictReader(file) if row["node"] == "rx1"]
    with (tmp_path / "run" / "observations.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["time_s", "node", "range_m", "weight"]
    assert rows == expected
    assert len(rows) > 30
    metrics = json.loads((tmp_path / "run" / "metrics.json").read_text())
    assert list(metrics) == ["path_error_std_m"]
    assert not (tmp_path / "run" / "tracks.csv").exists()
    assert "here is rx1" in (tmp_path / "run" / "report.html").read_text()
    assert main(["verify", str(tmp_path / "run" / "recording.h5")]) == 0
    assert "61 frames, all bytes the same" in capsys.readouterr().out
    message = failing(capsys, "process", str(lonely), "--target", "process")
    assert "node: expected enough nodes for a hub" in message


def test_a_recording_of_one_receiver_needs_no_site(run_folder: Path, tmp_path: Path) -> None:
    lonely = tmp_path / "lonely.h5"
    lonely.write_bytes((run_folder / "recording.h5").read_bytes())
    with h5py.File(lonely, "r+") as file:
        for number in range(2, 7):
            del file[f"nodes/rx{number}"]
        del file["site"]
    assert main(["process", str(lonely), "--no-report", "--out", str(tmp_path / "run")]) == 0
    with (tmp_path / "run" / "observations.csv").open() as file:
        assert len(list(csv.DictReader(file))) > 30
