"""Every value of NodeHealth is moved on running firmware, by exactly as much as was done; one a row.

A value that is added to `codec.HEALTH_VALUES` and has no row here fails.
"""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from ledger import OF_TROUBLE, Ledger
from numpy.typing import NDArray

from echofuse import _core
from echofuse.emulation import codec
from echofuse.emulation.codec import Transfer, cobs_encoded, crc16, crc32c, frame
from echofuse.emulation.firmware import HUB_ID, Machine
from echofuse.emulation.targets import open_board
from echofuse.pipeline import hub_config, node_config, places_of
from echofuse.recording import Recording
from echofuse.simulation.scene import sensor_radar_scene
from echofuse.simulation.sensor_radar import case_study_people, simulate
from echofuse.simulation.through_wall import simulate_through_wall
from echofuse.simulation.through_wall_scene import case_study_walkers, through_wall_scene
from echofuse.site import example_site

SITE = example_site("sensor_radar")
SOME = -1  # at least one
Scan = NDArray[np.float32]
#: Does something to a machine, and returns all that it must have counted of it.
Provocation = Callable[[Machine, Recording], dict[str, int]]


@pytest.fixture(scope="module")
def walk() -> Recording:
    return simulate(sensor_radar_scene(), case_study_people(1), seed=0)


@pytest.fixture(scope="module")
def behind_wall() -> Recording:
    return simulate_through_wall(through_wall_scene(), case_study_walkers(2), seed=0, duration_s=3.0)


# What all machines count of their link.


def sealed(payload: bytes, *, version: int = 1, index: int = 0x80000000, transfer_id: int = 0) -> bytes:
    """A frame of a stranger's message on a subject that nobody has, written down bit by bit."""
    header = (
        bytes([version, 4]) + (77).to_bytes(2, "little") + b"\xff\xff" + (7509).to_bytes(2, "little")
        + transfer_id.to_bytes(8, "little") + index.to_bytes(4, "little") + b"\0\0"
    )  # fmt: skip
    checked = header + crc16(header).to_bytes(2, "big") + payload + crc32c(payload).to_bytes(4, "little")
    return b"\0" + cobs_encoded(checked) + b"\0"


def damaged(data: bytes, at: int) -> bytes:
    """A frame with one byte changed, counted before its stuffing."""
    plain = bytearray(codec.cobs_decoded(data.strip(b"\0")) or b"")
    plain[at] ^= 0x55
    return b"\0" + cobs_encoded(bytes(plain)) + b"\0"


def hears(name: str, count: int, *stretches: bytes) -> Provocation:
    def provoke(machine: Machine, _: Recording) -> dict[str, int]:
        machine.step(10, b"".join(stretches))
        return {name: count}

    return provoke


def hears_frames(machine: Machine, _: Recording) -> dict[str, int]:
    machine.step(10, b"".join(sealed(b"abc", transfer_id=number) for number in range(5)))
    return {"link_frames": machine.requests + 5}


def is_refused(machine: Machine, _: Recording) -> dict[str, int]:
    machine.write_register("uavcan.node.id", np.uint16(9))
    return {"link_refused_writes": 1}


def says_all_it_has(_: Machine, __: Recording) -> dict[str, int]:
    """Nothing that this firmware sends is too long for a frame: tests/cpp/link/test_endpoint.cpp moves it."""
    return {"link_unsent": 0}


def paints_its_stack(machine: Machine, _: Recording) -> dict[str, int]:
    machine.step(10)
    return {"link_stack_bytes": SOME if "cortex" in machine.board.name else 0}  # a host's is not painted


OF_THE_LINK: dict[str, Provocation] = {
    "link_frames": hears_frames,
    "link_bad_cobs": hears("link_bad_cobs", 2, b"\0\x09abc\0", b"\0\xffabc\0"),
    "link_bad_length": hears("link_bad_length", 1, b"\0" + cobs_encoded(b"short") + b"\0"),
    "link_bad_version": hears("link_bad_version", 2, sealed(b"abc", version=2), sealed(b"abc", version=0)),
    "link_bad_header_crc": hears("link_bad_header_crc", 1, damaged(sealed(b"abc"), 5)),
    "link_bad_payload_crc": hears(
        "link_bad_payload_crc", 2, damaged(sealed(b"abc"), 25), damaged(sealed(b"abc"), -1)
    ),
    "link_multi_frame": hears(
        "link_multi_frame", 2, sealed(b"abc", index=0), sealed(b"abc", index=0x80000001)
    ),
    "link_repeated": hears("link_repeated", 3, *[sealed(b"abc", transfer_id=3)] * 4),
    "link_unsent": says_all_it_has,
    "link_refused_writes": is_refused,
    "link_stack_bytes": paints_its_stack,
}


# What a node counts. It knows its empty room.

SILENCE: Scan = np.zeros(1920, np.float32)


def give(node: Machine, *scans: Scan) -> None:
    for number, scan in enumerate(scans, start=1):
        node.step(100_000 * number, scan=scan, scan_time_us=100_000 * number)


def walked(walk: Recording) -> list[Scan]:
    return [np.asarray(scan, np.float32) for scan in walk.nodes[0].scans[:3]]


def put_in_force(machine: Machine, registers: dict[str, object]) -> None:
    for name, value in registers.items():
        assert machine.write_register(name, value) == pytest.approx(float(value))  # type: ignore[arg-type]
    machine.write_register("echofuse.apply", False)
    if machine.write_register("echofuse.apply", True) is not True:
        machine.step(2)
    assert machine.read_register("echofuse.apply") is True


def takes_scans(node: Machine, walk: Recording) -> dict[str, int]:
    give(node, *walked(walk))
    return {"scans": 3}


def rejects(node: Machine, _: Recording) -> dict[str, int]:
    bad = SILENCE.copy()
    bad[700] = np.nan
    give(node, SILENCE[:100], bad)
    return {"rejected_scans": 2}


def learns(node: Machine, walk: Recording) -> dict[str, int]:
    put_in_force(
        node, {"clutter.learning_scans": 2, "clutter.method": _core.ClutterMethod.exponential_average}
    )
    give(node, *walked(walk))
    return {"learning_scans": 2}


def hears_no_direct_path(node: Machine, _: Recording) -> dict[str, int]:
    give(node, SILENCE, SILENCE)
    return {"direct_path_missing": 2}


def sees_the_clock_jump(node: Machine, walk: Recording) -> dict[str, int]:
    first = walked(walk)[0]
    give(node, first, np.roll(first, 40))
    return {"alignment_doubts": 1}


def has_nothing_to_judge(node: Machine, walk: Recording) -> dict[str, int]:
    put_in_force(node, {"blind_zone_s": 1.15e-7})
    node.show_empty_room(walk.nodes[0].reference)  # type: ignore[arg-type]
    give(node, *walked(walk))
    return {"undetectable_scans": 3}


def sees_too_much(node: Machine, walk: Recording) -> dict[str, int]:
    registers: dict[str, object] = {
        "cfar.method": _core.CfarMethod.cell_averaging,
        "cfar.false_alarm_probability": 0.5,
        "range_clusters.min_weight": 1,
        "range_clusters.merge_distance_s": 1e-10,
    }
    put_in_force(node, registers)
    node.show_empty_room(walk.nodes[0].reference)  # type: ignore[arg-type]
    give(node, *walked(walk))
    return {"truncated_detections": SOME}


def takes_its_time(node: Machine, walk: Recording) -> dict[str, int]:
    give(node, *walked(walk))
    return {"ticks_max": SOME}


OF_A_NODE: dict[str, Provocation] = {
    "scans": takes_scans,
    "rejected_scans": rejects,
    "learning_scans": learns,
    "direct_path_missing": hears_no_direct_path,
    "alignment_doubts": sees_the_clock_jump,
    "undetectable_scans": has_nothing_to_judge,
    "truncated_detections": sees_too_much,
    "ticks_max": takes_its_time,
}


# What a node before a wall counts. It learns time zero, and then the background.

LEARNING = _core.ThroughWallNodeConfig().time_zero.learning_responses
SETTLED = LEARNING + _core.ThroughWallNodeConfig().clutter.learning_scans


def responses(behind_wall: Recording, count: int) -> list[Scan]:
    return [np.asarray(response, np.float32) for response in behind_wall.nodes[0].scans[:count]]


def takes_responses(node: Machine, behind_wall: Recording) -> dict[str, int]:
    give(node, *responses(behind_wall, SETTLED + 6))
    return {"responses": SETTLED + 6, "settling_responses": SETTLED, "ticks_max": SOME}


def rejects_responses(node: Machine, behind_wall: Recording) -> dict[str, int]:
    (good,) = responses(behind_wall, 1)
    bad = good.copy()
    bad[100] = np.inf
    give(node, good[:510], bad, good)
    return {"responses": 1, "rejected_responses": 2, "settling_responses": 1}


def hears_nothing(node: Machine, behind_wall: Recording) -> dict[str, int]:
    dead = np.full(511, 3.0, np.float32)
    give(node, *responses(behind_wall, LEARNING), dead, dead)
    return {"dead_responses": 2, "settling_responses": LEARNING}


def is_deafened(node: Machine, behind_wall: Recording) -> dict[str, int]:
    put_in_force(node, {"full_scale_count": 1000.0})
    loud = responses(behind_wall, 3)
    assert all(np.count_nonzero(np.abs(response) >= 1000.0) > 2 for response in loud)
    give(node, *loud)
    return {"saturated_responses": 3}


def loses_the_cross_talk(node: Machine, behind_wall: Recording) -> dict[str, int]:
    noise = np.random.default_rng(0).normal(0.0, 8.0, (2, 511)).astype(np.float32)
    give(node, *responses(behind_wall, LEARNING), *noise)
    return {"cross_talk_missing": 2, "settling_responses": LEARNING}


def is_switched_on_anew(node: Machine, behind_wall: Recording) -> dict[str, int]:
    """Three responses in a row say so; the third is the first that is learnt anew."""
    *before, one, other, third = responses(behind_wall, LEARNING + 3)
    give(node, *before, *(np.roll(response, 100) for response in (one, other, third)))
    return {"time_zero_moved": 1, "cross_talk_missing": 2, "settling_responses": LEARNING + 1}


def sees_targets_everywhere(node: Machine, behind_wall: Recording) -> dict[str, int]:
    registers: dict[str, object] = {
        "gaussian_cfar.fast_factor": 1.0,
        "gaussian_cfar.deviations": 0.01,
        "target_traces.window_samples": 2,
        "target_traces.least_hits": 1,
    }
    put_in_force(node, registers)
    give(node, *responses(behind_wall, SETTLED + 2))
    return {"truncated_detections": SOME}


OF_A_NODE_BEHIND_A_WALL: dict[str, Provocation] = {
    **dict.fromkeys(("responses", "settling_responses", "ticks_max"), takes_responses),
    "rejected_responses": rejects_responses,
    "dead_responses": hears_nothing,
    "saturated_responses": is_deafened,
    "cross_talk_missing": loses_the_cross_talk,
    "time_zero_moved": is_switched_on_anew,
    "truncated_detections": sees_targets_everywhere,
}


# What a hub counts of what it hears, from six nodes around a room or two before a wall. Its deadline: 80 ms.

FRAME_US = 100_000


def listed(hub: Machine) -> list[int]:
    """The ids of the nodes that a hub knows."""
    config = hub.config
    return [node.node_id for node in config.nodes[: config.n_nodes]]


def report(
    node: int, number: int, *, scan_us: int | None = None, delay_s: Sequence[float] = (2e-8,)
) -> bytes:
    """A node's report on its scan of a number, taken at a time [us] of its clock (default: 0.1 s each)."""
    time_us = FRAME_US * number if scan_us is None else scan_us
    payload = codec.detections_payload(time_us, np.array(delay_s), np.full(len(delay_s), 10))
    return frame(Transfer(node, codec.DETECTIONS, number, payload))


def reports(nodes: Sequence[int], number: int, **fields: object) -> bytes:
    return b"".join(report(node, number, **fields) for node in nodes)  # type: ignore[arg-type]


def hear(hub: Machine, nodes: Sequence[int], *numbers: int, **fields: object) -> None:
    """Frames that come on time, each to its end."""
    for number in numbers:
        hub.step(FRAME_US * number, reports(nodes, number, **fields))
        hub.step(FRAME_US * number + 90_000)


def takes_reports(hub: Machine, _: Recording) -> dict[str, int]:
    nodes = listed(hub)
    hear(hub, nodes, 1, 2, 3)
    return {"accepted": 3 * len(nodes), "frames": 3, "ticks_max": SOME}


def hears_one_late(hub: Machine, _: Recording) -> dict[str, int]:
    *others, last = listed(hub)
    hear(hub, [*others, last], 1)
    hear(hub, others, 2)
    hub.step(FRAME_US * 2 + 95_000, report(last, 2))
    return {"late": 1, "lost": 1}


def hears_one_early(hub: Machine, _: Recording) -> dict[str, int]:
    """At 50 frames a second: frame 4 still waits for the last node when the first speaks of frame 7."""
    *others, last = listed(hub)
    for number in (1, 2, 3):
        hub.step(20_000 * number, reports([*others, last], number, scan_us=20_000 * number))
    hub.step(80_000, reports(others, 4, scan_us=80_000))
    hub.step(140_000, report(others[0], 7, scan_us=140_000))
    return {"early": 1, "lost": 1}


def hears_one_twice(hub: Machine, _: Recording) -> dict[str, int]:
    """A scan of the same instant under another number."""
    first, *others = listed(hub)
    hear(hub, [first, *others], 1)
    twice = report(first, 2) + report(first, 3, scan_us=FRAME_US * 2)
    hub.step(FRAME_US * 2, twice + reports(others, 2))
    hub.step(FRAME_US * 2 + 90_000)
    return {"doubled": 1}


def hears_nonsense(hub: Machine, _: Recording) -> dict[str, int]:
    first, second, *_others = listed(hub)
    hub.step(FRAME_US, report(first, 1, delay_s=(2e-6,)) + report(second, 1, delay_s=(3e-8, 2e-8)))
    return {"malformed": 2}


def hears_strangers(hub: Machine, _: Recording) -> dict[str, int]:
    hub.step(FRAME_US, report(99, 1) + report(98, 1))
    return {"unknown_node": 2}


def misses_one(hub: Machine, _: Recording) -> dict[str, int]:
    hear(hub, listed(hub)[:-1], *range(1, 13))
    return {"lost": 10, "absent": 2}  # after ten frames nobody waits for it


def hears_one_count_anew(hub: Machine, _: Recording) -> dict[str, int]:
    *others, last = listed(hub)
    hear(hub, [*others, last], 5, 6)
    hub.step(FRAME_US * 7, reports(others, 7) + report(last, 0, scan_us=FRAME_US * 7))
    hub.step(FRAME_US * 7 + 90_000)
    return {"resynchronised": 1}


def hears_one_slowly(hub: Machine, _: Recording) -> dict[str, int]:
    *others, last = listed(hub)
    hear(hub, [*others, last], 1)
    hub.step(FRAME_US * 2, reports(others, 2))
    hub.step(FRAME_US * 2 + 50_000, report(last, 2))
    return {"slow": 1}


def hears_two_frames_at_once(hub: Machine, _: Recording) -> dict[str, int]:
    nodes = listed(hub)
    hear(hub, nodes, 1, 2)
    hub.step(FRAME_US * 4, reports(nodes, 3) + reports(nodes, 4))
    return {"clock_faults": 1}


def cannot_read(hub: Machine, _: Recording) -> dict[str, int]:
    hub.step(FRAME_US, frame(Transfer(listed(hub)[0], codec.DETECTIONS, 1, b"\1\2\3")))
    return {"undecodable": 1}


OF_ANY_HUB: dict[str, Provocation] = {
    **dict.fromkeys(("accepted", "frames", "ticks_max"), takes_reports),
    "late": hears_one_late,
    "early": hears_one_early,
    "doubled": hears_one_twice,
    "malformed": hears_nonsense,
    "unknown_node": hears_strangers,
    **dict.fromkeys(("lost", "absent"), misses_one),
    "resynchronised": hears_one_count_anew,
    "slow": hears_one_slowly,
    "clock_faults": hears_two_frames_at_once,
    "undecodable": cannot_read,
}


# And what a hub around a room does with them.


def tries_all_tuples(hub: Machine, _: Recording) -> dict[str, int]:
    hear(hub, listed(hub), 1, 2, 3)
    return {"tuples": 3 * 20}  # 20 ways to take three nodes of six


MANY = tuple(np.linspace(1.5e-8, 6e-8, 16))


def hears_everything(hub: Machine, _: Recording) -> dict[str, int]:
    """Sixteen echoes at each of six nodes: 17^6 ways to take them."""
    hub.step(FRAME_US, reports(listed(hub), 1, delay_s=MANY))
    return {"dropped_tuples": SOME, "dropped_detections": SOME, "dropped_measurements": 0}


def locates_too_much(hub: Machine, _: Recording) -> dict[str, int]:
    """Every tuple stands for a place, no two places for one point, and each point for a track."""
    registers: dict[str, object] = {
        "selection.method": _core.SelectionMethod.all_tuples,
        "selection.max_range_residual_m": 100.0,
        "point_clusters.threshold_m": 1e-6,
        "tracker": _core.Tracker.kalman,
        "tracks.birth_exclusion_m": 0.0,
    }
    put_in_force(hub, registers)
    hub.step(FRAME_US, reports(listed(hub), 1, delay_s=MANY))
    dropped = ("tuples", "detections", "measurements", "points", "births")
    return {f"dropped_{name}": SOME for name in dropped}


OF_A_HUB: dict[str, Provocation] = {
    **OF_ANY_HUB,
    "tuples": tries_all_tuples,
    **dict.fromkeys(("dropped_tuples", "dropped_detections"), hears_everything),
    **dict.fromkeys(("dropped_measurements", "dropped_points", "dropped_births"), locates_too_much),
}


# And one behind a wall, of two receivers 0.8 m apart.


def before_a_wall(*rx_x_m: float) -> "_core.ThroughWallHubConfig":
    """Receivers beside their transmitter, and the room of the case study."""
    config, n = _core.ThroughWallHubConfig(), len(rx_x_m)
    rx_m = np.column_stack([rx_x_m, np.zeros(n)]).astype(np.float32)
    config.set_nodes(list(range(1, n + 1)), np.zeros((n, 2), np.float32), rx_m)
    config.set_area(-2.35, 0.48, 2.35, 6.1)
    return config


def pairs_traces(hub: Machine, _: Recording) -> dict[str, int]:
    """The first is a person's, whose track takes the others."""
    hear(hub, listed(hub), 1, 2, 3)
    return {"couples": 1}


def cannot_locate(hub: Machine, _: Recording) -> dict[str, int]:
    """Paths that differ by 0.9 m, which the pairing allows."""
    first, second = listed(hub)
    hub.step(FRAME_US, report(first, 1, delay_s=(2e-8,)) + report(second, 1, delay_s=(2.3e-8,)))
    return {"couples": 1, "unlocated": 1}


def locates_beyond_the_room(hub: Machine, _: Recording) -> dict[str, int]:
    hear(hub, listed(hub), 1, delay_s=(4.3e-8,))
    return {"couples": 1, "outside_area": 1}


def has_room_for_one(hub: Machine, _: Recording) -> dict[str, int]:
    put_in_force(hub, {"path_tracker.max_tracks": 1})
    hear(hub, listed(hub), 1, delay_s=(1.5e-8, 2.5e-8, 3.5e-8))
    return {"couples": 3, "dropped_births": 2}


CLOSE = tuple(np.linspace(1.9e-8, 2e-8, 16))


def pairs_everything(hub: Machine, _: Recording) -> dict[str, int]:
    """Sixteen traces of each receiver, any of which may be any other's: 256 couples."""
    put_in_force(hub, {"trace_pairing.rule": _core.PairingRule.all_pairs, "track_aided": False})
    hear(hub, listed(hub), 1, delay_s=CLOSE)
    return {"dropped_points": SOME}


def searches_among_too_many(hub: Machine, _: Recording) -> dict[str, int]:
    """Eight receivers with sixteen traces each, and a track that all are near to: 17^8 combinations."""
    hub.configure(before_a_wall(-0.8, -0.6, -0.4, -0.2, 0.2, 0.4, 0.6, 0.8))
    hear(hub, listed(hub), 1, delay_s=CLOSE[-1:])
    hear(hub, listed(hub), 2, delay_s=CLOSE)
    return {"dropped_combinations": SOME}


OF_A_HUB_BEHIND_A_WALL: dict[str, Provocation] = {
    **OF_ANY_HUB,
    "couples": pairs_traces,
    "unlocated": cannot_locate,
    "outside_area": locates_beyond_the_room,
    "dropped_births": has_room_for_one,
    "dropped_points": pairs_everything,
    "dropped_combinations": searches_among_too_many,
}


# And one behind the cross of four receivers that the stairs have.


def pairs_both_axes(hub: Machine, _: Recording) -> dict[str, int]:
    """The first are a person's, whose track takes the others."""
    hear(hub, listed(hub), 1, 2, 3)
    return {"couples": 2, "quads": 1}


def must_bend_paths(hub: Machine, _: Recording) -> dict[str, int]:
    """Both axes say the same distance, and both that it is nearly all along them."""
    left, right, low, high = listed(hub)
    near, far = {"delay_s": (2e-8,)}, {"delay_s": (2.24e-8,)}
    said = report(left, 1, **near) + report(right, 1, **far) + report(low, 1, **near) + report(high, 1, **far)
    hub.step(FRAME_US, said)
    return {"couples": 2, "quads": 1, "clipped": 1}


def is_too_far_to_tell(hub: Machine, _: Recording) -> dict[str, int]:
    """143 m away, steeply downwards, where the four paths hardly differ in what they say of a place."""
    *level, high = listed(hub)
    hub.step(FRAME_US, reports(level, 1, delay_s=(9.57e-7,)) + report(high, 1, delay_s=(9.59e-7,)))
    return {"couples": 2, "quads": 1, "unlocated": 1}


def locates_beyond_the_box(hub: Machine, _: Recording) -> dict[str, int]:
    hear(hub, listed(hub), 1, delay_s=(5.5e-8,))
    return {"couples": 2, "quads": 1, "outside_area": 1}


def has_room_for_one_in_space(hub: Machine, _: Recording) -> dict[str, int]:
    put_in_force(hub, {"path_tracker.max_tracks": 1})
    hear(hub, listed(hub), 1, delay_s=(1.5e-8, 2.5e-8, 3.5e-8))
    return {"couples": 6, "quads": 3, "dropped_births": 2}


def searches_a_cross_among_too_many(hub: Machine, _: Recording) -> dict[str, int]:
    """Sixteen traces each within 3 mm, and a track near to all: 17^4 combinations, as good as each other."""
    hear(hub, listed(hub), 1, delay_s=CLOSE[-1:])
    hear(hub, listed(hub), 2, delay_s=tuple(np.linspace(1.9999e-8, 2e-8, 16)))
    return {"dropped_combinations": SOME}


OF_A_HUB_IN_SPACE: dict[str, Provocation] = {
    **OF_ANY_HUB,
    **dict.fromkeys(("couples", "quads"), pairs_both_axes),
    "clipped": must_bend_paths,
    "unlocated": is_too_far_to_tell,
    "outside_area": locates_beyond_the_box,
    "dropped_births": has_room_for_one_in_space,
    "dropped_points": pairs_everything,
    "dropped_combinations": searches_a_cross_among_too_many,
}

NODE, HUB, NODE_BEHIND_A_WALL, HUB_BEHIND_A_WALL, HUB_IN_SPACE = range(5)
ROWS = {
    NODE: OF_A_NODE | OF_THE_LINK,
    HUB: OF_A_HUB | OF_THE_LINK,
    NODE_BEHIND_A_WALL: OF_A_NODE_BEHIND_A_WALL | OF_THE_LINK,
    HUB_BEHIND_A_WALL: OF_A_HUB_BEHIND_A_WALL | OF_THE_LINK,
    HUB_IN_SPACE: OF_A_HUB_IN_SPACE | OF_THE_LINK,
}
VALUES = [(kind, name) for kind, names in codec.HEALTH_VALUES.items() for name in names]


@pytest.fixture(params=["process", pytest.param("cortex-m7", marks=pytest.mark.slow)])
def target(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def opened(kind: int, target: str, walk: Recording) -> Machine:
    if kind == NODE_BEHIND_A_WALL:
        node = Machine(open_board(target, "through_wall_node", "rx1", 1), 1)
        node.configure(_core.ThroughWallNodeConfig(node_id=1))
        return node
    if kind == HUB_BEHIND_A_WALL:
        hub = Machine(open_board(target, "through_wall_hub", "hub", HUB_ID), HUB_ID)
        hub.configure(before_a_wall(-0.4, 0.4))
        return hub
    if kind == HUB_IN_SPACE:
        hub = Machine(open_board(target, "through_wall_3d_hub", "hub", HUB_ID), HUB_ID)
        hub.configure(hub_config(example_site("stairs")))
        return hub
    if kind == HUB:
        hub = Machine(open_board(target, "sensor_radar_hub", "hub", HUB_ID), HUB_ID)
        hub.configure(hub_config(SITE))
        return hub
    source = walk.nodes[0]
    node = Machine(open_board(target, "sensor_radar_node", "rx1", source.node_id), source.node_id)
    place = places_of(SITE, walk.nodes)[source.node_id]
    node.configure(node_config(SITE, place, source))
    assert source.reference is not None
    node.show_empty_room(list(source.reference))
    return node


@pytest.mark.parametrize(("kind", "name"), VALUES)
def test_every_value_moves_by_what_was_done(
    kind: int, name: str, target: str, walk: Recording, behind_wall: Recording, injected: Ledger
) -> None:
    heard = behind_wall if kind == NODE_BEHIND_A_WALL else walk
    machine = opened(kind, target, heard)
    with machine.board:
        expected = ROWS[kind][name](machine, heard)
        machine.step(10_000_000)
        said = machine.health
        for key, count in expected.items():
            assert (said[key] > 0) if count == SOME else (said[key] == count), key
        trouble = {key: said[key] for key in expected if key in OF_TROUBLE}
        injected("hub" if kind in (HUB, HUB_BEHIND_A_WALL, HUB_IN_SPACE) else "rx1", **trouble)
        assert name in expected
