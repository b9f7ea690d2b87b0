"""Tracks had no z before: such recordings load, and planar pipelines have the digests that they had."""

import hashlib
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from echofuse.cli import main
from echofuse.errors import InputError
from echofuse.recording import DETECTION_DTYPE, TRACK_DTYPE, RecordingWriter, frame_digest, read, write
from echofuse.recording.model import SPATIAL_COLUMNS
from echofuse.site import PIPELINES

#: As recordings had them before there were pipelines in space.
OLD_TRACK_DTYPE = np.dtype(
    [
        *(("frame", "<i4"), ("time_us", "<i8"), ("id", "<i4"), ("state", "u1")),
        ("frames_since_update", "<i4"),
        *((name, "<f4") for name in ("x_m", "y_m", "vx_mps", "vy_mps")),
        *((f"covariance_{name}_m2", "<f4") for name in ("xx", "xy", "yy")),
    ]
)


def old_digest(time_us: int, detections: np.ndarray, tracks: np.ndarray) -> bytes:
    digest = hashlib.sha256(int(time_us).to_bytes(8, "little"))
    for rows in (detections, tracks):
        digest.update(len(rows).to_bytes(4, "little") + rows.tobytes())
    return digest.digest()


def make_old(path: Path) -> None:
    """Turn a recording into what was written before."""
    with h5py.File(path, "r+") as file:
        outputs = file["outputs"]
        stored = outputs["tracks"][()]
        tracks = np.zeros(len(stored), OLD_TRACK_DTYPE)
        for name in OLD_TRACK_DTYPE.names or ():
            tracks[name] = stored[name]
        detections = outputs["detections"][()]
        digests = [
            old_digest(time_us, *(rows[rows["frame"] == frame] for rows in (detections, tracks)))
            for frame, time_us in enumerate(outputs["frame_time_us"][()])
        ]
        del outputs["tracks"]
        outputs["tracks"] = tracks
        outputs["frame_hash"][...] = np.frombuffer(b"".join(digests), np.uint8).reshape(-1, 32)


@pytest.fixture
def in_space(monkeypatch: pytest.MonkeyPatch) -> str:
    """A pipeline whose positions have three coordinates."""
    monkeypatch.setitem(PIPELINES, "in_space", replace(PIPELINES["through_wall_2d"], dimension=3))
    return "in_space"


def some_tracks() -> np.ndarray:
    """Two tracks; what is of z is a number, as the compiled hubs give it."""
    tracks = np.zeros(2, [item for item in TRACK_DTYPE.descr if item[0] not in ("frame", "time_us")])
    for value, name in enumerate(tracks.dtype.names or (), 1):
        tracks[name] = value, value + 1
    return tracks


def written(path: Path, pipeline: str, tracks: np.ndarray) -> bytes:
    """Write a recording of one frame; its digest."""
    place = {"tx_position_m": (0, 0, 0), "rx_position_m": (1, 0, 0)}
    with RecordingWriter(path, pipeline=pipeline) as writer:
        writer.add_node("a", node_id=1, n_samples=1, sample_rate_hz=1e9, first_sample_s=0.0, **place)
        writer.append_scans("a", 0.0, np.zeros(1, np.float32))
        return writer.append_frame(7, np.zeros(1, DETECTION_DTYPE), tracks)


def tracks_of(path: Path) -> np.ndarray:
    outputs = read(path).outputs
    assert outputs is not None
    return outputs.tracks


@pytest.mark.parametrize("pipeline", [name for name, kind in PIPELINES.items() if kind.dimension == 2])
def test_a_planar_digest_is_what_it_was(tmp_path: Path, pipeline: str) -> None:
    digest = written(tmp_path / "r.h5", pipeline, some_tracks())
    found = tracks_of(tmp_path / "r.h5")
    assert all(np.all(np.isnan(found[name])) for name in SPATIAL_COLUMNS)
    before = np.zeros(2, OLD_TRACK_DTYPE)
    for name in OLD_TRACK_DTYPE.names or ():
        before[name] = found[name]
    assert before["covariance_yy_m2"].any()
    detections = np.zeros(1, DETECTION_DTYPE)
    detections["time_us"] = 0
    assert digest == old_digest(7, detections, before)
    assert digest == frame_digest(7, detections, found)


def test_an_old_recording_loads_without_z(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    digest = written(path, "sensor_radar", some_tracks())
    new = tracks_of(path)
    make_old(path)
    old = tracks_of(path)
    assert old.dtype == TRACK_DTYPE
    for name in TRACK_DTYPE.names or ():
        np.testing.assert_array_equal(old[name], new[name], err_msg=name)
    back = read(path)
    assert back.outputs is not None
    assert back.outputs.frame_hash[0].tobytes() == digest
    write(tmp_path / "copy.h5", back)
    copy = read(tmp_path / "copy.h5").outputs
    assert copy is not None
    assert copy.frame_hash[0].tobytes() == digest


def test_an_old_recording_verifies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "run"
    arguments = ["run", "through-wall", "--duration", "2", "--no-report", "--out", str(folder)]
    assert main(arguments) == 0
    recording = folder / "recording.h5"
    assert len(tracks_of(recording)) > 0
    make_old(recording)
    assert main(["verify", str(recording)]) == 0
    assert "all bytes the same" in capsys.readouterr().out


def test_tracks_in_space_are_kept_and_in_the_digest(tmp_path: Path, in_space: str) -> None:
    tracks = some_tracks()
    digest = written(tmp_path / "r.h5", in_space, tracks)
    found = tracks_of(tmp_path / "r.h5")
    for name in tracks.dtype.names or ():
        np.testing.assert_array_equal(found[name], tracks[name], err_msg=name)
    for name in SPATIAL_COLUMNS:
        changed = tracks.copy()
        changed[name][1] += 1
        assert written(tmp_path / "other.h5", in_space, changed) != digest, name


def test_a_table_with_some_columns_of_z_is_no_table_of_ours(tmp_path: Path) -> None:
    path = tmp_path / "r.h5"
    written(path, "sensor_radar", some_tracks())
    with h5py.File(path, "r+") as file:
        stored = file["outputs/tracks"][()]
        del file["outputs/tracks"]
        file["outputs/tracks"] = stored[[name for name in stored.dtype.names if name != "vz_mps"]]
    with pytest.raises(InputError, match="/outputs/tracks"):
        read(path)
