"""Steps one emulated board: its front-end and trace through named pipes, its link through a Unix socket.

Twin of `firmware_sim/lockstep.hpp`, whose comment says who sends what when. Nothing here depends on the wall
clock but the limit after which a wait is given up, and then the error names who waited for what.
"""

import os
import select
import socket
import struct
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from echofuse.errors import TargetError

STEP = struct.Struct(
    "<IIqqIIII"
)  # magic, sequence, now_us, scan_time_us, n_samples, link_bytes, flags, reserved
TRACE = struct.Struct("<IIBBHI")  # magic, sequence, kind, id, reserved, n_bytes
DONE = struct.Struct("<II")  # link bytes sent, link bytes received
STEP_MAGIC, TRACE_MAGIC = 0x50455453, 0x43415254
STEP_STOP, STEP_TAPS = 1, 2
TRACE_DONE, TRACE_TAP, TRACE_PROFILE, TRACE_FAULT, TRACE_STACK = range(5)
PROFILE_TOTAL = 255

HEALTH_AFTER_US = 1_100_000  # a machine tells what it has counted once a second
PATIENCE_S = 30.0  # a step of the slowest board takes less than one second


class BoardError(TargetError):
    """A board that ended, broke a promise, or did not answer in time; it says what was waited for."""


class Places(NamedTuple):
    """Where a board finds its channels."""

    link: Path  # a Unix socket that listens
    front_end: Path  # a named pipe to read
    trace: Path  # a named pipe to write


@dataclass
class StepOutput:
    """What a board said in one step."""

    link: bytes = b""  # what it put on the link
    taps: list[tuple[int, NDArray[np.float32]]] = field(default_factory=list)  # (TapId, values)
    profile: dict[int, int] = field(default_factory=dict)  # TapId that ended a stage, or 255: ticks
    stack_bytes: int | None = None


class Board:
    """One running board. `command` makes its command line from the places of its channels."""

    def __init__(
        self,
        name: str,
        command: Callable[[Places], Sequence[str]],
        *,
        patience_s: float = PATIENCE_S,
    ):
        self.name = name
        self._patience_s = patience_s
        self._folder = tempfile.TemporaryDirectory(prefix="echofuse-")
        folder = Path(self._folder.name)
        places = Places(folder / "link", folder / "front-end", folder / "trace")
        os.mkfifo(places.front_end)
        os.mkfifo(places.trace)
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(str(places.link))
        listener.listen(1)
        listener.settimeout(0.05)
        # Opened for both directions, a pipe waits for nobody; its end is seen from its process.
        self._front_end = os.open(places.front_end, os.O_RDWR)
        self._trace = os.open(places.trace, os.O_RDWR)
        self._errors = (folder / "errors").open("w+b")
        self._process = subprocess.Popen(
            list(command(places)), stdin=subprocess.DEVNULL, stdout=self._errors, stderr=self._errors
        )
        self._sequence = 0
        self._heard = "nothing"
        self._link_in = self._link_out = 0  # bytes since the start, modulo 2^32
        try:
            self._link = self._accepted(listener)
            self._collect(StepOutput(), "its start")
        except BaseException:
            self._kill()
            raise
        finally:
            listener.close()

    def step(
        self,
        now_us: int,
        link: bytes = b"",
        *,
        scan: NDArray[np.float32] | None = None,
        scan_time_us: int = 0,
        taps: bool = False,
    ) -> StepOutput:
        """Let the board work at one moment of its clock, and return all that it did.

        scan: (n_samples,) float32 [count], or None. link: bytes that have arrived for it.
        """
        samples = b"" if scan is None else np.ascontiguousarray(scan, "<f4").tobytes()
        self._sequence += 1
        self._link_in = (self._link_in + len(link)) & 0xFFFFFFFF
        flags = STEP_TAPS if taps else 0
        header = STEP.pack(
            STEP_MAGIC, self._sequence, now_us, scan_time_us, len(samples) // 4, self._link_in, flags, 0
        )
        purpose = f"step {self._sequence} ({now_us * 1e-6:.6f} s{', with a scan' if samples else ''})"
        self._send_link(link, purpose)
        self._write(header + samples, purpose)
        output = StepOutput()
        self._collect(output, purpose)
        return output

    def ask_health(self, now_us: int) -> StepOutput:
        """Let the board work until it says what it has counted, once a second of its clock."""
        return self.step(now_us + HEALTH_AFTER_US)

    def close(self) -> None:
        """Switch the board off and wait for its end."""
        if self._process.poll() is None:
            stop = STEP.pack(STEP_MAGIC, self._sequence + 1, 0, 0, 0, self._link_in, STEP_STOP, 0)
            try:
                self._write(stop, "its end")
                self._process.wait(self._patience_s)
            except (BoardError, subprocess.TimeoutExpired):
                pass
        self._kill()

    def kill(self) -> None:
        """Cut the power: an injected crash."""
        self._kill()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _accepted(self, listener: socket.socket) -> socket.socket:
        deadline = time.monotonic() + self._patience_s
        while True:
            try:
                link, _ = listener.accept()
                link.setblocking(False)
                return link
            except TimeoutError:
                self._check_alive("to join the link")
                if time.monotonic() > deadline:
                    raise self._late("to join the link") from None

    def _collect(self, output: StepOutput, purpose: str) -> None:
        """Read the trace until the board is done, and then the rest of what it put on the link."""
        while True:
            magic, sequence, kind, id_, _, n_bytes = TRACE.unpack(
                self._read_trace(TRACE.size, purpose, output)
            )
            payload = self._read_trace(n_bytes, purpose, output)
            if magic == TRACE_MAGIC and kind == TRACE_FAULT:  # whatever step the board believes to be in
                raise BoardError(
                    f"{self.name}: fault in {purpose}: {payload.decode(errors='replace').strip()}"
                )
            if magic != TRACE_MAGIC or sequence != self._sequence:
                raise BoardError(f"{self.name}: trace out of step in {purpose}: it says step {sequence}")
            self._heard = f"trace {kind}/{id_} of step {sequence}"
            if kind == TRACE_TAP:
                output.taps.append((id_, np.frombuffer(payload, "<f4")))
            elif kind == TRACE_PROFILE:
                output.profile[id_] = int.from_bytes(payload, "little")
            elif kind == TRACE_STACK:
                output.stack_bytes = int.from_bytes(payload, "little")
            elif kind == TRACE_DONE:
                break
        sent, received = DONE.unpack(payload)
        if received != self._link_in:
            raise BoardError(
                f"{self.name}: took {received} bytes of the link in {purpose}, not {self._link_in}"
            )
        while self._link_out != sent:
            self._wait_readable(self._link.fileno(), f"the link's byte {sent} of {purpose}")
            self._take_link(output, purpose)

    def _take_link(self, output: StepOutput, purpose: str) -> None:
        try:
            received = self._link.recv(65536)
        except BlockingIOError:
            return
        if not received:
            with suppress(subprocess.TimeoutExpired):  # its end shows on the link before its status is there
                self._process.wait(1.0)
            self._check_alive(purpose)
            raise BoardError(f"{self.name}: left the link while the emulation waited for {purpose}")
        output.link += received
        self._link_out = (self._link_out + len(received)) & 0xFFFFFFFF

    def _read_trace(self, size: int, purpose: str, output: StepOutput) -> bytes:
        parts: list[bytes] = []
        while size > 0:
            self._wait_readable(self._trace, purpose, drain=output)
            part = os.read(self._trace, size)
            parts.append(part)
            size -= len(part)
        return b"".join(parts)

    def _wait_readable(self, file: int, purpose: str, drain: StepOutput | None = None) -> None:
        """Wait for a file, and keep the link from filling up meanwhile, so that the board can go on."""
        deadline = time.monotonic() + self._patience_s
        watched = [file] if drain is None else [file, self._link.fileno()]
        while True:
            ready, _, _ = select.select(watched, [], [], 0.5)
            if file in ready:
                return
            if ready and drain is not None:
                self._take_link(drain, purpose)
                continue
            self._check_alive(purpose)
            if time.monotonic() > deadline:
                raise self._late(purpose)

    def _write(self, data: bytes, purpose: str) -> None:
        self._all_written(self._front_end, lambda rest: os.write(self._front_end, rest), data, purpose)

    def _send_link(self, data: bytes, purpose: str) -> None:
        self._all_written(self._link.fileno(), self._link.send, data, purpose)

    def _all_written(self, file: int, write: Callable[[bytes], int], data: bytes, purpose: str) -> None:
        deadline = time.monotonic() + self._patience_s
        while data:
            _, ready, _ = select.select([], [file], [], 0.5)
            if ready:
                data = data[write(data[:4096]) :]
                continue
            self._check_alive(purpose)
            if time.monotonic() > deadline:
                raise self._late(f"room for {purpose}")

    def _check_alive(self, purpose: str) -> None:
        status = self._process.poll()
        if status is None:
            return
        self._errors.seek(0)
        said = self._errors.read().decode(errors="replace").strip().splitlines()
        raise BoardError(
            f"{self.name}: ended with status {status} while the emulation waited for {purpose}"
            + (f"; it said: {said[-1]}" if said else "")
        )

    def _late(self, purpose: str) -> BoardError:
        return BoardError(
            f"{self.name}: no answer for {self._patience_s:g} s while the emulation waited for {purpose}; "
            f"heard last: {self._heard}"
        )

    def _kill(self) -> None:
        self._process.kill()
        self._process.wait()
        if hasattr(self, "_link"):
            self._link.close()
        for file in (self._front_end, self._trace):
            if file >= 0:
                os.close(file)
        self._front_end = self._trace = -1
        self._errors.close()
        self._folder.cleanup()
