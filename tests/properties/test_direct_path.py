"""Direct-path search: accuracy over noise, early detections, bad input."""

import numpy as np
import pytest
from numpy.typing import NDArray

from echofuse import _core

FS = 16.384e9
ARRIVAL = 420.0


def scans(noise: float, n_scans: int, seed: int) -> list[NDArray[np.float32]]:
    """Envelopes (1200,) of a pulse at ARRIVAL and 60 multipaths behind it, in noise."""
    rng = np.random.default_rng(seed)
    k = np.arange(1200)
    clean = np.exp(-0.5 * ((k - ARRIVAL) / 4.5) ** 2) * np.cos(2 * np.pi * 0.262 * (k - ARRIVAL))
    for place, gain in zip(rng.uniform(450, 1150, 60), rng.normal(0, 0.12, 60), strict=True):
        clean += gain * np.exp(-0.5 * ((k - place) / 4.5) ** 2) * np.cos(2 * np.pi * 0.262 * (k - place))
    core = _core.Envelope()
    assert core.configure(_core.EnvelopeConfig(), FS) == _core.Status.ok
    noisy = [(clean + rng.normal(0.0, noise, 1200)).astype(np.float32) for _ in range(n_scans)]
    return [np.asarray(core.process(scan)[1]) for scan in noisy]


def spread(search: str, noise: float, n_scans: int = 300) -> tuple[float, float]:
    """Standard deviation of the time of arrival, and the share of early detections (over 30 samples)."""
    core = _core.DirectPathSearcher()
    config = _core.DirectPathConfig(search=getattr(_core.DirectPathSearch, search))
    assert core.configure(config) == _core.Status.ok
    found = [core.process(envelope)[1] for envelope in scans(noise, n_scans, 5)]
    assert all(direct_path.found for direct_path in found)
    toa = np.array([direct_path.toa_samples for direct_path in found])
    return float(np.std(toa)), float(np.mean(toa < ARRIVAL - 30.0))


def test_threshold_is_the_published_one() -> None:
    """algorithms.md 6.3: N_n = 300, P_ed = 0.01 -> 4.54 sigma."""
    core = _core.DirectPathSearcher()
    assert core.configure(_core.DirectPathConfig()) == _core.Status.ok
    assert core.threshold_factor() == pytest.approx(4.54, abs=0.005)


SEARCHES = ("threshold_crossing", "jump_back_search_forward", "serial_backward")


def test_searches_are_alike_in_moderate_noise() -> None:
    """algorithms.md 6.3: 0.64, 0.64, 0.61 samples."""
    deviations = [spread(search, 0.02) for search in SEARCHES]
    # an early detection in one scan of a hundred is the plain threshold's design
    assert all(deviation < 0.8 for deviation, early in deviations if early == 0.0)
    assert deviations[2][0] < 0.8


def test_serial_backward_search_is_the_robust_one_in_noise() -> None:
    """algorithms.md 6.3, at three times the noise: 17, 3.0 and 0.8 samples, early detections 1 %."""
    (plain, early), (jump_back, _), (backward, never) = (spread(search, 0.06) for search in SEARCHES)
    assert backward < 1.0
    assert backward <= jump_back < plain
    assert plain > 5.0
    assert 0.002 < early < 0.03
    assert never == 0.0


def test_nothing_is_found_without_noise_samples_or_peak() -> None:
    core = _core.DirectPathSearcher()
    assert core.configure(_core.DirectPathConfig()) == _core.Status.ok
    envelope = np.ones(500, np.float32)
    envelope[20] = 9.0
    status, direct_path = core.process(envelope)  # no noise before the window
    assert (status, direct_path.found, direct_path.toa_samples) == (_core.Status.ok, False, 0.0)
    envelope[20], envelope[400] = 1.0, 2.0  # a peak, but within the noise
    status, direct_path = core.process(envelope)
    assert (status, direct_path.found, direct_path.peak_sample) == (_core.Status.ok, False, 400)


def test_the_crossing_is_interpolated() -> None:
    core = _core.DirectPathSearcher()
    assert core.configure(_core.DirectPathConfig(noise_samples=100)) == _core.Status.ok
    envelope = np.ones(400, np.float32)
    envelope[200:205] = (1.0, 4.0, 9.0, 20.0, 9.0)
    _, direct_path = core.process(envelope)
    threshold = core.threshold_factor() * np.sqrt(0.5)
    assert direct_path.threshold == pytest.approx(threshold, rel=1e-6)
    assert 1.0 < threshold < 4.0
    assert direct_path.toa_samples == pytest.approx(200.0 + (threshold - 1.0) / 3.0, abs=1e-4)


def test_bad_input() -> None:
    core = _core.DirectPathSearcher()
    assert core.process(np.ones(5, np.float32))[0] == _core.Status.not_configured
    for field, value in (
        ("noise_samples", 7),
        ("early_detection_probability", 0.0),
        ("early_detection_probability", float("nan")),
        ("window_samples", 0),
    ):
        config = _core.DirectPathConfig(**{field: value})
        assert config.invalid_field() == field
        assert core.configure(config) == _core.Status.invalid_config
    assert core.configure(_core.DirectPathConfig()) == _core.Status.ok
    assert core.process(np.zeros(0, np.float32))[0] == _core.Status.invalid_input
