#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The core under bytes that libFuzzer chooses, and the readers of files under damaged ones.
# Usage: fuzz.sh BIN SECONDS [SEED]; BIN has the Python of the package.
#
# With Clang (Debian: clang) the core is built once more, with assertions, sanitizers and
# counters of what an input reaches; new inputs are kept in build/fuzz/core. Without, the
# driver draws changes of the corpus at random.
set -euo pipefail
cd "$(dirname "$0")/.."

bin=$1 seconds=$2 seed=${3:-1}
out=build/fuzz
mkdir -p $out/core

settings=(-G Ninja -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g1")
if command -v clang++ >/dev/null; then
  cmake -S . -B $out/build "${settings[@]}" -DCMAKE_CXX_COMPILER=clang++ \
    -DREMANIFOLD_SANITIZE=fuzzer-no-link,address,undefined -DREMANIFOLD_LIBFUZZER=ON
  cmake --build $out/build --target remanifold_fuzz
  $out/build/tests/remanifold_fuzz -seed="$seed" -max_total_time="$seconds" -max_len=600 \
    -timeout=60 -rss_limit_mb=4000 -artifact_prefix=$out/ -print_final_stats=1 \
    $out/core tests/fuzz/corpus/core
else
  cmake -S . -B $out/build "${settings[@]}" -DREMANIFOLD_SANITIZE=address,undefined
  cmake --build $out/build --target remanifold_fuzz
  $out/build/tests/remanifold_fuzz --seconds "$seconds" --seed "$seed" \
    --keep $out/last tests/fuzz/corpus/core
fi
"$bin/python" tests/fuzz/fuzz_readers.py --seconds "$seconds" --seed "$seed"
