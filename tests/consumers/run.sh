#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Build and run a program against the installed library, and one that takes the sources in.
# Usage: run.sh BUILD, a directory in which the library is already built
set -euo pipefail
cd "$(dirname "$0")/../.."

build=$1
out=build/consumers
rm -rf "$out/prefix"
cmake --install "$build" --prefix "$out/prefix" --component development >/dev/null

consume() { # NAME SETTINGS...
  echo "-- consumer: $1"
  cmake -S "tests/consumers/$1" -B "$out/$1" -G Ninja "${@:2}" >/dev/null
  cmake --build "$out/$1"
  "$out/$1/consumer"
}

consume find_package -DCMAKE_BUILD_TYPE=Release "-DCMAKE_PREFIX_PATH=$PWD/$out/prefix"
# Compiles the whole core once more: without optimization, which is quickest.
consume add_subdirectory -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0
echo "consumers: 2 passed"
