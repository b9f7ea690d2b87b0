"""A recording in memory: what nodes measured, what was true, and what a pipeline said about it."""

from dataclasses import dataclass
from typing import Final, TypedDict

import numpy as np
from numpy.typing import NDArray

FORMAT: Final = "echofuse-recording"
VERSION: Final = 1

#: One row a detection: what a node reported. `node` indexes `Recording.nodes`.
DETECTION_DTYPE = np.dtype(
    [("frame", "i4"), ("node", "i4"), ("time_us", "i8"), ("delay_s", "f4"), ("weight", "f4")]
)
#: One row a living track and frame. `state`: 0 unconfirmed, 1 confirmed, 2 silent. SPATIAL_COLUMNS are NaN
#: where the pipeline is planar, as all were when recordings did not have them yet.
TRACK_DTYPE = np.dtype(
    [
        ("frame", "i4"),
        ("time_us", "i8"),
        ("id", "i4"),
        ("state", "u1"),
        ("frames_since_update", "i4"),
        ("x_m", "f4"),
        ("y_m", "f4"),
        ("z_m", "f4"),
        ("vx_mps", "f4"),
        ("vy_mps", "f4"),
        ("vz_mps", "f4"),
        ("covariance_xx_m2", "f4"),
        ("covariance_xy_m2", "f4"),
        ("covariance_yy_m2", "f4"),
        ("covariance_xz_m2", "f4"),
        ("covariance_yz_m2", "f4"),
        ("covariance_zz_m2", "f4"),
    ]
)
SPATIAL_COLUMNS = ("z_m", "vz_mps", "covariance_xz_m2", "covariance_yz_m2", "covariance_zz_m2")
PLANAR_TRACK_DTYPE = np.dtype(
    [(name, TRACK_DTYPE[name]) for name in TRACK_DTYPE.names or () if name not in SPATIAL_COLUMNS]
)

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
    detections: NDArray[np.void]  # (n,) DETECTION_DTYPE, ascending frame
    tracks: NDArray[np.void]  # (n,) TRACK_DTYPE, ascending frame


@dataclass(frozen=True, kw_only=True)
class Emulated:
    """By which faults the outputs came about (docs/emulation.md); the scans are those before any fault."""

    scenario: str  # name
    seed: int
    scenario_toml: str  # the scenario file as used, may be empty


@dataclass(frozen=True, kw_only=True, eq=False)
class Recording:
    """One recording, as `read` returns it."""

    pipeline: str
    created: str  # ISO 8601
    site_toml: str  # the site file as used, may be empty
    nodes: tuple[NodeRecording, ...]
    truth: tuple[PersonTruth, ...] = ()
    outputs: Outputs | None = None
    emulated: Emulated | None = None
