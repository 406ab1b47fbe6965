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

VENV := .venv
BIN := $(VENV)/bin
BUILD := build/python
ENVIRONMENT := $(VENV)/.environment
LINTERS := $(VENV)/.linters
PACKAGE := $(VENV)/.package

# The C++ tests and the benchmarks share the build of the Python module: the core is
# compiled once.
BUILD_SETTINGS := \
  --config-settings=build-dir=$(BUILD) \
  --config-settings=cmake.define.REMANIFOLD_BUILD_TESTS=ON \
  --config-settings=cmake.define.REMANIFOLD_BUILD_BENCHMARKS=ON

SOURCES := CMakeLists.txt README.md pyproject.toml $(shell find cpp python tests/cpp \
  tests/CMakeLists.txt benchmarks/CMakeLists.txt benchmarks/cpp -type f \
  -not -path '*/__pycache__/*')

.NOTPARALLEL:
.PHONY: all demo test test-cpp test-python test-consumers bench wheel lint format \
  system-packages clean distclean

all: $(PACKAGE)

demo: $(PACKAGE)
	$(BIN)/python docs/examples/demo.py

test: test-cpp test-consumers test-python

test-cpp: $(PACKAGE)
	ctest --test-dir $(BUILD) --output-on-failure --no-tests=error -j $(JOBS)

test-consumers: $(PACKAGE)
	tests/consumers/run.sh $(BUILD)

test-python: $(PACKAGE)
	$(BIN)/python -m pytest

# make bench ARGS="--shape sphere3 --samples 10000,20000"
bench: $(PACKAGE)
	$(BUILD)/benchmarks/remanifold_bench $(ARGS)

wheel: $(ENVIRONMENT) | system-packages
	.ci/wheel.sh $(BIN) $(BUILD_SETTINGS)

lint: $(ENVIRONMENT) $(LINTERS)
	.ci/lint.sh $(BIN)

format: $(LINTERS)
	$(BIN)/ruff check --fix-only .
	$(BIN)/ruff format .
	git ls-files -co --exclude-standard '*.cpp' '*.hpp' | xargs $(BIN)/clang-format -i

system-packages:
	@.ci/system-packages.sh $(PYTHON)

$(BIN)/python: | system-packages
	$(PYTHON) -m venv $(VENV)

$(ENVIRONMENT): pyproject.toml .ci/requirements.py | $(BIN)/python
	$(BIN)/python .ci/requirements.py build runtime plot test \
	  | xargs -d '\n' $(BIN)/python -m pip install
	touch $@

$(LINTERS): pyproject.toml .ci/requirements.py | $(BIN)/python
	$(BIN)/python .ci/requirements.py dev \
	  | xargs -d '\n' $(BIN)/python -m pip install
	touch $@

$(PACKAGE): $(ENVIRONMENT) $(SOURCES) | system-packages
	$(BIN)/python -m pip install --verbose --no-deps --no-build-isolation \
	  $(BUILD_SETTINGS) .
	touch $@

clean:
	rm -rf build dist
	rm -f $(PACKAGE)

distclean: clean
	rm -rf $(VENV)
