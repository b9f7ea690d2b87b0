"""A user's board: a node's firmware behind a TCP port and behind a serial line, by its own clock."""

import os
import pty
import select
import socket
import subprocess
import threading
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from ledger import Ledger

from echofuse.cli import main
from echofuse.conformance.choices import Choice
from echofuse.conformance.comparison import Scoreboard
from echofuse.conformance.firmware_target import FirmwareConformanceTarget
from echofuse.conformance.inputs import simulated_inputs
from echofuse.conformance.node_taps import NODE_TAPS, conform_node
from echofuse.emulation.run import emulate
from echofuse.emulation.scenario_file import parse_scenario
from echofuse.emulation.targets import firmware_image, port
from echofuse.errors import TargetError
from echofuse.pipeline import process_recording
from echofuse.recording import Recording
from echofuse.result import RunResult
from echofuse.simulation.scene import sensor_radar_scene
from echofuse.simulation.sensor_radar import case_study_people, simulate
from echofuse.site import example_site

SITE = example_site("sensor_radar")
NODE_ID = 3
Spoil = Callable[[bytes], bytes]


class Wire:
    """Joins two ends in a thread of its own; may spoil what the board says, or say nothing any more."""

    def __init__(self, ends: Callable[[], tuple[int, int]]) -> None:
        self.spoil: Spoil = lambda data: data
        self._ends = ends  # files: the board's, the harness's
        self._open = True
        self._thread = threading.Thread(target=self._carry, daemon=True)
        self._thread.start()

    def _carry(self) -> None:
        try:
            board, harness = self._ends()
            while self._open:
                for ready in select.select([board, harness], [], [], 0.05)[0]:
                    data = os.read(ready, 4096)
                    if not data:
                        return
                    rest = self.spoil(data) if ready == board else data
                    while rest:
                        rest = rest[os.write(harness if ready == board else board, rest) :]
        except OSError:  # an end has left
            return

    def close(self) -> None:
        self._open = False
        self._thread.join()


class Place(NamedTuple):
    """Where a board is, for who wants to drive it."""

    address: str
    wire: Wire
    board: subprocess.Popen[bytes]


def started(link: str, image: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [str(firmware_image("process", image)), "--node-id", str(NODE_ID), "--link", link]
    )


@contextmanager
def behind_tcp(image: str = "sensor_radar_node") -> Iterator[Place]:
    """The board joins one socket and the harness another, as at a terminal server."""
    with ExitStack() as stack:
        servers = [stack.enter_context(socket.create_server(("127.0.0.1", 0))) for _ in range(2)]
        for server in servers:
            server.settimeout(20.0)
        inner, outer = (server.getsockname()[1] for server in servers)

        def ends() -> tuple[int, int]:
            board, harness = (stack.enter_context(server.accept()[0]) for server in servers)
            return board.fileno(), harness.fileno()

        board = started(f"tcp:127.0.0.1:{inner}", image)
        wire = Wire(ends)
        try:
            yield Place(f"tcp://127.0.0.1:{outer}", wire, board)
        finally:
            board.kill()
            board.wait()
            wire.close()


@contextmanager
def behind_serial(image: str = "sensor_radar_node") -> Iterator[Place]:
    """A line of two pseudo-terminals."""
    (near, board_side), (far, harness_side) = pty.openpty(), pty.openpty()
    tty.setraw(board_side)
    tty.setraw(harness_side)
    board = started(f"serial:{os.ttyname(board_side)}", image)
    wire = Wire(lambda: (near, far))
    try:
        yield Place(f"serial:{os.ttyname(harness_side)}@921600", wire, board)
    finally:
        board.kill()
        board.wait()
        wire.close()
        for file in (near, board_side, far, harness_side):
            os.close(file)


PLACES = {"tcp": behind_tcp, "serial": behind_serial}


@pytest.fixture(params=sorted(PLACES))
def place(request: pytest.FixtureRequest) -> Iterator[Place]:
    with PLACES[request.param]() as opened:
        yield opened


@pytest.fixture(scope="module")
def walk() -> Recording:
    return simulate(sensor_radar_scene(), case_study_people(1), seed=3)


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(port, "IDENTIFY_S", 1.5)
    monkeypatch.setattr(port, "ANSWER_S", 0.5)


def test_every_decision_is_that_of_this_process(walk: Recording, place: Place) -> None:
    result = process_recording(walk, SITE, target=place.address)
    assert result.metrics["scans_that_differ"] == 0
    assert result.metrics["frames_that_differ"] == 0
    assert result.metrics["position_difference_m"] == 0.0
    here = process_recording(walk, SITE)
    np.testing.assert_array_equal(result.outputs().frame_hash, here.outputs().frame_hash)
    assert result.counters["rx3"]["scans"] == 61
    assert result.counters["rx3"]["rejected_scans"] == 0
    assert result.counters[place.address] == {}


@pytest.mark.slow
def test_a_bare_cortex_m7_behind_its_uart(walk: Recording) -> None:
    """Without a front-end, nobody steps it: scans, registers and reports go through the UART.

    Its clock is the host's here: counted by instructions, a second between two heartbeats may take any time.
    """
    few = replace(walk, nodes=tuple(replace(n, scans=n.scans[:6], time_s=n.time_s[:6]) for n in walk.nodes))
    with socket.create_server(("127.0.0.1", 0)) as free:
        number = free.getsockname()[1]
    command = ["qemu-system-arm", "-M", "mps2-an500", "-display", "none", "-monitor", "none"]
    command += ["-semihosting-config", "enable=on,target=native"]
    command += [
        "-kernel",
        str(firmware_image("cortex-m7", "sensor_radar_node")),
        "-append",
        f"--node-id {NODE_ID}",
    ]
    command += ["-serial", f"tcp:127.0.0.1:{number},server=on,wait=off"]
    with subprocess.Popen(command, stdin=subprocess.DEVNULL) as emulator:
        try:
            result = once_listening(lambda: process_recording(few, SITE, target=f"tcp://127.0.0.1:{number}"))
        finally:
            emulator.kill()
    assert result.metrics["scans_that_differ"] == 0
    assert result.counters["rx3"]["scans"] == 6


def once_listening(run: Callable[[], RunResult]) -> RunResult:
    for _ in range(50):
        try:
            return run()
        except TargetError as error:
            if "refused" not in str(error):
                raise
            time.sleep(0.1)
    raise AssertionError("the emulator does not listen")


def test_taps_come_over_the_line(place: Place) -> None:
    board = Scoreboard()
    with closing(FirmwareConformanceTarget(place.address)) as target:
        conform_node(board, Choice(name="default"), target, list(simulated_inputs(1)))
    assert [row.tap for row in board.rows() if row.passed] == list(NODE_TAPS)


def test_a_disturbed_line_is_counted_and_the_run_goes_on(walk: Recording, place: Place) -> None:
    """Garbage between the board's frames, whose own bytes arrive whole."""
    place.wire.spoil = lambda data: data + b"\0\x05ab\0" if data.endswith(b"\0") else data
    result = process_recording(walk, SITE, target=place.address)
    assert result.metrics["scans_that_differ"] == 0
    assert list(result.counters[place.address]) == ["bad_cobs"]
    assert result.counters[place.address]["bad_cobs"] > 50


@pytest.mark.usefixtures("impatient")
def test_a_board_that_falls_silent_is_named_with_what_was_waited_for(
    walk: Recording, place: Place, injected: Ledger
) -> None:
    injected.breaks_off()
    said = 0

    def spoil(data: bytes) -> bytes:
        nonlocal said
        said += len(data)
        return data if said < 4_000 else b""

    place.wire.spoil = spoil
    with pytest.raises(
        TargetError, match=r"rx3 \(.*no answer for 1.5 s to (scan \d+|the register|\d+ bytes)"
    ):
        process_recording(walk, SITE, target=place.address)


@pytest.mark.usefixtures("impatient")
def test_a_board_that_ends_is_named(walk: Recording) -> None:
    with behind_serial() as place:
        place.board.kill()
        with pytest.raises(TargetError, match=r"nobody there: no heartbeat for 1.5 s"):
            process_recording(walk, SITE, target=place.address)


@pytest.mark.usefixtures("impatient")
def test_a_hub_is_no_node(walk: Recording) -> None:
    with (
        behind_tcp("sensor_radar_hub") as place,
        pytest.raises(TargetError, match=r"calls itself echofuse.sensor_radar.hub"),
    ):
        process_recording(walk, SITE, target=place.address)


def test_faults_hold_for_a_board_of_ones_own(walk: Recording, place: Place, injected: Ledger) -> None:
    scenario = parse_scenario('[link]\nloss = 0.1\n[[fault]]\nkind = "silent"\nnode = "rx3"\nat_s = 4.0\n')
    there, here = (emulate(walk, SITE, scenario, 5, target) for target in (place.address, "inprocess"))
    assert there.emulation is not None
    assert there.emulation.account.problems == []
    injected("hub", **{name: there.counters["hub"][name] for name in ("lost", "absent")})
    assert there.tracks.tobytes() == here.tracks.tobytes()


def test_a_board_of_ones_own_is_not_switched_off(walk: Recording, place: Place, injected: Ledger) -> None:
    injected.breaks_off()
    scenario = parse_scenario('[[fault]]\nkind = "restart"\nnode = "rx3"\nat_s = 1.0\n')
    with pytest.raises(TargetError, match=r"the board there cannot be switched off and on from here"):
        emulate(walk, SITE, scenario, 0, place.address)


def test_the_command_line_drives_it(place: Place, tmp_path: Path) -> None:
    arguments = ["run", "sensor-radar", "--target", place.address, "--no-report", "--out", str(tmp_path)]
    assert main(arguments) == 0
    assert (tmp_path / "tracks.csv").is_file()


@pytest.mark.parametrize("target", ["tcp://127.0.0.1", "tcp://:1", "serial:", "serial:/dev/x@fast", "m7"])
def test_an_address_that_is_none_is_told(target: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["run", "sensor-radar", "--target", target])
    assert ended.value.code == 2
    assert "expected inprocess, process, cortex-m7, tcp://HOST:PORT or serial:DEVICE[@BAUD]" in (
        capsys.readouterr().err
    )


@pytest.mark.parametrize(
    ("target", "said"),
    [("tcp://127.0.0.1:1", "connection refused"), ("serial:/nobody/here", "no such file or directory")],
)
def test_an_address_without_a_board_is_one_line(
    target: str, said: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    arguments = ["run", "sensor-radar", "--target", target, "--no-report", "--out", str(tmp_path)]
    assert main(arguments) == 1
    assert capsys.readouterr().err.splitlines() == [f"echofuse: {target}: cannot be opened: {said}"]
