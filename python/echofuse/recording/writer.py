"""Writes a recording in blocks as it comes; after a crash it is readable up to the last flushed scan."""

import hashlib
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Self

import h5py
import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from echofuse.errors import InputError, problem
from echofuse.recording.growing_table import GrowingTable
from echofuse.recording.model import (
    DETECTION_DTYPE,
    FORMAT,
    PLANAR_TRACK_DTYPE,
    SPATIAL_COLUMNS,
    TRACK_DTYPE,
    VERSION,
    Emulated,
    NodeRecording,
    PersonTruth,
    Pulse,
    Recording,
)
from echofuse.site import PIPELINES

__all__ = ["PULSE_DTYPE", "RecordingWriter", "frame_digest", "frame_rows", "write"]

PULSE_DTYPE = np.dtype([("kind", "S32"), ("centre_hz", "f8"), ("bandwidth_hz", "f8")])
_BLOCK_BYTES = 1 << 18  # of one node's scans; large enough that HDF5's cost a call vanishes
_BLOCK_FRAMES = 64
_BLOCK_ROWS = 256


def frame_digest(time_us: int, detections: NDArray[np.void], tracks: NDArray[np.void]) -> bytes:
    """Return SHA-256 over the bytes of one frame's outputs (32 bytes).

    Little-endian: int64 time, uint32 number of detections, their DETECTION_DTYPE rows, uint32 number of
    tracks, their TRACK_DTYPE rows; of a planar pipeline, whose z is NaN, PLANAR_TRACK_DTYPE.
    """
    digest = hashlib.sha256(np.array(time_us, "<i8").tobytes())
    if np.all(np.isnan(tracks["z_m"])):
        tracks = tracks[list(PLANAR_TRACK_DTYPE.names or ())].astype(PLANAR_TRACK_DTYPE)
    for rows in (detections, tracks):
        digest.update(np.array(rows.size, "<u4").tobytes())
        digest.update(rows.astype(rows.dtype.newbyteorder("<")).tobytes())
    return digest.digest()


def frame_rows(
    values: NDArray[np.void], dtype: np.dtype[np.void], frame: int, time_us: int, *, pipeline: str
) -> NDArray[np.void]:
    """Return a frame's rows (n,) as a recording has them.

    values: (n,) with the fields of `dtype`. They may lack `frame`, `time_us`, which is the frame's then, and
    what is of z, which is NaN then, as it always is where the pipeline is planar.
    """
    kind = PIPELINES.get(pipeline)
    given = set(values.dtype.names or ())
    if kind is not None and kind.dimension == 2:
        given -= set(SPATIAL_COLUMNS)
    rows = np.zeros(len(values), dtype)
    for name in dtype.names or ():
        if name == "frame":
            rows[name] = frame
        elif name == "time_us" and name not in given:
            rows[name] = time_us
        elif name in SPATIAL_COLUMNS and name not in given:
            rows[name] = np.nan
        else:
            rows[name] = values[name]
    return rows


class RecordingWriter:
    """A recording file being written; a context manager.

    Rows wait in memory until a block is full, then go out with everything else that waits: first the data,
    then (after a flush to the operating system) the times that count them. Between blocks the file rests.
    """

    def __init__(
        self,
        path: str | Path,
        *,
        pipeline: str,
        site_toml: str = "",
        created: str | None = None,
        target: str = "",
    ) -> None:
        self.path = Path(path)
        try:
            self._file = h5py.File(self.path, "w")
        except OSError as error:
            raise InputError(problem(self.path, "", "a file that can be written", str(error))) from error
        self._file.attrs["format"] = FORMAT
        self._file.attrs["version"] = VERSION
        self._file.attrs["pipeline"] = pipeline
        self._file.attrs["created"] = created or datetime.now(UTC).isoformat(timespec="seconds")
        self._file["site"] = site_toml
        self._file.create_group("nodes", track_order=True)
        self._pipeline, self._target = pipeline, target
        self._nodes: dict[str, _NodeTables] = {}
        self._outputs: _OutputTables | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def note_emulation(self, emulated: Emulated) -> None:
        """Note by which faults the outputs come about."""
        self._file["scenario"] = emulated.scenario_toml
        self._file["scenario"].attrs["name"] = emulated.scenario
        self._file["scenario"].attrs["seed"] = emulated.seed

    def add_node(
        self,
        name: str,
        *,
        node_id: int,
        n_samples: int,
        sample_rate_hz: float,
        first_sample_s: float,
        tx_position_m: ArrayLike,
        rx_position_m: ArrayLike,
        dtype: DTypeLike = np.float32,
        pulse: Pulse | None = None,
        reference: ArrayLike | None = None,
    ) -> None:
        """Declare a node before its first scan; positions (3,) [m], reference (n_reference, n_samples)."""
        kind = np.dtype(dtype)
        if kind not in (np.dtype(np.float32), np.dtype(np.int32)):
            raise ValueError(f"scans of {name} must be float32 or int32, not {kind}")
        if not name or "/" in name or name in self._nodes:
            raise ValueError(f"node name {name!r} is empty, has a slash or is taken")
        group = self._file.create_group(f"nodes/{name}")
        group.attrs["node_id"] = node_id
        group.attrs["sample_rate_hz"] = float(sample_rate_hz)
        group.attrs["first_sample_s"] = float(first_sample_s)
        group.attrs["tx_position_m"] = np.asarray(tx_position_m, np.float64).reshape(3)
        group.attrs["rx_position_m"] = np.asarray(rx_position_m, np.float64).reshape(3)
        if pulse is not None:
            row = (pulse["kind"].encode(), pulse["centre_hz"], pulse["bandwidth_hz"])
            group.attrs["pulse"] = np.array(row, PULSE_DTYPE)
        if reference is not None:
            group["reference"] = np.asarray(reference, kind).reshape(-1, n_samples)
        block_rows = max(1, _BLOCK_BYTES // (4 * n_samples))
        self._nodes[name] = _NodeTables(
            scans=GrowingTable(group, "scans", (n_samples,), kind, block_rows=block_rows),
            time_s=GrowingTable(group, "time_s", (), np.float64, block_rows=_BLOCK_ROWS),
        )

    def append_scans(self, name: str, time_s: ArrayLike, scans: ArrayLike) -> None:
        """Append to a node: time_s (n,) or a number [s], scans (n, n_samples) or (n_samples,) [count]."""
        node = self._nodes[name]
        times = np.atleast_1d(np.asarray(time_s, np.float64))
        rows = np.atleast_2d(np.asarray(scans))
        expected = (times.size, *node.scans.columns)
        if rows.dtype != node.scans.dtype or rows.shape != expected:
            raise ValueError(
                f"scans of {name} must be {node.scans.dtype} {expected}, not {rows.dtype} {rows.shape}"
            )
        node.scans.append(rows)
        node.time_s.append(times)
        if node.scans.full:
            self.flush()

    def add_person(self, person: PersonTruth) -> None:
        """Write the truth about one person."""
        group = self._file.create_group(f"truth/people/{person.id}")
        group["time_s"] = np.asarray(person.time_s, np.float64)
        group["position_m"] = np.asarray(person.position_m, np.float64).reshape(-1, 3)
        optional = {"breathing_hz": person.breathing_hz, "height_m": person.height_m, "motion": person.motion}
        for key, value in optional.items():
            if value is not None:
                group.attrs[key] = value

    def append_frame(self, time_us: int, detections: NDArray[np.void], tracks: NDArray[np.void]) -> bytes:
        """Append one frame's outputs and return its hash.

        Rows are structured arrays with at least the fields of DETECTION_DTYPE and TRACK_DTYPE; `frame` is
        counted here, and what else they may lack says `frame_rows`.
        """
        if self._outputs is None:
            self._outputs = _create_outputs(self._file, self._target)
        tables = self._outputs
        detection_rows, track_rows = (
            frame_rows(values, dtype, tables.n_frames, time_us, pipeline=self._pipeline)
            for values, dtype in ((detections, DETECTION_DTYPE), (tracks, TRACK_DTYPE))
        )
        digest = frame_digest(time_us, detection_rows, track_rows)
        tables.detections.append(detection_rows)
        tables.tracks.append(track_rows)
        tables.frame_hash.append(np.frombuffer(digest, np.uint8)[np.newaxis])
        tables.frame_time_us.append(np.array([time_us], np.int64))
        tables.n_frames += 1
        if tables.frame_time_us.full:
            self.flush()
        return digest

    def flush(self) -> None:
        """Write all that waits: from here on it survives a crash."""
        data: list[GrowingTable] = [node.scans for node in self._nodes.values()]
        counters: list[GrowingTable] = [node.time_s for node in self._nodes.values()]
        if self._outputs is not None:
            data += [self._outputs.detections, self._outputs.tracks, self._outputs.frame_hash]
            counters.append(self._outputs.frame_time_us)
        for tables in (data, counters):
            for table in tables:
                table.write()
            self._file.flush()

    def close(self) -> None:
        """Write all that waits and close the file."""
        if self._file:
            self.flush()
            self._file.close()


def write(path: str | Path, recording: Recording) -> None:
    """Write a whole recording at once."""
    target = recording.outputs.target if recording.outputs is not None else ""
    with RecordingWriter(
        path,
        pipeline=recording.pipeline,
        site_toml=recording.site_toml,
        created=recording.created,
        target=target,
    ) as writer:
        if recording.emulated is not None:
            writer.note_emulation(recording.emulated)
        for node in recording.nodes:
            _write_node(writer, node)
        for person in recording.truth:
            writer.add_person(person)
        outputs = recording.outputs
        if outputs is not None:
            for frame, time_us in enumerate(outputs.frame_time_us):
                detections = outputs.detections[outputs.detections["frame"] == frame]
                tracks = outputs.tracks[outputs.tracks["frame"] == frame]
                writer.append_frame(int(time_us), detections, tracks)


@dataclass
class _NodeTables:
    scans: GrowingTable
    time_s: GrowingTable


@dataclass
class _OutputTables:
    detections: GrowingTable
    tracks: GrowingTable
    frame_hash: GrowingTable
    frame_time_us: GrowingTable
    n_frames: int = 0


def _create_outputs(file: h5py.File, target: str) -> _OutputTables:
    group = file.create_group("outputs")
    group.attrs["target"] = target
    group.attrs["hash"] = "sha256"

    return _OutputTables(
        detections=GrowingTable(group, "detections", (), DETECTION_DTYPE, block_rows=_BLOCK_ROWS),
        tracks=GrowingTable(group, "tracks", (), TRACK_DTYPE, block_rows=_BLOCK_ROWS),
        frame_hash=GrowingTable(group, "frame_hash", (32,), np.uint8, block_rows=_BLOCK_FRAMES),
        frame_time_us=GrowingTable(group, "frame_time_us", (), np.int64, block_rows=_BLOCK_FRAMES),
    )


def _write_node(writer: RecordingWriter, node: NodeRecording) -> None:
    writer.add_node(
        node.name,
        node_id=node.node_id,
        n_samples=node.scans.shape[1],
        sample_rate_hz=node.sample_rate_hz,
        first_sample_s=node.first_sample_s,
        tx_position_m=node.tx_position_m,
        rx_position_m=node.rx_position_m,
        dtype=node.scans.dtype,
        pulse=node.pulse,
        reference=node.reference,
    )
    writer.append_scans(node.name, node.time_s, node.scans)
