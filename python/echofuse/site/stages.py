"""Checks and applies stage settings against the compiled configuration classes, whatever fields these have.

Names, types and defaults all come from the classes: this module knows none.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, cast

import numpy as np

from echofuse.site.tables import Problems, finite_number, suggestion

__all__ = ["PIPELINES", "Config", "PipelineKind", "PlanConfig", "apply_settings", "check_settings"]

#: What the recording, or nodes, area and wall of the site say; a stage setting may not contradict them.
MEASURED = frozenset(
    {"node_id", "n_samples", "sample_rate_hz", "first_sample_s", "baseline_m", "nodes", "n_nodes", "area"}
    | {"thickness_m", "relative_permittivity"}
)


class Config(Protocol):
    """What every bound configuration class offers (`bindings/common.hpp`)."""

    def fields(self) -> tuple[str, ...]:
        """Return the names of all fields."""
        ...

    def invalid_field(self) -> str | None:
        """Return the name of the first field with an impossible value."""
        ...


def _link_budget() -> Any:
    return _compiled("CoverageConfig")


@dataclass
class PlanConfig:
    """What `echofuse plan` reads of [pipeline]: the table of the link budget."""

    coverage: Any = field(default_factory=_link_budget)

    def fields(self) -> tuple[str, ...]:
        """Return the names of all fields."""
        return ("coverage",)

    def invalid_field(self) -> str | None:
        """Return the name of the first field with an impossible value."""
        return None if self.coverage.invalid_field() is None else "coverage"


@dataclass(frozen=True, kw_only=True)
class PipelineKind:
    """The compiled classes of a pipeline, and the sites on which it can say where people are."""

    node: str  # a node's class; its configuration's name ends in Config
    hub: str
    least_nodes: int  # fewer see people, and cannot tell where they are
    most_nodes: int
    behind_wall: bool = False  # receivers before a wall, on a line or (dimension 3) in a cross, else around
    dimension: int = 2  # of the positions that the hub tells

    def new_node(self) -> Any:
        """Return a node that is not configured."""
        return _compiled(self.node)

    def new_hub(self) -> Any:
        """Return a hub that is not configured."""
        return _compiled(self.hub)

    def node_config(self) -> Any:
        """Return a node's configuration, as C++ defaults it."""
        return _compiled(f"{self.node}Config")

    def hub_config(self) -> Any:
        """Return the hub's configuration, as C++ defaults it."""
        return _compiled(f"{self.hub}Config")

    def default_configs(self) -> tuple[Config, ...]:
        """Return the configurations of a node, of the hub and of a plan, as C++ defaults them."""
        return self.node_config(), self.hub_config(), PlanConfig()


def _compiled(name: str) -> Any:
    from echofuse import _core

    return getattr(_core, name)()


PIPELINES = {
    "sensor_radar": PipelineKind(node="SensorRadarNode", hub="SensorRadarHub", least_nodes=3, most_nodes=16),
    "through_wall_2d": PipelineKind(
        node="ThroughWallNode", hub="ThroughWallHub", least_nodes=2, most_nodes=8, behind_wall=True
    ),
    "through_wall_3d": PipelineKind(
        node="ThroughWallNode",
        hub="ThroughWall3dHub",
        least_nodes=4,
        most_nodes=4,
        behind_wall=True,
        dimension=3,
    ),
}


def check_settings(settings: Mapping[str, Any], configs: Sequence[Config], problems: Problems) -> None:
    """Report every setting that no configuration knows, of a wrong type, or with an impossible value.

    A key is looked up in `configs` in order: the node's, the hub's, a plan's. What is right is set on them.
    """
    known = [field for config in configs for field in config.fields() if field not in MEASURED]
    own: list[dict[str, Any]] = [{} for _ in configs]
    for key, value in settings.items():
        owner = next((index for index, config in enumerate(configs) if key in config.fields()), None)
        if owner is None:
            problems.add(f"pipeline.{key}", suggestion(key, known), "an unknown key")
        else:
            own[owner][key] = value
    for config, values in zip(configs, own, strict=True):
        _set_all(config, values, "pipeline", problems)


def apply_settings(config: Config, settings: Mapping[str, Any]) -> None:
    """Set on `config` those checked settings that it has fields for; the others belong to another class.

    What is possible by itself, and not with what was measured, stands there: `invalid_field` tells.
    """
    problems = Problems("pipeline")
    for key, value in settings.items():
        if key in config.fields():
            _set(config, key, value, key, problems)
    if problems.lines:
        raise ValueError("\n".join(problems.lines))


def _set_all(config: Config, values: Mapping[str, Any], where: str, problems: Problems) -> None:
    """Set known fields, and put back with a problem those that make the configuration impossible."""
    before = {key: getattr(config, key) for key in values if key not in MEASURED}
    for key, value in values.items():
        _set(config, key, value, f"{where}.{key}".lstrip("."), problems)
    bad = config.invalid_field()
    while bad in before and not _is_config(before[bad]):
        meaning = _documentation(config, bad)
        problems.add(f"{where}.{bad}".lstrip("."), f"a possible value ({meaning})", values[bad])
        setattr(config, bad, before.pop(bad))
        bad = config.invalid_field()


def _set(config: Config, key: str, value: Any, where: str, problems: Problems) -> None:
    if key in MEASURED:
        problems.add(where, "no such setting: the recording or the site itself says it", value)
        return
    current = getattr(config, key)
    if _is_config(current):
        _set_stage(current, value, where, problems)
        return
    expected, converted = _converted(current, value)
    if converted is not None:
        try:
            setattr(config, key, converted)
            return
        except (TypeError, ValueError, OverflowError):
            expected += " that fits the field"
    problems.add(where, expected, value)


def _set_stage(config: Config, values: Any, where: str, problems: Problems) -> None:
    if not isinstance(values, Mapping):
        problems.add(where, f"a table [{where}]", values)
        return
    settable = [field for field in config.fields() if field not in MEASURED]
    for key in values:
        if key not in config.fields():
            problems.add(f"{where}.{key}", suggestion(key, settable), "an unknown key")
    known = {key: value for key, value in values.items() if key in config.fields()}
    _set_all(config, known, where, problems)


def _documentation(config: Config, field: str) -> str:
    """Return what the binding says about a field: its unit and range."""
    described = getattr(type(config), field, None)
    return (described.__doc__ if described is not None else "") or "see the stage"


def _converted(current: Any, value: Any) -> tuple[str, Any]:
    """Return what a field holding `current` expects, and `value` as such or None."""
    members = getattr(type(current), "__members__", None)
    if members is not None:
        fits = isinstance(value, str) and value in members
        return f"one of {', '.join(members)}", members[value] if fits else None
    if isinstance(current, bool):
        return "true or false", value if isinstance(value, bool) else None
    if isinstance(current, int):
        fits = isinstance(value, int) and not isinstance(value, bool)
        return "an integer", value if fits else None
    if isinstance(current, float):
        fits = finite_number(value) and abs(value) <= float(np.finfo(np.float32).max)
        return "a number", float(value) if fits else None
    if isinstance(current, Sequence):
        return _converted_list(current, value)
    return "nothing: this field cannot be set in a site file", None


def _converted_list(current: Sequence[Any], value: Any) -> tuple[str, Any]:
    if not isinstance(value, list) or len(value) != len(current):
        return f"a list of {len(current)} values", None
    pairs = [_converted(have, want) for have, want in zip(current, value, strict=True)]
    converted = [item for _, item in pairs]
    expected = f"a list of {len(current)}, each {pairs[0][0]}" if pairs else "an empty list"
    return expected, None if any(item is None for item in converted) else converted


def _is_config(value: Any) -> bool:
    return callable(getattr(value, "invalid_field", None)) and callable(
        getattr(cast(Config, value), "fields", None)
    )
