"""A node of the pipeline `through_wall_2d`: a receiver's response in, delays of people's echoes out."""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.node.scan.clutter import ClutterConfig, ClutterFilter
from echofuse.reference.node.scan.gaussian_cfar import GaussianCfarConfig, gaussian_cfar
from echofuse.reference.node.scan.leading_edge import LeadingEdgeConfig, leading_edge
from echofuse.reference.node.scan.target_traces import TargetTraceConfig, target_traces
from echofuse.reference.node.scan.time_zero import TimeZero, TimeZeroConfig, TimeZeroResult
from echofuse.reference.node.scan.weak_signal import WeakSignal, WeakSignalConfig
from echofuse.reference.signal.envelope import EnvelopeConfig, envelope

Samples = NDArray[np.float64]
SPEED_OF_LIGHT_MPS = 299792458.0
MAX_DETECTIONS = 16  # of one report
MAX_TRACES = 64  # of one response
SAME_ECHO_SAMPLES = 1.0  # two traces that begin closer together are one


class ThroughWallNodeConfig(Protocol):
    n_samples: int
    kept_samples: int  # 0: all
    sample_rate_hz: float
    baseline_m: float
    delay_offset_s: float
    blind_zone_s: float
    max_delay_s: float  # 0: none
    full_scale_count: float  # 0: not known
    saturated_samples: int
    time_zero: TimeZeroConfig
    clutter: ClutterConfig
    envelope: EnvelopeConfig
    weak_signal: WeakSignalConfig
    gaussian_cfar: GaussianCfarConfig
    target_traces: TargetTraceConfig
    leading_edge: LeadingEdgeConfig


@dataclass
class ThroughWallReport:
    """What one response gave."""

    state: str  # "judged", "dead", "saturated", "cross_talk_missing" or "settling"
    detections: NDArray[np.float64]  # (n_detections, 2) delay [s], weight; ascending delay
    traces: NDArray[np.intp]  # (n_detections,) which of the traces each begins with
    taps: dict[str, NDArray[np.float64]] = field(default_factory=dict)  # by name of TapId
    margins: dict[str, NDArray[np.float64]] = field(default_factory=dict)  # of the tap's decisions


class ThroughWallNode:
    """The stages of a receiver in a row. A response that is not judged gives an empty report."""

    def __init__(self, config: ThroughWallNodeConfig) -> None:
        self._config = config
        self.reset()

    def reset(self) -> None:
        config = self._config
        expected = config.baseline_m / SPEED_OF_LIGHT_MPS * config.sample_rate_hz
        self._time_zero = TimeZero(config.time_zero, expected)
        self._forget()

    def _forget(self) -> None:
        """What rests on time zero."""
        self._clutter = ClutterFilter(self._config.clutter)
        self._weak_signal = WeakSignal(self._config.weak_signal)
        self._n_heard = 0  # responses since then

    @property
    def ready(self) -> bool:
        return self._clutter.ready

    def process(self, response: Samples) -> ThroughWallReport:
        """Take response (n_samples,) [count], beginning at any chip."""
        config = self._config
        state, place = self._turned(response)
        subtracted = np.zeros_like(place.response)
        enhanced = subtracted
        if place.found:
            state = "judged" if self._clutter.ready else "settling"
            subtracted = self._clutter.process(place.response)
        if state == "judged":
            enhanced = self._weak_signal.process(subtracted)
        amplitude = envelope(subtracted, config.sample_rate_hz, config.envelope)
        detector = gaussian_cfar(enhanced, config.gaussian_cfar)
        traces = target_traces(detector.decisions, config.target_traces)
        toa_samples, weight = traces.toa_samples[:MAX_TRACES], traces.weight[:MAX_TRACES]
        edges = leading_edge(amplitude, toa_samples, config.leading_edge)
        detections, which, report_margin = self._report(edges.toa_samples, weight, place)
        return ThroughWallReport(
            state=state,
            detections=detections,
            traces=which,
            taps={
                "scan": response,
                "time_zero": np.array([place.found, place.rotation, place.fraction_samples], np.float64),
                "rotated": place.response,
                "subtracted": subtracted,
                "envelope": amplitude,
                "enhanced": enhanced,
                "decisions": detector.decisions.astype(np.float64),
                "target_traces": np.column_stack([toa_samples, weight]).astype(np.float64),
                "leading_edges": np.column_stack([edges.toa_samples, weight]).astype(np.float64),
                "detections": detections,
            },
            margins={
                "time_zero": np.array(place.margin),
                "decisions": detector.margin,
                "leading_edges": np.array(edges.margin),
                "detections": np.array(report_margin),
            },
        )

    def delay_s(self, toa_samples: Samples, place: TimeZeroResult) -> Samples:
        """Propagation delay transmitter -> person -> receiver of echoes in the turned response [s]."""
        config = self._config
        behind_cross_talk = toa_samples - self._time_zero.expected - place.fraction_samples
        cross_talk_s = config.baseline_m / SPEED_OF_LIGHT_MPS
        return behind_cross_talk / config.sample_rate_hz + cross_talk_s + config.delay_offset_s

    def _turned(self, response: Samples) -> tuple[str, TimeZeroResult]:
        """Why the response cannot be judged, if so, and what is kept of it once turned to time zero."""
        config = self._config
        kept = min(config.kept_samples or config.n_samples, config.n_samples)
        nothing = TimeZeroResult(False, False, 0, 0.0, np.zeros(kept), np.inf)
        if np.all(response == response[0]):
            return "dead", nothing
        full_scale = np.abs(response) >= config.full_scale_count
        if config.full_scale_count > 0.0 and np.count_nonzero(full_scale) > config.saturated_samples:
            return "saturated", nothing
        place = self._time_zero.process(response, kept)
        if place.moved:
            self._forget()
        self._n_heard += 1
        learning = self._n_heard <= config.time_zero.learning_responses
        return "settling" if learning else "cross_talk_missing", place

    def _report(
        self, toa_samples: Samples, weight: NDArray[np.intp], place: TimeZeroResult
    ) -> tuple[Samples, NDArray[np.intp], float]:
        """Detections (n, 2), which trace each begins with, and the least distance [sample] of a decision.

        Traces that begin within a sample of an earlier one are the same echo: it has the earlier beginning
        and the larger weight.
        """
        config = self._config
        margin = np.inf
        begins: list[int] = []
        weights: list[float] = []
        for which in np.argsort(toa_samples, kind="stable"):
            apart = toa_samples[which] - toa_samples[begins[-1]] if begins else np.inf
            margin = min(margin, abs(apart - SAME_ECHO_SAMPLES))
            if apart < SAME_ECHO_SAMPLES:
                weights[-1] = max(weights[-1], float(weight[which]))
            else:
                begins.append(int(which))
                weights.append(float(weight[which]))
        traces = np.array(begins, np.intp)
        rows = np.column_stack([self.delay_s(toa_samples[traces], place), weights])
        first_s = config.baseline_m / SPEED_OF_LIGHT_MPS + config.blind_zone_s
        last_s = config.max_delay_s or np.inf
        for limit_s in (first_s, last_s):
            distance_s = float(np.min(np.abs(rows[:, 0] - limit_s), initial=np.inf))
            margin = min(margin, distance_s * config.sample_rate_hz)
        inside = np.flatnonzero((rows[:, 0] >= first_s) & (rows[:, 0] <= last_s))
        heaviest = np.argsort(-rows[inside, 1], kind="stable")[:MAX_DETECTIONS]
        kept = inside[np.sort(heaviest)]
        return rows[kept], traces[kept], margin
