"""Frames: PyCyphal's vectors, our C++ and our Python are of one mind; all else is counted and survived."""

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from echofuse import _core
from echofuse.emulation import codec

CAPACITY = 2048
REJECTIONS = (
    "bad_cobs",
    "bad_length",
    "bad_version",
    "bad_header_crc",
    "bad_payload_crc",
    "multi_frame",
    "repeated",
)

payloads = st.binary(max_size=600) | st.lists(st.sampled_from([0, 1, 255]), max_size=600).map(bytes)
ids = st.integers(0, 0xFFFE)


def read(data: bytes, now_us: int = 0) -> tuple[list[tuple[object, ...]], dict[str, int]]:
    reader = _core.LinkReader(CAPACITY)
    return reader.feed(data, now_us), reader.counters()


def test_the_check_values_of_both_crcs() -> None:
    assert (_core.crc16(b"123456789"), codec.crc16(b"123456789")) == (0x29B1, 0x29B1)
    assert (_core.crc32c(b"123456789"), codec.crc32c(b"123456789")) == (0xE3069283, 0xE3069283)


def test_a_frame_is_written_as_pycyphal_writes_it(vector) -> None:
    ours = _core.write_frame(vector.source, vector.subject, vector.transfer_id, vector.payload)
    assert ours == vector.frame
    sent = codec.Transfer(vector.source, vector.subject, vector.transfer_id, vector.payload)
    assert codec.frame(sent) == vector.frame


def test_pycyphals_frame_is_read(vector) -> None:
    (transfer,), counters = read(vector.frame)
    assert transfer[:4] == (vector.source, vector.subject, vector.transfer_id, vector.payload)
    assert transfer[4] == _core.TransferKind.message
    assert counters["frames"] == 1
    (same,) = codec.FrameReader().feed(vector.frame)
    assert same[:4] == transfer[:4]


def test_a_report_of_four_detections_takes_at_most_64_bytes(vectors) -> None:
    assert len(vectors["four_detections"].frame) <= 64


@pytest.mark.parametrize("size", [0, 1, 225, 226, 227, 253, 254, 255, 480, 508, 509])
@pytest.mark.parametrize("byte", [0, 1, 255])
def test_payloads_around_the_length_of_a_block(size: int, byte: int) -> None:
    payload = bytes([byte]) * size
    frame = _core.write_frame(5, 6200, 9, payload)
    assert 0 not in frame[1:-1]
    assert frame == codec.frame(codec.Transfer(5, 6200, 9, payload))
    (transfer,), _ = read(frame)
    assert transfer[3] == payload


@given(payload=payloads, source=ids, port=st.integers(0, 8191), transfer_id=st.integers(0, (1 << 64) - 1))
def test_what_one_writes_the_other_reads(payload: bytes, source: int, port: int, transfer_id: int) -> None:
    frame = _core.write_frame(source, port, transfer_id, payload)
    assert frame == codec.frame(codec.Transfer(source, port, transfer_id, payload))
    (transfer,), _ = read(frame)
    assert transfer[:4] == (source, port, transfer_id, payload)


@given(payload=st.binary(max_size=64), bit=st.integers(0, 1 << 20))
def test_any_single_bit_error_is_rejected_and_counted(payload: bytes, bit: int) -> None:
    # Cut behind four zeros, they are the right CRC of no payload, which the messages' decoders refuse.
    assume(not payload.startswith(bytes(4)))
    frame = bytearray(_core.write_frame(3, 6200, 1, payload))
    bit %= 8 * (len(frame) - 2)  # the delimiters themselves are another matter: the stretch then runs on
    frame[1 + bit // 8] ^= 1 << bit % 8
    transfers, counters = read(bytes(frame))
    assert transfers == []
    assert sum(counters[name] for name in REJECTIONS) >= 1
    reader = codec.FrameReader()
    assert list(reader.feed(bytes(frame))) == []
    assert {name: counters[name] for name in reader.counters} == dict(reader.counters)


@given(noise=st.binary(max_size=400), payload=st.binary(max_size=100))
def test_after_anything_the_next_frame_is_read(noise: bytes, payload: bytes) -> None:
    frame = _core.write_frame(7, 6201, 2, payload)
    transfers, _ = read(noise + frame)
    assert (7, 6201, 2, payload) in [transfer[:4] for transfer in transfers]


@settings(max_examples=300)
@given(data=st.binary(max_size=3000))
def test_noise_gives_no_transfer_and_every_stretch_is_counted_once(data: bytes) -> None:
    transfers, counters = read(data + b"\0")
    stretches = [part for part in data.split(b"\0") if part]
    assert transfers == []
    assert sum(counters.values()) == len(stretches)


def test_a_frame_beyond_the_buffer_is_counted_and_the_next_is_read() -> None:
    reader = _core.LinkReader(100)
    long, short = (_core.write_frame(1, 6200, n, bytes(size)) for n, size in ((0, 73), (1, 72)))
    assert [transfer[2] for transfer in reader.feed(long + short, 0)] == [1]
    assert reader.counters()["bad_length"] == 1


def test_a_transfer_id_repeated_within_two_seconds_is_dropped_and_counted() -> None:
    reader = _core.LinkReader(CAPACITY)
    frame = _core.write_frame(1, 6200, 5, b"")
    assert [len(reader.feed(frame, t)) for t in (0, 1_999_999, 4_000_000)] == [1, 0, 1]
    assert reader.counters()["repeated"] == 1
    other = _core.write_frame(2, 6200, 5, b"")
    assert len(reader.feed(other, 4_000_001)) == 1


def test_part_of_a_longer_transfer_is_counted() -> None:
    frame = codec.frame(codec.Transfer(1, 6200, 5, b"abc"))
    checked = bytearray(codec.cobs_decoded(frame[1:-1]) or b"")
    checked[16:20] = (1).to_bytes(4, "little")
    checked[22:24] = codec.crc16(bytes(checked[:22])).to_bytes(2, "big")
    _, counters = read(b"\0" + codec.cobs_encoded(bytes(checked)) + b"\0")
    assert counters["multi_frame"] == 1
