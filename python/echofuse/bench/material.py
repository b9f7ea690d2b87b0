"""What the stages are fed with: a few frames of one person in the simulated case study."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import cycle
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.conformance.comparison import to_float64
from echofuse.pipeline import hub_config, node_config
from echofuse.simulation.scene import sensor_radar_scene
from echofuse.simulation.sensor_radar import case_study_people, simulate
from echofuse.site import example_site

FRAMES = 8
FRAME_S = 0.1
FRAME_US = 100_000
EMPTY_ROOM_SCANS = 5
SEED = 1

Samples = NDArray[np.float32]
Call = Callable[[], object]


@dataclass(frozen=True, kw_only=True)
class Heard:
    """One node: what it is, and what it hears."""

    node_id: int
    config: "_core.SensorRadarNodeConfig"
    empty_room: tuple[Samples, ...]
    scans: tuple[Samples, ...]  # one a frame


@dataclass(frozen=True, kw_only=True)
class Material:
    """All nodes of a site."""

    nodes: tuple[Heard, ...]
    hub: "_core.SensorRadarHubConfig"
    person_m: NDArray[np.float64]  # (2,) in the middle frame


def case_study() -> Material:
    """The case study of the example site, with the library's defaults."""
    site = example_site("sensor_radar")
    recording = simulate(
        sensor_radar_scene(),
        case_study_people(1),
        duration_s=FRAMES * FRAME_S + 0.01,
        seed=SEED,
        n_reference=EMPTY_ROOM_SCANS,
    )
    places = {place.id: place for place in site.nodes}
    nodes = []
    for source in recording.nodes:
        assert source.reference is not None
        nodes.append(
            Heard(
                node_id=source.node_id,
                config=node_config(site, places[source.node_id], source),
                empty_room=tuple(np.ascontiguousarray(scan, np.float32) for scan in source.reference),
                scans=tuple(np.ascontiguousarray(scan, np.float32) for scan in source.scans),
            )
        )
    person_m = to_float64(recording.truth[0].position_m[FRAMES // 2, :2])
    return Material(nodes=tuple(nodes), hub=hub_config(site), person_m=person_m)


def listening_node(heard: Heard) -> "_core.SensorRadarNode":
    """The library's node with its empty room."""
    node = _core.SensorRadarNode()
    accept(node.configure(heard.config))
    for scan in heard.empty_room:
        accept(node.set_empty_room(scan))
    return node


def accept(answer: Any) -> Any:
    """Return what the library said after its status, which must be ok: nothing refused is ever timed."""
    status, *rest = answer if isinstance(answer, tuple) else (answer,)
    if status != _core.Status.ok:
        raise RuntimeError(f"the library refuses what is to be timed: {status}")
    return rest[0] if len(rest) == 1 else tuple(rest)


def accepted(call: Call) -> Call:
    """Return the call itself, after it succeeded once."""
    accept(call())
    return call


def back_and_forth(count: int) -> Callable[[], int]:
    """Return what counts 0, 1, ..., count - 1, ..., 1, 0, 1, ...: a walk without a jump, however long."""
    return partial(next, cycle([*range(count), *range(count - 2, 0, -1)]))
