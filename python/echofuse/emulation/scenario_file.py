"""Reads a scenario file; everything that is wrong with it is reported together, one line each."""

import tomllib
from collections.abc import Callable, Mapping
from importlib.resources import files
from math import inf
from pathlib import Path
from typing import Any, TypeVar

from echofuse.emulation.scenario import FAULT_KINDS, Fault, LinkFaults, RadarFaults, Scenario
from echofuse.errors import InputError, problem
from echofuse.site import Site
from echofuse.site.loader import MAX_NODE_ID
from echofuse.site.tables import Problems, Table, suggestion

__all__ = ["check_nodes", "example_scenarios", "load_scenario", "parse_scenario"]

MAX_TIME_S = 1e6
MAX_TIME_US = 60_000_000
MAX_CLOCK_US = 10**15  # a report has 56 bits for it
RESTART_S = {"restart": 0.3, "hub_restart": 0.2}  # how long a machine takes to come back

Faults = TypeVar("Faults", RadarFaults, LinkFaults)
#: Type, least and greatest value, unit.
_Range = tuple[type, float, float, str]

_RADAR: Mapping[str, _Range] = {
    "period_us": (int, 0, MAX_TIME_US, "us"),
    "frame_duration_us": (int, 0, MAX_TIME_US, "us"),
    "jitter_us": (float, 0, MAX_TIME_US, "us"),
    "clock_offset_us": (int, 0, MAX_CLOCK_US, "us"),
    "drift_ppm": (float, -10_000, 10_000, "us/s"),
    "missed": (float, 0, 1, "1"),
    "doubled": (float, 0, 1, "1"),
    "adc_bits": (int, 0, 24, "1"),
    "adc_full_scale": (float, 0, 1e9, "count"),
}
_LINK: Mapping[str, _Range] = {
    "latency_us": (int, 0, MAX_TIME_US, "us"),
    "bandwidth_bps": (float, 0, 1e12, "bit/s"),
    "loss": (float, 0, 1, "1"),
    "bit_error_rate": (float, 0, 1, "1"),
    "reorder": (float, 0, 1, "1"),
    "doubled": (float, 0, 1, "1"),
    "late": (float, 0, 1, "1"),
    "late_us": (int, 1, MAX_TIME_US, "us"),
}


def example_scenarios() -> dict[str, Path]:
    """Return the scenario files that come with the package, by name."""
    folder = Path(str(files("echofuse"))) / "scenarios"
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}


def load_scenario(name_or_path: str | Path) -> Scenario:
    """Read and check a scenario, by the name of one that comes with the package or by its path.

    Raises
    ------
    InputError
        One line a problem: no such file, not TOML, unknown keys, wrong types, impossible values.
    """
    path = Path(name_or_path)
    if path.suffix != ".toml":
        known = example_scenarios()
        if str(name_or_path) not in known:
            expected = f"a scenario ({', '.join(known)}) or a scenario file (FILE.toml)"
            raise InputError(problem(name_or_path, "", expected))
        path = known[str(name_or_path)]
    try:
        text = path.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(problem(path, "", "a scenario file (TOML)", str(error))) from error
    return parse_scenario(text, str(path), name=path.stem)


def parse_scenario(text: str, source: str = "scenario", *, name: str = "scenario") -> Scenario:
    """Check the text of a scenario file; `source` is what its problems name."""
    try:
        tree = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(problem(source, "", "TOML", str(error))) from error
    problems = Problems(source)
    tables = ("radar", "link", "fault")
    for key in tree:
        if key not in tables:
            problems.add(key, suggestion(key, tables), "an unknown key")
    radar, radars = _with_overrides(tree.get("radar", {}), "radar", _RADAR, RadarFaults, problems)
    link, links = _with_overrides(tree.get("link", {}), "link", _LINK, LinkFaults, problems)
    faults = _faults(tree.get("fault", []), problems)
    if problems.lines:
        raise InputError(problems.lines)
    return Scenario(name=name, radar=radar, radars=radars, link=link, links=links, faults=faults, text=text)


def check_nodes(scenario: Scenario, site: Site, names: tuple[str, ...], source: str) -> None:
    """Raise when a scenario names nodes that a run does not have, or a stranger who is none."""
    problems = Problems(source)
    for table, overrides in (("radar", scenario.radars), ("link", scenario.links)):
        for node in overrides:
            if node not in names:
                problems.add(f"{table}.{node}", f"a key or a node of the run ({', '.join(names)})")
    for number, fault in enumerate(scenario.faults, start=1):
        if fault.node and fault.node not in names:
            problems.add(f"fault[{number}].node", f"a node of the run ({', '.join(names)})", fault.node)
        if fault.kind == "stranger" and fault.node_id in {node.id for node in site.nodes}:
            problems.add(f"fault[{number}].node_id", "an id that the site does not list", fault.node_id)
    if problems.lines:
        raise InputError(problems.lines)


def _with_overrides(
    values: Any,
    name: str,
    ranges: Mapping[str, _Range],
    kind: Callable[..., Faults],
    problems: Problems,
) -> tuple[Faults, dict[str, Faults]]:
    """Return the faults of all, and by name of those nodes that have a table of their own ([radar.rx3])."""
    table = Table(values, name, problems)
    own = {key: value for key, value in table.values.items() if isinstance(value, dict)}
    table.values = {key: value for key, value in table.values.items() if key not in own}
    common = _ranged(table, ranges)
    overrides = {
        node: kind(**(common | _ranged(Table(value, f"{name}.{node}", problems), ranges)))
        for node, value in own.items()
    }
    return kind(**common), overrides


def _ranged(table: Table, ranges: Mapping[str, _Range]) -> dict[str, Any]:
    """Return the values that a table sets."""
    found: dict[str, Any] = {}
    for key, (kind, low, high, unit) in ranges.items():
        if kind is int:
            found[key] = table.integer(key, int(low), int(high))
        else:
            found[key] = table.number(key, low, high, unit)
    table.finish()
    return {key: value for key, value in found.items() if value is not None}


def _faults(rows: Any, problems: Problems) -> tuple[Fault, ...]:
    if not isinstance(rows, list):
        problems.add("fault", "tables [[fault]]", rows)
        return ()
    found = [_fault(Table(row, f"fault[{i}]", problems)) for i, row in enumerate(rows, start=1)]
    return tuple(fault for fault in found if fault is not None)


def _fault(table: Table) -> Fault | None:
    kinds = f"one of {', '.join(FAULT_KINDS)}"
    kind = table.take("kind", kinds, required=True)
    if kind not in FAULT_KINDS:
        if "kind" in table.values:
            table.wrong("kind", kinds, kind)
        return None
    keys = FAULT_KINDS[kind]
    values: dict[str, Any] = {"kind": kind}
    at_s = table.number("at_s", 0, MAX_TIME_S, "s")
    values["at_s"] = at_s or 0.0
    if "until_s" in keys:
        until_s = table.number("until_s", 0, MAX_TIME_S, "s")
        if until_s is not None and until_s <= values["at_s"]:
            table.wrong("until_s", f"a time after at_s ({values['at_s']:g})", until_s)
        values["until_s"] = values["at_s"] + RESTART_S.get(kind, inf) if until_s is None else until_s
    if "node" in keys:
        values["node"] = table.string("node", required=True)
    if "node_id" in keys:
        values["node_id"] = table.integer("node_id", 0, MAX_NODE_ID, required=True)
        values["every_us"] = table.integer("every_us", 1000, MAX_TIME_US)
    table.finish()
    return Fault(**{key: value for key, value in values.items() if value is not None})
