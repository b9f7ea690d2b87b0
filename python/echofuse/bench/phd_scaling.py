"""The particle PHD's time against particles, targets and measurements, all in one run."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.bench.material import FRAME_S, accept
from echofuse.bench.timing import exponents

MAX_EXPONENT = 1.1  # of what is called linear
SIDE_M = 20.0
SPACING_M = 4.0  # of targets on a grid, so that they stay apart
MEASUREMENT_STD_M = 0.2
VELOCITY_STD_MPS = 0.3  # of targets that stand: a hundred particles find them
DETECTION_PROBABILITY = 0.98  # the targets are never missed here; the filter would count too many at 0.9
WARMING_FRAMES = 20
FRAMES_A_TURN = 4
MIN_ROUNDS = 3

PARTICLES = (250, 500, 1000, 2000)
COUNTS = (1, 2, 4, 8, 16)


@dataclass(frozen=True, kw_only=True)
class Crowd:
    """What one filter has to follow."""

    particles_per_target: int
    targets: int
    measurements: int  # of one frame: one of each target, and clutter anywhere


@dataclass(frozen=True, kw_only=True)
class Axis:
    """One quantity grows."""

    name: str
    sizes: tuple[int, ...]
    crowd: Callable[[int], Crowd]
    judged: bool = True  # whether it has to be linear


@dataclass(frozen=True, kw_only=True)
class Growth:
    """How the time of a frame (predict, update, resample) grows with a quantity."""

    axis: str
    sizes: tuple[int, ...]
    time_ms: tuple[float, ...]  # medians: of this run on this machine
    exponent: float  # of time ~ size^p over all sizes, median over rounds
    last_exponent: float  # of the last step alone
    linear: bool  # neither is above MAX_EXPONENT
    judged: bool  # whether it has to be


AXES = (
    Axis(
        name="particles (1 target, 4 measurements)",
        sizes=PARTICLES,
        crowd=lambda n: Crowd(particles_per_target=n, targets=1, measurements=4),
    ),
    Axis(
        name="targets (125 particles each, 16 measurements)",
        sizes=COUNTS,
        crowd=lambda n: Crowd(particles_per_target=125, targets=n, measurements=16),
    ),
    Axis(
        name="measurements (1 target, 1000 particles)",
        sizes=COUNTS,
        crowd=lambda n: Crowd(particles_per_target=1000, targets=1, measurements=n),
    ),
    # The update weighs every particle with every measurement: linear in each, not in both at once.
    Axis(
        name="targets and measurements together (125 particles each)",
        sizes=COUNTS,
        crowd=lambda n: Crowd(particles_per_target=125, targets=n, measurements=n),
        judged=False,
    ),
)


class FollowingFilter:
    """A particle filter that has found its targets, fed frame by frame."""

    def __init__(self, crowd: Crowd, seed: int) -> None:
        config = _core.PhdConfig(
            detection_probability=DETECTION_PROBABILITY,
            particles_per_target=crowd.particles_per_target,
            measurement_std_m=MEASUREMENT_STD_M,
            newborn_velocity_std_mps=VELOCITY_STD_MPS,
            clutter_per_frame=max(1.0, float(crowd.measurements - crowd.targets)),
            area_m2=SIDE_M**2,
        )
        self._filter = _core.PhdFilter()
        accept(self._filter.configure(config))
        self._crowd, self._random = crowd, np.random.default_rng(seed)
        columns = int(np.ceil(np.sqrt(crowd.targets)))
        places = [
            (SPACING_M * (1 + i % columns), SPACING_M * (1 + i // columns)) for i in range(crowd.targets)
        ]
        self._targets = np.array(places, np.float64)
        for _ in range(WARMING_FRAMES):
            self.frame()

    @property
    def number(self) -> int:
        """Targets that the filter counts."""
        return self._filter.number

    def frame(self) -> float:
        """Work on the next frame, and say how long it took [s]."""
        measurements = self._measurements()
        begin = time.perf_counter()
        self._filter.predict(FRAME_S)
        self._filter.update(measurements)
        self._filter.resample()
        return time.perf_counter() - begin

    def _measurements(self) -> NDArray[np.float32]:
        crowd = self._crowd
        seen = self._targets + self._random.normal(0.0, MEASUREMENT_STD_M, self._targets.shape)
        clutter = self._random.uniform(0.0, SIDE_M, (crowd.measurements - crowd.targets, 2))
        return np.concatenate([seen, clutter]).astype(np.float32)


def phd_growths(seconds: float) -> Iterator[Growth]:
    """Measure every axis for an equal part of the time."""
    for axis in AXES:
        yield growth(axis, seconds / len(AXES))


def growth(axis: Axis, seconds: float) -> Growth:
    """All sizes take turns; each round gives its own exponents, and the median of them counts."""
    end = time.perf_counter() + seconds
    filters = [FollowingFilter(axis.crowd(size), seed=size) for size in axis.sizes]
    rounds: list[list[float]] = []
    while len(rounds) < MIN_ROUNDS or time.perf_counter() < end:
        rounds.append([sum(each.frame() for _ in range(FRAMES_A_TURN)) / FRAMES_A_TURN for each in filters])
    fitted, last = np.median([exponents(axis.sizes, times) for times in rounds], axis=0)
    return Growth(
        axis=axis.name,
        sizes=axis.sizes,
        time_ms=tuple(float(t) for t in 1e3 * np.median(rounds, axis=0)),
        exponent=float(fitted),
        last_exponent=float(last),
        linear=bool(max(fitted, last) <= MAX_EXPONENT),
        judged=axis.judged,
    )
