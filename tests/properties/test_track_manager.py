"""Laws of the track manager."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from echofuse import _core

UNCONFIRMED, CONFIRMED, SILENT = (
    int(state)
    for state in (_core.TrackState.unconfirmed, _core.TrackState.confirmed, _core.TrackState.silent)
)


def manager(**settings_: Any) -> _core.TrackManager:
    made = _core.TrackManager()
    assert made.configure(_core.TrackManagerConfig(**settings_)) == _core.Status.ok
    return made


def points(positions: Any, velocity: tuple[float, float] = (0.0, 0.0)) -> NDArray[np.float32]:
    rows = np.zeros((len(positions), 7), np.float32)
    rows[:, :2] = np.reshape(positions, (-1, 2))
    rows[:, 2:4] = velocity
    rows[:, [4, 6]] = 0.01
    return rows


@given(
    seed=st.integers(0, 2**32 - 1),
    n_max=st.integers(0, 40),
    update=st.sampled_from([_core.TrackUpdate.estimate, _core.TrackUpdate.kalman]),
)
@settings(max_examples=50)
def test_any_input_keeps_the_laws(seed: int, n_max: int, update: _core.TrackUpdate) -> None:
    """Ids are never used again, no unconfirmed track outlives a miss, capacities hold, cuts are counted."""
    rng = np.random.default_rng(seed)
    made = manager(update=update)
    before: dict[int, int] = {}
    seen: set[int] = set()
    for _ in range(30):
        dropped = made.dropped_births
        status, tracks = made.process(points(rng.uniform(0.0, 6.0, (rng.integers(n_max + 1), 2))), 0.1)
        ids = tracks["id"].tolist()
        assert ids == sorted(set(ids))
        assert len(ids) <= _core.LIMITS["max_tracks"]
        assert all(i in before or i not in seen for i in ids)
        assert (status == _core.Status.truncated) >= (made.dropped_births > dropped)
        for track in tracks:
            missed = track["frames_since_update"] > 0
            assert (track["state"] == SILENT) == missed
            if before.get(int(track["id"])) in (CONFIRMED, SILENT):
                assert track["state"] != UNCONFIRMED
        seen.update(ids)
        before = dict(zip(ids, tracks["state"].tolist(), strict=True))


def test_life_of_a_track() -> None:
    made = manager(confirm_updates=3, silent_time_min_s=1.0, silent_time_per_confirmed=0.0)
    states = []
    for frame in range(20):
        present = frame < 5 or frame == 8
        _, tracks = made.process(points([[2.0, 3.0]] if present else []), 0.1)
        states.append(int(tracks["state"][0]) if len(tracks) else None)
    assert states[:3] == [UNCONFIRMED, UNCONFIRMED, CONFIRMED]
    assert states[5:9] == [SILENT, SILENT, SILENT, CONFIRMED]
    assert states[9:19] == [SILENT] * 10  # one second
    assert states[19] is None


def test_an_unconfirmed_track_dies_at_its_first_miss() -> None:
    made = manager()
    assert len(made.process(points([[2.0, 3.0]]), 0.1)[1]) == 1
    assert len(made.process(points([]), 0.1)[1]) == 0
    assert made.process(points([[2.0, 3.0]]), 0.1)[1]["id"].tolist() == [2]


@given(dt_s=st.floats(0.03, 0.5), constant_s=st.floats(0.1, 2.0))
@settings(max_examples=20)
def test_a_silent_track_comes_to_rest(dt_s: float, constant_s: float) -> None:
    """It goes on for one frame, then its velocity times the time constant; its covariance stops growing."""
    made = manager(silent_velocity_time_s=constant_s, silent_time_min_s=1e4, silent_time_max_s=1e5)
    for frame in range(5):
        made.process(points([[1.2 * dt_s * frame, 0.0]], (1.2, 0.0)), dt_s)
    start = 1.2 * dt_s * 4
    for _ in range(400):
        _, tracks = made.process(points([]), dt_s)
    assert tracks["state"].tolist() == [SILENT]
    assert tracks["x_m"][0] - start == pytest.approx(1.2 * (constant_s + dt_s), rel=0.02, abs=0.01)
    spread = tracks["covariance_xx_m2"][0]
    assert made.process(points([]), dt_s)[1]["covariance_xx_m2"][0] == pytest.approx(spread, rel=1e-3)
    assert abs(tracks["vx_mps"][0]) < 0.02


def test_silence_that_was_earned() -> None:
    made = manager(silent_time_min_s=0.5, silent_time_per_confirmed=1.0, silent_time_max_s=3.0)
    lives = []
    for confirmed_frames in (5, 22, 100):
        made.reset()
        for _ in range(confirmed_frames):
            made.process(points([[0.0, 0.0]]), 0.1)
        frames = 0
        while len(made.process(points([]), 0.1)[1]):
            frames += 1
        lives.append(frames)
    assert lives == [5, 19, 30]  # the least; confirmed in the third frame; the most


def test_the_gate_of_a_silent_track_grows() -> None:
    made = manager(silent_gate_growth_mps=0.5, silent_gate_max_m=2.0, silent_time_min_s=10.0)
    for away_m, silent_frames, joins in ((1.4, 1, False), (1.4, 15, True), (2.1, 60, False)):
        made.reset()
        for _ in range(5):
            made.process(points([[0.0, 0.0]]), 0.1)
        for _ in range(silent_frames):
            made.process(points([]), 0.1)
        _, tracks = made.process(points([[away_m, 0.0]]), 0.1)
        assert (tracks["id"].tolist() == [1]) == joins


def test_no_track_begins_beside_another() -> None:
    made = manager(birth_exclusion_m=0.5)
    for _ in range(5):
        _, tracks = made.process(points([[0.0, 0.0], [0.4, 0.0]]), 0.1)
    assert tracks["id"].tolist() == [1]
    for _ in range(5):
        _, tracks = made.process(points([[0.0, 0.0], [0.6, 0.0]]), 0.1)
    assert tracks["id"].tolist() == [1, 2]


@pytest.mark.parametrize(("association", "jumps"), [("per_pair", False), ("hypothesis_cost", True)])
def test_why_each_pair_is_judged_by_itself(association: str, jumps: bool) -> None:
    """The paper's sum of costs lets one track cross the room when the others are where they should be."""
    made = manager(association=getattr(_core.AssociationRule, association))
    places = [[float(x), 0.0] for x in range(0, 20, 2)]
    for _ in range(5):
        made.process(points(places), 0.1)
    places[0] = [0.0, 8.0]
    _, tracks = made.process(points(places), 0.1)
    assert (tracks["y_m"][0] > 7.0) == jumps


def test_bad_input_is_refused() -> None:
    made = manager()
    good = points([[0.0, 0.0]])
    assert made.process(good, 0.0)[0] == _core.Status.invalid_input
    bad = good.copy()
    bad[0, 0] = np.nan
    status, tracks = made.process(bad, 0.1)
    assert status == _core.Status.invalid_input
    assert len(tracks) == 0
    assert _core.TrackManager().process(good, 0.1)[0] == _core.Status.not_configured
