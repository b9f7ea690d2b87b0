"""Everything that can be wrong with a recording is one line that names the file and the key."""

from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from echofuse.errors import InputError
from echofuse.recording import DETECTION_DTYPE, TRACK_DTYPE, PersonTruth, RecordingWriter, read


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A good recording."""
    path = tmp_path / "good.h5"
    with RecordingWriter(path, pipeline="sensor_radar") as writer:
        for number in (1, 2):
            writer.add_node(
                f"n{number}",
                node_id=number,
                n_samples=64,
                sample_rate_hz=16e9,
                first_sample_s=0.0,
                tx_position_m=(0, 0, 0),
                rx_position_m=(number, 0, 0),
                pulse={"kind": "gaussian", "centre_hz": 4e9, "bandwidth_hz": 2e9},
                reference=np.zeros((2, 64), np.float32),
            )
            writer.append_scans(f"n{number}", np.arange(20.0), np.ones((20, 64), np.float32))
        writer.add_person(
            PersonTruth(id="7", time_s=np.arange(3.0), position_m=np.zeros((3, 3)), height_m=1.7)
        )
        writer.append_frame(0, np.zeros(1, DETECTION_DTYPE), np.zeros(1, TRACK_DTYPE))
    return path


def message(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read(path)
    text = str(caught.value)
    assert "\n" not in text
    assert str(path) in text
    assert "expected" in text
    return text


def replaced(file: h5py.File, key: str, data: object) -> None:
    del file[key]
    file[key] = data


def without_attribute(name: str, key: str) -> Callable[[h5py.File], None]:
    return lambda file: file[name].attrs.__delitem__(key)


def with_attribute(name: str, key: str, value: object) -> Callable[[h5py.File], None]:
    return lambda file: file[name].attrs.__setitem__(key, value)


DAMAGE: dict[str, tuple[Callable[[h5py.File], None], str]] = {
    "foreign": (without_attribute("/", "format"), "format"),
    "other format": (with_attribute("/", "format", "acme"), "format"),
    "newer": (with_attribute("/", "version", 2), "version"),
    "version not a number": (with_attribute("/", "version", "one"), "version"),
    "no pipeline": (without_attribute("/", "pipeline"), "pipeline"),
    "pipeline not a string": (with_attribute("/", "pipeline", 5), "pipeline"),
    "no nodes": (lambda file: file.__delitem__("nodes"), "/nodes"),
    "nodes is a dataset": (lambda file: replaced(file, "nodes", 3), "/nodes"),
    "site is a number": (lambda file: replaced(file, "site", 3), "/site"),
    "no scans": (lambda file: file.__delitem__("nodes/n1/scans"), "/nodes/n1/scans"),
    "float64 scans": (lambda file: replaced(file, "nodes/n1/scans", np.zeros((20, 64))), "/nodes/n1/scans"),
    "flat scans": (lambda file: replaced(file, "nodes/n1/scans", np.zeros(20, "f4")), "/nodes/n1/scans"),
    "scans without samples": (
        lambda file: replaced(file, "nodes/n1/scans", np.zeros((20, 0), "f4")),
        "/nodes/n1/scans",
    ),
    "no times": (lambda file: file.__delitem__("nodes/n2/time_s"), "/nodes/n2/time_s"),
    "more times than scans": (
        lambda file: replaced(file, "nodes/n2/time_s", np.zeros(21)),
        "/nodes/n2/time_s",
    ),
    "integer times": (lambda file: replaced(file, "nodes/n2/time_s", np.zeros(20, int)), "/nodes/n2/time_s"),
    "NaN times": (lambda file: replaced(file, "nodes/n2/time_s", np.full(20, np.nan)), "/nodes/n2/time_s"),
    "other reference": (
        lambda file: replaced(file, "nodes/n1/reference", np.zeros((2, 63), "f4")),
        "/nodes/n1/reference",
    ),
    "no id": (without_attribute("nodes/n1", "node_id"), "/nodes/n1.node_id"),
    "half an id": (with_attribute("nodes/n1", "node_id", 0.5), "/nodes/n1.node_id"),
    "no rate": (without_attribute("nodes/n1", "sample_rate_hz"), "/nodes/n1.sample_rate_hz"),
    "NaN rate": (with_attribute("nodes/n1", "sample_rate_hz", np.nan), "/nodes/n1.sample_rate_hz"),
    "negative rate": (with_attribute("nodes/n1", "sample_rate_hz", -1.0), "/nodes/n1.sample_rate_hz"),
    "two rates": (with_attribute("nodes/n1", "sample_rate_hz", [1.0, 2.0]), "/nodes/n1.sample_rate_hz"),
    "rate as text": (with_attribute("nodes/n1", "sample_rate_hz", "16 GHz"), "/nodes/n1.sample_rate_hz"),
    "NaN first sample": (with_attribute("nodes/n1", "first_sample_s", np.nan), "/nodes/n1.first_sample_s"),
    "two coordinates": (with_attribute("nodes/n1", "tx_position_m", [0.0, 1.0]), "/nodes/n1.tx_position_m"),
    "NaN coordinate": (
        with_attribute("nodes/n1", "rx_position_m", [0.0, np.nan, 0.0]),
        "/nodes/n1.rx_position_m",
    ),
    "pulse as text": (with_attribute("nodes/n1", "pulse", "gaussian"), "/nodes/n1.pulse"),
    "truth of other length": (
        lambda file: replaced(file, "truth/people/7/position_m", np.zeros((2, 3))),
        "/truth/people/7/position_m",
    ),
    "truth backwards": (
        lambda file: replaced(file, "truth/people/7/time_s", np.arange(3.0)[::-1]),
        "/truth/people/7/time_s",
    ),
    "NaN truth": (
        lambda file: replaced(file, "truth/people/7/position_m", np.full((3, 3), np.nan)),
        "/truth/people/7/position_m",
    ),
    "NaN height": (with_attribute("truth/people/7", "height_m", np.nan), "/truth/people/7.height_m"),
    "hash of other size": (
        lambda file: replaced(file, "outputs/frame_hash", np.zeros((1, 16), "u1")),
        "/outputs/frame_hash",
    ),
    "fewer hashes": (
        lambda file: replaced(file, "outputs/frame_hash", np.zeros((0, 32), "u1")),
        "/outputs/frame_hash",
    ),
    "other tracks": (lambda file: replaced(file, "outputs/tracks", np.zeros(3)), "/outputs/tracks"),
}


@pytest.mark.parametrize("name", DAMAGE)
def test_damage_is_named(path: Path, name: str) -> None:
    read(path)
    damage, key = DAMAGE[name]
    with h5py.File(path, "r+") as file:
        damage(file)
    assert f": {key}" in message(path) or f".{key}: " in message(path)


def test_empty_recordings(path: Path, tmp_path: Path) -> None:
    with h5py.File(path, "r+") as file:
        for name in ("n1", "n2"):
            replaced(file, f"nodes/{name}/time_s", np.zeros(0))
    assert "at least one scan" in message(path)
    empty = tmp_path / "empty.h5"
    RecordingWriter(empty, pipeline="sensor_radar").close()
    assert "at least one node" in message(empty)


def test_one_dead_node_is_no_reason_to_refuse_the_others(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        replaced(file, "nodes/n1/time_s", np.zeros(0))
        replaced(file, "nodes/n1/scans", np.zeros((0, 64), "f4"))
    assert [len(node.time_s) for node in read(path).nodes] == [0, 20]


def test_not_hdf5(tmp_path: Path) -> None:
    for name, content in (("text.h5", b"hello\n" * 99), ("nothing.h5", b"")):
        (tmp_path / name).write_bytes(content)
        assert "recording (HDF5 file)" in message(tmp_path / name)
    assert "no such file" in message(tmp_path / "missing.h5")
    assert "no such file" in message(tmp_path)


def test_every_truncation_is_noticed(path: Path) -> None:
    content = path.read_bytes()
    for size in np.linspace(8, len(content) - 1, 60).astype(int):
        path.write_bytes(content[:size])
        message(path)


def test_attributes_on_the_scans_are_understood(path: Path) -> None:
    with h5py.File(path, "r+") as file:
        for key, value in file["nodes/n1"].attrs.items():
            file["nodes/n1/scans"].attrs[key] = value
            del file["nodes/n1"].attrs[key]
    assert read(path).nodes[0].node_id == 1
