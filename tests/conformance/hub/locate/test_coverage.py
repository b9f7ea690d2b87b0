"""The core's coverage against the reference, and the paper's own numbers."""

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.reference.hub.locate import coverage as reference

CONFIGS = [
    {},
    {"path_loss_exponent": 2.4, "frequency_exponent": 0.8, "excess_path_loss_1m_db": 2.0, "min_snr_db": 10.0},
    {
        "min_snr_db": 42.0,
        "body_radius_m": 0.2,
        "bandwidth_hz": 5e8,
        "pulses_per_scan": 100,
        "antenna_gain_db": 6.0,
    },
]


@pytest.mark.parametrize("overrides", CONFIGS)
@pytest.mark.parametrize("kind", ["bistatic", "monostatic", "mixed"])
def test_coverage(kind, overrides, site_of, core_site):  # type: ignore[no-untyped-def]
    board, site = Scoreboard(), site_of(kind)
    config = _core.CoverageConfig(**overrides)
    stage = _core.Coverage()
    assert stage.configure(config, *core_site(site)) == _core.Status.ok
    plain = as_reference(config)
    np.testing.assert_allclose(stage.bistatic_constant, reference.bistatic_constant(plain), rtol=2e-4)
    rng = np.random.default_rng(5)
    places = (site.area_m[:2] + rng.random((40, 2)) * (site.area_m[2:] - site.area_m[:2])).astype(np.float32)
    status, got = stage.process(places)
    assert status == _core.Status.ok
    for i, place in enumerate(places.astype(np.float64)):
        expected = reference.coverage(plain, site, place)
        if expected.margin < 1e-3:  # [dB] or [m]
            continue
        assert (got["n_covering"][i], got["n_blind"][i]) == (expected.n_covering, expected.n_blind)
        snr = [got["best_snr_db"][i], got["third_snr_db"][i]]
        board.floats(
            kind, "SNR", str(i), snr, [expected.best_snr_db, expected.third_snr_db], "hub.coverage.snr_db"
        )
        bound = got["position_error_bound_m"][i]
        if np.isfinite(expected.position_error_bound_m):
            board.floats(
                kind, "bound", str(i), [bound], [expected.position_error_bound_m], "hub.coverage.bound"
            )
        else:
            assert np.isinf(bound)
    for row in board.rows():
        assert row.passed, row.failures[:3]


@pytest.mark.parametrize("module", [_core, reference])
def test_figure_3_and_4(module):  # type: ignore[no-untyped-def]
    """Fig. 3's four SNRs for chi = 5 l^4, and Fig. 4's two times of arrival for l / 2 = 1 m."""
    baseline = 2.0
    chi = 5 * baseline**4
    for ratio, paper_db in ((0.75, 24.0), (1.0, 19.0), (1.25, 15.2), (1.6, 10.9)):
        leg = ratio * baseline / 2  # both legs alike
        value_db = 10 * np.log10(module.snr(chi, leg, leg))
        assert value_db == pytest.approx(paper_db, abs=0.051)
        assert module.cassini_ratio(leg, leg, baseline) == pytest.approx(ratio)
    exact = [24.03, 19.03, 15.15, 10.87]
    got = [10 * np.log10(module.snr(chi, r * baseline / 2, r * baseline / 2)) for r in (0.75, 1.0, 1.25, 1.6)]
    np.testing.assert_allclose(got, exact, atol=0.006)
    assert module.time_of_arrival_s(2.0, 2.0) == pytest.approx(13.34e-9, abs=0.005e-9)
    assert module.time_of_arrival_s(3.2, 3.2) == pytest.approx(21.35e-9, abs=0.005e-9)


def test_relations_agree():  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(7)
    for _ in range(100):
        total, baseline, chi = 3 + 5 * rng.random(), 2.5 * rng.random(), 10 ** (4 * rng.random())
        angle = rng.random() * 2 * np.arcsin(baseline / total)
        for name, arguments in (
            ("leg_product_m2", (total, baseline, angle)),
            ("snr_on_ellipse", (chi, total, baseline, angle)),
            ("sum_on_cassini_m", (chi, 10.0, baseline, angle)),
            ("max_leg_product_m2", (chi, 10.0)),
        ):
            assert getattr(_core, name)(*arguments) == pytest.approx(
                getattr(reference, name)(*arguments), rel=2e-6
            )
