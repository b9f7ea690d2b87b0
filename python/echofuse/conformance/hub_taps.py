"""Compares every tap of a hub with the reference's, stage by stage.

Each stage of the reference gets what the target's stage before it showed, and the particle filter the
target's own particles of the frame before: rounding does not accumulate into other particles, and a decision
that was a coin toss is excused once, in the stage that took it. Only the frame assembler and the track
manager keep a state of their own.
"""

from collections.abc import Sequence
from contextlib import closing
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echofuse import _core
from echofuse.conformance.choices import Choice
from echofuse.conformance.comparison import Scoreboard, as_reference, to_float64
from echofuse.conformance.hub_inputs import HubInput, Instant
from echofuse.conformance.hub_reference import HubReference, covariances
from echofuse.conformance.target import ConformanceTarget, HubAnswer, HubTarget
from echofuse.reference.hub.hub import peak_rows, track_rows
from echofuse.reference.hub.measure.frame_assembler import ClosedFrame
from echofuse.reference.hub.track.range_tracker import RangeStep
from echofuse.reference.hub.track.track_manager import Step

Array = NDArray[np.float64]
MEASURE_TAPS = ("frame", "selected", "points")
PHD_TAPS = ("predicted", "updated", "peaks", "resampled")
QUICKLY_CLUSTERED = 16  # measurements; the reference's time grows with the cube of their number
DEADLINE_US = 90_000  # after an instant: every frame is overdue


def hub_taps(choice: Choice) -> tuple[str, ...]:
    """Return the taps that a hub shows under a choice."""
    phd = PHD_TAPS if choice.settings.get("tracker", "phd") == "phd" else ()
    return (*MEASURE_TAPS, *phd, "tracks")


def conform_hub(
    board: Scoreboard, choice: Choice, target: ConformanceTarget, inputs: Sequence[HubInput]
) -> None:
    """Feed the same reports to target and reference under one choice."""
    for tap in hub_taps(choice):
        board.row(choice.name, tap)
    fitting = [
        heard
        for heard in inputs
        if (heard.shared_transmitter if choice.shared_transmitter else not heard.stand_in)
    ]
    for number, heard in enumerate(fitting):
        config = heard.config(choice)
        with closing(target.hub(config)) as hub:
            comparison = HubComparison(board, choice, config, hub)
            for index, instant in enumerate(heard.instants):
                comparison.selects = choice.selects(number, index)
                if not comparison.feed(instant, f"{heard.where}, frame {index} of it"):
                    break


class HubComparison:
    """A target's hub beside the reference's stages."""

    def __init__(self, board: Scoreboard, choice: Choice, config: Any, target: HubTarget) -> None:
        self.board, self.choice, self.taps = board, choice.name, hub_taps(choice)
        self.target, self.reference = target, HubReference(as_reference(config), _core.LIMITS)
        self.selects = True
        self.particles: Array = np.zeros((0, 5))  # the target's, after the last frame

    def feed(self, instant: Instant, where: str) -> bool:
        """Whether the next instant may be compared as well."""
        for report in instant.reports:
            self.target.receive(report, instant.time_us)
            self.reference.receive(report, instant.time_us)
        for now_us in (instant.time_us, instant.time_us + DEADLINE_US):
            answer, frame = self.target.poll(now_us), self.reference.close_frame(now_us)
            if (answer is None) != (frame is None):
                self.board.row(self.choice, "frame").failures.append(f"{where}: closed by one side only")
                return False
            if answer is not None and frame is not None and not self._compare(answer, frame, where):
                return False
        return True

    def _compare(self, answer: HubAnswer, frame: ClosedFrame, where: str) -> bool:
        self.where = where
        if not self.board.shows(self.choice, where, self.taps, answer.taps):
            return False
        self.got = {tap: to_float64(answer.taps[tap]) for tap in self.taps}
        dt_s = self.reference.step_s(frame.time_us)
        self._frame(answer, frame)
        if self.selects:
            self._selected(dt_s, frame.frame.n_reported)
        if self.selects or len(self.got["selected"]) <= QUICKLY_CLUSTERED:
            self._points()
        measurements = self.got["points"][:, :2]
        step: Step | RangeStep
        if "peaks" in self.taps:
            step = self._phd(measurements, dt_s)
        elif self.reference.hub.ranges is not None:
            step = self.reference.ranges(self.got["frame"], dt_s)
        else:
            step = self.reference.kalman(measurements, dt_s)
        self.reference.know(answer.tracks)
        return self._tracks(answer, step)

    def _frame(self, answer: HubAnswer, frame: ClosedFrame) -> None:
        got, expected = self.got["frame"], frame.frame
        stamp = [answer.time_us, answer.frame]
        if not self._decisions("frame", stamp, [frame.time_us, frame.number]):
            return
        if self._decisions("frame", got[:, 0], expected.node_index):
            self._floats("frame", "hub.frame.path", got[:, 1], expected.path_m)
            self._decisions("frame", got[:, 2], expected.weight)

    def _selected(self, dt_s: float, n_reported: int) -> None:
        got, expected = self.got["selected"], self.reference.select(self.got["frame"], n_reported, dt_s)
        if not self._decisions("selected", got[:, 4], expected.n_nodes, expected.margin):
            return
        margin = expected.margin
        self._floats("selected", "hub.selection.position", got[:, :2], expected.position_m, margin=margin)
        self._floats("selected", "hub.selection.weight", got[:, 2], expected.weight, margin=margin)
        self._floats(
            "selected", "hub.selection.range_residual", got[:, 3], expected.range_residual_m, margin=margin
        )

    def _points(self) -> None:
        got, expected = self.got["points"], self.reference.cluster(self.got["selected"])
        if self._decisions("points", got[:, 2], expected.members, expected.margin):
            self._floats("points", "hub.point_clusters.position", got[:, :2], expected.position_m)
            self._floats("points", "hub.point_clusters.weight", got[:, 3], expected.weight)

    def _phd(self, measurements: Array, dt_s: float) -> Step:
        """Predict, update, peaks, resampling, each from what the target showed before it."""
        reference, got = self.reference, self.got
        predicted = reference.predict(self.particles, dt_s)
        self._particles("predicted", predicted)
        update = reference.update(got["predicted"], measurements)
        self._particles("updated", update.particles)
        peaks = reference.peaks(update, got["updated"], measurements)
        expected = peak_rows(peaks, update.mass)
        if self._decisions("peaks", len(got["peaks"]), len(expected), update.number_margin):
            margin = np.inf if peaks is None else peaks.margin
            self._floats("peaks", "hub.track.peak", got["peaks"][:, :4], expected[:, :4], margin=margin)
            self._floats("peaks", "sensor_radar.peak_mass", got["peaks"][:, 4], expected[:, 4], margin=margin)
        self._resampled(update.number_margin)
        self.particles = got["resampled"]
        return reference.track(peaks, got["peaks"], dt_s)

    def _resampled(self, number_margin: float) -> None:
        """A draw that was a coin toss gives another particle, and by their sum all weights another scale."""
        got, (drawn, expected) = self.got["resampled"], self.reference.resample(self.got["updated"])
        if not self._decisions("resampled", len(got), len(expected), number_margin) or len(got) == 0:
            return
        if not self._floats(
            "resampled", "hub.track.moved", got[:, :4], expected[:, :4], drawn.margin[:, None]
        ):
            kept = np.all(np.abs(got[:, :4] - expected[:, :4]) < 1e-4, axis=1)
            got, expected = got[kept] / np.sum(got[kept, 4]), expected[kept] / np.sum(expected[kept, 4])
        self._floats("resampled", "hub.track.weight", got[:, 4], expected[:, 4])

    def _particles(self, tap: str, expected: Array) -> None:
        got = self.got[tap]
        if self._decisions(tap, len(got), len(expected)):
            self._floats(tap, "hub.track.moved", got[:, :4], expected[:, :4])
            self._floats(tap, "hub.track.weight", got[:, 4], expected[:, 4])

    def _tracks(self, answer: HubAnswer, step: Step | RangeStep) -> bool:
        got, expected = self.got["tracks"], track_rows(step)
        same = self._decisions("tracks", got[:, [0, 1, 6]], expected[:, [0, 1, 6]], step.margin)
        if same:
            self._floats("tracks", "sensor_radar.track", got[:, 2:6], expected[:, 2:6])
            names = ("covariance_xx_m2", "covariance_xy_m2", "covariance_yy_m2")
            message = np.stack([to_float64(answer.tracks[name]) for name in names], axis=1)
            self._floats("tracks", "sensor_radar.covariance", message, covariances(step.tracks))
        return same

    def _floats(
        self, tap: str, tolerance: str, got: Array, expected: Array, margin: ArrayLike = np.inf
    ) -> bool:
        return self.board.floats(self.choice, tap, self.where, got, expected, tolerance, margin)

    def _decisions(self, tap: str, got: ArrayLike, expected: ArrayLike, margin: ArrayLike = np.inf) -> bool:
        return self.board.decisions(self.choice, tap, self.where, got, expected, margin)
