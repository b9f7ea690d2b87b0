"""The deepest stack that an image can need: frames from its disassembly, joined along its calls.

The compiler's own figures (-fstack-usage) leave out the C library and know no call graph; what is found
here is compared with them.
"""

import re
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

_FUNCTION = re.compile(r"^[0-9a-f]{8} <(.+)>:$")
_INSTRUCTION = re.compile(r"^ *[0-9a-f]+:\t(\S+)(?:\t(.*))?$")
_TARGET = re.compile(r"^[0-9a-f]+ <([^+>]+)>$")
_BRANCH = re.compile(r"^(bl|b|b[a-z]{2})(\.[nw])?$")


@dataclass
class Function:
    """One function of an image."""

    frame_bytes: int = 0  # pushed and reserved
    calls: set[str] = field(default_factory=set)
    indirect: bool = False  # calls through a pointer
    dynamic: bool = False  # moves the stack by what only a run tells


def _lines(command: Sequence[str | Path]) -> Iterator[str]:
    yield from subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()


def functions(image: Path) -> dict[str, Function]:
    """All functions of an image by their symbols."""
    found: dict[str, Function] = {}
    name = ""
    for line in _lines(["arm-none-eabi-objdump", "-d", "--no-show-raw-insn", image]):
        if start := _FUNCTION.match(line):
            name = start[1]
            found[name] = Function()
        elif name and (instruction := _INSTRUCTION.match(line)):
            operands = re.split(r"[\t ]@", instruction[2] or "")[0].strip()  # without the comment
            _read(found[name], name, instruction[1], operands)
    return found


def _registers(listed: str) -> int:
    count = 0
    for part in listed.strip("{}").split(","):
        ends = [int(digits) for digits in re.findall(r"\d+", part)] if "-" in part else []
        count += ends[1] - ends[0] + 1 if len(ends) == 2 else 1
    return count


def _read(function: Function, name: str, operation: str, operands: str) -> None:
    plain = operation.removesuffix(".w").removesuffix(".n")
    if plain == "push" or (plain == "stmdb" and operands.startswith("sp!")):
        function.frame_bytes += 4 * _registers(operands.removeprefix("sp!, "))
    elif plain == "vpush":
        function.frame_bytes += (8 if "d" in operands else 4) * _registers(operands)
    elif plain in ("sub", "subw") and operands.startswith("sp, "):
        amount = re.search(r"#(\d+)$", operands)
        function.frame_bytes += int(amount[1]) if amount else 0
        function.dynamic |= amount is None
    elif plain.startswith(("str", "vstr")) and (moved := re.search(r"\[sp, #-(\d+)\]!", operands)):
        function.frame_bytes += int(moved[1])
    elif plain == "blx" or (plain == "bx" and operands != "lr"):
        function.indirect = True
    elif _BRANCH.match(operation) and (target := _TARGET.match(operands)):  # noqa: SIM102
        if plain == "bl" or target[1] != name:  # else it is a loop
            function.calls.add(target[1])


@dataclass(frozen=True)
class Depth:
    """The deepest way from one function."""

    n_bytes: int
    path: tuple[str, ...]


def deepest(found: dict[str, Function], root: str, indirect: dict[str, Sequence[str]]) -> Depth:
    """Follow the calls from root.

    indirect: who calls through a pointer, and whom: regular expressions on symbols.
    Raises ValueError for a call through a pointer that is not listed, recursion, or a frame of unknown size.
    """
    known: dict[str, Depth] = {}
    under_way: list[str] = []

    def targets(name: str) -> set[str]:
        function = found[name]
        calls = set(function.calls)
        if function.indirect:
            rules = [callees for caller, callees in indirect.items() if re.search(caller, name)]
            if not rules:
                raise ValueError(f"{name} calls through a pointer and is not listed")
            for pattern in (pattern for callees in rules for pattern in callees):
                calls |= {symbol for symbol in found if re.search(pattern, symbol)}
        return calls & found.keys()

    def visit(name: str) -> Depth:
        if name in known:
            return known[name]
        if name in under_way:
            raise ValueError("recursion: " + " -> ".join([*under_way[under_way.index(name) :], name]))
        if found[name].dynamic:
            raise ValueError(f"{name} has a frame of unknown size")
        under_way.append(name)
        depths = [visit(callee) for callee in sorted(targets(name))]
        below = max(depths, key=lambda depth: depth.n_bytes, default=Depth(0, ()))
        under_way.pop()
        known[name] = Depth(found[name].frame_bytes + below.n_bytes, (name, *below.path))
        return known[name]

    return visit(root)


def compilers_frames(build: Path) -> dict[str, set[int]]:
    """What -fstack-usage wrote: sizes [byte] by the function's name without types and arguments.

    Raises ValueError for a frame that is not static.
    """
    sizes: dict[str, set[int]] = {}
    for file in build.rglob("*.su"):
        for line in file.read_text().splitlines():
            where, n_bytes, kind = line.split("\t")
            if kind != "static":
                raise ValueError(f"{where}: a frame of unknown size")
            sizes.setdefault(plain_name(where.split(":", 3)[3]), set()).add(int(n_bytes))
    return sizes


def plain_name(signature: str) -> str:
    """Reduce a signature to its qualified name: the compiler and c++filt write types differently."""
    text = signature.replace("(anonymous namespace)", "{anonymous}").replace("::{anonymous}", "")
    depth, head = 0, ""
    for letter in text:
        if letter == "(" and depth == 0:
            break
        depth += (letter == "<") - (letter == ">")
        if depth == 0 and letter != ">":
            head += letter
    return head.split(" ")[-1].lstrip("*&")
