# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line's ``project``."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest

import remanifold as rm

SQUARE = np.array([[0.0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]])
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
POINTS = np.array([[1.5, 0.25, 3.0], [-4, 0.5, 3], [2, 1, 0]])


def run(*arguments, data=None):
    done = subprocess.run(
        [sys.executable, "-m", "remanifold", "project", *map(str, arguments)],
        input=data,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout, done.stderr


@pytest.fixture
def files(tmp_path):
    rm.io.write_mesh(tmp_path / "square.ply", SQUARE, TRIANGLES)
    rm.io.write_points(tmp_path / "points.csv", POINTS)
    return tmp_path / "square.ply", tmp_path / "points.csv", tmp_path


def test_nearest_points_and_how_far_they_are(files):
    mesh, points, folder = files
    nearest = folder / "nearest.npz"
    code, out, err = run(mesh, points, "-o", nearest, "--json")
    assert (code, err) == (0, "")
    report = json.loads(out)
    assert report["num_points"] == 3
    assert report["num_simplices"] == 2
    assert report["distances"]["largest"] == 5.0
    assert report["distances"]["farthest_point"] == 1
    assert report["distances"]["smallest"] == 0.0
    np.testing.assert_allclose(
        rm.io.read_points(nearest), [[1.5, 0.25, 0], [0, 0.5, 0], [2, 1, 0]]
    )
    fields = rm.io.read_fields(nearest)
    np.testing.assert_array_equal(fields["simplex"], [0, 1, 0])
    np.testing.assert_allclose(fields["distance"], [3, 5, 0])
    corners = SQUARE[TRIANGLES[fields["simplex"]]]
    np.testing.assert_allclose(
        np.einsum("qk,qkd->qd", fields["barycentric"], corners),
        rm.io.read_points(nearest),
        atol=1e-15,
    )


def test_a_table_without_output(files):
    mesh, points, folder = files
    before = sorted(folder.iterdir())
    code, out, _ = run(mesh, points)
    assert code == 0
    assert "3 in R^3" in out
    assert "2 triangles" in out
    assert "point 1" in out
    assert sorted(folder.iterdir()) == before


def test_streams(files):
    mesh, points, _ = files
    code, out, err = run(
        *(mesh, "-", "--format", "csv", "-o", "-", "--output-format", "xyz"),
        data=points.read_text(),
    )
    assert code == 0
    names, *lines = out.splitlines()
    assert names.startswith("# x y z distance simplex ")
    rows = [[float(x) for x in line.split()][:3] for line in lines]
    np.testing.assert_allclose(rows, [[1.5, 0.25, 0], [0, 0.5, 0], [2, 1, 0]])
    assert "projected onto" in err  # the table makes room


def test_wrong_usage(files):
    mesh, points, folder = files
    rm.io.write_points(folder / "plane.csv", POINTS[:, :2])
    code, _, err = run(mesh, folder / "plane.csv")
    assert code == 2
    assert "'POINTS': have 2 coordinates" in err
    code, _, err = run(mesh, points, "-o", mesh)
    assert code == 2
    assert "is the input" in err
    assert len(rm.io.read_complex(mesh).simplices) == 2
    code, _, err = run(points, points)
    assert code == 1
    assert "points.csv" in err
