"""One HDF5 layout in and out (`design.md` section 7), and importers of other people's recordings."""

from echofuse.recording.model import (
    DETECTION_DTYPE,
    PLANAR_TRACK_DTYPE,
    TRACK_DTYPE,
    Emulated,
    NodeRecording,
    Outputs,
    PersonTruth,
    Pulse,
    Recording,
)
from echofuse.recording.reader import read
from echofuse.recording.writer import RecordingWriter, frame_digest, frame_rows, write

__all__ = [
    "DETECTION_DTYPE",
    "PLANAR_TRACK_DTYPE",
    "TRACK_DTYPE",
    "Emulated",
    "NodeRecording",
    "Outputs",
    "PersonTruth",
    "Pulse",
    "Recording",
    "RecordingWriter",
    "frame_digest",
    "frame_rows",
    "read",
    "write",
]
