"""Which of the candidates are there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from echofuse.reference.hub.track.people_likelihood import PeopleLikelihood, Trail
from echofuse.reference.hub.track.range_config import RangeTrackerConfig

MAX_NEWCOMERS, MAX_ROUNDS, LEAST_GAIN = 8, 8, 1e-2
RIVAL = 8.0  # a set so much worse may win where a density jumps
SCORE_PER_M = 50.0  # a margin of so much score counts like one of a metre of path


class PeopleSearch:
    """From those that were there, one step after another, whatever raises the score of the set most."""

    def __init__(self, config: RangeTrackerConfig, max_targets: int) -> None:
        self.config, self.max_targets = config, max_targets

    def process(
        self, likelihood: PeopleLikelihood, trails: Sequence[Trail], n_before: int
    ) -> tuple[list[int], float]:
        """Return who is there, and the margin; the first n_before of the trails were."""
        people = list(range(n_before))
        last, last_edge = self._value(likelihood, trails, people, n_before)
        margin = np.inf
        for _ in range(MAX_ROUNDS):
            tried = [
                (*self._value(likelihood, trails, step, n_before), step)
                for step in self._steps(people, len(trails), n_before)
            ]
            values = np.array([value for value, _, _ in tried])
            contest = np.array([last + LEAST_GAIN, *values])
            top = float(np.max(contest))
            edges = np.array([last_edge, *(edge for _, edge, _ in tried)])
            rivals = contest > top - RIVAL
            if np.sum(rivals) > 1:
                gap = np.sort(contest)[-1] - np.sort(contest)[-2]
                margin = min(margin, gap / SCORE_PER_M, float(np.min(edges[rivals])))
            if not len(tried) or not np.max(values) > last + LEAST_GAIN:
                break
            last, last_edge, people = tried[int(np.argmax(values))]
        return people, float(margin)

    def _steps(self, people: list[int], n_candidates: int, n_before: int) -> list[list[int]]:
        """Every set that is one step away: somebody less, somebody else, somebody more."""
        steps = [people[:place] + people[place + 1 :] for place in range(len(people))]
        for who in range(min(n_candidates, n_before + MAX_NEWCOMERS)):
            if who in people:
                continue
            steps += [[*people[:place], who, *people[place + 1 :]] for place in range(len(people))]
            if len(people) < self.max_targets:
                steps.append([*people, who])
        return steps

    def _value(
        self, likelihood: PeopleLikelihood, trails: Sequence[Trail], people: list[int], n_before: int
    ) -> tuple[float, float]:
        """How well the set explains the window, and how likely it is after the last frame's."""
        c = self.config
        score, edge = likelihood.score([trails[who] for who in people])
        score += c.lasting_score * min(len(people), n_before) - c.newcomer_cost * len(people)
        return score + c.identity_score * sum(who < n_before for who in people), edge
