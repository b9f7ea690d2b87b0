"""Reads a recording and checks everything in it; what is wrong is one line with the file and the key."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from echofuse.errors import InputError, problem
from echofuse.recording.model import (
    DETECTION_DTYPE,
    FORMAT,
    SPATIAL_COLUMNS,
    TRACK_DTYPE,
    VERSION,
    Emulated,
    NodeRecording,
    Outputs,
    PersonTruth,
    Pulse,
    Recording,
    Scans,
)

__all__ = ["read"]


def read(path: str | Path) -> Recording:
    """Read a whole recording.

    Raises
    ------
    InputError
        One line, when the file is missing, foreign, truncated, newer than this version, empty, or has a
        dataset or attribute that is missing, of another shape or type, or not finite. NaN samples inside
        scans are kept: the node rejects and counts such scans.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(problem(path, "", "a recording (HDF5 file)", "no such file"))
    try:
        if not h5py.is_hdf5(path):
            raise InputError(problem(path, "", "a recording (HDF5 file)", "another kind of file"))
        with h5py.File(path, "r") as file:
            return _Reader(path, file).recording()
    except (OSError, RuntimeError, ValueError, TypeError, KeyError) as error:
        raise InputError(problem(path, "", "a whole HDF5 file", f"a damaged one ({error})")) from error


class _Reader:
    """Turns the parts of one open file into a `Recording`."""

    def __init__(self, path: Path, file: h5py.File) -> None:
        self.path = path
        self.file = file

    def error(self, key: str, expected: str, found: object = None) -> InputError:
        return InputError(problem(self.path, key, expected, found))

    def recording(self) -> Recording:
        attributes = self.file.attrs
        if "format" not in attributes or _text(attributes["format"]) != FORMAT:
            raise self.error(
                "format", f'the attribute format = "{FORMAT}"', "the HDF5 file of another program"
            )
        version = self.integer(self.file, "version")
        if not 1 <= version <= VERSION:
            raise self.error("version", f"at most {VERSION}, the newest that this program reads", version)
        nodes = self.group("nodes")
        if len(nodes) == 0:
            raise self.error("/nodes", "at least one node", "none")
        recordings = tuple(self.node(name) for name in nodes)
        if not any(len(node.time_s) for node in recordings):
            raise self.error("/nodes", "at least one scan", "an empty recording")
        return Recording(
            pipeline=self.string(self.file, "pipeline"),
            created=self.string(self.file, "created"),
            site_toml=self.site(),
            nodes=recordings,
            truth=self.truth(),
            outputs=self.outputs(),
            emulated=self.emulated(),
        )

    def emulated(self) -> Emulated | None:
        if "scenario" not in self.file:
            return None
        source = self.file["scenario"]
        return Emulated(
            scenario=self.string(source, "name"),
            seed=self.integer(source, "seed"),
            scenario_toml=self.text("scenario", "one string, the scenario file"),
        )

    def site(self) -> str:
        return self.text("site", "one string, the site file") if "site" in self.file else ""

    def text(self, key: str, expected: str) -> str:
        dataset = self.file[key]
        if (
            not isinstance(dataset, h5py.Dataset)
            or dataset.shape != ()
            or h5py.check_string_dtype(dataset.dtype) is None
        ):
            raise self.error(f"/{key}", expected)
        return _text(dataset[()])

    def node(self, name: str) -> NodeRecording:
        key = f"/nodes/{name}"
        group = self.group(key)
        scans = self.scans(f"{key}/scans")
        # The attributes belong to the node; recordings that have them on its scans are understood as well.
        source = group["scans"] if "node_id" in group["scans"].attrs else group
        time_s = self.array(f"{key}/time_s", "f", (None,), "(n_scans,) float64")
        # A writer that crashed may have left scans whose times it had not written yet: these do not count.
        n_scans = len(time_s)
        if n_scans > len(scans):
            raise self.error(f"{key}/time_s", f"one time for each of {len(scans)} scans", n_scans)
        reference = self.scans(f"{key}/reference") if "reference" in group else None
        if reference is not None and reference.shape[1] != scans.shape[1]:
            raise self.error(
                f"{key}/reference", f"(n_reference, {scans.shape[1]}) as scans", str(reference.shape)
            )
        return NodeRecording(
            name=name,
            node_id=self.integer(source, "node_id"),
            sample_rate_hz=self.number(source, "sample_rate_hz", "positive [Hz]", lambda value: value > 0.0),
            first_sample_s=self.number(source, "first_sample_s", "a delay [s]"),
            tx_position_m=self.position(source, "tx_position_m"),
            rx_position_m=self.position(source, "rx_position_m"),
            time_s=self.finite(f"{key}/time_s", time_s),
            scans=scans[:n_scans],
            reference=reference if reference is not None and len(reference) else None,
            pulse=self.pulse(source),
        )

    def scans(self, key: str) -> Scans:
        dataset = self.dataset(key)
        if dataset.dtype.newbyteorder("=") not in (np.dtype(np.float32), np.dtype(np.int32)):
            raise self.error(key, "float32 or int32", str(dataset.dtype))
        if len(dataset.shape) != 2 or dataset.shape[1] == 0:
            raise self.error(key, "shape (n_scans, n_samples)", str(dataset.shape))
        if dataset.dtype.kind == "i":
            return np.asarray(dataset[()], np.int32)
        return np.asarray(dataset[()], np.float32)

    def truth(self) -> tuple[PersonTruth, ...]:
        if "truth/people" not in self.file:
            return ()
        return tuple(self.person(name) for name in self.group("truth/people"))

    def person(self, name: str) -> PersonTruth:
        key = f"/truth/people/{name}"
        group = self.group(key)
        time_s = self.finite(f"{key}/time_s", self.array(f"{key}/time_s", "f", (None,), "(n,) float64"))
        position_m = self.array(f"{key}/position_m", "f", (len(time_s), 3), f"({len(time_s)}, 3) float64")
        if np.any(np.diff(time_s) < 0.0):
            raise self.error(f"{key}/time_s", "ascending times")
        return PersonTruth(
            id=name,
            time_s=time_s,
            position_m=self.finite(f"{key}/position_m", position_m),
            breathing_hz=self.number(group, "breathing_hz", "a rate [Hz]")
            if "breathing_hz" in group.attrs
            else None,
            height_m=self.number(group, "height_m", "a height [m]") if "height_m" in group.attrs else None,
            motion=self.string(group, "motion") if "motion" in group.attrs else None,
        )

    def outputs(self) -> Outputs | None:
        if "outputs" not in self.file:
            return None
        group = self.group("outputs")
        time_us = self.array("/outputs/frame_time_us", "i", (None,), "(n_frames,) int64").astype(np.int64)
        n_frames = len(time_us)
        frame_hash = self.array("/outputs/frame_hash", "u", (None, 32), "(n_frames, 32) uint8")
        if len(frame_hash) < n_frames:
            raise self.error("/outputs/frame_hash", f"{n_frames} frames as in frame_time_us", len(frame_hash))
        return Outputs(
            target=self.string(group, "target"),
            frame_time_us=time_us,
            frame_hash=frame_hash[:n_frames].astype(np.uint8),
            detections=self.table("/outputs/detections", DETECTION_DTYPE, n_frames),
            tracks=self.table("/outputs/tracks", TRACK_DTYPE, n_frames),
        )

    def table(self, key: str, dtype: np.dtype[np.void], n_frames: int) -> NDArray[np.void]:
        """Return the rows of whole frames; SPATIAL_COLUMNS, which older recordings lack, are NaN there."""
        dataset = self.dataset(key)
        names = dtype.names or ()
        known = (names, tuple(name for name in names if name not in SPATIAL_COLUMNS))
        if dataset.dtype.names not in known or len(dataset.shape) != 1:
            raise self.error(key, f"a table with the columns {', '.join(names)}")
        stored = np.asarray(dataset[()])
        rows = np.zeros(len(stored), dtype)
        for name in names:
            rows[name] = stored[name] if name in dataset.dtype.names else np.nan
        return rows[rows["frame"] < n_frames]

    def group(self, key: str) -> h5py.Group:
        found = self.file.get(key)
        if not isinstance(found, h5py.Group):
            raise self.error(_absolute(key), "a group", "none" if found is None else "a dataset")
        return found

    def dataset(self, key: str) -> h5py.Dataset:
        found = self.file.get(key)
        if not isinstance(found, h5py.Dataset):
            raise self.error(key, "a dataset", "none" if found is None else "a group")
        return found

    def array(self, key: str, kind: str, shape: tuple[int | None, ...], expected: str) -> NDArray[Any]:
        """Return a dataset of a numeric kind; None in `shape` stands for any length."""
        dataset = self.dataset(key)
        fits = len(dataset.shape) == len(shape) and all(
            want in (None, have) for want, have in zip(shape, dataset.shape, strict=True)
        )
        if dataset.dtype.kind != kind or not fits:
            raise self.error(key, expected, f"{dataset.shape} {dataset.dtype}")
        return np.asarray(dataset[()])

    def finite(self, key: str, values: NDArray[Any]) -> NDArray[np.float64]:
        if not np.all(np.isfinite(values)):
            raise self.error(key, "finite numbers", f"{int(np.sum(~np.isfinite(values)))} that are not")
        return values.astype(np.float64)

    def attribute(self, source: h5py.HLObject, key: str) -> Any:
        if key not in source.attrs:
            raise self.error(_key(source, key), "this attribute", "none")
        return source.attrs[key]

    def string(self, source: h5py.HLObject, key: str) -> str:
        value = self.attribute(source, key)
        if not isinstance(value, str | bytes):
            raise self.error(_key(source, key), "a string", value)
        return _text(value)

    def integer(self, source: h5py.HLObject, key: str) -> int:
        value = np.asarray(self.attribute(source, key))
        if value.size != 1 or value.dtype.kind not in "iu":
            raise self.error(_key(source, key), "an integer", str(value))
        return int(value.reshape(-1)[0])

    def number(
        self, source: h5py.HLObject, key: str, expected: str, fits: Callable[[float], bool] = lambda _: True
    ) -> float:
        value = np.asarray(self.attribute(source, key))
        if value.size != 1 or value.dtype.kind not in "iuf":
            raise self.error(_key(source, key), f"one number, {expected}", str(value))
        number = float(value.reshape(-1)[0])
        if not math.isfinite(number) or not fits(number):
            raise self.error(_key(source, key), f"one finite number, {expected}", str(number))
        return number

    def position(self, source: h5py.HLObject, key: str) -> NDArray[np.float64]:
        value = np.asarray(self.attribute(source, key))
        if value.shape != (3,) or value.dtype.kind not in "iuf" or not np.all(np.isfinite(value)):
            raise self.error(_key(source, key), "three finite numbers x, y, z [m]", str(value))
        return value.astype(np.float64)

    def pulse(self, source: h5py.HLObject) -> Pulse | None:
        if "pulse" not in source.attrs:
            return None
        value = np.asarray(source.attrs["pulse"])
        if value.shape != () or set(value.dtype.names or ()) != {"kind", "centre_hz", "bandwidth_hz"}:
            raise self.error(_key(source, "pulse"), "one compound of kind, centre_hz, bandwidth_hz")
        centre_hz, bandwidth_hz = float(value["centre_hz"]), float(value["bandwidth_hz"])
        if not all(math.isfinite(number) and number > 0.0 for number in (centre_hz, bandwidth_hz)):
            raise self.error(_key(source, "pulse"), "positive centre_hz and bandwidth_hz", str(value))
        return Pulse(kind=_text(value["kind"].item()), centre_hz=centre_hz, bandwidth_hz=bandwidth_hz)


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _absolute(key: str) -> str:
    return key if key.startswith("/") else f"/{key}"


def _key(source: h5py.HLObject, key: str) -> str:
    return key if source.name == "/" else f"{source.name}.{key}"
