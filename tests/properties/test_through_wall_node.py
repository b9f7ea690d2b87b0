"""The through-wall node: absolute delays, limits, bad input, what it forgets and what it counts."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from echofuse import _core

C = 299792458.0
FS = 4.5e9
N_SAMPLES = 511
CROSS_TALK = 6.0  # [sample] 0.4 m
LEARNING, SETTLING = 5, 8
SETTLED = LEARNING + SETTLING
WIDTH = 2.2  # [sample] of a pulse, to 1 / e of its height
EDGE = WIDTH * np.sqrt(np.log(2.0))  # [sample] from half the envelope's height to its peak
OK, INVALID = _core.Status.ok, _core.Status.invalid_input
Response = NDArray[np.float32]


def pulse(place: float, n_samples: int = N_SAMPLES, *, carrier: float = 0.25) -> NDArray[np.float64]:
    """(n_samples,) of an echo at a sample, `carrier` cycles a sample."""
    x = np.arange(n_samples) - place
    shape = np.exp(-((x / WIDTH) ** 2)) * np.cos(2.0 * np.pi * carrier * x)
    return np.where(np.abs(x) < 4.0 * WIDTH, shape, 0.0)


def person(place: float, n_samples: int = N_SAMPLES) -> NDArray[np.float64]:
    """(n_samples,) of an echo with a tail."""
    return (
        pulse(place, n_samples) + 0.6 * pulse(place + 6.0, n_samples) + 0.4 * pulse(place + 12.0, n_samples)
    )


def response(
    rng: np.random.Generator,
    people: Sequence[float] = (),
    *,
    start: int = 123,
    late: float = 0.0,
    noise: float = 0.0,
    n_samples: int = N_SAMPLES,
) -> Response:
    """(n_samples,) cross-talk, a wall, echoes of people at samples [count]; begins with chip `start`.

    Without noise the empty room leaves nothing, and traces are people's alone.
    """
    made = 4000.0 * pulse(CROSS_TALK + late, n_samples, carrier=0.0)
    made = made + 900.0 * pulse(14.0 + late, n_samples)
    for place in people:
        made = made + 200.0 * person(place + late, n_samples)
    return np.roll(made + rng.normal(0.0, noise, n_samples), start).astype(np.float32)


def config_of(**fields: Any) -> _core.ThroughWallNodeConfig:
    return _core.ThroughWallNodeConfig(baseline_m=CROSS_TALK / FS * C, **fields)


def node_of(**fields: Any) -> _core.ThroughWallNode:
    core = _core.ThroughWallNode()
    assert core.configure(config_of(**fields)) == OK
    return core


def settle(core: _core.ThroughWallNode, rng: np.random.Generator, n: int = SETTLED, **how: Any) -> None:
    """Let it hear the empty room."""
    for t in range(n):
        assert core.process(response(rng, **how), t)[0] == OK


def test_nothing_is_reported_until_time_zero_and_background_are_known() -> None:
    rng, core = np.random.default_rng(0), node_of()
    assert core.process(response(rng), 0)[0] == OK
    assert not core.ready()
    settle(core, rng, SETTLED - 2)
    assert not core.ready()
    assert len(core.process(response(rng, [100.0]), 0)[1]) == 0
    assert core.ready()
    assert len(core.process(response(rng, [100.0]), 0)[1]) == 1
    assert core.counters()["settling_responses"] == SETTLED
    core.reset()
    assert not core.ready()
    assert len(core.process(response(rng, [100.0]), 0)[1]) == 0
    assert core.counters()["settling_responses"] == SETTLED + 1


@settings(max_examples=40)
@given(
    place=st.floats(40.0, 400.0),
    start=st.integers(0, 510),
    late=st.floats(-0.45, 0.45),
    offset_s=st.floats(-1e-9, 1e-9),
    seed=st.integers(0, 1000),
)
def test_the_delay_of_a_person_is_absolute(
    place: float, start: int, late: float, offset_s: float, seed: int
) -> None:
    """From wherever the response begins, to a fraction of a sample, less the half height of its edge."""
    rng, core = np.random.default_rng(seed), node_of(delay_offset_s=offset_s)
    settle(core, rng, start=start, late=late)
    status, detections = core.process(response(rng, [place], start=start, late=late), 0)
    assert status == OK
    expected = (place - EDGE) / FS + offset_s
    assert np.min(np.abs(detections["delay_s"] - expected)) < 0.2 / FS


def test_two_people_come_by_ascending_delay_with_the_hits_that_each_had() -> None:
    rng, core = np.random.default_rng(1), node_of()
    settle(core, rng)
    _, detections, taps = core.process_with_taps(response(rng, [200.0, 80.0]), 7)
    np.testing.assert_allclose(detections["delay_s"] * FS, [80.0 - EDGE, 200.0 - EDGE], atol=0.2)
    np.testing.assert_array_equal(detections["weight"], taps["target_traces"][:, 1])
    assert np.all(detections["weight"] >= 5)
    np.testing.assert_array_equal(taps["detections"][:, 0], detections["delay_s"])


def test_nothing_is_reported_from_the_blind_zone_or_from_beyond_the_room() -> None:
    limits = {"blind_zone_s": 60.0 / FS, "max_delay_s": 250.0 / FS}
    for fields, heard in (({}, [60.0, 150.0, 300.0]), (limits, [150.0])):
        rng, core = np.random.default_rng(2), node_of(**fields)
        settle(core, rng)
        _, detections, taps = core.process_with_taps(response(rng, [60.0, 150.0, 300.0]), 0)
        np.testing.assert_allclose(detections["delay_s"] * FS, np.array(heard) - EDGE, atol=0.3)
        assert len(taps["leading_edges"]) == 3  # the taps show them all


def test_a_trace_that_falls_upon_another_is_the_same_echo() -> None:
    """Two runs of hits in one echo: the later one's window begins in the earlier echo, and so both meet."""
    rng, core = np.random.default_rng(3), _core.ThroughWallNode()
    config = config_of()
    config.target_traces.window_samples, config.target_traces.least_hits = 3, 2
    config.leading_edge.before_samples = 40
    assert core.configure(config) == OK
    settle(core, rng)
    _, detections, taps = core.process_with_taps(response(rng, [100.0, 125.0, 300.0]), 0)
    edges = taps["leading_edges"]
    assert len(edges) == 3
    assert abs(edges[1, 0] - edges[0, 0]) < 1.0
    np.testing.assert_allclose(detections["delay_s"] * FS, [100.0 - EDGE, 300.0 - EDGE], atol=0.4)
    assert detections["weight"][0] == max(edges[0, 1], edges[1, 1])


def test_more_traces_than_a_report_holds_leave_the_heaviest() -> None:
    rng, core = np.random.default_rng(4), _core.ThroughWallNode()
    config = config_of()
    config.target_traces.window_samples, config.target_traces.least_hits = 8, 3
    config.gaussian_cfar.deviations = 0.3
    assert core.configure(config) == OK
    settle(core, rng)
    places = np.arange(40.0, 490.0, 25.0)  # 18 people
    status, detections, taps = core.process_with_taps(response(rng, places), 0)
    traces = len(taps["leading_edges"])
    assert status == _core.Status.truncated
    assert (len(detections), traces) == (16, 18)
    assert core.counters()["truncated_detections"] == traces - 16
    assert np.all(np.diff(detections["delay_s"]) > 0.0)
    kept, all_weights = np.sort(detections["weight"]), np.sort(taps["leading_edges"][:, 1])
    np.testing.assert_array_equal(kept, all_weights[-16:])


def test_a_power_up_makes_everything_begin_anew_and_no_delay_is_wrong() -> None:
    rng, core = np.random.default_rng(5), node_of()
    settle(core, rng, start=20)
    for t in range(60):
        moved = response(rng, [100.0 + t], start=377)
        detections = core.process(moved, t)[1]
        if t < 2 + SETTLED:
            assert len(detections) == 0
        elif t > 2 + SETTLED + 2:  # some responses after it had a background that held the person elsewhere
            assert np.min(np.abs(detections["delay_s"] * FS - (100.0 + t - EDGE))) < 1.0
    counted = core.counters()
    assert (counted["time_zero_moved"], counted["cross_talk_missing"]) == (1, 2)
    assert counted["settling_responses"] == 2 * SETTLED


def test_without_cross_talk_there_are_only_empty_reports() -> None:
    rng, core = np.random.default_rng(6), node_of()
    for t in range(50):
        status, detections = core.process(rng.normal(0.0, 3.0, N_SAMPLES).astype(np.float32), t)
        assert (status, len(detections), core.report_ready(), core.ready()) == (OK, 0, True, False)
    counted = core.counters()
    assert counted["settling_responses"] == LEARNING
    assert counted["cross_talk_missing"] == counted["responses"] - LEARNING == 45


@pytest.mark.parametrize("trouble", ["dead_responses", "saturated_responses", "cross_talk_missing"])
def test_what_a_receiver_in_trouble_says_teaches_nothing(trouble: str) -> None:
    """Two such responses in a row: the next good one is judged as if they had not been."""
    troubled, untroubled = node_of(full_scale_count=5000.0), node_of(full_scale_count=5000.0)
    for core in (troubled, untroubled):
        settle(core, np.random.default_rng(7))
    rng = np.random.default_rng(8)
    for t in range(2):
        bad = {
            "dead_responses": np.full(N_SAMPLES, 17.0),
            "saturated_responses": np.clip(9.0 * response(rng, [100.0]), -5000.0, 5000.0),
            "cross_talk_missing": rng.normal(0.0, 2.0, N_SAMPLES),
        }[trouble]
        status, detections = troubled.process(bad.astype(np.float32), t)
        assert (status, len(detections), troubled.report_ready()) == (OK, 0, True)
    assert troubled.counters()[trouble] == 2
    good = response(np.random.default_rng(9), [100.0])
    got, expected = troubled.process(good, 9)[1], untroubled.process(good, 9)[1]
    assert len(expected) == 1
    np.testing.assert_array_equal(got, expected)


def test_a_few_samples_at_full_scale_are_trusted_and_more_are_not() -> None:
    rng = np.random.default_rng(10)
    core = node_of(full_scale_count=5000.0, saturated_samples=3)
    settle(core, rng)
    for clipped, counted in ((3, 0), (4, 1)):
        heard = response(rng)
        heard[200 : 200 + clipped] = [5000.0, -5000.0, 6000.0, 5000.0][:clipped]
        assert core.process(heard, 0)[0] == OK
        assert core.counters()["saturated_responses"] == counted


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e20])
def test_unusable_responses_change_nothing(bad: float) -> None:
    first, second = node_of(), node_of()
    for core in (first, second):
        settle(core, np.random.default_rng(11))
    broken = response(np.random.default_rng(12), [100.0])
    broken[123] = bad
    for given_ in (broken, broken[:510], np.zeros(0, np.float32)):
        status, detections = first.process(given_, 0)
        assert (status, len(detections), first.report_ready()) == (INVALID, 0, False)
    assert first.counters()["rejected_responses"] == 3
    assert first.counters()["responses"] == SETTLED
    good = response(np.random.default_rng(13), [100.0])
    np.testing.assert_array_equal(first.process(good, 1)[1], second.process(good, 1)[1])


@settings(max_examples=60)
@given(
    n_samples=st.integers(64, 1920),
    scale=st.sampled_from([1e-30, 1e-3, 1.0, 1e4, 1e7]),
    seed=st.integers(0, 10_000),
    data=st.data(),
)
def test_no_input_gives_a_delay_that_is_not_finite_or_not_ascending(
    n_samples: int, scale: float, seed: int, data: st.DataObject
) -> None:
    """Any length, any loudness; noise, jumps, steps and silence between good responses."""
    rng = np.random.default_rng(seed)
    config = config_of(n_samples=n_samples, blind_zone_s=data.draw(st.sampled_from([0.0, 2.7e-9])))
    config.time_zero.learning_responses = config.clutter.learning_scans = 2
    config.target_traces.window_samples = data.draw(st.integers(1, 40))
    config.target_traces.least_hits = 1
    config.target_traces.density_correction = data.draw(st.booleans())
    config.gaussian_cfar.deviations = data.draw(st.sampled_from([0.1, 0.7]))
    config.weak_signal.floor_factor = data.draw(st.sampled_from([0.0, 4.0]))
    core = _core.ThroughWallNode()
    assert core.configure(config) == OK
    reports = 0
    for t in range(25):
        kind = rng.integers(6) if t > 4 else 0
        heard = scale * response(rng, rng.uniform(0.0, n_samples, 4), noise=2.0, n_samples=n_samples).astype(
            np.float64
        )
        if kind == 1:
            heard = scale * rng.normal(0.0, 100.0, n_samples)
        elif kind == 2:
            heard[rng.integers(n_samples) :] = 0.0
        elif kind == 3:
            heard[rng.integers(n_samples) :: 7] *= -10.0
        elif kind == 4:
            heard = np.roll(heard, rng.integers(n_samples))
        status, detections = core.process(heard.astype(np.float32), t)
        assert status in (OK, _core.Status.truncated)
        delays = detections["delay_s"]
        assert np.all(np.isfinite(delays))
        assert np.all(np.diff(delays) > 0.0)
        assert np.all(delays >= (CROSS_TALK / FS + config.blind_zone_s) * (1.0 - 1e-6))
        assert np.all(delays <= n_samples / FS)
        assert np.all(detections["weight"] >= 1)
        reports += core.report_ready()
    counted = core.counters()
    assert counted["responses"] == reports == 25


def test_taps_do_not_change_the_report_and_float64_is_refused() -> None:
    first, second, rng = node_of(), node_of(), np.random.default_rng(14)
    for t in range(40):
        heard = response(rng, [100.0 + t] if t > LEARNING + SETTLING else [])
        np.testing.assert_array_equal(first.process(heard, t)[1], second.process_with_taps(heard, t)[1])
    with pytest.raises(TypeError):
        first.process(heard.astype(np.float64), 0)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("node_id", -1), ("n_samples", 2), ("n_samples", 4096), ("sample_rate_hz", float("nan")),
        ("kept_samples", -1), ("kept_samples", 1921), ("kept_samples", 82),
        ("baseline_m", -1.0), ("baseline_m", 34.1), ("delay_offset_s", 5.0), ("blind_zone_s", -1e-9),
        ("max_delay_s", float("nan")), ("max_delay_s", 4e-9), ("full_scale_count", -1.0),
        ("saturated_samples", -1),
    ],
)  # fmt: skip
def test_an_impossible_field_is_named(field: str, value: float) -> None:
    core, config = _core.ThroughWallNode(), _core.ThroughWallNodeConfig(**{field: value})
    assert config.invalid_field() == field
    assert core.configure(config) == _core.Status.invalid_config
    assert core.process(np.ones(N_SAMPLES, np.float32), 0)[0] == _core.Status.not_configured


@pytest.mark.parametrize(
    ("key", "value", "named"),
    [
        ("time_zero.strong_fraction", 0.0, "time_zero"), ("clutter.averaging_factor", 1.0, "clutter"),
        ("envelope.hilbert_half_length_samples", 0, "envelope"),
        ("weak_signal.floor_factor", -1.0, "weak_signal"), ("gaussian_cfar.deviations", 0.0, "gaussian_cfar"),
        ("target_traces.least_hits", 0, "target_traces"), ("leading_edge.fraction", 1.0, "leading_edge"),
        ("clutter.method", _core.ClutterMethod.empty_room_envelope, "clutter.method"),
        ("envelope.low_pass_cutoff_hz", 2.25e9, "envelope.low_pass_cutoff_hz"),
        ("weak_signal.noise_samples", 512, "weak_signal.noise_samples"),
    ],
)  # fmt: skip
def test_an_impossible_stage_is_named(key: str, value: Any, named: str) -> None:
    config = _core.ThroughWallNodeConfig()
    stage, field = key.split(".")
    setattr(getattr(config, stage), field, value)
    assert config.invalid_field() == named
    assert _core.ThroughWallNode().configure(config) == _core.Status.invalid_config


def test_what_is_kept_fits_the_stages_and_holds_noise_behind_the_blind_zone() -> None:
    config = config_of(n_samples=4095)
    assert config.invalid_field() == "kept_samples"
    config.kept_samples = 83  # 18.2 samples to the end of the blind zone, and 64 of noise
    assert config.invalid_field() is None
    config.blind_zone_s = 3e-9
    assert config.invalid_field() == "kept_samples"
    config.weak_signal.noise_samples = 60
    assert config.invalid_field() is None
    config.n_samples, config.kept_samples = 64, 1000  # more than there are: all
    assert config.invalid_field() is None
    config.n_samples, config.kept_samples = 4095, 1920
    config.clutter.method = _core.ClutterMethod.frame_difference
    config.clutter.difference_lag_scans = 4
    assert config.invalid_field() == "clutter.difference_lag_scans"
    config.kept_samples = 511
    assert config.invalid_field() is None


@pytest.mark.parametrize("n_samples", [511, 4095])
def test_what_is_kept_of_a_response_is_judged_as_a_response_that_is_no_longer(n_samples: int) -> None:
    """Wherever it begins, and whatever moves behind that."""
    kept, starts = 400, (0, 123, n_samples - 200, n_samples - 5)
    for start in starts:
        rng = np.random.default_rng(15)
        cut, short = node_of(n_samples=n_samples, kept_samples=kept), node_of(n_samples=kept)
        for t in range(SETTLED + 20):
            people = [100.0 + t, 250.0] if t > SETTLED else []
            whole = response(rng, people, start=0, n_samples=n_samples)
            whole[kept:] += 30.0 * pulse(20.0 + t, n_samples - kept).astype(np.float32)  # out of sight
            status, got, taps = cut.process_with_taps(np.roll(whole, start), t)
            expected_status, expected, expected_taps = short.process_with_taps(whole[:kept].copy(), t)
            assert (status, expected_status) == (OK, OK)
            np.testing.assert_array_equal(got, expected)
            assert len(taps["scan"]) == n_samples
            for name, values in expected_taps.items():
                if name not in ("scan", "time_zero"):
                    np.testing.assert_array_equal(taps[name], values)
            assert len(got) == 2 or t <= SETTLED + 3


def test_a_frame_difference_further_back_than_the_memory_is_named() -> None:
    config = _core.ThroughWallNodeConfig(n_samples=1920)
    config.clutter.method = _core.ClutterMethod.frame_difference
    config.clutter.difference_lag_scans = 4
    assert config.invalid_field() == "clutter.difference_lag_scans"
    config.n_samples = 511
    assert config.invalid_field() is None
