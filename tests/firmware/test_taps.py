"""What an image shows is what the library shows in this process, to the last bit."""

from collections.abc import Iterator
from contextlib import closing

import numpy as np
import pytest

from echofuse.conformance.choices import (
    STAIRS_NODE_CHOICES,
    THROUGH_WALL_3D_HUB_CHOICES,
    THROUGH_WALL_HUB_CHOICES,
    THROUGH_WALL_NODE_CHOICES,
    Choice,
)
from echofuse.conformance.firmware_target import FirmwareConformanceTarget
from echofuse.conformance.target import HubTarget, InProcessTarget, Taps
from echofuse.conformance.through_wall_hub_inputs import (
    ThroughWallHubInput,
    simulated_climb_reports,
    simulated_through_wall_reports,
)
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


@pytest.mark.parametrize(
    "choice", THROUGH_WALL_NODE_CHOICES + STAIRS_NODE_CHOICES, ids=lambda choice: choice.name
)
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
    target = InProcessTarget()
    for heard in simulated_through_wall_reports(2):
        config = heard.config(choice)
        assert_same_frames(heard, target.through_wall_hub(config), image.through_wall_hub(config))


@pytest.mark.parametrize("choice", THROUGH_WALL_3D_HUB_CHOICES, ids=lambda choice: choice.name)
def test_a_hub_in_space(image: FirmwareConformanceTarget, choice: Choice) -> None:
    target = InProcessTarget()
    for heard in simulated_climb_reports(2):
        config = heard.config(choice)
        assert_same_frames(heard, target.through_wall_3d_hub(config), image.through_wall_3d_hub(config))


def assert_same_frames(heard: ThroughWallHubInput, here: HubTarget, there: HubTarget) -> None:
    closed = 0
    with closing(here), closing(there):
        for index, instant in enumerate(heard.instants):
            for report in instant.reports:
                here.receive(report, instant.time_us)
                there.receive(report, instant.time_us)
            for now_us in (instant.time_us, instant.time_us + DEADLINE_US):
                expected, answer = here.poll(now_us), there.poll(now_us)
                where = f"{heard.where}, instant {index}"
                assert (expected is None) == (answer is None), where
                if expected is None or answer is None:
                    continue
                closed += 1
                assert (answer.time_us, answer.frame) == (expected.time_us, expected.frame), where
                assert set(expected.taps) == set(THROUGH_WALL_HUB_TAPS)
                assert_same_bits(expected.taps, answer.taps, where)
    assert closed > 60
