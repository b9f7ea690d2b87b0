"""The wall: Snell's law, Fresnel's coefficients, Airy's series."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.simulation.wall import (
    Wall,
    reflection,
    refracted,
    reverberation,
    transmission,
    wall_response,
)

WALL = Wall()


def delay_by_bisection(wall: Wall, transverse_m: float, air_m: float) -> float:
    """Bisection on p, the sine in air: air p / sqrt(1 - p^2) + w p / sqrt(eps - p^2) = transverse."""
    w, eps = wall.thickness_m, wall.permittivity
    low, high = 0.0, 1.0
    for _ in range(200):
        p = 0.5 * (low + high)
        reach = math.inf if p == 1.0 else air_m * p / math.sqrt(1.0 - p * p) + w * p / math.sqrt(eps - p * p)
        low, high = (p, high) if reach < transverse_m else (low, p)
    return (air_m / math.sqrt(1.0 - low**2) + w * eps / math.sqrt(eps - low**2)) / SPEED_OF_LIGHT_MPS


def test_delays_are_those_of_bisection_on_snell_s_law() -> None:
    rng = np.random.default_rng(57)
    for _ in range(300):
        wall = Wall(thickness_m=rng.uniform(0.05, 0.5), permittivity=rng.uniform(1.0, 10.0))
        transverse_m, air_m = 10.0 ** rng.uniform(-2.0, 1.0), 10.0 ** rng.uniform(-1.0, 1.0)
        ray = refracted(wall, transverse_m, air_m)
        exact_s = delay_by_bisection(wall, transverse_m, air_m)
        assert float(ray.delay_s) == pytest.approx(exact_s, rel=0.0, abs=1e-17)  # a millionth of a picosecond


def test_a_refracted_ray_is_the_quickest_way() -> None:
    """Fermat: the least time over all points of entry and exit."""
    wall, target = WALL, np.array([3.0, 2.0])

    def time_s(crossings: np.ndarray) -> float:
        enter, leave = crossings
        air_m = math.hypot(enter, wall.front_m) + math.hypot(target[0] - leave, target[1] - wall.back_m)
        optical_m = math.sqrt(wall.permittivity) * math.hypot(leave - enter, wall.thickness_m)
        return 1e9 * (air_m + optical_m) / SPEED_OF_LIGHT_MPS

    found = minimize(time_s, np.array([0.5, 0.7]), method="BFGS", options={"gtol": 1e-9})
    ray = refracted(wall, target[0], target[1] - wall.thickness_m)
    assert 1e9 * float(ray.delay_s) == pytest.approx(found.fun, rel=0.0, abs=1e-9)
    enter, leave = found.x
    assert float(ray.sine) == pytest.approx(enter / math.hypot(enter, wall.front_m), abs=1e-5)
    slab_m = math.hypot(leave - enter, wall.thickness_m)
    assert float(ray.slab_m) == pytest.approx(slab_m, abs=1e-5)
    assert float(ray.length_m - ray.slab_m) == pytest.approx(
        math.hypot(enter, wall.front_m) + math.hypot(target[0] - leave, target[1] - wall.back_m), abs=1e-5
    )


def test_straight_through_the_wall_adds_w_times_sqrt_eps_minus_1() -> None:
    ray = refracted(WALL, 0.0, 3.76)
    assert float(ray.delay_s) * SPEED_OF_LIGHT_MPS == pytest.approx(4.0 + 0.24, abs=1e-12)
    twice = refracted(WALL, 0.0, 3.52, 2)
    assert float(twice.delay_s) * SPEED_OF_LIGHT_MPS == pytest.approx(4.0 + 0.48, abs=1e-12)


@pytest.mark.parametrize(
    ("x_m", "y_m", "error_m"), [(0.0, 4.0, 0.241), (1.5, 3.5, 0.257), (-3.0, 4.0, 0.281), (3.0, 2.0, 0.341)]
)
def test_who_forgets_the_wall_is_wrong_by_the_known_amounts(x_m: float, y_m: float, error_m: float) -> None:
    """Closed form of two ellipses, Tx at 0 and Rx at -d and +d, for a wall of 0.24 m and permittivity 4."""
    spacing_m = 0.4
    legs = refracted(WALL, np.abs(x_m - np.array([0.0, -spacing_m, spacing_m])), y_m - WALL.thickness_m)
    tx_m, left_m, right_m = legs.delay_s * SPEED_OF_LIGHT_MPS
    d1, d2 = tx_m + left_m, tx_m + right_m
    r0 = (d1**2 + d2**2 - 2.0 * spacing_m**2) / (2.0 * (d1 + d2))
    x = (d1 - d2) * (d1 * d2 + spacing_m**2) / (2.0 * spacing_m * (d1 + d2))
    assert math.hypot(x - x_m, math.sqrt(r0**2 - x**2) - y_m) == pytest.approx(error_m, abs=5e-4)


def test_brick_takes_20_db_per_metre_and_ninths_at_its_faces() -> None:
    assert float(reflection(WALL, 0.0)) == pytest.approx(-1.0 / 3.0)
    through = 20.0 * math.log10(float(transmission(WALL, refracted(WALL, 0.0, 2.0))))
    assert through == pytest.approx(20.0 * math.log10(8.0 / 9.0) - 4.8, abs=1e-9)
    slanted = refracted(WALL, 4.0, 2.0)
    assert float(slanted.slab_m) > WALL.thickness_m
    assert float(transmission(WALL, slanted)) < float(transmission(WALL, refracted(WALL, 0.0, 2.0)))


def test_brewster_s_angle_is_none_for_a_field_along_the_wall() -> None:
    """Perpendicular polarisation: reflects the more the flatter, and all of it at grazing incidence."""
    magnitude = np.abs(reflection(WALL, np.linspace(0.0, 1.0, 50)))
    assert np.all(np.diff(magnitude) > 0.0)
    assert magnitude[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("sine", [0.0, 0.6])
def test_echoes_inside_a_wall_without_loss_add_up_to_airy_s_formula(sine: float) -> None:
    wall = replace(WALL, loss_db_per_m=0.0)
    frequency_hz = np.linspace(0.1e9, 2.2e9, 400)
    square = float(reflection(wall, sine)) ** 2
    power = np.abs((1.0 - square) * reverberation(wall, sine, frequency_hz)) ** 2
    phase = 2.0 * np.pi * frequency_hz * wall.thickness_m * math.sqrt(4.0 - sine**2) / SPEED_OF_LIGHT_MPS
    np.testing.assert_allclose(
        power, 1.0 / (1.0 + 4.0 * square / (1.0 - square) ** 2 * np.sin(phase) ** 2), rtol=1e-9
    )
    assert power.max() == pytest.approx(1.0, abs=1e-3)


def test_echoes_inside_a_wall_come_3_2_ns_apart_and_29_db_down() -> None:
    period_s = 2.0 * 0.24 * 2.0 / SPEED_OF_LIGHT_MPS
    assert period_s == pytest.approx(3.2e-9, rel=0.001)
    frequency_hz = np.arange(1025) / (16.0 * period_s)  # a grid that has the echoes in samples 0, 128, ...
    in_time = np.fft.irfft(reverberation(WALL, 0.0, frequency_hz))
    echoes = np.abs(in_time[np.abs(in_time) > 1e-7 * np.abs(in_time[0])])
    assert 20.0 * np.log10(echoes[1] / echoes[0]) == pytest.approx(-28.7, abs=0.1)
    assert 20.0 * np.log10(echoes[2] / echoes[1]) == pytest.approx(-28.7, abs=0.1)


def test_the_wall_itself_answers_with_its_front_and_its_back() -> None:
    paths, sine = wall_response(WALL, 0.4, 0.48, 0.266)
    assert paths.delay_s[0] * SPEED_OF_LIGHT_MPS == pytest.approx(math.hypot(0.4, 0.48), abs=1e-12)
    assert sine[0] == pytest.approx(0.4 / math.hypot(0.4, 0.48), abs=1e-9)
    assert paths.gain[0] < 0.0 < paths.gain[1]  # into the denser, out of the denser
    straight, _ = wall_response(WALL, 0.0, 0.48, 0.266)
    np.testing.assert_allclose(np.diff(straight.delay_s), 2.0 * 0.24 * 2.0 / SPEED_OF_LIGHT_MPS, rtol=1e-9)
    face = 8.0 / 9.0 * 10.0 ** (-9.6 / 20.0) * 0.48 / 0.96  # both ways through it, loss, distance
    assert straight.gain[1] / straight.gain[0] == pytest.approx(-face, rel=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"thickness_m": 0.0}, "thickness_m"),
        ({"permittivity": 0.5}, "permittivity"),
        ({"loss_db_per_m": -1.0}, "loss"),
    ],
)
def test_impossible_walls_are_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(WALL, **change)
