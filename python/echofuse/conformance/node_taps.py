"""Compares every tap of a node with the reference's, scan by scan.

Target and reference each keep their own state. What a scan leaves behind depends on its shift, not on the
detector's decisions: after a decision that was a coin toss, the rest of that scan is not compared; after a
shift or a direct path that was one, the rest of the input is not.
"""

from collections.abc import Sequence
from contextlib import closing
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echofuse.conformance.choices import Choice
from echofuse.conformance.comparison import Scoreboard, TapComparison, as_reference, to_float64
from echofuse.conformance.inputs import NodeInput
from echofuse.conformance.target import ConformanceTarget, NodeAnswer
from echofuse.reference.node.node import MAX_DETECTIONS, NodeReport, SensorRadarNode, heaviest
from echofuse.reference.node.scan.range_clusters import RangeCluster

Samples = NDArray[np.float64]

NODE_TAPS = (
    "scan",
    "envelope",
    "direct_path",
    "alignment",
    "aligned",
    "residual",
    "threshold",
    "decisions",
    "range_clusters",
    "detections",
)
SCAN_PERIOD_US = 100_000


def conform_node(
    board: Scoreboard, choice: Choice, target: ConformanceTarget, inputs: Sequence[NodeInput]
) -> None:
    """Feed the same scans to target and reference under one choice."""
    for tap in NODE_TAPS:
        board.row(choice.name, tap)
    for heard in inputs:
        config = heard.config(choice)
        plain = as_reference(config)
        with closing(target.node(config)) as node:
            reference = SensorRadarNode(plain)
            for scan in heard.empty_room if heard.has_empty_room(choice) else ():
                node.set_empty_room(scan)
                reference.set_empty_room(to_float64(scan))
            for index, scan in enumerate(heard.scans_of(choice)):
                answer = node.process(scan, index * SCAN_PERIOD_US)
                report = reference.process(to_float64(scan))
                where = f"{heard.where}, scan {index} of it"
                if (answer is None) != (report is None):
                    board.row(choice.name, "scan").failures.append(f"{where}: complete for one side only")
                    break
                if answer is None or report is None:
                    continue
                if not _Scan(board, choice.name, where, plain).compare(answer, report):
                    break


class _Scan(TapComparison):
    """One scan's taps."""

    tolerances = "sensor_radar"

    def __init__(self, board: Scoreboard, choice: str, where: str, config: Any) -> None:
        super().__init__(board, choice, where)
        self.sample_rate_hz = float(config.sample_rate_hz)
        self.whole_samples = config.alignment.method != "sub_sample"

    def compare(self, answer: NodeAnswer, report: NodeReport) -> bool:
        """Whether the next scan may be compared as well."""
        self.answer, self.got = answer, answer.taps
        self.expected, self.margins = report.taps, report.margins
        self.peak = float(
            np.max(np.abs(self.expected["aligned"]))
        )  # what residuals are differences of [count]
        if not self.board.shows(self.choice, self.where, NODE_TAPS, self.got):
            return False
        self.floats("scan", "scan")
        self.floats("envelope", "envelope")
        if not self._direct_path() or not self._alignment():
            return False
        self.floats("aligned", "aligned")
        self.floats("residual", "residual", scale=self.peak)
        if self._detector():
            self._clusters()
        return True

    def _direct_path(self) -> bool:
        got, expected, margin = (
            self.got["direct_path"],
            self.expected["direct_path"],
            self.margins["direct_path"],
        )
        return (
            self.decisions("direct_path", got[0], expected[0], margin=margin)
            and self.floats("direct_path", "toa", got[1], expected[1], margin=margin)
            and self.floats("direct_path", "path_threshold", got[2], expected[2], margin=margin)
        )

    def _alignment(self) -> bool:
        got, expected, margin = self.got["alignment"], self.expected["alignment"], self.margins["alignment"]
        if self.whole_samples:
            same = self.decisions("alignment", got[0], expected[0], margin=margin)
        else:
            same = self.floats("alignment", "shift", got[0], expected[0], margin=margin)
        return same and self.floats("alignment", "correlation", got[1], expected[1], margin=margin)

    def _detector(self) -> bool:
        margin = self.margins["decisions"]
        self.floats(
            "threshold",
            "threshold",
            np.sqrt(self.got["threshold"]),
            np.sqrt(self.expected["threshold"]),
            margin=margin,
            scale=self.peak,
        )
        return self.decisions("decisions", self.got["decisions"], self.expected["decisions"], margin=margin)

    def _clusters(self) -> None:
        got, expected = self.got["range_clusters"], self.expected["range_clusters"]
        if not self.decisions("range_clusters", got[:, 1:], expected[:, 1:]):
            return
        first = expected[:, 2].astype(int)
        before = np.maximum(first - 1, 0)
        margin = np.minimum(self.margins["decisions"][first], self.margins["decisions"][before])
        scale = self._samples_a_count(first, before) * self.peak
        self.floats("range_clusters", "position", got[:, 0], expected[:, 0], margin=margin, scale=scale)
        reported_rows = {cluster.first_sample for cluster in heaviest(_clusters(expected), MAX_DETECTIONS)}
        kept = np.array([int(row[2]) in reported_rows for row in expected], dtype=bool)
        for reported in (self.got["detections"], self.answer.detections):
            self._detections(to_float64(reported), margin[kept], scale[kept] / self.sample_rate_hz)

    def _samples_a_count(self, first: Samples, before: Samples) -> Samples:
        """How far an edge moves by an error of the residual [sample/count]."""
        residual, threshold = self.expected["residual"], self.expected["threshold"]
        rise = (residual[first] ** 2 - threshold[first]) - (residual[before] ** 2 - threshold[before])
        moved: Samples = 2.0 * residual[first] / np.maximum(rise, 1e-12)
        return moved

    def _detections(self, got: Samples, margin: Samples, scale: Samples) -> None:
        expected = self.expected["detections"]
        if self.decisions("detections", got[:, 1], expected[:, 1]):
            self.floats("detections", "delay", got[:, 0], expected[:, 0], margin=margin, scale=scale)


def _clusters(rows: Samples) -> list[RangeCluster]:
    return [RangeCluster(row[0], int(row[1]), int(row[2]), int(row[3])) for row in rows]
