"""Makes vectors.toml with PyCyphal alone: its compiled DSDL and its serial frames, none of our code.

python tests/wire/make_vectors.py > tests/wire/vectors.toml
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
import pycyphal.dsdl
from pycyphal.transport import MessageDataSpecifier, Priority
from pycyphal.transport.commons.crc import CRC32C
from pycyphal.transport.serial._frame import SerialFrame

DSDL = Path(__file__).parents[2] / "cpp" / "dsdl"


def framed(subject: int, source: int, transfer_id: int, payload: bytes) -> bytes:
    """Return what PyCyphal puts on a serial line for one message."""
    frame = SerialFrame(
        priority=Priority.NOMINAL,
        transfer_id=transfer_id,
        index=0,
        end_of_transfer=True,
        payload=memoryview(payload + CRC32C.new(payload).value_as_bytes),
        source_node_id=source,
        destination_node_id=None,
        data_specifier=MessageDataSpecifier(subject),
        user_data=0,
    )
    return bytes(frame.compile_into(bytearray(8192)))


def vector(name: str, message: object, subject: int, source: int, transfer_id: int) -> str:
    """Return one table of vectors.toml."""
    payload = b"".join(bytes(part) for part in pycyphal.dsdl.serialize(message))
    frame = framed(subject, source, transfer_id, payload)
    lines = [f"[{name}]", f"subject = {subject}", f"source = {source}", f"transfer_id = {transfer_id}"]
    return "\n".join([*lines, f'payload = "{payload.hex()}"', f'frame = "{frame.hex()}"', ""])


def vectors() -> list[str]:
    """Return every vector, from the types that PyCyphal has compiled."""
    import uavcan.node
    import uavcan.time

    import echofuse  # here the namespace of cpp/dsdl

    detections = [echofuse.Detection_1_0(delay=k * 3.5e-9, weight=100 * k + 7) for k in range(1, 5)]
    track = echofuse.Track_1_0(
        id_=9,
        state=2,
        frames_since_update=3,
        position=np.array([1.5, -2.25], np.float32),
        velocity=np.array([0.0, 1e-3], np.float32),
        covariance=np.array([0.04, -0.01, 0.09], np.float32),
    )
    in_space = echofuse.SpatialTrack_1_0(
        id_=9,
        state=2,
        frames_since_update=3,
        position=np.array([1.5, -2.25, 1.125], np.float32),
        velocity=np.array([0.0, 1e-3, -0.5], np.float32),
        covariance=np.array([0.04, -0.01, 0.09, 0.02, -0.03, 0.16], np.float32),
    )
    heartbeat = uavcan.node.Heartbeat_1_0(
        uptime=86_400,
        health=uavcan.node.Health_1_0(2),
        mode=uavcan.node.Mode_1_0(1),
        vendor_specific_status_code=255,
    )
    return [
        vector("heartbeat", heartbeat, 7509, 61440, 1),
        vector("no_detections", echofuse.Detections_1_0(time_us=0, detections=[]), 6200, 1, 0),
        vector(
            "four_detections",
            echofuse.Detections_1_0(time_us=(1 << 56) - 2, detections=detections),
            6200,
            65534,
            (1 << 32) - 1,
        ),
        vector("track", echofuse.Tracks_1_0(time_us=1_234_567, frame=12, tracks=[track]), 6201, 61440, 12),
        vector(
            "health", echofuse.NodeHealth_1_0(kind=1, values=list(range(0, 31 * 255, 255))), 6205, 61440, 4
        ),
        vector(
            "synchronization",
            uavcan.time.Synchronization_1_0(previous_transmission_timestamp_microsecond=5_000_000),
            7168,
            61440,
            6,
        ),
        vector(
            "spatial_track",
            echofuse.SpatialTracks_1_0(time_us=1_234_567, frame=12, tracks=[in_space]),
            6208,
            61440,
            12,
        ),
    ]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        sys.path.insert(0, folder)
        pycyphal.dsdl.compile_all([DSDL / "uavcan", DSDL / "echofuse"], output_directory=folder)
        print("# By PyCyphal, never by our own code: make_vectors.py. A vector stays for ever.\n")
        print("\n".join(vectors()))
