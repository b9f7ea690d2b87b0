"""What the counters of a run tell in words: which node could not judge what, and why."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from echofuse.result import RunResult

#: Counters of nodes that say why nothing, or less, was reported; `of` names the counter of all.
MEANINGS: dict[str, tuple[str, str]] = {
    "dead_responses": ("responses", "the same value in every sample: the receiver hears nothing"),
    "saturated_responses": ("responses", "too many samples at full scale: the receiver is overdriven"),
    "cross_talk_missing": ("responses", "no cross-talk where it belongs: time zero is not known"),
    "time_zero_moved": (
        "",
        "the cross-talk moved as after a power-up: time zero and background were learnt anew",
    ),
    "rejected_responses": ("", "samples that are not finite, or too few: left out"),
    "rejected_scans": ("", "samples that are not finite, or too few: left out"),
    "direct_path_missing": ("scans", "no direct path: time zero is the last scan's"),
    "truncated_detections": ("", "more echoes than a report holds: the heaviest were reported"),
}
SETTLING = "settling_responses"


def health_lines(result: RunResult) -> list[str]:
    """Return a line for each counter of a node that is not as it should be: node, counter, what it means."""
    lines = []
    for node, counts in result.counters.items():
        if node == "hub":
            continue
        for counter, (of, meaning) in MEANINGS.items():
            count = counts.get(counter, 0)
            if count:
                share = f" of {counts[of]}" if of in counts else ""
                lines.append(f"{node}: {counter} {count}{share}: {meaning}")
        if counts.get(SETTLING) and "responses" in counts and _judged(counts) == 0:
            meaning = "time zero and background were still being learnt when it ended"
            lines.append(f"{node}: {SETTLING} {counts[SETTLING]} of {counts['responses']}: {meaning}")
    return lines


def _judged(counts: dict[str, int]) -> int:
    """Return how many responses gave a report that means something."""
    unjudged = ("dead_responses", "saturated_responses", "cross_talk_missing", SETTLING)
    return counts["responses"] - sum(counts.get(name, 0) for name in unjudged)
