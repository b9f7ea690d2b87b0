"""A site in memory: where the nodes stand, what area they watch, and how the pipeline is configured."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from echofuse.recording import Recording

BARE_MARGIN_M = 3.0  # around the nodes of a recording that comes without a site

Point2 = tuple[float, float]
Point3 = tuple[float, float, float]

#: What `[pipeline]` may set: values, and tables of values by stage name.
Settings = Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class Wall:
    """The wall through which the radars look."""

    thickness_m: float
    relative_permittivity: float


@dataclass(frozen=True, kw_only=True)
class SiteNode:
    """One receiver and the transmitter that it listens to: shared (bistatic) or its own (monostatic)."""

    name: str
    id: int
    tx_position_m: Point3
    rx_position_m: Point3
    radar: str = ""  # what it is, for people
    time_zero: str | None = None  # overrides [pipeline] time_zero for this node
    delay_offset_s: float | None = None  # overrides [pipeline] delay_offset_s for this node
    transmit_delay_s: float = 0.0  # how long after its nominal time the pulse leaves; importers subtract it

    def settings(self) -> dict[str, Any]:
        """What this node sets of its pipeline's configuration."""
        own = {"time_zero": self.time_zero, "delay_offset_s": self.delay_offset_s}
        return {key: value for key, value in own.items() if value is not None}


@dataclass(frozen=True, kw_only=True)
class TruePath:
    """What is known of a real walk: the path without times."""

    path_m: tuple[Point2, ...]  # vertices of an open polyline
    walking_scans: tuple[int, int] | None = None  # first and last scan of the walk; later the person stands


@dataclass(frozen=True, kw_only=True)
class Site:
    """One site file. Lengths in metres, x and y in the plane of the floor."""

    name: str
    nodes: tuple[SiteNode, ...]
    area: tuple[Point2, ...]  # vertices of the watched polygon
    pipeline: str
    heights_m: tuple[float, float] | None = None  # z of a watched box, where positions are in space
    settings: Settings = field(default_factory=dict)  # of [pipeline]; only what the file says, no defaults
    wall: Wall | None = None
    truth: TruePath | None = None

    @property
    def bounds_m(self) -> tuple[float, float, float, float]:
        """The rectangle around the area: x_min, y_min, x_max, y_max."""
        xs, ys = zip(*self.area, strict=True)
        return min(xs), min(ys), max(xs), max(ys)

    @property
    def box_m(self) -> tuple[float, float, float, float, float, float]:
        """The watched box: x_min, y_min, z_min, x_max, y_max, z_max; a site in the plane has none."""
        if self.heights_m is None:
            raise ValueError(f"the site {self.name} has an area in the plane")
        (x_min, y_min, x_max, y_max), (z_min, z_max) = self.bounds_m, self.heights_m
        return x_min, y_min, z_min, x_max, y_max, z_max

    @property
    def area_is_rectangle(self) -> bool:
        """Whether the area is its own bounding rectangle."""
        return self.area == rectangle(*self.bounds_m)

    def to_toml(self) -> str:
        """Return the text of a site file that loads as this site."""
        from echofuse.site.toml_writer import site_to_toml

        return site_to_toml(self)


def bare_site(recording: "Recording") -> Site:
    """Return a recording's nodes as a site with nothing set: enough where there are no positions."""
    nodes = tuple(
        SiteNode(
            name=node.name,
            id=node.node_id,
            tx_position_m=_point(node.tx_position_m),
            rx_position_m=_point(node.rx_position_m),
        )
        for node in recording.nodes
    )
    ends = [end for node in nodes for end in (node.tx_position_m, node.rx_position_m)]
    xs, ys, zs = zip(*ends, strict=True)
    area = rectangle(min(xs) - BARE_MARGIN_M, min(ys), max(xs) + BARE_MARGIN_M, max(ys) + 2.0 * BARE_MARGIN_M)
    heights_m = (min(zs) - BARE_MARGIN_M, max(zs) + BARE_MARGIN_M)
    return Site(
        name="nodes of the recording",
        nodes=nodes,
        area=area,
        heights_m=heights_m if recording.pipeline.endswith("_3d") else None,
        pipeline=recording.pipeline,
    )


def _point(position_m: Any) -> Point3:
    x, y, z = (float(value) for value in position_m)
    return x, y, z


def rectangle(x_min: float, y_min: float, x_max: float, y_max: float) -> tuple[Point2, ...]:
    """Return the vertices of a rectangle, anticlockwise from the lower left."""
    return (x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)
