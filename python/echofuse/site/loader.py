"""Reads a site file; everything that is wrong with it is reported together, one line each."""

import tomllib
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from echofuse.errors import InputError, problem
from echofuse.site.geometry import check_area, check_around, check_before_wall, check_nodes
from echofuse.site.model import Point2, Point3, Site, SiteNode, TruePath, Wall, rectangle
from echofuse.site.stages import PIPELINES, Config, PipelineKind, check_settings
from echofuse.site.tables import Problems, Table, suggestion

__all__ = ["example_site", "example_sites", "load_site", "parse_site"]

MAX_NODE_ID = 65534  # Cyphal/serial has 16 bits; 65535 is nobody or everybody
MAX_NODES = 16  # one hub serves one site of up to 16 nodes


def load_site(path: str | Path, *, few_nodes: bool = False) -> Site:
    """Read and check a site file; `few_nodes` lets one pass that has too few of them for positions.

    Raises
    ------
    InputError
        One line a problem: no such file, not TOML, unknown keys, wrong types, impossible values or geometry.
    """
    path = Path(path)
    try:
        text = path.read_text("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(problem(path, "", "a site file (TOML)", str(error))) from error
    return parse_site(text, str(path), few_nodes=few_nodes)


def parse_site(
    text: str,
    source: str = "site",
    configs: tuple[Config, Config] | None = None,
    *,
    few_nodes: bool = False,
) -> Site:
    """Check the text of a site file; `source` is what its problems name.

    `configs` are the node's and the hub's default configuration (default: those of the compiled library).
    `few_nodes` lets a site pass that has too few nodes for positions; then it need not have a wall either.
    """
    try:
        tree = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(problem(source, "", "TOML", str(error))) from error
    problems = Problems(source)
    root = _Root(tree, problems, few_nodes=few_nodes)
    site = root.site(configs)
    if problems.lines or site is None:
        raise InputError(problems.lines)
    return site


def example_sites() -> dict[str, Path]:
    """Return the site files that come with the package, by name."""
    folder = Path(str(files("echofuse"))) / "sites"
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}


def example_site(name: str) -> Site:
    """Load a site file that comes with the package."""
    return load_site(example_sites()[name])


class _Root:
    """The whole file."""

    def __init__(self, tree: Mapping[str, Any], problems: Problems, *, few_nodes: bool) -> None:
        self.tree = dict(tree)
        self.problems = problems
        self.few_nodes = few_nodes
        self.blind_zone_s = 0.0

    def site(self, configs: tuple[Config, Config] | None) -> Site | None:
        tables = ("site", "node", "pipeline", "truth")
        for key in self.tree:
            if key not in tables:
                self.problems.add(key, suggestion(key, tables), "an unknown key")
        head = self.table("site")
        name = head.string("name", required=True)
        area, heights_m = _area(head, self.dimension())
        wall = _wall(head, self.problems)
        head.finish()
        nodes = self.nodes()
        pipeline, settings = self.pipeline(configs)
        truth = self.truth()
        if area is not None:
            check_area(area, self.problems)
        if area is not None and nodes is not None and pipeline is not None:
            check_nodes(nodes, area, self.problems)
            self.check_positions(PIPELINES[pipeline], nodes, area, wall)
        if name is None or area is None or nodes is None or pipeline is None:
            return None
        return Site(
            name=name,
            nodes=nodes,
            area=area,
            heights_m=heights_m,
            pipeline=pipeline,
            settings=settings,
            wall=wall,
            truth=truth,
        )

    def check_positions(
        self, kind: PipelineKind, nodes: tuple[SiteNode, ...], area: tuple[Point2, ...], wall: Wall | None
    ) -> None:
        """Check that a pipeline can locate people with these nodes."""
        least, most = kind.least_nodes, kind.most_nodes
        if len(nodes) < least:
            if not self.few_nodes or not nodes:
                expected = f"at least {least} nodes, the fewest that locate a person"
                self.problems.add("node", expected, f"{len(nodes)}")
        elif kind.behind_wall:
            if len(nodes) > most:
                shape = "in the cross" if kind.dimension == 3 else "on the line"
                self.problems.add("node", f"at most {most} nodes {shape}", f"{len(nodes)}")
                return
            check_before_wall(nodes, area, wall, self.blind_zone_s, self.problems, dimension=kind.dimension)
        else:
            check_around(nodes, self.problems)

    def dimension(self) -> int:
        """Return that of the pipeline's positions, 2 of a pipeline that is not known."""
        table = self.tree.get("pipeline")
        kind = PIPELINES.get(str(table.get("name"))) if isinstance(table, dict) else None
        return 2 if kind is None else kind.dimension

    def table(self, key: str) -> Table:
        if key not in self.tree:
            self.problems.add(key, f"a table [{key}]", "nothing")
        return Table(self.tree.get(key, {}), key, self.problems)

    def nodes(self) -> tuple[SiteNode, ...] | None:
        """Return all nodes, or None when one of them cannot be read."""
        rows = self.tree.get("node", [])
        if not isinstance(rows, list):
            self.problems.add("node", "tables [[node]]", rows)
            return None
        if len(rows) > MAX_NODES:
            self.problems.add("node", f"at most {MAX_NODES} nodes", len(rows))
        nodes = [_node(Table(row, f"node[{i}]", self.problems)) for i, row in enumerate(rows, start=1)]
        found = tuple(node for node in nodes if node is not None)
        return found if len(found) == len(nodes) else None

    def pipeline(self, configs: tuple[Config, Config] | None) -> tuple[str | None, dict[str, Any]]:
        table = self.table("pipeline")
        name = table.string("name", required=True)
        settings = {key: value for key, value in table.values.items() if key != "name"}
        if name is None:
            return None, settings
        if name not in PIPELINES:
            known = tuple(PIPELINES)
            self.problems.add("pipeline.name", f"one of {', '.join(known)}", name)
            return None, settings
        checked = configs or PIPELINES[name].default_configs()
        check_settings(settings, checked, self.problems)
        self.blind_zone_s = getattr(checked[0], "blind_zone_s", 0.0)
        self.check_node_settings(checked[0])
        return name, settings

    def check_node_settings(self, config: Config) -> None:
        """Check what nodes override against the same class; wrong types are reported already."""
        rows = self.tree.get("node", [])
        for i, row in enumerate(rows if isinstance(rows, list) else [], start=1):
            value = row.get("time_zero") if isinstance(row, dict) else None
            if not isinstance(value, str):
                continue
            if hasattr(getattr(config, "time_zero", None), "fields"):  # a stage there, and no choice
                key, expected = f"node[{i}].time_zero", "no such setting: the cross-talk tells time zero"
                self.problems.add(key, expected, value)
                continue
            own = Problems(self.problems.source)
            check_settings({"time_zero": value}, (config,), own)
            self.problems.lines += [
                line.replace("pipeline.time_zero", f"node[{i}].time_zero") for line in own.lines
            ]

    def truth(self) -> TruePath | None:
        if "truth" not in self.tree:
            return None
        table = self.table("truth")
        path = table.points("path_m", 2, "at least two points [x, y] in metres", required=True)
        scans = table.take("walking_scans", "", required=False)
        table.finish()
        is_range = isinstance(scans, list) and len(scans) == 2 and all(type(scan) is int for scan in scans)
        if scans is not None and not (is_range and 0 <= scans[0] < scans[1]):
            table.wrong(
                "walking_scans", "the first and the last scan of the walk, two ascending integers", scans
            )
            return None
        if path is None:
            return None
        return TruePath(path_m=tuple(path), walking_scans=(scans[0], scans[1]) if scans else None)


def _area(table: Table, dimension: int) -> tuple[tuple[Point2, ...] | None, tuple[float, float] | None]:
    """Return the area's vertices on the floor and, in space, its least and greatest z."""
    if dimension == 2:
        return _polygon(table), None
    expected = "[x_min, y_min, z_min, x_max, y_max, z_max], a box in metres"
    numbers = table.numbers("area", (6,), expected, required=True)
    if numbers is None:
        return None, None
    x_min, y_min, z_min, x_max, y_max, z_max = numbers
    if not (x_min < x_max and y_min < y_max and z_min < z_max):
        table.wrong("area", "x_min < x_max, y_min < y_max and z_min < z_max", numbers)
        return None, None
    return rectangle(x_min, y_min, x_max, y_max), (z_min, z_max)


def _polygon(table: Table) -> tuple[Point2, ...] | None:
    """Return the vertices of ``area = [x_min, y_min, x_max, y_max]`` or ``[[x, y], [x, y], [x, y], ...]``."""
    expected = "[x_min, y_min, x_max, y_max] or at least three points [x, y], in metres"
    raw = table.values.get("area")
    if isinstance(raw, list) and raw and isinstance(raw[0], list):
        points = table.points("area", 3, expected)
        return tuple(points) if points else None
    numbers = table.numbers("area", (4,), expected, required=True)
    if numbers is None:
        return None
    x_min, y_min, x_max, y_max = numbers
    if not (x_min < x_max and y_min < y_max):
        table.wrong("area", "x_min < x_max and y_min < y_max", raw)
        return None
    return rectangle(x_min, y_min, x_max, y_max)


def _wall(site: Table, problems: Problems) -> Wall | None:
    raw = site.take("wall", "a table", required=False)
    if raw is None:
        return None
    table = Table(raw, "site.wall", problems)
    thickness_m = table.number("thickness_m", 0.0, 2.0, "m", required=True)
    permittivity = table.number("relative_permittivity", 1.0, 100.0, "1", required=True)
    table.finish()
    if thickness_m is None or permittivity is None:
        return None
    return Wall(thickness_m=thickness_m, relative_permittivity=permittivity)


def _node(table: Table) -> SiteNode | None:
    name = table.string("name", required=True)
    if name is not None and "/" in name:
        table.wrong("name", "a name without a slash", name)
    node_id = table.integer("id", 0, MAX_NODE_ID, required=True)
    radar = table.string("radar")
    tx_m, rx_m = _position(table, "tx_position_m"), _position(table, "rx_position_m")
    time_zero = table.string("time_zero")
    delay_offset_s = table.number("delay_offset_s", -1e-6, 1e-6, "s")
    transmit_delay_s = table.number("transmit_delay_s", -1e-6, 1e-6, "s")
    table.finish()
    if name is None or node_id is None or tx_m is None or rx_m is None:
        return None
    return SiteNode(
        name=name,
        id=node_id,
        radar=radar or "",
        tx_position_m=tx_m,
        rx_position_m=rx_m,
        time_zero=time_zero,
        delay_offset_s=delay_offset_s,
        transmit_delay_s=transmit_delay_s or 0.0,
    )


def _position(table: Table, key: str) -> Point3 | None:
    numbers = table.numbers(key, (2, 3), "two or three finite numbers x, y (, z) [m]", required=True)
    if numbers is None:
        return None
    x, y, z = (*numbers, 0.0)[:3]
    return x, y, z
