"""Many paths into one spectrum, fast: band-limited synthesis at exact delays."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Spectrum = NDArray[np.complex128]


def path_spectrum(
    delay_s: NDArray[np.float64],
    gain: NDArray[np.float64],
    *,
    first_bin: int,
    n_bins: int,
    bin_spacing_hz: float,
) -> Spectrum:
    """Sum over paths (n,) of gain exp(-j 2 pi f delay) at f = (first_bin + k) bin_spacing_hz -> (n_bins,)."""
    step = math.ceil(math.sqrt(n_bins))  # the grid as step * a + b, so that phases factor
    # exp(-j 2 pi (first + step a + b) df tau) = (a part) (b part): two small tables, one matrix product.
    turn = -2j * np.pi * delay_s * bin_spacing_hz
    coarse = _powers(np.exp(step * turn), step)
    coarse *= np.exp(first_bin * turn) * gain
    return np.asarray((coarse @ _powers(np.exp(turn), step).T).ravel()[:n_bins])


def _powers(base: Spectrum, count: int) -> Spectrum:
    """(count, n): base^0 to base^(count - 1), for |base| = 1."""
    table = np.empty((count, len(base)), dtype=np.complex128)
    table[0] = 1.0
    done, step = 1, base
    while done < count:
        more = min(done, count - done)
        table[done : done + more] = table[:more] * step
        done, step = done + more, step * step
    return table
