"""The reference's hub, one call a stage, each from a given input."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echofuse.conformance.comparison import to_float64
from echofuse.conformance.target import Report
from echofuse.reference.core.random import Pcg32
from echofuse.reference.estimation.kalman import ConstantVelocityFilter
from echofuse.reference.estimation.mixture_em import Mixture, fit_mixture
from echofuse.reference.estimation.resampling import Resampling
from echofuse.reference.hub.hub import HubLimits, SensorRadarHub, keep_heaviest
from echofuse.reference.hub.measure.frame_assembler import ClosedFrame
from echofuse.reference.hub.measure.frame_assembler import Report as ReferenceReport
from echofuse.reference.hub.measure.measurement_selection import (
    Frame,
    Limits,
    Measurements,
    measurement_selection,
)
from echofuse.reference.hub.measure.point_clusters import PointClusters, point_clusters
from echofuse.reference.hub.track.path_tracker import PathTrack
from echofuse.reference.hub.track.phd_filter import PhdUpdate
from echofuse.reference.hub.track.phd_tracker import PhdTracker, estimates
from echofuse.reference.hub.track.range_tracker import RangeStep, RangeTrack
from echofuse.reference.hub.track.track_manager import Step, Track

Array = NDArray[np.float64]


def hub_limits(limits: Mapping[str, int]) -> HubLimits:
    """Return the target's capacities as the reference names them."""
    return HubLimits(
        max_tuples=limits["max_tuples_per_frame"],
        max_measurements=limits["max_measurements_per_frame"],
        max_candidates=limits["max_measurements_per_frame"],
        max_points=limits["max_points_per_frame"],
        max_particles=limits["max_particles"],
        max_newborn_particles=limits["max_newborn_particles"],
        max_targets=limits["max_targets"],
        max_tracks=limits["max_tracks"],
    )


def reference_report(report: Report) -> ReferenceReport:
    """Return a report as the reference takes it."""
    return ReferenceReport(
        report.node_id, report.frame, to_float64(report.delay_s), to_float64(report.weight)
    )


#: [m] or score: of it, 1e-5 are what filters in single precision differ by after some seconds.
RANGE_MARGIN = 20.0


class HubReference:
    """The reference's hub taken apart."""

    def __init__(self, config: Any, limits: Mapping[str, int]) -> None:
        self.config, self.limits = config, hub_limits(limits)
        self.hub = SensorRadarHub(config, self.limits)

    def receive(self, report: Report, now_us: int) -> None:
        """Give the frame assembler a report."""
        self.hub.receive(reference_report(report), now_us)

    def close_frame(self, now_us: int) -> ClosedFrame | None:
        """Return the oldest frame that is closed by now."""
        return self.hub.assembler.poll(now_us)

    def step_s(self, time_us: int) -> float:
        """Time since the last frame [s]."""
        return self.hub.clock.step_s(time_us, self.config.frame_period_s)

    def know(self, tracks: NDArray[np.void]) -> None:
        """Take over the target's tracks as the known people."""
        self.hub.known = [
            Track(
                id=int(track["id"]),
                state=int(track["state"]),
                filter=ConstantVelocityFilter(
                    np.array([track[name] for name in ("x_m", "vx_mps", "y_m", "vy_mps")], np.float64),
                    np.zeros((4, 4)),
                ),
                frames_since_update=int(track["frames_since_update"]),
            )
            for track in tracks
        ]

    def select(self, rows: Array, n_reported: int, dt_s: float) -> Measurements:
        """Select from the frame tap (n, 3)."""
        limits = Limits(self.limits.max_tuples, self.limits.max_measurements, self.limits.max_candidates)
        frame = Frame(rows[:, 0].astype(np.intp), rows[:, 1], rows[:, 2], n_reported)
        people = self.hub.predict_people(dt_s)
        return measurement_selection(
            self.config.selection, self.config.ellipse, self.hub.site, limits, frame, people
        )

    def cluster(self, rows: Array) -> PointClusters:
        """Cluster the selected tap (m, 5)."""
        clusters = point_clusters(self.config.point_clusters, rows[:, :2], rows[:, 2])
        return keep_heaviest(clusters, self.limits.max_points)

    @property
    def phd(self) -> PhdTracker:
        """The particle filter's tracker, where it is configured."""
        assert self.hub.phd is not None
        return self.hub.phd

    def predict(self, particles: Array, dt_s: float) -> Array:
        """Move the particles of the last frame (n, 5)."""
        self.phd.phd.particles = particles
        return self.phd.phd.predict(dt_s)

    def update(self, predicted: Array, measurements: Array) -> PhdUpdate:
        """Weigh predicted particles (n, 5) with points (m, 2) [m]."""
        self.phd.phd.particles = predicted
        return self.phd.phd.update(measurements)

    def peaks(self, update: PhdUpdate, updated: Array, measurements: Array) -> Mixture | None:
        """Peaks of updated particles (n, 5), as many as the update counted."""
        if update.number == 0:
            return None
        seeds = np.column_stack([measurements, update.measurement_mass])
        random = Pcg32(self.phd.phd.peak_seed)
        return fit_mixture(updated[: update.n_persistent], seeds, update.number, self.config.em, random)

    def resample(self, updated: Array) -> tuple[Resampling, Array]:
        """Draw from updated particles (n, 5)."""
        self.phd.phd.particles = updated
        drawn = self.phd.phd.resample()
        return drawn, self.phd.phd.particles

    def track(self, peaks: Mixture | None, rows: Array, dt_s: float) -> Step:
        """Feed the track manager with the peaks' tap (n, 5), spread as the reference's peaks are."""
        if peaks is not None and len(peaks.mean) == len(rows):
            peaks = peaks._replace(mean=rows[:, :2], velocity=rows[:, 2:4])
        return self.phd.manager.process(estimates(peaks), dt_s)

    def kalman(self, measurements: Array, dt_s: float) -> Step:
        """Feed the Kalman filters with points (m, 2) [m]."""
        assert self.hub.kalman is not None
        return self.hub.kalman.process(measurements, dt_s)

    def ranges(self, rows: Array, dt_s: float) -> RangeStep:
        """Feed the range tracker with the frame tap (n, 3); margins as parts of RANGE_MARGIN."""
        assert self.hub.ranges is not None
        step = self.hub.ranges.process(rows[:, 0].astype(np.int64), rows[:, 1], dt_s)
        return step._replace(margin=step.margin / RANGE_MARGIN)


def covariances(tracks: Sequence[Track | RangeTrack | PathTrack], dimension: int = 2) -> Array:
    """Position covariances (n, 3): xx, xy, yy [m^2]; in space (n, 6): xx, xy, xz, yy, yz, zz."""
    upper = np.triu_indices(dimension)
    entries = [track.filter.position_covariance[upper] for track in tracks]
    return np.array(entries, np.float64).reshape(-1, len(upper[0]))
