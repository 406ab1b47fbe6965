#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Style, types, and the rules of the house that a machine can hold.
# Usage: lint.sh BIN, the directory of ruff, mypy, import-linter and clang-format
set -uo pipefail

bin=$1
failed=0

check() { # TITLE COMMAND...
  echo "-- $1"
  "${@:2}" || failed=1
}

# A rule: no line of the files given after `--` may match.
forbid() { # TITLE PATTERN -- FILES...
  local hits
  echo "-- $1"
  if hits=$(grep -HnE "$2" "${@:4}"); then
    echo "$hits"
    failed=1
  fi
}

sources() { # PATHSPECS...
  git ls-files -co --exclude-standard -- "$@"
}

mapfile -t cpp < <(sources '*.cpp' '*.hpp')
mapfile -t core < <(sources cpp/include cpp/src)
mapfile -t public < <(sources cpp/include)
mapfile -t not_flann < <(sources cpp tests/cpp | grep -v -e '^cpp/cmake/' \
  -e 'CMakeLists' -e '^cpp/src/neighbors/neighborhoods\.cpp$')
mapfile -t not_cgal < <(sources cpp tests/cpp | grep -v -e '^cpp/cmake/' \
  -e 'CMakeLists' -e '^cpp/src/local/exact_orientation\.cpp$' \
  -e '^cpp/src/chain/candidates\.cpp$')
mapfile -t below < <(sources 'python/remanifold/*.py' |
  grep -v -e '^python/remanifold/cli/' -e '^python/remanifold/__init__\.py$')
mapfile -t unlicensed < <(sources '*.cpp' '*.hpp' '*.py' '*.pyi' '*.sh' '*.cmake' \
  '*CMakeLists.txt' Makefile | xargs grep -L 'SPDX-License-Identifier: GPL-3.0-or-later')

check "ruff check" "$bin/ruff" check .
check "ruff format" "$bin/ruff" format --check .
check "mypy" "$bin/mypy"
check "layers of the package" env PYTHONPATH=python "$bin/lint-imports" --no-logo --no-cache
forbid "nobody below the command line asks the front of the package" \
  '^ *(import remanifold( as|$)|from remanifold import [^_])' -- "${below[@]}"
check "clang-format" "$bin/clang-format" --dry-run -Werror "${cpp[@]}"
forbid "no Python in the core" 'pybind11|Python\.h' -- "${core[@]}"
forbid "FLANN only in its adapter" '#include *[<"]flann' -- "${not_flann[@]}"
forbid "CGAL only in its adapters" '#include *[<"]CGAL' -- "${not_cgal[@]}"
forbid "no third party in public headers" \
  '#include *[<"](CGAL|Eigen|flann|tbb|oneapi|boost)' -- "${public[@]}"
forbid "no output from the core" \
  '#include *<(iostream|print|cstdio|stdio\.h)>|std::(cout|cerr|clog)|printf *\(' -- \
  "${core[@]}"
echo "-- license line in every source"
if [ ${#unlicensed[@]} -gt 0 ]; then
  printf '%s: no SPDX line\n' "${unlicensed[@]}"
  failed=1
fi

if [ $failed -eq 0 ]; then echo "lint: all clean"; else echo "lint: FAILED"; fi
exit $failed
