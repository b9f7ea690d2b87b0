"""Synthetic sites and frames for the hub's conformance tests."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from echofuse import _core
from echofuse.reference.hub.locate.site import Site, path_m


def make_site(kind: str) -> Site:
    """The case study's geometry, four monostatic nodes at the corners of a room, or both kinds mixed."""
    corners = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    if kind == "monostatic":
        return Site(corners, corners, np.array([0.0, 0.0, 4.0, 4.0]))
    rx = np.array([[0.0, 1.5], [0.0, 4.5], [3.5, 6.0], [8.0, 6.0], [11.5, 4.5], [11.5, 1.5]])
    tx = np.repeat([[5.75, 0.0]], 6, axis=0)
    if kind == "mixed":
        tx[::2] = rx[::2]
    return Site(tx, rx, np.array([0.0, 0.0, 11.5, 6.0]))


def to_core(site: Site) -> tuple[list[_core.NodeSite], _core.Area]:
    def point(z: NDArray[np.float64]) -> _core.Point:
        return _core.Point(x_m=float(z[0]), y_m=float(z[1]))

    nodes = [
        _core.NodeSite(node_id=i, tx=point(tx), rx=point(rx))
        for i, (tx, rx) in enumerate(zip(site.tx_m, site.rx_m, strict=True))
    ]
    a = [float(value) for value in site.area_m]
    return nodes, _core.Area(min_x_m=a[0], min_y_m=a[1], max_x_m=a[2], max_y_m=a[3])


def make_frame(
    rng: np.random.Generator, site: Site, n_people: int, n_false: float = 1.0, sigma_m: float = 0.08
) -> tuple[NDArray[np.int32], NDArray[np.float32], NDArray[np.float32], NDArray[np.float64]]:
    """(node_index, path_m, weight) as a frame holds them, and the people's positions (n_people, 2)."""
    low, high = site.area_m[:2] + 0.5, site.area_m[2:] - 0.5
    people = low + rng.random((n_people, 2)) * (high - low)
    rows = []
    for node, (tx, rx) in enumerate(zip(site.tx_m, site.rx_m, strict=True)):
        for z in people:
            if rng.random() < 0.9:
                rows.append(
                    (node, path_m(z, tx, rx) + sigma_m * rng.standard_normal(), 15 + 5 * rng.random())
                )
        base = np.linalg.norm(tx - rx)
        rows += [
            (node, base + 0.5 + 8 * rng.random(), 4 + 8 * rng.random()) for _ in range(rng.poisson(n_false))
        ]
    rows.sort()
    node_index, path, weight = zip(*rows, strict=True) if rows else ((), (), ())
    return np.array(node_index, np.int32), np.array(path, np.float32), np.array(weight, np.float32), people


@pytest.fixture
def site_of() -> Callable[[str], Site]:
    return make_site


@pytest.fixture
def core_site() -> Callable[[Site], Any]:
    return to_core


@pytest.fixture
def frame_of() -> Callable[..., Any]:
    return make_frame
