"""What a run of a pipeline leaves behind: the tables of reports, metrics and files."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from echofuse.recording import Outputs, Recording, frame_digest

if TYPE_CHECKING:
    from echofuse.emulation.run import Emulation
    from echofuse.site import Site

#: One row a point that the tracker was given. [m] z_m is NaN where the pipeline is planar.
POINT_DTYPE = np.dtype(
    [
        *(("frame", "i4"), ("time_us", "i8")),
        *((name, "f4") for name in ("x_m", "y_m", "z_m", "members", "weight")),
    ]
)

#: A row a detection in a through-wall hub's frame. node: of the site's nodes; owner: the track that took it,
#: or minus the number of the couple that it was paired into, or 0.
ASSOCIATED_DTYPE = np.dtype([("frame", "i4"), ("node", "i4"), ("path_m", "f4"), ("owner", "i4")])


@dataclass(kw_only=True)
class NodeStack:
    """One node's scans after its stages, one row a scan (the paper's Fig. 6)."""

    residual: NDArray[np.float32]  # (n_scans, n_samples) rectified amplitude after clutter removal [count]
    decisions: NDArray[np.uint8]  # (n_scans, n_samples) detector output
    clusters: list[NDArray[np.float32]]  # per scan (n_clusters, 4), as the tap range_clusters
    delay_s: NDArray[np.float64]  # (n_samples,) propagation delay Tx -> person -> Rx of each sample [s]


@dataclass(kw_only=True)
class ResponseStack:
    """One through-wall receiver's responses after its stages, a row a response (the paper's Figs. 5, 6)."""

    #: (n_responses, n_kept) each, by tap: rotated and subtracted [count], enhanced [1]; zero if not judged
    images: dict[str, NDArray[np.float32]]
    decisions: NDArray[np.uint8]  # (n_responses, n_kept) detector output
    #: per response (n, 2), by tap: delay [s] and weight of target_traces, leading_edges and detections
    delays: dict[str, list[NDArray[np.float64]]]
    delay_s: NDArray[np.float64]  # (n_kept,) propagation delay of each sample once rotated [s]


@dataclass(kw_only=True)
class RunResult:
    """Everything that one run said, frame by frame."""

    site: "Site"
    recording: Recording
    frame_time_us: NDArray[np.int64]  # (n_frames,) hub clock [us]
    detections: NDArray[np.void]  # DETECTION_DTYPE
    points: NDArray[np.void]  # POINT_DTYPE
    tracks: NDArray[np.void]  # TRACK_DTYPE, the configured tracker
    baseline_tracks: NDArray[np.void]  # TRACK_DTYPE, of a simpler way on the same frames: `baselines`
    metrics: dict[str, float]  # flat, names carry units (see `design.md` section 7)
    baseline_metrics: dict[str, float]
    #: POINT_DTYPE by way: what the simpler ways located
    compared_points: dict[str, NDArray[np.void]] = field(default_factory=dict)
    #: TRACK_DTYPE by way: what the simpler ways tracked; `baseline_tracks` are one of them
    compared_tracks: dict[str, NDArray[np.void]] = field(default_factory=dict)
    associated: NDArray[np.void] = field(default_factory=lambda: np.zeros(0, ASSOCIATED_DTYPE))
    target: str = "inprocess"  # what it ran on
    counters: dict[str, dict[str, int]] = field(
        default_factory=dict
    )  # "hub" and each node's name -> counter -> count
    #: by node name, when taps were asked for; `responses` of a through-wall pipeline, `stacks` of another one
    stacks: dict[str, NodeStack] = field(default_factory=dict)
    responses: dict[str, ResponseStack] = field(default_factory=dict)
    why_no_positions: str | None = None  # when there were too few nodes for a hub
    emulation: "Emulation | None" = None  # faults and counters, of an emulated run
    shown_frame: int = 0  # the frame whose stages the report shows
    shown_taps: dict[str, dict[str, NDArray[Any]]] = field(
        default_factory=dict
    )  # node name -> tap name -> values

    def outputs(self) -> Outputs:
        """Return what a recording keeps of this run, each frame with its hash."""
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
            target=self.target,
            frame_time_us=self.frame_time_us,
            frame_hash=np.frombuffer(b"".join(digests), np.uint8).reshape(-1, 32),
            detections=self.detections,
            tracks=self.tracks,
        )
