"""Positions from a frame's detections (sensor-radar paper, V-A and V-B), and a greedy choice among them."""

from itertools import combinations, product
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.hub.locate.ellipse_least_squares import (
    EllipseConfig,
    Ellipses,
    ellipse_least_squares,
    range_residual_m,
    refine,
    start,
)
from echofuse.reference.hub.locate.site import Site, inside, path_m

Array = NDArray[np.float64]
MANY_TUPLES = 1 << 40  # where their count saturates
DEPTH_SLACK = 8  # this many times too many tuples: detections are left out first
Chosen = tuple[int, ...]  # one entry a node: the index of its detection in the frame, or -1


class SelectionConfig(Protocol):
    method: str  # consensus | all_tuples
    residual: str  # range_residual | equation_residual
    nodes_per_tuple: int
    min_weight: float
    max_range_residual_m: float
    max_equation_residual_m3: float
    coarse_residual_m: float
    support_gate_m: float
    min_support: int
    min_support_fraction: float
    min_own_support: int
    echo_tail_m: float
    track_aided: bool
    track_gate_m: float
    track_min_support: int
    track_min_own_support: int


class Frame(NamedTuple):
    """All detections of a frame."""

    node_index: NDArray[np.intp]  # (n,) ascending
    path_m: Array  # (n,) [m] ascending within a node
    weight: Array  # (n,) [1]
    n_reported: int  # nodes that reported, with or without detections


class Limits(NamedTuple):
    """The capacities of the core's limits.hpp that cut work here."""

    max_tuples: int
    max_measurements: int
    max_candidates: int


class Measurements(NamedTuple):
    position_m: Array  # (m, 2) [m]
    weight: Array  # (m,) sum of the detections' weights
    range_residual_m: Array  # (m,) [m]
    n_nodes: NDArray[np.intp]  # (m,) nodes that support it
    dropped_detections: int  # not used in any tuple
    dropped_tuples: int  # not solved
    dropped_measurements: int  # did not fit
    margin: float  # least relative distance of a decision from flipping


class Candidate(NamedTuple):
    position_m: Array
    chosen: Chosen
    residual_m: float
    weight: float
    own: int = 0  # supporters that no better candidate explains

    @property
    def support(self) -> int:
        return sum(index >= 0 for index in self.chosen)


class Needed(NamedTuple):
    """Least support of a position."""

    support: int  # nodes
    own: int  # of them, by a detection that no better position explains


class Selector:
    """One frame's work; the margin collects how near its decisions came to flipping."""

    def __init__(
        self, config: SelectionConfig, ellipse: EllipseConfig, site: Site, limits: Limits, frame: Frame
    ):
        self.config, self.ellipse, self.site, self.limits, self.frame = config, ellipse, site, limits, frame
        self.margin = np.inf
        self.used = np.zeros(len(frame.path_m), dtype=bool)
        part = int(np.ceil(config.min_support_fraction * frame.n_reported - 1e-4))
        self.needed = Needed(max(config.min_support, part), config.min_own_support)

    def decide(self, value: float, bound: float) -> bool:
        """value <= bound, remembering how close it was."""
        if not np.isfinite(value):
            return False
        self.margin = min(self.margin, abs(value - bound) / max(abs(bound), 1e-12))
        return bool(value <= bound)

    def inside(self, position_m: Array) -> bool:
        within, gap = inside(position_m, self.site.area_m)
        self.margin = min(self.margin, gap)
        return within

    def ellipses(self, indices: list[int]) -> Ellipses:
        nodes = self.frame.node_index[indices]
        ones = np.ones(len(indices))
        return Ellipses(self.site.tx_m[nodes], self.site.rx_m[nodes], self.frame.path_m[indices], ones)

    # ---- the paper: every tuple

    def all_tuples(self, tuples: list[Chosen]) -> list[Candidate]:
        """Every tuple whose weight and residual pass (V-B)."""
        found = []
        for indices in tuples:
            weight = float(np.sum(self.frame.weight[list(indices)]))
            if not self.decide(-weight, -self.config.min_weight):
                continue
            fix = ellipse_least_squares(self.ellipse, self.ellipses(list(indices)), self.site.area_m)
            if fix is None or not fix.converged:
                continue
            self.margin = min(self.margin, fix.margin)
            if self.config.residual == "equation_residual":
                passed = self.decide(fix.equation_residual_m3, self.config.max_equation_residual_m3)
            else:
                passed = self.decide(fix.range_residual_m, self.config.max_range_residual_m)
            if passed and self.inside(fix.position_m):
                found.append(Candidate(fix.position_m, indices, fix.range_residual_m, weight))
        return found

    # ---- the choice: what most nodes support

    def supporters(self, position_m: Array, gate_m: float) -> Chosen:
        """Of each node the detection nearest to the predicted path, if within the gate."""
        chosen = []
        for node, (tx, rx) in enumerate(zip(self.site.tx_m, self.site.rx_m, strict=True)):
            of_node = np.flatnonzero(self.frame.node_index == node)
            if len(of_node) == 0:
                chosen.append(-1)
                continue
            gaps = np.abs(self.frame.path_m[of_node] - path_m(position_m, tx, rx, self.ellipse.body_radius_m))
            if len(gaps) > 1:
                first, second = np.sort(gaps)[:2]
                if first <= gate_m:
                    self.margin = min(self.margin, second - first)
            nearest = int(np.argmin(gaps))
            chosen.append(int(of_node[nearest]) if self.decide(float(gaps[nearest]), gate_m) else -1)
        return tuple(chosen)

    def candidate(self, position_m: Array, gate_m: float, needed: Needed) -> Candidate | None:
        """Refine a position with all that support it, twice; None when too few do, or they contradict."""
        once = self.supported_fix(position_m, gate_m, needed)
        twice = once and self.supported_fix(once.position_m, self.config.support_gate_m, needed)
        if twice is None or not self.decide(-twice.weight, -self.config.min_weight):
            return None
        if not self.inside(twice.position_m):
            return None
        return twice if self.decide(twice.residual_m, self.config.max_range_residual_m) else None

    def supported_fix(self, position_m: Array, gate_m: float, needed: Needed) -> Candidate | None:
        """A position refined with all nodes that support it."""
        chosen = self.supporters(position_m, gate_m)
        indices = [index for index in chosen if index >= 0]
        own = int(np.sum(~self.used[indices]))
        if len(indices) < needed.support or own < needed.own:
            return None
        fix = refine(self.ellipse, self.ellipses(indices), position_m, robust=True)
        if fix is None:
            return None
        self.margin = min(self.margin, fix.margin)
        weight = float(np.sum(self.frame.weight[indices]))
        return Candidate(fix.position_m, chosen, fix.range_residual_m, weight, own)

    def candidates(self, tuples: list[Chosen]) -> list[Candidate]:
        """The supported fixes of all tuples that no earlier candidate explains already."""
        found: list[Candidate] = []
        for indices in tuples:
            if len(found) == self.limits.max_candidates:
                break
            if any(set(indices) <= set(other.chosen) for other in found):
                continue
            begin = start(self.ellipses(list(indices)), self.ellipse.body_radius_m, self.site.area_m)
            if begin is None:
                continue
            self.margin = min(self.margin, begin.margin)
            coarse = range_residual_m(
                begin.position_m, self.ellipses(list(indices)), self.ellipse.body_radius_m
            )
            if not self.decide(coarse, self.config.coarse_residual_m):
                continue
            fix = refine(self.ellipse, self.ellipses(list(indices)), begin.position_m, robust=False)
            if fix is None or not fix.converged:
                continue
            self.margin = min(self.margin, fix.margin)
            if not self.decide(fix.range_residual_m, self.config.max_range_residual_m):
                continue
            candidate = self.candidate(fix.position_m, self.config.support_gate_m, self.needed)
            if candidate is not None:
                found.append(candidate)
        return found

    def best(self, candidates: list[Candidate]) -> Candidate:
        """Most supporters, then the least residual."""
        most = max((c.own, c.support) for c in candidates)
        rivals = sorted((c for c in candidates if (c.own, c.support) == most), key=lambda c: c.residual_m)
        for rival in rivals[1:]:
            if rival.chosen != rivals[0].chosen:
                self.margin = min(self.margin, (rival.residual_m - rivals[0].residual_m) / rival.residual_m)
                break
        return rivals[0]

    def take(self, candidates: list[Candidate], needed: Needed) -> list[Candidate]:
        """The best candidate explains its detections; those that lose support by it are looked at again."""
        taken = []
        remaining = list(candidates)
        while remaining:
            winner = self.best(remaining)
            taken.append(winner)
            self.mark_used(winner)
            kept = []
            for candidate in remaining:
                if any(index >= 0 and self.used[index] for index in candidate.chosen):
                    again = self.candidate(candidate.position_m, self.config.support_gate_m, needed)
                    if again is None:
                        continue
                    candidate = again
                kept.append(candidate)
            remaining = kept
        return taken

    def mark_used(self, winner: Candidate) -> None:
        """The detections that it rests on, and those in the tail of its echoes."""
        self.used[[index for index in winner.chosen if index >= 0]] = True
        if self.config.echo_tail_m == 0:
            return
        for index, (node, path) in enumerate(zip(self.frame.node_index, self.frame.path_m, strict=True)):
            tx, rx = self.site.tx_m[node], self.site.rx_m[node]
            behind = float(path - path_m(winner.position_m, tx, rx, self.ellipse.body_radius_m))
            if self.decide(-behind, self.config.support_gate_m) and self.decide(
                behind, self.config.echo_tail_m
            ):
                self.used[index] = True

    def aided(self, predictions_m: Array) -> list[Candidate]:
        """People already tracked choose first, with a lower need of support."""
        found = []
        needed = Needed(self.config.track_min_support, self.config.track_min_own_support)
        for prediction in predictions_m:
            candidate = self.candidate(prediction, self.config.track_gate_m, needed)
            if candidate is None:
                continue
            moved = float(np.linalg.norm(candidate.position_m - prediction))
            if self.decide(moved, self.config.track_gate_m):
                found.append(candidate)
        return self.take(found, needed)


def elementary_symmetric(counts: list[int], order: int) -> int:
    """Number of tuples: the sum over all choices of `order` nodes of the product of their counts."""
    sums = [1] + [0] * order
    for count in counts:
        for k in range(order, 0, -1):
            sums[k] = min(MANY_TUPLES, sums[k] + sums[k - 1] * count)
    return sums[order]


def choose_tuples(
    frame: Frame, used: NDArray[np.bool_], order: int, max_tuples: int
) -> tuple[list[Chosen], int, int]:
    """Tuples to solve, the number of detections that are in none for lack of room, and of tuples left out.

    When there are too many: the heaviest `depth` detections of each node, the greatest depth for which an
    eighth of the tuples fits; then every `stride`-th choice of nodes, then the first `max_tuples`.
    """
    nodes = [int(node) for node in np.unique(frame.node_index)]
    lists = {n: [int(i) for i in np.flatnonzero((frame.node_index == n) & ~used)] for n in nodes}
    lists = {n: indices for n, indices in lists.items() if indices}
    counts = [len(indices) for indices in lists.values()]
    total = elementary_symmetric(counts, order)
    depth = max(counts, default=0)
    while (
        depth > 1 and elementary_symmetric([min(c, depth) for c in counts], order) > DEPTH_SLACK * max_tuples
    ):
        depth -= 1
    dropped_detections = sum(max(0, c - depth) for c in counts)
    for node, indices in lists.items():
        heaviest = sorted(indices, key=lambda i: (-frame.weight[i], i))[:depth]
        lists[node] = sorted(heaviest)
    fitting = elementary_symmetric([len(indices) for indices in lists.values()], order)
    stride = -(-fitting // max_tuples) if fitting > 0 else 1
    tuples = [
        chosen
        for choice in list(combinations(lists, order))[::stride]
        for chosen in product(*(lists[node] for node in choice))
    ][:max_tuples]
    return tuples, dropped_detections, total - len(tuples)


def measurement_selection(
    config: SelectionConfig,
    ellipse: EllipseConfig,
    site: Site,
    limits: Limits,
    frame: Frame,
    predictions_m: Array | None = None,
) -> Measurements:
    """Measurements of one frame; `predictions_m` (p, 2) are the confirmed tracks' predicted positions."""
    selector = Selector(config, ellipse, site, limits, frame)
    taken: list[Candidate] = []
    if config.method == "consensus":
        if config.track_aided and predictions_m is not None:
            taken = selector.aided(predictions_m)
        tuples, cut, left_out = choose_tuples(frame, selector.used, config.nodes_per_tuple, limits.max_tuples)
        taken += selector.take(selector.candidates(tuples), selector.needed)
    else:
        tuples, cut, left_out = choose_tuples(frame, selector.used, config.nodes_per_tuple, limits.max_tuples)
        taken = selector.all_tuples(tuples)
    kept = taken[: limits.max_measurements]
    return Measurements(
        np.array([c.position_m for c in kept]).reshape(-1, 2),
        np.array([c.weight for c in kept]),
        np.array([c.residual_m for c in kept]),
        np.array([c.support for c in kept], dtype=np.intp),
        cut,
        left_out,
        len(taken) - len(kept),
        float(selector.margin),
    )
