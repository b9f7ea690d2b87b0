"""Makes the fuzzers' first inputs, tests/fuzz/corpus, from the vectors of tests/wire and a few requests.

python tests/fuzz/make_corpus.py
"""

import tomllib
from pathlib import Path

import numpy as np

from echofuse.emulation import codec

HERE = Path(__file__).parent
#: In the order of kDecoders of messages.cpp.
DECODERS = (
    *("detections", "tracks", "node_health", "heartbeat", "synchronization", "raw_scan"),
    "spatial_tracks",
)
SUBJECTS = dict(
    zip((6200, 6201, 6205, codec.HEARTBEAT, codec.TIME, codec.RAW_SCAN, 6208), DECODERS, strict=True)
)
ACCESS, LIST, GET_INFO, OTHER = (bytes([n]) for n in range(4))  # kServices of requests.cpp


def put(fuzzer: str, name: str, data: bytes) -> None:
    """Write one input."""
    folder = HERE / "corpus" / fuzzer
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(data)


def main() -> None:
    """Write every input."""
    scan = (
        (1_000_000).to_bytes(7, "little") + (3).to_bytes(2, "little") + np.array([1, -2, 3], "<f4").tobytes()
    )
    messages = {"scan": (codec.RAW_SCAN, scan)}
    for name, vector in tomllib.loads((HERE.parent / "wire" / "vectors.toml").read_text()).items():
        put("frames", name, bytes.fromhex(vector["frame"]))
        if vector["subject"] in SUBJECTS:
            messages[name] = (vector["subject"], bytes.fromhex(vector["payload"]))
    for name, (subject, payload) in messages.items():
        decoder = SUBJECTS[subject]
        put(decoder, name, payload)
        put("messages", name, bytes([DECODERS.index(decoder)]) + payload)
    put("requests", "read", ACCESS + codec.register_read("cfar.global_factor"))
    put("requests", "read_node", ACCESS + codec.register_read("nodes.11.tx.x_m"))
    put("requests", "write_real", ACCESS + codec.register_write("cfar.global_factor", 4.5))
    put("requests", "write_integer", ACCESS + codec.register_write("cfar.buffer_samples", 30))
    put("requests", "write_bit", ACCESS + codec.register_write("selection.track_aided", True))
    put("requests", "write_port", ACCESS + codec.register_write("uavcan.pub.tap.id", np.uint16(6300)))
    put("requests", "write_seed", ACCESS + codec.register_write("phd.seed", np.uint64(1)))
    put("requests", "list", LIST + (40).to_bytes(2, "little"))
    put("requests", "info", GET_INFO)
    put("requests", "unknown", OTHER)


if __name__ == "__main__":
    main()
