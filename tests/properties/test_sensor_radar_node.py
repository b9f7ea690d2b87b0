"""The node: delays, background, timing errors, shadowing, bad input, counters."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from echofuse import _core

C = 299792458.0
FS = 16.384e9
#: How much later than its peak says an echo is timed: both edges precede their peaks, but the stronger direct
#: path's, over the noise, by 16 samples, and the echo's, over the detector's threshold, by 4 to 14.
EDGE_S = 7.0 / FS
EDGE_SPREAD_S = 7.0 / FS
Scan = NDArray[np.float32]


def pulse(n_samples: int, place: float, fs: float) -> NDArray[np.float64]:
    x = (np.arange(n_samples) - place) / fs
    return np.exp(-0.5 * (x / 0.3e-9) ** 2) * np.cos(2.0 * np.pi * 4.3e9 * x)


def scan_of(
    rng: np.random.Generator,
    *,
    person: float | None,
    late: float = 0.0,
    direct_path: float = 3000.0,
    fs: float = FS,
    n_samples: int = 1000,
    start: float = 400.0,
) -> Scan:
    """(n_samples,) direct path at sample `start`, two walls, a person's echo at sample `person` [count]."""
    scan = rng.normal(0.0, 4.0, n_samples)
    for place, gain in ((start, direct_path), (start + 150.0, 900.0), (start + 330.0, -700.0)):
        scan += gain * pulse(n_samples, place + late, fs)
    if person is not None:
        scan += 250.0 * pulse(n_samples, person + late, fs) + 120.0 * pulse(
            n_samples, person + 14.0 + late, fs
        )
    return scan.astype(np.float32)


def node_of(**fields: Any) -> _core.SensorRadarNode:
    config = _core.SensorRadarNodeConfig(**({"n_samples": 1000, "baseline_m": 6.0} | fields))
    core = _core.SensorRadarNode()
    assert core.configure(config) == _core.Status.ok
    return core


@settings(max_examples=30)
@given(
    person=st.one_of(st.floats(600.0, 680.0), st.floats(790.0, 900.0)),
    late=st.floats(-5.0, 5.0),
    seed=st.integers(0, 1000),
)
def test_the_delay_of_a_person_is_absolute(person: float, late: float, seed: int) -> None:
    """Leading edges precede peaks by some samples, for the direct path and the echo alike."""
    rng = np.random.default_rng(seed)
    core = node_of()
    for _ in range(10):
        assert core.set_empty_room(scan_of(rng, person=None)) == _core.Status.ok
    status, detections = core.process(scan_of(rng, person=person, late=late), 0)
    expected = 6.0 / C + (person - 400.0) / FS
    assert status == _core.Status.ok
    assert np.min(np.abs(detections["delay_s"] - expected - EDGE_S)) < EDGE_SPREAD_S


def test_the_empty_room_stays_nearly_silent_and_the_person_is_the_heaviest() -> None:
    rng, core = np.random.default_rng(1), node_of()
    core_floor = _core.SensorRadarNodeConfig(n_samples=1000, baseline_m=6.0)
    core_floor.noise_floor.factor = 16.0
    assert core.configure(core_floor) == _core.Status.ok
    for _ in range(20):
        assert core.set_empty_room(scan_of(rng, person=None, late=rng.normal(0, 1.0))) == _core.Status.ok
    alarms = sum(
        len(core.process(scan_of(rng, person=None, late=rng.normal(0, 1.0)), t)[1]) for t in range(50)
    )
    assert alarms <= 1
    for t in range(50):
        _, detections = core.process(scan_of(rng, person=700.0, late=rng.normal(0, 1.0)), t)
        heaviest = detections[np.argmax(detections["weight"])]
        assert heaviest["delay_s"] == pytest.approx(6.0 / C + 300.0 / FS + EDGE_S, abs=EDGE_SPREAD_S)


@pytest.mark.parametrize("method", ["empty_room_envelope", "empty_room_scan", "exponential_average"])
def test_a_background_is_learnt_where_none_is_given(method: str) -> None:
    rng = np.random.default_rng(2)
    config = _core.SensorRadarNodeConfig(n_samples=1000, baseline_m=6.0)
    config.clutter.method = getattr(_core.ClutterMethod, method)
    config.clutter.learning_scans = 6
    core = _core.SensorRadarNode()
    assert core.configure(config) == _core.Status.ok
    for t in range(6):
        assert not core.ready()
        status, detections = core.process(scan_of(rng, person=None), t)
        assert (status, len(detections)) == (_core.Status.ok, 0)
    assert core.ready()
    assert core.counters()["learning_scans"] == 6
    _, detections = core.process(scan_of(rng, person=700.0), 6)
    assert np.min(np.abs(detections["delay_s"] - 6.0 / C - 300.0 / FS - EDGE_S)) < EDGE_SPREAD_S
    core.reset()
    assert not core.ready()
    assert len(core.process(scan_of(rng, person=700.0), 7)[1]) == 0


@pytest.mark.parametrize("step", [0.0, 25.0])
def test_a_shadowed_direct_path_does_not_tear_the_alignment(step: float) -> None:
    """A person in its way hides the direct path; a clock that steps moves everything. Both are told apart."""
    rng, core = np.random.default_rng(3), node_of()
    for _ in range(10):
        assert core.set_empty_room(scan_of(rng, person=None)) == _core.Status.ok
    _, _, taps = core.process_with_taps(scan_of(rng, person=700.0, late=2.3), 0)
    assert taps["alignment"][0] == pytest.approx(2.3, abs=0.1)
    shadowed = scan_of(rng, person=700.0, late=2.3 + step, direct_path=60.0 if step == 0.0 else 3000.0)
    _, detections, taps = core.process_with_taps(shadowed, 1)
    assert taps["alignment"][0] == pytest.approx(2.3 + step, abs=0.15)
    assert np.min(np.abs(detections["delay_s"] - 6.0 / C - 300.0 / FS - EDGE_S)) < EDGE_SPREAD_S
    assert core.counters()["alignment_doubts"] == 1


def test_monostatic_node_with_another_rate_and_length() -> None:
    """10 GHz, 600 samples, sample 0 at 8 ns: nothing of the case study is built in."""
    rng, fs = np.random.default_rng(4), 10e9
    core = node_of(
        n_samples=600,
        sample_rate_hz=fs,
        first_sample_s=8e-9,
        baseline_m=0.0,
        time_zero=_core.TimeZero.recorded,
        delay_offset_s=-0.5e-9,
    )
    kwargs: dict[str, Any] = {"fs": fs, "n_samples": 600, "start": 100.0}
    for _ in range(10):
        assert core.set_empty_room(scan_of(rng, person=None, **kwargs)) == _core.Status.ok
    _, detections = core.process(scan_of(rng, person=350.0, **kwargs), 0)
    assert np.min(np.abs(detections["delay_s"] - (8e-9 + 350.0 / fs - 0.5e-9))) < 8.0 / fs
    assert core.counters()["direct_path_missing"] == 0


def test_nothing_is_reported_from_the_blind_zone() -> None:
    rng = np.random.default_rng(5)
    core = node_of(blind_zone_s=8e-9)
    for _ in range(10):
        assert core.set_empty_room(scan_of(rng, person=None)) == _core.Status.ok
    _, detections, taps = core.process_with_taps(scan_of(rng, person=480.0), 0)
    assert not np.any(detections["delay_s"] < 6.0 / C + 8e-9)
    assert np.all(taps["decisions"][:510] == 0.0)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e20])
def test_unusable_scans_change_nothing(bad: float) -> None:
    first, second = node_of(), node_of()
    for core in (first, second):
        rng = np.random.default_rng(6)
        for _ in range(5):
            assert core.set_empty_room(scan_of(rng, person=None)) == _core.Status.ok
    broken = scan_of(np.random.default_rng(7), person=700.0)
    broken[123] = bad
    status, detections = first.process(broken, 0)
    assert (status, len(detections)) == (_core.Status.invalid_input, 0)
    assert first.set_empty_room(broken) == _core.Status.invalid_input
    assert first.process(broken[:999], 0)[0] == _core.Status.invalid_input
    assert first.process(np.zeros(0, np.float32), 0)[0] == _core.Status.invalid_input
    assert first.counters()["rejected_scans"] == 4
    good = scan_of(np.random.default_rng(8), person=700.0)
    assert np.array_equal(first.process(good, 1)[1], second.process(good, 1)[1])


def test_taps_do_not_change_the_report_and_float64_is_refused() -> None:
    rng = np.random.default_rng(9)
    first, second = node_of(), node_of()
    for t in range(30):
        scan = scan_of(rng, person=700.0 if t > 22 else None)
        plain, tapped = first.process(scan, t), second.process_with_taps(scan, t)
        assert np.array_equal(plain[1], tapped[1])
        assert np.array_equal(tapped[2]["detections"][:, 0], plain[1]["delay_s"])
    with pytest.raises(TypeError):
        first.process(scan.astype(np.float64), 0)


def test_pulses_are_integrated_before_anything_is_reported() -> None:
    rng = np.random.default_rng(10)
    config = _core.SensorRadarNodeConfig(n_samples=1000, baseline_m=6.0)
    config.pulse_integrator.pulses_per_scan = 4
    core = _core.SensorRadarNode()
    assert core.configure(config) == _core.Status.ok
    ready = [core.process(scan_of(rng, person=None), t) and core.report_ready() for t in range(8)]
    assert ready == [False, False, False, True] * 2
    assert core.counters()["scans"] == 2


def test_impossible_configurations_are_named() -> None:
    core = _core.SensorRadarNode()
    assert core.process(np.ones(1920, np.float32), 0)[0] == _core.Status.not_configured
    for field, value in (
        ("node_id", -1),
        ("n_samples", 1921),
        ("n_samples", 1),
        ("sample_rate_hz", float("nan")),
        ("first_sample_s", float("inf")),
        ("baseline_m", -1.0),
        ("blind_zone_s", float("nan")),
        ("delay_offset_s", 5.0),
    ):
        config = _core.SensorRadarNodeConfig(**{field: value})
        assert config.invalid_field() == field
        assert core.configure(config) == _core.Status.invalid_config
    lag = _core.SensorRadarNodeConfig()
    lag.clutter.method = _core.ClutterMethod.frame_difference
    lag.clutter.difference_lag_scans = 4  # of 1,920 samples: more than the memory holds
    assert lag.invalid_field() == "clutter.difference_lag_scans"
    lag.n_samples = 480
    assert lag.invalid_field() is None
    lag.cfar.buffer_samples = 0
    assert lag.invalid_field() == "cfar"
