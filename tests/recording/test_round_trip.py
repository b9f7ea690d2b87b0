"""What is written is what is read, whatever the order and size of the pieces."""

import hashlib
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from echofuse.errors import InputError
from echofuse.recording import (
    DETECTION_DTYPE,
    TRACK_DTYPE,
    NodeRecording,
    PersonTruth,
    Recording,
    RecordingWriter,
    frame_digest,
    read,
    write,
)


def node(
    name: str, dtype: type, *, n_scans: int = 7, n_samples: int = 5, reference: bool = True
) -> NodeRecording:
    rng = np.random.default_rng(len(name) + n_scans)
    return NodeRecording(
        name=name,
        node_id=300 + len(name),
        sample_rate_hz=16.384e9,
        first_sample_s=-3.25e-9,
        tx_position_m=np.array([1.0, 2.0, 0.5]),
        rx_position_m=np.array([-1.0, 0.25, 0.5]),
        time_s=np.arange(n_scans) * 0.1 + 0.003,
        scans=(1000.0 * rng.normal(size=(n_scans, n_samples))).astype(dtype),
        reference=(100.0 * rng.normal(size=(3, n_samples))).astype(dtype) if reference else None,
        pulse={"kind": "gaussian", "centre_hz": 4.3e9, "bandwidth_hz": 2.2e9},
    )


def assert_same_nodes(one: NodeRecording, other: NodeRecording) -> None:
    for key, value in vars(one).items():
        found = getattr(other, key)
        np.testing.assert_array_equal(found, value, err_msg=key)
        if isinstance(value, np.ndarray):
            assert found.dtype == value.dtype, key


def test_a_recording_comes_back_whole(tmp_path: Path) -> None:
    person = PersonTruth(
        id="1",
        time_s=np.array([0.0, 0.1]),
        position_m=np.array([[1.0, 2.0, 1.1], [1.2, 2.0, 1.1]]),
        height_m=1.8,
        motion="walk",
    )
    recording = Recording(
        pipeline="sensor_radar",
        created="2024-05-06T07:08:09+00:00",
        site_toml='[site]\nname = "ünï"\n',
        nodes=(node("z", np.float32), node("aa", np.int32, n_samples=8, reference=False)),
        truth=(person,),
    )
    write(tmp_path / "r.h5", recording)
    back = read(tmp_path / "r.h5")
    assert (back.pipeline, back.created, back.site_toml) == (
        recording.pipeline,
        recording.created,
        recording.site_toml,
    )
    assert [found.name for found in back.nodes] == ["z", "aa"]  # in the order of writing, not of the alphabet
    for one, other in zip(recording.nodes, back.nodes, strict=True):
        assert_same_nodes(one, other)
    assert back.outputs is None
    (found,) = back.truth
    assert (found.id, found.height_m, found.motion, found.breathing_hz) == ("1", 1.8, "walk", None)
    np.testing.assert_array_equal(found.position_m, person.position_m)


def test_anybody_can_read_it_with_h5py(tmp_path: Path) -> None:
    """The published layout, key by key."""
    write(
        tmp_path / "r.h5",
        Recording(pipeline="sensor_radar", created="now", site_toml="", nodes=(node("a", np.int32),)),
    )
    with h5py.File(tmp_path / "r.h5") as file:
        assert dict(file.attrs) == {
            "format": "echofuse-recording",
            "version": 1,
            "pipeline": "sensor_radar",
            "created": "now",
        }
        assert file["site"][()] == b""
        group = file["nodes/a"]
        assert group["scans"].shape == (7, 5)
        assert group["scans"].dtype == np.int32
        assert group["time_s"].dtype == np.float64
        assert group["reference"].shape == (3, 5)
        assert set(group.attrs) == {
            "node_id",
            "sample_rate_hz",
            "first_sample_s",
            "tx_position_m",
            "rx_position_m",
            "pulse",
        }
        assert group.attrs["tx_position_m"].shape == (3,)
        assert group.attrs["pulse"]["centre_hz"] == 4.3e9


@given(pieces=st.lists(st.integers(1, 70), min_size=1, max_size=8))
def test_pieces_do_not_matter(tmp_path_factory: pytest.TempPathFactory, pieces: list[int]) -> None:
    path = tmp_path_factory.mktemp("pieces") / "r.h5"
    total = sum(pieces)
    scans = np.arange(total * 3000, dtype=np.float32).reshape(total, 3000)
    with RecordingWriter(path, pipeline="sensor_radar") as writer:
        writer.add_node(
            "a",
            node_id=1,
            n_samples=3000,  # a block is 21 scans
            sample_rate_hz=1e9,
            first_sample_s=0.0,
            tx_position_m=(0, 0, 0),
            rx_position_m=(1, 0, 0),
        )
        start = 0
        for piece in pieces:
            writer.append_scans("a", np.arange(start, start + piece), scans[start : start + piece])
            start += piece
    (back,) = read(path).nodes
    np.testing.assert_array_equal(back.scans, scans)
    np.testing.assert_array_equal(back.time_s, np.arange(total))


def test_rejected_samples_are_kept(tmp_path: Path) -> None:
    """NaN and infinity in scans are the node's to reject and count."""
    scans = np.zeros((2, 4), np.float32)
    scans[1, 2], scans[0, 0] = np.nan, np.inf
    original = node("a", np.float32, n_scans=2, n_samples=4)
    damaged = NodeRecording(**{**vars(original), "scans": scans})
    write(tmp_path / "r.h5", Recording(pipeline="p", created="c", site_toml="", nodes=(damaged,)))
    np.testing.assert_array_equal(read(tmp_path / "r.h5").nodes[0].scans, scans)


def outputs_of_frame(frame: int) -> tuple[np.ndarray, np.ndarray]:
    detections = np.zeros(frame % 3, DETECTION_DTYPE)
    detections["node"], detections["delay_s"], detections["weight"] = 2, 1e-8 * (frame + 1), 9
    detections["time_us"] = 100 * frame + 7
    tracks = np.zeros(
        (frame + 1) % 2, [item for item in TRACK_DTYPE.descr if item[0] not in ("frame", "time_us")]
    )
    tracks["id"], tracks["state"], tracks["x_m"], tracks["covariance_yy_m2"] = 4, 1, frame, 0.25
    return detections, tracks


def test_outputs_come_back_with_a_hash_a_frame(tmp_path: Path) -> None:
    digests = []
    with RecordingWriter(tmp_path / "r.h5", pipeline="sensor_radar", target="inprocess") as writer:
        writer.add_node(
            "a",
            node_id=1,
            n_samples=1,
            sample_rate_hz=1e9,
            first_sample_s=0.0,
            tx_position_m=(0, 0, 0),
            rx_position_m=(1, 0, 0),
            dtype=np.int32,
        )
        writer.append_scans("a", 0.0, np.zeros(1, np.int32))
        for frame in range(150):
            digests.append(writer.append_frame(100 * frame, *outputs_of_frame(frame)))
    back = read(tmp_path / "r.h5")
    outputs = back.outputs
    assert outputs is not None
    assert outputs.target == "inprocess"
    np.testing.assert_array_equal(outputs.frame_time_us, 100 * np.arange(150))
    assert [row.tobytes() for row in outputs.frame_hash] == digests
    for frame in range(150):
        detections, tracks = outputs_of_frame(frame)
        found = outputs.detections[outputs.detections["frame"] == frame]
        np.testing.assert_array_equal(found["delay_s"], detections["delay_s"])
        np.testing.assert_array_equal(found["time_us"], detections["time_us"])
        rows = outputs.tracks[outputs.tracks["frame"] == frame]
        np.testing.assert_array_equal(rows["x_m"], tracks["x_m"])
        assert np.all(rows["time_us"] == 100 * frame)  # the frame's own, as these rows had none
        assert (
            frame_digest(100 * frame, found, rows) == digests[frame]
        )  # the hash can be proved from the file
    write(tmp_path / "copy.h5", back)
    copy = read(tmp_path / "copy.h5").outputs
    assert copy is not None
    np.testing.assert_array_equal(copy.frame_hash, outputs.frame_hash)


def test_the_hash_covers_every_bit() -> None:
    detections, tracks = np.zeros(1, DETECTION_DTYPE), np.zeros(1, TRACK_DTYPE)
    whole = frame_digest(5, detections, tracks)
    expected = hashlib.sha256(
        (5).to_bytes(8, "little")
        + (1).to_bytes(4, "little")
        + bytes(DETECTION_DTYPE.itemsize)
        + (1).to_bytes(4, "little")
        + bytes(TRACK_DTYPE.itemsize)
    ).digest()
    assert whole == expected
    for name in TRACK_DTYPE.names or ():
        changed = tracks.copy()
        changed[name] = 1
        assert frame_digest(5, detections, changed) != whole, name
    assert frame_digest(6, detections, tracks) != whole
    assert frame_digest(5, detections[:0], tracks) != whole


def test_the_writer_refuses_what_would_not_fit(tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / "r.h5", pipeline="p") as writer:
        place = {
            "sample_rate_hz": 1e9,
            "first_sample_s": 0.0,
            "tx_position_m": (0, 0, 0),
            "rx_position_m": (0, 0, 1),
        }
        writer.add_node("a", node_id=1, n_samples=4, **place)
        with pytest.raises(ValueError, match="taken"):
            writer.add_node("a", node_id=2, n_samples=4, **place)
        with pytest.raises(ValueError, match="float32 or int32"):
            writer.add_node("b", node_id=2, n_samples=4, dtype=np.float64, **place)
        with pytest.raises(ValueError, match=r"float32 \(1, 4\)"):
            writer.append_scans("a", 0.0, np.zeros(5, np.float32))
        with pytest.raises(ValueError, match="not float64"):
            writer.append_scans("a", 0.0, np.zeros(4))
    with pytest.raises(InputError, match="a file that can be written"):
        RecordingWriter(tmp_path / "no folder" / "r.h5", pipeline="p")
