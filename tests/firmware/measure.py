"""Measures the images of build/cortex-m7.

python tests/firmware/measure.py            the figures, as README's table
python tests/firmware/measure.py --update   and into budgets.toml
"""

import argparse
import re
import struct
import subprocess
import sys
import tempfile
import tomllib
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from board import PROFILE, STACK, TAP, TOTAL, Board
from material import PERIOD_US, Feed, case_study, crowd
from static_stack import deepest, functions

from echofuse.emulation.image_size import image_size

HERE = Path(__file__).parent
BUILD = HERE.parents[1] / "build" / "cortex-m7"
BUDGETS = HERE / "budgets.toml"
TOLERANCE = 0.03  # in both directions
FORBIDDEN = {"malloc", "free", "calloc", "realloc", "_malloc_r", "_free_r", "_sbrk"}
FORBIDDEN |= {"__cxa_throw", "__cxa_guard_acquire"}
FORBIDDEN_OPERATORS = ("_Znw", "_Zna", "_Zdl", "_Zda")  # new and delete

Figures = dict[str, int]


@dataclass
class Run:
    """What an image did with a feed."""

    totals: list[int]  # instructions of each step
    stages: dict[int, list[int]]  # the same by the tap that ends a stage
    answers: list[bytes]  # the last tap of each step
    stack_bytes: int  # deepest use, painted


def limits() -> dict[str, Any]:
    """Return limits.toml."""
    return tomllib.loads((HERE / "limits.toml").read_text())


def run(image: Path, feed: Feed, *, marks: bool = False) -> Run:
    """Feed an image, step by step."""
    result = Run([], defaultdict(list), [], 0)
    with tempfile.TemporaryDirectory() as folder, Board(image, Path(folder)) as board:
        board.step(feed.settings)
        for scan in feed.empty_room:
            board.step(scan, time_us=-1)
        for index, values in enumerate(feed.steps):
            for kind, identity, payload in board.step(values, time_us=(index + 1) * PERIOD_US, marks=marks):
                if kind == PROFILE and identity == TOTAL:
                    result.totals.append(struct.unpack("<I", payload)[0])
                elif kind == PROFILE:
                    result.stages[identity].append(struct.unpack("<I", payload)[0])
                elif kind == STACK:
                    result.stack_bytes = struct.unpack("<I", payload)[0]
                elif kind == TAP:
                    result.answers.append(payload)
        if status := board.stop():
            raise RuntimeError(f"{image.name} ended with {status}")
    return result


def stage_names() -> dict[int, str]:
    """Return the taps' names by their numbers, as `core/tap.hpp` gives them."""
    header = (HERE.parents[1] / "cpp/include/echofuse/core/tap.hpp").read_text()
    found = re.findall(r"^  k(\w+) = (\d+),", header, re.MULTILINE)
    return {int(number): re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower() for name, number in found}


def measure(entry: dict[str, Any]) -> Figures:
    """Return all figures of one image of limits.toml."""
    image = BUILD / entry["file"]
    size = image_size(image)
    found = functions(image)
    pointers = limits()["calls_through_pointers"]
    figures = {
        "flash_bytes": size.flash_bytes,
        "ram_bytes": size.ram_bytes,
        "stack_bytes": deepest(found, "main", pointers).n_bytes,
    }
    feeds = {"node": lambda: case_study()[0][0], "hub": lambda: case_study()[1]}
    if entry.get("feed"):
        feed = feeds[entry["feed"]]()
        plain, marked = run(image, feed), run(image, feed, marks=True)
        figures["stack_painted_bytes"] = plain.stack_bytes
        figures["instructions_mean"] = round(np.mean(plain.totals))
        figures["instructions_max"] = max(plain.totals)
        names = stage_names()
        for tap, counts in marked.stages.items():
            figures[f"instructions_of_{names[tap]}"] = round(np.mean(counts))
    if entry.get("feed") == "hub":
        figures["instructions_worst_case"] = max(run(image, crowd(16, 16)).totals)
    return figures


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
        figures = measure(entry)
        lines += ["", f"[{entry['name']}]", *(f"{name} = {value}" for name, value in figures.items())]
        print(f"\n| {entry['name']} | asked | measured |\n|---|---|---|")
        for name, value in figures.items():
            asked = entry["at_most"].get(name)
            print(f"| {name.replace('_', ' ')} | {'' if asked is None else f'<= {asked:,}'} | {value:,} |")
    if options.update:
        BUDGETS.write_text("\n".join(lines) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
