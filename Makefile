# The front door. Everything lands in .venv, build/ and demo/.
#   demo       build, run the case study of the sensor radar, write demo/report.html
#   build      the Python package with its C++ core, as .venv/bin/echofuse
#   firmware   the bare-metal images, into build/cortex-m7 (and build/cortex-m4, which proves that a smaller core will do)
#   budgets    measures the images, prints README's table, and makes its figures the budgets of tests/firmware
#   test       everything: C++, Python, then C++ again under the sanitizers
#   test-fast  C++ and the quick part of Python, under three minutes
#   fuzz       10 million inputs into each decoder of the link (a quarter of an hour); fuzz-short: half a minute each
#   soak       100,000 frames of host processes under every fault: nothing may grow (10 minutes)
#   bench      C++ against the NumPy reference
#   lint       what pre-commit checks
#   stubs      python/echofuse/_core.pyi anew from the built core
#   clean      all but .venv;  distclean: .venv too

SHELL := /bin/bash
export PATH := $(CURDIR)/.venv/bin:$(PATH)
# One thread a process: pytest runs as many processes as there are cores.
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1

PYTHON := .venv/bin/python
SOURCES := pyproject.toml CMakeLists.txt README.md $(shell find cpp bindings python firmware_sim \
             \( -name __pycache__ -o -name '.*' \) -prune -o -type f -print)
CXX_FILES = $(shell git ls-files '*.cpp' '*.hpp')

.PHONY: demo build firmware budgets test test-fast test-cpp fuzz fuzz-short soak bench lint stubs clean distclean

demo: build
	.venv/bin/echofuse run sensor-radar --out demo

build: build/.installed

# A plain install and not an editable one, so that what is run and tested is what a wheel holds. scikit-build-core keeps
# its CMake tree in build/python and there is no build isolation, so a changed C++ file recompiles alone.
build/.installed: $(SOURCES) | .venv/.setup-run
	$(PYTHON) -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps .
	@touch $@

.venv/.setup-%: pyproject.toml tools/setup
	tools/setup $*

# What a part adds to the environment is put into the one that `run` has made.
.venv/.setup-test .venv/.setup-firmware .venv/.setup-fuzz .venv/.setup-lint: .venv/.setup-run

# The images go beside the package, where `--target cortex-m7` looks for them.
PACKAGE = $(shell $(PYTHON) -c 'import sysconfig; print(sysconfig.get_path("platlib"))')/echofuse
firmware: build .venv/.setup-firmware
	cmake --preset cortex-m7 >/dev/null
	cmake --build --preset cortex-m7
	install -D -t $(PACKAGE)/firmware/cortex-m7 build/cortex-m7/firmware_sim/*.elf
	cmake --preset cortex-m4 >/dev/null
	cmake --build --preset cortex-m4

budgets: build firmware
	$(PYTHON) tests/firmware/measure.py --update

test-cpp: .venv/.setup-test
	cmake --preset host >/dev/null
	cmake --build --preset host
	ctest --preset host

test: build test-cpp firmware fuzz-short
	$(PYTHON) -m pytest -q -n auto
	cmake --preset sanitize >/dev/null
	cmake --build --preset sanitize
	ctest --preset sanitize

test-fast: build test-cpp
	$(PYTHON) -m pytest -q -n auto -m 'not slow'

# Inputs that are worth keeping go to build/fuzz/corpus; what finds something is left in build/fuzz/findings.
FUZZERS := frames detections tracks node_health heartbeat synchronization raw_scan spatial_tracks
fuzz: .venv/.setup-fuzz
	tools/fuzz -runs=10000000 $(FUZZERS)
	tools/fuzz -runs=1000000 requests  # each of which searches 250 names

fuzz-short: .venv/.setup-fuzz
	tools/fuzz -max_total_time=30 frames requests messages

soak: build
	$(PYTHON) tests/soak/soak.py

bench: build
	.venv/bin/echofuse bench

lint: build .venv/.setup-lint
	clang-format --dry-run -Werror $(CXX_FILES)
	@! grep -rnE '#include <(Eigen/(Core|Dense|Eigen)|eigen3)' cpp tests bindings --include='*.[ch]pp' \
	  | grep -v core/eigen.hpp || { echo 'include echofuse/core/eigen.hpp instead'; exit 1; }
	ruff check .
	ruff format --check .
	mypy
	tools/stubs --check

stubs: build .venv/.setup-lint
	tools/stubs

clean:
	rm -rf build demo .mypy_cache .pytest_cache .ruff_cache .hypothesis
	find python tests -name __pycache__ -prune -exec rm -rf {} +

distclean: clean
	rm -rf .venv
