"""A long run under every fault: does anything grow?

    python tests/soak/soak.py [--frames 100000] [--out FILE.json]

One person walks the case study's room to and fro for as long as it takes, every fault of the scenario `all`
holds, and once a minute nodes fall silent, restart and send garbage; every tenth minute the hub restarts.
Each machine is watched: its resident memory, how long after a scan the hub speaks of it (virtual time), and
how long a step takes (a ratio within the run, printed and not judged).
"""

import argparse
import json
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np

from echofuse.emulation import codec
from echofuse.emulation.machine import Machine, ScanInput, StepOutput, Target
from echofuse.emulation.radar import digitised
from echofuse.emulation.run import TICK_US, emulate
from echofuse.emulation.scenario import RadarFaults
from echofuse.emulation.scenario_file import load_scenario, parse_scenario
from echofuse.emulation.targets import TARGETS
from echofuse.recording import NodeRecording, Recording
from echofuse.simulation.scene import sensor_radar_scene
from echofuse.simulation.sensor_radar import case_study_people, simulate
from echofuse.site import Site, example_site

FRAME_US = 100_000
PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")
BLOCKS = 10  # a run is judged by its tenths, against the first of them
SLACK_BYTES = 256 * 1024  # a process that starts anew may have touched a page more
LATENCY_MOST_US = 80_000 + TICK_US  # the hub's deadline, and how often the emulation lets it look


class LoopedScans:
    """A walk's scans to and fro, (n, n_samples), without keeping them n / n_walk times."""

    def __init__(self, scans: np.ndarray, n: int) -> None:  # type: ignore[type-arg]
        self._scans = scans
        self.shape = (n, scans.shape[1])

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, index: int) -> np.ndarray:  # type: ignore[type-arg]
        last = len(self._scans) - 1
        return self._scans[last - abs(last - index % (2 * last))]


def looped(walk: Recording, n_frames: int) -> Recording:
    """The walk for n_frames frames; its converters have 12 bits. Where the person is, is not in it."""
    time_s = np.arange(n_frames) * FRAME_US * 1e-6

    def repeated(source: NodeRecording) -> NodeRecording:
        converted = digitised(source, RadarFaults(adc_bits=12))
        return replace(converted, scans=LoopedScans(converted.scans, n_frames), time_s=time_s)  # type: ignore[arg-type]

    return replace(walk, nodes=tuple(map(repeated, walk.nodes)), truth=())


def scenario_text(n_frames: int) -> str:
    """What scenario `all` does to radars and links, all the time, and its other faults again and again."""
    always = load_scenario("all").text.partition("[[fault]]")[0].replace("adc_bits = 12\n", "")
    always = always.replace("[radar]\n", f"[radar]\nperiod_us = {FRAME_US}\n", 1)
    faults = ['kind = "stranger"\nnode_id = 4242\nevery_us = 1000000']
    seconds = n_frames * FRAME_US * 1e-6
    for number, minute_s in enumerate(np.arange(0.0, seconds - 12.0, 60.0)):
        faults += [
            f'kind = "silent"\nnode = "rx3"\nat_s = {minute_s + 4.5}\nuntil_s = {minute_s + 10.0}',
            f'kind = "silent"\nnode = "rx5"\nat_s = {minute_s + 2.0}\nuntil_s = {minute_s + 8.0}',
            f'kind = "restart"\nnode = "rx4"\nat_s = {minute_s + 2.0}\nuntil_s = {minute_s + 2.3}',
            f'kind = "garbage"\nnode = "rx2"\nat_s = {minute_s + 3.5}\nuntil_s = {minute_s + 4.5}',
        ]
        if number % 10 == 0:
            faults.append(f'kind = "hub_restart"\nat_s = {minute_s + 3.02}\nuntil_s = {minute_s + 3.22}')
    return always + "".join(f"[[fault]]\n{fault}\n" for fault in faults)


@dataclass
class Block:
    """One tenth of a run."""

    frames: int = 0
    resident_bytes: dict[str, int] = field(default_factory=dict)  # largest of each machine
    latency_us: int = 0  # longest from a frame's first report to its tracks, the hub's clock
    step_s: float = 0.0
    steps: int = 0


class Watch:
    """What was seen of all machines, tenth by tenth of the hub's time."""

    def __init__(self, n_frames: int) -> None:
        self._block_us = n_frames * FRAME_US / BLOCKS
        self.blocks = [Block() for _ in range(BLOCKS)]
        self.now = self.blocks[0]
        self._hub_us = 0  # when the hub was stepped last

    def hub_stepped(self, now_us: int, elapsed_s: float, said: Sequence[codec.Transfer]) -> None:
        """Note a step of the hub."""
        self.now = block = self.blocks[min(int(now_us / self._block_us), BLOCKS - 1)]
        block.steps += 1
        block.step_s += elapsed_s
        on_time = (
            now_us <= self._hub_us + TICK_US
        )  # and not at its end, when it is given all the time to finish
        self._hub_us = now_us
        for transfer in said:
            if transfer.port == codec.TRACKS and transfer.kind == codec.MESSAGE:
                time_us, _, _ = codec.parse_tracks(transfer.payload)
                block.frames += 1
                block.latency_us = max(block.latency_us, now_us - time_us if on_time else 0)

    def resident(self, name: str, pid: int) -> None:
        """Note how much memory a process holds."""
        before = self.now.resident_bytes.get(name, 0)
        self.now.resident_bytes[name] = max(before, resident_bytes(pid))


class WatchedMachine:
    """A machine, and what its steps show."""

    def __init__(self, name: str, machine: Machine, watch: Watch) -> None:
        self._name, self._machine, self._watch = name, machine, watch
        self._pid = machine._machine.board._process.pid  # type: ignore[attr-defined]
        self._steps = 0
        self._reader = codec.FrameReader()

    def step(
        self, now_us: int, link_in: bytes = b"", scan: ScanInput | None = None, *, taps: bool = False
    ) -> StepOutput:
        """Step it, and look at it now and then."""
        begin_s = time.perf_counter()
        output = self._machine.step(now_us, link_in, scan, taps=taps)
        if self._name == "hub":
            said = list(self._reader.feed(output.link_out))
            self._watch.hub_stepped(now_us, time.perf_counter() - begin_s, said)
        self._steps += 1
        if self._steps % 100 == 0:
            self._watch.resident(self._name, self._pid)
        return output

    def counters(self, now_us: int) -> dict[str, int]:
        """Those of the machine."""
        return self._machine.counters(now_us)

    def close(self) -> None:
        """Switch it off."""
        self._machine.close()


class WatchedTarget:
    """A target of firmware whose machines are watched."""

    def __init__(self, target: Target, sources: Sequence[NodeRecording], watch: Watch) -> None:
        self.name = target.name
        self._target, self._sources, self._watch = target, sources, watch

    def open_node(self, index: int) -> Machine:
        """Start a node."""
        return WatchedMachine(self._sources[index].name, self._target.open_node(index), self._watch)

    def open_hub(self) -> Machine:
        """Start the hub."""
        return WatchedMachine("hub", self._target.open_hub(), self._watch)

    def close(self) -> None:
        """Nothing is held beside the machines."""
        self._target.close()


def resident_bytes(pid: int) -> int:
    """Return how much memory a process holds."""
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * PAGE_BYTES


def soak(n_frames: int) -> tuple[list[Block], dict[str, int], list[str]]:
    """Run n_frames frames of host processes; the tenths, the hub's counters, and what is wrong."""
    walk = simulate(sensor_radar_scene(), case_study_people(1), seed=0)
    watch = Watch(n_frames)

    def opener(name: str, site: Site, sources: Sequence[NodeRecording]) -> Target:
        return WatchedTarget(TARGETS["process"]("process", site, sources), sources, watch)

    TARGETS["watched:"] = opener
    try:
        scenario = parse_scenario(scenario_text(n_frames))
        result = emulate(looped(walk, n_frames), example_site("sensor_radar"), scenario, 0, "watched:process")
    finally:
        del TARGETS["watched:"]
    assert result.emulation is not None
    return watch.blocks, result.counters["hub"], [*result.emulation.account.problems, *grown(watch.blocks)]


def grown(blocks: Sequence[Block]) -> list[str]:
    """Return what grew after the first tenth."""
    first, found = blocks[0], []
    for number, block in enumerate(blocks[1:], start=2):
        if block.latency_us > LATENCY_MOST_US:
            found.append(f"tenth {number}: tracks {block.latency_us} us after their frame's first report")
        for name, size in block.resident_bytes.items():
            if size > first.resident_bytes[name] + SLACK_BYTES:
                found.append(
                    f"tenth {number}: {name} holds {size} bytes, {first.resident_bytes[name]} at first"
                )
    return found


def main() -> int:
    """Run it, print the tenths, and say whether anything grew."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--frames", type=int, default=100_000)
    parser.add_argument("--out", type=Path, help="a JSON file with the tenths and the hub's counters")
    options = parser.parse_args()
    blocks, counters, problems = soak(options.frames)
    print("tenth  frames  hub [KiB]  nodes [KiB]  latency [ms]  step, of the first")
    for number, block in enumerate(blocks, start=1):
        nodes = [size // 1024 for name, size in block.resident_bytes.items() if name != "hub"]
        ratio = (block.step_s / block.steps) / (blocks[0].step_s / blocks[0].steps)
        memory = f"{block.resident_bytes['hub'] // 1024:10d}  {min(nodes)}-{max(nodes)}"
        print(f"{number:5d} {block.frames:7d} {memory}{block.latency_us / 1000:14.1f} {ratio:19.2f}")
    print(", ".join(f"{name} {count}" for name, count in counters.items() if count))
    if options.out:
        options.out.write_text(json.dumps({"tenths": list(map(asdict, blocks)), "hub": counters}, indent=1))
    for problem in problems:
        print(f"soak: {problem}", file=sys.stderr)
    return int(bool(problems))


if __name__ == "__main__":
    sys.exit(main())
