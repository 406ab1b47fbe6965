#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Install the Debian packages the build needs, if any is missing.
# Usage: system-packages.sh PYTHON [MORE PACKAGES...]
set -euo pipefail

python=${1:-python3}

"$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null || {
  echo "remanifold needs Python 3.10 or newer; '$python' is not." >&2
  exit 1
}

missing=()

need_command() { # COMMAND PACKAGE
  command -v "$1" >/dev/null || missing+=("$2")
}

need_package() {
  [ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" = installed ] ||
    missing+=("$1")
}

# The headers and the venv module of Debian's Python are packages of their own.
need_python() { # CODE PACKAGE
  "$python" -c "$1" 2>/dev/null || missing+=("$2")
}

need_command c++ g++
need_command ninja ninja-build
cmake_version=$({ cmake --version 2>/dev/null || true; } | sed -n '1s/[^0-9]*//p')
[ "$(printf '%s\n' 3.25 "${cmake_version:-0}" | sort -V | head -n 1)" = 3.25 ] ||
  missing+=(cmake)
need_python 'import ensurepip, venv' python3-venv
need_python '
import pathlib, sysconfig
(pathlib.Path(sysconfig.get_path("include")) / "Python.h").stat()' python3-dev
if command -v dpkg-query >/dev/null; then
  for package in libcgal-dev libeigen3-dev libflann-dev libgmp-dev libgtest-dev \
    liblz4-dev libmpfr-dev libtbb-dev; do
    need_package "$package"
  done
  # The wheel of pymeshlab, which the tests and the demo use, expects these two.
  need_package libgl1
  need_package libopengl0
  # And this one PyVista, to draw without a display.
  need_package libegl1
  for package in "${@:2}"; do
    need_package "$package"
  done
fi

[ ${#missing[@]} -gt 0 ] || exit 0

command="apt-get install --no-install-recommends ${missing[*]}"
if ! command -v apt-get >/dev/null; then
  echo "Missing, by the names of their Debian packages: ${missing[*]}" >&2
  exit 1
fi
if [ "$(id -u)" -eq 0 ]; then
  as_root=()
elif command -v sudo >/dev/null && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then
  as_root=(sudo)
else
  echo "These Debian packages are missing. As root, run: $command" >&2
  exit 1
fi

echo "Installing Debian packages: ${missing[*]}"
as_root+=(env DEBIAN_FRONTEND=noninteractive)
"${as_root[@]}" apt-get update -q </dev/null ||
  echo "apt-get update failed; trying with the lists at hand." >&2
"${as_root[@]}" apt-get install -q -y --no-install-recommends \
  -o DPkg::Lock::Timeout=300 "${missing[@]}" </dev/null || {
  echo "Could not install what is missing. As root, run: $command" >&2
  exit 1
}
