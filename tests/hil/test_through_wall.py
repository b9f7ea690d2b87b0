"""Through-wall receivers and their hub on their images: what this process says, byte for byte."""

from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from ledger import OF_TROUBLE, Ledger
from test_ports import PLACES

from echofuse import _core
from echofuse.conformance.choices import THROUGH_WALL_NODE_CHOICES
from echofuse.conformance.comparison import Scoreboard
from echofuse.conformance.firmware_target import FirmwareConformanceTarget
from echofuse.conformance.through_wall_inputs import simulated_responses
from echofuse.conformance.through_wall_taps import THROUGH_WALL_NODE_TAPS, conform_through_wall_node
from echofuse.emulation import codec
from echofuse.emulation.firmware import HUB_ID
from echofuse.emulation.firmware import Machine as Board
from echofuse.emulation.machine import Machine, ScanInput
from echofuse.emulation.targets import FIRMWARE_TARGETS, BoardOpener
from echofuse.emulation.targets.firmware import FirmwareMachine
from echofuse.emulation.targets.inprocess import InProcessHub, InProcessNode
from echofuse.errors import TargetError
from echofuse.recording import NodeRecording
from echofuse.simulation.through_wall import simulate_through_wall
from echofuse.simulation.through_wall_scene import case_study_walkers, through_wall_scene

PERIOD_US = 74_000
DEAD = slice(40, 43)  # responses of the second receiver
Configure = Callable[
    [str, NodeRecording | None, Any], Machine
]  # role, the receiver if it is one, configuration


@dataclass
class Said:
    """What a run put on the link, report by report and frame by frame, and what its machines counted."""

    detections: list[codec.Transfer]
    tracks: list[codec.Transfer]
    counters: dict[str, dict[str, int]]


@pytest.fixture(scope="module")
def receivers() -> tuple[NodeRecording, ...]:
    """Two people for seven seconds; the second receiver is dead for a moment."""
    scene, people = through_wall_scene(), case_study_walkers(2)
    first, second = simulate_through_wall(scene, people, seed=3, duration_s=7.0).nodes
    scans = second.scans.copy()
    scans[DEAD] = 0.0
    return replace(first, node_id=3), replace(second, node_id=4, scans=scans)


@pytest.fixture(scope="module")
def here(receivers: tuple[NodeRecording, ...]) -> Said:
    return run(receivers, in_this_process)


def in_this_process(role: str, receiver: NodeRecording | None, config: Any) -> Machine:
    machine = _core.ThroughWallHub() if receiver is None else _core.ThroughWallNode()
    assert machine.configure(config) == _core.Status.ok
    return InProcessHub(machine, 2) if receiver is None else InProcessNode(receiver.node_id, machine)


def on_boards(open_board: BoardOpener) -> Configure:
    def configure(role: str, receiver: NodeRecording | None, config: Any) -> Machine:
        name, node_id = ("hub", HUB_ID) if receiver is None else (receiver.name, receiver.node_id)
        board = Board(open_board(role, name, node_id), node_id)
        board.configure(config)
        return FirmwareMachine(board)

    return configure


def node_config(receiver: NodeRecording) -> "_core.ThroughWallNodeConfig":
    config = _core.ThroughWallNodeConfig(node_id=receiver.node_id, n_samples=receiver.scans.shape[1])
    config.sample_rate_hz = receiver.sample_rate_hz
    config.baseline_m = float(np.linalg.norm(receiver.rx_position_m - receiver.tx_position_m))
    return config


def hub_config(receivers: tuple[NodeRecording, ...]) -> "_core.ThroughWallHubConfig":
    config = _core.ThroughWallHubConfig()
    tx_m = np.array([receiver.tx_position_m[:2] for receiver in receivers], np.float32)
    rx_m = np.array([receiver.rx_position_m[:2] for receiver in receivers], np.float32)
    config.set_nodes([receiver.node_id for receiver in receivers], tx_m, rx_m)
    config.set_area(-2.35, 0.48, 2.35, 6.10)
    return config


def run(receivers: tuple[NodeRecording, ...], configure: Configure) -> Said:
    said, now_us = Said([], [], {}), PERIOD_US
    nodes = [configure("node", receiver, node_config(receiver)) for receiver in receivers]
    hub = configure("hub", None, hub_config(receivers))
    try:
        for index in range(len(receivers[0].scans)):
            now_us = (index + 1) * PERIOD_US
            for node, receiver in zip(nodes, receivers, strict=True):
                response = np.ascontiguousarray(receiver.scans[index], np.float32)
                link = node.step(now_us, b"", ScanInput(now_us, response)).link_out
                said.detections += messages(link, codec.DETECTIONS)
                said.tracks += messages(hub.step(now_us, link).link_out, codec.TRACKS)
        for name, machine in (("hub", hub), *((r.name, n) for r, n in zip(receivers, nodes, strict=True))):
            said.counters[name] = machine.counters(now_us)
    finally:
        for machine in (hub, *nodes):
            machine.close()
    return said


def messages(link: bytes, port: int) -> Iterator[codec.Transfer]:
    for transfer in codec.FrameReader().feed(link):
        if transfer.port == port and transfer.kind == codec.MESSAGE:
            yield transfer


def assert_same(here: Said, there: Said) -> None:
    assert there.detections == here.detections
    assert there.tracks == here.tracks
    for name, counted in here.counters.items():
        shared = set(counted) & set(there.counters[name])
        assert len(shared) >= 8
        pipelines_own = {key for key in shared if not key.startswith("link_")}  # a board also says heartbeats
        assert {key: there.counters[name][key] for key in pipelines_own} == {
            key: counted[key] for key in pipelines_own
        }


def test_this_process_has_something_to_say(here: Said) -> None:
    assert here.counters["hub"]["frames"] == len(here.tracks) == 94
    assert here.counters["rx2"]["dead_responses"] == 3
    assert here.counters["rx1"]["dead_responses"] == here.counters["rx1"]["cross_talk_missing"] == 0
    assert max(len(codec.parse_tracks(frame.payload)[2]) for frame in here.tracks) >= 2


@pytest.mark.slow
@pytest.mark.parametrize("target", FIRMWARE_TARGETS)
def test_images_say_the_same_bytes(
    target: str, receivers: tuple[NodeRecording, ...], here: Said, injected: Ledger
) -> None:
    injected("rx2", dead_responses=3)
    there = run(receivers, on_boards(BoardOpener(target, "through_wall_2d")))
    assert_same(here, there)
    assert not any(there.counters["hub"][name] for name in OF_TROUBLE & set(there.counters["hub"]))


@pytest.mark.parametrize("kind", sorted(PLACES))
def test_a_receiver_of_ones_own_says_the_same_bytes(
    kind: str, receivers: tuple[NodeRecording, ...], here: Said, injected: Ledger
) -> None:
    """Its responses come over the link; the other receiver and the hub are host processes."""
    injected("rx2", dead_responses=3)
    with PLACES[kind]("through_wall_node") as place:
        opener = BoardOpener(place.address, "through_wall_2d")
        there = run(receivers, on_boards(opener))
    assert_same(here, there)
    assert opener.rejected == {place.address: {}}


@pytest.mark.parametrize("kind", sorted(PLACES))
def test_a_receiver_of_ones_own_takes_4095_samples(kind: str) -> None:
    board = Scoreboard()
    (choice,) = (choice for choice in THROUGH_WALL_NODE_CHOICES if choice.long_sequence)
    heard = list(simulated_responses(1, long_sequence=True))
    with (
        PLACES[kind]("through_wall_node") as place,
        closing(FirmwareConformanceTarget(place.address)) as target,
    ):
        conform_through_wall_node(board, choice, target, heard)
    assert [row.tap for row in board.rows() if row.passed] == list(THROUGH_WALL_NODE_TAPS)


def test_a_node_of_another_pipeline_is_no_receiver() -> None:
    with (
        PLACES["tcp"]("sensor_radar_node") as place,
        pytest.raises(
            TargetError,
            match=r"expected echofuse.through_wall.node, and it calls itself echofuse.sensor_radar.node",
        ),
    ):
        BoardOpener(place.address, "through_wall_2d")
