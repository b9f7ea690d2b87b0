"""Configuration classes as the compiled library offers them, with every kind of field, to test the loader."""

import enum
import math
from collections.abc import Callable
from typing import Any

import pytest

from echofuse.site import Site, parse_site


class Method(enum.Enum):
    cell_averaging = 0
    ordered_statistic = 1


class TimeZero(enum.Enum):
    direct_path = 0
    recorded = 1


class FakeConfig:
    """Fields are attributes; a number below its least value, or not finite, is impossible."""

    def __init__(self, least: dict[str, float] | None = None, **values: Any) -> None:
        self.__dict__["_least"] = least or {}
        self.__dict__["_names"] = tuple(values)
        self.__dict__.update(values)

    def fields(self) -> tuple[str, ...]:
        return self.__dict__["_names"]  # type: ignore[no-any-return]

    def invalid_field(self) -> str | None:
        for name in self.fields():
            value = getattr(self, name)
            if isinstance(value, FakeConfig) and value.invalid_field():
                return name
            if name in self.__dict__["_least"] and not math.inf > value >= self.__dict__["_least"][name]:
                return name
        return None


@pytest.fixture
def configs() -> tuple[FakeConfig, FakeConfig]:
    """A node's and a hub's defaults."""
    cfar = FakeConfig(
        {"training_cells_per_side": 1, "false_alarm_probability": 1e-12},
        method=Method.cell_averaging,
        false_alarm_probability=1e-4,
        training_cells_per_side=16,
        sample_rate_hz=0.0,
    )
    node = FakeConfig(
        {"n_samples": 1, "blind_zone_s": 0.0},
        blind_zone_s=1.5e-9,
        delay_offset_s=0.0,
        time_zero=TimeZero.direct_path,
        n_samples=0,
        cfar=cfar,
    )
    selection = FakeConfig(
        {"min_weight": 0}, min_weight=40.0, merge_distance_s=4e-9, use_area=True, weights=[1.0, 2.0]
    )
    return node, FakeConfig(tracker=Method.cell_averaging, nodes=[], selection=selection)


@pytest.fixture
def load(configs: tuple[FakeConfig, FakeConfig]) -> Callable[[str], Site]:
    """Check a site's text against those classes."""
    return lambda text: parse_site(text, "hall.toml", configs)
