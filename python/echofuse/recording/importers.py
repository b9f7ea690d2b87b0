"""Turns other people's recordings into ours."""

from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echofuse.errors import InputError, problem
from echofuse.recording.model import NodeRecording, Pulse, Recording
from echofuse.site import Site, SiteNode, example_site, example_sites

__all__ = ["LoggerFile", "import_logger", "read_logger", "recognise_site"]

SCAN_FIELDS = ("T", "Tstrt", "Tstp", "Nscn", "scn")
P4XX_PULSE = Pulse(kind="p4xx", centre_hz=4.3e9, bandwidth_hz=2.2e9)  # of every radar that this logger drives


@dataclass(frozen=True, kw_only=True, eq=False)
class LoggerFile:
    """One node's log as the vendor's logger wrote it (MATLAB structs `cfg` and `scn`)."""

    path: Path
    node_id: int
    time_s: NDArray[np.float64]  # (n_scans,) the host's clock [s]
    start_s: float  # of the first sample after the nominal transmit time [s]
    sample_period_s: float
    scans: NDArray[np.int32]  # (n_scans, n_samples) [count]


def import_logger(path: str | Path, site: Site | None = None) -> Recording:
    """Import a logger file, or a folder with one file a node, with the positions of a site.

    Without a site, one of the example sites is taken whose node ids are exactly those of the files. A single
    file gives a recording of one node, for looking at: a site needs more to position anybody.

    Raises
    ------
    InputError
        No file, not a logger's file, nodes doubled, mixed or unknown to the site, or no site known for them.
    """
    path = Path(path)
    logs = [read_logger(file) for file in _logger_files(path)]
    by_id: dict[int, LoggerFile] = {}
    for log in logs:
        if log.node_id in by_id:
            raise InputError(
                problem(log.path, "cfg.nodeID", f"another node than {by_id[log.node_id].path}", log.node_id)
            )
        by_id[log.node_id] = log
    chosen = site or recognise_site(set(by_id), path)
    places = {node.id: node for node in chosen.nodes}
    for node_id, log in by_id.items():
        if node_id not in places:
            known = ", ".join(str(known_id) for known_id in sorted(places))
            raise InputError(
                problem(log.path, "cfg.nodeID", f"a node of site '{chosen.name}' ({known})", node_id)
            )
    missing = sorted(set(places) - set(by_id))
    if missing and path.is_dir():
        raise InputError(
            problem(path, "", f"a file for every node of site '{chosen.name}'", f"none for {missing}")
        )
    # One time axis for the network: seconds since the earliest scan of any node.
    epoch_s = min(log.time_s[0] for log in logs)
    return Recording(
        pipeline=chosen.pipeline,
        created=_modified(path),
        site_toml=chosen.to_toml(),
        nodes=tuple(_node(by_id[node.id], node, epoch_s) for node in chosen.nodes if node.id in by_id),
    )


def recognise_site(node_ids: set[int], path: Path) -> Site:
    """Return the example site with exactly these nodes (for one file: with this node)."""
    for name in example_sites():
        site = example_site(name)
        known = {node.id for node in site.nodes}
        if node_ids == known or (path.is_file() and node_ids <= known):
            return site
    found = f"nodes {', '.join(map(str, sorted(node_ids)))}"
    raise InputError(problem(path, "", "--site SITE.toml with the positions of its nodes", found))


def read_logger(path: Path) -> LoggerFile:
    """Read one file of the logger.

    A scan's T is the host's clock [ms]; Tstrt and Tstp are the times of the first sample and of the last
    one's end after the nominal transmit time [ps], so that a sample takes (Tstp - Tstrt) / Nscn.
    """
    from scipy.io import loadmat  # heavy, and needed nowhere else

    try:
        content: dict[str, Any] = loadmat(
            path, squeeze_me=True, struct_as_record=True, variable_names=("cfg", "scn")
        )
    except Exception as error:  # loadmat raises almost anything at a damaged file
        raise InputError(
            problem(path, "", "a MATLAB file (version 4 to 7)", f"{type(error).__name__}: {error}")
        ) from error
    for name in ("cfg", "scn"):
        if name not in content or content[name].dtype.names is None:
            raise InputError(
                problem(path, name, f"a struct '{name}' as the radar's logger writes it", "none")
            )
    cfg, scn = np.atleast_1d(content["cfg"]), np.atleast_1d(content["scn"])
    missing = [f"scn.{key}" for key in SCAN_FIELDS if key not in (scn.dtype.names or ())]
    missing += [] if "nodeID" in (cfg.dtype.names or ()) else ["cfg.nodeID"]
    if missing:
        raise InputError(problem(path, missing[0], "this field, as the radar's logger writes it", "none"))
    if scn.size == 0:
        raise InputError(problem(path, "scn", "at least one scan", "none"))
    numbers = {key: _numbers(path, scn, key) for key in ("T", "Tstrt", "Tstp", "Nscn")}
    for key in ("Tstrt", "Tstp", "Nscn"):
        if np.any(numbers[key] != numbers[key][0]):
            raise InputError(
                problem(path, f"scn.{key}", "the same in all scans", str(np.unique(numbers[key])))
            )
    start_ps, stop_ps, n_samples = (float(numbers[key][0]) for key in ("Tstrt", "Tstp", "Nscn"))
    if not (stop_ps > start_ps and n_samples >= 1):
        raise InputError(problem(path, "scn.Tstp", f"more than Tstrt = {start_ps:g} ps", stop_ps))
    return LoggerFile(
        path=path,
        node_id=int(_numbers(path, cfg, "nodeID")[0]),
        time_s=numbers["T"] * 1e-3,
        start_s=start_ps * 1e-12,
        sample_period_s=(stop_ps - start_ps) * 1e-12 / n_samples,
        scans=_samples(path, scn, int(n_samples)),
    )


def _samples(path: Path, scn: NDArray[np.void], n_samples: int) -> NDArray[np.int32]:
    scans = np.empty((scn.size, n_samples), np.int32)
    for index, samples in enumerate(scn["scn"]):
        row = np.atleast_1d(np.asarray(samples))
        if row.dtype.kind not in "iu" or row.shape != (n_samples,):
            found = f"{row.dtype} {row.shape} in scan {index}"
            raise InputError(problem(path, "scn.scn", f"{n_samples} integers a scan", found))
        scans[index] = row
    return scans


def _numbers(path: Path, table: NDArray[np.void], key: str) -> NDArray[np.float64]:
    try:
        values = np.array([float(value) for value in table[key]])
    except (TypeError, ValueError) as error:
        raise InputError(problem(path, key, "one number each", str(error))) from error
    if not np.all(np.isfinite(values)):
        raise InputError(problem(path, key, "finite numbers", "others"))
    return values


def _node(log: LoggerFile, place: SiteNode, epoch_s: float) -> NodeRecording:
    return NodeRecording(
        name=place.name,
        node_id=place.id,
        sample_rate_hz=1.0 / log.sample_period_s,
        first_sample_s=log.start_s - place.transmit_delay_s,
        tx_position_m=np.array(place.tx_position_m),
        rx_position_m=np.array(place.rx_position_m),
        time_s=log.time_s - epoch_s,
        scans=log.scans,
        pulse=P4XX_PULSE,
    )


def _logger_files(path: Path) -> list[Path]:
    if path.is_file():
        return [path]
    files = sorted(path.glob("*.mat")) if path.is_dir() else []
    if not files:
        found = "none in this folder" if path.is_dir() else "no such file or folder"
        raise InputError(problem(path, "", "a logger's file (.mat), or a folder of them", found))
    return files


def _modified(path: Path) -> str:
    return datetime.fromtimestamp(path.stat().st_mtime, UTC).isoformat(timespec="seconds")
