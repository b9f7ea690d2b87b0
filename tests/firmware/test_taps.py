"""What an image shows is what the library shows in this process, to the last bit."""

from collections.abc import Iterator
from contextlib import closing

import numpy as np
import pytest

from echofuse.conformance.choices import THROUGH_WALL_NODE_CHOICES, Choice
from echofuse.conformance.firmware_target import FirmwareConformanceTarget
from echofuse.conformance.target import InProcessTarget, Taps
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
    for heard in simulated_responses(len(KINDS)):
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
