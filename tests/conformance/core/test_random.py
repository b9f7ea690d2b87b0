"""The core's random numbers against the reference's, and against their definition."""

from statistics import NormalDist

import numpy as np
import pytest

from echofuse import _core
from echofuse.reference.core.random import Pcg32, inverse_normal

PUBLISHED = [0xA15C02B7, 0x7B47F409, 0xBA1D3330, 0x83D2F293, 0xBFA4784B, 0xCBED606E]
SEEDS = [(0, 0), (1, 1), (42, 54), (2**64 - 1, 2**63 - 1), (2**63, 2**62 + 3)]


@pytest.mark.parametrize("make", [_core.Pcg32, Pcg32])
def test_published_stream(make: type[Pcg32]) -> None:
    random = make(42, 54)
    assert [random.next_u32() for _ in PUBLISHED] == PUBLISHED


@pytest.mark.parametrize(("seed", "stream"), SEEDS)
def test_same_stream_however_it_is_cut(seed: int, stream: int) -> None:
    target, reference, one_by_one = _core.Pcg32(seed, stream), Pcg32(seed, stream), Pcg32(seed, stream)
    for n in (0, 1, 2, 3, 64, 1000):
        expected = reference.uniforms(n)
        assert np.array_equal(target.uniforms(n), expected)
        assert [one_by_one.uniform() for _ in range(n)] == expected.tolist()
    assert target.next_u32() == reference.next_u32() == one_by_one.next_u32()


@pytest.mark.parametrize(("seed", "stream"), SEEDS)
def test_normals_agree(seed: int, stream: int) -> None:
    target, reference = _core.Pcg32(seed, stream).normals(100_000), Pcg32(seed, stream).normals(100_000)
    # float32 carries 24 bits, and the core's polynomials are good for seven digits
    assert np.max(np.abs(target - reference) / np.maximum(1.0, np.abs(reference))) < 1e-6


def test_reference_is_the_inverse_normal_distribution() -> None:
    steps = np.concatenate([np.arange(2000), np.arange(0, 2**24, 9973), 2**24 - 1 - np.arange(2000)])
    exact = [NormalDist().inv_cdf((step + 0.5) / 2**24) for step in steps.tolist()]
    assert inverse_normal((steps + 0.5) / 2**24 - 0.5) == pytest.approx(exact, rel=1e-13, abs=1e-13)
