"""What `echofuse run` simulates: the case studies, and sites of a user's own."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from echofuse.cli import CASES
from echofuse.display.progress import progress
from echofuse.errors import InputError, problem
from echofuse.recording import Recording
from echofuse.site import PIPELINES, Site, example_site, load_site

__all__ = ["simulated", "site_of_case"]

MOST_BEHIND_WALL = 4  # people whose walks the case study knows


def site_of_case(case: str, people: int | None) -> tuple[Site, str, int]:
    """Return the case's site, its name, and how many people walk; several have their own (decision 0004)."""
    if case == "sensor-radar":
        n_people = 1 if people is None else people
        return example_site("sensor_radar" if n_people <= 1 else "sensor_radar_several"), case, n_people
    if case == "stairs":
        if people not in (None, 1):
            raise InputError(problem("--people", "", "1 on the stairs", people))
        return example_site("stairs"), case, 1
    if case == "through-wall":
        site, name = example_site("through_wall"), case
    else:
        path = Path(case)
        if path.suffix != ".toml":
            cases = f"a case ({', '.join(CASES)}) or a site file (SITE.toml)"
            raise InputError(problem(case, "", cases))
        site, name = load_site(path), path.stem
    if not PIPELINES[site.pipeline].behind_wall:
        return site, name, 1 if people is None else people
    if people is not None and people > MOST_BEHIND_WALL:
        raise InputError(problem("--people", "", f"0 to {MOST_BEHIND_WALL} behind a wall", people))
    return site, name, 2 if people is None else people


def simulated(site: Site, case: str, people: int, seed: int, duration_s: float | None) -> Recording:
    """Return what the nodes of a case or of a site hear of people; duration_s: None for the default."""
    simulate = _behind_wall if PIPELINES[site.pipeline].behind_wall else _around
    recording = simulate(site, case, people, seed, duration_s)
    return replace(recording, pipeline=site.pipeline, site_toml=site.to_toml())


def _around(site: Site, case: str, people: int, seed: int, duration_s: float | None) -> Recording:
    from echofuse.simulation.scene import sensor_radar_scene
    from echofuse.simulation.sensor_radar import CASE_STUDY_DURATION_S, case_study_people, simulate
    from echofuse.simulation.site_scene import site_people, site_scene

    if case == "sensor-radar":
        scene, walkers = sensor_radar_scene(), case_study_people(people)
    else:
        scene = site_scene(site)
        walkers = site_people(scene, people)
    duration_s = _whole_scans(duration_s, CASE_STUDY_DURATION_S, scene.scan_period_s)
    return simulate(scene, walkers, seed=seed, duration_s=duration_s, progress=_simulating)


def _behind_wall(site: Site, case: str, people: int, seed: int, duration_s: float | None) -> Recording:
    from echofuse.simulation.stairs import climb_s, stairs_climber, stairs_scene
    from echofuse.simulation.through_wall import simulate_through_wall
    from echofuse.simulation.through_wall_scene import (
        CASE_STUDY_DURATION_S,
        case_study_walkers,
        through_wall_scene,
    )
    from echofuse.simulation.through_wall_site import site_scene_behind_wall, site_walkers_behind_wall

    default_s = CASE_STUDY_DURATION_S
    if case == "through-wall":
        scene, walkers = through_wall_scene(), case_study_walkers(people)
    elif case == "stairs":
        scene, walkers = stairs_scene(), (stairs_climber(),)
        default_s = climb_s(walkers[0])
    else:
        scene = site_scene_behind_wall(site)
        walkers = site_walkers_behind_wall(scene, people)
        if not all(scene.holds(person) for person in walkers):
            expected = "room for the people who are simulated, their width and 1.9 m of height"
            raise InputError(problem(site.name, "site.area", expected))
    duration_s = _whole_scans(duration_s, default_s, scene.scan_period_s)
    return simulate_through_wall(scene, walkers, seed=seed, duration_s=duration_s, progress=_simulating)


def _whole_scans(asked_s: float | None, default_s: float, period_s: float) -> float:
    """Return how long a run takes [s], which is one scan at least."""
    if asked_s is None:
        return default_s
    if asked_s < period_s:
        raise InputError(problem("--duration", "", f"at least one scan, {period_s:g} s", asked_s))
    return asked_s


def _simulating(frames: range) -> Iterable[int]:
    return progress(frames, "simulating", len(frames))
