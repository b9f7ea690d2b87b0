"""What a run of the `sensor_radar` pipeline leaves behind: the tables of reports, metrics and files."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from echofuse.recording import Outputs, Recording
    from echofuse.site import Site

#: One row a detection: what a node reported. `node` indexes `Recording.nodes`.
DETECTION_DTYPE = np.dtype(
    [("frame", "i4"), ("node", "i4"), ("time_us", "i8"), ("delay_s", "f4"), ("weight", "f4")]
)
#: One row a point that the tracker was given. [m]
POINT_DTYPE = np.dtype(
    [("frame", "i4"), ("time_us", "i8"), ("x_m", "f4"), ("y_m", "f4"), ("members", "f4"), ("weight", "f4")]
)
#: One row a living track and frame. `state`: 0 unconfirmed, 1 confirmed, 2 silent.
TRACK_DTYPE = np.dtype(
    [
        ("frame", "i4"),
        ("time_us", "i8"),
        ("id", "i4"),
        ("state", "u1"),
        ("frames_since_update", "i4"),
        ("x_m", "f4"),
        ("y_m", "f4"),
        ("vx_mps", "f4"),
        ("vy_mps", "f4"),
        ("covariance_xx_m2", "f4"),
        ("covariance_xy_m2", "f4"),
        ("covariance_yy_m2", "f4"),
    ]
)


@dataclass(kw_only=True)
class NodeStack:
    """One node's scans after its stages, one row a scan (the paper's Fig. 6)."""

    residual: NDArray[np.float32]  # (n_scans, n_samples) rectified amplitude after clutter removal [count]
    decisions: NDArray[np.uint8]  # (n_scans, n_samples) detector output
    clusters: list[
        NDArray[np.float32]
    ]  # per scan (n_clusters, 4) position [sample], weight, first, last sample
    delay_s: NDArray[np.float64]  # (n_samples,) propagation delay Tx -> person -> Rx of each sample [s]


@dataclass(kw_only=True)
class RunResult:
    """Everything that one run said, frame by frame."""

    site: "Site"
    recording: "Recording"
    frame_time_us: NDArray[np.int64]  # (n_frames,) hub clock [us]
    detections: NDArray[np.void]  # DETECTION_DTYPE
    points: NDArray[np.void]  # POINT_DTYPE
    tracks: NDArray[np.void]  # TRACK_DTYPE, the configured tracker
    baseline_tracks: NDArray[np.void]  # TRACK_DTYPE, Kalman filter with global nearest neighbour, same points
    metrics: dict[str, float]  # flat, names carry units (see `design.md` section 7)
    baseline_metrics: dict[str, float]
    counters: dict[str, dict[str, int]]  # "hub" and each node's name -> counter -> count
    stacks: dict[str, NodeStack] = field(default_factory=dict)  # by node name, when taps were asked for
    shown_frame: int = 0  # the frame whose stages the report shows
    shown_taps: dict[str, dict[str, NDArray[Any]]] = field(
        default_factory=dict
    )  # node name -> tap name -> values

    def outputs(self) -> "Outputs":
        """Return what a recording keeps of this run, each frame with its hash."""
        from echofuse.recording import Outputs, frame_digest

        frames = np.arange(len(self.frame_time_us) + 1)
        starts = [np.searchsorted(table["frame"], frames) for table in (self.detections, self.tracks)]
        digests = [
            frame_digest(
                int(time_us),
                self.detections[starts[0][frame] : starts[0][frame + 1]],
                self.tracks[starts[1][frame] : starts[1][frame + 1]],
            )
            for frame, time_us in enumerate(self.frame_time_us)
        ]
        return Outputs(
            target="inprocess",
            frame_time_us=self.frame_time_us,
            frame_hash=np.frombuffer(b"".join(digests), np.uint8).reshape(-1, 32),
            detections=self.detections,
            tracks=self.tracks,
        )
