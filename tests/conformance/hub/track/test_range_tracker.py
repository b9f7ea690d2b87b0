"""The core's range tracker against the reference: the same detections, every track of every frame."""

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import as_reference
from echofuse.reference.hub.locate.site import path_m
from echofuse.reference.hub.track.range_tracker import RangeTracker

N_FRAMES = 16
UNCLEAR = 1e-4  # [m] or [1]: a decision nearer than this to flipping may flip by rounding
COLUMNS = ("x_m", "y_m", "vx_mps", "vy_mps", "covariance_xx_m2", "covariance_xy_m2", "covariance_yy_m2")


def detections(rng, site, k):  # type: ignore[no-untyped-def]
    """(node_index, path_m) of two walking people who cross, with misses, echoes behind them and clutter."""
    people = np.array([[2.0 + 0.12 * k, 2.5], [6.5 - 0.1 * k, 3.2]])
    node_index, paths = [], []
    for node, (tx, rx) in enumerate(zip(site.tx_m, site.rx_m, strict=True)):
        found = [path_m(z, tx, rx, 0.18) + 0.06 * rng.standard_normal() for z in people if rng.random() < 0.8]
        found += [path + rng.uniform(0.3, 3.0) for path in found if rng.random() < 0.4]
        found += list(np.linalg.norm(tx - rx) + 0.5 + 8.0 * rng.random(rng.poisson(0.7)))
        node_index += [node] * len(found)
        paths += sorted(found)
    return np.array(node_index, np.int32), np.array(paths, np.float32)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["bistatic", "mixed"])
def test_tracks(kind, site_of, core_site):  # type: ignore[no-untyped-def]
    site, compared, confirmed = site_of(kind), 0, 0
    nodes, area = core_site(site)
    config = _core.RangeTrackerConfig(
        birth_step_m=0.8,
        max_births=6,
        window_frames=6,
        newcomer_cost=10.0,
        lasting_score=15.0,
        visible_path_m=-0.05,
        nearest_path_m=0.1,
    )
    for seed in range(20):
        core = _core.RangeTracker()
        assert core.configure(config, 0.18, nodes, area) == _core.Status.ok
        reference = RangeTracker(as_reference(config), 0.18, site, _core.LIMITS["max_tracks"])
        rng = np.random.default_rng(seed)
        for k in range(N_FRAMES):
            node_index, paths = detections(rng, site, k)
            status, got = core.process(node_index, paths, 0.1)
            assert status in (_core.Status.ok, _core.Status.truncated)
            expected, margin = reference.process(node_index, paths.astype(np.float64), 0.1)
            if margin < UNCLEAR:
                break  # from here on the two may rightly differ
            assert list(got["id"]) == [track.id for track in expected]
            assert [bool(s) for s in got["state"]] == [track.confirmed for track in expected]
            assert list(got["frames_since_update"]) == [track.frames_since_update for track in expected]
            for row, track in zip(got, expected, strict=True):
                p = track.filter.covariance
                wanted = [*track.position_m, *track.velocity_mps, p[0, 0], p[0, 2], p[2, 2]]
                assert np.allclose([row[name] for name in COLUMNS], wanted, rtol=1e-3, atol=1e-3)
            compared += 1
            confirmed += sum(track.confirmed for track in expected)
    assert compared > 100
    assert confirmed > 50


def test_refuses_what_is_no_frame(site_of, core_site):  # type: ignore[no-untyped-def]
    nodes, area = core_site(site_of("bistatic"))
    core = _core.RangeTracker()
    one = np.array([0], np.int32), np.array([8.0], np.float32)
    assert core.process(*one, 0.1)[0] == _core.Status.not_configured
    assert core.configure(_core.RangeTrackerConfig(), 0.18, nodes, area) == _core.Status.ok
    assert core.process(*one, 0.0)[0] == _core.Status.invalid_input
    unordered = np.array([1, 0], np.int32), np.array([8.0, 8.0], np.float32)
    assert core.process(*unordered, 0.1)[0] == _core.Status.invalid_input
    assert core.process(one[0], np.array([np.nan], np.float32), 0.1)[0] == _core.Status.invalid_input
    assert core.process(*one, 0.1)[0] == _core.Status.ok
    worse = _core.RangeTrackerConfig(path_std_m=float("nan"))
    assert core.configure(worse, 0.18, nodes, area) == _core.Status.invalid_config
