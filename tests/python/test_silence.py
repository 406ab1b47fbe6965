# SPDX-License-Identifier: GPL-3.0-or-later
"""Nothing but the result is on standard output, and what others print is left alone.

The file descriptors of a process of its own are looked at: what C code prints counts.
"""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

import remanifold as rm

# Noise leaves cavities that only programs fill, linear ones and an integer one.
NOISY = """
import numpy as np, remanifold as rm
points = rm.datasets.torus(800, random_state=2)
spacing = float(np.median(rm.neighborhoods(points, 1)[1]))
points = rm.datasets.add_noise(points, 0.6 * spacing, random_state=3)
"""


def run(*command, **options):
    return subprocess.run(command, capture_output=True, check=False, **options)


@pytest.fixture(scope="module")
def noisy(tmp_path_factory):
    scope: dict[str, np.ndarray] = {}
    exec(NOISY, scope)  # noqa: S102
    path = tmp_path_factory.mktemp("silence") / "noisy.npy"
    np.save(path, scope["points"])
    return path


def test_a_reconstruction_prints_nothing():
    code = NOISY + (
        "rec = rm.reconstruct(points, 2, smooth=False)\n"
        "assert rec.repair.num_programs > 0\n"
        "rec.topology(), rec.quality, repr(rec), rec.geodesic_distances(0)\n"
    )
    done = run(sys.executable, "-W", "ignore", "-c", code)
    assert done.returncode == 0, done.stderr
    assert done.stdout == b""
    assert done.stderr == b""


def test_what_others_print_meanwhile_arrives():
    """By Python, and by whatever writes to the descriptor itself."""
    code = NOISY + (
        "import os, threading\n"
        "from concurrent.futures import ThreadPoolExecutor\n"
        "done, lines = threading.Event(), 0\n"
        "def talk():\n"
        "    global lines\n"
        "    while not done.wait(0.001):\n"
        "        print('python', flush=True)\n"
        "        os.write(1, b'system\\n')\n"
        "        os.write(2, b'error\\n')\n"
        "        lines += 1\n"
        "talker = threading.Thread(target=talk)\n"
        "talker.start()\n"
        "with ThreadPoolExecutor(2) as pool:\n"
        "    list(pool.map(lambda p: rm.reconstruct(p, 2, smooth=False), [points, -points]))\n"
        "done.set(); talker.join()\n"
        "print('lines', lines)\n"
    )
    done = run(sys.executable, "-W", "ignore", "-c", code)
    assert done.returncode == 0, done.stderr
    out = done.stdout.decode().splitlines()
    count = int(out[-1].split()[1])
    assert count > 0
    assert sorted(out[:-1]) == ["python"] * count + ["system"] * count
    assert done.stderr.decode().splitlines() == ["error"] * count


def command(*arguments):
    command = ("-m", "remanifold", *map(str, arguments), "--smooth", "no")
    return run(sys.executable, *command)


def test_a_mesh_on_standard_output_is_all_there_is(noisy, tmp_path):
    out = command("reconstruct", noisy, "--dim", 2, "-o", "-", "--format", "ply")
    assert out.returncode == 0, out.stderr
    path = tmp_path / "mesh.ply"
    path.write_bytes(out.stdout)
    assert len(rm.io.read_complex(path).simplices) > 1000


def test_json_on_standard_output_is_all_there_is(noisy, tmp_path):
    out = command("reconstruct", noisy, "--dim", 2, "-o", tmp_path / "a.ply", "--json")
    assert out.returncode == 0, out.stderr
    assert json.loads(out.stdout)


def test_quiet_says_nothing(noisy, tmp_path):
    out = command("reconstruct", noisy, "--dim", 2, "-o", tmp_path / "a.ply", "-q")
    assert (out.returncode, out.stdout, out.stderr) == (0, b"", b"")


def test_a_report_page_prints_nothing_of_its_libraries(noisy, tmp_path):
    pytest.importorskip("plotly")
    page = tmp_path / "page.html"
    out = command("report", noisy, "--dim", 2, "-o", page, "-q")
    assert (out.returncode, out.stdout) == (0, b"")
    assert page.stat().st_size > 10_000
