"""The real recording, where it is there."""

import os
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray


@pytest.fixture(scope="session")
def real_walk() -> NDArray[np.float32]:
    """Scans 100 to 220 of one node of the real walk, (n_scans, n_samples) [count]."""
    loadmat = pytest.importorskip("scipy.io").loadmat
    root = Path(os.environ.get("ECHOFUSE_DATA", Path(__file__).parents[4] / "shared" / "data"))
    path = root / "p410-triangle" / "101_P1.mat"
    if not path.exists():
        pytest.skip("the real recording is not here; set ECHOFUSE_DATA to its folder")
    records = loadmat(path, squeeze_me=True, struct_as_record=False)["scn"].flat
    return np.stack([np.asarray(record.scn, np.float32) for record in list(records)[100:220]])
