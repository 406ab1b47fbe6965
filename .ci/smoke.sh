#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The source distribution becomes a wheel in an environment that has only pip, and the
# wheel works in another one that has only what it asks for.
# Usage: smoke.sh PYTHON
set -euo pipefail

python=$1
work=build/smoke

rm -rf $work
mkdir -p $work
for name in sdist wheel installed; do "$python" -m venv $work/$name; done
$work/sdist/bin/python -m pip install build
$work/sdist/bin/python -m build --sdist --outdir $work .
$work/wheel/bin/python -m pip wheel --no-deps --wheel-dir $work $work/remanifold-*.tar.gz
$work/installed/bin/python -m pip install --constraint .ci/constraints.txt \
  $work/remanifold-*.whl
# Away from the sources, so that nothing but the wheel can be imported.
cp .ci/smoke.py $work/
cd $work
installed/bin/python -I smoke.py installed/bin/remanifold
