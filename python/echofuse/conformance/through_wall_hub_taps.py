"""Compares every tap of a through-wall hub, in the plane or in space, with the reference's, frame by frame.

Target and reference each keep their own tracks, so after a decision that was a coin toss the rest of an input
is not compared.
"""

from collections.abc import Sequence
from contextlib import closing

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.choices import Choice
from echofuse.conformance.comparison import Scoreboard, as_reference, to_float64
from echofuse.conformance.hub_reference import covariances, reference_report
from echofuse.conformance.target import ConformanceTarget, HubAnswer, HubTarget
from echofuse.conformance.through_wall_hub_inputs import PathHubConfig, ThroughWallHubInput
from echofuse.reference.hub.path_hub import PathHub, PathHubFrame
from echofuse.reference.hub.through_wall import ThroughWallHub
from echofuse.reference.hub.through_wall_3d import ThroughWall3dHub

THROUGH_WALL_HUB_TAPS = ("frame", "associated", "points", "tracks")
AXES = {2: ("xx", "xy", "yy"), 3: ("xx", "xy", "xz", "yy", "yz", "zz")}
DEADLINE_US = 73_000  # after an instant: its frame is overdue, and the next instant not yet there

#: Of a margin, what is compared with the coin toss's: tracks differ by 1e-4 m after seconds in float32.
MARGIN_SHARE = 0.05


def conform_through_wall_hub(
    board: Scoreboard, choice: Choice, target: ConformanceTarget, inputs: Sequence[ThroughWallHubInput]
) -> None:
    """Feed the same reports to target and reference under one choice."""
    for tap in THROUGH_WALL_HUB_TAPS:
        board.row(choice.name, tap)
    for heard in inputs:
        config = heard.config(choice)
        opened, reference = _hubs(target, config)
        with closing(opened) as hub:
            for index, instant in enumerate(heard.instants):
                for report in instant.reports:
                    hub.receive(report, instant.time_us)
                    reference.receive(reference_report(report), instant.time_us)
                for now_us in (instant.time_us, instant.time_us + DEADLINE_US):
                    answer, frame = hub.poll(now_us), reference.poll(now_us)
                    compared = _Frame(
                        board, choice.name, f"{heard.where}, frame {index} of it", _tolerances(config)
                    )
                    if not compared.compare(answer, frame):
                        break
                else:
                    continue
                break


def _hubs(target: ConformanceTarget, config: PathHubConfig) -> tuple[HubTarget, PathHub]:
    """Return the target's hub of a configuration, and the reference's."""
    capacities = _core.LIMITS["max_points_per_frame"], _core.LIMITS["max_tracks"]
    if isinstance(config, _core.ThroughWall3dHubConfig):
        return target.through_wall_3d_hub(config), ThroughWall3dHub(as_reference(config), *capacities)
    return target.through_wall_hub(config), ThroughWallHub(as_reference(config), *capacities)


def _tolerances(config: PathHubConfig) -> tuple[str, str, str]:
    """Return the rows for points, tracks, covariances: in space tracks of points, or of upright bodies."""
    in_plane = "through_wall.point", "through_wall.track", "through_wall.covariance"
    if not isinstance(config, _core.ThroughWall3dHubConfig):
        return in_plane
    points = "through_wall.point_in_space"
    if not config.track_aided:
        return points, "through_wall.track_of_points", in_plane[2]
    if config.path_tracker.body_half_height_m > 0.0:
        return points, "hub.track.tall", "hub.track.tall_covariance"
    return points, *in_plane[1:]


class _Frame:
    """One frame's taps."""

    def __init__(self, board: Scoreboard, choice: str, where: str, tolerances: tuple[str, str, str]) -> None:
        self.board, self.choice, self.where = board, choice, where
        self.of_points, self.of_tracks, self.of_covariances = tolerances

    def compare(self, answer: HubAnswer | None, frame: PathHubFrame | None) -> bool:
        """Whether the next frame may be compared as well."""
        if answer is None and frame is None:
            return True
        if answer is None or frame is None:
            self.board.row(self.choice, "frame").failures.append(f"{self.where}: closed by one side only")
            return False
        if not self.board.shows(self.choice, self.where, THROUGH_WALL_HUB_TAPS, answer.taps):
            return False
        got, expected = {tap: to_float64(answer.taps[tap]) for tap in THROUGH_WALL_HUB_TAPS}, frame.taps
        margin = {tap: MARGIN_SHARE * value for tap, value in frame.margins.items()}
        d = expected["points"].shape[1] - 2  # the dimension
        decided = [0, 1, 2 + 2 * d]
        stamp = np.array([frame.time_us, frame.number])
        return (
            self._decisions("frame", np.array([answer.time_us, answer.frame]), stamp)
            and self._decisions("frame", got["frame"][:, [0, 2]], expected["frame"][:, [0, 2]])
            and self._floats("frame", "hub.frame.path", got["frame"][:, 1], expected["frame"][:, 1])
            and self._decisions("associated", got["associated"], expected["associated"], margin["associated"])
            and self._decisions("points", got["points"][:, d:], expected["points"][:, d:], margin["points"])
            and self._floats("points", self.of_points, got["points"][:, :d], expected["points"][:, :d])
            and self._decisions(
                "tracks", got["tracks"][:, decided], expected["tracks"][:, decided], margin["tracks"]
            )
            and self._floats("tracks", self.of_tracks, got["tracks"][:, 2:-1], expected["tracks"][:, 2:-1])
            and self._floats(
                "tracks",
                self.of_covariances,
                np.column_stack([answer.tracks[f"covariance_{axes}_m2"] for axes in AXES[d]]),
                covariances(frame.tracks, d),
            )
        )

    def _decisions(
        self, tap: str, got: NDArray[np.float64], expected: NDArray[np.float64], margin: float = np.inf
    ) -> bool:
        return self.board.decisions(self.choice, tap, self.where, got, expected, margin)

    def _floats(
        self, tap: str, tolerance: str, got: NDArray[np.float64], expected: NDArray[np.float64]
    ) -> bool:
        return self.board.floats(self.choice, tap, self.where, got, expected, tolerance)
