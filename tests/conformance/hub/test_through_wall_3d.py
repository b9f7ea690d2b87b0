"""The hub behind a cross names what is impossible; its taps are compared in test_stairs.py."""

import numpy as np
import pytest

from echofuse import _core

TX_M, ARM_M = np.array([0.3, -0.1, 1.2]), 0.39
ARMS_M = ARM_M * np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
LEAST_M, MOST_M = np.array([-2.3, 0.4, -0.5]), np.array([2.9, 7.0, 3.5])
IDS = [11, 12, 13, 14]


def a_config():  # type: ignore[no-untyped-def]
    config = _core.ThroughWall3dHubConfig()
    tx = np.tile(TX_M, (4, 1)).astype(np.float32)
    config.set_nodes(IDS, tx, (TX_M + ARMS_M).astype(np.float32))
    config.set_area(*map(float, LEAST_M), *map(float, MOST_M))
    assert config.invalid_field() is None
    return config


def test_impossible_configurations_are_named():  # type: ignore[no-untyped-def]
    tx = np.tile(TX_M, (4, 1)).astype(np.float32)
    config = a_config()
    config.set_nodes(IDS[:3], tx[:3], tx[:3])
    assert config.invalid_field() == "n_nodes"
    config = a_config()
    bent = (TX_M + ARMS_M + [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.05, 0.0]]).astype(
        np.float32
    )
    config.set_nodes(IDS, tx, bent)
    assert config.invalid_field() == "nodes"
    config = a_config()
    config.set_area(-2.0, -1.0, 0.0, 2.0, 6.0, 3.0)
    assert config.invalid_field() == "area"
    assert _core.ThroughWall3dHub().configure(config) == _core.Status.invalid_config
    with pytest.raises(ValueError, match="at most 4"):
        config.set_nodes([*IDS, 15], np.tile(tx[:1], (5, 1)), np.tile(tx[:1], (5, 1)))
