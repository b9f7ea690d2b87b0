"""What the emulation needs of a machine, whatever it runs on: bytes in, bytes out, one step at a time."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse import _core

__all__ = ["Machine", "ScanInput", "StepOutput", "Target", "by_frame", "named_taps"]


def by_frame(taps: Iterable[tuple[str, NDArray[np.float32]]]) -> Iterator[dict[str, NDArray[np.float32]]]:
    """Yield the taps of each frame that a hub has closed; "frame" is the first of them."""
    frame: dict[str, NDArray[np.float32]] = {}
    for name, values in taps:
        if name == "frame" and frame:
            yield frame
            frame = {}
        frame[name] = values
    if frame:
        yield frame


def named_taps(taps: Iterable[tuple[int, NDArray[np.float32]]]) -> list[tuple[str, NDArray[np.float32]]]:
    """Return taps (TapId, values) by their names, a row an item where there are columns (core/tap.hpp)."""
    named = []
    for tap, values in taps:
        name, columns = _core.TAPS[tap]
        named.append((name, values.reshape(-1, columns) if columns else values))
    return named


class ScanInput(NamedTuple):
    """A raw scan as the radar's front-end gives it."""

    time_us: int  # the machine's clock [us] when it was taken
    samples: NDArray[np.float32]  # (n_samples,) [count]


@dataclass(kw_only=True)
class StepOutput:
    """What a machine did in one step."""

    link_out: bytes = b""  # what it put on the link: whole frames
    taps: Sequence[
        tuple[str, NDArray[np.float32]]
    ] = ()  # by name (core/tap.hpp), in the order in which they came
    profile: dict[str, int] = field(default_factory=dict)  # ticks by the tap that ended a stage
    total_ticks: int | None = None  # of the pipeline's work in this step; None when the target counts none


class Machine(Protocol):
    """A node or a hub that runs. It lives from its opening until close(): a restart opens another one."""

    def step(
        self, now_us: int, link_in: bytes = b"", scan: ScanInput | None = None, *, taps: bool = False
    ) -> StepOutput:
        """Let it work at one moment of its own clock [us], with what has arrived; a hub gets no scans."""
        ...

    def counters(self, now_us: int) -> dict[str, int]:
        """Return what it has counted since its opening, by the names of NodeHealth (`codec.HEALTH_VALUES`).

        Asked once, at the end of its life. It may be stepped for that, at now_us or later.
        """
        ...

    def close(self) -> None:
        """Switch it off."""
        ...


class Target(Protocol):
    """Where the machines of one site run."""

    name: str  # as the command line has it

    def open_node(self, index: int) -> Machine:
        """Start the node of the recording's index-th radar, configured and with its empty room."""
        ...

    def open_hub(self) -> Machine:
        """Start the hub, configured."""
        ...

    def close(self) -> None:
        """Give back what the target holds beside its machines."""
        ...
