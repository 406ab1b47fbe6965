#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Install groups of requirements of pyproject.toml, see requirements.py.
# Usage: install.sh BIN pinned|lowest|newest GROUPS...
#   pinned  the versions of .ci/constraints.txt
#   lowest  the lowest versions that pyproject.toml allows
#   newest  the newest that exist
set -euo pipefail

python=$1/python
pins=$2
options=()
lowest=()
case $pins in
  pinned) options=(--constraint .ci/constraints.txt) ;;
  lowest) lowest=(--lowest) ;;
  newest) options=(--upgrade --upgrade-strategy eager) ;;
  *)
    echo "install.sh: pinned, lowest or newest, not '$pins'" >&2
    exit 1
    ;;
esac

mapfile -t wanted < <("$python" .ci/requirements.py "${lowest[@]}" "${@:3}")
[ ${#wanted[@]} -gt 0 ]
# Bytecode is made where something is imported, which most of it never is.
"$python" -m pip install --no-compile "${options[@]}" "${wanted[@]}"
