"""Cuts the table of tracks into lines that can be drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

UNCONFIRMED, CONFIRMED, SILENT = 0, 1, 2


@dataclass(frozen=True, kw_only=True)
class Stretch:
    """Successive frames of one track in one state, with the point where the next state takes over."""

    track_id: int
    state: int
    rows: NDArray[np.void]  # TRACK_DTYPE, ascending frame


def stretches(tracks: NDArray[np.void]) -> list[Stretch]:
    """Return the stretches of all tracks by id, then by frame."""
    found = []
    for track_id in np.unique(tracks["id"]):
        rows = np.sort(tracks[tracks["id"] == track_id], order="frame")
        changes = np.flatnonzero((np.diff(rows["state"].astype(int)) != 0) | (np.diff(rows["frame"]) > 1)) + 1
        starts, ends = [0, *changes.tolist()], [*changes.tolist(), rows.size]
        for start, end in zip(starts, ends, strict=True):
            joins = end < rows.size and rows["frame"][end] == rows["frame"][end - 1] + 1
            last = end + 1 if joins else end
            found.append(
                Stretch(track_id=int(track_id), state=int(rows["state"][start]), rows=rows[start:last])
            )
    return found


def shown(tracks: NDArray[np.void]) -> NDArray[np.void]:
    """Return the rows of confirmed and silent tracks: what a user of the hub is told."""
    told: NDArray[np.void] = tracks[tracks["state"] != UNCONFIRMED]
    return told
