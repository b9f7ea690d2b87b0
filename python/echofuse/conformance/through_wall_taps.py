"""Compares every tap of a through-wall node with the reference's, response by response.

Target and reference each keep their own state. It depends on time zero and not on the detector's decisions:
after a decision that was a coin toss the rest of that response is not compared; after a time zero that was
one, the rest of the input is not.
"""

from collections.abc import Sequence
from contextlib import closing

import numpy as np
from numpy.typing import NDArray

from echofuse.conformance.choices import Choice
from echofuse.conformance.comparison import Scoreboard, TapComparison, as_reference, to_float64
from echofuse.conformance.target import ConformanceTarget, NodeAnswer
from echofuse.conformance.through_wall_inputs import ThroughWallInput
from echofuse.reference.node.through_wall import ThroughWallNode, ThroughWallReport

Samples = NDArray[np.float64]

THROUGH_WALL_NODE_TAPS = (
    "scan",
    "time_zero",
    "rotated",
    "subtracted",
    "envelope",
    "enhanced",
    "decisions",
    "target_traces",
    "leading_edges",
    "detections",
)
RESPONSE_PERIOD_US = 74_000


def conform_through_wall_node(
    board: Scoreboard, choice: Choice, target: ConformanceTarget, inputs: Sequence[ThroughWallInput]
) -> None:
    """Feed the same responses to target and reference under one choice."""
    for tap in THROUGH_WALL_NODE_TAPS:
        board.row(choice.name, tap)
    for heard in inputs:
        config = heard.config(choice)
        with closing(target.through_wall_node(config)) as node:
            reference = ThroughWallNode(as_reference(config))
            for index, response in enumerate(heard.responses):
                answer = node.process(response, index * RESPONSE_PERIOD_US)
                report = reference.process(to_float64(response))
                where = f"{heard.where}, response {index} of it"
                if answer is None:
                    board.row(choice.name, "scan").failures.append(f"{where}: no report")
                    break
                compared = _Response(board, choice.name, where, float(config.sample_rate_hz))
                if not compared.compare(answer, report):
                    break


class _Response(TapComparison):
    """One response's taps."""

    tolerances = "through_wall"

    def __init__(self, board: Scoreboard, choice: str, where: str, sample_rate_hz: float) -> None:
        super().__init__(board, choice, where)
        self.sample_rate_hz = sample_rate_hz

    def compare(self, answer: NodeAnswer, report: ThroughWallReport) -> bool:
        """Whether the next response may be compared as well."""
        self.got, self.expected, self.margins = answer.taps, report.taps, report.margins
        if not self.board.shows(self.choice, self.where, THROUGH_WALL_NODE_TAPS, self.got):
            return False
        self.floats("scan", "carried")
        if not self._time_zero():
            return False
        self.floats("rotated", "carried")
        # what is subtracted is a difference of samples so large [count]
        peak = float(np.max(np.abs(self.expected["rotated"])))
        self.floats("subtracted", "subtracted", scale=peak)
        self.floats("envelope", "subtracted", scale=peak)
        self.floats("enhanced", "enhanced", scale=peak / self._divisor())
        if self.decisions("decisions", margin=self.margins["decisions"]):
            self._traces(answer, report, peak)
        return True

    def _time_zero(self) -> bool:
        got, expected, margin = self.got["time_zero"], self.expected["time_zero"], self.margins["time_zero"]
        same = self.decisions("time_zero", got[:2], expected[:2], margin=margin)
        return same and self.floats("time_zero", "fraction", got[2], expected[2], margin=margin)

    def _divisor(self) -> Samples:
        """What each sample was divided by to be enhanced [count]."""
        subtracted, enhanced = self.expected["subtracted"], self.expected["enhanced"]
        return np.divide(subtracted, enhanced, out=np.ones_like(enhanced), where=enhanced != 0.0)

    def _traces(self, answer: NodeAnswer, report: ThroughWallReport, peak: float) -> None:
        got, expected = self.got["target_traces"], self.expected["target_traces"]
        if not self.decisions("target_traces", got[:, 1], expected[:, 1]):
            return
        self.floats("target_traces", "trace", got[:, 0], expected[:, 0])
        edges, margin = self.expected["leading_edges"], self.margins["leading_edges"]
        scale = peak * self._samples_a_count(edges[:, 0])
        got = self.got["leading_edges"]
        self.decisions("leading_edges", got[:, 1], edges[:, 1])
        if not self.floats("leading_edges", "edge", got[:, 0], edges[:, 0], margin=margin, scale=scale):
            return
        margin, scale = self.margins["detections"], scale[report.traces] / self.sample_rate_hz
        expected = self.expected["detections"]
        for reported in (self.got["detections"], answer.detections):
            delay_s, weight = to_float64(reported).T
            if self.decisions("detections", weight, expected[:, 1], margin=margin):
                self.floats("detections", "delay", delay_s, expected[:, 0], margin=margin, scale=scale)

    def _samples_a_count(self, edges: Samples) -> Samples:
        """How far an edge moves by an error of the envelope [sample/count]; 0 where it begins its window."""
        envelope = np.append(self.expected["envelope"], 0.0)
        before = np.floor(edges).astype(int)
        rise = envelope[before + 1] - envelope[before]
        moved: Samples = np.divide(1.0, rise, out=np.zeros_like(rise), where=(rise > 0.0) & (edges > before))
        return moved
