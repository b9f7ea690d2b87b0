"""Where firmware runs: as a host process, or on a bare Cortex-M7 in QEMU."""

import os
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

from echofuse.emulation.lockstep import Board, Places
from echofuse.errors import TargetError, problem

FIRMWARE_TARGETS = ("process", "cortex-m7")
_SUFFIX = {"process": "", "cortex-m7": ".elf"}


def firmware_image(target: str, role: str) -> Path:
    """Return the image of a role, "node" or "hub": in the folder ECHOFUSE_FIRMWARE, or in the package."""
    named = os.environ.get("ECHOFUSE_FIRMWARE")
    folder = Path(named) if named else Path(__file__).parents[2] / "firmware"
    image = folder / target / f"sensor_radar_{role}{_SUFFIX[target]}"
    if not image.is_file():
        hint = "make firmware" if target == "cortex-m7" else "make build"
        raise TargetError(problem(image, "", f"a firmware image for the target {target} (`{hint}` makes it)"))
    return image


def open_board(target: str, role: str, name: str, node_id: int) -> Board:
    """Start the firmware of `role` under a node id; the board waits for its first step."""
    if target not in FIRMWARE_TARGETS:
        raise TargetError(f"target {target}: expected one of {', '.join(FIRMWARE_TARGETS)}")
    image = firmware_image(target, role)
    command = _process(image, node_id) if target == "process" else _cortex_m7(image, node_id)
    return Board(f"{name} ({target})", command)


def _process(image: Path, node_id: int) -> Callable[[Places], Sequence[str]]:
    return lambda places: [
        str(image),
        *("--node-id", str(node_id)),
        *("--link", f"unix:{places.link}"),
        *("--front-end", str(places.front_end)),
        *("--trace", str(places.trace)),
    ]


def _cortex_m7(image: Path, node_id: int) -> Callable[[Places], Sequence[str]]:
    qemu = shutil.which("qemu-system-arm")
    if qemu is None:
        raise TargetError("target cortex-m7: qemu-system-arm is missing (`make firmware` installs it)")
    return lambda places: [
        *(qemu, "-M", "mps2-an500", "-display", "none", "-monitor", "none", "-icount", "shift=0"),
        *("-kernel", str(image), "-semihosting-config", "enable=on,target=native"),
        *("-append", f"--node-id {node_id} --front-end {places.front_end} --trace {places.trace}"),
        *("-chardev", f"socket,id=link,path={places.link}", "-serial", "chardev:link"),
    ]
