"""What `cmake --install` leaves behind is enough for a firmware outside of the tree.

It installs from the trees that `make test-cpp firmware` has built; one that is missing is an error.
"""

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from measure import heap_symbols

from echofuse.cli import main
from echofuse.emulation.codec import DETECTIONS, HEARTBEAT, FrameReader, parse_detections
from echofuse.emulation.image_size import image_size
from echofuse.pipeline import SensorRadar, scans_in_time_order
from echofuse.recording import read
from echofuse.site import example_site

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "firmware"
SITE = ROOT / "python/echofuse/sites/sensor_radar.toml"
TOOLCHAIN = ROOT / "firmware_sim" / "arm_none_eabi.cmake"
TIMEOUT_S = 600


def cmake(*arguments: "str | Path", status: int = 0) -> str:
    """Run CMake; what it said, in one line, so that its wrapping of messages does not matter."""
    done = subprocess.run(
        ["cmake", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        timeout=TIMEOUT_S,
    )
    assert done.returncode == status, done.stdout
    return " ".join(done.stdout.split())


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folders `host` and `cortex-m7`, moved after their installation."""
    first = tmp_path_factory.mktemp("installed") / "first"
    for preset in ("host", "cortex-m7"):
        cmake("--install", ROOT / "build" / preset, "--prefix", first / preset)
    return first.rename(first.with_name("moved"))


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A copy of the example, with its site."""
    folder = Path(shutil.copytree(EXAMPLE, tmp_path / "my_node"))
    assert main(["export-config", str(SITE), "--out", str(folder / "site_config.hpp")]) == 0
    return folder


def commands_of(page: Path) -> str:
    """Return the shell commands of a page."""
    return "\n".join(re.findall(r"^```sh\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL))


@pytest.mark.slow
def test_the_commands_of_the_page_run_and_both_nodes_say_what_this_process_says(tmp_path: Path) -> None:
    environment = os.environ | {"HOME": str(tmp_path)}
    page = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", commands_of(ROOT / "docs" / "porting.md")],
        cwd=ROOT,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        timeout=TIMEOUT_S,
    )
    assert page.returncode == 0, page.stdout
    folder = tmp_path / "my_node"
    assert "node 1, scan 60, " in page.stdout  # what records.py prints

    recording = read(folder / "run" / "recording.h5")
    radar = SensorRadar(example_site("sensor_radar"), recording.nodes)
    expected = [
        radar.scan(scan, recording.nodes[scan.node].scans[scan.index]).detections
        for scan in scans_in_time_order(recording.nodes)
        if recording.nodes[scan.node].name == "rx1"
    ]
    transfers = list(FrameReader().feed((folder / "frames-host.bin").read_bytes()))
    assert {transfer.source for transfer in transfers} == {1}
    assert sum(transfer.port == HEARTBEAT for transfer in transfers) >= 6  # of 6.1 s
    reports = [parse_detections(t.payload)[1] for t in transfers if t.port == DETECTIONS]
    assert len(reports) == len(expected) == 61
    assert max(map(len, reports)) > 0
    for theirs, ours in zip(reports, expected, strict=True):
        for name in ("delay_s", "weight"):
            assert np.array_equal(theirs[name], ours[name])
    assert (folder / "frames.bin").read_bytes() == (folder / "frames-host.bin").read_bytes()

    image = folder / "build/cortex-m7/my_node.elf"
    assert heap_symbols(image) == []
    size = image_size(image)
    stated = re.search(
        r"takes ([\d.]+) KB of flash and ([\d.]+) KB of RAM", (ROOT / "docs/porting.md").read_text()
    )
    assert stated is not None
    assert [size.flash_bytes, size.ram_bytes] == pytest.approx(
        [1e3 * float(kb) for kb in stated.groups()], rel=0.03
    )
    assert size.ram_bytes <= 98304


@pytest.mark.parametrize("preset", ["host", "cortex-m7"])
def test_what_is_installed_knows_neither_its_source_nor_where_it_was_put(
    installed: Path, preset: str
) -> None:
    files = [path for path in (installed / preset).rglob("*") if path.is_file()]
    headers = {path.relative_to(installed / preset / "include") for path in files if path.suffix == ".hpp"}
    source = ROOT / "cpp" / "include"
    assert headers == {path.relative_to(source) for path in source.rglob("*.hpp")}
    assert sum(path.suffix == ".a" for path in files) == 6
    named = [
        path.name
        for path in files
        for place in (ROOT, installed.with_name("first"))
        if os.fsencode(place) in path.read_bytes()
    ]
    assert named == []


def test_no_public_header_includes_a_generated_message(installed: Path) -> None:
    for header in (installed / "host" / "include").rglob("*.hpp"):
        for included in re.findall(r'#include [<"](.+?)[>"]', header.read_text()):
            assert "/" not in included or included.startswith(("echofuse/", "Eigen/")), header


def test_a_toolchain_that_names_no_processor_gets_the_libraries_own(installed: Path, project: Path) -> None:
    toolchain = project / "plain.cmake"
    toolchain.write_text("""
      set(CMAKE_SYSTEM_NAME Generic)
      set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
      set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)""")
    prefix = f"-DCMAKE_PREFIX_PATH={installed / 'cortex-m7'}"
    cmake("-S", project, "-B", project / "build", prefix, "--toolchain", toolchain, "-G", "Ninja")
    cmake("--build", project / "build")
    image = project / "build" / "my_node.elf"
    attributes = subprocess.run(
        ["arm-none-eabi-readelf", "-A", image], check=True, capture_output=True, text=True
    ).stdout
    assert 'Tag_CPU_name: "7E-M"' in attributes
    assert "Tag_ABI_VFP_args: VFP registers" in attributes
    assert heap_symbols(image) == []


@pytest.mark.slow
def test_the_tree_itself_can_be_part_of_a_build(project: Path) -> None:
    lists = project / "CMakeLists.txt"
    package = "find_package(echofuse 0.1 REQUIRED COMPONENTS node link)"
    assert package in lists.read_text()
    lists.write_text(lists.read_text().replace(package, f"add_subdirectory({ROOT} echofuse)"))
    build = project / "build"
    cmake("-S", project, "-B", build, "-DCMAKE_BUILD_TYPE=Debug", "-G", "Ninja")
    cmake("--build", build, "--target", "my_node")
    assert subprocess.run([build / "my_node"], stdin=subprocess.DEVNULL, check=False).returncode == 0
    cmake("--install", build, "--prefix", project / "installed")
    assert not (project / "installed").exists()


@pytest.mark.parametrize(
    ("change", "prefix", "options", "said"),
    [
        ("COMPONENTS node link|COMPONENTS node radio", "host", [], "it has no component radio, but core"),
        ("echofuse 0.1|echofuse 7.0", "host", [], 'compatible with requested version "7.0"'),
        ("|", "cortex-m7", [], "echofuseConfig.cmake, version: 0.1.0 (32bit)"),
        (
            "|",
            "cortex-m7",
            ["--toolchain", TOOLCHAIN, "-DECHOFUSE_CPU=cortex-m4", "-DECHOFUSE_FPU=fpv4-sp-d16"],
            "it was built with -mcpu=cortex-m7, and CMAKE_CXX_FLAGS says -mcpu=cortex-m4",
        ),
    ],
    ids=["component", "version", "host", "processor"],
)
def test_what_does_not_fit_is_refused(
    installed: Path, project: Path, change: str, prefix: str, options: list[str | Path], said: str
) -> None:
    lists = project / "CMakeLists.txt"
    lists.write_text(lists.read_text().replace(*change.split("|")))
    output = cmake(
        *("-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={installed / prefix}", *options),
        status=1,
    )
    assert said in output


def test_a_missing_site_is_told(installed: Path, project: Path) -> None:
    (project / "site_config.hpp").unlink()
    output = cmake(
        "-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={installed / 'host'}", status=1
    )
    assert "site_config.hpp is missing here: `echofuse export-config SITE.toml" in output


def test_a_limits_header_that_is_missing_is_told(tmp_path: Path) -> None:
    output = cmake("-S", ROOT, "-B", tmp_path, "-DECHOFUSE_LIMITS_HEADER=none.hpp", status=1)
    assert re.search(r"ECHOFUSE_LIMITS_HEADER=\S*none.hpp: expected a header that exists", output)


@pytest.mark.slow
def test_the_limits_of_the_libraries_are_those_of_who_links_them(tmp_path: Path, project: Path) -> None:
    """A program that is told nothing of the limits, and a library of half the samples."""
    limits = (ROOT / "cpp/include/echofuse/core/limits.hpp").read_text()
    constants = limits[limits.index("#else") + 5 : limits.index("#endif")]
    small = tmp_path / "small limits.hpp"
    small.write_text("#pragma once\n#include <cstddef>\n" + re.sub(r"\b1920\b", "960", constants))
    build, prefix = tmp_path / "build", tmp_path / "installed"
    options = [f"-DECHOFUSE_LIMITS_HEADER={small}", "-DCMAKE_BUILD_TYPE=Debug", "-G", "Ninja"]
    cmake("-S", ROOT, "-B", build, *options)
    cmake("--build", build)
    cmake("--install", build, "--prefix", prefix)
    small.unlink()
    (project / "node.cpp").write_text("""
      #include "echofuse/node/node.hpp"
      static_assert(echofuse::kMaxSamplesPerScan == 960);
      echofuse::node::SensorRadarNode pipeline;
      echofuse::node::SensorRadarNodeConfig config;
      int main() {
        const bool taken = pipeline.configure(config) == echofuse::Status::kOk;
        config.n_samples = 961;
        return taken && pipeline.configure(config) == echofuse::Status::kInvalidConfig ? 0 : 1;
      }""")
    cmake("-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={prefix}", "-G", "Ninja")
    cmake("--build", project / "build")
    assert subprocess.run([project / "build" / "my_node"], check=False).returncode == 0
