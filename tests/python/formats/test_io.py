# SPDX-License-Identifier: GPL-3.0-or-later
"""Round trips through every format, foreign files, damaged files, and failed runs."""

from __future__ import annotations

import os
import re
import signal
import stat
import struct
import subprocess
import sys
import warnings
from pathlib import Path

import meshio
import numpy as np
import pytest

import remanifold as rm
from remanifold._base.files import complete_file
from remanifold.io import check_output, read_fields, read_points, write_mesh

# Coordinates without a short decimal form, very large and very small ones.
POINTS = np.array(
    [
        [0.1, 1 / 3, -2 / 3],
        [np.pi, 1e-300, -1e300],
        [1 + 2**-52, -0.0, 5e-324],
        [-np.e, 1e22, 123456789.123456789],
        [2.0, 3.0, 5.0],
    ]
)
EDGES = np.array([[0, 1], [1, 2], [2, 3], [0, 4]])
TRIANGLES = np.array([[0, 1, 2], [1, 2, 3], [0, 3, 4]])
TETRAHEDRA = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
SIMPLICES = {1: EDGES, 2: TRIANGLES, 3: TETRAHEDRA}


def put(path: Path, content: str | bytes) -> Path:
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


# ----------------------------------------------------------------- round trips


@pytest.mark.parametrize(
    ("suffix", "dim"),
    [
        *[(".ply", 1), (".ply", 2), (".obj", 1), (".obj", 2), (".off", 2)],
        *[(".vtk", 1), (".vtk", 2), (".vtk", 3), (".vtu", 1), (".vtu", 2), (".vtu", 3)],
        *[(".npz", 1), (".npz", 2), (".npz", 3), (".PLY", 2), (".OFF", 2)],
    ],
)
def test_points_come_back_bit_for_bit(tmp_path, suffix, dim):
    path = tmp_path / f"mesh{suffix}"
    write_mesh(path, POINTS, SIMPLICES[dim])
    points = read_points(path)
    assert points.dtype == np.float64
    assert points.tobytes() == POINTS.tobytes()


def test_stl_keeps_each_corner_once(tmp_path):
    write_mesh(tmp_path / "mesh.stl", POINTS, TRIANGLES)
    np.testing.assert_array_equal(read_points(tmp_path / "mesh.stl"), POINTS)


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".stl", ".vtk", ".vtu"])
def test_triangles_are_read_by_others(tmp_path, suffix):
    path = tmp_path / f"mesh{suffix}"
    points = np.random.default_rng(1).normal(size=(5, 3))
    write_mesh(path, points, TRIANGLES)
    with np.errstate(over="ignore"):  # meshio first takes text STL for binary
        mesh = meshio.read(path)
    (cells,) = mesh.cells
    assert cells.type == "triangle"
    np.testing.assert_array_equal(mesh.points[cells.data], points[TRIANGLES])


@pytest.mark.parametrize(
    ("suffix", "dim", "kind"),
    [
        (".vtk", 1, "line"),
        (".vtu", 1, "line"),
        (".vtk", 3, "tetra"),
        (".vtu", 3, "tetra"),
    ],
)
def test_edges_and_tetrahedra_are_read_by_others(tmp_path, suffix, dim, kind):
    path = tmp_path / f"mesh{suffix}"
    write_mesh(path, POINTS, SIMPLICES[dim])
    (cells,) = meshio.read(path).cells
    assert cells.type == kind
    np.testing.assert_array_equal(cells.data, SIMPLICES[dim])


def test_edges_in_ply_and_obj(tmp_path):
    write_mesh(tmp_path / "curve.ply", POINTS, EDGES)
    header, _, body = (tmp_path / "curve.ply").read_bytes().partition(b"end_header\n")
    assert b"element edge 4\nproperty int vertex1\nproperty int vertex2\n" in header
    stored = np.frombuffer(body[POINTS.nbytes :], "<i4").reshape(-1, 2)
    np.testing.assert_array_equal(stored, EDGES)

    write_mesh(tmp_path / "curve.obj", POINTS, EDGES)
    lines = (tmp_path / "curve.obj").read_text().splitlines()
    assert lines[len(POINTS) :] == ["l 1 2", "l 2 3", "l 3 4", "l 1 5"]


def test_archive_takes_any_dimension(tmp_path):
    points = np.random.default_rng(2).normal(size=(8, 9))
    simplices = np.array([[0, 1, 2, 3, 4, 5], [1, 2, 3, 5, 6, 7]])
    write_mesh(tmp_path / "mesh.npz", points, simplices)
    with np.load(tmp_path / "mesh.npz") as archive:
        np.testing.assert_array_equal(archive["points"], points)
        np.testing.assert_array_equal(archive["simplices"], simplices)


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".stl", ".vtk", ".vtu"])
def test_plane_points_get_a_zero(tmp_path, suffix):
    path = tmp_path / f"mesh{suffix}"
    points = np.random.default_rng(3).normal(size=(5, 2))
    write_mesh(path, points, TRIANGLES)
    np.testing.assert_array_equal(
        read_points(path), np.column_stack([points, np.zeros(5)])
    )


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".stl", ".vtk", ".vtu"])
def test_same_mesh_same_bytes(tmp_path, suffix):
    paths = [tmp_path / f"{name}{suffix}" for name in "ab"]
    for path in paths:
        write_mesh(path, POINTS[:, ::-1], TRIANGLES)
    assert paths[0].read_bytes() == paths[1].read_bytes()


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".vtk", ".npz"])
def test_mesh_without_simplices(tmp_path, suffix):
    path = tmp_path / f"mesh{suffix}"
    write_mesh(path, POINTS, np.empty((0, 3), dtype=np.int32))
    np.testing.assert_array_equal(read_points(path), POINTS)


def test_stl_of_a_degenerate_triangle_has_no_nan(tmp_path):
    write_mesh(tmp_path / "mesh.stl", [[0, 0, 0], [1, 1, 1], [2, 2, 2]], [[0, 1, 2]])
    assert "nan" not in (tmp_path / "mesh.stl").read_text()


# ---------------------------------------------------------------- tables, arrays


def test_npy(tmp_path):
    np.save(tmp_path / "a.npy", POINTS)
    np.testing.assert_array_equal(read_points(tmp_path / "a.npy"), POINTS)
    np.save(tmp_path / "b.npy", np.asfortranarray(np.ones((5, 1), np.float32)))
    points = read_points(tmp_path / "b.npy")
    assert points.dtype == np.float64
    assert points.shape == (5, 1)


def test_complex_numbers_count_twice(tmp_path):
    np.save(tmp_path / "a.npy", np.array([[1 + 2j, 3], [4j, 5]]))
    points = read_points(tmp_path / "a.npy")
    np.testing.assert_array_equal(points, [[1, 2, 3, 0], [0, 4, 5, 0]])


def test_npz_takes_points_or_the_only_matrix(tmp_path):
    np.savez(tmp_path / "a.npz", faces=TRIANGLES, points=POINTS)
    np.testing.assert_array_equal(read_points(tmp_path / "a.npz"), POINTS)
    np.savez(tmp_path / "b.npz", labels=np.arange(5), scan=POINTS)
    np.testing.assert_array_equal(read_points(tmp_path / "b.npz"), POINTS)


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (
            {"a": np.zeros((2, 3)), "b": np.zeros((4, 5))},
            r"found a \(2, 3\), b \(4, 5\)",
        ),
        ({"a": np.zeros(3)}, r"found a \(3,\)"),
        ({"points": np.zeros(3), "b": np.zeros((4, 5))}, r"'points' has shape \(3,\)"),
        ({"points": np.array([["a", "b"]])}, "holds <U1, expected numbers"),
        ({"points": np.array([[None, {}]])}, "holds Python objects"),
        ({"points": np.zeros((0, 3))}, "holds no points"),
    ],
)
def test_npz_without_points_says_what_it_holds(tmp_path, arrays, message):
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(ValueError, match=message) as caught:
        read_points(tmp_path / "a.npz")
    assert str(tmp_path / "a.npz") in str(caught.value)


@pytest.mark.parametrize("suffix", [".csv", ".txt", ".xyz"])
def test_table_with_full_precision(tmp_path, suffix):
    separator = "," if suffix == ".csv" else " "
    rows = [separator.join(map(repr, row)) for row in POINTS.tolist()]
    path = put(tmp_path / f"a{suffix}", "\n".join(rows))
    assert read_points(path).tobytes() == POINTS.tobytes()


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.csv", "x,y,z\n1,2,3\n4,5,6\n"),
        ("a.csv", '\ufeff"x", "y", "z"\r\n1, 2, 3\r\n\r\n4, 5, 6\r\n'),
        ("a.csv", "# made by hand\n1,2,3\n# more\n4,5,6"),
        ("a.xyz", "1 2 3\n4 5 6\n"),
        ("a.xyz", "\n  x y z\n\t1\t2  3 \n\n4 5 6\n\n"),
        ("a.txt", "# comment\n1e0 2. +3\n4 5 6"),
    ],
)
def test_table_with_header_comments_and_blank_lines(tmp_path, name, text):
    np.testing.assert_array_equal(
        read_points(put(tmp_path / name, text)), [[1, 2, 3], [4, 5, 6]]
    )


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.csv", "1,2,3\n4,x,6\n", "line 2: expected numbers .* found 'x'"),
        ("a.csv", "x,y\n1,2\na,b\n", "line 3: .* found 'a'"),
        ("a.csv", "x,2\n1,2\n", "line 1: .* found 'x'"),
        ("a.csv", "1,2,3\n\n4,5\n", "line 3: expected 3 numbers as before, found 2"),
        ("a.csv", "1:2:3\n4:5:6\n", "line 2: .* separated by commas, found '4:5:6'"),
        ("a.csv", "x,y,z\n", "holds no points"),
        ("a.csv", "", "holds no points"),
        ("a.xyz", "1 2 3\n4 5 6,\n", "line 2: .* separated by blanks, found '6,'"),
        ("a.xyz", b"1 2 3\n\xff\xfe\x00", "no text file"),
        ("a.csv", b"\x89PNG\r\n\x1a\n", "no text file"),
    ],
)
def test_bad_table_names_the_line(tmp_path, name, text, message):
    path = put(tmp_path / name, text)
    with pytest.raises(ValueError, match=message) as caught:
        read_points(path)
    assert str(path) in str(caught.value)


# ------------------------------------------------------- meshes made by others

PLY_HEADER = "ply\nformat {}\nelement vertex 2\n" + "".join(
    f"property float {axis}\n" for axis in "xyz"
)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("ascii.ply", PLY_HEADER.format("ascii 1.0") + "end_header\n1 2 3\n4 5 6\n"),
        (
            "little.ply",
            PLY_HEADER.format("binary_little_endian 1.0").encode()
            + b"end_header\n"
            + struct.pack("<6f", 1, 2, 3, 4, 5, 6),
        ),
        (
            "big.ply",
            PLY_HEADER.format("binary_big_endian 1.0").encode()
            + b"property uchar red\nend_header\n"
            + struct.pack(">3fB3fB", 1, 2, 3, 255, 4, 5, 6, 0),
        ),
        (
            # As range scanners write it: another element comes first.
            "camera.ply",
            b"ply\r\nformat binary_little_endian 1.0\r\ncomment a scan\r\n"
            b"element camera 1\r\nproperty float focal\r\nproperty int width\r\n"
            b"element patch 2\r\nproperty list uchar short ids\r\n"
            b"element vertex 2\r\nproperty double z\r\nproperty double y\r\n"
            b"property int flags\r\nproperty double x\r\nend_header\r\n"
            + struct.pack("<fi", 0.5, 640)
            + struct.pack("<BhhhB", 3, 7, 8, 9, 0)
            + struct.pack("<ddid", 3, 2, -1, 1)
            + struct.pack("<ddid", 6, 5, -1, 4),
        ),
        (
            "lists.ply",
            b"ply\nformat binary_little_endian 1.0\nelement vertex 2\n"
            b"property double x\nproperty list uchar int owners\n"
            b"property double y\nproperty double z\nend_header\n"
            + struct.pack("<dBiidd", 1, 2, 0, 0, 2, 3)
            + struct.pack("<dBdd", 4, 0, 5, 6),
        ),
        (
            "lists_ascii.ply",
            (
                "ply\nformat ascii 1.0\nelement range 2\nproperty list uchar int ids\n"
                "element vertex 2\nproperty double x\nproperty list uchar int owners\n"
                "property double y\nproperty double z\nend_header\n"
                "1 0\n0\n1 2 0 0 2 3\n4 0 5 6\n"
            ),
        ),
        ("points.obj", "# two points\nv 1 2 3\nv 4 5 6 1.0\n"),
        ("faces.obj", "mtllib x\nv 1 2 3\nvn 0 0 1\nvt 0 0\nv 4 5 6\nf 1//1 2//1 1\n"),
        ("points.off", "OFF\n2 0 0\n1 2 3\n4 5 6\n"),
        ("counts.off", "OFF 2 1\n# comment\n\n1 2 3 # one\n4 5 6 255 0 0\n3 0 1 1\n"),
        ("colors.off", "COFF\n2 0 0\n1 2 3 255 0 0 255\n4 5 6 0 0 0 255\n"),
        ("gudhi.off", "nOFF\n3 2 0 0\n1 2 3\n4 5 6\n"),
        ("geomview.off", "nOFF 3\n2 0 0\n1 2 3\n4 5 6\n"),
        (
            "points.vtk",
            (
                "# vtk DataFile Version 3.0\nscan\nASCII\nDATASET POLYDATA\n"
                "POINTS 2 float\n1 2 3 4\n5 6\nVERTICES 1 3\n2 0 1\n"
            ),
        ),
        (
            "grid.vtk",
            b"# vtk DataFile Version 3.0\nscan\nBINARY\nDATASET UNSTRUCTURED_GRID\n"
            b"POINTS 2 float\n"
            + struct.pack(">6f", 1, 2, 3, 4, 5, 6)
            + b"\nCELLS 0 0\n",
        ),
        (
            "ascii.stl",
            (
                "solid a\n facet normal 0 0 1\n  outer loop\n   vertex 1 2 3\n"
                "   vertex 4 5 6\n   vertex 1 2 3\n  endloop\n endfacet\nendsolid a\n"
            ),
        ),
        (
            "capitals.stl",
            (
                "SOLID vertex\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 1 2 3\n"
                "VERTEX 4 5 6\nVERTEX 1 2 3\nENDLOOP\nENDFACET\nENDSOLID\n\n"
            ),
        ),
        (
            "binary.stl",
            b"solid binary, in spite of the word".ljust(80)
            + struct.pack("<I12fH", 1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 1, 2, 3, 0),
        ),
    ],
)
def test_foreign_file(tmp_path, name, content):
    points = read_points(put(tmp_path / name, content))
    np.testing.assert_array_equal(points, [[1, 2, 3], [4, 5, 6]])


@pytest.mark.parametrize(
    ("suffix", "kind"),
    [
        *[(s, "triangle") for s in (".vtk", ".vtu", ".ply", ".obj", ".off", ".stl")],
        *[(s, "tetra") for s in (".vtk", ".vtu")],
    ],
)
def test_files_written_by_meshio(tmp_path, suffix, kind):
    cells = TRIANGLES if kind == "triangle" else TETRAHEDRA
    points = np.random.default_rng(4).normal(size=(5, 3))
    mesh = meshio.Mesh(points, [(kind, cells.astype(np.int32))])
    mesh.write(tmp_path / f"a{suffix}")
    np.testing.assert_array_equal(read_points(tmp_path / f"a{suffix}"), points)


def test_off_of_any_dimension(tmp_path):
    path = put(tmp_path / "a.off", "nOFF\n5 2 0 0\n1 2 3 4 5\n6 7 8 9 10\n")
    np.testing.assert_array_equal(read_points(path), np.arange(1, 11).reshape(2, 5))


def test_plane_ply(tmp_path):
    header = PLY_HEADER.format("ascii 1.0").replace("property float z\n", "")
    path = put(tmp_path / "a.ply", header + "end_header\n1 2\n3 4\n")
    np.testing.assert_array_equal(read_points(path), [[1, 2], [3, 4]])


# ---------------------------------------------------------------- damaged files


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.ply", "plie\n", "line 1: expected a PLY file"),
        ("a.ply", "ply\nformat ascii 1.0\nelement vertex 2\n", "no 'end_header'"),
        ("a.ply", "ply\nformat zip 1.0\nend_header\n", "line 2: no valid line"),
        ("a.ply", "ply\nformat ascii 1.0\nelement vertex x\n", "line 3: expected a c"),
        (
            "a.ply",
            "ply\nformat ascii 1.0\nend_header\n",
            "expected an element 'vertex'",
        ),
        (
            "a.ply",
            "ply\nelement vertex 0\nproperty float x\nend_header\n",
            "x, y, z|form",
        ),
        (
            "a.ply",
            PLY_HEADER.format("ascii 1.0") + "end_header\n1 2 3\n4 5\n",
            "line 9: expected 3 values, found 2",
        ),
        (
            "a.ply",
            PLY_HEADER.format("ascii 1.0\nelement range 2\nproperty int i")
            + "end_header\n0\n1\n1 2 3\n4 5 x\n",
            "line 13: expected 3 numbers, found '4 5 x'",
        ),
        (
            "a.ply",
            PLY_HEADER.format("ascii 1.0") + "end_header\n1 2 3\n",
            "truncated: expected 2 vertices, found 1",
        ),
        (
            "a.ply",
            PLY_HEADER.format("binary_little_endian 1.0") + "end_header\n" + 23 * "x",
            "truncated: expected 2 vertices, found 1",
        ),
        (
            "a.ply",
            (
                "ply\nformat binary_little_endian 1.0\nelement vertex 99999999999999\n"
                "property list uchar int a\nproperty double x\nproperty double y\n"
                "end_header\n\1"
            ),
            "truncated in the element 'vertex'",
        ),
        (
            "a.ply",
            PLY_HEADER.format("ascii 1.0").replace(" 2\n", " 0\n") + "end_header\n",
            "holds no points",
        ),
        ("a.obj", "vn 1 2 3\n", "expected lines 'v x y z', found none"),
        ("a.obj", "v 1 2 3\nv 1 2\n", "line 2: expected 3 numbers, found '1 2'"),
        ("a.obj", "v 1 2 3\nv 1 2 z\n", "line 2: expected 3 numbers, found '1 2 z'"),
        ("a.off", "", "line 1: expected 'OFF' or 'nOFF', found ''"),
        ("a.off", "OF\n1 0 0\n", "line 1: expected 'OFF' or 'nOFF', found 'OF'"),
        ("a.off", "OFF BINARY\n", "line 1: expected 'OFF'"),
        ("a.off", "4OFF\n1 0 0\n0 0 0 1\n", "line 1: expected 'OFF'"),
        ("a.off", "OFF\n", "ends before the number of vertices"),
        ("a.off", "OFF\n2 -1 0.5\n\n", "truncated: expected 2 vertices, found 0"),
        ("a.off", "OFF\n-2 0 0\n1 2 3\n", "line 2: expected a count, found '-2'"),
        ("a.off", "OFF\n3 0 0\n1 2 3\n4 5 6\n", "expected 3 vertices, found 2"),
        (
            "a.off",
            "OFF\n2 0 0\n1 2 3\n4 5\n",
            "line 4: expected 3 numbers, found '4 5'",
        ),
        ("a.stl", b"", "truncated: expected an STL header"),
        ("a.stl", 80 * b"\0" + struct.pack("<I", 3) + 60 * b"\0", "expected 3 facets"),
        ("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2 3\n", "truncated"),
        ("a.stl", "solid\nfacet\nvertex 1 2\nendsolid\n", "line 3: expected 3 numbers"),
        ("a.vtk", "POINTS 1 float\n1 2 3\n", "starting with '# vtk DataFile'"),
        (
            "a.vtk",
            "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n",
            "POINTS n",
        ),
        (
            "a.vtk",
            (
                "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n"
                "POINTS 2 float\n1 2 3\n4 5 x\n"
            ),
            "line 7: expected 3 numbers, found '4 5 x'",
        ),
        (
            "a.vtk",
            (
                "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n"
                "POINTS 2 float\n1 2 3\n4 5\n"
            ),
            "expected 2 points, found 1",
        ),
        (
            "a.vtk",
            (
                "# vtk DataFile Version 3.0\nx\nBINARY\nDATASET POLYDATA\n"
                "POINTS 2 double\n12345678"
            ),
            "expected 2 points, found 0",
        ),
        (
            "a.vtk",
            "# vtk DataFile Version 3.0\nx\nBINARY\nDATASET POLYDATA\nPOINTS 1 int\nx",
            "type float or double, found int",
        ),
        ("a.vtu", "<VTKFile", "damaged, truncated"),
        (
            "a.vtu",
            '<VTKFile type="PolyData"/>',
            "damaged, truncated or of another kind",
        ),
        ("a.vtu", "", "damaged, truncated"),
        ("a.vtu", "<html></html>", "damaged, truncated"),
        ("a.npy", b"", "damaged, truncated"),
        ("a.npy", b"\x93NUMPY\x01\x00", "damaged, truncated"),
        ("a.npz", b"PK\x03\x04 and then nothing", "damaged, truncated"),
        ("a.npz", "text", "damaged, truncated"),
    ],
)
def test_damaged_file_names_itself_and_the_reason(
    tmp_path, capfd, name, content, message
):
    path = put(tmp_path / name, content)
    with pytest.raises(ValueError, match=message) as caught:
        read_points(path)
    assert str(path) in str(caught.value)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "suffix", [".npz", ".npy", ".ply", ".off", ".stl", ".vtk", ".vtu"]
)
def test_every_truncation_is_noticed_or_harmless(tmp_path, suffix):
    """Cut anywhere, a file gives a ValueError, or else all of its points."""
    points = np.round(np.random.default_rng(5).normal(size=(5, 3)), 3)
    whole = tmp_path / f"whole{suffix}"
    if suffix == ".npy":
        np.save(whole, points)
    else:
        write_mesh(whole, points, TRIANGLES)
    data = whole.read_bytes()
    cut = tmp_path / f"cut{suffix}"
    errors = told = 0
    for size in range(0, len(data) - 1, 7):
        cut.write_bytes(data[:size])
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always", rm.FileWarning)
                found = read_points(cut)
        except ValueError as error:
            assert str(cut) in str(error)  # noqa: PT017
            errors += 1
        else:
            # A text file may end within its very last digits.
            np.testing.assert_allclose(found, points, rtol=1.0)
            assert all(str(cut) in str(w.message) for w in caught)
            told += len(caught)
    assert errors > 0
    # All points are there, and less of the triangles than the header says.
    assert (told > 0) == (suffix == ".ply")


# ------------------------------------------------------------- paths, refusals


def test_missing_file_directory_and_suffix(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no\.ply: no such file"):
        read_points(tmp_path / "no.ply")
    (tmp_path / "folder.ply").mkdir()
    with pytest.raises(IsADirectoryError, match=r"folder\.ply: is a directory"):
        read_points(tmp_path / "folder.ply")
    with pytest.raises(IsADirectoryError, match="is a directory"):
        read_points(tmp_path)
    with pytest.raises(ValueError, match=r"from \.docx; use one of \.npy, "):
        read_points(tmp_path / "a.docx")
    with pytest.raises(ValueError, match="a file without a suffix; use one of"):
        read_points(tmp_path / "points")


@pytest.mark.parametrize(
    ("name", "dim", "ambient_dim", "message"),
    [
        ("a.stl", 1, 3, r"\.stl cannot hold edges; use \.ply, \.obj, \.vtk, \.vtu, "),
        ("a.off", 1, 2, r"cannot hold edges"),
        ("a.ply", 3, 3, r"\.ply cannot hold tetrahedra; use \.vtk, \.vtu, .*\.npz$"),
        ("a.vtu", 4, None, r"hold simplices of dimension 4; use \.npz$"),
        ("a.vtu", 3, 4, r"cannot hold points with 4 coordinates; use \.npz$"),
        ("a.ply", 2, 4, r"cannot hold points with 4 coordinates; use \.off, \.npz$"),
        ("a.ply", None, 9, r"cannot hold points with 9 coordinates; use \.off, \.npz$"),
        ("a.xyz", 2, 3, r"cannot write a mesh to \.xyz; use one of \.ply, "),
        ("a", None, None, "a file without a suffix; use one of"),
    ],
)
def test_formats_that_cannot_hold_the_mesh(tmp_path, name, dim, ambient_dim, message):
    with pytest.raises(ValueError, match=message):
        check_output(tmp_path / name, dim, ambient_dim)
    if dim is not None and ambient_dim is not None:
        with pytest.raises(ValueError, match=message):
            write_mesh(
                tmp_path / name,
                np.zeros((6, ambient_dim)),
                np.arange(dim + 1)[None],
            )
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("vertices", "simplices", "message"),
    [
        (POINTS, [[0, 1, 5]], "indices from 0 to 4, got 0 to 5"),
        (POINTS, [[-1, 1, 2]], "got -1 to 2"),
        (POINTS, [[0.0, 1.0, 2.0]], "must be integers of shape"),
        (POINTS, [[0], [1]], "must be integers of shape"),
        (POINTS[0], [[0, 1, 2]], "vertices must be real numbers of shape"),
        (POINTS * 1j, [[0, 1, 2]], "vertices must be real numbers of shape"),
    ],
)
def test_arrays_that_do_not_fit(tmp_path, vertices, simplices, message):
    with pytest.raises(ValueError, match=message):
        write_mesh(tmp_path / "a.ply", vertices, simplices)
    assert list(tmp_path.iterdir()) == []


def test_target_that_is_no_file(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"folder .*no does not exist"):
        write_mesh(tmp_path / "no" / "a.ply", POINTS, TRIANGLES)
    (tmp_path / "a.ply").mkdir()
    with pytest.raises(IsADirectoryError, match="is a directory"):
        write_mesh(tmp_path / "a.ply", POINTS, TRIANGLES)
    os.mkfifo(tmp_path / "b.ply")
    with pytest.raises(ValueError, match="is not a regular file"):
        write_mesh(tmp_path / "b.ply", POINTS, TRIANGLES)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.ply", "b.ply"]
    with pytest.raises(FileNotFoundError, match=r"folder .*no does not exist"):
        check_output(tmp_path / "no" / "a.ply")


def test_folder_without_permission(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "access", lambda *_args: False)  # root may write anywhere
    with pytest.raises(PermissionError, match="no permission to write"):
        check_output(tmp_path / "a.ply")


@pytest.mark.parametrize("failure", [OSError(28, "No space left"), KeyboardInterrupt()])
@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".stl", ".vtk", ".npz"])
def test_failed_write_leaves_the_old_file_alone(tmp_path, monkeypatch, suffix, failure):
    path = put(tmp_path / f"a{suffix}", "the old one")

    def fail(*_args):
        raise failure

    # All is written, and the last step fails.
    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(type(failure)) as caught:
        write_mesh(path, POINTS, TRIANGLES)
    if isinstance(failure, OSError):
        assert f"{path}: cannot write the file (No space left)" in str(caught.value)
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_text() == "the old one"


def test_writing_replaces_the_file_behind_a_link(tmp_path):
    (tmp_path / "data").mkdir()
    target = put(tmp_path / "data" / "mesh-1.ply", "the old one")
    link = tmp_path / "mesh.ply"
    link.symlink_to(target)
    write_mesh(link, POINTS, TRIANGLES)
    assert link.is_symlink()
    np.testing.assert_array_equal(read_points(target), POINTS)
    assert list((tmp_path / "data").iterdir()) == [target]


def test_mode_follows_the_umask(tmp_path):
    old = os.umask(0o027)
    try:
        write_mesh(tmp_path / "a.ply", POINTS, TRIANGLES)
    finally:
        os.umask(old)
    assert (tmp_path / "a.ply").stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664, 0o444])
def test_rights_of_the_file_whose_place_is_taken(tmp_path, mode):
    path = put(tmp_path / "a.ply", "the old one")
    path.chmod(mode)
    write_mesh(path, POINTS, TRIANGLES)
    assert stat.S_IMODE(path.stat().st_mode) == mode
    np.testing.assert_array_equal(read_points(path), POINTS)


def test_nobody_looks_into_an_unfinished_file_who_may_not(tmp_path):
    path = put(tmp_path / "a.ply", "the old one")
    path.chmod(0o600)
    with complete_file(path):
        (partial,) = {*tmp_path.iterdir()} - {path}
        assert stat.S_IMODE(partial.stat().st_mode) == 0o600


def test_what_is_written_is_on_the_disk_before_it_has_its_name(tmp_path, monkeypatch):
    done = []
    sync, replace = os.fsync, Path.replace
    monkeypatch.setattr(os, "fsync", lambda f: (done.append("sync"), sync(f)))
    monkeypatch.setattr(
        Path, "replace", lambda a, b: (done.append("rename"), replace(a, b))
    )
    write_mesh(tmp_path / "a.ply", POINTS, TRIANGLES)
    assert done == ["sync", "rename", "sync"]  # the last one of the folder


@pytest.mark.parametrize("letter", ["a", "ä", "点"])
def test_names_as_long_as_there_are(tmp_path, letter):
    number = (249 - len(".ply")) // len(letter.encode())
    path = tmp_path / f"{letter * number}.ply"
    write_mesh(path, POINTS, TRIANGLES)
    assert [*tmp_path.iterdir()] == [path]


KILLED = """
import os, signal, sys
from remanifold._base.files import complete_file
with complete_file(sys.argv[1]) as file:
    file.write(b"half of it")
    file.flush()
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_what_a_killed_run_has_left_is_named(tmp_path):
    path = put(tmp_path / "a[1].ply", "the old one")
    done = subprocess.run([sys.executable, "-c", KILLED, path], check=False)
    assert done.returncode == -signal.SIGKILL
    assert path.read_text() == "the old one"
    (left,) = {*tmp_path.iterdir()} - {path}
    write_mesh(tmp_path / "b.ply", POINTS, TRIANGLES)  # no concern of this one
    with pytest.warns(rm.FileWarning, match=re.escape(f"has left {left.name}")):
        write_mesh(path, POINTS, TRIANGLES)
    np.testing.assert_array_equal(read_points(path), POINTS)
    left.unlink()
    write_mesh(path, POINTS, TRIANGLES)


def test_what_another_run_is_writing_is_not_left_over(tmp_path):
    with complete_file(tmp_path / "a.ply") as file:
        file.write(b"slowly")
        write_mesh(tmp_path / "a.ply", POINTS, TRIANGLES)  # would warn
    assert (tmp_path / "a.ply").read_bytes() == b"slowly"


@pytest.mark.parametrize("name", ["allow_pickle", "file", "mmap_mode", "args", "kwds"])
def test_fields_are_called_as_one_likes(tmp_path, name):
    values = np.arange(5)
    write_mesh(tmp_path / "a.npz", POINTS, TRIANGLES, fields={name: values})
    np.testing.assert_array_equal(read_fields(tmp_path / "a.npz")[name], values)


def test_an_image_of_points_says_how_it_becomes_a_list(tmp_path):
    np.save(tmp_path / "a.npy", np.zeros((4, 5, 3)))
    with pytest.raises(
        ValueError, match=r"\(4, 5, 3\), .* reshape\(-1, 3\) makes points"
    ):
        read_points(tmp_path / "a.npy")


def test_objects_are_not_unpickled(tmp_path):
    for name in ("a.npy", "a.npz"):
        save = np.save if name == "a.npy" else np.savez
        save(tmp_path / name, np.array([[{}, 1]], dtype=object))
        with pytest.raises(ValueError, match="holds Python objects, which are not"):
            read_points(tmp_path / name)


def test_vertices_of_any_layout(tmp_path):
    write_mesh(
        tmp_path / "a.ply", np.asfortranarray(POINTS), TRIANGLES.astype(np.uint8)
    )
    np.testing.assert_array_equal(read_points(tmp_path / "a.ply"), POINTS)
    write_mesh(str(tmp_path / "b.obj"), POINTS.tolist(), TRIANGLES.tolist())
    np.testing.assert_array_equal(read_points(str(tmp_path / "b.obj")), POINTS)
