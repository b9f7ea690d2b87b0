"""Envelope: core against reference, every method."""

import numpy as np
import pytest

from echofuse import _core
from echofuse.conformance.comparison import Scoreboard, as_reference
from echofuse.reference.signal.envelope import envelope

SEEDS = range(20)
SAMPLE_RATE_HZ = 16.384e9


@pytest.mark.parametrize(
    ("method", "tolerance"),
    [("hilbert", "signal.envelope"), ("square_low_pass", "signal.envelope.low_pass")],
)
@pytest.mark.parametrize("half_length", [1, 4, 15, 40])
def test_envelope(method: str, tolerance: str, half_length: int) -> None:
    config = _core.EnvelopeConfig(
        method=getattr(_core.EnvelopeMethod, method),
        hilbert_half_length_samples=half_length,
        low_pass_half_length_samples=half_length,
    )
    core = _core.Envelope()
    assert core.configure(config, SAMPLE_RATE_HZ) == _core.Status.ok
    board = Scoreboard()
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        scan = rng.normal(0.0, 100.0, rng.integers(1, 400)).astype(np.float32)
        for _ in range(2):  # no state
            status, got = core.process(scan)
            assert status == _core.Status.ok
            expected = envelope(scan.astype(np.float64), SAMPLE_RATE_HZ, as_reference(config))
            board.floats(method, "envelope", f"seed {seed}", got, expected, tolerance)
    assert [row.failures for row in board.rows()] == [[]]
