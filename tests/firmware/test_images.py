"""The bare-metal images: no heap, inside their budgets, and faults that are told.

What they answer is tests/hil's. They are built by `make firmware`; an image, a compiler or an emulator
that is missing is an error.
"""

import os
import struct
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest
from measure import BUDGETS, FEEDS, TOLERANCE, heap_symbols, instructions_together, limits, measure, run
from static_stack import Function, compilers_frames, deepest, functions, plain_name

from echofuse.emulation.image_size import image_size
from echofuse.emulation.lockstep import BoardError
from echofuse.emulation.targets import firmware_image, open_board
from echofuse.errors import InputError

IMAGES: list[dict[str, Any]] = limits()["image"]
BUILD = Path(__file__).parents[2] / "build" / "cortex-m7"
COMPILER = ["arm-none-eabi-g++", "-mcpu=cortex-m7", "-mthumb", "-O2", "-ffunction-sections", "-nostartfiles"]


def image_of(entry: dict[str, Any]) -> Path:
    return firmware_image("cortex-m7", entry["name"])


def names(entry: dict[str, Any]) -> str:
    return entry["name"]


def compiled(folder: Path, source: str) -> Path:
    """A program that is only looked at."""
    image = folder / "program.elf"
    command = [
        *COMPILER,
        "--specs=nosys.specs",
        "-Wl,-emain,--defsym=__dso_handle=0",
        "-x",
        "c++",
        "-",
        "-o",
        str(image),
    ]
    subprocess.run(command, input=source, text=True, check=True, capture_output=True)
    return image


@pytest.mark.parametrize("entry", IMAGES, ids=names)
def test_no_image_has_a_heap_or_exceptions(entry: dict[str, Any]) -> None:
    assert heap_symbols(image_of(entry)) == []


def test_a_heap_would_be_seen(tmp_path: Path) -> None:
    source = "int main(int n, char**) { volatile int* p = new int[n]; int v = *p; delete[] p; return v; }"
    assert {"malloc", "free", "_Znaj"} <= set(heap_symbols(compiled(tmp_path, source)))


@pytest.mark.parametrize("entry", IMAGES, ids=names)
def test_an_image_holds_its_own_pipeline_alone(entry: dict[str, Any]) -> None:
    listed = subprocess.run(
        ["arm-none-eabi-nm", image_of(entry)], check=True, capture_output=True, text=True
    ).stdout
    pipelines = {
        "sensor_radar": {"SensorRadar"},
        "through_wall_node": {"ThroughWall"},
        "through_wall_hub": {"ThroughWall", "ThroughWallHub"},
        "through_wall_3d": {"ThroughWall", "ThroughWall3dHub"},
    }
    (expected,) = (held for name, held in pipelines.items() if entry["name"].startswith(name))
    assert {pipeline for pipeline in set().union(*pipelines.values()) if pipeline in listed} == expected


@pytest.mark.parametrize("entry", IMAGES, ids=names)
def test_an_image_keeps_its_budgets(entry: dict[str, Any]) -> None:
    budgets = tomllib.loads(BUDGETS.read_text())[entry["name"]]
    measured = measure(entry["name"])
    too_much = {name: measured[name] for name, most in entry["at_most"].items() if measured[name] > most}
    assert too_much == {}
    off = {
        name: (budgets.get(name), value)
        for name, value in measured.items()
        if name not in budgets or abs(value - budgets[name]) > TOLERANCE * budgets[name]
    }
    assert off == {}, "budget and measured figure; `make budgets` records what is meant"


@pytest.mark.parametrize(("hub", "asked"), limits()["together"].items())
def test_from_raw_samples_to_tracks_nodes_and_hub_keep_their_budget(hub: str, asked: dict[str, Any]) -> None:
    assert instructions_together(hub, asked) <= asked["instructions_max"]


@pytest.mark.parametrize("entry", IMAGES, ids=names)
def test_the_stack_in_use_is_inside_the_stack_that_the_calls_add_up_to(entry: dict[str, Any]) -> None:
    budgets = tomllib.loads(BUDGETS.read_text())[entry["name"]]
    assert (
        budgets["stack_painted_bytes"] <= budgets["stack_bytes"] + 64
    )  # painted from 64 bytes below its top
    assert budgets["stack_bytes"] <= image_size(image_of(entry)).stack_bytes


@pytest.mark.parametrize("entry", IMAGES, ids=names)
def test_frames_are_those_of_the_compiler(entry: dict[str, Any]) -> None:
    """By name, without arguments; a name with more than one frame (overloads) must have one of them."""
    known = compilers_frames(BUILD)
    found = functions(image_of(entry))
    plain = subprocess.run(
        ["arm-none-eabi-c++filt", *found], check=True, capture_output=True, text=True
    ).stdout
    compared = 0
    for (symbol, function), name in zip(found.items(), map(plain_name, plain.splitlines()), strict=True):
        if "echofuse" not in name or name not in known or "." in symbol:  # ".": a split-off part
            continue
        compared += 1
        # The compiler leaves out padding and arguments in registers that it stores before its frame.
        assert any(0 <= function.frame_bytes - size <= 16 for size in known[name]), name
    assert compared > 50


def test_a_board_out_of_step_says_so_and_stops() -> None:
    with open_board("cortex-m7", "sensor_radar_node", "rx1", 1) as board:
        os.write(board._front_end, b"x" * 40)
        with pytest.raises(
            BoardError, match=r"fault in step 1 .*: front-end out of step \(.*board.cpp:\d+\)"
        ):
            board.step(1)


def test_growing_out_of_the_stack_is_a_fault(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The node's image with less stack than it needs."""
    data = bytearray(firmware_image("cortex-m7", "sensor_radar_node").read_bytes())
    stack_top = struct.unpack_from("<I", data, text_offset(data))[0]
    struct.pack_into("<I", data, text_offset(data), 0x20000000 + 1024)
    assert stack_top == 0x20000000 + 4096
    (tmp_path / "cortex-m7").mkdir()
    (tmp_path / "cortex-m7" / "sensor_radar_node.elf").write_bytes(data)
    monkeypatch.setenv("ECHOFUSE_FIRMWARE", str(tmp_path))
    with pytest.raises(BoardError, match=r"rx1 .*: fault in step .*: stack overflow"):
        run("sensor_radar_node", FEEDS["sensor_radar_node"]())


def text_offset(data: bytes) -> int:
    """Where the vector table lies in the file: at the begin of the first segment."""
    program_headers = struct.unpack_from("<I", data, 28)[0]
    return int(struct.unpack_from("<I", data, program_headers + 4)[0])


def test_image_size_refuses_what_is_no_image(tmp_path: Path) -> None:
    file = tmp_path / "image.elf"
    file.write_bytes(b"\x7fELF\x02\x01" + bytes(100))
    with pytest.raises(InputError, match="32-bit"):
        image_size(file)


def test_image_size_is_that_of_the_linker() -> None:
    image = firmware_image("cortex-m7", "sensor_radar_node")
    rows = subprocess.run(["arm-none-eabi-size", image], check=True, capture_output=True, text=True).stdout
    text, data, bss = map(int, rows.splitlines()[1].split()[:3])
    size = image_size(image)
    assert (size.flash_bytes, size.ram_bytes) == (text + data, data + bss)


class TestDeepest:
    def test_takes_the_deepest_way(self) -> None:
        found = {
            "main": Function(8, {"a", "b"}),
            "a": Function(100),
            "b": Function(16, {"c"}),
            "c": Function(90),
        }
        depth = deepest(found, "main", {})
        assert (depth.n_bytes, depth.path) == (114, ("main", "b", "c"))

    def test_refuses_recursion(self) -> None:
        with pytest.raises(ValueError, match="recursion: a -> b -> a"):
            deepest(
                {"main": Function(0, {"a"}), "a": Function(0, {"b"}), "b": Function(0, {"a"})}, "main", {}
            )

    def test_refuses_a_call_through_a_pointer_that_is_not_listed(self) -> None:
        found = {"main": Function(8, indirect=True), "sink": Function(40)}
        with pytest.raises(ValueError, match="pointer"):
            deepest(found, "main", {})
        assert deepest(found, "main", {"^main$": ["^sink$"]}).n_bytes == 48

    def test_refuses_a_frame_of_unknown_size(self) -> None:
        with pytest.raises(ValueError, match="unknown size"):
            deepest({"main": Function(8, dynamic=True)}, "main", {})

    def test_reads_frames_and_calls_of_real_code(self, tmp_path: Path) -> None:
        source = """
          extern "C" { void use(char*); [[gnu::noinline]] void leaf() { char room[200]; use(room); }
          [[gnu::noinline]] void use(char* p) { *(volatile char*)p = 1; }
          int main() { leaf(); return 0; } }
        """
        depth = deepest(functions(compiled(tmp_path, source)), "main", {})
        assert depth.path[:2] == ("main", "leaf")
        assert 200 + 16 <= depth.n_bytes <= 232


@pytest.mark.parametrize(
    ("signature", "name"),
    [
        (
            "echofuse::Status echofuse::node::X::process(echofuse::Span<const float>, int) const",
            "echofuse::node::X::process",
        ),
        ("void echofuse::{anonymous}::Assignment::enter(std::size_t)", "echofuse::Assignment::enter"),
        ("echofuse::(anonymous namespace)::Assignment::enter(unsigned int)", "echofuse::Assignment::enter"),
        ("void echofuse::f(int) [with int kStep = 1]", "echofuse::f"),
        ("main", "main"),
    ],
)
def test_plain_name(signature: str, name: str) -> None:
    assert plain_name(signature) == name
