"""The emulated radar: schedule, clock and converter."""

import numpy as np
import pytest

from echofuse.emulation.injection import InjectionLog
from echofuse.emulation.radar import RadarEvent, digitised, schedule
from echofuse.emulation.scenario import RadarFaults
from echofuse.recording import NodeRecording

N_SCANS, PERIOD_US = 400, 100_000


@pytest.fixture(scope="module")
def source() -> NodeRecording:
    rng = np.random.default_rng(5)
    return NodeRecording(
        name="rx1",
        node_id=1,
        sample_rate_hz=16.4e9,
        first_sample_s=0.0,
        tx_position_m=np.zeros(3),
        rx_position_m=np.ones(3),
        time_s=np.arange(N_SCANS) * PERIOD_US * 1e-6,
        scans=rng.normal(0.0, 100.0, (N_SCANS, 8)).astype(np.float32),
        reference=rng.normal(0.0, 100.0, (2, 8)).astype(np.float32),
    )


def events(source: NodeRecording, seed: int = 0, **faults: float) -> list[RadarEvent]:
    return schedule(source, RadarFaults(**faults), seed=seed, begin_us=0, log=InjectionLog())  # type: ignore[arg-type]


def test_without_faults_the_schedule_is_the_recorded_one(source: NodeRecording) -> None:
    for index, event in enumerate(events(source)):
        at_us = index * PERIOD_US
        assert event == RadarEvent(true_time_us=at_us, ready_us=at_us, node_time_us=at_us, index=index)


def test_jitter_has_its_deviation_and_is_cut_off(source: NodeRecording) -> None:
    found = np.array([event.true_time_us for event in events(source, jitter_us=5000.0)])
    jitter_us = found[1:] - PERIOD_US * np.arange(1, N_SCANS)
    assert 4500 < jitter_us.std() < 5500
    assert abs(jitter_us.mean()) < 1000
    assert np.abs(jitter_us).max() <= 15_000


def test_a_fast_clock_shows_more_and_scans_earlier(source: NodeRecording) -> None:
    last = events(source, drift_ppm=100.0, clock_offset_us=7_000_000)[-1]
    nominal_us = (N_SCANS - 1) * PERIOD_US
    assert last.true_time_us == round(nominal_us / (1 + 1e-4))
    assert abs(last.node_time_us - 7_000_000 - nominal_us) <= 1


def test_another_period_takes_the_nearest_scan(source: NodeRecording) -> None:
    found = events(source, period_us=70_000, frame_duration_us=2400)
    assert [event.true_time_us for event in found[:4]] == [0, 70_000, 140_000, 210_000]
    assert [event.index for event in found[:4]] == [0, 1, 1, 2]
    assert all(event.ready_us == event.true_time_us + 2400 for event in found)
    assert found[-1].true_time_us <= (N_SCANS - 1) * PERIOD_US


def test_missed_and_doubled_scans_come_about_as_often_as_asked(source: NodeRecording) -> None:
    missed = sum(event.missed for event in events(source, missed=0.1))
    doubled = [event for event in events(source, doubled=0.1) if event.again]
    assert 25 <= missed <= 55
    assert 25 <= len(doubled) <= 55
    assert all(event.true_time_us % PERIOD_US == 1000 for event in doubled)


def test_one_fault_does_not_shift_another(source: NodeRecording) -> None:
    alone = [event.index for event in events(source, missed=0.1) if event.missed]
    together = events(source, missed=0.1, doubled=0.3, jitter_us=100.0)
    assert [event.index for event in together if event.missed] == alone
    assert [event.index for event in events(source, seed=1, missed=0.1) if event.missed] != alone


def test_the_converter_cuts_off_and_rounds(source: NodeRecording) -> None:
    converted = digitised(source, RadarFaults(adc_bits=6, adc_full_scale=128.0))
    assert converted.reference is not None
    for scans, before in ((converted.scans, source.scans), (converted.reference, source.reference)):
        assert scans.dtype == np.float32
        assert np.abs(scans).max() <= 128.0
        np.testing.assert_array_equal(scans % 4.0, 0.0)
        inside = np.abs(before) < 128.0
        assert np.abs(scans - before)[inside].max() <= 2.0
    assert digitised(source, RadarFaults()) is source
