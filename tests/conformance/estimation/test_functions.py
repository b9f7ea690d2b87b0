"""Kernel, resampling, assignment, Kalman filter: core against reference."""

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard
from echofuse.reference.estimation.assignment import assign, assignment_margin
from echofuse.reference.estimation.gaussian import gaussian_kernel
from echofuse.reference.estimation.kalman import ConstantVelocityFilter
from echofuse.reference.estimation.resampling import systematic_resample
from echofuse.reference.estimation.turning_filter import TurningFilter

SEEDS = range(20)
FILTERS = {2: _core.ConstantVelocityFilter, 3: _core.ConstantVelocityFilter3d}
TURNING = {2: _core.TurningFilter, 3: _core.TurningFilter3d}


def test_gaussian_kernel() -> None:
    board = Scoreboard()
    squared = np.linspace(0.0, 26.0, 20001, dtype=np.float32)
    expected = gaussian_kernel(squared.astype(np.float64))
    board.floats(
        "", "kernel", "", _core.gaussian_kernel(squared), expected, "estimation.gaussian", scale=expected
    )
    assert [row.failures for row in board.rows()] == [[]]


@pytest.mark.parametrize("n_out", [1, 7, 500, 2048])
def test_resampling(n_out: int) -> None:
    board = Scoreboard()
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        weights = rng.exponential(size=rng.integers(1, 3000)).astype(np.float32) ** 3
        weights[rng.random(len(weights)) < 0.2] = 0.0
        weights[rng.integers(len(weights))] = 1.0
        uniform = float(np.float32(rng.random()))
        status, got = _core.systematic_resample(weights, uniform, n_out)
        assert status == _core.Status.ok
        expected = systematic_resample(weights.astype(np.float64), uniform, n_out)
        board.decisions("", "indices", f"seed {seed}", got, expected.indices, expected.margin)
    assert [row.failures for row in board.rows()] == [[]]
    assert board.rows()[0].excused < 0.1 * board.rows()[0].values


@pytest.mark.parametrize("shape", [(1, 1), (3, 8), (8, 3), (12, 12), (32, 32), (5, 32)])
def test_assignment(shape: tuple[int, int]) -> None:
    board = Scoreboard()
    for seed in SEEDS:
        cost = np.random.default_rng(seed).uniform(0.0, 3.0, shape).astype(np.float32)
        status, got = _core.assign(cost)
        assert status == _core.Status.ok
        exact = cost.astype(np.float64)
        expected = assign(exact)
        margin = assignment_margin(exact, expected, np.full(len(cost), 1e3)) * 1e3
        board.decisions("", "columns", f"seed {seed}", got, expected, margin)
    assert [row.failures for row in board.rows()] == [[]]


@pytest.mark.parametrize("dimension", [2, 3])
def test_kalman(dimension: int) -> None:
    board, kind = Scoreboard(), FILTERS[dimension]
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        root = rng.normal(size=(2 * dimension, 2 * dimension)).astype(np.float32)
        state, covariance = rng.normal(0.0, 5.0, 2 * dimension).astype(np.float32), root @ root.T
        core = kind(state, covariance)
        reference = ConstantVelocityFilter(state.astype(np.float64), covariance.astype(np.float64))
        for _ in range(20):
            dt_s, density, decay = rng.uniform(0.02, 0.3, 3).astype(np.float32).tolist()
            core.predict(dt_s, density, decay)
            reference.predict(dt_s, density, decay)
            small = rng.normal(0.0, 0.2, (dimension, dimension)).astype(np.float32)
            noise = (small @ small.T + 0.01 * np.eye(dimension)).astype(np.float32)
            z, direction = rng.normal(0.0, [[5.0], [1.0]], (2, dimension)).astype(np.float32)
            core.update(z, noise)
            reference.update(z.astype(np.float64), noise.astype(np.float64))
            innovation_m, variance_m2 = np.float32(rng.normal(0.0, 0.3)), np.float32(rng.uniform(0.01, 0.1))
            core.update_along(direction, innovation_m, variance_m2)
            reference.update_along(direction.astype(np.float64), float(innovation_m), float(variance_m2))
        where = f"seed {seed}"
        board.floats("", "state", where, core.state, reference.state, "estimation.kalman.state")
        board.floats(
            "", "covariance", where, core.covariance, reference.covariance, "estimation.kalman.covariance"
        )
    assert [row.failures for row in board.rows()] == [[], []]


def walk(rng: np.random.Generator, dimension: int, n_steps: int) -> np.ndarray:
    """Positions (n_steps, dimension) [m] of somebody who turns by a right angle half way, 1 m/s."""
    along = np.minimum(np.arange(n_steps), n_steps // 2)
    aside = np.maximum(np.arange(n_steps) - n_steps // 2, 0)
    directions = np.linalg.qr(rng.normal(size=(dimension, dimension)))[0][:2]
    return 0.1 * (along[:, np.newaxis] * directions[0] + aside[:, np.newaxis] * directions[1])


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("turns", [True, False])
def test_turning_filter(dimension: int, turns: bool) -> None:
    board, noticed = Scoreboard(), []
    dt_s, straight, turning, begin, end, variance_m2 = np.array(
        [0.1, 0.01, 2.0, 0.02, 0.1, 0.0025], np.float32
    )
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        state = np.zeros(2 * dimension, np.float32)
        covariance = np.kron(np.eye(dimension), np.diag([0.04, 1.0])).astype(np.float32)
        core = TURNING[dimension](state, covariance, turns)
        single = ConstantVelocityFilter(state.astype(np.float64), covariance.astype(np.float64))
        double = TurningFilter(single)
        probability = []
        for position in walk(rng, dimension, 80):
            core.predict(dt_s, straight, turning, begin, end)
            if turns:
                double.predict(float(dt_s), (float(straight), float(turning)), float(begin), float(end))
            else:
                single.predict(float(dt_s), float(straight))
            expected = double if turns else single
            for direction in rng.normal(size=(3, dimension)).astype(np.float32):
                true = direction.astype(np.float64)
                measured_m = float(true @ position) + rng.normal(0.0, 0.05)
                innovation_m = np.float32(measured_m - true @ expected.position)
                core.update_along(direction, innovation_m, variance_m2)
                expected.update_along(true, float(innovation_m), float(variance_m2))
            probability.append(double.probability[1])
        where = f"seed {seed}"
        board.floats("", "state", where, core.state, expected.state, "estimation.turning.state")
        board.floats(
            "", "covariance", where, core.covariance, expected.covariance, "estimation.turning.covariance"
        )
        if turns:
            board.floats(
                "",
                "probability",
                where,
                np.array([core.turning_probability]),
                double.probability[1:],
                "estimation.turning.probability",
            )
            noticed.append(np.mean(probability[41:48]) - np.mean(probability[20:40]))
    assert [row.failures for row in board.rows()] == [[]] * len(board.rows())
    assert not turns or np.mean(noticed) > 0.3


def test_turning_filter_holds() -> None:
    for turns in (True, False):
        core = _core.TurningFilter(
            np.array([1.0, 3.0, 0.0, 0.5], np.float32), np.eye(4, dtype=np.float32), turns
        )
        core.hold(0, -2.0, 0.5)
        np.testing.assert_array_equal(core.state, np.array([0.5, 0.0, 0.0, 0.5], np.float32))
