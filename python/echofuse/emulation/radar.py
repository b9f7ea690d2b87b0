"""An emulated radar: gives a recording's scans of one node by its own schedule, clock and converter."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from echofuse.emulation.injection import InjectionLog
from echofuse.emulation.scenario import RadarFaults
from echofuse.emulation.streams import stream
from echofuse.recording import NodeRecording

__all__ = ["RadarEvent", "clock_us", "digitised", "schedule", "start_us", "times_us"]

DOUBLED_AFTER_US = 1000  # a scan comes again so much later


@dataclass(frozen=True, kw_only=True)
class RadarEvent:
    """One scan on its way to its node."""

    true_time_us: int  # virtual [us] when it was taken
    ready_us: int  # virtual [us] when it is complete
    node_time_us: int  # the node's clock [us] at true_time_us
    index: int  # into the node's recorded scans
    missed: bool = False  # the node does not get it
    again: bool = False  # the node has had it before


def times_us(source: NodeRecording) -> NDArray[np.int64]:
    """Return when a node's scans were taken, (n_scans,) [us]."""
    return np.array([round(float(time_s) * 1e6) for time_s in source.time_s], np.int64)


def start_us(sources: Sequence[NodeRecording]) -> int:
    """Return the time of a recording's first scan [us]; 0 without any."""
    return min((int(times_us(source)[0]) for source in sources if len(source.time_s)), default=0)


def clock_us(faults: RadarFaults, time_us: int) -> int:
    """Return what a node's clock shows at a virtual time [us]."""
    return time_us + faults.clock_offset_us + round(time_us * faults.drift_ppm * 1e-6)


def schedule(
    source: NodeRecording, faults: RadarFaults, *, seed: int, begin_us: int, log: InjectionLog
) -> list[RadarEvent]:
    """Return a radar's scans in the order in which they are complete.

    begin_us: virtual time of the run's first scan, from which drift stretches the schedule.
    """
    recorded = times_us(source)
    nominal = recorded
    if faults.period_us and len(recorded):
        nominal = np.arange(recorded[0], recorded[-1] + 1, faults.period_us, dtype=np.int64)
    n = len(nominal)
    true_us = begin_us + np.rint((nominal - begin_us) / (1.0 + faults.drift_ppm * 1e-6)).astype(np.int64)
    true_us = true_us + _jitter_us(source.name, faults, n, seed)
    index = _nearest(recorded, true_us) if faults.period_us else np.arange(n)
    missed = stream(seed, "radar.missed", source.name).random(n) < faults.missed
    doubled = stream(seed, "radar.doubled", source.name).random(n) < faults.doubled
    _note(source.name, faults, n, log)
    events = []
    for which in range(n):
        at_us = max(int(true_us[which]), 0)
        event = RadarEvent(
            true_time_us=at_us,
            ready_us=at_us + faults.frame_duration_us,
            node_time_us=clock_us(faults, at_us),
            index=int(index[which]),
            missed=bool(missed[which]),
        )
        events.append(event)
        if doubled[which] and not event.missed:
            events.append(_again(event))
    return sorted(events, key=lambda event: event.ready_us)


def digitised(source: NodeRecording, faults: RadarFaults) -> NodeRecording:
    """Return a node's scans as its converter would have given them: cut off and in whole steps."""
    if not faults.adc_bits and not faults.adc_full_scale:
        return source
    full_scale = faults.adc_full_scale or float(np.max(np.abs(source.scans), initial=1.0))
    step = 2.0 * full_scale / 2**faults.adc_bits if faults.adc_bits else 0.0

    def converted(scans: NDArray[np.float32] | NDArray[np.int32]) -> NDArray[np.float32]:
        cut = np.clip(scans.astype(np.float64), -full_scale, full_scale)
        return (np.rint(cut / step) * step if step else cut).astype(np.float32)

    reference = None if source.reference is None else converted(source.reference)
    return replace(source, scans=converted(source.scans), reference=reference)


def _jitter_us(node: str, faults: RadarFaults, n: int, seed: int) -> NDArray[np.int64]:
    deviations = np.clip(stream(seed, "radar.jitter", node).standard_normal(n), -3.0, 3.0)
    return np.rint(faults.jitter_us * deviations).astype(np.int64)


def _nearest(recorded: NDArray[np.int64], wanted: NDArray[np.int64]) -> NDArray[np.intp]:
    """Return the index of the recorded time nearest to each wanted one."""
    middles = (recorded[1:] + recorded[:-1]) / 2.0
    return np.searchsorted(middles, wanted)


def _again(event: RadarEvent) -> RadarEvent:
    return replace(
        event,
        true_time_us=event.true_time_us + DOUBLED_AFTER_US,
        ready_us=event.ready_us + DOUBLED_AFTER_US,
        node_time_us=event.node_time_us + DOUBLED_AFTER_US,
        again=True,
    )


def _note(node: str, faults: RadarFaults, n: int, log: InjectionLog) -> None:
    """Note what is always there, and what must come about."""
    plain = RadarFaults()
    steady = ("period_us", "frame_duration_us", "jitter_us", "clock_offset_us", "drift_ppm")
    for name in (*steady, "adc_bits", "adc_full_scale"):
        if getattr(faults, name) != getattr(plain, name):
            log.want(f"radar.{name}", node)
            for _ in range(n):
                log.count(f"radar.{name}", node)
    for name in ("missed", "doubled"):
        if getattr(faults, name) > 0.0:
            log.want(f"radar.{name}", "*")
