"""What a test gave to its boards, and what they say that they counted.

After every test here (conftest.py) each board is asked. A test that injects something says so, as in
`injected("rx1", rejected_scans=1)`. All other counters of trouble must be zero, on every board that was
started, and the counters of work must be those of the scans and frames that it was given. No board gets
around this: whatever opens one goes through `lockstep.Board`.
"""

from collections import Counter
from collections.abc import Iterator

from echofuse.emulation import codec
from echofuse.emulation.accounting import TROUBLE
from echofuse.emulation.firmware import CONFIG_STEP_US
from echofuse.emulation.lockstep import Board
from echofuse.emulation.reception import REJECTED

#: What a node or a hub counts that is not work.
OF_TROUBLE = {
    *TROUBLE,
    *(
        "rejected_scans",
        "direct_path_missing",
        "alignment_doubts",
        "undetectable_scans",
        "truncated_detections",
    ),
    *(
        "rejected_responses",
        "dead_responses",
        "saturated_responses",
        "cross_talk_missing",
        "time_zero_moved",
    ),
    *(
        f"dropped_{what}"
        for what in ("tuples", "detections", "measurements", "points", "births", "combinations")
    ),
    *(f"link_{name}" for name in (*REJECTED, "repeated", "unsent", "refused_writes")),
}


class Ledger:
    """What was given to the boards of a test, and what they say that they counted."""

    def __init__(self) -> None:
        self.expected: dict[str, Counter[str]] = {}
        self.silent: set[str] = set()
        self.broken_off = False
        self.given: dict[Board, Counter[str]] = {}
        self.readers: dict[Board, codec.FrameReader] = {}
        self.last_us: dict[Board, int] = {}
        self.said: dict[Board, dict[str, int]] = {}

    def __call__(self, name: str, **counters: int) -> None:
        """Declare that the board of a name is to have counted so much trouble."""
        self.expected.setdefault(name, Counter()).update(counters)

    def ends_unheard(self, name: str) -> None:
        """Declare that the test ends the board of a name, so that it cannot be asked."""
        self.silent.add(name)

    def breaks_off(self) -> None:
        """Declare that the test ends a run in the middle, so that what was missed means nothing."""
        self.broken_off = True

    def opened(self, board: Board) -> None:
        self.given[board], self.readers[board], self.last_us[board] = Counter(), codec.FrameReader(), 0

    def stepped(self, board: Board, now_us: int, link: bytes, has_scan: bool) -> None:
        self.last_us[board] = max(self.last_us[board], now_us)
        self.given[board]["scans"] += has_scan and now_us != CONFIG_STEP_US  # that is the empty room's
        self.given[board]["frames"] += sum(1 for _ in self.readers[board].feed(link))

    def problems(self) -> Iterator[str]:
        for board in () if self.broken_off else self.given:
            name = name_of(board)
            if name in self.silent:
                continue
            if board not in self.said:
                yield f"{name}: was never asked what it counted: not closed, or ended without saying so"
                continue
            said, given = self.said[board], self.given[board]
            expected = {key: self.expected.get(name, Counter())[key] for key in said if key in OF_TROUBLE}
            for key, value in expected.items():
                if said[key] != value:
                    yield f"{name}: {key} is {said[key]}, injected {value}"
            for what in ("scans", "responses"):
                if what in said and said[what] + said[f"rejected_{what}"] != given["scans"]:
                    counted = f"{said[what]} {what} and {said[f'rejected_{what}']} rejected"
                    yield f"{name}: {counted}, of {given['scans']}"
            taken = said["link_frames"] + said["link_repeated"]
            if taken != given["frames"]:
                yield f"{name}: link_frames {said['link_frames']}, of {given['frames']} intact ones sent"
        for name in {*self.expected, *self.silent} - {name_of(board) for board in self.given}:
            yield f"{name}: something was injected, and there is no such board"


def name_of(board: Board) -> str:
    return board.name.partition(" (")[0]
