"""A writer that is killed leaves a recording that is readable up to the last flushed scan."""

import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from echofuse.recording import read

WRITER = """
import sys
import numpy as np
from echofuse.recording import RecordingWriter
from echofuse.recording import DETECTION_DTYPE, TRACK_DTYPE

writer = RecordingWriter(sys.argv[1], pipeline="sensor_radar", site_toml="x = 1")
for node in range(3):
    writer.add_node(f"n{node}", node_id=node, n_samples=400, sample_rate_hz=1e9, first_sample_s=0.0,
                    tx_position_m=(0, 0, 0), rx_position_m=(node, 1, 0), dtype=np.int32)
for scan in range(10**9):
    for node in range(3):
        writer.append_scans(f"n{node}", scan * 0.5, np.full(400, 1000 * scan + node, np.int32))
    tracks = np.zeros(1, TRACK_DTYPE)
    tracks["x_m"] = scan
    writer.append_frame(scan, np.zeros(0, DETECTION_DTYPE), tracks)
    if scan % 50 == 0:
        writer.flush()
        print(scan, flush=True)
"""


@pytest.mark.parametrize("delay_s", [0.0, 0.013, 0.05, 0.11, 0.17])
def test_killed_in_the_middle(tmp_path: Path, delay_s: float) -> None:
    path = tmp_path / "r.h5"
    process = subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    for _ in range(3):
        last = process.stdout.readline()
    time.sleep(delay_s)
    process.kill()  # SIGKILL: nothing gets a chance to tidy up
    rest, _ = process.communicate()
    flushed = int((rest.split() or [last])[-1]) if rest.endswith("\n") or not rest else int(last)
    recording = read(path)
    assert recording.site_toml == "x = 1"
    for index, node in enumerate(recording.nodes):
        n_scans = len(node.time_s)
        assert n_scans > flushed  # scan number `flushed` is the last one that was promised
        np.testing.assert_array_equal(node.time_s, 0.5 * np.arange(n_scans))
        expected = 1000 * np.arange(n_scans) + index
        np.testing.assert_array_equal(node.scans, np.repeat(expected[:, np.newaxis], 400, axis=1))
    outputs = recording.outputs
    assert outputs is not None
    n_frames = len(outputs.frame_time_us)
    assert n_frames > flushed
    np.testing.assert_array_equal(outputs.tracks["x_m"], np.arange(n_frames))
    assert np.all(outputs.frame_hash.any(axis=1))


def test_scans_whose_times_were_not_written_yet_do_not_count(tmp_path: Path) -> None:
    """The state between the two flushes of a block."""
    path = tmp_path / "r.h5"
    with h5py.File(path, "w") as file:
        file.attrs.update({"format": "echofuse-recording", "version": 1, "pipeline": "p", "created": "c"})
        group = file.create_group("nodes/a")
        position = np.zeros(3)
        group.attrs.update(
            {"node_id": 1, "sample_rate_hz": 1e9, "first_sample_s": 0.0, "tx_position_m": position}
        )
        group.attrs["rx_position_m"] = position
        group["scans"] = np.arange(12, dtype=np.float32).reshape(6, 2)
        group["time_s"] = np.arange(4.0)
    (node,) = read(path).nodes
    assert node.scans.shape == (4, 2)
