"""What goes wrong in an emulated run. Everything defaults to no fault; docs/emulation.md explains each value.

Times are virtual, in microseconds; those of `Fault` are in seconds after the first scan.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf

__all__ = ["FAULT_KINDS", "Fault", "LinkFaults", "RadarFaults", "Scenario"]

#: Kinds of `[[fault]]`, and which of their keys each needs or may have.
FAULT_KINDS: Mapping[str, tuple[str, ...]] = {
    "silent": ("node", "until_s"),
    "crash": ("node",),
    "restart": ("node", "until_s"),
    "hub_restart": ("until_s",),
    "garbage": ("node", "until_s"),
    "stranger": ("node_id", "every_us", "until_s"),
}


@dataclass(frozen=True, kw_only=True)
class RadarFaults:
    """One radar's schedule and converter."""

    period_us: int = 0  # [us] between scans; 0: as recorded
    frame_duration_us: int = 0  # [us] from a scan's time until it is complete
    jitter_us: float = 0.0  # [us] standard deviation of a scan's time, cut off at three
    clock_offset_us: int = 0  # [us] the node's clock at virtual time 0
    drift_ppm: float = (
        0.0  # the node's clock gains so many us a second, and its radar scans earlier accordingly
    )
    missed: float = 0.0  # probability that the node gets no scan
    doubled: float = 0.0  # probability that the node gets a scan twice
    adc_bits: int = 0  # resolution of the converter; 0: as recorded
    adc_full_scale: float = 0.0  # [count] larger amplitudes are cut off; 0: never


@dataclass(frozen=True, kw_only=True)
class LinkFaults:
    """The link from one node to the hub. Each probability is of one frame."""

    latency_us: int = 0
    bandwidth_bps: float = 0.0  # [bit/s] 0: unlimited
    loss: float = 0.0
    bit_error_rate: float = 0.0  # probability that a bit is turned over
    reorder: float = 0.0  # the frame is overtaken by the node's next one
    doubled: float = 0.0  # the frame comes twice
    late: float = 0.0  # the frame is late_us late
    late_us: int = 50_000


@dataclass(frozen=True, kw_only=True)
class Fault:
    """One thing that happens to a machine at a time."""

    kind: str  # of FAULT_KINDS
    node: str = ""  # name
    at_s: float = 0.0
    until_s: float = inf
    node_id: int = 0  # of a stranger
    every_us: int = 100_000  # [us] between the reports of a stranger

    @property
    def key(self) -> str:
        """What the log calls it."""
        return f"fault.{self.kind}"


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """One scenario file."""

    name: str = "no-fault"
    radar: RadarFaults = field(default_factory=RadarFaults)
    radars: Mapping[str, RadarFaults] = field(default_factory=dict)  # by node name, complete
    link: LinkFaults = field(default_factory=LinkFaults)
    links: Mapping[str, LinkFaults] = field(default_factory=dict)  # by node name, complete
    faults: tuple[Fault, ...] = ()
    text: str = ""  # of the file

    def radar_of(self, node: str) -> RadarFaults:
        """Return what happens to one node's radar."""
        return self.radars.get(node, self.radar)

    def link_of(self, node: str) -> LinkFaults:
        """Return what happens on one node's link."""
        return self.links.get(node, self.link)
