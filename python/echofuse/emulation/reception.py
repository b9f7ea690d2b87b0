"""What a machine on the link takes from its bytes: valid transfers, each once."""

from collections.abc import Iterator

from echofuse.emulation.codec import BROADCAST, FrameReader, Transfer

__all__ = ["REJECTED", "Receiver"]

TRANSFER_ID_TIMEOUT_US = 2_000_000

#: Why a reader takes nothing from what stands between two delimiters (cpp/include/echofuse/link/frame.hpp).
REJECTED = ("bad_cobs", "bad_length", "bad_version", "bad_header_crc", "bad_payload_crc", "multi_frame")


class Receiver:
    """A frame reader that knows a repetition when it sees one."""

    def __init__(self) -> None:
        self._reader = FrameReader()
        self._repeated = 0
        self._last: dict[tuple[int, int, int, int], tuple[int, int]] = {}  # session -> transfer id, time [us]

    def feed(self, data: bytes, now_us: int) -> Iterator[Transfer]:
        """Yield the transfers that these bytes complete, but none that is the last of its session again."""
        for transfer in self._reader.feed(data):
            session = (transfer.source, transfer.destination, transfer.port, transfer.kind)
            last = self._last.get(session)
            self._last[session] = (transfer.transfer_id, now_us)
            recent = last is not None and now_us - last[1] < TRANSFER_ID_TIMEOUT_US
            if (
                transfer.source != BROADCAST
                and recent
                and last is not None
                and last[0] == transfer.transfer_id
            ):
                self._repeated += 1
                continue
            yield transfer

    def counters(self) -> dict[str, int]:
        """Return what became of every stretch between two delimiters, by the names of FrameCounters."""
        counted = self._reader.counters
        frames = {"frames": counted["frames"] - self._repeated, "repeated": self._repeated}
        return frames | {name: counted[name] for name in REJECTED}
