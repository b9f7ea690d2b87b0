"""The stages of a hub, each choice, and the whole hub."""

import time
from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from itertools import count
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.bench.material import (
    FRAME_S,
    FRAME_US,
    FRAMES,
    Material,
    accept,
    accepted,
    back_and_forth,
    listening_node,
)
from echofuse.bench.node_cases import choices
from echofuse.bench.timing import Case, Run, timed
from echofuse.conformance.comparison import as_reference, to_float64
from echofuse.conformance.hub_reference import hub_limits
from echofuse.reference.core.random import Pcg32
from echofuse.reference.estimation.mixture_em import fit_mixture
from echofuse.reference.hub.hub import SensorRadarHub
from echofuse.reference.hub.locate.ellipse_least_squares import Ellipses, ellipse_least_squares
from echofuse.reference.hub.locate.site import path_m
from echofuse.reference.hub.measure.frame_assembler import FrameAssembler, Report
from echofuse.reference.hub.measure.measurement_selection import Frame, Limits, measurement_selection
from echofuse.reference.hub.measure.point_clusters import point_clusters
from echofuse.reference.hub.track.kalman_tracker import KalmanTracker
from echofuse.reference.hub.track.phd_filter import PhdFilter
from echofuse.reference.hub.track.track_manager import TrackEstimate, TrackManager

Array = NDArray[np.float32]
Reports = list[tuple[int, Array, Array]]  # of one frame: node id, delays [s], weights

LIMITS = hub_limits(_core.LIMITS)
PHD_PARTS = ("predict", "update", "resample")
MOST_POINTS = 32  # clustered by the reference in reasonable time, which grows with their cube
WARMING_FRAMES = 10  # until the particle filter has found the person


def hub_cases(material: Material) -> Iterator[Case]:
    """Every stage on what the stage before gave for one frame, then the hub over the frames."""
    frames = reports_of(material)
    taps = _taps(material.hub, frames)
    yield _assembler(material, frames)
    yield _ellipse(material)
    yield from _selection(material, taps)
    yield from _point_clusters(material, frames)
    yield from _phd(material.hub, taps["points"][:, :2])
    yield _peaks(material.hub, taps["points"][:, :2])
    yield from _tracks(material.hub, taps)
    yield Case(
        group="hub",
        name="whole hub",
        core=_core_hub(material, frames),
        reference=_reference_hub(material, frames),
        in_step=True,
    )


def reports_of(material: Material) -> list[Reports]:
    """What the library's nodes say, frame by frame."""
    nodes = [listening_node(heard) for heard in material.nodes]
    frames = []
    for index in range(FRAMES):
        said = [accept(n.process(h.scans[index], index)) for n, h in zip(nodes, material.nodes, strict=True)]
        frames.append([(h.node_id, *columns(rows)) for h, rows in zip(material.nodes, said, strict=True)])
    return frames


def columns(rows: Any) -> tuple[Array, Array]:
    """Delays [s] and weights of a report, as the hub takes them."""
    return np.ascontiguousarray(rows["delay_s"], np.float32), np.ascontiguousarray(rows["weight"], np.float32)


def configured_hub(config: Any) -> "_core.SensorRadarHub":
    """The library's hub."""
    hub = _core.SensorRadarHub()
    accept(hub.configure(config))
    return hub


def warm_particles(config: Any, points: Array) -> Any:
    """The library's particle filter that has followed points (n, 2) [m] for a second."""
    phd = _core.PhdFilter()
    accept(phd.configure(config))
    for _ in range(WARMING_FRAMES):
        accept(phd.predict(FRAME_S))
        accept(phd.update(points))
        accept(phd.resample())
    return phd


def _taps(config: Any, frames: Sequence[Reports]) -> dict[str, Array]:
    """The hub's taps of the middle frame."""
    hub = configured_hub(config)
    for index in range(FRAMES // 2 + 1):
        for node_id, delay_s, weight in frames[index]:
            accept(hub.receive(node_id, index, delay_s, weight, index * FRAME_US))
        taps: dict[str, Array] = hub.poll_with_taps(index * FRAME_US)[2]
    return taps


def _case(name: str, core: Any, reference: Any) -> Case:
    return Case(group="hub", name=name, core=timed(accepted(core)), reference=timed(reference))


def _assembler(material: Material, frames: Sequence[Reports]) -> Case:
    """All nodes' reports in, one frame out."""
    config = material.hub
    stage = _core.FrameAssembler()
    accept(stage.configure(config.frame_assembler, config.nodes[: config.n_nodes]))
    reference = FrameAssembler(
        as_reference(config.frame_assembler), [heard.node_id for heard in material.nodes]
    )
    plain = _plain(frames[0])
    core_clock, reference_clock = count(), count()

    def core_call() -> object:
        number = next(core_clock)
        for node_id, delay_s, weight in frames[0]:
            stage.receive(node_id, number, delay_s, weight, number * FRAME_US)
        return stage.poll(number * FRAME_US)

    def reference_call() -> object:
        number = next(reference_clock)
        for node_id, delay_s, weight in plain:
            reference.receive(Report(node_id, number, delay_s, weight), number * FRAME_US)
        return reference.poll(number * FRAME_US)

    return _case("frame_assembler", core_call, reference_call)


def _ellipse(material: Material) -> Case:
    """One path a node, as the person makes them."""
    config, reference = material.hub, SensorRadarHub(as_reference(material.hub), LIMITS)
    site = reference.site
    path = path_m(material.person_m, site.tx_m, site.rx_m).astype(np.float32)
    weight = np.ones(len(path), np.float32)
    stage, same = _core.EllipseLeastSquares(), as_reference(config.ellipse)
    accept(stage.configure(config.ellipse))
    nodes, area = config.nodes[: config.n_nodes], config.area
    ellipses = Ellipses(site.tx_m, site.rx_m, to_float64(path), to_float64(weight))
    return _case(
        "ellipse fix",
        lambda: stage.process(nodes, path, weight, area),
        lambda: ellipse_least_squares(same, ellipses, site.area_m),
    )


def _selection(material: Material, taps: dict[str, Array]) -> Iterator[Case]:
    config = material.hub
    nodes, area, n_nodes = config.nodes[: config.n_nodes], config.area, len(material.nodes)
    site = SensorRadarHub(as_reference(config), LIMITS).site
    limits = Limits(LIMITS.max_tuples, LIMITS.max_measurements, LIMITS.max_candidates)
    index, path, weight = (np.ascontiguousarray(column) for column in taps["frame"].T)
    nobody = np.zeros((0, 2), np.float32)
    frame = Frame(index.astype(np.intp), to_float64(path), to_float64(weight), n_nodes)
    ellipse = as_reference(config.ellipse)
    for name, chosen in choices(config, "selection", "method"):
        stage, same = _core.MeasurementSelection(), as_reference(chosen)
        accept(stage.configure(chosen, config.ellipse, nodes, area))
        yield _case(
            name,
            lambda stage=stage: stage.process(index.astype(np.int32), path, weight, n_nodes, nobody),
            lambda same=same: measurement_selection(same, ellipse, site, limits, frame),
        )


def _point_clusters(material: Material, frames: Sequence[Reports]) -> Iterator[Case]:
    """On what the paper's own selection leaves, which is many positions of one person."""
    everything = next(
        chosen for name, chosen in choices(material.hub, "selection", "method") if name.endswith("all_tuples")
    )
    config = deepcopy(material.hub)
    config.selection = everything
    rows = _taps(config, frames)["selected"][:MOST_POINTS]
    position, weight = np.ascontiguousarray(rows[:, :2]), np.ascontiguousarray(rows[:, 2])
    plain, plain_weight = to_float64(position), to_float64(weight)
    for name, chosen in choices(material.hub, "point_clusters", "distance"):
        stage, same = _core.PointClusters(), as_reference(chosen)
        accept(stage.configure(chosen))
        yield _case(
            f"{name}, {len(rows)} points",
            lambda stage=stage: stage.process(position, weight),
            lambda same=same: point_clusters(same, plain, plain_weight),
        )


def _phd(config: Any, points: Array) -> Iterator[Case]:
    """Each part of a frame; the filter runs through all of them, and the part's time counts."""
    points = np.ascontiguousarray(points)
    for part in PHD_PARTS:
        reference = PhdFilter(as_reference(config.phd), LIMITS)
        plain = to_float64(points)
        for _ in range(WARMING_FRAMES):
            _phd_part(reference, plain, part)()
        yield Case(
            group="hub",
            name=f"phd, {part}",
            core=_phd_part(warm_particles(config.phd, points), points, part),
            reference=_phd_part(reference, plain, part),
        )


def _phd_part(phd: Any, points: NDArray[Any], part: str) -> Run:
    def run() -> float:
        calls: dict[str, Callable[[], object]] = {
            "predict": lambda: phd.predict(FRAME_S),
            "update": lambda: phd.update(points),
            "resample": phd.resample,
        }
        elapsed = 0.0
        for name in PHD_PARTS:
            begin = time.perf_counter()
            calls[name]()
            if name == part:
                elapsed = time.perf_counter() - begin
        return elapsed

    return run


def _peaks(config: Any, points: Array) -> Case:
    points = np.ascontiguousarray(points)
    phd = warm_particles(config.phd, points)
    accept(phd.predict(FRAME_S))
    accept(phd.update(points))
    particles, targets = phd.persistent, max(1, phd.number)
    seeds = np.ascontiguousarray(np.column_stack([points, phd.measurement_mass]), np.float32)
    plain, plain_seeds = to_float64(particles), to_float64(seeds)
    stage, same = _core.MixtureFitter(), as_reference(config.em)
    accept(stage.configure(config.em))
    return _case(
        "peaks (EM)",
        lambda: stage.process(particles, seeds, targets, _core.Pcg32(1)),
        lambda: fit_mixture(plain, plain_seeds, targets, same, Pcg32(1)),
    )


def _tracks(config: Any, taps: dict[str, Array]) -> Iterator[Case]:
    """A track a peak; the same peaks again and again."""
    variance = config.tracks.measurement_std_m**2
    spread = np.tile(np.array([variance, 0.0, variance]), (len(taps["peaks"]), 1))
    rows = np.ascontiguousarray(np.column_stack([taps["peaks"][:, :4], spread]), np.float32)
    estimates = [
        TrackEstimate(row[:2], row[2:4], np.array([[row[4], row[5]], [row[5], row[6]]]))
        for row in to_float64(rows)
    ]
    manager = _core.TrackManager()
    accept(manager.configure(config.tracks))
    same = TrackManager(as_reference(config.tracks), LIMITS.max_tracks)
    yield _case(
        "track_manager", lambda: manager.process(rows, FRAME_S), lambda: same.process(estimates, FRAME_S)
    )
    by_kalman = deepcopy(config.tracks)
    by_kalman.update = _core.TrackUpdate.kalman
    kalman = _core.KalmanTracker()
    accept(kalman.configure(by_kalman))
    same_kalman = KalmanTracker(as_reference(by_kalman), LIMITS.max_tracks)
    points = np.ascontiguousarray(rows[:, :2])
    plain = to_float64(points)
    yield _case(
        "kalman_tracker", lambda: kalman.process(points, FRAME_S), lambda: same_kalman.process(plain, FRAME_S)
    )


def _plain(reports: Reports) -> list[tuple[int, NDArray[np.float64], NDArray[np.float64]]]:
    return [(node_id, to_float64(delay_s), to_float64(weight)) for node_id, delay_s, weight in reports]


def _core_hub(material: Material, frames: Sequence[Reports]) -> Run:
    hub, order, numbers = configured_hub(material.hub), back_and_forth(FRAMES), count()

    def call() -> object:
        number = next(numbers)
        for node_id, delay_s, weight in frames[order()]:
            hub.receive(node_id, number, delay_s, weight, number * FRAME_US)
        return hub.poll(number * FRAME_US)

    return timed(accepted(call))


def _reference_hub(material: Material, frames: Sequence[Reports]) -> Run:
    hub = SensorRadarHub(as_reference(material.hub), LIMITS)
    plain = [_plain(reports) for reports in frames]
    order, numbers = back_and_forth(FRAMES), count()

    def call() -> object:
        number = next(numbers)
        for node_id, delay_s, weight in plain[order()]:
            hub.receive(Report(node_id, number, delay_s, weight), number * FRAME_US)
        return hub.poll(number * FRAME_US)

    call()  # as the library did when it was accepted
    return timed(call)
