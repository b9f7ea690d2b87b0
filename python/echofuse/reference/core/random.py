"""PCG-XSH-RR 64/32 (O'Neill, HMC-CS-2014-0905, 2014), the one source of randomness.

Every number takes exactly one 32-bit draw. The stream is that of ``echofuse::Pcg32``: draws and uniforms
to the last bit, normals as the inverse normal distribution in float64.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_MULTIPLIER = 6364136223846793005
_MASK = (1 << 64) - 1

# Wichura, Applied Statistics 37 (1988), AS 241, PPND16: numerator and denominator, highest power first.
_CENTRE = (
    (2509.0809287301226727, 33430.575583588128105, 67265.770927008700853, 45921.953931549871457,
     13731.693765509461125, 1971.5909503065514427, 133.14166789178437745, 3.3871328727963666080),
    (5226.4952788528545610, 28729.085735721942674, 39307.895800092710610, 21213.794301586595867,
     5394.1960214247511077, 687.18700749205790830, 42.313330701600911252, 1.0),
)  # fmt: skip
_TAIL = (
    (7.74545014278341407640e-4, 0.0227238449892691845833, 0.241780725177450611770, 1.27045825245236838258,
     3.64784832476320460504, 5.76949722146069140550, 4.63033784615654529590, 1.42343711074968357734),
    (1.05075007164441684324e-9, 5.47593808499534494600e-4, 0.0151986665636164571966, 0.148103976427480074590,
     0.689767334985100004550, 1.67638483018380384940, 2.05319162663775882187, 1.0),
)  # fmt: skip


class Pcg32:
    """Scalar draws one by one, or the next ``n`` of the same stream at once."""

    def __init__(self, seed: int = 0, stream: int = 0) -> None:
        self._increment = ((stream << 1) | 1) & _MASK
        self._state = 0
        self.next_u32()
        self._state = (self._state + seed) & _MASK
        self.next_u32()

    def next_u32(self) -> int:
        """Draw 32 bits."""
        return int(self.draws(1)[0])

    def uniform(self) -> float:
        """Draw from [0, 1)."""
        return float(self.uniforms(1)[0])

    def normal(self) -> float:
        """Draw a standard normal."""
        return float(self.normals(1)[0])

    def draws(self, n: int) -> NDArray[np.uint32]:
        """Draw 32 bits n times, (n,)."""
        states = self._advance(n)
        xorshifted = (((states >> np.uint64(18)) ^ states) >> np.uint64(27)).astype(np.uint32)
        rotation = (states >> np.uint64(59)).astype(np.uint32)
        left = (np.uint32(32) - rotation) & np.uint32(31)
        return (xorshifted >> rotation) | (xorshifted << left)

    def uniforms(self, n: int) -> NDArray[np.float64]:
        """Draw from [0, 1) n times, (n,): multiples of 2^-24, exact in float32 as well."""
        return (self.draws(n) >> np.uint32(8)).astype(np.float64) * 2.0**-24

    def normals(self, n: int) -> NDArray[np.float64]:
        """Draw n standard normals, (n,): the inverse distribution in the middles of 2^24 equal steps."""
        steps = (self.draws(n) >> np.uint32(8)).astype(np.float64)
        return inverse_normal((steps - 2.0**23 + 0.5) * 2.0**-24)

    def _advance(self, n: int) -> NDArray[np.uint64]:
        """Leave the states before each of the next n draws, (n,), and move on.

        State i is multipliers[i] * state + offsets[i]; each pass doubles how many are known.
        """
        multipliers = np.ones(1, dtype=np.uint64)
        offsets = np.zeros(1, dtype=np.uint64)
        step_multiplier, step_offset = _MULTIPLIER, self._increment  # as many steps as are known
        while len(multipliers) < n:
            jump, shift = np.uint64(step_multiplier), np.uint64(step_offset)
            multipliers = np.concatenate([multipliers, multipliers * jump])
            offsets = np.concatenate([offsets, offsets * jump + shift])
            step_offset = (step_multiplier * step_offset + step_offset) & _MASK
            step_multiplier = (step_multiplier * step_multiplier) & _MASK
        states = (multipliers * np.uint64(self._state) + offsets)[:n]
        if n > 0:
            self._state = (int(states[-1]) * _MULTIPLIER + self._increment) & _MASK
        return states


def inverse_normal(offset: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where the normal distribution reaches 1/2 + offset, any shape, |offset| < 1/2 (AS 241, PPND16).

    The branch for probabilities under exp(-25) is left out: draws of 24 bits do not reach it.
    """
    tail = 0.5 - np.abs(offset)
    distance = 0.180625 - offset**2
    centre = offset * np.polyval(_CENTRE[0], distance) / np.polyval(_CENTRE[1], distance)
    root = np.sqrt(-np.log(tail)) - 1.6
    outside = np.sign(offset) * np.polyval(_TAIL[0], root) / np.polyval(_TAIL[1], root)
    values: NDArray[np.float64] = np.where(np.abs(offset) <= 0.425, centre, outside)
    return values
