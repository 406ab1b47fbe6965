#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# A program that takes the sources in, and the C++ tests, under the address and
# undefined-behavior sanitizers: the core is compiled once for both.
set -euo pipefail
cd "$(dirname "$0")/.."

out=build/asan
cmake -S tests/consumers/add_subdirectory -B $out -G Ninja -DCMAKE_BUILD_TYPE=Debug \
  -DCMAKE_CXX_FLAGS_DEBUG="-O1 -g1" -DREMANIFOLD_SANITIZE=address,undefined \
  -DREMANIFOLD_BUILD_TESTS=ON -DREMANIFOLD_WARNINGS_AS_ERRORS=ON
cmake --build $out --target consumer remanifold_tests
$out/consumer
UBSAN_OPTIONS=print_stacktrace=1 ctest --test-dir $out/remanifold --output-on-failure \
  --no-tests=error -j "${CMAKE_BUILD_PARALLEL_LEVEL:-2}"
