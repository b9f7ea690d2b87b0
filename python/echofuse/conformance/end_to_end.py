"""One whole run: target and reference each on their own, from raw scans to tracks."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.choices import Choice
from echofuse.conformance.comparison import Scoreboard, as_reference, to_float64
from echofuse.conformance.hub_inputs import hub_config_of, scene_of
from echofuse.conformance.hub_reference import hub_limits, reference_report
from echofuse.conformance.inputs import node_config_of
from echofuse.conformance.target import ConformanceTarget, Report
from echofuse.reference.hub.hub import HubFrame, SensorRadarHub
from echofuse.reference.hub.track.track_manager import CONFIRMED
from echofuse.reference.node.node import SensorRadarNode
from echofuse.simulation.sensor_radar import SensorRadarSimulation, case_study_people

Array = NDArray[np.float64]
FRAMES = 61  # the case study's walk
EMPTY_ROOM_SCANS = 5
SCAN_PERIOD_US = 100_000
TRACKERS = ("phd", "kalman")
END_TO_END_TAPS = ("detections", "tracks")


class FrameReports(NamedTuple):
    """What all nodes said in one frame."""

    target: list[Report]
    reference: list[Report]  # float64 inside
    margin: float  # of the reference's decisions, in this frame and all before it


def conform_end_to_end(board: Scoreboard, target: ConformanceTarget, frames: int) -> Iterator[None]:
    """Run one person's walk of the case study, with each tracker."""
    reports = []
    for frame in _listen(board, target, frames):
        reports.append(frame)
        yield
    for tracker in TRACKERS:
        _track(board, target, tracker, reports)
        yield


def _listen(board: Scoreboard, target: ConformanceTarget, frames: int) -> Iterator[FrameReports]:
    simulation = SensorRadarSimulation(scene_of("shared Tx"), case_study_people(1), seed=0)
    places = simulation.scene.nodes
    configs = [node_config_of(simulation.scene, place) for place in places]
    nodes = [target.node(config) for config in configs]
    references = [SensorRadarNode(as_reference(config)) for config in configs]
    for which in range(len(places)):
        for scan in simulation.reference(which, EMPTY_ROOM_SCANS):
            nodes[which].set_empty_room(scan)
            references[which].set_empty_room(to_float64(scan))
    margin = np.inf
    for index in range(frames):
        got, expected = [], []
        for which, scan in enumerate(simulation.frame(index).scans):
            answer, report = (
                nodes[which].process(scan, index * SCAN_PERIOD_US),
                references[which].process(to_float64(scan)),
            )
            assert answer is not None  # one pulse makes a scan
            assert report is not None
            margin = min(margin, *(float(np.min(np.abs(values))) for values in report.margins.values()))
            where = f"seed 0, frame {index}, {places[which].name}"
            for tracker in TRACKERS:
                _compare_detections(
                    board, _name(tracker), where, answer.detections, report.detections, margin
                )
            got.append(_report(places[which].node_id, index, answer.detections, np.float32))
            expected.append(_report(places[which].node_id, index, report.detections, np.float64))
        yield FrameReports(got, expected, margin)
    for node in nodes:
        node.close()


def _name(tracker: str) -> str:
    return f"end to end, {tracker}"


def _report(node_id: int, frame: int, detections: Array, kind: type[np.floating]) -> Report:
    delay_s, weight = (np.ascontiguousarray(column, kind) for column in detections.T)
    return Report(node_id, frame, delay_s, weight)


def _compare_detections(
    board: Scoreboard, choice: str, where: str, got: Array, expected: Array, margin: float
) -> None:
    if board.decisions(choice, "detections", where, got[:, 1], expected[:, 1], margin):
        name = "sensor_radar.free_delay"
        board.floats(choice, "detections", where, got[:, 0], expected[:, 0], name, margin=margin)


def _track(board: Scoreboard, target: ConformanceTarget, tracker: str, reports: list[FrameReports]) -> None:
    choice = Choice(name=_name(tracker), settings={"tracker": tracker})
    config = hub_config_of(scene_of("shared Tx"), choice)
    hub, reference = target.hub(config), SensorRadarHub(as_reference(config), hub_limits(_core.LIMITS))
    margin = np.inf
    for index, frame in enumerate(reports):
        now_us = index * SCAN_PERIOD_US
        for got, expected in zip(frame.target, frame.reference, strict=True):
            hub.receive(got, now_us)
            reference.receive(reference_report(expected), now_us)
        answer, step = hub.poll(now_us), reference.poll(now_us)
        where = f"seed 0, frame {index}"
        if answer is None or step is None:
            board.row(choice.name, "tracks").failures.append(f"{where}: the frame is not closed")
            return
        margin = min(margin, frame.margin, *step.margins.values())
        _compare_tracks(board, choice.name, where, to_float64(answer.taps["tracks"]), step, margin)
    hub.close()


def _compare_tracks(
    board: Scoreboard, choice: str, where: str, got: Array, step: HubFrame, margin: float
) -> None:
    """Ids and states until a coin toss; positions of confirmed tracks always."""
    expected = step.taps["tracks"]
    board.decisions(choice, "tracks", where, got[:, [0, 1]], expected[:, [0, 1]], margin)
    confirmed = expected[expected[:, 1] == CONFIRMED][:, 2:4]
    found = got[got[:, 1] == CONFIRMED][:, 2:4]
    if len(confirmed) == 0:
        return
    if len(found) == 0:
        found = np.full((1, 2), np.inf)
    gaps = np.linalg.norm(confirmed[:, None] - found[None], axis=2)
    nearest = found[np.argmin(gaps, axis=1)]
    board.floats(choice, "tracks", where, nearest, confirmed, f"sensor_radar.free_{choice.split()[-1]}")
