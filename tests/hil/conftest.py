"""After every test here, each board says what it has counted, and that must be what the test gave it."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from echofuse.emulation import codec
from echofuse.emulation.lockstep import Board

sys.path.insert(0, str(Path(__file__).parent))
from ledger import Ledger, name_of


@pytest.fixture(autouse=True)
def injected(monkeypatch: pytest.MonkeyPatch) -> Iterator[Ledger]:
    ledger = Ledger()
    init, step, close = Board.__init__, Board.step, Board.close

    def watched_init(self: Board, *arguments: Any, **options: Any) -> None:
        init(self, *arguments, **options)
        ledger.opened(self)

    def watched_step(self: Board, now_us: int, link: bytes = b"", **options: Any) -> Any:
        ledger.stepped(self, now_us, link, options.get("scan") is not None)
        return step(self, now_us, link, **options)

    def asking_close(self: Board) -> None:
        if self not in ledger.said and name_of(self) not in ledger.silent:
            output = step(self, ledger.last_us[self] + 1_100_000)
            for transfer in codec.FrameReader().feed(output.link):
                if transfer.port == codec.NODE_HEALTH and transfer.kind == codec.MESSAGE:
                    ledger.said[self] = codec.parse_health(transfer.payload)
        close(self)

    monkeypatch.setattr(Board, "__init__", watched_init)
    monkeypatch.setattr(Board, "step", watched_step)
    monkeypatch.setattr(Board, "close", asking_close)
    yield ledger
    assert list(ledger.problems()) == []
