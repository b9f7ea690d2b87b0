"""The core's hub behind a cross against the reference: the same reports, every tap of every frame."""

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.choices import configure
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.reference.hub.measure.frame_assembler import Report
from echofuse.reference.hub.path_hub import PathHubFrame
from echofuse.reference.hub.through_wall_3d import ThroughWall3dHub
from echofuse.reference.hub.track.path_tracker import paths_and_gradients

PERIOD_US, FRAMES = 74_000, 60
TX_M, ARM_M = np.array([0.3, -0.1, 1.2]), 0.39
ARMS_M = ARM_M * np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
LEAST_M, MOST_M = np.array([-2.3, 0.4, -0.5]), np.array([2.9, 7.0, 3.5])
IDS = [11, 12, 13, 14]
MARGIN_SHARE = 0.05  # see conformance.through_wall_hub_taps
AXES = ("xx", "xy", "xz", "yy", "yz", "zz")

CHOICES = {
    "default": {},
    "paper": {"track_aided": False},
    "all pairs": {"trace_pairing.rule": "all_pairs"},
    "paper, all pairs": {"track_aided": False, "trace_pairing.rule": "all_pairs"},
    "3D-2D alone": {"taylor_3d.max_iterations": 0},
    "A-3D-2D alone": {
        "taylor_3d.max_iterations": 0,
        "taylor_3d.start": "approximate",
        "track_aided": False,
    },
    "A-3D-2D, then TSM": {"taylor_3d.start": "approximate", "range_difference_m": 0.1},
    "upright bodies": {"path_tracker.body_half_height_m": 0.8, "path_tracker.path_std_growth": 0.1},
    "second kind": {"taylor_3d.wall.compensation": "second_kind"},
}


def a_config(settings=None):  # type: ignore[no-untyped-def]
    config = _core.ThroughWall3dHubConfig()
    tx = np.tile(TX_M, (4, 1)).astype(np.float32)
    config.set_nodes(IDS, tx, (TX_M + ARMS_M).astype(np.float32))
    config.set_area(*map(float, LEAST_M), *map(float, MOST_M))
    configure(config, settings or {})
    assert config.invalid_field() is None
    return config


def instants(rng, config, people):  # type: ignore[no-untyped-def]
    """Reports of people who walk and climb, of false traces, some lost."""
    wall = as_reference(config).taylor_3d.wall
    low, high = LEAST_M - TX_M + [0.3, 1.2, 0.8], MOST_M - TX_M - 0.4
    position = rng.uniform(low, high, (people, 3))
    velocity = rng.uniform(-1.0, 1.0, (people, 3)) * [1.0, 1.0, 0.3]
    for frame in range(FRAMES):
        velocity = np.where((position < low) | (position > high), -velocity, velocity)
        position = position + PERIOD_US * 1e-6 * velocity
        paths = [[] for _ in IDS]
        for person in position:
            path_m, _ = paths_and_gradients(wall, person, ARMS_M)
            path_m = path_m + rng.normal(0.0, 0.08) + rng.normal(0.0, 0.04, 4) - 2.0 * config.body_radius_m
            for r in np.flatnonzero(rng.random(4) < 0.9):
                paths[r].append(path_m[r])
        for r, of_receiver in enumerate(paths):
            of_receiver.extend(rng.uniform(0.5, 13.0, rng.poisson(0.5)))
            if rng.random() < 0.97:
                delay_s = (np.sort(of_receiver) / SPEED_OF_LIGHT_MPS).astype(np.float32)
                weight = rng.integers(4, 9, len(delay_s)).astype(np.float32)
                yield frame, IDS[r], delay_s, weight


def compare(board, where, answer, taps, frame: PathHubFrame):  # type: ignore[no-untyped-def]
    """Whether the next frame may be compared as well."""
    expected = frame.taps
    margin = {tap: MARGIN_SHARE * value for tap, value in frame.margins.items()}
    tracks = answer[2]
    covariances = np.array([t.filter.position_covariance[np.triu_indices(3)] for t in frame.tracks])
    decided = [0, 1, 8]
    return (
        board.decisions("", "frame", where, answer[:2], (frame.time_us, frame.number), np.inf)
        and board.decisions(
            "", "frame", where, taps["frame"][:, [0, 2]], expected["frame"][:, [0, 2]], np.inf
        )
        and board.floats("", "frame", where, taps["frame"][:, 1], expected["frame"][:, 1], "hub.frame.path")
        and board.decisions(
            "", "associated", where, taps["associated"], expected["associated"], margin["associated"]
        )
        and board.decisions(
            "", "points", where, taps["points"][:, 3:], expected["points"][:, 3:], margin["points"]
        )
        and board.floats(
            "", "points", where, taps["points"][:, :3], expected["points"][:, :3], "through_wall.point"
        )
        and board.decisions(
            "", "tracks", where, taps["tracks"][:, decided], expected["tracks"][:, decided], margin["tracks"]
        )
        and board.floats(
            "", "tracks", where, taps["tracks"][:, 2:8], expected["tracks"][:, 2:8], "through_wall.track"
        )
        and board.floats(
            "",
            "covariances",
            where,
            np.column_stack([tracks[f"covariance_{axes}_m2"] for axes in AXES]),
            covariances.reshape(-1, 6),
            "through_wall.covariance",
        )
    )


@pytest.mark.parametrize("choice", CHOICES)
def test_every_tap(choice):  # type: ignore[no-untyped-def]
    config = a_config(CHOICES[choice])
    board, compared, confirmed, quads = Scoreboard(), 0, 0, 0
    for seed in range(6):
        rng = np.random.default_rng([seed, 403])
        hub = _core.ThroughWall3dHub()
        assert hub.configure(config) == _core.Status.ok
        limits = _core.LIMITS
        reference = ThroughWall3dHub(
            as_reference(config), limits["max_points_per_frame"], limits["max_tracks"]
        )
        reports = list(instants(rng, config, 1 + seed % 3))
        for frame in range(FRAMES):
            now_us = 1_000_000 + frame * PERIOD_US
            for at, node_id, delay_s, weight in reports:
                if at != frame:
                    continue
                assert hub.receive(node_id, frame, delay_s, weight, now_us) == _core.Status.ok
                wide = delay_s.astype(np.float64), weight.astype(np.float64)
                assert reference.receive(Report(node_id, frame, *wide), now_us)
            same = True
            for us in (now_us, now_us + PERIOD_US - 1000):
                (status, answer, taps), expected = hub.poll_with_taps(us), reference.poll(us)
                assert status == _core.Status.ok
                where = f"seed {seed}, frame {frame}"
                assert (answer is None) == (expected is None), where
                if answer is None or expected is None or not same:
                    continue
                same = compare(board, where, answer, taps, expected)
                compared += same
                confirmed += int(np.sum(answer[2]["state"] == 1))
            if not same:
                break
        else:
            counted = hub.counters()
            quads += counted["quads"]
            assert (counted["quads"], counted["clipped"]) == (reference.quads, reference.clipped)
            assert counted["accepted"] == len(reports)
    for row in board.rows():
        assert row.passed, row.failures[:3]
        assert row.excused < 4
    assert compared > 0.8 * 6 * FRAMES
    assert confirmed > compared / 3
    assert quads > 9


def test_impossible_configurations_are_named():  # type: ignore[no-untyped-def]
    tx = np.tile(TX_M, (4, 1)).astype(np.float32)
    config = a_config()
    config.set_nodes(IDS[:3], tx[:3], tx[:3])
    assert config.invalid_field() == "n_nodes"
    config = a_config()
    bent = (TX_M + ARMS_M + [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.05, 0.0]]).astype(
        np.float32
    )
    config.set_nodes(IDS, tx, bent)
    assert config.invalid_field() == "nodes"
    config = a_config()
    config.set_area(-2.0, -1.0, 0.0, 2.0, 6.0, 3.0)
    assert config.invalid_field() == "area"
    assert _core.ThroughWall3dHub().configure(config) == _core.Status.invalid_config
    with pytest.raises(ValueError, match="at most 4"):
        config.set_nodes([*IDS, 15], np.tile(tx[:1], (5, 1)), np.tile(tx[:1], (5, 1)))
