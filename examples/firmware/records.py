"""What the node of this folder reads, made from a recording; and what it wrote, printed.

python records.py scans RECORDING.h5 NODE scans.bin
python records.py reports frames.bin
"""

import sys
from pathlib import Path

import numpy as np

from echofuse.emulation.codec import DETECTIONS, FrameReader, parse_detections
from echofuse.recording import read


def scans(recording: Path, name: str, out: Path) -> None:
    """Write the scans of the empty room at negative times, and behind them those of the recording."""
    (node,) = (node for node in read(recording).nodes if node.name == name)
    rows = node.scans if node.reference is None else np.concatenate([node.reference, node.scans])
    records = np.zeros(len(rows), [("time_us", "<i8"), ("samples", "<f4", rows.shape[1])])
    records["time_us"] = -1
    records["time_us"][-len(node.scans) :] = np.rint(node.time_s * 1e6)
    records["samples"] = rows
    records.tofile(out)


def reports(frames: Path) -> None:
    """Print each report: when, and the delay and weight of each echo."""
    for transfer in FrameReader().feed(frames.read_bytes()):
        if transfer.port == DETECTIONS:
            time_us, rows = parse_detections(transfer.payload)
            echoes = ", ".join(f"{row['delay_s'] * 1e9:.2f} ns ({row['weight']})" for row in rows)
            print(f"node {transfer.source}, scan {transfer.transfer_id}, {time_us * 1e-6:.1f} s: {echoes}")


if __name__ == "__main__":
    command, *arguments = sys.argv[1:] or ["help"]
    if command == "scans" and len(arguments) == 3:
        scans(Path(arguments[0]), arguments[1], Path(arguments[2]))
    elif command == "reports" and len(arguments) == 1:
        reports(Path(arguments[0]))
    else:
        sys.exit(__doc__)
