"""Measures the images of the target cortex-m7, as `make firmware` leaves them.

python tests/firmware/measure.py            the figures, as README's table
python tests/firmware/measure.py --update   and into budgets.toml
"""

import argparse
import subprocess
import sys
import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from material import (
    HubFeed,
    NodeFeed,
    cross_at_random,
    crowd,
    sensor_radar_hub,
    sensor_radar_node,
    stairs_node,
    through_wall_3d_hub,
    through_wall_hub,
    through_wall_node,
    traces_at_random,
)
from static_stack import deepest, functions

from echofuse import _core
from echofuse.emulation.firmware import HUB_ID, Machine
from echofuse.emulation.image_size import image_size
from echofuse.emulation.lockstep import PROFILE_TOTAL
from echofuse.emulation.targets import firmware_image, open_board

HERE = Path(__file__).parent
BUDGETS = HERE / "budgets.toml"
TOLERANCE = 0.03  # in both directions
FORBIDDEN = {"malloc", "free", "calloc", "realloc", "_malloc_r", "_free_r", "_sbrk"}
FORBIDDEN |= {"__cxa_throw", "__cxa_guard_acquire"}
FORBIDDEN_OPERATORS = ("_Znw", "_Zna", "_Zdl", "_Zda")  # new and delete

#: What each image is fed with.
FEEDS: dict[str, Callable[[], NodeFeed | HubFeed]] = {
    "sensor_radar_node": sensor_radar_node,
    "sensor_radar_hub": sensor_radar_hub,
    "through_wall_node": through_wall_node,
    "through_wall_hub": through_wall_hub,
    "through_wall_3d_hub": through_wall_3d_hub,
}
#: What else, the most instructions of which are measured; `worst_case`: that its capacities let in.
OTHERS: dict[str, dict[str, Callable[[], NodeFeed | HubFeed]]] = {
    "sensor_radar_hub": {"worst_case": lambda: crowd(16, 16)},
    "through_wall_node": {"stairs": lambda: stairs_node(700), "worst_case": lambda: stairs_node(1920)},
    "through_wall_hub": {"worst_case": lambda: traces_at_random(2)},
    "through_wall_3d_hub": {"worst_case": cross_at_random},
}

Figures = dict[str, int]


def limits() -> dict[str, Any]:
    """Return limits.toml."""
    return tomllib.loads((HERE / "limits.toml").read_text())


def run(image: str, feed: NodeFeed | HubFeed) -> Machine:
    """Let an image work on all that it is fed with; the machine, with its profile of each scan or frame."""
    return run_node(image, feed) if isinstance(feed, NodeFeed) else run_hub(image, feed)


def run_node(image: str, feed: NodeFeed) -> Machine:
    """Let a node process its scans; the machine, with its profile of each scan."""
    source = feed.source
    with open_board("cortex-m7", image, source.name, source.node_id) as board:
        node = Machine(board, source.node_id)
        node.configure(feed.config)
        node.show_empty_room([] if source.reference is None else list(source.reference))
        for index, samples in enumerate(source.scans):
            time_us = (index + 1) * feed.period_us
            node.step(time_us, scan=np.ascontiguousarray(samples, np.float32), scan_time_us=time_us)
    if len(node.profiles) != len(source.scans):
        raise RuntimeError(f"{len(node.profiles)} of {len(source.scans)} scans were processed")
    return node


def run_hub(image: str, feed: HubFeed) -> Machine:
    """Let a hub process the reports of each frame; the machine, with its profile of each frame."""
    with open_board("cortex-m7", image, "hub", HUB_ID) as board:
        hub = Machine(board, HUB_ID)
        hub.configure(feed.config)
        for index, reports in enumerate(feed.frames):
            hub.step((index + 1) * feed.period_us, reports)
    if len(hub.profiles) != len(feed.frames):
        raise RuntimeError(f"{len(hub.profiles)} of {len(feed.frames)} frames were closed")
    return hub


@cache
def measure(name: str) -> Figures:
    """Return all figures of an image."""
    image = firmware_image("cortex-m7", name)
    size = image_size(image)
    machine = run(name, FEEDS[name]())
    totals = [profile[PROFILE_TOTAL] for profile in machine.profiles]
    figures = {
        "flash_bytes": size.flash_bytes,
        "ram_bytes": size.ram_bytes,
        "stack_bytes": deepest(functions(image), "main", limits()["calls_through_pointers"]).n_bytes,
        "stack_painted_bytes": machine.stack_bytes,
        "instructions_mean": round(np.mean(totals)),
        "instructions_max": max(totals),
    }
    stages = dict.fromkeys(tap for profile in machine.profiles for tap in profile if tap != PROFILE_TOTAL)
    for tap in stages:  # in the order in which they run
        counts = [profile[tap] for profile in machine.profiles if tap in profile]
        figures[f"instructions_of_{_core.TAPS[tap][0]}"] = round(np.mean(counts))
    for other, feed in OTHERS.get(name, {}).items():
        profiles = run(name, feed()).profiles
        figures[f"instructions_{other}"] = max(profile[PROFILE_TOTAL] for profile in profiles)
    return figures


def instructions_together(hub: str, asked: dict[str, Any]) -> int:
    """Return the longest that nodes and hub take from raw samples to tracks, one after the other."""
    node = measure(asked["node"])[asked.get("of_node", "instructions_max")]
    return asked["nodes"] * node + measure(hub)["instructions_max"]


def heap_symbols(image: Path) -> list[str]:
    """Return what of the heap and of exceptions is in an image."""
    listed = subprocess.run(["arm-none-eabi-nm", image], check=True, capture_output=True, text=True).stdout
    names = [line.split()[-1] for line in listed.splitlines()]
    return sorted(name for name in names if name in FORBIDDEN or name.startswith(FORBIDDEN_OPERATORS))


def main() -> int:
    """Print the figures; with --update, make them the budgets."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--update", action="store_true", help="write budgets.toml")
    options = parser.parse_args()
    lines = ["# Written by `make budgets`. A measured figure may differ by 3 %, up or down."]
    for entry in limits()["image"]:
        figures = measure(entry["name"])
        lines += ["", f"[{entry['name']}]", *(f"{name} = {value}" for name, value in figures.items())]
        print(f"\n| {entry['name']} | asked | measured |\n|---|---|---|")
        for name, value in figures.items():
            asked = entry["at_most"].get(name)
            print(f"| {name.replace('_', ' ')} | {'' if asked is None else f'<= {asked:,}'} | {value:,} |")
    for hub, asked in limits()["together"].items():
        most = instructions_together(hub, asked)
        print(f"\n{hub} and {asked['nodes']} of {asked['node']}: {most:,}, <= {asked['instructions_max']:,}")
    if options.update:
        BUDGETS.write_text("\n".join(lines) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
