"""Cyphal/serial frames and our messages, once more and from the specification alone.

It reads what the library writes and the other way round, so the two hold each other to the wire format
(docs/link_protocol.md). 00 | COBS(24 bytes of header | payload | CRC-32C) | 00, one frame a transfer.
"""

import struct
from collections import Counter
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

BROADCAST = 0xFFFF
HEARTBEAT, TIME = 7509, 7168
REGISTER_ACCESS, REGISTER_LIST, GET_INFO = 384, 385, 430
DETECTIONS, TRACKS, NODE_HEALTH, TAP, RAW_SCAN, SPATIAL_TRACKS = 6200, 6201, 6205, 6206, 6207, 6208

MESSAGE, REQUEST, RESPONSE = 0x0000, 0xC000, 0x8000  # bits of the data specifier
_HEADER = struct.Struct("<BBHHHQIH")  # all but the CRC
_SINGLE_FRAME = 0x80000000

DETECTION = np.dtype([("delay_s", "<f4"), ("weight", "<u2")])
TRACK = np.dtype(
    [
        ("id", "<u4"),
        ("state", "u1"),
        ("frames_since_update", "<u2"),
        *((name, "<f4") for name in ("x_m", "y_m", "vx_mps", "vy_mps")),
        *((f"covariance_{name}_m2", "<f4") for name in ("xx", "xy", "yy")),
    ]
)
SPATIAL_TRACK = np.dtype(
    [
        ("id", "<u4"),
        ("state", "u1"),
        ("frames_since_update", "<u2"),
        *((name, "<f4") for name in ("x_m", "y_m", "z_m", "vx_mps", "vy_mps", "vz_mps")),
        *((f"covariance_{name}_m2", "<f4") for name in ("xx", "xy", "yy", "xz", "yz", "zz")),
    ]
)
#: The rows of the messages in which hubs report, by subject.
TRACK_ROWS = {TRACKS: TRACK, SPATIAL_TRACKS: SPATIAL_TRACK}

#: What a NodeHealth's values are, by kind (docs/link_protocol.md).
_LINK_COUNTERS = (
    "frames",
    "bad_cobs",
    "bad_length",
    "bad_version",
    "bad_header_crc",
    "bad_payload_crc",
    "multi_frame",
    "repeated",
    "unsent",
    "refused_writes",
    "stack_bytes",
)
_REPORT_COUNTERS = (
    "accepted",
    "late",
    "early",
    "doubled",
    "malformed",
    "unknown_node",
    "lost",
    "resynchronised",
    "frames",
    "absent",
    "slow",
)
HEALTH_VALUES: dict[int, tuple[str, ...]] = {
    0: (
        "scans",
        "rejected_scans",
        "learning_scans",
        "direct_path_missing",
        "alignment_doubts",
        "undetectable_scans",
        "truncated_detections",
        "ticks_max",
        *(f"link_{name}" for name in _LINK_COUNTERS),
    ),
    1: (
        *_REPORT_COUNTERS,
        "tuples",
        "dropped_tuples",
        "dropped_detections",
        "dropped_measurements",
        "dropped_points",
        "dropped_births",
        "clock_faults",
        "undecodable",
        "ticks_max",
        *(f"link_{name}" for name in _LINK_COUNTERS),
    ),
    2: (
        "responses",
        "rejected_responses",
        "dead_responses",
        "saturated_responses",
        "cross_talk_missing",
        "settling_responses",
        "time_zero_moved",
        "truncated_detections",
        "ticks_max",
        *(f"link_{name}" for name in _LINK_COUNTERS),
    ),
    3: (
        *_REPORT_COUNTERS,
        "couples",
        "unlocated",
        "outside_area",
        "dropped_points",
        "dropped_births",
        "dropped_combinations",
        "clock_faults",
        "undecodable",
        "ticks_max",
        *(f"link_{name}" for name in _LINK_COUNTERS),
    ),
    4: (
        *_REPORT_COUNTERS,
        "couples",
        "quads",
        "clipped",
        "unlocated",
        "outside_area",
        "dropped_points",
        "dropped_births",
        "dropped_combinations",
        "clock_faults",
        "undecodable",
        "ticks_max",
        *(f"link_{name}" for name in _LINK_COUNTERS),
    ),
}


class Transfer(NamedTuple):
    """One message, request or response."""

    source: int
    port: int
    transfer_id: int
    payload: bytes
    kind: int = MESSAGE
    destination: int = BROADCAST
    priority: int = 4


def crc16(data: bytes) -> int:
    """CRC-16/CCITT-FALSE."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = ((crc << 1) ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def _crc32c_entry(byte: int) -> int:
    for _ in range(8):
        byte = (byte >> 1) ^ 0x82F63B78 if byte & 1 else byte >> 1
    return byte


_CRC32C = tuple(_crc32c_entry(byte) for byte in range(256))


def crc32c(data: bytes) -> int:
    """CRC-32C (Castagnoli)."""
    crc = 0xFFFFFFFF
    for byte in data:
        crc = (crc >> 8) ^ _CRC32C[(crc ^ byte) & 0xFF]
    return crc ^ 0xFFFFFFFF


def cobs_encoded(data: bytes) -> bytes:
    """Return `data` without zeros: each block says how far it is to the next one."""
    blocks = []
    for part in data.split(b"\0"):
        while len(part) >= 254:
            blocks.append(b"\xff" + part[:254])
            part = part[254:]
        blocks.append(bytes([len(part) + 1]) + part)
    return b"".join(blocks)


def cobs_decoded(data: bytes) -> bytes | None:
    """Return what was encoded, or None when a block reaches beyond the end."""
    decoded, at = bytearray(), 0
    while at < len(data):
        code = data[at]
        if at + code > len(data):
            return None
        decoded += data[at + 1 : at + code]
        at += code
        if code != 255 and at < len(data):
            decoded.append(0)
    return bytes(decoded)


def frame(transfer: Transfer) -> bytes:
    """Return the frame of a transfer, with its delimiters."""
    header = _HEADER.pack(
        1,
        transfer.priority,
        transfer.source,
        transfer.destination,
        transfer.port | transfer.kind,
        transfer.transfer_id,
        _SINGLE_FRAME,
        0,
    )
    header += crc16(header).to_bytes(2, "big")
    checked = header + transfer.payload + crc32c(transfer.payload).to_bytes(4, "little")
    return b"\0" + cobs_encoded(checked) + b"\0"


class FrameReader:
    """Finds frames in a byte stream; `counters` says what became of every stretch between two delimiters."""

    def __init__(self) -> None:
        self.counters: Counter[str] = Counter()
        self._rest = b""

    def feed(self, data: bytes) -> Iterator[Transfer]:
        """Yield the valid transfers that these bytes complete."""
        *stretches, self._rest = (self._rest + data).split(b"\0")
        for stretch in stretches:
            if stretch:
                outcome = parsed(stretch)
                self.counters["frames" if isinstance(outcome, Transfer) else outcome] += 1
                if isinstance(outcome, Transfer):
                    yield outcome


def parsed(stretch: bytes) -> Transfer | str:
    """Return the transfer in what stands between two delimiters, or why there is none."""
    checked = cobs_decoded(stretch)
    if checked is None:
        return "bad_cobs"
    if len(checked) < _HEADER.size + 6:
        return "bad_length"
    header, payload, crc = checked[:24], checked[24:-4], checked[-4:]
    version, priority, source, destination, specifier, transfer_id, index, _ = _HEADER.unpack(header[:22])
    if crc16(header) != 0:
        return "bad_header_crc"
    if version != 1:
        return "bad_version"
    if crc32c(payload) != int.from_bytes(crc, "little"):
        return "bad_payload_crc"
    if index != _SINGLE_FRAME:
        return "multi_frame"
    kind = specifier & 0xC000 if specifier & 0x8000 else MESSAGE
    port = specifier & (0x3FFF if kind else 0x7FFF)
    return Transfer(source, port, transfer_id, payload, kind, destination, priority)


def detections_payload(time_us: int, delay_s: NDArray[Any], weight: NDArray[Any]) -> bytes:
    """Return the payload of echofuse.Detections; delay_s and weight (n,), n at most 16."""
    rows = np.zeros(len(delay_s), DETECTION)
    rows["delay_s"], rows["weight"] = delay_s, weight
    return (time_us & (1 << 56) - 1).to_bytes(7, "little") + bytes([len(rows)]) + rows.tobytes()


def parse_detections(payload: bytes) -> tuple[int, NDArray[np.void]]:
    """Return the time [us] and the rows (n,) of delay_s, weight."""
    return int.from_bytes(payload[:7], "little"), np.frombuffer(payload[8:], DETECTION, payload[7])


def parse_tracks(payload: bytes, rows: np.dtype[np.void] = TRACK) -> tuple[int, int, NDArray[np.void]]:
    """Return time [us], frame number and the rows (n,) of Tracks, or with SPATIAL_TRACK of SpatialTracks."""
    return (
        int.from_bytes(payload[:7], "little"),
        int.from_bytes(payload[7:11], "little"),
        np.frombuffer(payload[12:], rows, payload[11]),
    )


def reported_tracks(transfer: Transfer) -> tuple[int, int, NDArray[np.void]] | None:
    """Return what `parse_tracks` does of a hub's report, planar or in space; None when it is none."""
    if transfer.kind != MESSAGE or transfer.port not in TRACK_ROWS:
        return None
    return parse_tracks(transfer.payload, TRACK_ROWS[transfer.port])


def tracks_payload(
    time_us: int, frame: int, tracks: NDArray[np.void], rows: np.dtype[np.void] = TRACK
) -> bytes:
    """Return the payload of Tracks, or with SPATIAL_TRACK of SpatialTracks.

    tracks: (n,) with the fields of `rows`, n at most 24.
    """
    sent = np.zeros(len(tracks), rows)
    for name in rows.names or ():
        sent[name] = tracks[name]
    head = (time_us & (1 << 56) - 1).to_bytes(7, "little") + (frame & 0xFFFFFFFF).to_bytes(4, "little")
    return head + bytes([len(sent)]) + sent.tobytes()


def parse_health(payload: bytes) -> dict[str, int]:
    """Return a machine's counters by name."""
    names = HEALTH_VALUES[payload[0]]
    values = np.frombuffer(payload[2:], "<u4", payload[1])
    return dict(zip(names, map(int, values), strict=True))


#: uavcan.register.Value: tag and format of an element, by the type of a configuration's member.
_REAL32, _INTEGER32, _NATURAL8, _NATURAL16, _NATURAL64, _BIT = (
    (13, "f"),
    (5, "i"),
    (11, "B"),
    (10, "H"),
    (8, "Q"),
    (3, "?"),
)


def register_write(name: str, value: object) -> bytes:
    """Return the request that sets one register; the type of the value chooses the wire's."""
    if isinstance(value, bool):
        tag, data = _BIT[0], bytes([value])
    elif hasattr(type(value), "__members__"):
        tag, data = _NATURAL8[0], bytes([int(value)])  # type: ignore[call-overload]
    elif isinstance(value, np.uint16 | np.uint64):
        tag, code = _NATURAL16 if isinstance(value, np.uint16) else _NATURAL64
        data = struct.pack(f"<{code}", int(value))
    elif isinstance(value, int):
        tag, data = _INTEGER32[0], struct.pack("<i", value)
    else:
        tag, data = _REAL32[0], struct.pack("<f", value)
    size = (
        2 if tag in (_BIT[0], _NATURAL8[0]) else 1
    )  # an array of up to 256 elements or more has a length of 16 bits
    encoded = name.encode()
    return bytes([len(encoded)]) + encoded + bytes([tag]) + (1).to_bytes(size, "little") + data


def register_read(name: str) -> bytes:
    """Return the request of uavcan.register.Access that reads one register."""
    encoded = name.encode()
    return bytes([len(encoded)]) + encoded + b"\0"


def parse_name(payload: bytes) -> str:
    """Return what a machine calls itself in a response of uavcan.node.GetInfo."""
    return payload[31 : 31 + payload[30]].decode(errors="replace")


def parse_register(payload: bytes) -> object:
    """Return the first element of the value in a response of register.Access; None when it is empty."""
    tag, data = payload[8], payload[9:]
    for known, code in (_REAL32, _INTEGER32, _NATURAL8, _NATURAL16, _NATURAL64, _BIT):
        if tag == known:
            size = 2 if tag in (_BIT[0], _NATURAL8[0]) else 1
            return data[2] & 1 == 1 if tag == _BIT[0] else struct.unpack_from(f"<{code}", data, size)[0]
    return None
