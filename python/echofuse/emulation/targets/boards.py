"""Where firmware runs: as a host process, on a bare Cortex-M7 in QEMU, or on a user's own board."""

import os
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path

from echofuse.emulation.lockstep import Board, Places
from echofuse.emulation.targets.port import PortBoard, is_port
from echofuse.errors import TargetError, problem

AnyBoard = Board | PortBoard
FIRMWARE_TARGETS = ("process", "cortex-m7")
_SUFFIX = {"process": "", "cortex-m7": ".elf"}
#: By a site's pipeline and a role: what an image's name, and what its boards call themselves, begin with.
FAMILIES = {
    "sensor_radar": {"node": "sensor_radar", "hub": "sensor_radar"},
    "through_wall_2d": {"node": "through_wall", "hub": "through_wall"},
    "through_wall_3d": {"node": "through_wall", "hub": "through_wall_3d"},
}


def image_name(pipeline: str, role: str) -> str:
    """Return the name of the image of a pipeline and a role, "node" or "hub"."""
    return f"{FAMILIES[pipeline][role]}_{role}"


def firmware_image(target: str, image: str) -> Path:
    """Return the file of an image by its name: in the folder ECHOFUSE_FIRMWARE, or in the package."""
    named = os.environ.get("ECHOFUSE_FIRMWARE")
    folder = Path(named) if named else Path(__file__).parents[2] / "firmware"
    file = folder / target / f"{image}{_SUFFIX[target]}"
    if not file.is_file():
        hint = "make firmware" if target == "cortex-m7" else "make build"
        raise TargetError(problem(file, "", f"a firmware image for the target {target} (`{hint}` makes it)"))
    return file


class BoardOpener:
    """Starts the boards of a target: of its kind, or at its addresses, with host processes for all others."""

    def __init__(self, target: str, pipeline: str) -> None:
        """target: one of FIRMWARE_TARGETS, or addresses of boards with commas between them."""
        self.target = target
        self._pipeline = pipeline
        self._kind = "process" if is_port(target) else target
        self._waiting: dict[int, PortBoard] = {}  # by node id
        self._taken: dict[int, PortBoard] = {}
        try:
            for address in target.split(",") if is_port(target) else ():
                board = PortBoard(address, f"echofuse.{FAMILIES[pipeline]['node']}.node")
                other = self._waiting.setdefault(board.node_id, board)
                if other is not board:
                    board.close()
                    raise TargetError(f"{address}: node {board.node_id}, as at {other.address}")
        except BaseException:
            self.close()
            raise

    def __call__(self, role: str, name: str, node_id: int) -> AnyBoard:
        """Start the firmware of a role ("node", "hub") by a name and a node id."""
        if node_id in self._taken:
            address = self._taken[node_id].address
            raise TargetError(f"{address}: the board there cannot be switched off and on from here")
        if role == "node" and node_id in self._waiting:
            board = self._taken[node_id] = self._waiting.pop(node_id)
            board.name = f"{name} ({board.address})"
            return board
        return open_board(self._kind, image_name(self._pipeline, role), name, node_id)

    def free_id(self) -> int:
        """Return the id of a node that answers at an address and is not in use yet, or else one of nobody."""
        return next(iter(self._waiting), max(self._taken, default=0) + 1)

    def check_all_taken(self, site: str) -> None:
        """Raise when a board answers at an address and is no node of the site."""
        for node_id, board in self._waiting.items():
            raise TargetError(f"{board.address}: node {node_id} answers there, which {site} does not list")

    @property
    def rejected(self) -> dict[str, dict[str, int]]:
        """What came over the lines and was no frame, by address and reason."""
        return {board.address: board.rejected for board in self._taken.values()}

    def close(self) -> None:
        """Leave the lines that nobody took."""
        while self._waiting:
            self._waiting.popitem()[1].close()


def open_board(target: str, image: str, name: str, node_id: int) -> Board:
    """Start an image, such as "sensor_radar_node", under a node id; the board waits for its first step."""
    if target not in FIRMWARE_TARGETS:
        raise TargetError(f"target {target}: expected one of {', '.join(FIRMWARE_TARGETS)}")
    file = firmware_image(target, image)
    command = _process(file, node_id) if target == "process" else _cortex_m7(file, node_id)
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
