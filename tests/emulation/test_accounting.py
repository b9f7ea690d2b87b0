"""The accounting itself: what it must notice."""

from collections.abc import Sequence

import pytest

from echofuse.emulation import codec, targets
from echofuse.emulation.accounting import MAY_MOVE, Account, account
from echofuse.emulation.injection import Effect, InjectionLog
from echofuse.emulation.machine import Machine, ScanInput, StepOutput, Target
from echofuse.emulation.run import emulate
from echofuse.emulation.scenario import FAULT_KINDS, LinkFaults, RadarFaults
from echofuse.emulation.targets.inprocess import InProcessTarget
from echofuse.errors import InputError
from echofuse.recording import NodeRecording, Recording
from echofuse.site import Site

HUB = {"accepted": 9, "lost": 1, "frames": 5, "link_frames": 9, "link_repeated": 0}


def accounted(log: InjectionLog, hub: dict[str, int], scans: int = 10) -> Account:
    return account(
        log=log,
        expected=HUB,
        counters={"hub": hub, "rx1": {"scans": scans}},
        made={"rx1": 10},
        made_by_strangers=0,
        heard_intact=9,
        heard_reports=9,
        unheard_reports=0,
    )


@pytest.fixture
def one_lost() -> InjectionLog:
    log = InjectionLog()
    log.add("link.loss", "rx1", 0, Effect.MISSING)
    return log


def test_what_agrees_has_no_problem(one_lost: InjectionLog) -> None:
    found = accounted(one_lost, HUB)
    assert found.problems == []
    assert "every fault is accounted for" in found.text()
    assert "link.loss                       1  lost" in found.text()


def test_a_fault_that_is_in_no_counter(one_lost: InjectionLog) -> None:
    found = accounted(one_lost, HUB | {"lost": 0})
    assert found.problems == ["hub.lost: expected 1, counted 0"]
    assert "NOT ACCOUNTED FOR: hub.lost" in found.text()


def test_a_counter_that_no_fault_moves(one_lost: InjectionLog) -> None:
    assert accounted(one_lost, HUB | {"undecodable": 2}).problems == [
        "hub.undecodable: 2, and no fault moves it"
    ]
    assert accounted(InjectionLog(), HUB).problems == [
        "of 10 reports 0 ended on the way, 9 came to the hub and 0 while there was none",
        "hub.lost: 1, and no fault moves it",
    ]


def test_a_node_that_does_not_count_its_scans(one_lost: InjectionLog) -> None:
    assert accounted(one_lost, HUB, scans=9).problems == ["rx1.scans: expected 10, counted 9"]


def test_every_fault_that_can_be_asked_for_has_its_counters() -> None:
    asked = [f"radar.{name}" for name in RadarFaults.__dataclass_fields__]
    asked += [f"link.{name}" for name in LinkFaults.__dataclass_fields__ if name != "late_us"]
    asked += [f"fault.{kind}" for kind in FAULT_KINDS]
    assert sorted(asked) == sorted(MAY_MOVE)


def test_a_report_that_came_and_is_in_no_counter(one_lost: InjectionLog) -> None:
    one_lost.add("fault.hub_restart", "", 0, Effect.RESTARTED)  # not even a restart hides it
    found = accounted(one_lost, HUB | {"accepted": 8}).problems
    assert "of 9 reports that came 8 are in the hub's counters" in found


def test_a_report_that_nobody_heard_is_told_from_one_that_vanished() -> None:
    log = InjectionLog()
    log.add("fault.hub_restart", "", 0, Effect.RESTARTED)
    assert "of 10 reports 0 ended on the way, 9 came" in accounted(log, HUB).problems[0]


def test_repetitions_that_no_fault_made(one_lost: InjectionLog) -> None:
    found = accounted(one_lost, HUB | {"accepted": 8, "link_frames": 8, "link_repeated": 1}).problems
    assert "0 frames were doubled, and link_repeated is 1" in found
    assert "hub.link_repeated: 1, and no fault moves it" in found


class ForgetfulHub:
    """Takes one report less than it is given, and says nothing."""

    def __init__(self, hub: Machine) -> None:
        self._hub, self._frames = hub, 0

    def step(
        self, now_us: int, link_in: bytes = b"", scan: ScanInput | None = None, *, taps: bool = False
    ) -> StepOutput:
        self._frames += bool(link_in)
        return self._hub.step(now_us, b"" if self._frames == 50 and link_in else link_in, taps=taps)

    def counters(self, now_us: int) -> dict[str, int]:
        return self._hub.counters(now_us)

    def close(self) -> None:
        self._hub.close()


class ForgetfulTarget(InProcessTarget):
    def open_hub(self) -> Machine:
        return ForgetfulHub(super().open_hub())


def test_a_hub_that_forgets_one_report_is_found_out(
    short_walk: Recording, site: Site, monkeypatch: pytest.MonkeyPatch
) -> None:
    def opener(name: str, site: Site, sources: Sequence[NodeRecording]) -> Target:
        return ForgetfulTarget(site, sources)

    monkeypatch.setitem(targets.TARGETS, "forgetful:", opener)
    result = emulate(short_walk, site, target="forgetful:1")
    assert result.emulation is not None
    assert "hub.accepted: expected 180, counted 179" in result.emulation.account.problems
    assert "hub.lost: 1, and no fault moves it" in result.emulation.account.problems


def test_an_unknown_target_is_refused(short_walk: Recording, site: Site) -> None:
    with pytest.raises(InputError, match="--target: expected one of inprocess"):
        emulate(short_walk, site, target="abacus")


def test_tracks_come_back_from_the_wire_as_they_were(walk: Recording, site: Site) -> None:
    tracks = emulate(walk, site).tracks[:3]
    payload = codec.tracks_payload(123_456, 78, tracks)
    time_us, frame, rows = codec.parse_tracks(payload)
    assert (time_us, frame) == (123_456, 78)
    for name in rows.dtype.names or ():
        assert (rows[name] == tracks[name]).all()
