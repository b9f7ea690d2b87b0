"""What is to be seen in each picture of the report, as plain text."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from echofuse.display import setting

if TYPE_CHECKING:
    from echofuse.result import RunResult


def room(result: RunResult) -> str:
    """Return the caption of the room from above."""
    if setting.people(result):
        truth = "The broad grey band is where a person truly walked; a circle marks its start. "
    elif setting.truth_path_m(result.site) is not None:
        truth = "The broad grey band is the path marked on the floor; the times are not known. "
    else:
        truth = ""
    return (
        f"The site from above (the paper's Fig. 7). {truth}Small dots are the points that the hub located "
        "and gave to the tracker. Each track has its colour: solid while confirmed, dashed while silent, "
        "that is while nobody moves where it was last seen. The thin orange line is the Kalman filter "
        "with nearest-neighbour association on the same points."
    )


def error(result: RunResult) -> str:
    """Return the caption of the errors."""
    number = "how many people were told of"
    if setting.people(result):
        return (
            "(a) Empirical distribution of the localisation error after the first second (the paper's "
            "Fig. 8). A person without a track counts as infinitely wrong, so a curve ends at the share "
            "that was tracked. The diamond is the paper's best setting: left of it and above is better. "
            "(b) The error of each person's track over time; a gap is a frame without one. (c) How many "
            f"people there were, and {number}."
        )
    if setting.truth_path_m(result.site) is not None:
        return (
            "The recording tells where the person walked but not when: the error is the distance of "
            "confirmed tracks across that path. (a) Its distribution while the person walked, (b) over "
            f"time, a line a track, shaded where the person did not walk, (c) {number}. The diamond is the "
            "paper's error, in two dimensions, in its own room."
        )
    return f"No truth was recorded, so there is no error to draw: only {number} over time."


def scan(result: RunResult, name: str) -> str:
    """Return the caption of one scan of node `name` through its stages."""
    time_s = setting.elapsed_s(result, result.frame_time_us[result.shown_frame : result.shown_frame + 1])
    when = f"frame {result.shown_frame}" + (f", {time_s[0]:.2f} s after the first" if time_s.size else "")
    found = result.shown_taps[name].get("range_clusters")
    number = 0 if found is None else int(np.asarray(found).size // 4)
    reports = "nothing" if number == 0 else "one echo" if number == 1 else f"{number} echoes"
    return (
        f"{name}, {when}: one scan through the stages of the node (the paper's Fig. 5). (a), (b) A "
        "person's echo is hardly seen in the raw scan beside the static room; (c) the envelope; (d) what "
        "moves, after the static room is removed and negative values are cut, against the detector's "
        "threshold on the same scale; (e) samples over the threshold; (f) what is sent to the hub: here "
        f"{reports}. Dashed black: the true delay of each person."
    )


def stack(result: RunResult, name: str) -> str:
    """Return the caption of the stacked scans of node `name`."""
    truth = "(a) where each person's echo truly was; " if setting.people(result) else ""
    return (
        f"{name}, all scans of the run, time upwards (the paper's Fig. 6): {truth}(b) what is left after "
        "clutter removal, bright is strong; (c) decisions; (d) clusters, larger with more weight. A "
        "person is a continuous line; dots beside it are false alarms, and the hub's task."
    )
