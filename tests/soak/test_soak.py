"""The soak, short: `make soak` runs it for 100,000 frames."""

import pytest
from soak import BLOCKS, Block, grown, soak


@pytest.mark.slow
def test_nothing_grows_and_nothing_is_lost_uncounted() -> None:
    blocks, counters, problems = soak(3_000)
    assert problems == []
    assert sum(block.frames for block in blocks) >= 2_900
    assert all(len(block.resident_bytes) == 7 for block in blocks)  # six nodes and the hub
    moved = ("late", "unknown_node", "lost", "absent", "slow", "resynchronised", "link_repeated")
    assert all(counters[name] > 0 for name in moved)
    assert counters["starts"] == 2


def test_what_grows_is_told() -> None:
    steady = [Block(resident_bytes={"hub": 3_000_000}, latency_us=80_000) for _ in range(BLOCKS)]
    assert grown(steady) == []
    steady[4] = Block(resident_bytes={"hub": 4_000_000}, latency_us=80_000)
    steady[7] = Block(resident_bytes={"hub": 3_000_000}, latency_us=180_000)
    assert [line.partition(":")[0] for line in grown(steady)] == ["tenth 5", "tenth 8"]
