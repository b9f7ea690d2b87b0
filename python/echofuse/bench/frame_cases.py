"""The whole frame: all nodes of a site and their hub."""

from itertools import count

from echofuse.bench.hub_cases import LIMITS, columns, configured_hub
from echofuse.bench.material import FRAME_US, FRAMES, Material, accepted, back_and_forth, listening_node
from echofuse.bench.node_cases import listening_reference
from echofuse.bench.timing import Case, Run, timed
from echofuse.conformance.comparison import as_reference, to_float64
from echofuse.reference.hub.hub import SensorRadarHub
from echofuse.reference.hub.measure.frame_assembler import Report


def frame_case(material: Material) -> Case:
    """All nodes process a scan each, and the hub what they report."""
    return Case(
        group="frame",
        name="whole frame",
        core=_core_frame(material),
        reference=_reference_frame(material),
        in_step=True,
    )


def _core_frame(material: Material) -> Run:
    nodes = [listening_node(heard) for heard in material.nodes]
    hub, order, numbers = configured_hub(material.hub), back_and_forth(FRAMES), count()

    def call() -> object:
        number, index = next(numbers), order()
        now_us = number * FRAME_US
        for node, heard in zip(nodes, material.nodes, strict=True):
            _, rows = node.process(heard.scans[index], now_us)
            hub.receive(heard.node_id, number, *columns(rows), now_us)
        return hub.poll(now_us)

    return timed(accepted(call))


def _reference_frame(material: Material) -> Run:
    nodes = [listening_reference(heard) for heard in material.nodes]
    scans = [[to_float64(scan) for scan in heard.scans] for heard in material.nodes]
    hub = SensorRadarHub(as_reference(material.hub), LIMITS)
    order, numbers = back_and_forth(FRAMES), count()

    def call() -> object:
        number, index = next(numbers), order()
        for node, heard, heard_scans in zip(nodes, material.nodes, scans, strict=True):
            report = node.process(heard_scans[index])
            assert report is not None
            delay_s, weight = report.detections.T
            hub.receive(Report(heard.node_id, number, delay_s, weight), number * FRAME_US)
        return hub.poll(number * FRAME_US)

    call()  # as the library did when it was accepted
    return timed(call)
