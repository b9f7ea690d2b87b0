"""What an image shows is what the library shows in this process, to the last bit."""

from collections.abc import Iterator
from contextlib import closing

import numpy as np
import pytest

from echofuse.conformance.choices import THROUGH_WALL_HUB_CHOICES, THROUGH_WALL_NODE_CHOICES, Choice
from echofuse.conformance.firmware_target import FirmwareConformanceTarget
from echofuse.conformance.target import InProcessTarget, Taps
from echofuse.conformance.through_wall_hub_inputs import simulated_through_wall_reports
from echofuse.conformance.through_wall_hub_taps import DEADLINE_US, THROUGH_WALL_HUB_TAPS
from echofuse.conformance.through_wall_inputs import KINDS, simulated_responses
from echofuse.conformance.through_wall_taps import RESPONSE_PERIOD_US, THROUGH_WALL_NODE_TAPS

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def image() -> Iterator[FirmwareConformanceTarget]:
    with closing(FirmwareConformanceTarget("cortex-m7")) as target:
        yield target


def assert_same_bits(here: Taps, there: Taps, where: str) -> None:
    assert list(here) == list(there), where
    for tap, values in here.items():
        assert values.shape == there[tap].shape, f"{where}: {tap}"
        assert values.tobytes() == there[tap].tobytes(), f"{where}: {tap}"


@pytest.mark.parametrize("choice", THROUGH_WALL_NODE_CHOICES, ids=lambda choice: choice.name)
def test_a_through_wall_node(image: FirmwareConformanceTarget, choice: Choice) -> None:
    for heard in simulated_responses(len(KINDS), long_sequence=choice.long_sequence):
        config = heard.config(choice)
        with (
            closing(InProcessTarget().through_wall_node(config)) as node,
            closing(image.through_wall_node(config)) as board,
        ):
            for index, response in enumerate(heard.responses):
                here = node.process(response, index * RESPONSE_PERIOD_US)
                there = board.process(response, index * RESPONSE_PERIOD_US)
                where = f"{heard.where}, response {index}"
                assert here is not None, where
                assert there is not None, where
                assert set(here.taps) == set(THROUGH_WALL_NODE_TAPS)
                assert_same_bits(here.taps, there.taps, where)
                assert np.array_equal(here.detections, there.detections), where


@pytest.mark.parametrize("choice", THROUGH_WALL_HUB_CHOICES, ids=lambda choice: choice.name)
def test_a_through_wall_hub(image: FirmwareConformanceTarget, choice: Choice) -> None:
    """Of two receivers."""
    for heard in simulated_through_wall_reports(2):
        config, closed = heard.config(choice), 0
        with (
            closing(InProcessTarget().through_wall_hub(config)) as hub,
            closing(image.through_wall_hub(config)) as board,
        ):
            for index, instant in enumerate(heard.instants):
                for report in instant.reports:
                    hub.receive(report, instant.time_us)
                    board.receive(report, instant.time_us)
                for now_us in (instant.time_us, instant.time_us + DEADLINE_US):
                    here, there = hub.poll(now_us), board.poll(now_us)
                    where = f"{heard.where}, instant {index}"
                    assert (here is None) == (there is None), where
                    if here is None or there is None:
                        continue
                    closed += 1
                    assert (there.time_us, there.frame) == (here.time_us, here.frame), where
                    assert set(here.taps) == set(THROUGH_WALL_HUB_TAPS)
                    assert_same_bits(here.taps, there.taps, where)
        assert closed > 60
