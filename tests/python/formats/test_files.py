# SPDX-License-Identifier: GPL-3.0-or-later
"""Complexes, polygons and fields in files; LAS, glTF, streams; files cut short."""

from __future__ import annotations

import io
import json
import struct
import sys
import warnings

import laspy
import numpy as np
import pytest
import trimesh

import remanifold as rm
from remanifold.formats import _mesh, _source, _stl
from remanifold.io import (
    read_complex,
    read_fields,
    read_points,
    write_complex,
    write_mesh,
    write_points,
)

RNG = np.random.default_rng(0)
POINTS = RNG.normal(size=(6, 3)) * [1, 1e-7, 1e9]
SIMPLICES = {
    1: np.array([[0, 1], [1, 2], [4, 2], [4, 5]]),
    2: np.array([[0, 1, 2], [1, 3, 2], [5, 3, 4]]),
    3: np.array([[0, 1, 2, 3], [1, 2, 3, 5], [4, 2, 3, 5]]),
}
HOLDS = {
    ".npz": (1, 2, 3),
    ".ply": (1, 2),
    ".obj": (1, 2),
    ".off": (2,),
    ".stl": (2,),
    ".vtk": (1, 2, 3),
    ".vtu": (1, 2, 3),
}
FIELDS = {
    "inside": np.array([True, False, False, True, True, False]),
    "number": np.array([-3, 0, 1, 2, 3, 2**31 - 1]),
    "spacing": np.array([0.1, np.inf, np.nan, 1e-300, -0.0, np.pi]),
    "single": np.arange(6, dtype=np.float32) / 3,
    "byte": np.array([0, 1, 2, 253, 254, 255], dtype=np.uint8),
    "short": np.array([-(2**15), 0, 0, 0, 0, 2**15 - 1], dtype=np.int16),
    "normals": RNG.normal(size=(6, 3)),
    "pairs": RNG.normal(size=(6, 2)),
}


def put(path, content):
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


# ----------------------------------------------------------------- complexes


@pytest.mark.parametrize(
    ("suffix", "dim"), [(suffix, dim) for suffix, dims in HOLDS.items() for dim in dims]
)
def test_complex_comes_back_bit_for_bit(tmp_path, suffix, dim):
    path = tmp_path / f"mesh{suffix}"
    complex = rm.SimplicialComplex(POINTS, SIMPLICES[dim])
    write_complex(path, complex)
    found = read_complex(path)
    assert found.dim == dim
    if suffix == ".stl":  # vertices in the order of the facets
        np.testing.assert_array_equal(
            found.vertices[found.simplices], POINTS[SIMPLICES[dim]]
        )
        return
    assert found.vertices.tobytes() == POINTS.tobytes()
    np.testing.assert_array_equal(found.simplices, SIMPLICES[dim])
    # The same by a method, and with a name that says nothing.
    complex.write(tmp_path / "mesh", format=suffix[1:])
    assert (tmp_path / "mesh").read_bytes() == path.read_bytes()
    again = read_complex(tmp_path / "mesh", format=suffix)
    np.testing.assert_array_equal(again.simplices, SIMPLICES[dim])


@pytest.mark.parametrize(("suffix", "ambient"), [(".npz", 7), (".npz", 1), (".off", 5)])
def test_any_number_of_coordinates(tmp_path, suffix, ambient):
    points = RNG.normal(size=(6, ambient))
    simplices = SIMPLICES[2 if suffix == ".off" else 1]
    path = tmp_path / f"mesh{suffix}"
    write_mesh(path, points, simplices)
    found = read_complex(path)
    assert found.vertices.tobytes() == points.tobytes()
    np.testing.assert_array_equal(found.simplices, simplices)


def test_gudhi_reads_the_points_of_off(tmp_path):
    gudhi = pytest.importorskip("gudhi")
    for ambient in (3, 5):
        points = RNG.normal(size=(6, ambient))
        write_points(tmp_path / "a.off", points)
        found = gudhi.read_points_from_off_file(str(tmp_path / "a.off"))
        np.testing.assert_array_equal(np.array(found), points)


def test_high_dimension_in_an_archive(tmp_path):
    points, simplices = (
        RNG.normal(size=(8, 9)),
        [[0, 1, 2, 3, 4, 5], [2, 3, 4, 5, 6, 7]],
    )
    write_mesh(tmp_path / "a.npz", points, simplices)
    assert read_complex(tmp_path / "a.npz").dim == 5


def test_reconstruction_is_written_with_its_fields(tmp_path):
    points = rm.datasets.spherical_cap(300, random_state=0)
    rec = rm.reconstruct(np.vstack([points, [[5, 5, 5]]]), 2)
    rec.write(tmp_path / "a.vtu")
    assert "quality" not in vars(rec)  # which takes as long as the reconstruction
    fields = read_fields(tmp_path / "a.vtu")
    assert {*fields} == {"boundary", "outlier"}
    np.testing.assert_array_equal(fields["boundary"], rec.boundary)
    assert fields["boundary"].sum() > 10
    np.testing.assert_array_equal(np.flatnonzero(fields["outlier"]), rec.outliers)
    rec.write(tmp_path / "a.obj")  # has no fields
    rec.write(tmp_path / "b.vtu", fields=None)
    assert read_fields(tmp_path / "b.vtu") == {}
    with pytest.raises(ValueError, match="fields is 'some', expected one of 'auto', "):
        rec.write(tmp_path / "b.vtu", fields="some")
    with pytest.raises(ValueError, match=r"\.obj cannot hold the fields 'boundary', "):
        rec.write(tmp_path / "b.obj", fields="all")
    rec.write(tmp_path / "c.npz", fields="all")
    fields = read_fields(tmp_path / "c.npz")
    assert fields["boundary"].dtype == bool
    for name in ("spacing", "reach", "doubtful", "gap"):
        np.testing.assert_array_equal(fields[name], getattr(rec.quality, name))
    rec.write(tmp_path / "d.npz")  # as it is known now
    assert (tmp_path / "d.npz").read_bytes() == (tmp_path / "c.npz").read_bytes()
    found = read_complex(tmp_path / "d.npz")
    np.testing.assert_array_equal(found.simplices, rec.simplices)


def test_without_coordinates_there_is_nothing_to_write(tmp_path):
    points = rm.datasets.circle(60, random_state=0)
    rec = rm.reconstruct(gram=points @ points.T, dim=1)
    with pytest.raises(ValueError, match="no coordinates, only inner products"):
        rec.write(tmp_path / "a.npz")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "call",
    [
        lambda: write_complex("a.ply", [[0, 1, 2]]),
        lambda: rm.edge_graph([[0, 1, 2]]),
        lambda: rm.interoperability.to_gudhi([[0, 1, 2]]),
        lambda: rm.interoperability.to_trimesh([[0, 1, 2]]),
        lambda: rm.interoperability.to_networkx([[0, 1, 2]]),
    ],
)
def test_what_is_no_complex(call):
    with pytest.raises(
        TypeError, match="complex must be a SimplicialComplex, got list"
    ):
        call()


def test_format_that_is_no_word(tmp_path):
    with pytest.raises(TypeError, match="format must be a word such as 'csv', got 3"):
        read_points(tmp_path / "a.csv", format=3)


# -------------------------------------------------------------------- fields


@pytest.mark.parametrize("suffix", [".npz", ".ply", ".vtk", ".vtu"])
@pytest.mark.parametrize("dim", [1, 2, None])
def test_fields_come_back(tmp_path, suffix, dim):
    path = tmp_path / f"mesh{suffix}"
    if dim is None:
        write_points(path, POINTS, fields=FIELDS)
    else:
        write_mesh(path, POINTS, SIMPLICES[dim], fields=FIELDS)
        np.testing.assert_array_equal(read_complex(path).simplices, SIMPLICES[dim])
    assert read_points(path).tobytes() == POINTS.tobytes()
    found = read_fields(path)
    assert {*found} == {*FIELDS}
    for name, array in FIELDS.items():
        kind = array.dtype
        if kind == bool and suffix != ".npz":
            kind = np.dtype(np.uint8)
        if name == "number" and suffix == ".ply":
            kind = np.dtype(np.int32)
        assert found[name].dtype == kind, name
        np.testing.assert_array_equal(found[name], array, err_msg=name)


def test_fields_of_ply_have_the_names_others_use(tmp_path):
    colors = RNG.integers(0, 256, (6, 4)).astype(np.uint8)
    fields = {"normals": FIELDS["normals"], "colors": colors, "pairs": FIELDS["pairs"]}
    write_mesh(tmp_path / "a.ply", POINTS, SIMPLICES[2], fields=fields)
    header = (tmp_path / "a.ply").read_bytes().partition(b"end_header")[0].decode()
    names = ["nx", "ny", "nz", "red", "green", "blue", "alpha", "pairs_0", "pairs_1"]
    assert [row.split()[2] for row in header.splitlines()[6:-2]] == names
    mesh = trimesh.load(tmp_path / "a.ply", process=False)
    np.testing.assert_array_equal(mesh.visual.vertex_colors, colors)
    np.testing.assert_allclose(mesh.vertex_normals, FIELDS["normals"], rtol=1e-6)
    found = read_fields(tmp_path / "a.ply")
    np.testing.assert_array_equal(found["colors"], colors)


def test_large_integers_in_ply(tmp_path):
    numbers = np.array([2**40, 0, 1, 2, 3, -1])
    write_mesh(tmp_path / "a.ply", POINTS, SIMPLICES[2], fields={"number": numbers})
    np.testing.assert_array_equal(read_fields(tmp_path / "a.ply")["number"], numbers)


@pytest.mark.parametrize("suffix", [".npz", ".vtk", ".vtu"])
def test_names_with_blanks_and_letters_of_all_kinds(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    fields = {'Abstand "d" <1>&%': np.arange(6.0), "größe": np.arange(6)}
    write_mesh(path, POINTS, SIMPLICES[2], fields=fields)
    found = read_fields(path)
    assert {*found} == {*fields}
    np.testing.assert_array_equal(found["größe"], fields["größe"])


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        (
            {"a": np.zeros(5)},
            r"fields\['a'\] has shape \(5,\), expected \(6,\) or \(6, C",
        ),
        ({"a": np.zeros((6, 0))}, r"has shape \(6, 0\)"),
        ({"a": 1.0}, r"has shape \(\)"),
        ({"a": ["x"] * 6}, "holds <U1, expected numbers or bool"),
        ({"a": np.zeros(6) * 1j}, "holds complex128"),
        ({"": np.zeros(6)}, "'' is no name"),
        ({"a\nb": np.zeros(6)}, "is no name"),
        ({1: np.zeros(6)}, "1 is no name"),
    ],
)
def test_fields_that_do_not_fit(tmp_path, fields, message):
    with pytest.raises(ValueError, match=message):
        write_mesh(tmp_path / "a.ply", POINTS, SIMPLICES[2], fields=fields)
    assert list(tmp_path.iterdir()) == []


def test_fields_that_a_format_cannot_hold(tmp_path):
    for suffix in (".obj", ".off", ".stl"):
        with pytest.raises(
            ValueError, match=r"'a'; use \.ply, \.vtk, \.vtu, \.vtp, \.glb, \.gltf, \.n"
        ):
            write_mesh(
                tmp_path / f"a{suffix}", POINTS, SIMPLICES[2], fields={"a": np.ones(6)}
            )
    with pytest.raises(ValueError, match="called 'x'"):
        write_mesh(tmp_path / "a.ply", POINTS, SIMPLICES[2], fields={"x": np.ones(6)})
    twice = {"a b": np.ones(6), "a_b": np.ones(6)}
    with pytest.raises(ValueError, match="called 'a_b'"):
        write_mesh(tmp_path / "a.ply", POINTS, SIMPLICES[2], fields=twice)
    with pytest.raises(ValueError, match="'points' is an array that each"):
        write_points(tmp_path / "a.npz", POINTS, fields={"points": np.ones(6)})
    with pytest.raises(TypeError, match="fields must map names to arrays, got list"):
        write_mesh(tmp_path / "a.ply", POINTS, SIMPLICES[2], fields=[np.ones(6)])
    assert list(tmp_path.iterdir()) == []


# ------------------------------------------------- files with more than simplices

SQUARE = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]
# An arrow whose notch is corner 3: from corners 1 and 3 alone are all others seen.
ARROW = [[-2, -2, 0], [3, 0, 0], [-2, 2, 0], [-1, 0, 0]]


def obj(points, *lines):
    return "\n".join([*(f"v {x} {y} {z}" for x, y, z in points), *lines, ""])


def test_polygons_are_triangulated(tmp_path):
    pentagon = [*SQUARE[:3], [1, 3, 0], SQUARE[3]]
    path = put(tmp_path / "a.obj", obj(pentagon, "f 1 2 3", "f 1 2 3 4 5", "f 1 3 5"))
    with pytest.warns(rm.FileWarning, match="a.obj: 1 triangles left out, 0 .* 1 rep"):
        found = read_complex(path)
    assert found.simplices.tolist() == [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 2, 4]]


@pytest.mark.parametrize("start", range(4))
def test_polygons_that_are_not_convex(tmp_path, start):
    order = [(start + i) % 4 + 1 for i in range(4)]
    text = obj(ARROW, "f " + " ".join(map(str, order)))
    found = read_complex(put(tmp_path / "a.obj", text))
    corners = found.vertices[found.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = normals[:, 2] / 2
    assert (areas > 0).all()
    assert areas.sum() == pytest.approx(8.0)


COMB = [[0, 0], [6, 0], [6, 3], [5, 1], [4, 3], [3, 1], [2, 3], [1, 1], [0, 3]]


@pytest.mark.parametrize("step", [1, -1])
@pytest.mark.parametrize("axes", [(0, 1, 2), (1, 2, 0), (2, 0, 1)])
def test_polygon_that_no_corner_sees(tmp_path, step, axes):
    """Of either orientation, in any plane of coordinates, from any corner."""
    for first in range(9):
        order = [(first + step * i) % 9 for i in range(9)]
        points = np.array([[x, y, 0] for x, y in COMB])[:, axes]
        face = " ".join(str(i + 1) for i in order)
        found = read_complex(put(tmp_path / "a.obj", obj(points, f"f {face}")))
        assert len(found.simplices) == 7
        corners = found.vertices[found.simplices]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        out = normals[:, np.argmin(np.ptp(points, axis=0))]
        turned = np.linalg.det(np.eye(3)[list(axes)])
        assert (out * step * turned > 0).all()
        assert np.abs(out).sum() / 2 == pytest.approx(12.0)


def test_polygon_that_crosses_itself(tmp_path):
    bow = [[0, 0, 0], [4, 3, 0], [4, 0, 0], [0, 3, 0], [2, 5, 0]]
    with pytest.raises(ValueError, match="face 0 has 5 corners and crosses itself"):
        read_complex(put(tmp_path / "a.obj", obj(bow, "f 1 2 3 4 5")))


def test_polygons_in_many_coordinates_are_refused(tmp_path):
    text = "nOFF\n4 4 1 0\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n4 0 1 2 3\n"
    with pytest.raises(ValueError, match=r"has 4 corners; in R\^4 only triangles"):
        read_complex(put(tmp_path / "a.off", text))


def test_degenerate_and_repeated_simplices_are_left_out_with_a_warning(tmp_path):
    text = obj(SQUARE, "f 1 2 3", "f 3 1 2", "f 1 1 2", "f 1 3 4")
    with pytest.warns(rm.FileWarning, match="2 triangles left out, 1 with a .* 1 repe"):
        found = read_complex(put(tmp_path / "a.obj", text))
    assert found.simplices.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_simplices_of_several_dimensions(tmp_path):
    faces = ("f 1 2 3", "f 1 3 4")
    path = put(tmp_path / "a.obj", obj(SQUARE, *faces, "l 1 2 3 4 1"))
    assert read_complex(path).dim == 2  # all edges are sides of the triangles
    found = read_complex(path, dim=1)
    assert found.simplices.tolist() == [[0, 1], [1, 2], [2, 3], [3, 0]]
    path = put(tmp_path / "b.obj", obj(SQUARE, *faces, "l 1 2", "l 2 4"))
    with pytest.raises(ValueError, match="1 edges that are in none of its 2 triangles"):
        read_complex(path)
    assert len(read_complex(path, dim=1).simplices) == 2
    assert len(read_complex(path, dim=2).simplices) == 2
    with pytest.raises(
        ValueError, match="holds no tetrahedra, but 2 triangles and 2 e"
    ):
        read_complex(path, dim=3)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.obj", "v 0 0 0\n", "holds points and no simplices; read_points"),
        ("a.obj", "v 0 0 0\nf 1 2 3\n", "face with vertex 2, which is none of the 1 "),
        ("a.obj", "v 0 0 0\nf 1 0 3\n", "line 2: has vertex 0; vertices count from 1"),
        ("a.obj", "v 0 0 0\nf 1 -2 1\n", "line 2: has vertex -2 of 1 so far"),
        ("a.obj", "v 0 0 0\nf 1 x 1\n", "line 2: expected indices, found '1 x 1'"),
        ("a.obj", "v 0 0 0\nf 1 1\n", "line 2: expected 3 vertices or more, found 2"),
        ("a.off", "OFF\n1 1 0\n0 0 0\n3 0 1\n", "line 4: expected 3 vertices, found 2"),
        ("a.off", "OFF\n1 2 0\n0 0 0\n", "truncated: expected 2 faces, found 0"),
        ("a.off", "OFF\n1 x 0\n0 0 0\n", "expected the number of faces"),
        ("a.off", "nOFF\n0 1 0 0\n", "points without coordinates"),
        (
            "a.vtk",
            (
                "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                "POINTS 1 float\n1 2 3\nCELLS 1 9\n8 0 0 0 0 0 0 0 0\nCELL_TYPES 1\n12\n"
            ),
            r"holds hexahedra \(VTK's type 12\); only edges, polygons and tetrahedra",
        ),
        (
            "a.vtk",
            (
                "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n"
                "POINTS 1 float\n1 2 3\nTRIANGLE_STRIPS 1 4\n3 0 0 7\n"
            ),
            "has a face with vertex 7",
        ),
        (
            "a.vtk",
            "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\n",
            "line 4: expected DATASET POLYDATA or UNSTRUCTURED_GRID",
        ),
        (
            "a.vtk",
            (
                "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n"
                "POINTS 1 float\n1 2 3\nPOLYGONS 1 4\n5 0 0 0\n"
            ),
            "the sizes of POLYGONS do not fit",
        ),
    ],
)
def test_simplices_that_cannot_be_read(tmp_path, name, content, message):
    path = put(tmp_path / name, content)
    with pytest.raises(ValueError, match=message) as caught:
        read_complex(path)
    assert str(path) in str(caught.value)


def test_archive_with_wrong_simplices(tmp_path):
    for simplices, message in (
        ([[0, 1, 6]], "hold indices from 0 to 5, found 0 to 6"),
        (
            [[0.5, 1, 2]],
            r"hold integers of shape \(M, K \+ 1\), found float64 \(1, 3\)",
        ),
    ):
        np.savez(tmp_path / "a.npz", points=POINTS, simplices=simplices)
        with pytest.raises(ValueError, match=message):
            read_complex(tmp_path / "a.npz")
    np.savez(tmp_path / "a.npz", points=POINTS * np.nan, simplices=SIMPLICES[1])
    with pytest.raises(ValueError, match=r"a\.npz: points?\S* is nan|vertices\[0, 0\]"):
        read_complex(tmp_path / "a.npz")


def test_faces_of_many_sizes_in_ply(tmp_path):
    header = (
        "ply\nformat {}\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nelement face 2\nproperty uchar flag\n"
        "property list uchar uint vertex_index\nelement edge 1\n"
        "property int vertex1\nproperty int vertex2\nend_header\n"
    )
    text = header.format("ascii 1.0") + "0 0 0\n2 0 0\n2 2 0\n0 2 0\n"
    text += "1 3 0 1 2\n2 4 0 1 2 3\n0 1\n"
    corners = struct.pack(">12f", *np.ravel(SQUARE))
    faces = struct.pack(">BB3I", 1, 3, 0, 1, 2) + struct.pack(">BB4I", 2, 4, 0, 1, 2, 3)
    binary = header.format("binary_big_endian 1.0").encode() + corners + faces
    binary += struct.pack(">2i", 0, 1)
    for name, content in (("a.ply", text), ("b.ply", binary)):
        with pytest.warns(rm.FileWarning, match="1 repeated"):
            found = read_complex(put(tmp_path / name, content))
        assert found.simplices.tolist() == [[0, 1, 2], [0, 2, 3]]
        assert read_complex(tmp_path / name, dim=1).simplices.tolist() == [[0, 1]]


def test_polydata_of_version_5_with_cell_data(tmp_path):
    """As VTK 9 writes surfaces: offsets, and data of the cells before the points'."""
    text = (
        "# vtk DataFile Version 5.1\nvtk output\nASCII\nDATASET POLYDATA\n"
        "POINTS 4 float\n0 0 0 2 0 0 2 2 0 \n0 2 0 \n\nMETADATA\nINFORMATION 0\n\n"
        "POLYGONS 3 6\nOFFSETS vtktypeint64\n0 3 6 \nCONNECTIVITY vtktypeint64\n"
        "0 1 2 0 2 3 \n\nCELL_DATA 2\nFIELD FieldData 1\nids 1 2 vtktypeint64\n5 6 \n"
        "METADATA\nINFORMATION 0\n\nPOINT_DATA 4\nSCALARS height float\n"
        "LOOKUP_TABLE default\n1 2 3 4 \nNORMALS n float\n0 0 1 0 0 1 0 0 1 0 0 1 \n"
    )
    path = put(tmp_path / "a.vtk", text)
    assert read_complex(path).simplices.tolist() == [[0, 1, 2], [0, 2, 3]]
    fields = read_fields(path)
    assert {*fields} == {"height", "n"}
    assert fields["height"].tolist() == [1, 2, 3, 4]
    assert fields["n"].shape == (4, 3)


def test_text_stl_is_read_in_parts_and_line_by_line_alike(tmp_path, monkeypatch):
    points = RNG.normal(size=(60, 3))
    triangles = np.sort(RNG.permuted(np.tile(np.arange(60), (40, 1)), axis=1)[:, :3])
    write_mesh(tmp_path / "a.stl", points, triangles)
    source = _source.Source(tmp_path / "a.stl", ".stl")
    expected = points[triangles].reshape(-1, 3)
    np.testing.assert_array_equal(_stl._regular(source), expected)
    for size in (300, 1000, 5000):
        monkeypatch.setattr(_stl, "_PART", size)
        np.testing.assert_array_equal(_stl._regular(source), expected)
    text = source.data.replace(b"endfacet\n", b"endfacet\nattribute 1\n", 1)
    unusual = _source.Source(put(tmp_path / "b.stl", text), ".stl")
    assert _stl._regular(unusual) is None
    np.testing.assert_array_equal(_stl._ascii(unusual), expected)


def test_first_of_equal_rows():
    rows = RNG.integers(0, 3, (200, 3))
    first, places = _mesh.first_of_equal_rows(rows)
    np.testing.assert_array_equal(rows[first][places], rows)
    assert (np.diff(first) > 0).all()
    assert len(first) == len({tuple(row) for row in rows.tolist()})
    assert all((rows[:i] != rows[i]).any(axis=1).all() for i in first.tolist())


# ------------------------------------------------------------------ points alone


@pytest.mark.parametrize("suffix", [".npy", ".npz", ".csv", ".txt", ".xyz", ".off"])
@pytest.mark.parametrize("ambient", [1, 2, 3, 6])
def test_points_of_any_dimension(tmp_path, suffix, ambient):
    points = RNG.normal(size=(7, ambient))
    path = tmp_path / f"a{suffix}"
    write_points(path, points)
    assert read_points(path).tobytes() == points.tobytes()


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".vtk", ".vtu"])
def test_points_of_three_dimensions(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    write_points(path, POINTS)
    assert read_points(path).tobytes() == POINTS.tobytes()
    with pytest.raises(
        ValueError, match=r"4 coordinates; use \.off, \.npz, \.npy, \.csv, "
    ):
        write_points(path, np.zeros((3, 4)))
    with pytest.raises(ValueError, match=r"holds points and no simplices"):
        read_complex(path)


def test_points_that_cannot_be_written(tmp_path):
    with pytest.raises(ValueError, match=r"cannot write points to \.stl; use one of"):
        write_points(tmp_path / "a.stl", POINTS)
    with pytest.raises(ValueError, match=r"cannot write points to \.laz; use one of"):
        write_points(tmp_path / "a.laz", POINTS)
    with pytest.raises(
        ValueError, match=r"npy cannot hold the fields 'a'; use \.ply, "
    ):
        write_points(tmp_path / "a.npy", POINTS, fields={"a": np.ones(6)})
    with pytest.raises(ValueError, match="points must be real numbers of shape"):
        write_points(tmp_path / "a.csv", POINTS[0])
    with pytest.raises(FileNotFoundError, match="does not exist"):
        write_points(tmp_path / "no" / "a.csv", POINTS)
    assert list(tmp_path.iterdir()) == []


# ---------------------------------------------------------------------------- LAS


OFFSETS = np.array([4e5, 5e6, 0])


def las_file(path, points):
    header = laspy.LasHeader(point_format=0, version="1.2")
    header.scales, header.offsets = [0.001] * 3, OFFSETS
    cloud = laspy.LasData(header)
    cloud.x, cloud.y, cloud.z = points.T
    cloud.intensity = np.arange(len(points), dtype=np.uint16)
    cloud.write(path)
    return path


@pytest.mark.parametrize("suffix", [".las", ".laz"])
def test_las(tmp_path, suffix):
    points = np.round(RNG.uniform(size=(50, 3)) * 100, 3) + OFFSETS
    path = las_file(tmp_path / f"a{suffix}", points)
    found = read_points(path)
    assert found.dtype == np.float64
    np.testing.assert_allclose(found, points, rtol=0, atol=1e-9)
    assert read_fields(path)["intensity"].tolist() == list(range(50))
    with pytest.raises(ValueError, match=r"cannot read simplices from \.la"):
        read_complex(path)


@pytest.mark.parametrize(
    ("suffix", "place", "value", "message"),
    [
        (".las", 100, 2**32 - 1, "its header does not fit the file"),  # records
        (".las", 96, 2**31, "its header does not fit the file"),  # start of the points
        (".las", 107, 2**31, "expected 2,147,483,648 points, found 3"),
        (".laz", None, 2**31, "it has no room for 2,147,483,648 chunks"),
    ],
)
def test_damaged_las_headers_ask_for_no_memory(tmp_path, suffix, place, value, message):
    """laspy and lazrs would make room for what the header promises, or loop."""
    path = las_file(tmp_path / f"a{suffix}", OFFSETS + np.eye(3))
    data = bytearray(path.read_bytes())
    if place is None:
        (start,) = struct.unpack_from("<I", data, 96)
        place = struct.unpack_from("<q", data, start)[0] + 4
    struct.pack_into("<I", data, place, value)
    with pytest.raises(ValueError, match=message):
        read_points(put(path, bytes(data)))


def test_las_without_laspy(tmp_path, monkeypatch):
    path = las_file(tmp_path / "a.las", OFFSETS + np.eye(3))
    monkeypatch.setitem(sys.modules, "laspy", None)
    with pytest.raises(ImportError, match=r"pip install remanifold\[las\]"):
        read_points(path)


# --------------------------------------------------------------------------- glTF


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_gltf_is_read_by_trimesh(tmp_path, suffix):
    rec = rm.reconstruct(rm.datasets.torus(400, random_state=0), 2)
    path = tmp_path / f"torus{suffix}"
    rec.write(path)
    (mesh,) = trimesh.load(path, process=False).geometry.values()
    np.testing.assert_array_equal(mesh.faces, rec.simplices)
    np.testing.assert_array_equal(mesh.vertices, rec.vertices.astype(np.float32))
    assert mesh.is_watertight
    assert mesh.volume > 0
    boundary = np.ravel(mesh.vertex_attributes["_BOUNDARY"])
    np.testing.assert_array_equal(boundary, rec.boundary)


def test_gltf_of_edges_colors_and_normals(tmp_path):
    points = RNG.normal(size=(6, 3))
    colors = RNG.integers(0, 256, (6, 3)).astype(np.uint8)
    normals = points / np.linalg.norm(points, axis=1, keepdims=True)
    fields = {"colors": colors, "normals": normals}
    write_mesh(tmp_path / "a.glb", points, SIMPLICES[2], fields=fields)
    (mesh,) = trimesh.load(tmp_path / "a.glb", process=False).geometry.values()
    np.testing.assert_array_equal(mesh.visual.vertex_colors[:, :3], colors)
    np.testing.assert_allclose(mesh.vertex_normals, normals, atol=1e-6)
    write_mesh(tmp_path / "a.gltf", points, SIMPLICES[1])
    scene = json.loads((tmp_path / "a.gltf").read_text())
    (primitive,) = scene["meshes"][0]["primitives"]
    assert primitive["mode"] == 1
    assert scene["accessors"][primitive["indices"]]["count"] == 8


def test_gltf_refuses_what_it_cannot_hold(tmp_path):
    for points, fields, message in (
        (POINTS * 1e200, {}, "too large for glTF"),
        (POINTS, {"a": np.ones((6, 5))}, "'a' has 5 columns; glTF holds at most 4"),
    ):
        with pytest.raises(ValueError, match=message):
            write_mesh(tmp_path / "a.glb", points, SIMPLICES[2], fields=fields)
    assert list(tmp_path.iterdir()) == []


# ------------------------------------------------------------------------ streams


class Stream:
    """Standard input or output of bytes."""

    def __init__(self, data=b""):
        self.buffer = io.BytesIO(data)

    def flush(self):
        pass


@pytest.mark.parametrize(
    "format", ["npy", "npz", "csv", "xyz", "ply", "obj", "off", "stl", "vtk", "vtu"]
)
def test_standard_input_and_output(tmp_path, monkeypatch, format):
    out = Stream()
    monkeypatch.setattr(sys, "stdout", out)
    points = POINTS[[*SIMPLICES[2].ravel()]][:6]
    if format in ("npy", "csv", "xyz"):
        write_points("-", points, format=format)
    else:
        write_mesh("-", POINTS, SIMPLICES[2], format=format)
        write_mesh(tmp_path / f"a.{format}", POINTS, SIMPLICES[2])
        assert out.buffer.getvalue() == (tmp_path / f"a.{format}").read_bytes()
    monkeypatch.setattr(sys, "stdin", Stream(out.buffer.getvalue()))
    assert read_points("-", format=format).shape == (6, 3)
    monkeypatch.setattr(sys, "stdin", Stream(b"nonsense"))
    with pytest.raises(ValueError, match=r"^standard input(, line 1)?: "):
        read_points("-", format=format)


def test_streams_need_a_format():
    with pytest.raises(ValueError, match="standard input and output have no suffix"):
        read_points("-")
    with pytest.raises(
        ValueError, match="format is 'docx', expected one of npy, npz, c"
    ):
        read_points("-", format="docx")
    with pytest.raises(
        ValueError, match="format is 'csv', expected one of ply, obj, o"
    ):
        write_mesh("-", POINTS, SIMPLICES[2], format="csv")


# ------------------------------------------------------------------- damaged files


def examples(folder):
    """A file of each kind, with fields where there are some."""
    rec = rm.reconstruct(rm.datasets.circle(30, random_state=0) @ np.eye(2, 3), 1)
    for suffix, dims in HOLDS.items():
        for dim in dims:
            path = folder / f"{dim}{suffix}"
            fields = FIELDS if suffix in (".npz", ".ply", ".vtk", ".vtu") else None
            write_mesh(path, POINTS, SIMPLICES[dim], fields=fields)
            yield path
    rec.write(folder / "rec.ply")
    yield folder / "rec.ply"
    for suffix in (".npy", ".csv", ".xyz"):
        write_points(folder / f"points{suffix}", POINTS)
        yield folder / f"points{suffix}"
    for suffix in (".las", ".laz"):
        yield las_file(folder / f"points{suffix}", OFFSETS + np.eye(3))
    ascii = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
    ascii += "property float y\nproperty float z\nelement face 1\n"
    ascii += "property list uchar int vertex_indices\nend_header\n"
    ascii += "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"
    yield put(folder / "ascii.ply", ascii)


def read_all(path):
    """Whatever is in a file, or ValueErrors that name it; True if there were some."""
    complained = False
    for read in (read_points, read_fields, read_complex):
        try:
            read(path)
        except ValueError as error:
            assert str(path) in str(error), str(error)  # noqa: PT017
            complained = True
    return complained


def test_files_cut_short_give_value_errors_only(tmp_path, capfd):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.FileWarning)
        for path in examples(tmp_path):
            data = path.read_bytes()
            cut = tmp_path / f"cut{path.suffix}"
            step = max(10, len(data) // 150)
            errors = sum(
                read_all(put(cut, data[:size])) for size in range(0, len(data), step)
            )
            assert errors > 0, path.name
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
def test_damaged_bytes_give_value_errors_only(tmp_path):
    rng = np.random.default_rng(1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rm.FileWarning)
        for path in examples(tmp_path):
            data = path.read_bytes()
            bad = tmp_path / f"bad{path.suffix}"
            for _ in range(60):
                spoiled = bytearray(data)
                for place in rng.integers(0, len(data), rng.integers(1, 4)):
                    spoiled[place] = rng.integers(0, 256)
                read_all(put(bad, bytes(spoiled)))


@pytest.mark.parametrize("suffix", [*HOLDS, ".npy", ".csv", ".xyz", ".las", ".laz"])
@pytest.mark.parametrize(
    "content", [b"", b"\n", bytes(range(256)), b"\0" * 500, b"\x89PNG\r\n\x1a\n\0\0"]
)
def test_nonsense_is_refused(tmp_path, suffix, content):
    assert read_all(put(tmp_path / f"a{suffix}", content))


@pytest.mark.parametrize("suffix", [*HOLDS, ".npy", ".csv", ".las"])
def test_content_of_another_format_is_refused(tmp_path, suffix):
    for path in [*examples(tmp_path)]:
        related = {path.suffix, suffix}
        # Tables are read whatever separates their cells.
        same = ({".npz", ".npy"}, {".las", ".laz"}, {".csv", ".xyz"})
        if related in same or len(related) == 1:
            continue
        assert read_all(put(tmp_path / f"other{suffix}", path.read_bytes())), path.name
