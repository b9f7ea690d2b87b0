"""Streams scans through the compiled nodes and hub, in the order of their times: the `inprocess` target.

Every decision is the library's; Python only carries scans in and tables out.
"""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.display.progress import progress
from echofuse.errors import InputError, problem
from echofuse.metrics import measure
from echofuse.recording import TRACK_DTYPE, NodeRecording, Recording
from echofuse.result import RunResult
from echofuse.run_tables import FrameOutput, NodeOutput, RunTables, Scan, Taps
from echofuse.site import PIPELINES, Site, SiteNode, apply_settings

if TYPE_CHECKING:
    from echofuse.emulation.deadline import Processor
    from echofuse.emulation.emulated_radar import EmulatedRadar

LAST_DEADLINE_US = 10_000_000  # after the last scan, so that the frames still open close


def scans_in_time_order(nodes: Sequence[NodeRecording]) -> list[Scan]:
    """Return the scans of all nodes by time, nodes that share a time in their own order."""
    return sorted(
        (
            Scan(time_us=round(float(time_s) * 1e6), node=node, index=index)
            for node, recording in enumerate(nodes)
            for index, time_s in enumerate(recording.time_s)
        ),
        key=lambda scan: (scan.time_us, scan.node),
    )


def node_config(site: Site, place: SiteNode, source: NodeRecording) -> Any:
    """Return a node's configuration: what its recording says, then [pipeline], then its own table.

    It is of the class that the site's pipeline names: `_core.SensorRadarNodeConfig` or another.

    Raises
    ------
    InputError
        One line that names the first field that is impossible with such scans.
    """
    config = PIPELINES[site.pipeline].node_config()
    config.node_id = source.node_id
    config.n_samples = source.scans.shape[1]
    config.sample_rate_hz = source.sample_rate_hz
    if hasattr(config, "first_sample_s"):  # else the node finds time zero itself
        config.first_sample_s = source.first_sample_s
    config.baseline_m = math.dist(place.tx_position_m, place.rx_position_m)
    apply_settings(config, site.settings)
    apply_settings(config, place.settings())
    if config.invalid_field() is not None:
        key = f"node {source.name}: {config.invalid_field()}"
        allowed = f"what scans of {source.scans.shape[1]} samples at {source.sample_rate_hz:g} Hz allow"
        raise InputError(problem(site.name, key, allowed))
    return config


def nominal_source(site: Site, place: SiteNode) -> NodeRecording:
    """Return a node that has recorded nothing yet, with the default scan length and sample rate."""
    nominal = PIPELINES[site.pipeline].node_config()
    return NodeRecording(
        name=place.name,
        node_id=place.id,
        sample_rate_hz=nominal.sample_rate_hz,
        first_sample_s=getattr(nominal, "first_sample_s", 0.0),
        tx_position_m=np.array(place.tx_position_m),
        rx_position_m=np.array(place.rx_position_m),
        scans=np.zeros((0, nominal.n_samples), np.float32),
        time_s=np.zeros(0),
    )


def hub_config(site: Site) -> Any:
    """Return the hub's configuration, of the pipeline's class: the geometry of the site, then [pipeline]."""
    kind = PIPELINES[site.pipeline]
    config = kind.hub_config()
    config.set_nodes(
        [node.id for node in site.nodes],
        np.array([node.tx_position_m[: kind.dimension] for node in site.nodes], np.float32),
        np.array([node.rx_position_m[: kind.dimension] for node in site.nodes], np.float32),
    )
    config.set_area(*(site.box_m if kind.dimension == 3 else site.bounds_m))
    if hasattr(config, "phd"):
        x_min, y_min, x_max, y_max = site.bounds_m
        config.phd.area_m2 = (x_max - x_min) * (y_max - y_min)
    locator = getattr(config, "taylor_3d" if kind.dimension == 3 else "line_locator", None)
    if locator is not None and site.wall is not None:
        locator.wall.thickness_m = site.wall.thickness_m
        locator.wall.relative_permittivity = site.wall.relative_permittivity
    apply_settings(config, site.settings)
    return config


class SensorRadar:
    """Nodes and hub of one site, of any pipeline, fed scan by scan."""

    def __init__(self, site: Site, sources: Sequence[NodeRecording]) -> None:
        self._sources = tuple(sources)
        places = places_of(site, sources)
        self._nodes: list[Any] = []  # compiled nodes; None where the site knows none
        self._pulses: list[int] = []  # that make one scan; a report's number counts scans
        for source in sources:
            place = places.get(source.node_id)
            config = None if place is None else node_config(site, place, source)
            self._nodes.append(None if config is None else configured_node(site, config, source))
            self._pulses.append(pulses_per_scan(config))
        #: None where there are too few nodes for a hub.
        self.hub_config: Any = None
        self.hub: Any = NodesAlone()
        if why_no_positions(site, sources) is None:
            self.hub_config = hub_config(site)
            self.hub = configured_hub(site, self.hub_config)

    def scan(self, scan: Scan, samples: NDArray[Any], *, taps: bool = False) -> NodeOutput:
        """Give a node its next scan (n_samples,) [count], and the hub what the node reports.

        A node that the site does not know processes nothing; the hub counts its report as a stranger's.
        """
        node, source = self._nodes[scan.node], self._sources[scan.node]
        if node is None:
            self._report(source.node_id, scan.index, np.empty(0, NO_DETECTIONS), scan.time_us)
            return NodeOutput(detections=np.empty(0, NO_DETECTIONS))
        values = np.ascontiguousarray(samples, np.float32)
        tapped: Taps = {}
        if taps:
            status, detections, tapped = node.process_with_taps(values, scan.time_us)
        else:
            status, detections = node.process(values, scan.time_us)
        if status != _core.Status.invalid_input and node.report_ready():
            number = scan.index // self._pulses[scan.node]
            self._report(source.node_id, number, detections, scan.time_us)
        return NodeOutput(detections=detections, taps=tapped)

    def frames(self, now_us: int) -> Iterator[FrameOutput]:
        """Yield the frames that are closed at a time of the hub."""
        while True:
            _, closed, taps = self.hub.poll_with_taps(now_us)
            if closed is None:
                return
            time_us, _, tracks = closed
            yield FrameOutput(time_us=time_us, points=taps["points"], tracks=tracks, taps=taps)

    def counters(self) -> dict[str, dict[str, int]]:
        """Return what hub and nodes counted, by name."""
        known = zip(self._sources, self._nodes, strict=True)
        hub = self.hub.counters()
        return ({"hub": hub} if hub else {}) | {
            source.name: node.counters() for source, node in known if node is not None
        }

    def _report(self, node_id: int, frame: int, detections: NDArray[np.void], now_us: int) -> None:
        delay_s, weight = (
            np.ascontiguousarray(detections[name], np.float32) for name in ("delay_s", "weight")
        )
        # The hub counts what it does not take; there is nothing to do about it here.
        self.hub.receive(node_id, frame, delay_s, weight, now_us)


class NodesAlone:
    """Stands for the hub where there are too few nodes for positions: a frame a scan time, and no tracks."""

    def __init__(self) -> None:
        self._time_us: int | None = None  # of the frame that is open
        self._frames = 0

    def receive(self, *report: Any) -> None:
        """Open the frame of a report, which ends with the time."""
        self._time_us = report[-1]

    def poll_with_taps(self, now_us: int) -> tuple[None, tuple[int, int, NDArray[np.void]] | None, Taps]:
        """Close the open frame once its time has passed."""
        if self._time_us is None or now_us <= self._time_us:
            return None, None, {}
        closed = (self._time_us, self._frames, np.zeros(0, TRACK_DTYPE))
        self._time_us, self._frames = None, self._frames + 1
        return None, closed, {"points": np.zeros((0, 4), np.float32)}

    def counters(self) -> dict[str, int]:
        """Return nothing: there is no hub."""
        return {}


NO_DETECTIONS = np.dtype([("delay_s", "f4"), ("weight", "f4")])


def process_recording(
    recording: Recording,
    site: Site,
    *,
    taps: bool = False,
    target: str = "inprocess",
    processor: "Processor | None" = None,
) -> RunResult:
    """Run a recording through its pipeline on a target; with `taps`, keep the stages for the report.

    processor: what turns a Cortex-M7's instructions into time.
    """
    check_pipeline(recording, site)
    if target == "inprocess":
        return _process(SensorRadar(site, recording.nodes), recording, site, taps=taps)
    from echofuse.emulation.deadline import Processor
    from echofuse.emulation.emulated_radar import EmulatedRadar

    check_positions(recording, site)
    with EmulatedRadar(site, recording.nodes, target) as radar:
        result = _process(radar, recording, site, taps=taps)
        result.target = target
        result.metrics |= radar.metrics(processor or Processor())
    return result


def _process(
    radar: "SensorRadar | EmulatedRadar", recording: Recording, site: Site, *, taps: bool
) -> RunResult:
    tables = RunTables(recording, radar.hub_config)
    order = scans_in_time_order(recording.nodes)
    shown = shown_scan(recording) if taps else -1
    for scan in progress(order, "processing", len(order)):
        for frame in radar.frames(scan.time_us):
            tables.add_frame(frame)
        samples = recording.nodes[scan.node].scans[scan.index]
        output = radar.scan(scan, samples, taps=taps)
        tables.add_scan(scan, output, shown=scan.index == shown)
    end_us = (order[-1].time_us if order else 0) + LAST_DEADLINE_US
    for frame in radar.frames(end_us):
        tables.add_frame(frame)
    result = tables.result(site, radar.counters(), shown)
    result.why_no_positions = why_no_positions(site, recording.nodes)
    measure(result)
    return result


def check_pipeline(recording: Recording, site: Site) -> None:
    """Raise when a site is not for a recording's pipeline."""
    if recording.pipeline != site.pipeline:
        expected = f"the recording's pipeline '{recording.pipeline}'"
        raise InputError(problem(site.name, "pipeline.name", expected, site.pipeline))


def places_of(site: Site, sources: Sequence[NodeRecording]) -> dict[int, SiteNode]:
    """Return the site's nodes by id; a recording that has none of them is an error."""
    places = {place.id: place for place in site.nodes}
    if not any(source.node_id in places for source in sources):
        found = ", ".join(str(source.node_id) for source in sources)
        known = ", ".join(map(str, places))
        raise InputError(problem(site.name, "node.id", f"ids of the recording's nodes ({found})", known))
    return places


def why_no_positions(site: Site, sources: Sequence[NodeRecording]) -> str | None:
    """Return why these nodes cannot say where people are, None when they can."""
    least = PIPELINES[site.pipeline].least_nodes
    places = {place.id for place in site.nodes}
    known = [source.name for source in sources if source.node_id in places]
    if len(known) >= least:
        return None
    here = f"{len(known)} of them: {', '.join(known)}" if len(known) > 1 else known[0] if known else "none"
    return f"a position takes {least} receivers that recording and site both know, here is {here}"


def check_positions(recording: Recording, site: Site) -> None:
    """Raise when a recording and its site have too few nodes in common for a hub."""
    why = why_no_positions(site, recording.nodes)
    if why is not None:
        raise InputError(problem(site.name, "node", f"enough nodes for a hub: {why}"))


def pulses_per_scan(config: Any) -> int:
    """Return how many scans of a recording a node makes one of."""
    integrator = getattr(config, "pulse_integrator", None)
    return 1 if integrator is None else int(integrator.pulses_per_scan)


def configured_hub(site: Site, config: Any) -> Any:
    """Return a hub that has begun nothing yet."""
    hub = PIPELINES[site.pipeline].new_hub()
    if hub.configure(config) != _core.Status.ok:
        raise InputError(problem(site.name, f"pipeline.{config.invalid_field()}", "a possible value"))
    return hub


def configured_node(site: Site, config: Any, source: NodeRecording) -> Any:
    """Return a node that knows the empty room if its recording does."""
    node = PIPELINES[site.pipeline].new_node()
    if node.configure(config) != _core.Status.ok:
        raise ValueError(f"{config.invalid_field()}: impossible, which node_config tells")
    if source.reference is not None and hasattr(node, "set_empty_room"):
        for scan in source.reference:
            if node.set_empty_room(np.ascontiguousarray(scan, np.float32)) != _core.Status.ok:
                raise InputError(
                    problem(site.name, f"node {source.name}: reference", "finite scans of the empty room")
                )
    return node


def shown_scan(recording: Recording) -> int:
    """Return the scan whose stages the report shows: the middle one, like the paper's 32nd of 61."""
    return max((len(node.scans) for node in recording.nodes), default=0) // 2
