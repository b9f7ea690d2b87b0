"""What is conformed: each choice of each stage, one at a time from the default, and some that people combine."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

Settings = Mapping[str, Any]  # "stage.field" or "field" -> value, a choice as its word


@dataclass(frozen=True, kw_only=True)
class Choice:
    """One row of the table."""

    name: str
    settings: Settings = field(default_factory=dict)
    learns: bool = False  # nobody gives the background: the node learns it
    equation_residual: bool = False  # hub: only where all nodes share one transmitter


def _one(key: str, *values: Any, learns: bool = False) -> Iterator[Choice]:
    """One choice a value of one field."""
    for value in values:
        name = f"{key}={value}" + (", learnt" if learns else "")
        yield Choice(name=name, settings={key: value, **(LEARNING if learns else {})}, learns=learns)


def configure(config: object, settings: Settings) -> None:
    """Set "stage.field" and "field" on a bound configuration; a choice by its word."""
    for key, value in settings.items():
        *stages, name = key.split(".")
        owner = config
        for stage in stages:
            owner = getattr(owner, stage)
        members = getattr(type(getattr(owner, name)), "__members__", None)
        setattr(owner, name, value if members is None else members[value])


LEARNING: Settings = {"clutter.learning_scans": 3}

NODE_CHOICES: tuple[Choice, ...] = (
    Choice(name="default"),
    *_one("time_zero", "recorded"),
    *_one("pulse_integrator.pulses_per_scan", 2),
    *_one("envelope.method", "square_low_pass"),
    *_one("direct_path.search", "threshold_crossing", "jump_back_search_forward"),
    *_one("alignment.method", "integer", "none"),
    *_one("clutter.method", "empty_room_scan", "exponential_average", "frame_difference"),
    *_one(
        "clutter.method",
        "empty_room_envelope",
        "empty_room_scan",
        "exponential_average",
        "frame_difference",
        learns=True,
    ),
    Choice(
        name="clutter.difference_lag_scans=2",
        settings={"clutter.method": "frame_difference", "clutter.difference_lag_scans": 2},
    ),
    *_one("cfar.method", "cell_averaging", "global_average", "ordered_statistic"),
    *_one("noise_floor.factor", 3.0),
    *_one("range_clusters.representative", "median"),
    Choice(
        name="the paper's",
        settings={
            "cfar.method": "double_threshold_buffer",
            "range_clusters.representative": "median",
            "direct_path.search": "serial_backward",
        },
    ),
    Choice(
        name="coherent, cell averaging, median",
        settings={
            "clutter.method": "empty_room_scan",
            "cfar.method": "cell_averaging",
            "range_clusters.representative": "median",
        },
    ),
    Choice(
        name="learnt, exponential, ordered statistic, recorded, noise floor",
        settings={
            **LEARNING,
            "clutter.method": "exponential_average",
            "cfar.method": "ordered_statistic",
            "time_zero": "recorded",
            "noise_floor.factor": 2.5,
        },
        learns=True,
    ),
    Choice(
        name="square law, whole samples, global average, crossing",
        settings={
            "envelope.method": "square_low_pass",
            "alignment.method": "integer",
            "cfar.method": "global_average",
            "direct_path.search": "threshold_crossing",
        },
    ),
)
