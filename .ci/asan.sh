#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The C++ tests under the address and undefined-behavior sanitizers.
set -euo pipefail

cmake --preset asan
cmake --build --preset asan
ctest --preset asan -j "${CMAKE_BUILD_PARALLEL_LEVEL:-2}"
