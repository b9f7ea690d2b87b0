"""docs/link_protocol.md says in which order a machine's counters come, and where messages are published."""

import re
from pathlib import Path

from echofuse.emulation import codec

TEXT = (Path(__file__).parents[2] / "docs" / "link_protocol.md").read_text()


def documented(beginning: str, end: str) -> list[str]:
    """Return the names in the first column of the tables between two headlines."""
    section = TEXT[TEXT.index(beginning) :]
    rows = re.findall(r"^\| (`.*?) \|", section[: section.index(end)], re.MULTILINE)
    return [name for row in rows for name in re.findall(r"`(\w+)`", row)]


def test_the_order_of_the_health_values() -> None:
    link = "Then, for all"
    after = [*(f"Kind {kind}" for kind in codec.HEALTH_VALUES), link]
    for kind, values in codec.HEALTH_VALUES.items():
        of_the_link = documented(link, "## Registers")
        assert documented(f"Kind {kind}", after[kind + 1]) + of_the_link == list(values)


def test_the_default_subjects() -> None:
    subjects = {
        name: int(number) for number, name in re.findall(r"^\| (\d{4}) \| `\w+(?:\.\w+)*\.(\w+)`", TEXT, re.M)
    }
    assert subjects == {
        "BreathingObservations": 6202,
        "MotionReport": 6203,
        "Persons": 6204,
        "Detections": codec.DETECTIONS,
        "Tracks": codec.TRACKS,
        "SpatialTracks": codec.SPATIAL_TRACKS,
        "NodeHealth": codec.NODE_HEALTH,
        "Tap": codec.TAP,
        "RawScan": codec.RAW_SCAN,
        "Synchronization": codec.TIME,
        "Heartbeat": codec.HEARTBEAT,
    }
