"""Messages: the library's payloads are PyCyphal's, and decoding refuses what is none."""

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from echofuse import _core
from echofuse.emulation import codec
from echofuse.recording.model import SPATIAL_COLUMNS


def float32(*values: float) -> np.ndarray:
    return np.array(values, np.float32)


def test_detections(vectors) -> None:
    vector = vectors["four_detections"]
    delay_s, weight = float32(3.5e-9, 7e-9, 10.5e-9, 14e-9), float32(107, 207, 307, 407)
    assert _core.encode_detections(-2, delay_s, weight) == vector.payload
    status, node, frame, time_us, rows = _core.decode_detections(
        vector.source, vector.transfer_id, vector.payload
    )
    assert (status, node, frame, time_us) == (_core.Status.ok, 65534, (1 << 32) - 1, -2)
    assert np.array_equal(rows["delay_s"], delay_s)
    assert np.array_equal(rows["weight"], weight)
    _, same = codec.parse_detections(vector.payload)
    assert np.array_equal(same["delay_s"], delay_s)
    assert codec.detections_payload(-2, delay_s, weight) == vector.payload


def test_a_report_without_detections(vectors) -> None:
    nothing = float32()
    assert _core.encode_detections(0, nothing, nothing) == vectors["no_detections"].payload


def test_tracks(vectors) -> None:
    payload = vectors["track"].payload
    status, time_us, frame, rows = _core.decode_tracks(payload)
    assert (status, time_us, frame, len(rows)) == (_core.Status.ok, 1_234_567, 12, 1)
    (row,) = rows
    assert (row["id"], row["state"], row["frames_since_update"]) == (9, 2, 3)
    assert row["y_m"] == np.float32(-2.25)
    assert row["covariance_xy_m2"] == np.float32(-0.01)
    assert _core.encode_tracks(time_us, frame, rows) == payload
    _, _, same = codec.parse_tracks(payload)
    assert same["vy_mps"] == row["vy_mps"]


def test_tracks_in_space(vectors) -> None:
    vector = vectors["spatial_track"]
    status, time_us, frame, rows = _core.decode_spatial_tracks(vector.payload)
    assert (status, time_us, frame, len(rows)) == (_core.Status.ok, 1_234_567, 12, 1)
    expected = {
        **{"id": 9, "state": 2, "frames_since_update": 3},
        **{"x_m": 1.5, "y_m": -2.25, "z_m": 1.125, "vx_mps": 0.0, "vy_mps": 1e-3, "vz_mps": -0.5},
        **{"covariance_xx_m2": 0.04, "covariance_xy_m2": -0.01, "covariance_yy_m2": 0.09},
        **{"covariance_xz_m2": 0.02, "covariance_yz_m2": -0.03, "covariance_zz_m2": 0.16},
    }
    assert rows.dtype.names == tuple(expected)
    for name, value in expected.items():
        assert rows[name][0] == np.float32(value), name
    assert _core.encode_spatial_tracks(time_us, frame, rows) == vector.payload
    transfer = codec.Transfer(vector.source, vector.subject, vector.transfer_id, vector.payload)
    report = codec.reported_tracks(transfer)
    assert report is not None
    assert report[:2] == (time_us, frame)
    assert all(np.array_equal(report[2][name], rows[name]) for name in expected)
    assert codec.tracks_payload(time_us, frame, rows, codec.SPATIAL_TRACK) == vector.payload


def test_a_hubs_report_is_told_by_its_subject(vectors) -> None:
    def report(name: str, **other: int) -> object:
        vector = vectors[name]
        transfer = codec.Transfer(vector.source, vector.subject, vector.transfer_id, vector.payload)
        return codec.reported_tracks(transfer._replace(**other))

    assert report("track") is not None
    assert report("health") is None
    assert report("track", kind=codec.REQUEST) is None


def test_planar_tracks_have_no_height_on_the_wire(vectors) -> None:
    _, time_us, frame, rows = _core.decode_spatial_tracks(vectors["spatial_track"].payload)
    assert _core.encode_tracks(time_us, frame, rows) == vectors["track"].payload
    _, _, _, planar = _core.decode_tracks(vectors["track"].payload)
    for name in SPATIAL_COLUMNS:
        assert planar[name] == 0.0


def test_health(vectors) -> None:
    counters = codec.parse_health(vectors["health"].payload)
    assert list(counters.values()) == list(range(0, 31 * 255, 255))


def test_a_heartbeat_is_sent_once_a_second(vectors) -> None:
    machine = _core.LinkMachine(61440)
    assert [bool(machine.heartbeat(t)) for t in (0, 400_000, 999_999, 1_000_000, 1_000_001)] == [
        *(True, False, False),
        *(True, False),
    ]
    (transfer,) = codec.FrameReader().feed(machine.heartbeat(86_400_000_000))
    expected = bytearray(vectors["heartbeat"].payload)
    expected[4:] = bytes([0, 0, 0])  # nominal, operational, no status
    assert (transfer.port, transfer.payload) == (7509, bytes(expected))


@given(payload=st.binary(max_size=200), source=st.integers(0, 65535), transfer_id=st.integers(0, 1 << 63))
def test_any_payload_is_decoded_or_refused(payload: bytes, source: int, transfer_id: int) -> None:
    status, *_, rows = _core.decode_detections(source, transfer_id, payload)
    assert status in (_core.Status.ok, _core.Status.invalid_input)
    assert len(rows) <= 16
    for decode in (_core.decode_tracks, _core.decode_spatial_tracks):
        status, *_, rows = decode(payload)
        assert status in (_core.Status.ok, _core.Status.invalid_input)
        assert all(row["state"] <= 3 for row in rows)


@pytest.mark.parametrize("count", [17, 255])
def test_more_detections_than_a_report_has_are_refused(count: int) -> None:
    payload = bytes(7) + bytes([count]) + bytes(6 * count)
    assert _core.decode_detections(1, 0, payload)[0] == _core.Status.invalid_input


def access(machine: "_core.LinkMachine", request: bytes, number: int) -> bytes:
    asked = codec.Transfer(9, codec.REGISTER_ACCESS, number, request, codec.REQUEST, 5)
    (answer,) = codec.FrameReader().feed(machine.feed(codec.frame(asked), 1))
    assert (answer.kind, answer.source, answer.destination) == (codec.RESPONSE, 5, 9)
    assert answer.transfer_id == number
    return answer.payload


def test_registers_are_written_and_read_back() -> None:
    machine = _core.LinkMachine(5)
    written = {
        "cfar.global_factor": 4.5,
        "cfar.buffer_samples": 30,
        "cfar.method": _core.CfarMethod.cell_averaging,
    }
    for number, (name, value) in enumerate(written.items()):
        answer = access(machine, codec.register_write(name, value), number)
        assert codec.parse_register(answer) == (int(value) if number == 2 else value)
        assert answer[7] == 1  # mutable, not persistent
    assert codec.parse_register(access(machine, codec.register_read("cfar.global_factor"), 7)) == 4.5
    assert codec.parse_register(access(machine, codec.register_read("uavcan.node.id"), 8)) == 5
    assert codec.parse_register(access(machine, codec.register_read("uavcan.pub.detections.id"), 9)) == 6200
    assert machine.refused_writes() == 0


@pytest.mark.parametrize(
    "request_",
    [
        codec.register_write("cfar.global_factor", 4),  # an integer for a real
        codec.register_write("uavcan.node.id", np.uint16(7)),  # the board's
        codec.register_write("no.such.register", 1.0),
    ],
)
def test_a_write_that_does_not_fit_is_refused_and_counted(request_: bytes) -> None:
    machine = _core.LinkMachine(5)
    access(machine, request_, 0)
    assert machine.refused_writes() == 1


def test_every_register_is_listed_once() -> None:
    machine = _core.LinkMachine(5)
    names: list[str] = []
    for index in range(200):
        asked = codec.Transfer(9, codec.REGISTER_LIST, index, struct.pack("<H", index), codec.REQUEST, 5)
        (answer,) = codec.FrameReader().feed(machine.feed(codec.frame(asked), 1))
        if answer.payload == b"\0":
            break
        names.append(answer.payload[1:].decode())
    assert len(set(names)) == len(names)
    assert set(_core.node_registers()) < set(names)


def test_requests_to_others_and_unknown_services_are_left_alone() -> None:
    machine = _core.LinkMachine(5)
    for port, destination in ((codec.REGISTER_ACCESS, 6), (100, 5)):
        asked = codec.Transfer(9, port, 0, codec.register_read("uavcan.node.id"), codec.REQUEST, destination)
        assert machine.feed(codec.frame(asked), 1) == b""


def members(config: object, where: str = "") -> set[str]:
    """The names that a site file knows."""
    names: set[str] = set()
    for name in config.fields():  # type: ignore[attr-defined]
        value = getattr(config, name)
        if hasattr(value, "fields"):
            names |= members(value, f"{where}{name}.")
        elif isinstance(value, list):
            names |= members(value[0], f"{where}{name}.#.")
        else:
            names.add(where + name)
    return names


def test_every_member_of_a_configuration_is_a_register() -> None:
    assert set(_core.node_registers()) == members(_core.SensorRadarNodeConfig()) - {"node_id"}
    assert set(_core.through_wall_node_registers()) == members(_core.ThroughWallNodeConfig()) - {"node_id"}
    assert set(_core.hub_registers()) == members(_core.SensorRadarHubConfig())
    assert set(_core.through_wall_hub_registers()) == members(_core.ThroughWallHubConfig())
    assert set(_core.through_wall_3d_hub_registers()) == members(_core.ThroughWall3dHubConfig())
