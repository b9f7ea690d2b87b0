"""What is to be seen in each picture of the report, as plain text."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from echofuse.display import setting

if TYPE_CHECKING:
    from echofuse.result import RunResult


DIAMOND = "The diamond is the paper's best setting: left of it and above is better. "
MARKED_DIAMOND = " The diamond is the paper's error, in two dimensions, in its own room."


def room(result: RunResult) -> str:
    """Return the caption of the room from above."""
    if setting.people(result):
        truth = "The broad grey band is where a person truly walked; a circle marks its start. "
    elif setting.truth_path_m(result.site) is not None:
        truth = "The broad grey band is the path marked on the floor; the times are not known. "
    else:
        truth = ""
    if result.why_no_positions is not None:
        return f"The site from above. {truth}There are no positions: {result.why_no_positions}."
    if setting.in_space(result):
        return (
            f"The site from above. {truth}How far before the wall the antennas stand makes no difference. "
            "Small dots are the quadruples of traces that were located and that no track took. Each track "
            "has its colour: solid while confirmed, dashed while silent. The thin orange line is the paper's "
            "way: traces paired, located by TSM from 3D-2D, then a Kalman filter with nearest neighbour."
        )
    if setting.behind_wall(result):
        return (
            f"The room behind the wall from above (the paper's Fig. 7). {truth}How far before the wall the "
            "antennas stand makes no difference. Small dots are the couples of traces that were located and "
            "that no track took. Each track has its colour: solid while confirmed, dashed while silent. The "
            "thin orange line is the paper's way: traces paired, located, then a Kalman filter with nearest "
            "neighbour."
        )
    return (
        f"The site from above (the paper's Fig. 7). {truth}Small dots are the points that the hub located "
        "and gave to the tracker. Each track has its colour: solid while confirmed, dashed while silent, "
        "that is while nobody moves where it was last seen. The thin orange line is the Kalman filter "
        "with nearest-neighbour association on the same points."
    )


#: What is drawn of each way in space, and where the paper has it.
SPACE = {
    "three_d_two_d": "Traces paired and located by 3D-2D, and a Kalman filter on these positions (the "
    "paper's Figs. 5, 6, 9 and 10).",
    "tsm_from_three_d_two_d": "The same with the Taylor-series method from 3D-2D (the paper's Figs. 7, 8, 11 "
    "and 12).",
    "tracker": "The run's own tracker, which takes part in the pairing and follows the paths themselves.",
}


def space(result: RunResult, way: str) -> str:
    """Return the caption of a way's positions and tracks in space."""
    region = (
        " Yellow: the region of the true positions, the paper's cuboid of 1 m x 1 m x 1.8 m about the person "
        "along the whole path. Black: the axis of the torso, which errors are measured from."
        if setting.people(result)
        else ""
    )
    return f"{SPACE[way]}{region} Tracks are solid while confirmed and dashed while silent."


def error(result: RunResult) -> str:
    """Return the caption of the errors."""
    number = "how many people were told of"
    behind_wall = setting.behind_wall(result)
    if setting.people(result):
        after = "two seconds" if behind_wall else "second (the paper's Fig. 8)"
        diamond = "" if behind_wall else DIAMOND
        return (
            f"(a) Empirical distribution of the localisation error after the first {after}. A person without "
            f"a track counts as infinitely wrong, so a curve ends at the share that was tracked. {diamond}"
            "(b) The error of each person's track over time; a gap is a frame without one. (c) How many "
            f"people there were, and {number}."
        )
    if setting.truth_path_m(result.site) is not None:
        return (
            "The recording tells where the person walked but not when: the error is the distance of "
            "confirmed tracks across that path. (a) Its distribution while the person walked, (b) over "
            f"time, a line a track, shaded where the person did not walk, (c) {number}."
            + ("" if behind_wall else MARKED_DIAMOND)
        )
    return f"No truth was recorded, so there is no error to draw: only {number} over time."


def responses(result: RunResult, name: str) -> str:
    """Return the caption of a through-wall receiver's responses."""
    heard = "" if result.why_no_positions is None else " (there is no second receiver to pair them with)"
    return (
        f"{name}, all responses of the run, time upwards (the paper's Figs. 5 and 6). (a) As received, all "
        "of the sequence: the brightest line is the cross-talk; (b) turned until that is in its place, as "
        "far as the area reaches; (c) what moves; (d) each sample over the largest from it to the end, so "
        "that far people are as bright as near ones; (e) hits of the detector; (f) what may be a person, "
        "and where each one's echo begins; (g) what is reported: taken by a track, in its colour, or "
        f"paired, or neither{heard}; (h) where the echoes truly were."
    )


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
