"""What the commands do: each takes the parsed options, prints, writes files, and returns the exit status."""

import json
import math
from argparse import Namespace
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from echofuse.cases import simulated, site_of_case
from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.display import setting
from echofuse.display.health import health_lines
from echofuse.display.progress import progress
from echofuse.display.ways import is_of_a_way, way_lines
from echofuse.errors import InputError, problem
from echofuse.pipeline import check_positions, process_recording
from echofuse.recording import Recording, read, write
from echofuse.result import RunResult
from echofuse.site import PIPELINES, Site, bare_site, load_site, parse_site

#: What `run --seeds` prints of each seed, by pipeline.
SEED_COLUMNS = {
    "sensor_radar": (
        "rmse_m",
        "p80_m",
        "one_track_fraction",
        "count_right_fraction",
        "false_track_fraction",
        "bound_ratio",
    ),
    "through_wall_2d": (
        "rmse_m",
        "bound_ratio",
        "worst_tracked_fraction",
        "mean_tracked_fraction",
        "crossing_tracked_fraction",
        "false_tracks_per_100_s",
        "confirmed_tracks",
        "ghosts_per_response",
        "paired_ghosts_per_response",
        "all_pairs_ghosts_per_response",
    ),
    "through_wall_3d": (
        "rmse_m",
        "bound_ratio",
        "tracked_fraction",
        "one_track_fraction",
        "cuboid_fraction",
        "false_tracks_per_100_s",
        "position_error_bound_m",
    ),
}
TRACK_STATES = ("unconfirmed", "confirmed", "silent")


def run(options: Namespace) -> int:
    """Simulate a case or a site, process it, and write its folder."""
    if options.seeds is not None:
        return _run_seeds(options)
    site, name, people = site_of_case(options.case, options.people)
    recording = simulated(site, options.case, people, options.seed, options.duration)
    result = _processed(recording, site, options, options.seed)
    folder = options.out or Path("runs") / f"{name}-{options.seed}"
    return _finish(result, folder, report=not options.no_report)


def process(options: Namespace) -> int:
    """Track the people in a recording."""
    recording = read(options.recording)
    site = _site_of_recording(recording, options)
    if options.site is not None:
        recording = replace(recording, site_toml=site.to_toml())  # so that it verifies as it is
    result = _processed(recording, site, options)
    folder = options.out or Path("runs") / options.recording.stem
    return _finish(result, folder, report=not options.no_report)


def verify(options: Namespace) -> int:
    """Replay a recording's inputs and compare each frame's hash with the recorded one."""
    recording = read(options.recording)
    if recording.outputs is None or not len(recording.outputs.frame_hash):
        raise InputError(
            problem(options.recording, "outputs", "what a pipeline said (run or process writes it)")
        )
    site = _site_of_recording(recording, options)
    result = _replayed(replace(recording, outputs=None), site, options.target)
    replayed = result.outputs().frame_hash
    recorded = recording.outputs.frame_hash
    same = min(len(recorded), len(replayed))
    differs = np.flatnonzero(np.any(recorded[:same] != replayed[:same], axis=1))
    if len(recorded) != len(replayed):
        print(f"verify: {len(recorded)} frames recorded, {len(replayed)} replayed")
        return 1
    if len(differs):
        time_s = recording.outputs.frame_time_us[differs[0]] * 1e-6
        print(f"verify: {len(differs)} of {same} frames differ, first frame {differs[0]} at {time_s:.3f} s")
        return 1
    targets = f"recorded on {recording.outputs.target}, replayed on {options.target}"
    print(f"verify: {same} frames, all bytes the same ({targets})")
    return 0


def import_(options: Namespace) -> int:
    """Turn a logger's files into a recording."""
    from echofuse.recording.importers import import_logger

    recording = import_logger(options.source, load_site(options.site) if options.site else None)
    _make_folder(options.out.parent)
    write(options.out, recording)
    for node in recording.nodes:
        print(f"node {node.name}: {len(node.scans)} scans of {node.scans.shape[1]} samples")
    site = parse_site(recording.site_toml, str(options.out))
    print(f"positions from site '{site.name}'; wrote {options.out}")
    return 0


def conform(options: Namespace) -> int:
    """Compare a target with the reference, tap by tap."""
    from echofuse.conformance import conform as compare

    passed = compare(
        options.cases or ["sensor-radar"],
        target=options.target,
        seeds=options.seeds,
        recording=options.recording,
        out=options.out,
    )
    return 0 if passed else 1


def export_config(options: Namespace) -> int:
    """Write a site's configurations as a C++ header."""
    from echofuse.pipeline import hub_config, node_config, nominal_source
    from echofuse.site.cpp_header import cpp_header

    site = load_site(options.site)
    recorded = read(options.recording).nodes if options.recording else ()
    sources = {source.node_id: source for source in recorded}
    configs = {
        place.id: node_config(site, place, sources.get(place.id) or nominal_source(site, place))
        for place in site.nodes
    }
    _make_folder(options.out.parent)
    options.out.write_text(cpp_header(site.name, configs, hub_config(site)))
    print(f"{len(configs)} nodes and a hub; wrote {options.out}")
    return 0


def plan(options: Namespace) -> int:
    """Draw what a site covers, and how accurate it can be."""
    from echofuse.display import style
    from echofuse.display.plan_figure import plan_figure
    from echofuse.planning import plan_site

    site = load_site(options.site)
    planned = plan_site(site)
    folder = options.out or Path("plans") / options.site.stem
    _make_folder(folder)
    style.save_png(plan_figure(**planned.figure_data()), folder / "plan.png")
    _write_json(folder / "metrics.json", planned.metrics)
    for name, value in planned.metrics.items():
        print(f"{name:36s} {value:10.4g}")
    print(f"wrote {folder / 'plan.png'}")
    return 0


def bench(options: Namespace) -> int:
    """Measure the library against its reference, as ratios in one run."""
    from echofuse.bench import bench as measure_all

    table = measure_all()
    if options.out:
        _make_folder(options.out)
        _write_json(options.out / "bench.json", table)
    return 0 if table["passed"] else 1


COMMANDS: dict[str, Callable[[Namespace], int]] = {
    "run": run,
    "process": process,
    "verify": verify,
    "import": import_,
    "conform": conform,
    "plan": plan,
    "export-config": export_config,
    "bench": bench,
}


def _processed(
    recording: Recording, site: Site, options: Namespace, seed: int = 0, *, taps: bool = True
) -> RunResult:
    taps = taps and not options.no_report
    if getattr(options, "faults", None) is not None:
        from echofuse.emulation.command import run_with_faults

        check_positions(recording, site)
        return run_with_faults(recording, site, options.faults, seed=seed, target=options.target, taps=taps)
    from echofuse.emulation.deadline import Processor

    processor = Processor(
        clock_hz=1e6 * options.clock_mhz, cycles_per_instruction=options.cycles_per_instruction
    )
    return process_recording(recording, site, taps=taps, target=options.target, processor=processor)


def _replayed(recording: Recording, site: Site, target: str) -> RunResult:
    if recording.emulated is None:
        return process_recording(recording, site, target=target)
    from echofuse.emulation.command import replay

    return replay(recording, site, recording.emulated, target=target)


def _site_of_recording(recording: Recording, options: Namespace) -> Site:
    chosen: Path | None = getattr(options, "site", None)
    if chosen is not None:
        return load_site(chosen, few_nodes=True)
    if recording.site_toml.strip():
        return parse_site(recording.site_toml, f"{options.recording}: /site", few_nodes=True)
    kind = PIPELINES.get(recording.pipeline)
    if kind is None or len(recording.nodes) >= kind.least_nodes:
        raise InputError(problem(options.recording, "site", "a site file inside, or --site SITE.toml"))
    return bare_site(recording)


def _run_seeds(options: Namespace) -> int:
    """Run many seeds, print one line each and their mean."""
    site, _, people = site_of_case(options.case, options.people)
    columns = SEED_COLUMNS[site.pipeline]
    rows: list[dict[str, float]] = []
    baselines: list[dict[str, float]] = []
    unaccounted = 0  # runs whose faults are not those in the counters
    print("seed  " + "  ".join(f"{column:>20s}" for column in columns))
    for seed in progress(options.seeds, "seeds", len(options.seeds)):
        recording = simulated(site, options.case, people, seed, options.duration)
        result = _processed(recording, site, options, seed, taps=False)
        unaccounted += result.emulation is not None and bool(result.emulation.account.problems)
        rows.append(result.metrics)
        baselines.append(result.baseline_metrics)
        print(f"{seed:4d}  " + _cells(result.metrics, columns))
    for label, table in (("mean", rows), ("KF  ", baselines)):
        print(f"{label}  " + _cells({column: _mean(table, column) for column in columns}, columns))
    means = {name: _mean(rows, name) for name in rows[0]}
    for line in way_lines(means, setting.tracker_of(site)):
        print(line)
    if options.out:
        _make_folder(options.out)
        _write_json(
            options.out / "seeds.json",
            {str(seed): row for seed, row in zip(options.seeds, rows, strict=True)},
        )
    if unaccounted:
        print(f"{unaccounted} runs with faults that the counters do not account for")
    return 1 if unaccounted else 0


def _cells(metrics: dict[str, float], columns: Sequence[str]) -> str:
    """Return a line of the table; '-' where nothing is known, such as errors with nobody there."""
    known = [metrics.get(column, math.nan) for column in columns]
    width = [max(20, len(column)) for column in columns]
    return "  ".join(
        f"{'-' if math.isnan(value) else f'{value:.4f}':>{wide}s}"
        for value, wide in zip(known, width, strict=True)
    )


def _mean(table: Sequence[dict[str, float]], column: str) -> float:
    """Return the mean over the seeds, NaN where a seed knows none."""
    return float(np.mean([row.get(column, math.nan) for row in table]))


def _finish(result: RunResult, folder: Path, *, report: bool) -> int:
    """Write a run's folder and say what came out."""
    _make_folder(folder)
    write(folder / "recording.h5", replace(result.recording, outputs=result.outputs()))
    _write_json(folder / "metrics.json", result.metrics)
    _write_json(folder / "baseline_metrics.json", result.baseline_metrics)
    _write_json(folder / "counters.json", result.counters)
    _write_observations(folder / "observations.csv", result)
    if result.why_no_positions is None:
        _write_tracks(folder / "tracks.csv", result)
    else:
        (folder / "tracks.csv").unlink(missing_ok=True)  # of an earlier run in this folder
        print(f"no positions: {result.why_no_positions}")
        print(f"{len(result.detections)} ranges in observations.csv")
    beside_name = setting.baseline_name(result)
    for name, value in result.metrics.items():
        if is_of_a_way(name):
            continue
        baseline = result.baseline_metrics.get(name)
        beside = "" if baseline is None else f"   ({beside_name} {baseline:.4g})"
        print(f"{name:32s} {value:10.4g}{beside}")
    for line in (*way_lines(result.metrics, setting.tracker_of(result.site)), *health_lines(result)):
        print(line)
    if report:
        from echofuse.display.report import write_report

        print(f"wrote {write_report(result, folder)}")
    else:
        print(f"wrote {folder}")
    if result.emulation is None:
        return _verdict(result)
    from echofuse.emulation.command import tell, write_injections

    write_injections(folder / "injections.csv", result)
    return tell(result)


def _verdict(result: RunResult) -> int:
    """Say what a target did otherwise than this process, or too late; 1 when there is anything."""
    counted = {
        "scans_that_differ": "scans have other detections than in this process",
        "frames_that_differ": "frames have other tracks than in this process",
        "deadlines_missed": "scans or frames took longer than the radar's frame period",
    }
    found = [
        f"{result.metrics[name]:.0f} {what}" for name, what in counted.items() if result.metrics.get(name)
    ]
    for line in found:
        print(f"{result.target}: {line}")
    if result.target != "inprocess" and not found:
        print(f"{result.target}: every decision as in this process, no deadline missed")
    return 1 if found else 0


def _write_tracks(path: Path, result: RunResult) -> None:
    with path.open("w") as file:
        file.write("time_s,track_id,state,x_m,y_m,z_m,vx_mps,vy_mps,vz_mps\n")
        for row in result.tracks:
            file.write(
                f"{row['time_us'] * 1e-6:.6f},{row['id']},{TRACK_STATES[row['state']]},{row['x_m']:.4f},"
                f"{row['y_m']:.4f},{row['z_m']:.4f},"
                f"{row['vx_mps']:.4f},{row['vy_mps']:.4f},{row['vz_mps']:.4f}\n"
            )


def _write_observations(path: Path, result: RunResult) -> None:
    with path.open("w") as file:
        file.write("time_s,node,range_m,weight\n")
        for row in result.detections:
            name = result.recording.nodes[row["node"]].name
            range_m = row["delay_s"] * SPEED_OF_LIGHT_MPS
            file.write(f"{row['time_us'] * 1e-6:.6f},{name},{range_m:.4f},{row['weight']:.0f}\n")


def _write_json(path: Path, document: object) -> None:
    """Write numbers as JSON; what is not finite as null, since JSON has no word for it."""
    path.write_text(json.dumps(_finite(document), indent=2) + "\n")


def _finite(value: object) -> object:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(problem(folder, "", "a folder that can be made", error.strerror)) from error
