"""The firmware on its targets: the decisions of this process, over the real link; and boards that fail.

`make test` builds both kinds of image before: a missing one is an error here.
"""

import os
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from ledger import Ledger

from echofuse.cases import simulated
from echofuse.cli import main
from echofuse.emulation import codec
from echofuse.emulation.firmware import HUB_ID, Machine
from echofuse.emulation.lockstep import Board, BoardError
from echofuse.emulation.targets import FIRMWARE_TARGETS, firmware_image, open_board
from echofuse.errors import TargetError
from echofuse.pipeline import process_recording
from echofuse.recording import Recording
from echofuse.site import example_site

SITE = example_site("sensor_radar")
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def recording() -> Recording:
    from echofuse.simulation.scene import sensor_radar_scene
    from echofuse.simulation.sensor_radar import case_study_people, simulate

    return simulate(sensor_radar_scene(), case_study_people(1), seed=3)


@pytest.fixture(params=FIRMWARE_TARGETS)
def node(request: pytest.FixtureRequest) -> Iterator[Machine]:
    with open_board(request.param, "sensor_radar_node", "rx1", 1) as board:
        yield Machine(board, 1)


@pytest.mark.slow
@pytest.mark.parametrize("target", FIRMWARE_TARGETS)
def test_every_decision_is_that_of_this_process(recording: Recording, target: str) -> None:
    result = process_recording(recording, SITE, target=target)
    assert result.metrics["scans_that_differ"] == 0
    assert result.metrics["frames_that_differ"] == 0
    assert result.metrics["position_difference_m"] <= 1e-3
    here = process_recording(recording, SITE)
    assert np.array_equal(result.outputs().frame_hash, here.outputs().frame_hash)
    shared = set(here.counters["hub"]) & set(result.counters["hub"])
    assert {"accepted", "lost", "unknown_node", "frames"} <= shared
    assert {name: result.counters["hub"][name] for name in shared} == {
        name: here.counters["hub"][name] for name in shared
    }


@pytest.mark.slow
@pytest.mark.parametrize("target", FIRMWARE_TARGETS)
def test_every_decision_in_space_is_that_of_this_process(target: str) -> None:
    """The last seconds of 5 s are in the tables: the climber is tracked, and has a height."""
    stairs = example_site("stairs")
    climb = simulated(stairs, "stairs", 1, seed=0, duration_s=5.0)
    there, here = process_recording(climb, stairs, target=target), process_recording(climb, stairs)
    assert (there.metrics["scans_that_differ"], there.metrics["frames_that_differ"]) == (0, 0)
    assert there.metrics["position_difference_m"] <= 1e-3
    assert np.array_equal(there.outputs().frame_hash, here.outputs().frame_hash)
    assert len(there.tracks) > 10
    assert np.ptp(there.tracks["z_m"]) > 0.1
    shared = set(here.counters["hub"]) & set(there.counters["hub"])
    assert {"couples", "quads", "clipped", "unlocated", "outside_area"} <= shared
    assert {name: there.counters["hub"][name] for name in shared} == {
        name: here.counters["hub"][name] for name in shared
    }


@pytest.mark.slow
def test_two_runs_on_the_cortex_m7_take_the_same_instructions(recording: Recording) -> None:
    first, second = (process_recording(recording, SITE, target="cortex-m7").metrics for _ in range(2))
    assert first == second
    assert first["instructions_max"] <= 520_000
    assert first["hub_instructions_max"] <= 4_000_000
    assert first["deadlines_missed"] == 0


@pytest.mark.slow
def test_a_run_that_is_too_slow_for_its_radar_fails(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    arguments = ["run", "sensor-radar", "--target", "cortex-m7", "--clock-mhz", "1", "--no-report"]
    assert main([*arguments, "--out", str(tmp_path)]) == 1
    assert "took longer than the radar's frame period" in capsys.readouterr().out


def test_a_node_says_what_it_is_given_and_keeps_its_own_id(node: Machine, injected: Ledger) -> None:
    injected("rx1", link_refused_writes=1)
    assert node.write_register("cfar.global_factor", 6.5) == 6.5
    assert node.read_register("cfar.global_factor") == 6.5
    assert node.write_register("uavcan.node.id", np.uint16(77)) == 1


def test_an_impossible_configuration_is_not_put_in_force(node: Machine) -> None:
    node.write_register("sample_rate_hz", -1.0)
    node.write_register("echofuse.apply", False)
    node.step(1)
    assert node.write_register("echofuse.apply", True) in (True, False)
    node.step(1)
    assert node.read_register("echofuse.apply") is False


def test_a_scan_of_the_wrong_length_is_counted_and_the_next_is_processed(
    node: Machine, injected: Ledger
) -> None:
    injected("rx1", rejected_scans=1, direct_path_missing=1)
    scan = np.zeros(1920, np.float32)
    _, transfers = node.step(10, scan=scan[:100])
    assert [t for t in transfers if t.port == codec.DETECTIONS] == []
    _, transfers = node.step(20, scan=scan, scan_time_us=20)
    (report,) = [t for t in transfers if t.port == codec.DETECTIONS]
    assert (report.source, report.transfer_id) == (1, 0)


def test_garbage_on_the_link_is_counted_and_what_follows_is_answered(node: Machine, injected: Ledger) -> None:
    injected("rx1", link_bad_cobs=1)
    node.step(1, b"\0" + bytes(range(1, 200)) + b"\0")
    assert node.read_register("uavcan.node.id") == 1


@pytest.mark.parametrize("target", FIRMWARE_TARGETS)
def test_a_hub_without_nodes_is_not_operational_until_it_has_some(target: str) -> None:
    with open_board(target, "sensor_radar_hub", "hub", HUB_ID) as board:
        hub = Machine(board, HUB_ID)
        _, transfers = hub.step(1)
        modes = [t.payload[5] for t in transfers if t.port == codec.HEARTBEAT]
        from echofuse.pipeline import hub_config

        hub.configure(hub_config(SITE))
        _, transfers = hub.step(3_000_000)
        modes += [t.payload[5] for t in transfers if t.port == codec.HEARTBEAT]
    assert modes[0] == 1
    assert modes[-1] == 0


def test_a_board_that_ends_is_named_with_what_was_waited_for(injected: Ledger) -> None:
    injected.ends_unheard("rx4")
    board = open_board("process", "sensor_radar_node", "rx4", 4)
    os.kill(board._process.pid, signal.SIGKILL)
    with pytest.raises(BoardError, match=r"rx4 \(process\): ended with status -9 while .* step 1"):
        board.step(5)
    board.close()


def test_a_board_that_hangs_is_named_and_what_was_heard_last(injected: Ledger) -> None:
    injected.ends_unheard("rx5")
    board = open_board("process", "sensor_radar_node", "rx5", 5)
    board._patience_s = 1.0
    os.kill(board._process.pid, signal.SIGSTOP)
    with pytest.raises(
        BoardError, match=r"rx5 .*no answer for 1 s .*step 1 .*heard last: trace 0/0 of step 0"
    ):
        board.step(5)
    board.close()


def test_a_program_that_is_no_board_is_told() -> None:
    with pytest.raises(
        BoardError, match="ended with status 0 while the emulation waited for to join the link"
    ):
        Board("nobody", lambda places: ["true"], patience_s=5.0)


def test_a_missing_image_is_one_line(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("ECHOFUSE_FIRMWARE", str(tmp_path))
    with pytest.raises(
        TargetError, match=r"sensor_radar_node\.elf: expected a firmware image .*make firmware"
    ):
        firmware_image("cortex-m7", "sensor_radar_node")


def includes(*folders: Path) -> list[str]:
    return [
        *(f"-I{folder}" for folder in (ROOT / "cpp/include", *folders)),
        "-isystem",
        "/usr/include/eigen3",
    ]


def test_an_exported_site_compiles_and_is_the_site(tmp_path: Path) -> None:
    header = tmp_path / "site_config.hpp"
    site = ROOT / "python/echofuse/sites/sensor_radar_several.toml"
    assert main(["export-config", str(site), "--out", str(header)]) == 0
    program = """
      #include "site_config.hpp"
      int main() {
        echofuse::node::SensorRadarNodeConfig c;
        if (echofuse::site::node_config(99, c) || !echofuse::site::node_config(4, c)) return 1;
        if (c.node_id != 4 || c.cfar.global_factor != 4.0f) return 2;
        return c.clutter.method == echofuse::node::ClutterMethod::kEmptyRoomShadowed ? 0 : 3;
      }"""
    binary = tmp_path / "check"
    command = ["g++", "-std=c++17", *includes(tmp_path), "-x", "c++", "-", "-o", str(binary)]
    subprocess.run(command, input=program, text=True, check=True, capture_output=True)
    assert subprocess.run([binary], check=False).returncode == 0


@pytest.mark.parametrize("pipeline", ["SensorRadar", "ThroughWall"])
@pytest.mark.parametrize("role", ["node", "hub"])
@pytest.mark.parametrize(
    ("site", "of"), [("sensor_radar_several", "SensorRadar"), ("through_wall", "ThroughWall")]
)
def test_every_firmware_compiles_with_a_site_and_takes_that_of_its_own_pipeline(
    site: str, of: str, role: str, pipeline: str, tmp_path: Path
) -> None:
    """A build makes all images with one site: those of other pipelines have none compiled in."""
    header, compiled = tmp_path / "site_config.hpp", tmp_path / "firmware.o"
    file = ROOT / f"python/echofuse/sites/{site}.toml"
    assert main(["export-config", str(file), "--out", str(header)]) == 0
    command = ["g++", "-std=c++17", "-O0", "-c", *includes(tmp_path, ROOT / "firmware_sim")]
    command += ['-DECHOFUSE_SITE_CONFIG="site_config.hpp"', f"-DECHOFUSE_PIPELINE={pipeline}"]
    source = ROOT / f"firmware_sim/{role}_firmware.cpp"
    subprocess.run([*command, str(source), "-o", str(compiled)], check=True, capture_output=True)
    # An inline function is there if somebody calls it.
    assert (f"{role}_config".encode() in compiled.read_bytes()) == (pipeline == of)
