"""Instructions of one fix in space on the Cortex-M7, and no heap, with the image of `make firmware`."""

import subprocess
from pathlib import Path

import pytest
from measure import heap_symbols

IMAGE = Path(__file__).parents[2] / "build/cortex-m7/tests/firmware/taylor_3d.elf"
MAX_INSTRUCTIONS = 60_000
CONVERGED = 0

pytestmark = pytest.mark.slow


def test_it_needs_no_heap() -> None:
    assert heap_symbols(IMAGE) == []


def test_one_fix_stays_under_the_limit() -> None:
    machine = "qemu-system-arm -M mps2-an500 -nographic -icount shift=0"
    semihosting = "-semihosting-config enable=on,target=native"
    command = [*machine.split(), *semihosting.split(), "-kernel", str(IMAGE), "-append", "--node-id 1"]
    done = subprocess.run(
        command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60, check=True
    )
    *fixes, stack = (done.stdout + done.stderr).split("\n")[:-1]
    counts = [tuple(map(int, line.split())) for line in fixes]
    print(counts, stack)
    assert len(counts) == 12
    for instructions, iterations, status in counts:
        assert status == CONVERGED
        assert iterations >= 2
        assert 1_000 < instructions < MAX_INSTRUCTIONS
    assert 0 < int(stack) < 2048
