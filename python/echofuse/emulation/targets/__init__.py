"""Where nodes and hub run: `open_target` gives the machines of one site for a name of the command line."""

from collections.abc import Callable, Sequence

from echofuse.emulation.machine import Target
from echofuse.emulation.targets.boards import (
    FIRMWARE_TARGETS,
    BoardOpener,
    firmware_image,
    image_name,
    open_board,
)
from echofuse.emulation.targets.port import is_port, port_url
from echofuse.errors import InputError, problem
from echofuse.recording import NodeRecording
from echofuse.site import Site

__all__ = [
    "FIRMWARE_TARGETS",
    "TARGETS",
    "BoardOpener",
    "firmware_image",
    "image_name",
    "is_port",
    "open_board",
    "open_target",
    "port_url",
]

Opener = Callable[[str, Site, Sequence[NodeRecording]], Target]


def _inprocess(name: str, site: Site, sources: Sequence[NodeRecording]) -> Target:
    from echofuse.emulation.targets.inprocess import InProcessTarget

    return InProcessTarget(site, sources)


def _firmware(name: str, site: Site, sources: Sequence[NodeRecording]) -> Target:
    from echofuse.emulation.targets.firmware import FirmwareTarget

    return FirmwareTarget(name, site, sources)


#: By name, or by what a name begins with ("tcp:").
TARGETS: dict[str, Opener] = {
    "inprocess": _inprocess,
    **dict.fromkeys((*FIRMWARE_TARGETS, "tcp:", "serial:"), _firmware),
}


def open_target(name: str, site: Site, sources: Sequence[NodeRecording]) -> Target:
    """Return the target of a name, for the machines of one site and the radars of one recording."""
    opener = TARGETS.get(name) or TARGETS.get(name.partition(":")[0] + ":")
    if opener is None:
        raise InputError(problem("--target", "", f"one of {', '.join(TARGETS)}", name))
    return opener(name, site, sources)
