"""What the stages of a through-wall receiver promise, by numbers worked out beside them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from echofuse import _core
from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.simulation.through_wall import simulate_through_wall
from echofuse.simulation.through_wall_scene import case_study_walkers, through_wall_scene
from echofuse.simulation.wall import refracted

OK, INVALID = _core.Status.ok, _core.Status.invalid_input


def enhanced(samples, **config):  # type: ignore[no-untyped-def]
    stage = _core.WeakSignalEnhancer()
    assert stage.configure(_core.WeakSignalConfig(**config), len(samples)) == OK
    return stage.process(np.array(samples, np.float32))[1]


def traced(decisions, **config):  # type: ignore[no-untyped-def]
    stage = _core.TargetTracer()
    assert stage.configure(_core.TargetTraceConfig(**config)) == OK
    return stage.process(np.array(decisions, np.uint8))[1]


def test_an_echo_behind_a_stronger_one_is_raised_to_it() -> None:
    got = enhanced([0.1, 0.2, 5, 1, 0.3, 2, 0.5, 0.1], floor_factor=0.0, noise_samples=2)
    np.testing.assert_allclose(got, [0.02, 0.04, 1, 0.5, 0.15, 1, 1, 1], rtol=1e-6)


def test_the_tail_of_noise_is_not_raised() -> None:
    rng = np.random.default_rng(0)
    assert np.max(np.abs(enhanced(rng.normal(0.0, 1.0, 511)))) < 1.0


@pytest.mark.parametrize(
    ("fast", "slow", "spread", "deviations", "rate"),
    [
        (0.5, 0.02, "rms", 0.5, 8e-2), (0.5, 0.02, "rms", 0.75, 2.4e-2), (0.3, 0.02, "rms", 0.5, 2.4e-2),
        (0.5, 0.02, "standard_deviation", 1.0, 5e-2), (0.3, 0.02, "standard_deviation", 1.0, 1e-2),
        (0.2, 0.01, "standard_deviation", 1.0, 2e-3),
    ],
)  # fmt: skip
def test_false_alarms_in_gaussian_noise(
    fast: float, slow: float, spread: str, deviations: float, rate: float
) -> None:
    stage = _core.GaussianCfarDetector()
    config = _core.GaussianCfarConfig(
        fast_factor=fast, slow_factor=slow, spread=getattr(_core.ClutterSpread, spread), deviations=deviations
    )
    assert stage.configure(config) == OK
    noise = np.random.default_rng(1).normal(0.0, 1.0, 400_000).astype(np.float32)
    assert np.mean(stage.process(noise)[1]) == pytest.approx(rate, rel=0.25)


def test_a_target_begins_at_its_first_reflection() -> None:
    decisions = np.zeros(300)
    decisions[100:120] = 1
    np.testing.assert_array_equal(traced(decisions)["toa_samples"], [100.0])


@pytest.mark.parametrize("density", [0.7, 0.5])
def test_missing_hits_delay_a_target_and_the_correction_takes_half_of_it_off(density: float) -> None:
    rng = np.random.default_rng(2)
    late: dict[bool, list[float]] = {False: [], True: []}
    for _ in range(2000):
        decisions = np.zeros(300)
        decisions[100:130] = rng.random(30) < density
        for corrected, found in late.items():
            toa = traced(decisions, density_correction=corrected)["toa_samples"]
            found.extend(toa[:1] - 100.0)
    plain, corrected = (float(np.mean(late[which])) for which in (False, True))
    assert plain == pytest.approx(4.0 * (1.0 / density - 1.0), abs=1.3)
    assert 0.0 < corrected < 0.6 * plain


@given(start=st.integers(0, 510), fraction=st.floats(-0.4, 0.4), scale=st.floats(1e-3, 1e6))
def test_the_cross_talk_comes_to_its_place_wherever_the_response_begins(
    start: int, fraction: float, scale: float
) -> None:
    k = np.arange(511)
    response = np.exp(-(((k - 6 - fraction) / 2.5) ** 2)) - 0.7 * np.exp(-(((k - 20) / 2.5) ** 2))
    stage = _core.TimeZeroFinder()
    assert stage.configure(_core.TimeZeroConfig(), 511, 6.0) == OK
    turned = np.roll(scale * response, start).astype(np.float32)
    learning = _core.TimeZeroConfig().learning_responses
    for index in range(learning + 1):
        status, result, rotated = stage.process(turned)
        assert (status, result.found) == (OK, index == learning)
    assert result.rotation_samples == start
    assert result.fraction_samples == pytest.approx(fraction, abs=0.02)  # a parabola is not a Gaussian
    np.testing.assert_array_equal(rotated, np.roll(turned, -start))


def test_without_cross_talk_nothing_is_found() -> None:
    stage, rng = _core.TimeZeroFinder(), np.random.default_rng(4)
    assert stage.configure(_core.TimeZeroConfig(), 511, 6.0) == OK
    for _ in range(60):
        _, result, rotated = stage.process(rng.normal(0.0, 1.0, 511).astype(np.float32))
        assert not result.found
        assert not rotated.any()


def test_inputs_of_the_wrong_length_are_refused() -> None:
    short = np.zeros(10, np.float32)
    finder, enhancer = _core.TimeZeroFinder(), _core.WeakSignalEnhancer()
    assert finder.process(short)[0] == _core.Status.not_configured
    assert finder.configure(_core.TimeZeroConfig(), 511, 600.0) == _core.Status.invalid_config
    assert finder.configure(_core.TimeZeroConfig(), 511, 6.0) == OK
    assert finder.process(short)[0] == INVALID
    assert finder.process(np.zeros(511, np.float32), kept_samples=512)[0] == INVALID
    assert finder.configure(_core.TimeZeroConfig(), 4096, 6.0) == _core.Status.invalid_config
    assert enhancer.configure(_core.WeakSignalConfig(noise_samples=20), 10) == _core.Status.invalid_config
    assert enhancer.configure(_core.WeakSignalConfig(), 511) == OK
    assert enhancer.process(short)[0] == INVALID


@pytest.mark.parametrize(
    ("kind", "field", "value"),
    [
        ("TimeZeroConfig", "learning_responses", 0), ("TimeZeroConfig", "strong_fraction", 0.0),
        ("TimeZeroConfig", "least_peak_factor", float("nan")), ("TimeZeroConfig", "moved_samples", -1),
        ("TimeZeroConfig", "moved_responses", 0), ("WeakSignalConfig", "floor_factor", -1.0),
        ("WeakSignalConfig", "noise_samples", 0), ("WeakSignalConfig", "averaging_factor", 1.0),
        ("GaussianCfarConfig", "fast_factor", 0.0), ("GaussianCfarConfig", "slow_factor", float("nan")),
        ("GaussianCfarConfig", "deviations", 0.0), ("GaussianCfarConfig", "starting_samples", 0),
        ("TargetTraceConfig", "window_samples", 0), ("TargetTraceConfig", "least_hits", 16),
    ],
)  # fmt: skip
def test_an_impossible_value_is_named(kind: str, field: str, value: float) -> None:
    assert getattr(_core, kind)(**{field: value}).invalid_field() == field


def test_a_leading_edge_is_a_fraction_of_its_largest_value_high() -> None:
    envelope = np.full(60, 0.25, np.float32)
    envelope[20:30] = [1, 2, 3, 4, 5, 6, 7, 8, 4, 2]
    stage = _core.LeadingEdge()
    traces = traced(np.arange(60) >= 22)[:1]
    assert stage.process(envelope, traces)[0] == _core.Status.not_configured
    for fraction, expected in ((0.5, 23.0), (0.4375, 22.5), (0.0625, 19.0 + 0.25 / 0.75)):
        assert stage.configure(_core.LeadingEdgeConfig(fraction=fraction)) == OK
        assert stage.process(envelope, traces)[1]["toa_samples"] == pytest.approx([expected])
    assert stage.configure(_core.LeadingEdgeConfig(fraction=0.01)) == OK
    assert stage.process(envelope, traces)[1]["toa_samples"] == [18.0]  # the window's first sample
    np.testing.assert_array_equal(stage.process(np.zeros(60, np.float32), traces)[1], traces)
    np.testing.assert_array_equal(stage.process(envelope[:10], traces)[1], traces)


def test_two_receivers_differ_by_half_as_much_at_leading_edges() -> None:
    """One person, 30 s, median error of the difference between two receivers' paths [m]."""
    scene = through_wall_scene()
    run = simulate_through_wall(scene, case_study_walkers(1), seed=3, duration_s=30.0)
    position_m = run.truth[0].position_m

    def leg_m(x_m: float):  # type: ignore[no-untyped-def]
        across, air = np.abs(position_m[:, 0] - x_m), position_m[:, 1] - scene.wall.thickness_m
        return refracted(scene.wall, across, air).delay_s * SPEED_OF_LIGHT_MPS

    error_m = np.full((2, 2, len(position_m)), np.nan)  # (receiver, hits or edge, response)
    for receiver, node in enumerate(run.nodes):
        true_m = leg_m(0.0) + leg_m(float(node.rx_position_m[0]))
        for index, (delays, edges) in enumerate(_traces(node.scans)):
            offset = delays / scene.radar.clock_hz * SPEED_OF_LIGHT_MPS - true_m[index]
            if len(offset):
                best = np.argmin(np.abs(offset + 0.45))  # the front of a body lies before its middle
                edge_m = edges[best] / scene.radar.clock_hz * SPEED_OF_LIGHT_MPS
                error_m[receiver, :, index] = offset[best], edge_m - true_m[index]
    apart = np.abs(error_m[0] - error_m[1])[:, np.all(np.abs(error_m[:, 0] + 0.45) < 0.6, axis=0)]
    hits_m, edges_m = np.median(apart, axis=1)
    assert apart.shape[1] > 250
    assert edges_m < 0.65 * hits_m  # 0.39 to 0.57 of it in seeds 0 to 5
    assert edges_m < 0.04  # 0.023 to 0.036


def _traces(scans):  # type: ignore[no-untyped-def]
    """Each response's delays by hits, and by leading edges [sample]."""
    time_zero, enhancer, detector = (
        _core.TimeZeroFinder(), _core.WeakSignalEnhancer(), _core.GaussianCfarDetector(),
    )  # fmt: skip
    envelope, tracer, edge = _core.Envelope(), _core.TargetTracer(), _core.LeadingEdge()
    n = scans.shape[1]
    assert time_zero.configure(_core.TimeZeroConfig(), n, 6.0) == OK
    assert enhancer.configure(_core.WeakSignalConfig(), n) == OK
    assert detector.configure(_core.GaussianCfarConfig()) == OK
    assert envelope.configure(_core.EnvelopeConfig(), 4.5e9) == OK
    assert tracer.configure(_core.TargetTraceConfig()) == OK
    assert edge.configure(_core.LeadingEdgeConfig()) == OK
    average = None
    for scan in scans:
        _, place, response = time_zero.process(scan)
        if not place.found:
            yield np.zeros(0), np.zeros(0)
            continue
        average = response if average is None else np.float32(0.95) * average + np.float32(0.05) * response
        rest = response - average
        traces = tracer.process(detector.process(enhancer.process(rest)[1])[1])[1]
        edges = edge.process(envelope.process(rest)[1], traces)[1]
        late = detector.delay_samples() + place.fraction_samples
        yield traces["toa_samples"] - late, edges["toa_samples"] - place.fraction_samples
