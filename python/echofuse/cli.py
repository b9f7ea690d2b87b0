"""The command line: parses, calls `echofuse.runner`, and turns bad input into one line and exit status 2."""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from echofuse import __version__
from echofuse.errors import InputError, TargetError

CASES = ("sensor-radar", "through-wall", "stairs")
TARGETS = ("inprocess", "process", "cortex-m7")
TARGET = "TARGET"


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of every subcommand."""
    parser = argparse.ArgumentParser(
        prog="echofuse",
        description="Find people with radar: run, process, prove and plan sensor-radar networks.",
    )
    parser.add_argument("--version", action="version", version=f"echofuse {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    run = commands.add_parser("run", help="simulate a case or a site of your own, and track the people in it")
    run.add_argument("case", help=f"one of {', '.join(CASES)}, or a SITE.toml")
    run.add_argument("--seed", type=_natural, default=0, help="of everything random (default 0)")
    run.add_argument("--seeds", type=_seed_range, help="FIRST-LAST: a table over many seeds, no report")
    run.add_argument(
        "--people",
        type=_people,
        help="how many people walk, 0 to 5 (default 1); behind a wall 0 to 4 (2); on the stairs 1",
    )
    run.add_argument(
        "--duration",
        type=_positive,
        metavar="SECONDS",
        help="of the walk (default: 6.1; behind a wall 60; a climb 24)",
    )
    run.add_argument("--out", type=Path, help="folder of the run (default runs/CASE-SEED)")
    run.add_argument("--no-report", action="store_true", help="tables only, no pictures")
    run.add_argument(
        "--faults", metavar="NAME|FILE", help="a scenario of faults, such as lost or all, or FILE.toml"
    )
    _add_target(run)

    process = commands.add_parser("process", help="track the people in a recording, ours or yours")
    process.add_argument("recording", type=Path)
    process.add_argument("--site", type=Path, help="site file (default: the one inside the recording)")
    process.add_argument("--out", type=Path, help="folder of the run (default: runs/RECORDING)")
    process.add_argument("--no-report", action="store_true", help="tables only, no pictures")
    _add_target(process)

    verify = commands.add_parser("verify", help="replay a recording and prove that the same bytes come out")
    verify.add_argument("recording", type=Path)
    verify.add_argument(
        "--target", type=_target, metavar=TARGET, default="inprocess", help="replay there (default inprocess)"
    )

    import_ = commands.add_parser("import", help="turn other people's recordings into ours")
    import_.add_argument("source", type=Path, help="a logger file, or a folder with one file a node")
    import_.add_argument("--site", type=Path, help="site file with the positions (default: a known example)")
    import_.add_argument("--out", type=Path, required=True, help="the HDF5 file to write")

    conform = commands.add_parser("conform", help="compare a target with the NumPy reference, tap by tap")
    conform.add_argument("cases", nargs="*", metavar="CASE", help=f"of {', '.join(CASES)} (default: all)")
    conform.add_argument(
        "--target", type=_target, metavar=TARGET, default="inprocess", help="what is compared"
    )
    conform.add_argument("--seeds", type=_natural, help="how many seeds (default 20; on the Cortex-M7 3)")
    conform.add_argument(
        "--recording", type=Path, help="conform on this recording too (default: the real walk)"
    )
    conform.add_argument("--out", type=Path, help="folder for conformance.json")

    plan = commands.add_parser("plan", help="draw a site's coverage and the accuracy that it can reach")
    plan.add_argument("site", type=Path)
    plan.add_argument("--out", type=Path, help="folder for the map (default plans/SITE)")

    export = commands.add_parser("export-config", help="a site as a C++ header, to be compiled into firmware")
    export.add_argument("site", type=Path)
    export.add_argument(
        "--recording", type=Path, help="takes each node's scan length and sample rate from here"
    )
    export.add_argument("--out", type=Path, required=True, help="the header to write, site_config.hpp")

    bench = commands.add_parser("bench", help="the library against the NumPy reference, as ratios")
    bench.add_argument("--out", type=Path, help="folder for bench.json")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; 0 when all is well, 1 when a check failed, 2 on bad input."""
    options = build_parser().parse_args(arguments)
    from echofuse import runner  # the heavy parts load when used

    try:
        return runner.COMMANDS[options.command](options)
    except InputError as error:
        print(f"echofuse: {error}", file=sys.stderr)
        return 2
    except TargetError as error:
        print(f"echofuse: {error}", file=sys.stderr)
        return 1
    except BrokenPipeError:  # whoever read the output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        print("echofuse: interrupted", file=sys.stderr)
        return 130


def _add_target(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--target",
        type=_target,
        metavar=TARGET,
        default="inprocess",
        help="in this process (default), as host processes, on bare Cortex-M7 images in QEMU, or a node of "
        "your own at tcp://HOST:PORT or serial:DEVICE[@BAUD] (several with commas; the others as processes)",
    )
    parser.add_argument(
        "--clock-mhz",
        type=_positive,
        default=216.0,
        help="of the node's processor, for deadlines (default 216)",
    )
    parser.add_argument(
        "--cycles-per-instruction",
        type=_positive,
        default=1.0,
        help="what an instruction takes there: instructions are counted, cycles stated (default 1)",
    )


def _target(text: str) -> str:
    if text in TARGETS:
        return text
    from echofuse.emulation.targets import port_url

    try:
        for address in text.split(","):
            port_url(address)
    except InputError:
        expected = f"{', '.join(TARGETS)}, tcp://HOST:PORT or serial:DEVICE[@BAUD]"
        raise argparse.ArgumentTypeError(f"expected {expected}, got {text}") from None
    return text


def _positive(text: str) -> float:
    value = float(text)
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a number > 0, got {text}")
    return value


def _natural(text: str) -> int:
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"expected a number >= 0, got {text}")
    return value


def _people(text: str) -> int:
    value = int(text)
    if not 0 <= value <= 5:
        raise argparse.ArgumentTypeError(f"expected 0 to 5 people, got {text}")
    return value


def _seed_range(text: str) -> range:
    first, _, last = text.partition("-")
    if not first.isdigit() or not (last or first).isdigit():
        raise argparse.ArgumentTypeError(f"expected FIRST-LAST such as 0-19, got {text}")
    return range(int(first), int(last or first) + 1)


if __name__ == "__main__":
    sys.exit(main())
