"""A user's own board behind a TCP port or a serial line: a node that takes its raw scans over the link.

It has no lockstep, so each step ends with a question to the board: it takes what comes in its order, so what
it has to say about a scan has come when the answer is there. Time is the scans' own, as they carry it.
"""

import struct
import time
from contextlib import suppress
from types import TracebackType
from typing import Any, NoReturn, Self

import numpy as np
from numpy.typing import NDArray

from echofuse.emulation import codec
from echofuse.emulation.codec import FrameReader, Transfer
from echofuse.emulation.lockstep import BoardError, StepOutput
from echofuse.errors import InputError, problem

__all__ = ["PortBoard", "is_port", "port_url"]

FENCE_ID = 0xF002  # who asks at the end of a step
BAUD = 115_200
IDENTIFY_S = 5.0  # a heartbeat comes every second
ANSWER_S, TRIES = 5.0, 3  # a raw scan takes 0.7 s at 115,200 bit/s
_TAP = struct.Struct("<BIHH")  # tap, scan, offset, size; then the count of values and they
_SCHEMES = ("tcp://", "serial:")


def is_port(target: str) -> bool:
    """Whether a target's name is the address of a board, or several with commas."""
    return target.startswith(_SCHEMES)


def port_url(address: str) -> str:
    """Return an address as pyserial takes it.

    Raises
    ------
    InputError
        It is neither tcp://HOST:PORT nor serial:DEVICE[@BAUD].
    """
    if address.startswith("tcp://"):
        host, colon, port = address.removeprefix("tcp://").rpartition(":")
        if colon and host and port.isdigit() and 0 < int(port) < 65536:
            return f"socket://{host}:{port}"
    elif address.startswith("serial:"):
        device, _, baud = address.removeprefix("serial:").partition("@")
        if device and (not baud or baud.isdigit()):
            return device
    raise InputError(problem("--target", "", "tcp://HOST:PORT or serial:DEVICE[@BAUD]", address))


class PortBoard:
    """The board at an address: a node, by its heartbeat and by what it calls itself."""

    def __init__(self, address: str, node_name: str) -> None:
        """node_name: what the board has to call itself, such as "echofuse.sensor_radar.node"."""
        import serial

        url = port_url(address)
        baud = address.partition("@")[2] if address.startswith("serial:") else ""
        self.address = self.name = address
        self._reader = FrameReader()
        self._asked = self._scans = 0
        self._taps_on = False
        try:
            self._line = serial.serial_for_url(url, baudrate=int(baud or BAUD), timeout=0.05)
        except (serial.SerialException, OSError, ValueError) as error:
            raise BoardError(f"{address}: cannot be opened: {_reason(error)}") from None
        try:
            self.node_id = self._identified(node_name)
            self._raw_scan_port = int(self._register("uavcan.sub.raw_scan.id"))
        except BaseException:
            self._line.close()
            raise

    @property
    def rejected(self) -> dict[str, int]:
        """What came over the line and was no frame, by reason."""
        return {name: count for name, count in self._reader.counters.items() if name != "frames"}

    def step(
        self,
        now_us: int,
        link: bytes = b"",
        *,
        scan: NDArray[np.float32] | None = None,
        scan_time_us: int = 0,
        taps: bool = False,
    ) -> StepOutput:
        """Give the board what arrives at one moment, and return all that it says to it.

        scan: (n_samples,) float32 [count], or None. The board's own clock stays its own.
        """
        if taps != self._taps_on:
            self._register("echofuse.taps", taps)
            self._taps_on = taps
        sent, what = link, f"{len(link)} bytes at {now_us * 1e-6:.6f} s"
        if scan is not None:
            payload = _time(scan_time_us) + len(scan).to_bytes(2, "little")
            payload += np.ascontiguousarray(scan, "<f4").tobytes()
            transfer = Transfer(codec.BROADCAST, self._raw_scan_port, self._scans, payload)
            self._scans += 1
            sent, what = sent + codec.frame(transfer), f"scan {self._scans - 1} ({scan_time_us * 1e-6:.6f} s)"
        if not sent:
            return StepOutput()
        fence = codec.register_read("uavcan.node.id")
        _, said = self._exchange(sent, codec.REGISTER_ACCESS, fence, what)
        output = StepOutput(link=b"".join(codec.frame(transfer) for transfer in said))
        output.taps = _assembled([t.payload for t in said if t.port == codec.TAP and t.kind == codec.MESSAGE])
        return output

    def ask_health(self, now_us: int) -> StepOutput:
        """Wait until the board next says what it has counted."""
        deadline = time.monotonic() + IDENTIFY_S
        while time.monotonic() < deadline:
            for transfer in self._heard():
                if transfer.port == codec.NODE_HEALTH and transfer.kind == codec.MESSAGE:
                    return StepOutput(link=codec.frame(transfer))
        raise BoardError(f"{self.name}: no NodeHealth for {IDENTIFY_S:g} s")

    def close(self) -> None:
        """Leave the line; the board goes on."""
        if self._taps_on:
            with suppress(BoardError):
                self._register("echofuse.taps", False)
        self._line.close()

    def kill(self) -> None:
        """A board that is not ours cannot be switched off."""
        raise BoardError(f"{self.name}: cannot be switched off from here")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _identified(self, node_name: str) -> int:
        """Wait for a heartbeat, and ask whose it is."""
        deadline = time.monotonic() + IDENTIFY_S
        while time.monotonic() < deadline:
            for transfer in self._heard():
                if transfer.port == codec.HEARTBEAT and transfer.kind == codec.MESSAGE:
                    self.node_id = transfer.source
                    name = codec.parse_name(self._ask(codec.GET_INFO, b"", "its name"))
                    if name != node_name:
                        raise BoardError(f"{self.name}: expected {node_name}, and it calls itself {name}")
                    return transfer.source
        raise BoardError(f"{self.name}: nobody there: no heartbeat for {IDENTIFY_S:g} s{self._noise()}")

    def _register(self, name: str, value: object = None) -> Any:
        request = codec.register_read(name) if value is None else codec.register_write(name, value)
        return codec.parse_register(self._ask(codec.REGISTER_ACCESS, request, f"the register {name}"))

    def _ask(self, service: int, request: bytes, what: str) -> bytes:
        """Return the payload of a service's answer."""
        answer, _ = self._exchange(b"", service, request, what)
        return answer

    def _exchange(self, data: bytes, service: int, request: bytes, what: str) -> tuple[bytes, list[Transfer]]:
        """Send bytes and a question; the answer's payload, and all that the board says until it comes."""
        said: list[Transfer] = []
        for _ in range(TRIES):  # the line may spoil a question or its answer
            self._asked += 1
            asked = Transfer(FENCE_ID, service, self._asked, request, codec.REQUEST, self.node_id)
            self._send(data + codec.frame(asked), what)
            data = b""
            deadline = time.monotonic() + ANSWER_S
            while time.monotonic() < deadline:
                for transfer in self._heard():
                    if transfer.kind != codec.RESPONSE or transfer.destination != FENCE_ID:
                        said.append(transfer)
                    elif transfer.transfer_id == self._asked:
                        return transfer.payload, said
        raise BoardError(f"{self.name}: no answer for {TRIES * ANSWER_S:g} s to {what}{self._noise()}")

    def _noise(self) -> str:
        counted = ", ".join(f"{name} {count}" for name, count in sorted(self.rejected.items()))
        return f"; what came was no frame: {counted}" if counted else ""

    def _send(self, data: bytes, what: str) -> None:
        try:
            self._line.write(data)
        except OSError as error:
            self._gone(what, error)

    def _heard(self) -> list[Transfer]:
        try:
            data = self._line.read(max(1, self._line.in_waiting))
        except OSError as error:
            self._gone("its next words", error)
        return list(self._reader.feed(data))

    def _gone(self, what: str, error: OSError) -> NoReturn:
        raise BoardError(
            f"{self.name}: left while the emulation waited for {what}: {_reason(error)}"
        ) from None


def _time(time_us: int) -> bytes:
    return (time_us & (1 << 56) - 1).to_bytes(7, "little")


def _reason(error: Exception) -> str:
    """Return what an error of the operating system says, without pyserial's wrapping."""
    inner = error.__context__ if isinstance(error.__context__, OSError) else error
    return (getattr(inner, "strerror", None) or str(inner)).lower()


def _assembled(payloads: list[bytes]) -> list[tuple[int, NDArray[np.float32]]]:
    """Put the pieces of Tap messages together; a tap of which a piece is missing is left out."""
    taps: list[tuple[int, NDArray[np.float32]]] = []
    parts: list[NDArray[np.float32]] = []
    for payload in payloads:
        tap, _, offset, size = _TAP.unpack_from(payload)
        values = np.frombuffer(payload[10:], "<f4", payload[9])
        if offset == 0:
            parts = []
        if offset != sum(map(len, parts)):
            continue
        parts.append(values)
        if offset + len(values) == size:
            taps.append((tap, np.concatenate(parts)))
            parts = []
    return taps
