"""What the command line does with faults: reads the scenario, runs it, tells what was counted."""

from pathlib import Path

from echofuse.emulation.run import emulate
from echofuse.emulation.scenario_file import load_scenario, parse_scenario
from echofuse.recording import Emulated, Recording
from echofuse.result import RunResult
from echofuse.site import Site

__all__ = ["replay", "run_with_faults", "tell", "write_injections"]


def run_with_faults(
    recording: Recording, site: Site, faults: str, *, seed: int, target: str, taps: bool
) -> RunResult:
    """Run a recording with the faults of a scenario, by its name or its file."""
    return emulate(recording, site, load_scenario(faults), seed, target, taps=taps)


def replay(recording: Recording, site: Site, emulated: Emulated, *, target: str) -> RunResult:
    """Run a recording again with the faults that it was made with."""
    scenario = parse_scenario(emulated.scenario_toml, "the recording's scenario", name=emulated.scenario)
    return emulate(recording, site, scenario, emulated.seed, target)


def tell(result: RunResult) -> int:
    """Print the injected faults against the counters; 1 when they do not agree."""
    if result.emulation is None:
        return 0
    account = result.emulation.account
    print(account.text())
    return 1 if account.problems else 0


def write_injections(path: Path, result: RunResult) -> None:
    """Write each injected fault that happened at a time, one line each."""
    if result.emulation is None:
        return
    with path.open("w") as file:
        file.write("time_s,kind,node,effect,detail\n")
        for entry in result.emulation.log.entries:
            file.write(
                f"{entry.time_us * 1e-6:.6f},{entry.kind},{entry.node},{entry.effect.value},{entry.detail}\n"
            )
