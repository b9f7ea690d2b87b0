"""Instructions of one fix in space on the Cortex-M7, and no heap, with the libraries of `make firmware`."""

import subprocess
from pathlib import Path

import pytest
from measure import heap_symbols

ROOT = Path(__file__).parents[2]
LIBRARIES = ROOT / "build" / "cortex-m7"
BOARD = ROOT / "firmware_sim" / "mps2_an500"
MAX_INSTRUCTIONS = 60_000
CONVERGED = 0

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def image(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("taylor") / "taylor_3d.elf"
    target = "-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard"
    language = "-std=c++17 -O2 -DNDEBUG -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-use-cxa-atexit"
    sections = "-ffunction-sections -fdata-sections -fno-unwind-tables -fno-asynchronous-unwind-tables"
    link = f"-nostartfiles -T {BOARD / 'image.ld'} -Wl,--defsym=image_stack_bytes=4096 -Wl,--gc-sections"
    sources = [Path(__file__).with_name("taylor_3d.cpp"), *sorted(BOARD.glob("*.cpp"))]
    archives = [LIBRARIES / "libechofuse_hub.a", LIBRARIES / "libechofuse_core.a"]
    command = ["arm-none-eabi-g++", *f"{target} {language} {sections} -fno-math-errno".split()]
    command += ["-I", str(ROOT / "cpp/include"), "-I", str(ROOT / "firmware_sim"), *map(str, sources)]
    command += [*map(str, archives), *link.split(), "-o", str(made)]
    subprocess.run(command, check=True, capture_output=True)
    return made


def test_it_needs_no_heap(image: Path) -> None:
    assert heap_symbols(image) == []


def test_one_fix_stays_under_the_limit(image: Path) -> None:
    machine = "qemu-system-arm -M mps2-an500 -nographic -icount shift=0"
    semihosting = "-semihosting-config enable=on,target=native"
    command = [*machine.split(), *semihosting.split(), "-kernel", str(image), "-append", "--node-id 1"]
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
