"""PyCyphal, in a process of its own, joins the link of a running site: it reads all, and writes a register.

The bytes are the firmware's own; the test only carries them between the boards and a socket.
"""

import json
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from echofuse import _core
from echofuse.emulation.firmware import HUB_ID, FirmwareRadar
from echofuse.emulation.lockstep import Board, StepOutput
from echofuse.emulation.targets import FIRMWARE_TARGETS, open_board
from echofuse.pipeline import hub_config, node_config, scans_in_time_order
from echofuse.recording import Recording
from echofuse.site import example_site

CLIENT = Path(__file__).with_name("cyphal_client.py")
DSDL = Path(__file__).parents[2] / "cpp" / "dsdl"
NODE_ID = 1
SITE = example_site("sensor_radar")
N_FRAMES = 25  # until a walker's track has begun
PATIENCE_S = 90.0


class Bus:
    """A socket that one client joins, as a serial adapter would be: it hears all boards, and all hear it."""

    def __init__(self) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.settimeout(PATIENCE_S)
        self.port = self._listener.getsockname()[1]
        self._client: socket.socket | None = None
        self.boards: list[TappedBoard] = []

    def accept(self) -> None:
        """Wait for the client."""
        self._client, _ = self._listener.accept()
        self._client.setblocking(False)

    def hear(self, link: bytes) -> None:
        """Give a board's bytes to the client, and take what the client has for the boards."""
        if self._client is None:
            return
        try:
            self._client.setblocking(True)
            self._client.sendall(link)
            self._client.setblocking(False)
            asked = self._client.recv(65536)
        except (BlockingIOError, ConnectionError):  # it asks nothing, or has left with what it wanted
            return
        for board in self.boards:
            board.waiting += asked

    def close(self) -> None:
        """Hang up."""
        self._listener.close()
        if self._client is not None:
            self._client.close()


class TappedBoard:
    """A board whose link the bus shares."""

    def __init__(self, board: Board, bus: Bus) -> None:
        self._board, self._bus = board, bus
        self.waiting = b""
        bus.boards.append(self)

    def step(self, now_us: int, link: bytes = b"", **rest: Any) -> StepOutput:
        asked, self.waiting = self.waiting, b""
        output = self._board.step(now_us, asked + link, **rest)
        self._bus.hear(output.link)
        return output

    def __getattr__(self, name: str) -> Any:
        return getattr(self._board, name)


@pytest.fixture(scope="module")
def compiled_dsdl(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dsdl")
    subprocess.run([sys.executable, CLIENT, "compile", DSDL, folder], check=True, timeout=PATIENCE_S)
    return folder


@pytest.fixture(scope="module")
def recording() -> Recording:
    from echofuse.simulation.scene import sensor_radar_scene
    from echofuse.simulation.sensor_radar import case_study_people, simulate

    return simulate(sensor_radar_scene(), case_study_people(1), seed=3)


@pytest.fixture
def bus() -> Iterator[Bus]:
    bus = Bus()
    yield bus
    bus.close()


@pytest.fixture(params=FIRMWARE_TARGETS)
def radar(request: pytest.FixtureRequest, bus: Bus) -> Iterator[FirmwareRadar]:
    target = request.param

    def open_tapped(role: str, name: str, node_id: int) -> TappedBoard:
        return TappedBoard(open_board(target, f"sensor_radar_{role}", name, node_id), bus)

    radar = FirmwareRadar(open_tapped)  # type: ignore[arg-type]
    yield radar
    radar.close()


def configure(radar: FirmwareRadar, recording: Recording) -> None:
    """Start the nodes, and write the site to all boards."""
    radar.hub.configure(hub_config(SITE))
    places = {place.id: place for place in SITE.nodes}
    for source in recording.nodes:
        empty_room = [] if source.reference is None else list(source.reference)
        radar.add_node(
            source.name, source.node_id, node_config(SITE, places[source.node_id], source), empty_room
        )


def run(radar: FirmwareRadar, recording: Recording, client: "subprocess.Popen[str]") -> dict[Any, Any]:
    """Let the site work through some frames, and on until the client has all; the nodes' reports."""
    reports = {}
    for scan in scans_in_time_order(recording.nodes)[: N_FRAMES * len(recording.nodes)]:
        source = recording.nodes[scan.node]
        samples = np.ascontiguousarray(source.scans[scan.index], np.float32)
        reports[source.node_id, scan.time_us] = radar.scan(source.node_id, samples, scan.time_us)
    now_us, deadline = scan.time_us, time.monotonic() + PATIENCE_S
    while client.poll() is None and time.monotonic() < deadline:
        now_us += 50_000
        radar.deliver(b"", now_us)
        radar.nodes[NODE_ID].step(now_us)
        time.sleep(0.002)  # else the site would live through days
    return reports


@pytest.mark.slow
def test_pycyphal_reads_a_running_site_and_writes_a_register(
    radar: FirmwareRadar, recording: Recording, compiled_dsdl: Path, bus: Bus
) -> None:
    configure(radar, recording)
    arguments = ["listen", compiled_dsdl, *map(str, (bus.port, NODE_ID, HUB_ID))]
    with subprocess.Popen(
        [sys.executable, CLIENT, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as client:
        try:
            assert client.stdout is not None
            bus.accept()
            first = client.stdout.readline()
            assert first == "ready\n", first + client.stdout.read()
            reports = run(radar, recording, client)
            said = client.stdout.read()
        finally:
            client.kill()
    assert client.returncode == 0, said
    heard = json.loads(said.splitlines()[-1])
    check_reports(heard, reports)
    check_tracks(heard, radar)
    check_registers(heard["registers"])
    assert heard["name"] == "echofuse.sensor_radar.node"
    beats = [beat["message"] for beat in heard["heartbeat"]]
    assert all(beat["health"]["value"] == 0 and beat["mode"]["value"] == 0 for beat in beats)
    assert all(
        beat["message"]["previous_transmission_timestamp_microsecond"] >= 0
        for beat in heard["synchronization"]
    )


def check_reports(heard: dict[str, Any], reports: dict[Any, Any]) -> None:
    """Every report that PyCyphal read is the node's, number by number."""
    assert len(heard["detections"]) >= N_FRAMES
    for item in heard["detections"]:
        rows = reports[item["source"], item["message"]["time_us"]]
        assert [echo["delay"] for echo in item["message"]["detections"]] == rows["delay_s"].tolist()
        assert [echo["weight"] for echo in item["message"]["detections"]] == rows["weight"].tolist()


def check_tracks(heard: dict[str, Any], radar: FirmwareRadar) -> None:
    """Every frame's tracks that PyCyphal read are the hub's."""
    frames = {frame: rows for _, frame, rows in radar.take_tracks()}
    for item in heard["tracks"]:
        assert item["source"] == HUB_ID
        rows = frames[item["transfer_id"]]
        assert item["message"]["frame"] == item["transfer_id"]
        assert [track["id"] for track in item["message"]["tracks"]] == rows["id"].tolist()
        assert [track["position"][0] for track in item["message"]["tracks"]] == rows["x_m"].tolist()


def check_registers(said: dict[str, Any]) -> None:
    """All registers are there, a write is read back, and the board's own is left alone."""
    assert {*_core.node_registers(), "uavcan.node.id", "uavcan.pub.detections.id"} <= set(said["names"])
    assert said["before"]["mutable"]
    assert not said["before"]["persistent"]
    assert said["written"]["value"] == {"real32": {"value": [4.5]}}
    assert said["restored"]["value"] == said["before"]["value"]
    assert not said["refused"]["mutable"]
    assert said["refused"]["value"] == {"natural16": {"value": [NODE_ID]}}
