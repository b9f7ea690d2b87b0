"""Runs a recording through emulated radars, links and machines: a function of (scenario, seed, target)."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from echofuse.emulation import codec
from echofuse.emulation.accounting import Account, account
from echofuse.emulation.clock import VirtualClock
from echofuse.emulation.injection import Effect, InjectionLog
from echofuse.emulation.link import Link
from echofuse.emulation.machine import ScanInput, StepOutput, Target, by_frame
from echofuse.emulation.monitor import HubMonitor
from echofuse.emulation.radar import RadarEvent, digitised, schedule, start_us
from echofuse.emulation.reception import Receiver
from echofuse.emulation.scenario import Fault, Scenario
from echofuse.emulation.scenario_file import check_nodes
from echofuse.emulation.stations import NodeStation, Station, is_report
from echofuse.emulation.targets import open_target
from echofuse.metrics import measure
from echofuse.pipeline import LAST_DEADLINE_US, check_pipeline, hub_config, places_of, shown_scan
from echofuse.recording import Emulated, NodeRecording, Recording
from echofuse.result import RunResult
from echofuse.run_tables import FrameOutput, NodeOutput, RunTables, Scan, Taps
from echofuse.site import Site

__all__ = ["Emulation", "emulate"]

TICK_US = 10_000  # a hub looks this often whether a deadline has passed


@dataclass(frozen=True, kw_only=True)
class Emulation:
    """What a run was, beside its result."""

    scenario: Scenario
    seed: int
    target: str
    log: InjectionLog
    account: Account
    profiles: dict[str, list[dict[str, int]]] = field(
        default_factory=dict
    )  # by machine, of each scan or frame


def emulate(
    recording: Recording,
    site: Site,
    scenario: Scenario | None = None,
    seed: int = 0,
    target: str = "inprocess",
    *,
    taps: bool = False,
) -> RunResult:
    """Run a recording on a target with a scenario's faults; with `taps`, keep the stages for the report.

    Raises
    ------
    InputError
        The scenario names nodes that the recording does not have; no such target.
    NotAppliedError
        A fault of the scenario never came about.
    """
    scenario = scenario or Scenario()
    check_pipeline(recording, site)
    names = tuple(node.name for node in recording.nodes)
    check_nodes(scenario, site, names, f"scenario {scenario.name}")
    sources = tuple(digitised(node, scenario.radar_of(node.name)) for node in recording.nodes)
    opened = open_target(target, site, sources)
    run = None
    try:
        run = _Run(recording, site, scenario, seed, opened, sources, shown_scan(recording) if taps else -1)
        return run.result(target)
    finally:
        if run is not None:
            run.close()
        opened.close()


class _Run:
    """One run."""

    def __init__(
        self,
        recording: Recording,
        site: Site,
        scenario: Scenario,
        seed: int,
        target: Target,
        sources: tuple[NodeRecording, ...],
        shown: int,
    ) -> None:
        self._recording, self._site, self._scenario, self._seed = recording, site, scenario, seed
        self._sources, self._shown = sources, shown
        self._log = InjectionLog()
        self._begin_us = start_us(sources)
        self._clock = VirtualClock(min(self._begin_us, 0))
        config = hub_config(site)
        self._tables = RunTables(recording, config)
        self._monitor = HubMonitor(config.frame_assembler, [node.id for node in site.nodes])
        self._heard_intact = 0  # frames that arrived at a running hub
        self._heard_reports = self._unheard_reports = 0  # of nodes, also while there was no hub
        self._strange: Counter[int] = Counter()  # reports of each stranger's id
        self._from_hub = Receiver()
        self._hub = Station(target.open_hub)
        self._nodes: list[NodeStation] = []
        for index in range(len(sources)):
            self._nodes.append(self._node(index, target))

    def result(self, target: str) -> RunResult:
        """Let everything happen, and return what came of it."""
        self._plan()
        self._clock.run()
        for node in self._nodes:
            node.link.finish()
        self._clock.run()
        self._step_hub(b"", self._clock.now_us + LAST_DEADLINE_US)
        end_us = self._clock.now_us + LAST_DEADLINE_US
        for station in (self._hub, *self._nodes):
            station.switch_off(end_us)
        self._log.check_all_applied(f"scenario {self._scenario.name}")
        counters = {"hub": self._hub.counters()} | {node.name: node.counters() for node in self._nodes}
        result = self._tables.result(self._site, counters, self._shown)
        note = Emulated(scenario=self._scenario.name, seed=self._seed, scenario_toml=self._scenario.text)
        result.recording = replace(result.recording, emulated=note)
        result.target = target
        result.emulation = Emulation(
            scenario=self._scenario,
            seed=self._seed,
            target=target,
            log=self._log,
            account=self._account(counters),
            profiles={"hub": self._hub.profiles} | {node.name: node.profiles for node in self._nodes},
        )
        measure(result)
        return result

    def close(self) -> None:
        """End all machines that still run."""
        for station in (self._hub, *self._nodes):
            station.close()

    def _node(self, index: int, target: Target) -> NodeStation:
        source, scenario = self._sources[index], self._scenario
        link = Link(
            source.name,
            scenario.link_of(source.name),
            seed=self._seed,
            log=self._log,
            clock=self._clock,
            deliver=self._deliver,
        )
        return NodeStation(
            source.name,
            lambda: target.open_node(index),
            radar=scenario.radar_of(source.name),
            faults=tuple(fault for fault in scenario.faults if fault.node == source.name),
            link=link,
            seed=self._seed,
            log=self._log,
            begin_us=self._begin_us,
        )

    def _plan(self) -> None:
        """Put the scans, the faults and the hub's ticks on the clock."""
        scans = []
        for index, source in enumerate(self._sources):
            faults = self._scenario.radar_of(source.name)
            events = schedule(source, faults, seed=self._seed, begin_us=self._begin_us, log=self._log)
            scans += [(event.ready_us, index, event) for event in events]
        last_us = max((ready_us for ready_us, _, _ in scans), default=0)
        for fault in self._scenario.faults:
            self._plan_fault(fault, last_us)
        for ready_us, index, event in sorted(scans, key=lambda scan: scan[:2]):
            self._clock.at(ready_us, self._scanning(index, event))
        self._clock.at(self._begin_us, self._tick)

    def _plan_fault(self, fault: Fault, last_us: int) -> None:
        self._log.want(fault.key, fault.node or "*")
        at_us = self._begin_us + round(fault.at_s * 1e6)
        if at_us > last_us:
            return
        if fault.kind == "stranger":
            until_us = min(last_us, self._begin_us + fault.until_s * 1e6)
            for number in range(int(until_us - at_us) // fault.every_us + 1):
                self._clock.at(at_us + number * fault.every_us, lambda: self._send_strange(fault))
        elif fault.kind in ("crash", "restart", "hub_restart"):
            station = self._hub if fault.kind == "hub_restart" else self._station(fault.node)
            self._clock.at(at_us, lambda: self._switch_off(station, fault))
            if fault.kind != "crash":
                until_us = self._begin_us + round(fault.until_s * 1e6)
                self._clock.at(until_us, lambda: self._switch_on(station, fault))

    def _station(self, name: str) -> NodeStation:
        return next(node for node in self._nodes if node.name == name)

    def _switch_off(self, station: Station, fault: Fault) -> None:
        if station is self._hub and station.machine is not None:
            # It may have to be stepped to tell its counters, and that closes the frame that is open, as it
            # does on all targets. What it says there, nobody hears.
            at_us = self._clock.now_us + LAST_DEADLINE_US
            self._monitor.step(at_us, b"")
            station.machine.step(at_us)
            station.switch_off(at_us)
        station.switch_off(self._clock.now_us)
        self._log.add(fault.key, fault.node, self._clock.now_us, Effect.NOTHING, "off")

    def _switch_on(self, station: Station, fault: Fault) -> None:
        if station.machine is not None:
            return
        station.switch_on()
        self._log.add(fault.key, fault.node, self._clock.now_us, Effect.RESTARTED, "on")
        if station is self._hub:
            self._monitor.restart()
            self._from_hub = Receiver()

    def _scanning(self, index: int, event: RadarEvent) -> Callable[[], None]:
        return lambda: self._scan(index, event)

    def _scan(self, index: int, event: RadarEvent) -> None:
        samples = np.ascontiguousarray(self._sources[index].scans[event.index], np.float32)
        taps = self._shown >= 0
        output = self._nodes[index].scan(event, ScanInput(event.node_time_us, samples), taps=taps)
        if output is not None:
            row = Scan(time_us=event.true_time_us, node=index, index=event.index)
            self._tables.add_scan(row, _node_output(output), shown=event.index == self._shown)

    def _send_strange(self, fault: Fault) -> None:
        """Send one report of somebody the site does not list, if there is a hub to hear it."""
        if self._hub.machine is None:
            return
        now_us = self._clock.now_us
        payload = codec.detections_payload(now_us, np.array([2e-8]), np.array([10]))
        number = self._strange[fault.node_id]
        self._strange[fault.node_id] += 1
        self._log.add(fault.key, f"id {fault.node_id}", now_us, Effect.STRANGE)
        self._deliver(codec.frame(codec.Transfer(fault.node_id, codec.DETECTIONS, number, payload)), True)

    def _tick(self) -> None:
        self._step_hub(b"", self._clock.now_us)
        if self._clock.waiting:
            self._clock.at(self._clock.now_us + TICK_US, self._tick)

    def _deliver(self, data: bytes, intact: bool) -> None:
        report = intact and is_report(data)
        if self._hub.machine is None:
            self._unheard_reports += report
            return
        self._heard_intact += intact
        self._heard_reports += report
        self._step_hub(data, self._clock.now_us)

    def _step_hub(self, data: bytes, now_us: int) -> None:
        if self._hub.machine is None:
            return
        self._monitor.step(now_us, data)
        output = self._hub.machine.step(now_us, data, taps=True)
        self._hub.keep_profile(output)
        taps = by_frame(output.taps)
        for transfer in self._from_hub.feed(output.link_out, now_us):
            report = codec.reported_tracks(transfer)
            if report is not None:
                time_us, _, tracks = report
                shown = next(taps, {})
                points = shown.get("points", np.zeros((0, 4), np.float32))
                frame = FrameOutput(time_us=time_us, points=points, tracks=tracks, taps=shown)
                self._tables.add_frame(frame)

    def _account(self, counters: dict[str, dict[str, int]]) -> Account:
        known = places_of(self._site, self._sources)
        made = {
            node.name: node.reports_made
            for node, source in zip(self._nodes, self._sources, strict=True)
            if source.node_id in known
        }
        return account(
            log=self._log,
            expected=self._monitor.expected(),
            counters=counters,
            made=made,
            made_by_strangers=sum(node.reports_made for node in self._nodes) - sum(made.values()),
            heard_intact=self._heard_intact,
            heard_reports=self._heard_reports,
            unheard_reports=self._unheard_reports,
        )


def _node_output(output: StepOutput) -> NodeOutput:
    """Return what a node said about a scan, from the report that it put on the link."""
    detections = np.zeros(0, codec.DETECTION)
    for transfer in codec.FrameReader().feed(output.link_out):
        if transfer.kind == codec.MESSAGE and transfer.port == codec.DETECTIONS:
            _, detections = codec.parse_detections(transfer.payload)
    taps: Taps = dict(output.taps)
    return NodeOutput(detections=detections, taps=taps)
