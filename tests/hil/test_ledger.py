"""The check after every test of this folder does bite."""

import numpy as np
from ledger import Ledger

from echofuse.emulation.targets import open_board

SILENCE = np.zeros(1920, np.float32)


def test_trouble_that_nobody_injected_is_told(injected: Ledger) -> None:
    with open_board("process", "sensor_radar_node", "rx1", 1) as board:
        board.step(10, b"\0\x09abc\0")
    assert list(injected.problems()) == ["rx1: link_bad_cobs is 1, injected 0"]
    injected("rx1", link_bad_cobs=1)
    assert list(injected.problems()) == []


def test_trouble_that_was_injected_and_not_counted_is_told(injected: Ledger) -> None:
    with open_board("process", "sensor_radar_node", "rx1", 1) as board:
        board.step(10)
    injected("rx1", rejected_scans=1)
    assert list(injected.problems()) == ["rx1: rejected_scans is 0, injected 1"]
    injected.expected.clear()


def test_a_scan_that_vanished_is_told(injected: Ledger) -> None:
    with open_board("process", "sensor_radar_node", "rx1", 1) as board:
        board.step(10, scan=SILENCE, scan_time_us=10)
    injected("rx1", direct_path_missing=1)
    injected.given[board]["scans"] += 1
    assert list(injected.problems()) == ["rx1: 1 scans and 0 rejected, of 2"]
    injected.given[board]["scans"] -= 1


def test_a_board_that_was_not_asked_is_told(injected: Ledger) -> None:
    board = open_board("process", "sensor_radar_node", "rx1", 1)
    assert ["never asked" in problem for problem in injected.problems()] == [True]
    board.close()
    assert list(injected.problems()) == []


def test_a_board_that_does_not_exist_is_told(injected: Ledger) -> None:
    injected("rx9", late=1)
    assert list(injected.problems()) == ["rx9: something was injected, and there is no such board"]
    injected.expected.clear()
