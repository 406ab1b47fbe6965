#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Build and run a program against the installed library. One that takes the sources in
# compiles the whole core again: .ci/asan.sh, which does so anyway, has it.
# Usage: run.sh BUILD, a directory in which the library is already built
set -euo pipefail
cd "$(dirname "$0")/../.."

build=$1
out=build/consumers
rm -rf "$out/prefix"
cmake --install "$build" --prefix "$out/prefix" --component development >/dev/null

cmake -S tests/consumers/find_package -B "$out/find_package" -G Ninja \
  -DCMAKE_BUILD_TYPE=Release "-DCMAKE_PREFIX_PATH=$PWD/$out/prefix" >/dev/null
cmake --build "$out/find_package"
"$out/find_package/consumer"
echo "consumers: passed"
