"""A board in QEMU, given turns by hand: what `firmware_sim/lockstep.hpp` asks for, without a link."""

import os
import select
import struct
import subprocess
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

STEP_MAGIC, TRACE_MAGIC = 0x50455453, 0x43415254
DONE, TAP, PROFILE, FAULT, STACK = range(5)
STOP, TAPS = 1, 2
TOTAL = 255
TIMEOUT_S = 60.0

Trace = list[tuple[int, int, bytes]]  # kind, id, payload


class Board:
    """One machine with an image, from power on to power off."""

    def __init__(self, image: Path, folder: Path, *, machine: str = "mps2-an500") -> None:
        pipes = folder / "front_end", folder / "trace"
        for pipe in pipes:
            pipe.unlink(missing_ok=True)
            os.mkfifo(pipe)
        # Both ends here as well, so that opening waits for nobody and a machine that dies is told by poll().
        self._front_end, self._trace = (os.open(pipe, os.O_RDWR) for pipe in pipes)
        self._sequence = 0
        command = ["qemu-system-arm", "-M", machine, "-nographic", "-monitor", "none", "-serial", "null"]
        command += ["-icount", "shift=0", "-semihosting-config", "enable=on,target=native", "-kernel"]
        options = f"--node-id 7 --front-end {pipes[0]} --trace {pipes[1]}"
        self._process = subprocess.Popen(
            [*command, str(image), "-append", options], stdin=subprocess.DEVNULL, stderr=subprocess.PIPE
        )
        self._wait()

    def step(self, samples: ArrayLike = (), *, time_us: int = 0, marks: bool = False) -> Trace:
        """Give the board one turn; what it traced."""
        self._send(np.asarray(samples, "<f4").tobytes(), time_us, TAPS if marks else 0)
        return self._wait()

    def stop(self) -> int:
        """Power off; the exit status."""
        self._send(b"", 0, STOP)
        return self._process.wait(TIMEOUT_S)

    def _send(self, samples: bytes, time_us: int, flags: int) -> None:
        self._sequence += 1
        step = struct.pack(
            "<IIqqIIII", STEP_MAGIC, self._sequence, abs(time_us), time_us, len(samples) // 4, 0, flags, 0
        )
        os.write(self._front_end, step + samples)

    def _wait(self) -> Trace:
        trace: Trace = []
        while True:
            magic, sequence, kind, identity, _, n_bytes = struct.unpack("<IIBBHI", self._read(16))
            payload = self._read(n_bytes)
            if kind == FAULT:
                raise RuntimeError(payload.decode().strip())
            assert (magic, sequence) == (TRACE_MAGIC, self._sequence)
            if kind == DONE:
                return trace
            trace.append((kind, identity, payload))

    def _read(self, size: int) -> bytes:
        data = b""
        while len(data) < size:
            patience_s = TIMEOUT_S if self._process.poll() is None else 0.5
            if not select.select([self._trace], [], [], patience_s)[0]:
                raise RuntimeError(f"the board is silent since step {self._sequence}")
            data += os.read(self._trace, size - len(data))
        return data

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._process.poll() is None:
            self._process.kill()
        self._process.communicate()
        os.close(self._front_end)
        os.close(self._trace)
