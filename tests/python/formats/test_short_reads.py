# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads and writes of a part, and interrupted ones: files are whole all the same."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest

from remanifold.formats.writing import WRITERS

POINTS = np.random.default_rng(0).normal(size=(2000, 3))

# In place of the system's calls: every other one is interrupted before it has begun, the
# others read and write a third of what they are asked for.
SHIM = r"""
#include <errno.h>
#include <sys/syscall.h>
#include <unistd.h>

static int armed = 0;
static int count = 0;
int arm(int on) { int before = count; armed = on; count = 0; return before; }

static long part(long call, int file, void* data, size_t size) {
  if (armed && file > 2) {
    if (count++ % 2 == 0) { errno = EINTR; return -1; }
    size = size > 2 ? size / 3 : size;
  }
  return syscall(call, file, data, size);
}
ssize_t read(int file, void* data, size_t size) {
  return part(SYS_read, file, data, size);
}
ssize_t write(int file, const void* data, size_t size) {
  return part(SYS_write, file, (void*)data, size);
}
"""
CHILD = """
import ctypes, filecmp, sys, warnings
from pathlib import Path
import numpy as np
import remanifold as rm
from remanifold.formats.writing import WRITERS

warnings.simplefilter("ignore")
arm = ctypes.CDLL(None).arm
folder = Path(sys.argv[1])
points = np.random.default_rng(0).normal(size=(2000, 3))
triangles = np.sort(np.random.default_rng(1).permuted(
    np.tile(np.arange(2000), (700, 1)), axis=1)[:, :3])

def write(path):
    if WRITERS[path.suffix].dims == ():
        rm.io.write_points(path, points)
    else:
        rm.io.write_mesh(path, points, triangles)

def under_difficulties(call, *arguments):
    arm(1)
    try:
        return call(*arguments)
    finally:
        calls = arm(0)
        assert calls >= 2, (calls, arguments)

for suffix in sys.argv[2:]:
    whole, parts = folder / f"whole{suffix}", folder / f"parts{suffix}"
    write(whole)
    rm.io.read_points(whole)  # imports what it needs
    under_difficulties(write, parts)
    assert filecmp.cmp(whole, parts, shallow=False), suffix
    read = under_difficulties(rm.io.read_points, whole)
    assert read.tobytes() == rm.io.read_points(whole).tobytes(), suffix
print("all")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="calls of Linux")
@pytest.mark.skipif(shutil.which("c++") is None, reason="needs a compiler")
def test_calls_that_do_a_part(tmp_path):
    (tmp_path / "shim.c").write_text(SHIM)
    shim = tmp_path / "shim.so"
    subprocess.run(
        ["c++", "-x", "c", "-shared", "-fPIC", "-o", shim, tmp_path / "shim.c"],
        check=True,
    )
    # What PyArrow reads and writes by itself is its own affair.
    suffixes = [suffix for suffix in WRITERS if suffix != ".parquet"]
    done = subprocess.run(
        [sys.executable, "-c", CHILD, tmp_path, *suffixes],
        env={**os.environ, "LD_PRELOAD": str(shim)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.stdout, done.returncode) == ("all\n", 0), done.stderr


# Signals that are handled come every millisecond, and pipes hand over bit by bit.
INTERRUPTED = """
import signal, sys
from remanifold.cli import main
sys.argv = ["remanifold", "convert", "-", "-", "--format", "csv"]
sys.argv += ["--output-format", "csv"]
signal.signal(signal.SIGALRM, lambda *_: None)
signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)
try:
    sys.exit(main())
finally:
    signal.setitimer(signal.ITIMER_REAL, 0)
"""


def test_pipes_under_signals():
    given = "x,y,z\n" + "\n".join(",".join(map(repr, row)) for row in POINTS.tolist())
    with subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:

        def feed():
            with process.stdin as pipe:
                for start in range(0, len(given), 5000):
                    pipe.write(given[start : start + 5000].encode())
                    pipe.flush()

        feeding = threading.Thread(target=feed)
        feeding.start()
        read = []
        while part := os.read(process.stdout.fileno(), 3000):
            read.append(part)
        feeding.join()
        errors = process.stderr.read().decode()
        process.wait()
    assert process.returncode == 0, errors
    assert signal.Signals.SIGALRM.name not in errors
    rows = b"".join(read).decode().splitlines()
    assert len(rows) == 1 + len(POINTS)
    found = np.array([row.split(",") for row in rows[1:]], dtype=float)
    assert found.tobytes() == POINTS.tobytes()
