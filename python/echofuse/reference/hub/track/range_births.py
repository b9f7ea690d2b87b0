"""Where tracks may begin: maxima of a lone person's score, on a grid over the area."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.hub.locate.site import Site
from echofuse.reference.hub.track.people_likelihood import PeopleLikelihood
from echofuse.reference.hub.track.range_config import RangeTrackerConfig

Array = NDArray[np.float64]

MAX_CELLS = 2048
MAX_PLACES = 24
GRID_VARIANCE = 0.3
GATE_STDS = 4.0
NEIGHBOURS = 2
EDGE = 5.0  # a score changes by less when one node more, or less, can see the place


class Places(NamedTuple):
    """Best first."""

    at_m: list[Array]
    margin: float  # [1]


def lone_score(config: RangeTrackerConfig, error_m: float, std_m: float) -> float:
    """Log-likelihood ratio of a detection with a person by herself there, or else of her being missed."""
    p = config.candidate_detection_probability
    density = np.exp(-0.5 * (error_m / std_m) ** 2) / (np.sqrt(2.0 * np.pi) * std_m)
    hit = p * density / config.candidate_clutter_per_m
    return max(float(np.log(max(hit, 1e-300))), missed_score(config))


def missed_score(config: RangeTrackerConfig) -> float:
    """Log-likelihood ratio of a node without a detection there."""
    return float(np.log(1.0 - config.candidate_detection_probability))


class RangeBirths:
    def __init__(self, config: RangeTrackerConfig, site: Site) -> None:
        self.config = config
        width, height = site.area_m[2:] - site.area_m[:2]
        self.step_m = max(config.birth_step_m, max(width, height) / (MAX_CELLS // 4))
        while self._cells(width) * self._cells(height) > MAX_CELLS:
            self.step_m *= 1.1
        columns = site.area_m[0] + (np.arange(self._cells(width)) + 0.5) * self.step_m
        rows = site.area_m[1] + (np.arange(self._cells(height)) + 0.5) * self.step_m
        self.grid_m = np.stack(np.meshgrid(columns, rows, indexing="ij"), axis=-1)
        self.std_m = float(np.sqrt(config.path_std_m**2 + GRID_VARIANCE * self.step_m**2))

    def process(self, likelihood: PeopleLikelihood) -> Places:
        """Places above the birth score in the newest frame."""
        cells = np.array([[self._cell_score(likelihood, z) for z in column] for column in self.grid_m])
        scores, edges = cells[..., 0], cells[..., 1]
        high = scores > self.config.birth_score - EDGE
        margin = float(np.min(edges, initial=np.inf, where=high))
        maxima: list[tuple[float, int, int]] = []
        for i, j in np.ndindex(*scores.shape):
            margin = min(margin, float(abs(scores[i, j] - self.config.birth_score)))
            if scores[i, j] < self.config.birth_score:
                continue
            is_maximum, gap = self._is_maximum(scores, i, j)
            margin = min(margin, gap)
            if is_maximum:
                maxima.append((float(scores[i, j]), i, j))
        maxima.sort(key=lambda cell: -cell[0])
        heights = np.array([score for score, _, _ in maxima])
        margin = min(margin, float(np.min(np.abs(np.diff(heights)), initial=np.inf)))
        return Places([self.grid_m[i, j] for _, i, j in maxima[:MAX_PLACES]], float(margin))

    def _cells(self, length_m: float) -> int:
        return max(1, int(np.float32(length_m) / np.float32(self.step_m)))

    def _cell_score(self, likelihood: PeopleLikelihood, place_m: Array) -> tuple[float, float]:
        """Score of a person at a place, and how near a node is to seeing it or not [m]."""
        score = 0.0
        paths, edge = likelihood.visible_paths(place_m)
        for path, detections in zip(paths, likelihood.frames[0], strict=True):
            if np.isnan(path):
                continue
            least = float(np.min(np.abs(detections - path), initial=np.inf))
            if least < GATE_STDS * self.std_m:
                score += lone_score(self.config, least, self.std_m)
            else:
                score += missed_score(self.config)
        return score, edge

    @staticmethod
    def _is_maximum(scores: Array, i: int, j: int) -> tuple[bool, float]:
        """Whether it is the best within two cells, of equal ones the first, and how clearly."""
        gap = np.inf
        for a in range(max(0, i - NEIGHBOURS), min(scores.shape[0], i + NEIGHBOURS + 1)):
            for b in range(max(0, j - NEIGHBOURS), min(scores.shape[1], j + NEIGHBOURS + 1)):
                if scores[a, b] > scores[i, j] or (scores[a, b] == scores[i, j] and (a, b) < (i, j)):
                    return False, abs(scores[i, j] - scores[a, b])
                if (a, b) != (i, j):
                    gap = min(gap, abs(scores[i, j] - scores[a, b]))
        return True, float(gap)
