"""What pictures need to know about a run besides its tables: who stood where and when."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS

if TYPE_CHECKING:
    from echofuse.recording import NodeRecording
    from echofuse.result import RunResult
    from echofuse.site import Site

MONOSTATIC_WITHIN_M = 0.5  # two antennas of one module stand closer than this


@dataclass(frozen=True, kw_only=True)
class Person:
    """Where one person truly was."""

    name: str
    time_s: NDArray[np.float64]  # (n,) on the hub's clock [s]
    position_m: NDArray[np.float64]  # (n, 2)

    def at(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the position (n_times, 2) [m], NaN when the person is not there."""
        axes = [np.interp(time_s, self.time_s, self.position_m[:, axis]) for axis in (0, 1)]
        position = np.stack(axes, axis=-1)
        slack_s = 1e-6 + (float(np.median(np.diff(self.time_s))) if self.time_s.size > 1 else 0.0)
        away = (time_s < self.time_s[0] - slack_s) | (time_s > self.time_s[-1] + slack_s)
        position[away] = np.nan
        return position


def people(result: RunResult) -> list[Person]:
    """Return the people of the truth, none when the recording knows nobody."""
    return [
        Person(
            name=person.id,
            time_s=np.asarray(person.time_s, dtype=np.float64),
            position_m=np.asarray(person.position_m, dtype=np.float64)[:, :2],
        )
        for person in result.recording.truth
        if person.time_s.size > 0
    ]


def frame_time_s(result: RunResult) -> NDArray[np.float64]:
    """Return the frames' times (n_frames,) on the hub's clock [s]."""
    return np.asarray(result.frame_time_us, dtype=np.float64) * 1e-6


def elapsed_s(result: RunResult, time_us: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return times [us] of the hub's clock as seconds since the first frame."""
    start_us = int(result.frame_time_us[0]) if result.frame_time_us.size else 0
    return np.asarray((np.asarray(time_us, dtype=np.int64) - start_us) * 1e-6, dtype=np.float64)


def node_by_name(result: RunResult, name: str) -> NodeRecording:
    """Return the recording of node `name`; KeyError when there is none."""
    for node in result.recording.nodes:
        if node.name == name:
            return node
    raise KeyError(name)


def echo_delay_s(node: NodeRecording, position_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the delay Tx -> position (n, 2) or (n, 3) -> Rx as (n,) [s], in the plane or in space."""
    dimension = position_m.shape[-1]
    tx_m = np.asarray(node.tx_position_m, dtype=np.float64)[:dimension]
    rx_m = np.asarray(node.rx_position_m, dtype=np.float64)[:dimension]
    path_m = np.linalg.norm(position_m - tx_m, axis=-1) + np.linalg.norm(position_m - rx_m, axis=-1)
    return np.asarray(path_m / SPEED_OF_LIGHT_MPS)


def monostatic_within_m(result: RunResult) -> float:
    """Return how near to each other Tx and Rx of one module are; of a handheld before a wall none are one."""
    return 0.0 if behind_wall(result) else MONOSTATIC_WITHIN_M


def is_monostatic(node: NodeRecording, within_m: float) -> bool:
    """Whether a node hears its own transmitter, not farther than `within_m`."""
    apart_m = np.linalg.norm(np.asarray(node.tx_position_m)[:2] - np.asarray(node.rx_position_m)[:2])
    return bool(apart_m < within_m)


def sample_delay_s(result: RunResult, name: str, n_samples: int) -> NDArray[np.float64]:
    """Return each sample's propagation delay (n_samples,) [s]: the node's, else the recording's."""
    stack = result.stacks.get(name)
    if stack is not None and stack.delay_s.size == n_samples:
        return np.asarray(stack.delay_s, dtype=np.float64)
    node = node_by_name(result, name)
    return np.asarray(float(node.first_sample_s) + np.arange(n_samples) / float(node.sample_rate_hz))


def area_outline_m(site: Site) -> NDArray[np.float64]:
    """Return the watched area's outline (n, 2) [m]."""
    return np.asarray(site.area, dtype=np.float64).reshape(-1, 2)


def area_corners_m(site: Site) -> NDArray[np.float64]:
    """Return the corners of the watched area (n, 2) or box (2 n, 3) [m]."""
    outline = area_outline_m(site)
    if site.heights_m is None:
        return outline
    return np.concatenate([np.column_stack([outline, np.full(len(outline), z)]) for z in site.heights_m])


def truth_path_m(site: Site) -> NDArray[np.float64] | None:
    """Return the path (n, 2) [m] that the site says was walked, None when it says nothing."""
    return None if site.truth is None else np.asarray(site.truth.path_m, dtype=np.float64).reshape(-1, 2)


def behind_wall(result: RunResult) -> bool:
    """Whether the run's people are behind a wall."""
    return _is_behind_wall(result.site)


def in_space(result: RunResult) -> bool:
    """Whether the run's positions have a height."""
    from echofuse.site import PIPELINES

    kind = PIPELINES.get(result.site.pipeline)
    return kind is not None and kind.dimension == 3


def _is_behind_wall(site: Site) -> bool:
    from echofuse.site import PIPELINES

    kind = PIPELINES.get(site.pipeline)
    return kind is not None and kind.behind_wall


def tracker_name(result: RunResult) -> str:
    """Return what the run's tracker is called in tables and legends."""
    return tracker_of(result.site)


def tracker_of(site: Site) -> str:
    """Return what a site's tracker is called."""
    settings = site.settings
    if _is_behind_wall(site):
        return "Path tracker" if settings.get("track_aided", True) else "Kalman filter"
    names = {"phd": "PHD filter", "kalman": "Kalman filter", "range": "Path tracker"}
    return names.get(str(settings.get("tracker", "phd")), "Tracker")


def baseline_name(result: RunResult) -> str:
    """Return what the simpler way beside it is called."""
    if in_space(result):
        return "Pairing, TSM, then Kalman"
    return "Pairing, then Kalman" if behind_wall(result) else "Kalman baseline"
