"""A recording in memory: what nodes measured, what was true, and what a pipeline said about it."""

from dataclasses import dataclass
from typing import Final, TypedDict

import numpy as np
from numpy.typing import NDArray

FORMAT: Final = "echofuse-recording"
VERSION: Final = 1

#: Scans are kept in the type in which the radar delivers them. [count]
Scans = NDArray[np.float32] | NDArray[np.int32]


class Pulse(TypedDict):
    """What the transmitter sends."""

    kind: str  # such as "gaussian" or "p410"
    centre_hz: float
    bandwidth_hz: float  # -10 dB


@dataclass(frozen=True, kw_only=True, eq=False)
class NodeRecording:
    """One node's raw scans."""

    name: str
    node_id: int
    sample_rate_hz: float
    first_sample_s: float  # propagation delay that sample 0 stands for [s]
    tx_position_m: NDArray[np.float64]  # (3,)
    rx_position_m: NDArray[np.float64]  # (3,)
    time_s: NDArray[np.float64]  # (n_scans,) the node's own clock
    scans: Scans  # (n_scans, n_samples) [count]
    reference: Scans | None = None  # (n_reference, n_samples) scans of the empty room [count]
    pulse: Pulse | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class PersonTruth:
    """Where one person really was. Present from the first to the last of `time_s`."""

    id: str
    time_s: NDArray[np.float64]  # (n,) ascending
    position_m: NDArray[np.float64]  # (n, 3)
    breathing_hz: float | None = None
    height_m: float | None = None
    motion: str | None = None  # such as "walk"


@dataclass(frozen=True, kw_only=True, eq=False)
class Outputs:
    """What a pipeline said, frame by frame."""

    target: str  # what it ran on
    frame_time_us: NDArray[np.int64]  # (n_frames,) hub clock [us]
    frame_hash: NDArray[np.uint8]  # (n_frames, 32) see `frame_digest`
    detections: NDArray[np.void]  # (n,) result.DETECTION_DTYPE, ascending frame
    tracks: NDArray[np.void]  # (n,) result.TRACK_DTYPE, ascending frame


@dataclass(frozen=True, kw_only=True, eq=False)
class Recording:
    """One recording, as `read` returns it."""

    pipeline: str
    created: str  # ISO 8601
    site_toml: str  # the site file as used, may be empty
    nodes: tuple[NodeRecording, ...]
    truth: tuple[PersonTruth, ...] = ()
    outputs: Outputs | None = None
