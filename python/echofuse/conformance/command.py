"""What `echofuse conform` does."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from pathlib import Path

from echofuse import recording as recordings
from echofuse.conformance import sensor_radar, through_wall
from echofuse.conformance.table import format_scores, format_tolerances, write_json
from echofuse.conformance.target import ConformanceTarget, InProcessTarget
from echofuse.display.progress import progress as bar
from echofuse.emulation.targets import FIRMWARE_TARGETS, is_port
from echofuse.errors import InputError, problem
from echofuse.recording import Recording

#: How many simulated inputs there are of each choice: an emulated processor takes longer.
SEEDS = {"inprocess": 20, "cortex-m7": 3}

Progress = Callable[[Iterator[None], str, int], Iterator[None]]


def conform_cases(
    cases: Sequence[str],
    *,
    target: str,
    seeds: int | None,
    recording: Path | None,
    out: Path | None,
    progress: Progress | None = None,
) -> bool:
    """Compare, print and write; see `echofuse.conformance.conform`."""
    if recording is not None and "sensor-radar" not in cases:
        raise InputError(problem("--recording", "", "the case sensor-radar beside it"))
    walk, about_walk = _recording(recording) if "sensor-radar" in cases else (None, "no recording")
    seeds = SEEDS.get(target, SEEDS["inprocess"]) if seeds is None else seeds
    began_s, scores = time.monotonic(), sensor_radar.Scores()
    with closing(open_target(target)) as opened:
        if "sensor-radar" in cases:
            plan = sensor_radar.Plan(seeds=seeds, recording=walk)
            _work(sensor_radar.steps(opened, plan, scores), plan.steps(), progress)
        behind_wall = {
            "through-wall": through_wall.ThroughWallPlan(seeds=seeds),
            "stairs": through_wall.stairs_plan(seeds),
        }
        for case, behind in behind_wall.items():
            if case in cases:
                _work(through_wall.steps(opened, behind, scores), behind.steps(), progress)
    took_s = time.monotonic() - began_s
    print(format_scores(scores.boards))
    print()
    print(format_tolerances())
    print()
    verdict = "all agree with the reference" if scores.passed else "NOT all agree with the reference"
    rows = sum(len(board.rows()) for board in scores.boards.values())
    print(f"{target}, {seeds} seeds and {about_walk}: {rows} taps of choices, {verdict} ({took_s:.0f} s)")
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        about = {"cases": list(cases), "target": target, "seeds": seeds, "recording": about_walk}
        write_json(out / "conformance.json", scores.boards, about)
        (out / "tolerances.txt").write_text(format_tolerances() + "\n", encoding="utf-8")
        print(f"wrote {out / 'conformance.json'}")
    return scores.passed


def open_target(name: str) -> ConformanceTarget:
    """Return what is compared with the reference."""
    if name == "inprocess":
        return InProcessTarget()
    if name not in FIRMWARE_TARGETS and not is_port(name):
        raise InputError(problem("--target", "", f"one of inprocess, {', '.join(FIRMWARE_TARGETS)}", name))
    from echofuse.conformance.firmware_target import FirmwareConformanceTarget

    return FirmwareConformanceTarget(name)


def _recording(path: Path | None) -> tuple[Recording | None, str]:
    if path is not None:
        loaded = recordings.read(path)
        if not loaded.site_toml.strip():
            raise InputError(problem(path, "/site", "a site file inside"))
        return loaded, str(path)
    walk = sensor_radar.real_walk()
    if walk is None:
        print("The real walk was skipped: no p410-triangle in ../shared/data or $ECHOFUSE_DATA.")
        return None, "no recording (the real walk was skipped)"
    return walk, "the real walk"


def _work(steps: Iterator[None], how_many: int, progress: Progress | None) -> None:
    for _ in (progress or bar)(steps, "conforming", how_many):
        pass
