#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What cibuildwheel calls before it builds: the libraries of the core from conda-forge, the
# same releases on every system. Not tried on any so far, see CONTRIBUTING.
# Usage: wheel-libraries.sh DIRECTORY
set -euo pipefail

python -m pip install micromamba
micromamba create --yes --prefix "$1" --channel conda-forge \
  "cgal-cpp>=5.4" "eigen>=3.4" flann gmp lz4-c mpfr tbb-devel
