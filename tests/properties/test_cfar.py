"""Detectors: design false-alarm rates, the published factors, masking, scale, mirror image, bad input."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from echofuse import _core

METHODS = ("double_threshold_buffer", "cell_averaging", "global_average", "ordered_statistic")


def detector(method: str, **fields: float) -> _core.CfarDetector:
    core = _core.CfarDetector()
    config = _core.CfarConfig(method=getattr(_core.CfarMethod, method), **fields)
    assert core.configure(config) == _core.Status.ok
    return core


def decide(core: _core.CfarDetector, amplitude: NDArray[np.floating]) -> NDArray[np.uint8]:
    status, _, decisions = core.process(amplitude.astype(np.float32))
    assert status == _core.Status.ok
    return np.asarray(decisions)


# algorithms.md 6.4: N -> factors for P_fa 1e-2, 1e-3, 1e-4, 1e-6
AVERAGING = {
    16: (5.34, 8.64, 12.45, 21.94),
    24: (5.08, 8.00, 11.23, 18.68),
    32: (4.95, 7.71, 10.67, 17.28),
    50: (4.82, 7.41, 10.11, 15.91),
}
ORDERED = {
    16: (4.43, 7.42, 11.08, 20.95),
    24: (4.03, 6.50, 9.34, 16.29),
    32: (3.84, 6.09, 8.58, 14.40),
    50: (3.54, 5.50, 7.60, 12.24),
}


@pytest.mark.parametrize(("method", "table"), [("cell_averaging", AVERAGING), ("ordered_statistic", ORDERED)])
def test_factors_are_the_published_ones(method: str, table: dict[int, tuple[float, ...]]) -> None:
    for column, probability in enumerate((1e-2, 1e-3, 1e-4, 1e-6)):
        core = detector(method, false_alarm_probability=probability)
        for n_cells, factors in table.items():
            assert core.factor(n_cells) == pytest.approx(factors[column], abs=0.0051)


@pytest.mark.parametrize("method", ["cell_averaging", "global_average", "ordered_statistic"])
@pytest.mark.parametrize("probability", [1e-3, 1e-2])
def test_false_alarm_rate_in_exponential_noise(method: str, probability: float) -> None:
    """Everywhere, and in the first and last window alone, where fewer cells train."""
    core = detector(
        method, false_alarm_probability=probability, training_cells_per_side=12, guard_cells_per_side=2
    )
    rng = np.random.default_rng(1)
    n_scans, n_samples, edge = 1500, 600, 14
    everywhere = ends = 0
    for _ in range(n_scans):
        decisions = decide(core, np.sqrt(rng.exponential(3.0, n_samples)))
        everywhere += int(decisions.sum())
        ends += int(decisions[:edge].sum() + decisions[-edge:].sum())
    for count, n in ((everywhere, n_scans * n_samples), (ends, n_scans * 2 * edge)):
        # neighbours share training cells, so the count spreads a little more than a binomial one
        assert abs(count / n - probability) < 6.0 * np.sqrt(probability / n)


def echoes(rng: np.random.Generator, places: list[int], n_samples: int = 1920) -> NDArray[np.float64]:
    """(n_samples,) rectified difference of noise envelopes, echoes of 5 to 8 times it with tails."""
    noise = rng.rayleigh(1.0, n_samples) - rng.rayleigh(1.0, n_samples)
    signal = np.zeros(n_samples)
    for place in places:
        x = np.arange(n_samples) - place
        signal += rng.uniform(5.0, 8.0) * np.exp(-0.5 * (x / np.where(x < 0, 6.0, 15.0)) ** 2)
    return np.maximum(0.0, noise + signal)


@pytest.mark.parametrize("places", [[700], [700, 760], [400, 900, 1500]], ids=["single", "close", "triple"])
def test_double_threshold_buffer_detects_and_stays_quiet(places: list[int]) -> None:
    """algorithms.md 6.5: detection 1.00, false alarms outside the echoes at most 1.4e-3 a sample."""
    core, rng = detector("double_threshold_buffer"), np.random.default_rng(2)
    detected = false_alarms = outside = 0
    away = np.min(np.abs(np.arange(1920)[:, None] - np.array(places)), axis=1) > 60
    n_scans = 120
    for _ in range(n_scans):
        decisions = decide(core, echoes(rng, places))
        detected += sum(int(decisions[place - 10 : place + 11].any()) for place in places)
        false_alarms += int(decisions[away].sum())
        outside += int(away.sum())
    assert detected >= 0.97 * n_scans * len(places)
    assert false_alarms <= 1.4e-3 * outside


def test_double_threshold_buffer_in_noise_alone() -> None:
    core, rng = detector("double_threshold_buffer"), np.random.default_rng(3)
    rate = np.mean([decide(core, echoes(rng, [])).mean() for _ in range(120)])
    assert rate == pytest.approx(1e-2, rel=0.15)


def test_cell_averaging_with_factor_eight_alarms_more_than_the_buffer() -> None:
    """A rectified difference is not exponential: at alpha = 8 3 percent are false alarms (6.4)."""
    rng = np.random.default_rng(4)
    probability = (1.0 + 8.0 / 64.0) ** -64  # whose factor for 64 cells is 8
    averaging = detector("cell_averaging", false_alarm_probability=probability)
    assert averaging.factor(64) == pytest.approx(8.0, rel=1e-4)
    buffer = detector("double_threshold_buffer")
    scans = [echoes(rng, []) for _ in range(60)]
    rate = float(np.mean([decide(averaging, scan).mean() for scan in scans]))
    assert rate == pytest.approx(3e-2, rel=0.15)
    assert rate > 2.0 * float(np.mean([decide(buffer, scan).mean() for scan in scans]))


@given(seed=st.integers(0, 10_000), exponent=st.integers(-8, 8), method=st.sampled_from(METHODS))
def test_decisions_do_not_depend_on_the_scale(seed: int, exponent: int, method: str) -> None:
    d = echoes(np.random.default_rng(seed), [100, 300], 400).astype(np.float32)
    core = detector(method)
    assert np.array_equal(decide(core, d), decide(core, d * np.float32(2.0**exponent)))


@given(seed=st.integers(0, 10_000), method=st.sampled_from(METHODS))
def test_mirrored_scans_have_mirrored_decisions(seed: int, method: str) -> None:
    d = echoes(np.random.default_rng(seed), [150], 300).astype(np.float32)
    core = detector(method, false_alarm_probability=1e-2)
    _, threshold, _ = core.process(d)
    _, mirrored, _ = core.process(np.ascontiguousarray(d[::-1]))
    assert mirrored[::-1] == pytest.approx(threshold, rel=1e-5)


@pytest.mark.parametrize("method", METHODS)
def test_a_loud_cell_leaves_nothing_behind(method: str) -> None:
    """1e5 times louder cells pass through the windows: the thresholds behind them are those without them."""
    rng = np.random.default_rng(5)
    quiet = rng.rayleigh(1.0, 900).astype(np.float32)
    loud = quiet.copy()
    loud[400:403] = 1e5
    core = detector(method, global_factor=0.0)
    _, expected, _ = core.process(quiet)
    _, got, _ = core.process(loud)
    far = np.abs(np.arange(900) - 401) > 130  # neither training nor guarded cells are loud there
    if method == "global_average":
        # loud cells are part of the mean, except for themselves and their guarded neighbours
        far = np.abs(np.arange(900) - 401) <= 10
        quiet_sum = np.array(
            [
                np.sum(np.delete(quiet**2, slice(k - 16, k + 17)).astype(np.float64))
                for k in range(900)
                if far[k]
            ]
        )
        n_cells = 900 - 33
        assert got[far] == pytest.approx(core.factor(n_cells) / n_cells * quiet_sum, rel=1e-5)
        return
    assert got[far] == pytest.approx(expected[far], rel=1e-5)


def test_close_targets_mask_each_other_only_in_cell_averaging() -> None:
    d = np.ones(400, np.float32) + 0.1 * np.random.default_rng(6).normal(size=400).astype(np.float32)
    d[200], d[225] = 6.0, 40.0
    assert decide(detector("cell_averaging", false_alarm_probability=1e-3), d)[200] == 0
    assert decide(detector("ordered_statistic", false_alarm_probability=1e-3), d)[200] == 1


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e30])
def test_values_that_are_not_usable_are_rejected(method: str, bad: float) -> None:
    core = detector(method)
    d = np.ones(200, np.float32)
    d[77] = bad
    status, threshold, decisions = core.process(d)
    assert status == _core.Status.invalid_input
    assert len(threshold) == len(decisions) == 0


@pytest.mark.parametrize("method", METHODS)
def test_too_short_scans_are_rejected(method: str) -> None:
    core = detector(method)
    assert core.process(np.ones(core.min_samples(), np.float32))[0] == _core.Status.ok
    assert core.process(np.ones(core.min_samples() - 1, np.float32))[0] == _core.Status.invalid_input
    assert core.process(np.zeros(0, np.float32))[0] == _core.Status.invalid_input


def test_impossible_configurations_are_named() -> None:
    for field, value in (
        ("false_alarm_probability", 0.0),
        ("false_alarm_probability", float("nan")),
        ("training_cells_per_side", 0),
        ("training_cells_per_side", 65),
        ("guard_cells_per_side", -1),
        ("ordered_rank_fraction", 1.5),
        ("local_factor", 0.0),
        ("global_factor", float("nan")),
        ("buffer_samples", 0),
        ("max_rises", -1),
        ("rise_threshold_factor", 0.0),
    ):
        config = _core.CfarConfig(**{field: value})
        assert config.invalid_field() == field
        core = detector("cell_averaging")
        before = core.factor(20)
        assert core.configure(config) == _core.Status.invalid_config
        assert core.factor(20) == before
