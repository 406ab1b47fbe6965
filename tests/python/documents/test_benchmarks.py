# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark of success rates tells right from wrong, and survives crashes."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import remanifold as rm
from remanifold import datasets
from remanifold.datasets import SHAPES

BENCHMARKS = Path(__file__).resolve().parents[3] / "benchmarks"
sys.path.insert(0, str(BENCHMARKS))  # the processes of the runs import it as well

import judge
import noise_ladder
import processes
import samples
import success_rates

pytestmark = pytest.mark.slow


def run(*arguments):
    done = subprocess.run(
        [sys.executable, BENCHMARKS / "success_rates.py", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done


def test_command(tmp_path):
    file = tmp_path / "results.json"
    done = run(
        *("--method", "paper", "--shape", "circle", "--seeds", 2, "--jobs", 2),
        *("--num-samples", 100, "--peers", "--markdown", "--json", file),
    )
    head, _, row = done.stdout.splitlines()
    assert head == (
        "|  | samples | paper | seconds | gudhi | seconds | gudhi perturbed | seconds |"
    )
    cells = [cell.strip() for cell in row.strip("|").split("|")]
    assert cells[:3] + cells[4::2] == ["circle in R^2", "100"] + ["2 of 2"] * 3
    report = json.loads(file.read_text(encoding="utf-8"))
    assert report["seeds"] == 2
    (result,) = report["results"]
    assert (result["name"], result["dim"], result["num_samples"]) == ("circle", 1, 100)
    assert list(result["methods"]) == ["paper", "gudhi", "gudhi perturbed"]
    assert result["methods"]["paper"]["successes"] == 2
    assert result["methods"]["paper"]["failures"] == {}


def test_reasons_of_failure_by_seed():
    done = run(
        *("--method", "paper", "--shape", "sphere", "--seeds", 2, "--jobs", 1, "-v")
    )
    lines = done.stderr.splitlines()
    assert lines[0].startswith("sphere, paper, 100, seed 0: wrong links: 3")
    assert "over Z3, not 1, 0, 1" in lines[1]
    assert done.stdout.splitlines()[1].split()[-3:-1] == ["of", "2"]


def test_smallest_number():
    arguments = ("--method", "paper", "--shape", "circle", "--seeds", 3)
    done = run(*arguments, "--smallest", "--num-samples", 40, "--verbose")
    number = int(done.stdout.split()[-1])
    assert f"circle, paper, {number}: enough" in done.stderr
    tried = [
        int(line.split(", ")[2].split(":")[0]) for line in done.stderr.splitlines()
    ]
    assert tried == sorted(tried) or tried == sorted(tried, reverse=True)


def test_grids_and_noise():
    rows = run("--method", "paper", "--grids", "--markdown").stdout.splitlines()[2:]
    cells = [[cell.strip() for cell in row.split("|")][1:4] for row in rows]
    assert cells == [
        ["grid on a torus", "960", "1 of 1"],
        ["grid on a cylinder", "960", "0 of 1"],
        ["figure 9 of the paper", "960", "0 of 1"],
    ]
    options = ("--noise", 0.5, "--num-samples", 300, "--seeds", 2)
    assert "0 of 2" in run("--method", "paper", *options).stdout


@pytest.mark.parametrize(
    "arguments",
    [["--shape", "cube"], ["--method", "magic"], ["--grids", "--smallest"]],
)
def test_wrong_usage(arguments):
    done = subprocess.run(
        [sys.executable, BENCHMARKS / "success_rates.py", "--method=paper", *arguments],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert arguments[-1] in done.stderr


def test_rows_of_the_table():
    rows = [*success_rates.TABLE, *success_rates.GRIDS]
    assert len({row.name for row in rows}) == len(rows)
    assert {row.shape for row in rows} <= set(SHAPES)
    for row in rows:
        assert row.draw(96 * 2, 0).shape[1] == SHAPES[row.shape].ambient_dim


# ------------------------------------------------------------------- judgement

OCTAHEDRON = np.array(
    [sorted((x, y, z)) for x in (0, 1) for y in (2, 3) for z in (4, 5)], dtype=np.int32
)
PROJECTIVE_PLANE = np.array(
    [
        *([0, 1, 2], [0, 1, 3], [0, 2, 4], [0, 3, 5], [0, 4, 5]),
        *([1, 2, 5], [1, 3, 4], [1, 4, 5], [2, 3, 4], [2, 3, 5]),
    ],
    dtype=np.int32,
)


def reasons(simplices, name, count=6):
    topology = rm.compute_topology(simplices, count)
    return list(judge.judge(simplices, topology, count, SHAPES[name]))


def test_right_complexes_pass():
    assert reasons(OCTAHEDRON, "sphere") == []
    assert reasons(PROJECTIVE_PLANE, "projective_plane") == []
    assert reasons(OCTAHEDRON[1:], "spherical_cap") == []
    ring = np.array([[0, 1], [0, 3], [1, 2], [2, 3]], dtype=np.int32)
    assert reasons(ring, "circle", 4) == []
    assert reasons(ring[1:], "spiral", 4) == []


@pytest.mark.parametrize(
    ("simplices", "name", "count", "expected"),
    [
        (OCTAHEDRON[:0], "sphere", 6, ["no simplices"]),
        (
            OCTAHEDRON[1:],
            "sphere",
            6,
            [
                "boundary components: 1, not 0",
                "Betti numbers 1, 0, 0 over Z2, not 1, 0, 1",
                "Betti numbers 1, 0, 0 over Z3, not 1, 0, 1",
            ],
        ),
        (
            PROJECTIVE_PLANE,
            "klein_bottle",
            6,
            [
                "Betti numbers 1, 1, 1 over Z2, not 1, 2, 1",
                "Betti numbers 1, 0, 0 over Z3, not 1, 1, 0",
            ],
        ),
        (OCTAHEDRON, "sphere", 7, ["unused samples: 1"]),
        (
            OCTAHEDRON[[0, 7]],  # two triangles without a common vertex
            "spherical_cap",
            6,
            [
                "boundary components: 2, not 1",
                "components: 2, not 1",
                "Betti numbers 2, 0, 0 over Z2, not 1, 0, 0",
                "Betti numbers 2, 0, 0 over Z3, not 1, 0, 0",
            ],
        ),
    ],
)
def test_wrong_complexes_fail(simplices, name, count, expected):
    assert reasons(simplices, name, count) == expected


def test_pinched_and_orientable():
    pinched = np.vstack([OCTAHEDRON, np.where(OCTAHEDRON == 0, 0, OCTAHEDRON + 5)])
    assert reasons(np.sort(pinched, axis=1), "sphere", 11)[0] == ("wrong links: 1")
    assert "orientable" in reasons(OCTAHEDRON, "projective_plane")


def test_noise_is_along_the_normals():
    draw = success_rates.NOISY.draw
    points = datasets.torus(3000, random_state=5)
    moves = samples.add_normal_noise(points, 2, 0.5, 5, draw) - points
    center = points * [1, 1, 0]
    center /= np.linalg.norm(center, axis=1, keepdims=True)
    along = np.einsum("ij,ij->i", moves, (points - center) / 0.4)
    size = samples.spacing(points)
    assert along.std() == pytest.approx(0.5 * size, rel=0.05)
    assert np.linalg.norm(moves, axis=1) == pytest.approx(np.abs(along), abs=0.2 * size)


# ------------------------------------------------------------------- processes


def test_crashes_are_outcomes():
    runs = processes.run_all(signal.raise_signal, [signal.SIGSEGV] * 2, 2, 60)
    for _, outcome in runs:
        assert outcome == processes.Failure("crashed: SIGSEGV", "crash")


def test_errors_are_outcomes():
    ((_, outcome),) = processes.run_all(int, ["x"], 1, 60)
    assert outcome.reason.startswith("ValueError: invalid literal")
    assert outcome.ending == "error"


def test_runs_without_end_are_outcomes():
    start = time.monotonic()
    found = dict(processes.run_all(time.sleep, [120, 0], 2, 3))
    assert found[120] == processes.Failure("not done after 3 s", "timeout")
    assert found[0] is None
    assert time.monotonic() - start < 60


# ---------------------------------------------------------------------- the ladder


def test_noise_ladder(tmp_path):
    file = tmp_path / "results.json"
    script = BENCHMARKS / "noise_ladder.py"
    arguments = ("--shape", "trefoil", "--seeds", "1", "--jobs", "1", "--markdown")
    arguments += ("--levels", "0.5", "--outliers", "0.05", "--json", str(file))
    done = subprocess.run(
        [sys.executable, script, *arguments],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    head, _, row = done.stdout.splitlines()
    assert [cell.strip() for cell in head.strip("|").split("|")] == [
        *("", "samples", "noise", "outliers", "found", "samples lost"),
        *("right", "samples off", "vertices off", "seconds"),
    ]
    cells = [cell.strip() for cell in row.strip("|").split("|")]
    assert cells[:4] == ["trefoil in R^3", "1,500", "0.5", "5%"]
    (record,) = json.loads(file.read_text(encoding="utf-8"))["results"]
    assert record["outliers_in_all"] == 75
    assert record["outliers_found"] > 60
    assert record["samples_off"] == pytest.approx(0.5 * np.sqrt(2), rel=0.1)


@pytest.mark.parametrize("row", noise_ladder.TABLE, ids=lambda row: row.name)
def test_distances_of_the_ladder(row):
    """None for the samples, and for noise what it is in so many normal directions."""
    shape, points = SHAPES[row.shape], row.draw(1000, 1)
    unit = samples.spacing(points)
    assert noise_ladder.distances(points, row, points, 1).max() < 0.03 * unit
    noisy = noise_ladder.add_noise(points, row, 0.1, 1)
    off = noise_ladder.distances(noisy, row, points, 1)
    expected = 0.1 * unit * np.sqrt(shape.ambient_dim - shape.dim)
    assert np.sqrt(np.mean(off**2)) == pytest.approx(expected, rel=0.1)
