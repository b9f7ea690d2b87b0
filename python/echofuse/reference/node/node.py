"""A node of the pipeline `sensor_radar`: one raw scan in, delays of echoes from people out (Sec. IV)."""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.node.scan.cfar import CfarConfig, cfar
from echofuse.reference.node.scan.clutter import ClutterConfig, ClutterFilter, rectified
from echofuse.reference.node.scan.direct_path import NOT_FOUND, DirectPath, DirectPathConfig, direct_path
from echofuse.reference.node.scan.noise_floor import NoiseFloor, NoiseFloorConfig
from echofuse.reference.node.scan.pulse_integrator import PulseIntegrator, PulseIntegratorConfig
from echofuse.reference.node.scan.range_clusters import RangeCluster, RangeClusterConfig, range_clusters
from echofuse.reference.signal.alignment import Alignment, AlignmentConfig, estimate_shift, shifted
from echofuse.reference.signal.envelope import EnvelopeConfig, envelope

Samples = NDArray[np.float64]
SPEED_OF_LIGHT_MPS = 299792458.0
MAX_DETECTIONS = 16  # of one report
MAX_CLUSTERS = 64  # of one scan
RESEMBLING = 0.9  # correlation of a scan with the background that it belongs to
NO_SHIFT = Alignment(0.0, 0.0, 1.0)


class SensorRadarNodeConfig(Protocol):
    n_samples: int
    sample_rate_hz: float
    first_sample_s: float
    baseline_m: float
    time_zero: str  # "direct_path" or "recorded"
    delay_offset_s: float
    blind_zone_s: float
    pulse_integrator: PulseIntegratorConfig
    envelope: EnvelopeConfig
    direct_path: DirectPathConfig
    alignment: AlignmentConfig
    clutter: ClutterConfig
    cfar: CfarConfig
    noise_floor: NoiseFloorConfig
    range_clusters: RangeClusterConfig


@dataclass
class NodeReport:
    """What one complete scan gave."""

    detections: NDArray[np.float64]  # (n_detections, 2) delay [s], weight; ascending delay
    taps: dict[str, NDArray[np.float64]] = field(default_factory=dict)  # by name of TapId
    margins: dict[str, NDArray[np.float64]] = field(default_factory=dict)  # of the tap's decisions


def heaviest(clusters: list[RangeCluster], most: int) -> list[RangeCluster]:
    """Keep the `most` heaviest, the first of equals, in their order."""
    by_weight = sorted(range(len(clusters)), key=lambda i: (-clusters[i].weight, i))
    return [clusters[i] for i in sorted(by_weight[:most])]


class SensorRadarNode:
    """The stages of a node in a row, with the background that they share."""

    def __init__(self, config: SensorRadarNodeConfig) -> None:
        self._config = config
        self.reset()

    def reset(self) -> None:
        config = self._config
        self._integrator = PulseIntegrator(config.pulse_integrator)
        self._clutter = ClutterFilter(config.clutter)
        self._noise_floor = NoiseFloor(config.noise_floor)
        self._reference: list[Samples] = []  # aligned envelopes that make the background's
        self._has_empty_room = False
        self._last_shift = 0.0
        self._background = NOT_FOUND

    @property
    def ready(self) -> bool:
        return self._clutter.ready and (self._config.time_zero == "recorded" or self._background.found)

    def set_empty_room(self, scan: Samples) -> None:
        """Average one scan (n_samples,) [count] of the empty room into the background."""
        if not self._has_empty_room:
            self.reset()
        self._has_empty_room = True
        amplitude = self._envelope(scan)
        shift = self._align(amplitude, self._direct_path(amplitude)).shift_samples
        self._learn_reference(amplitude, shift)
        source = amplitude if self._on_envelope else scan
        self._clutter.add_empty_room(shifted(source, shift, self._config.alignment))

    def process(self, scan: Samples) -> NodeReport | None:
        """Take scan (n_samples,) [count]; a report when it completes the pulses of a scan."""
        integrated = self._integrator.process(scan)
        if integrated is None:
            return None
        amplitude = self._envelope(integrated)
        path = self._direct_path(amplitude)
        alignment = self._align(amplitude, path)
        if not self._has_empty_room and len(self._reference) < self._config.clutter.learning_scans:
            self._learn_reference(amplitude, alignment.shift_samples)

        reports = self.ready
        source = amplitude if self._on_envelope else integrated
        aligned = shifted(source, alignment.shift_samples, self._config.alignment)
        difference = self._clutter.process(aligned)
        residual = rectified(difference if self._on_envelope else self._envelope(difference))

        first, last = self._usable_range(alignment.shift_samples) if reports else (0, 0)
        threshold, decisions, margin = self._detect(residual, first, last)
        clusters = heaviest(
            range_clusters(
                decisions, residual, threshold, self._config.sample_rate_hz, self._config.range_clusters
            ),
            MAX_CLUSTERS,
        )
        kept = heaviest(clusters, MAX_DETECTIONS)
        rows = [(self.delay_s(cluster.position_samples), cluster.weight) for cluster in kept]
        detections = np.array(rows, dtype=np.float64).reshape(-1, 2)
        return NodeReport(
            detections=detections,
            taps={
                "scan": integrated,
                "envelope": amplitude,
                "direct_path": np.array([path.found, path.toa_samples, path.threshold], dtype=np.float64),
                "alignment": np.array([alignment.shift_samples, alignment.correlation]),
                "aligned": aligned,
                "residual": residual,
                "threshold": threshold,
                "decisions": decisions.astype(np.float64),
                "range_clusters": np.array(clusters, dtype=np.float64).reshape(-1, 4),
                "detections": detections,
            },
            margins={
                "direct_path": np.array(path.margin),
                "alignment": np.array(alignment.margin),
                "decisions": margin,
            },
        )

    def delay_s(self, position_samples: float) -> float:
        """Propagation delay transmitter -> person -> receiver of an echo in the aligned scan [s]."""
        config = self._config
        if config.time_zero == "recorded":
            return config.first_sample_s + position_samples / config.sample_rate_hz + config.delay_offset_s
        after_direct_path = (position_samples - self._background.toa_samples) / config.sample_rate_hz
        return after_direct_path + config.baseline_m / SPEED_OF_LIGHT_MPS + config.delay_offset_s

    @property
    def _on_envelope(self) -> bool:
        return self._config.clutter.method == "empty_room_envelope"

    def _envelope(self, scan: Samples) -> Samples:
        return envelope(scan, self._config.sample_rate_hz, self._config.envelope)

    def _direct_path(self, amplitude: Samples) -> DirectPath:
        if self._config.time_zero == "recorded":
            return NOT_FOUND
        return direct_path(amplitude, self._config.direct_path)

    def _align(self, amplitude: Samples, path: DirectPath) -> Alignment:
        """Search around the direct path's shift; a jump is believed if the scan then fits."""
        if not self._reference:
            return NO_SHIFT
        config = self._config.alignment
        previous = int(np.floor(self._last_shift + 0.5))
        coarse = previous
        if path.found and self._background.found:
            coarse = int(np.floor(path.toa_samples - self._background.toa_samples + 0.5))
        reference = np.mean(self._reference, axis=0)
        # compared: a window that starts an eighth of itself before the strongest arrival, cut to the scan
        length = min(config.window_samples, len(reference))
        first = max(0, min(int(np.argmax(reference)) - length // 8, len(reference) - length))
        last = first + length
        alignment = estimate_shift(amplitude, reference, coarse, first, last, config)
        if abs(coarse - previous) > config.max_shift_samples and alignment.correlation < RESEMBLING:
            alignment = estimate_shift(amplitude, reference, previous, first, last, config)
        self._last_shift = alignment.shift_samples
        return alignment

    def _learn_reference(self, amplitude: Samples, shift_samples: float) -> None:
        self._reference.append(shifted(amplitude, shift_samples, self._config.alignment))
        self._background = self._direct_path(np.mean(self._reference, axis=0))

    def _usable_range(self, shift_samples: float) -> tuple[int, int]:
        """Samples behind the blind zone that the alignment filled from inside the scan."""
        config = self._config
        edge = 0
        if config.alignment.method != "none":
            edge = max(config.alignment.max_shift_samples, int(np.ceil(abs(shift_samples))))
            edge += config.alignment.interpolator_half_length_samples
            if not self._on_envelope:
                edge += (
                    config.envelope.hilbert_half_length_samples
                    if config.envelope.method == "hilbert"
                    else config.envelope.low_pass_half_length_samples
                )
        blind_delay_s = config.baseline_m / SPEED_OF_LIGHT_MPS + config.blind_zone_s
        blind = int(np.ceil(max(0.0, (blind_delay_s - self.delay_s(0.0)) * config.sample_rate_hz)))
        return max(edge, min(blind, config.n_samples)), config.n_samples - edge

    def _detect(self, residual: Samples, first: int, last: int) -> tuple[Samples, NDArray[np.uint8], Samples]:
        """Threshold, decisions, margins (n_samples,); the first two are 0 outside [first, last)."""
        config = self._config
        threshold = np.zeros(len(residual))
        margin = np.ones(len(residual))
        decisions = np.zeros(len(residual), dtype=np.uint8)
        shortest = 2 * (config.cfar.guard_cells_per_side + 1)
        if config.cfar.method == "double_threshold_buffer":
            shortest = 2 * config.cfar.buffer_samples
        if last - first < max(shortest, config.noise_floor.block_samples):
            return threshold, decisions, margin
        judged = residual[first:last]
        result = cfar(judged, config.cfar)
        raised = self._noise_floor.process(judged, result.threshold)
        power = judged**2
        distance = np.abs(power - raised) / np.maximum(np.maximum(power, raised), 1e-300)
        threshold[first:last] = raised
        decisions[first:last] = power > raised
        margin[first:last] = np.minimum(result.margin, distance)
        return threshold, decisions, margin
