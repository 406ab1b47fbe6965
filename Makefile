# SPDX-License-Identifier: GPL-3.0-or-later
# Each target installs what it needs first: missing Debian packages, a virtual environment
# in .venv, this package. Nothing is done again until its sources change.

PYTHON ?= python3
JOBS ?= $(shell nproc)

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DELETE_ON_ERROR:
export CMAKE_BUILD_PARALLEL_LEVEL ?= $(JOBS)
export PIP_DISABLE_PIP_VERSION_CHECK := 1

# `make bench` and `make test-lowest` call again with values of their own for what stands
# here: their packages are not for everybody.
VENV := .venv
BIN := $(VENV)/bin
BUILD := build/python
EXTRAS := gallery plot test
PINS := pinned# or lowest, newest: see .ci/install.sh
TESTS := ON
PEERS := OFF
MORE_PACKAGES :=
ENVIRONMENT := $(VENV)/.environment
LINTERS := $(VENV)/.linters
DOCUMENTERS := $(VENV)/.documenters
PACKAGE := $(VENV)/.package
INSTALL := .ci/install.sh $(BIN) $(PINS)
VERSIONS := pyproject.toml .ci/constraints.txt .ci/install.sh .ci/requirements.py

# The C++ tests and the benchmarks share the build of the Python module: the core is
# compiled once.
BUILD_SETTINGS := \
  --config-settings=build-dir=$(BUILD) \
  --config-settings=cmake.define.REMANIFOLD_BUILD_TESTS=$(TESTS) \
  --config-settings=cmake.define.REMANIFOLD_BUILD_BENCHMARKS=ON \
  --config-settings=cmake.define.REMANIFOLD_BUILD_PEERS=$(PEERS)

SOURCES := CMakeLists.txt README.md pyproject.toml $(shell find cpp python tests/cpp \
  tests/CMakeLists.txt benchmarks/CMakeLists.txt benchmarks/cpp -type f \
  -not -path '*/__pycache__/*')

.NOTPARALLEL:
.PHONY: all demo check test test-cpp test-python test-consumers test-lowest test-newest \
  smoke constraints bench bench-docs bench-hard hard bench-steps soak fuzz faults \
  interruptions distributed side-by-side \
  side-by-side-docs docs wheel lint format system-packages clean distclean

all: $(PACKAGE)

demo: $(PACKAGE)
	$(BIN)/python docs/examples/demo.py

# For the loop of editing: all of C++, and the tests of Python that are fast.
check: test-cpp
	$(BIN)/python -m pytest -q -n $(JOBS) --maxprocesses 4 -m "not slow"

test: test-cpp test-consumers test-python

test-cpp: $(PACKAGE)
	ctest --test-dir $(BUILD) --output-on-failure --no-tests=error -j $(JOBS)

test-consumers: $(PACKAGE)
	tests/consumers/run.sh $(BUILD)

test-python: $(PACKAGE)
	$(BIN)/python -m pytest -n $(JOBS) --maxprocesses 4 --dist worksteal

# The tests of Python with other versions of the dependencies: the lowest that
# pyproject.toml allows, the newest that exist.
test-lowest test-newest: test-%:
	+$(MAKE) VENV=.venv-$* BUILD=build/$* TESTS=OFF PINS=$* test-python

# The source distribution and the wheel made from it, where there is nothing else.
smoke: | $(BIN)/python
	.ci/smoke.sh $(PYTHON)

# New pins. With them, run everything.
constraints: | system-packages
	$(PYTHON) .ci/constraints.py

# Beside its peers. make bench ARGS="--shape torus --samples 10000,100000 --json FILE"
bench:
	+$(MAKE) $(BENCH) side-by-side

# The tables and the plot of docs/benchmarks.md, in about an hour.
bench-docs:
	+$(MAKE) $(BENCH) side-by-side-docs

# Open3D wants the last three packages.
BENCH := VENV=.venv-bench BUILD=build/bench EXTRAS="bench plot" TESTS=OFF \
  PEERS=ON PINS=newest MORE_PACKAGES="libegl1 libusb-1.0-0 libx11-6"
MEASURE = $(BIN)/python benchmarks/side_by_side.py \
  --driver $(BUILD)/benchmarks/remanifold_peers
MEASURE_FOR_DOCS = $(MEASURE) --cpu --time-limit 120 $(ARGS)

side-by-side: $(PACKAGE)
	$(MEASURE) $(ARGS)

side-by-side-docs: $(PACKAGE)
	$(MEASURE_FOR_DOCS) --shape torus --samples 10000,30000,100000,300000,1000000 \
	  --json $(BUILD)/torus.json
	$(MEASURE_FOR_DOCS) --shape sphere --samples 10000,100000,1000000 \
	  --json $(BUILD)/sphere.json
	$(MEASURE_FOR_DOCS) --shape circle --shape flat_torus_in_300 \
	  --shape sphere_times_circle --shape flat_torus_3 --shape rotations \
	  --shape sphere_4 --json $(BUILD)/others.json
	$(MEASURE_FOR_DOCS) --shape torus --samples 3000,30000 --noise 0.5 \
	  --json $(BUILD)/noise.json
	$(BIN)/python benchmarks/report.py --cpu $(BUILD)/{torus,sphere,others,noise}.json \
	  --into docs/benchmarks.md
	$(BIN)/python benchmarks/plot_growth.py --cpu $(BUILD)/torus.json \
	  -o docs/figures/side_by_side.svg

# Noise, raw scans, lattices: make bench-hard ARGS='"raw range scan"'
bench-hard:
	+$(MAKE) $(BENCH) hard

hard: $(PACKAGE)
	$(BIN)/python -m pip install -q meshlib
	$(BIN)/python benchmarks/hard.py --driver $(BUILD)/benchmarks/remanifold_peers $(ARGS)

# Random manifolds of all families. make soak ARGS="--seconds 3600 --seed 1"
soak: $(PACKAGE)
	$(BIN)/python benchmarks/soak.py $(ARGS)

# Bytes through the core and damaged files through the readers, ten minutes each.
# make fuzz SECONDS_EACH=3600 SEED=2
SECONDS_EACH = 600
SEED = 1
fuzz: $(PACKAGE)
	.ci/fuzz.sh $(BIN) $(SECONDS_EACH) $(SEED)

# Every allocation of small runs fails in turn; the tests take a sample.
faults: $(PACKAGE)
	REMANIFOLD_ALL_FAULTS=1 $(BUILD)/tests/remanifold_fault_tests

# Runs stopped at random moments. make interruptions ARGS="--count 1000 --seed 1"
interruptions: $(PACKAGE)
	$(BIN)/python tests/python/interrupting.py $(ARGS)

# In tiles, two million samples of several shapes, beside one piece: some minutes.
distributed: $(PACKAGE)
	$(BIN)/python benchmarks/tiles.py --tile-size 300000,1000000 $(ARGS)

# The steps one by one. make bench-steps ARGS="--shape sphere3 --samples 10000,20000"
bench-steps: $(PACKAGE)
	$(BUILD)/benchmarks/remanifold_bench $(ARGS)

# The pages as a site, build/docs/index.html; needs no network.
docs: $(PACKAGE) $(DOCUMENTERS)
	rm -rf build/docs
	$(BIN)/python -m sphinx -W --keep-going -q -b html -d build/doctrees docs build/docs
	@echo "docs: $$(find build/docs -name '*.html' | wc -l) pages, no warnings"

wheel: $(ENVIRONMENT) | system-packages
	.ci/wheel.sh $(BIN)

lint: $(ENVIRONMENT) $(LINTERS)
	.ci/lint.sh $(BIN)

format: $(LINTERS)
	$(BIN)/ruff check --fix-only .
	$(BIN)/ruff format .
	git ls-files -co --exclude-standard '*.cpp' '*.hpp' | xargs $(BIN)/clang-format -i

system-packages:
	@.ci/system-packages.sh $(PYTHON) $(MORE_PACKAGES)

$(BIN)/python: | system-packages
	$(PYTHON) -m venv $(VENV)

$(ENVIRONMENT): $(VERSIONS) | $(BIN)/python
	$(INSTALL) build runtime $(EXTRAS)
	touch $@

$(LINTERS): $(VERSIONS) | $(BIN)/python
	$(INSTALL) dev
	touch $@

$(DOCUMENTERS): $(VERSIONS) | $(BIN)/python
	$(INSTALL) docs
	touch $@

$(PACKAGE): $(ENVIRONMENT) $(SOURCES) | system-packages
	$(BIN)/python -m pip install --verbose --no-deps --no-build-isolation \
	  $(BUILD_SETTINGS) .
	touch $@

clean:
	rm -rf build dist
	rm -f .venv*/.package

distclean: clean
	rm -rf .venv .venv-*
