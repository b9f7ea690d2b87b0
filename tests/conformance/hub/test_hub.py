"""The core's hub against the reference: the same reports, every tap of every frame."""

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import COIN_TOSS_MARGIN, Scoreboard, as_reference
from echofuse.conformance.hub_reference import hub_limits
from echofuse.reference.hub.hub import SensorRadarHub
from echofuse.reference.hub.locate.site import path_m
from echofuse.reference.hub.measure.frame_assembler import SPEED_OF_LIGHT_MPS, Report

PERIOD_US = 100_000
N_FRAMES = 25


def configured(site, core_site, **fields):  # type: ignore[no-untyped-def]
    nodes, area = core_site(site)
    config = _core.SensorRadarHubConfig(**fields)
    tx, rx = site.tx_m.astype(np.float32), site.rx_m.astype(np.float32)
    config.set_nodes([node.node_id for node in nodes], tx, rx)
    config.area = area
    assert config.invalid_field() is None
    hub = _core.SensorRadarHub()
    assert hub.configure(config) == _core.Status.ok
    return hub, SensorRadarHub(as_reference(config), hub_limits(_core.LIMITS)), nodes


def reports(rng, site, k):  # type: ignore[no-untyped-def]
    """Two walking people, missed and false detections, one report lost now and then."""
    people = np.array([[2.0 + 0.12 * k, 2.5], [9.0 - 0.1 * k, 4.0]])
    for node, (tx, rx) in enumerate(zip(site.tx_m, site.rx_m, strict=True)):
        if rng.random() < 0.05:
            continue
        paths = [path_m(z, tx, rx) + 0.06 * rng.standard_normal() for z in people if rng.random() < 0.92]
        paths += list(np.linalg.norm(tx - rx) + 0.5 + 8 * rng.random(rng.poisson(0.5)))
        delay = (np.sort(paths) / SPEED_OF_LIGHT_MPS).astype(np.float32)
        yield node, delay, rng.uniform(5, 20, len(delay)).astype(np.float32)


@pytest.mark.slow
@pytest.mark.parametrize("tracker", ["kalman", "phd"])
def test_every_tap(tracker, site_of, core_site):  # type: ignore[no-untyped-def]
    site, board, compared = site_of("bistatic"), Scoreboard(), 0
    phd = _core.PhdConfig(particles_per_target=150, newborn_per_measurement=32)
    for seed in range(20 if tracker == "kalman" else 5):
        rng = np.random.default_rng(seed)
        # A particle drawn otherwise would come back through the aid by tracks and move the measurements.
        selection = _core.SelectionConfig(track_aided=tracker == "kalman")
        fields = {"tracker": getattr(_core.Tracker, tracker), "phd": phd, "selection": selection}
        hub, reference, nodes = configured(site, core_site, **fields)
        tossed = False
        for k in range(N_FRAMES):
            now = k * PERIOD_US
            for node, delay, weight in reports(rng, site, k):
                node_id = nodes[node].node_id
                assert hub.receive(node_id, k, delay, weight, now) == _core.Status.ok
                wide = delay.astype(np.float64), weight.astype(np.float64)
                assert reference.receive(Report(node_id, k, *wide), now)
            later = now + 90_000
            status, got, taps = hub.poll_with_taps(later)
            expected = reference.poll(later)
            assert expected is not None
            assert status == _core.Status.ok
            assert got[:2] == (expected.time_us, expected.number)
            board.floats(
                tracker,
                "frame",
                f"{seed} {k}",
                taps["frame"][:, 1],
                expected.taps["frame"][:, 1],
                "hub.frame.path",
            )
            tossed = tossed or min(decisive(expected.margins)) < COIN_TOSS_MARGIN
            if tossed:  # from here on both may follow different, equally right decisions
                continue
            compared += 1
            compare_decided(board, tracker, f"{seed} {k}", taps, expected)
        assert hub.counters()["lost"] == reference.assembler.counters.lost
    assert compared > (300 if tracker == "kalman" else 30)
    for row in board.rows():
        assert row.passed, row.failures[:3]


def compare_decided(board, tracker, where, taps, expected):  # type: ignore[no-untyped-def]
    selected = expected.taps["selected"]
    board.decisions(tracker, "nodes", where, taps["selected"][:, 4], selected[:, 4], 1.0)
    board.floats(
        tracker, "selected", where, taps["selected"][:, :2], selected[:, :2], "hub.selection.position"
    )
    points = expected.taps["points"]
    board.decisions(tracker, "members", where, taps["points"][:, 2], points[:, 2], 1.0)
    board.floats(tracker, "points", where, taps["points"][:, :2], points[:, :2], "hub.selection.position")
    tracks = expected.taps["tracks"]
    decided = [0, 1, 6]  # id, state, frames since the last update
    board.decisions(tracker, "track states", where, taps["tracks"][:, decided], tracks[:, decided], 1.0)
    row = "hub.pipeline.tracks" if tracker == "kalman" else "hub.pipeline.phd_tracks"
    board.floats(tracker, "tracks", where, taps["tracks"][:, 2:6], tracks[:, 2:6], row)


def decisive(margins):  # type: ignore[no-untyped-def]
    """Of all decisions but which particle is drawn: among hundreds there is a toss in every frame."""
    return [margin for stage, margin in margins.items() if stage != "resampled"]


def test_impossible_configurations_are_named(site_of, core_site):  # type: ignore[no-untyped-def]
    site = site_of("monostatic")
    nodes, area = core_site(site)
    hub = _core.SensorRadarHub()
    ids = [node.node_id for node in nodes]
    tx = site.tx_m.astype(np.float32)

    def field(n=4, places=tx, **changes):  # type: ignore[no-untyped-def]
        config = _core.SensorRadarHubConfig(**changes)
        config.set_nodes(ids[:n], places[:n], places[:n])
        if "area" not in changes:
            config.area = area
        named = config.invalid_field()
        assert (hub.configure(config) == _core.Status.ok) == (named is None)
        return named

    together, line = tx.copy(), tx.copy()
    together[1] = together[0]
    line[:, 1] = 2.0
    assert field() is None
    assert field(n=2) == "n_nodes"
    assert field(places=together) == "nodes"
    assert field(places=line * np.array([[1, 1], [0.5, 1], [0.7, 1], [0.2, 1]], np.float32)) == "nodes"
    assert field(area=_core.Area()) == "area"
    assert field(frame_period_s=float("nan")) == "frame_period_s"
    assert field(selection=_core.SelectionConfig(nodes_per_tuple=5)) == "selection"
    assert field(point_clusters=_core.PointClusterConfig(threshold_m=0.0)) == "point_clusters"
    assert field(frame_assembler=_core.FrameAssemblerConfig(deadline_us=0)) == "frame_assembler"
