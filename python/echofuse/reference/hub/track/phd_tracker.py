"""The paper's tracker: particle PHD filter, its peaks, tracks (sections V-D and V-E)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.core.random import Pcg32
from echofuse.reference.estimation.mixture_em import Mixture, MixtureConfig, fit_mixture
from echofuse.reference.estimation.resampling import Resampling
from echofuse.reference.hub.track.phd_filter import PhdConfig, PhdFilter, PhdLimits, PhdUpdate
from echofuse.reference.hub.track.track_manager import Step, TrackEstimate, TrackManager, TrackManagerConfig


class PhdStep(NamedTuple):
    """Everything that one frame went through."""

    predicted: NDArray[np.float64]  # (n, 5) particles
    update: PhdUpdate
    peaks: Mixture | None  # None: no targets
    resampling: Resampling
    resampled: NDArray[np.float64]  # (n, 5) particles
    step: Step


class PhdTracker:
    """Keeps the filter and the tracks."""

    def __init__(
        self,
        phd: PhdConfig,
        em: MixtureConfig,
        tracks: TrackManagerConfig,
        limits: PhdLimits,
        max_tracks: int,
    ) -> None:
        self.phd = PhdFilter(phd, limits)
        self.em = em
        self.manager = TrackManager(tracks, max_tracks)

    def process(self, measurements: NDArray[np.float64], dt_s: float) -> PhdStep:
        """Take in the points (m, 2) [m] of one frame, ``dt_s`` after the last one."""
        predicted = self.phd.predict(dt_s)
        update = self.phd.update(measurements)
        peaks = find_peaks(update, measurements, self.em, self.phd.peak_seed)
        resampling = self.phd.resample()
        step = self.manager.process(estimates(peaks), dt_s)
        return PhdStep(predicted, update, peaks, resampling, self.phd.particles, step)


def find_peaks(
    update: PhdUpdate, measurements: NDArray[np.float64], em: MixtureConfig, peak_seed: int
) -> Mixture | None:
    """Fit as many Gaussians to the persistent particles as there are targets."""
    persistent = update.particles[: update.n_persistent]
    if update.number == 0:
        return None
    seeds = np.column_stack([measurements, update.measurement_mass])
    return fit_mixture(persistent, seeds, update.number, em, Pcg32(peak_seed))


def estimates(peaks: Mixture | None) -> list[TrackEstimate]:
    """Hand the peaks that hold any weight to the track manager."""
    if peaks is None:
        return []
    return [
        TrackEstimate(peaks.mean[c], peaks.velocity[c], peaks.covariance[c])
        for c in np.flatnonzero(peaks.share > 0.0)
    ]
