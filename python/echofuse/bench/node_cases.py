"""The stages of a node, each choice, and the whole node."""

from collections.abc import Iterator
from copy import deepcopy
from typing import Any

from echofuse import _core
from echofuse.bench.material import FRAME_US, FRAMES, Heard, accept, accepted, back_and_forth, listening_node
from echofuse.bench.timing import Case, Run, timed
from echofuse.conformance.choices import configure
from echofuse.conformance.comparison import as_reference, to_float64
from echofuse.reference.node.node import SensorRadarNode
from echofuse.reference.node.scan.cfar import cfar
from echofuse.reference.node.scan.clutter import ClutterFilter
from echofuse.reference.node.scan.direct_path import direct_path
from echofuse.reference.node.scan.noise_floor import NoiseFloor
from echofuse.reference.node.scan.pulse_integrator import PulseIntegrator
from echofuse.reference.node.scan.range_clusters import range_clusters
from echofuse.reference.signal.alignment import estimate_shift, shifted
from echofuse.reference.signal.envelope import envelope


def node_cases(heard: Heard) -> Iterator[Case]:
    """Every stage on what the stage before gave for one scan, then the node over its scans."""
    taps = accept(listening_node(heard).process_with_taps(heard.scans[FRAMES // 2], 0))[1]
    yield _integrator(heard, taps)
    yield from _envelope(heard, taps)
    yield from _direct_path(heard, taps)
    yield from _alignment(heard, taps)
    yield from _clutter(heard, taps)
    yield from _cfar(heard, taps)
    yield _noise_floor(heard, taps)
    yield from _range_clusters(heard, taps)
    yield Case(
        group="node", name="whole node", core=core_node(heard), reference=reference_node(heard), in_step=True
    )


def core_node(heard: Heard) -> Run:
    """The library's node, one scan a call."""
    node, frame = listening_node(heard), back_and_forth(FRAMES)
    time_us = 0

    def call() -> object:
        nonlocal time_us
        time_us += FRAME_US
        return node.process(heard.scans[frame()], time_us)

    return timed(accepted(call))


def reference_node(heard: Heard) -> Run:
    """The reference's node, one scan a call."""
    node, frame = listening_reference(heard), back_and_forth(FRAMES)
    scans = [to_float64(scan) for scan in heard.scans]
    node.process(scans[frame()])  # as the library's did when it was accepted
    return timed(lambda: node.process(scans[frame()]))


def listening_reference(heard: Heard) -> SensorRadarNode:
    """The reference's node with its empty room."""
    node = SensorRadarNode(as_reference(heard.config))
    for scan in heard.empty_room:
        node.set_empty_room(to_float64(scan))
    return node


def choices(config: Any, stage: str, field: str) -> Iterator[tuple[str, Any]]:
    """Every choice of a stage's enumeration: its name and the stage's configuration."""
    for word in type(getattr(getattr(config, stage), field)).__members__:
        chosen = deepcopy(config)
        configure(chosen, {f"{stage}.{field}": word})
        yield f"{stage}.{field}={word}", getattr(chosen, stage)


def _case(name: str, core: Any, reference: Any) -> Case:
    return Case(group="node", name=name, core=timed(accepted(core)), reference=timed(reference))


def _integrator(heard: Heard, taps: Any) -> Case:
    stage = _core.PulseIntegrator()
    accept(stage.configure(heard.config.pulse_integrator))
    reference = PulseIntegrator(as_reference(heard.config.pulse_integrator))
    scan, plain = taps["scan"], to_float64(taps["scan"])
    return _case("pulse_integrator", lambda: stage.process(scan), lambda: reference.process(plain))


def _envelope(heard: Heard, taps: Any) -> Iterator[Case]:
    scan, plain, rate = taps["scan"], to_float64(taps["scan"]), heard.config.sample_rate_hz
    for name, config in choices(heard.config, "envelope", "method"):
        stage, same = _core.Envelope(), as_reference(config)
        accept(stage.configure(config, rate))
        yield _case(
            name,
            lambda stage=stage: stage.process(scan),
            lambda same=same: envelope(plain, rate, same),
        )


def _direct_path(heard: Heard, taps: Any) -> Iterator[Case]:
    amplitude, plain = taps["envelope"], to_float64(taps["envelope"])
    for name, config in choices(heard.config, "direct_path", "search"):
        stage, same = _core.DirectPathSearcher(), as_reference(config)
        accept(stage.configure(config))
        yield _case(
            name,
            lambda stage=stage: stage.process(amplitude),
            lambda same=same: direct_path(plain, same),
        )


def _alignment(heard: Heard, taps: Any) -> Iterator[Case]:
    """Against an empty-room scan, in a window around the direct path; shifted by a fraction of a sample."""
    stage, same = _core.Aligner(), as_reference(heard.config.alignment)
    accept(stage.configure(heard.config.alignment))
    background = accept(listening_node(heard).process_with_taps(heard.empty_room[0], 0))[1]["envelope"]
    amplitude = taps["envelope"]
    plain, plain_background = to_float64(amplitude), to_float64(background)
    first = max(0, int(plain_background.argmax()) - 8)
    last = min(len(plain), first + same.window_samples)
    yield _case(
        "alignment, estimate",
        lambda: stage.estimate(amplitude, background, 0, first, last),
        lambda: estimate_shift(plain, plain_background, 0, first, last, same),
    )
    yield _case(
        "alignment, shift",
        lambda: stage.shift(amplitude, 0.4),
        lambda: shifted(plain, 0.4, same),
    )


def _clutter(heard: Heard, taps: Any) -> Iterator[Case]:
    samples, plain = taps["aligned"], to_float64(taps["aligned"])
    for name, config in choices(heard.config, "clutter", "method"):
        stage, reference = _core.ClutterFilter(), ClutterFilter(as_reference(config))
        accept(stage.configure(config, len(samples)))
        accept(stage.add_empty_room(samples))
        reference.add_empty_room(plain)
        yield _case(
            name,
            lambda stage=stage: stage.process(samples),
            lambda reference=reference: reference.process(plain),
        )


def _cfar(heard: Heard, taps: Any) -> Iterator[Case]:
    residual, plain = taps["residual"], to_float64(taps["residual"])
    for name, config in choices(heard.config, "cfar", "method"):
        stage, same = _core.CfarDetector(), as_reference(config)
        accept(stage.configure(config))
        yield _case(
            name,
            lambda stage=stage: stage.process(residual),
            lambda same=same: cfar(plain, same),
        )


def _noise_floor(heard: Heard, taps: Any) -> Case:
    config = deepcopy(heard.config.noise_floor)
    config.factor = 3.0  # by default it is left out
    stage, reference = _core.NoiseFloor(), NoiseFloor(as_reference(config))
    accept(stage.configure(config))
    residual, threshold = taps["residual"], taps["threshold"]
    plain, plain_threshold = to_float64(residual), to_float64(threshold)
    return _case(
        "noise_floor",
        lambda: stage.process(residual, threshold),
        lambda: reference.process(plain, plain_threshold),
    )


def _range_clusters(heard: Heard, taps: Any) -> Iterator[Case]:
    decisions, residual, threshold = taps["decisions"].astype("u1"), taps["residual"], taps["threshold"]
    plain, plain_threshold = to_float64(residual), to_float64(threshold)
    rate = heard.config.sample_rate_hz
    for name, config in choices(heard.config, "range_clusters", "representative"):
        stage, same = _core.RangeClusterer(), as_reference(config)
        accept(stage.configure(config, rate))
        yield _case(
            name,
            lambda stage=stage: stage.process(decisions, residual, threshold),
            lambda same=same: range_clusters(decisions, plain, plain_threshold, rate, same),
        )
