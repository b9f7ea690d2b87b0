"""What holds for the hub of a line of receivers, whatever its receivers report."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.comparison import as_reference
from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.reference.hub.locate.line_locator import path_and_gradient

PERIOD_S = 0.074
CONFIRMED = 1


def a_tracker(n_receivers: int = 2, **settings: float) -> tuple["_core.PathTracker", NDArray[np.float64]]:
    rx_x_m = np.linspace(-0.4, 0.4, n_receivers) if n_receivers != 3 else np.array([-0.4, 0.2, 0.4])
    tracker = _core.PathTracker()
    rx_m = np.column_stack([rx_x_m, np.zeros(n_receivers)]).astype(np.float32)
    least_m, most_m = np.array([-2.1, 0.7], np.float32), np.array([2.1, 5.9], np.float32)
    config = _core.PathTrackerConfig(**settings)
    status = tracker.configure(config, _core.WallConfig(), rx_m, least_m, most_m)
    assert status == _core.Status.ok
    return tracker, rx_x_m


def paths_to(x_m: float, y_m: float, rx_x_m: NDArray[np.float64]) -> list[NDArray[np.float32]]:
    paths, _ = path_and_gradient(as_reference(_core.WallConfig()), np.array([x_m, y_m]), rx_x_m)
    return [np.array([path], np.float32) for path in paths]


def fix_of(
    paths: Sequence[NDArray[np.float32]], rx_x_m: NDArray[np.float64]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Position (2,) and its covariance (2, 2)."""
    locator = _core.LineLocator()
    locator.configure(_core.LineLocatorConfig(), rx_x_m.astype(np.float32))
    status, fix = locator.process(np.concatenate(paths), np.ones(len(rx_x_m), np.float32))
    assert (status, fix.status) == (_core.Status.ok, _core.LineFixStatus.fix)
    xx, xy, yy = fix.covariance_m2
    return np.array(fix.position_m, np.float32), np.array([[xx, xy], [xy, yy]], np.float32)


@pytest.mark.parametrize("n_receivers", [2, 3, 4])
@given(x_m=st.floats(-1.5, 1.5), y_m=st.floats(1.5, 5.0), vx=st.floats(-0.5, 0.5), vy=st.floats(-1.0, 1.0))
@settings(deadline=None, max_examples=25)
def test_one_person_is_one_track_where_she_is(
    n_receivers: int, x_m: float, y_m: float, vx: float, vy: float
) -> None:
    tracker, rx_x_m = a_tracker(n_receivers)
    for step in range(12):
        x, y = x_m + step * PERIOD_S * vx, y_m + step * PERIOD_S * vy
        paths = paths_to(x, y, rx_x_m)
        status, owners = tracker.update(paths, PERIOD_S)
        assert status == _core.Status.ok
        if step == 0:
            assert not owners.any()
            assert tracker.begin(*fix_of(paths, rx_x_m)) == _core.Status.ok
        else:
            assert list(owners) == [1] * n_receivers
    (track,) = tracker.tracks()
    assert (track["id"], track["state"], track["frames_since_update"]) == (1, CONFIRMED, 0)
    assert np.hypot(track["x_m"] - x, track["y_m"] - y) < 0.25
    xx, xy, yy = (float(track[f"covariance_{axes}_m2"]) for axes in ("xx", "xy", "yy"))
    assert xx > 0.0
    assert xx * yy > xy**2


def test_people_at_the_same_range_keep_their_traces() -> None:
    """The weakness that the paper names: both receivers hear first the person who is on their side."""
    tracker, rx_x_m = a_tracker()
    for step in range(40):
        y_m = 2.0 + 0.05 * step
        both = [paths_to(x_m, y_m, rx_x_m) for x_m in (-0.9, 0.9)]
        paths = [np.sort(np.concatenate(of_receiver)) for of_receiver in zip(*both, strict=True)]
        status, owners = tracker.update(paths, PERIOD_S)
        assert status == _core.Status.ok
        if step == 0:
            for person in both:
                tracker.begin(*fix_of(person, rx_x_m))
            continue
        assert list(owners) == [1, 2, 2, 1]
    assert sorted(np.round(tracker.tracks()["x_m"], 1)) == pytest.approx([-0.9, 0.9], abs=0.11)


def test_a_receiver_that_falls_silent_ends_the_tracks_and_begins_none() -> None:
    tracker, rx_x_m = a_tracker()
    paths = paths_to(0.3, 3.0, rx_x_m)
    tracker.update(paths, PERIOD_S)
    tracker.begin(*fix_of(paths, rx_x_m))
    for _ in range(10):
        tracker.update(paths, PERIOD_S)
    assert len(tracker.tracks()) == 1
    nothing = np.zeros(0, np.float32)
    alone = [len(tracker.tracks()) for _ in range(40) if tracker.update([paths[0], nothing], PERIOD_S)]
    assert alone[8] == 1
    assert alone[-1] == 0


def test_tracks_stay_in_the_room() -> None:
    tracker, rx_x_m = a_tracker()
    for step in range(12):
        paths = paths_to(0.0, 5.0 + 0.07 * step, rx_x_m)
        tracker.update(paths, PERIOD_S)
        if step == 0:
            tracker.begin(*fix_of(paths, rx_x_m))
    nothing = [np.zeros(0, np.float32)] * 2
    for _ in range(10):
        tracker.update(nothing, PERIOD_S)
    (track,) = tracker.tracks()
    assert track["y_m"] <= 5.9


def test_births_beyond_the_last_track_are_counted() -> None:
    tracker, rx_x_m = a_tracker(max_tracks=2)
    fixes = [fix_of(paths_to(x_m, 3.0, rx_x_m), rx_x_m) for x_m in (-1.5, 0.0, 1.5)]
    assert [tracker.begin(*fix) for fix in fixes] == [
        _core.Status.ok,
        _core.Status.ok,
        _core.Status.truncated,
    ]
    assert tracker.dropped_births() == 1
    assert tracker.begin(*fixes[0]) == _core.Status.ok  # near a track: nothing to begin
    assert len(tracker.tracks()) == 2


@pytest.mark.parametrize("paths", [[[np.nan], [4.0]], [[4.0], [4.0], [4.0]], [[4.0] * 17, [4.0]]])
def test_bad_paths_change_nothing(paths: list[list[float]]) -> None:
    tracker, _ = a_tracker()
    status, _ = tracker.update([np.array(of_receiver, np.float32) for of_receiver in paths], PERIOD_S)
    assert status == _core.Status.invalid_input


@given(seed=st.integers(0, 10_000), n_receivers=st.integers(2, 8))
@settings(deadline=None, max_examples=40)
def test_whatever_is_reported_positions_are_finite_and_in_the_room(seed: int, n_receivers: int) -> None:
    rng = np.random.default_rng(seed)
    config = _core.ThroughWallHubConfig()
    rx_m = np.column_stack([np.linspace(-0.9, 1.0, n_receivers), np.zeros(n_receivers)]).astype(np.float32)
    config.set_nodes(list(range(n_receivers)), np.zeros_like(rx_m), rx_m)
    config.set_area(-2.35, 0.48, 2.35, 6.1)
    hub = _core.ThroughWallHub()
    assert hub.configure(config) == _core.Status.ok
    frames = 0
    for frame in range(30):
        for node in range(n_receivers):
            n = int(rng.integers(0, 17))
            delay_s = np.sort(rng.uniform(0.5, 14.0, n) / SPEED_OF_LIGHT_MPS).astype(np.float32)
            hub.receive(node, frame, delay_s, np.ones(n, np.float32), frame * 74_000)
        status, closed, taps = hub.poll_with_taps(frame * 74_000)
        assert status in (_core.Status.ok, _core.Status.truncated)
        if closed is None:
            continue
        frames += 1
        tracks = closed[2]
        for name in ("x_m", "y_m", "vx_mps", "vy_mps", "covariance_xx_m2", "covariance_yy_m2"):
            assert np.all(np.isfinite(tracks[name]))
        assert np.all((taps["points"][:, 0] >= -2.35) & (taps["points"][:, 0] <= 2.35))
        assert len(taps["associated"]) == len(taps["frame"])
    counted = hub.counters()
    assert counted["frames"] == frames == 30
    assert counted["accepted"] == 30 * n_receivers


def test_a_hub_says_what_is_impossible() -> None:
    def config(ids: list[int], rx_m: list[list[float]], tx_m: list[list[float]] | None = None) -> str | None:
        made = _core.ThroughWallHubConfig()
        tx = np.zeros((len(ids), 2)) if tx_m is None else np.array(tx_m)
        made.set_nodes(ids, tx.astype(np.float32), np.array(rx_m, np.float32).reshape(-1, 2))
        made.set_area(-2.0, 0.5, 2.0, 6.0)
        return made.invalid_field()

    pair = [[-0.4, 0.0], [0.4, 0.0]]
    assert config([1, 2], pair) is None
    assert config([1], pair[:1]) == "n_nodes"
    assert config([1, 1], pair) == "nodes"
    assert config([1, 2], [[-0.4, 0.0], [0.4, 0.2]]) == "nodes"  # not on the line
    assert config([1, 2], [[-0.4, 0.0], [-0.4, 0.0]]) == "nodes"
    assert config([1, 2], pair, [[0.0, 0.0], [0.1, 0.0]]) == "nodes"  # two transmitters
    behind = _core.ThroughWallHubConfig()
    behind.set_nodes([1, 2], np.zeros((2, 2), np.float32), np.array(pair, np.float32))
    behind.set_area(-2.0, -6.0, 2.0, -0.5)
    assert behind.invalid_field() == "area"
    behind.set_area(-0.2, 0.5, 0.2, 6.0)
    assert behind.invalid_field() == "body_radius_m"  # nobody fits in
