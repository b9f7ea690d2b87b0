"""One row of the tolerance table."""

from typing import NamedTuple


class Tolerance(NamedTuple):
    """``|target - reference| <= atol + rtol * scale``; scale: largest magnitude of the compared array."""

    rtol: float
    atol: float
    reason: str
