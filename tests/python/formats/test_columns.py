# SPDX-License-Identifier: GPL-3.0-or-later
"""Which columns are coordinates: by name, by what they hold, as asked for."""

from __future__ import annotations

import bz2
import gzip
import lzma

import numpy as np
import pytest

import remanifold as rm
from remanifold.io import read, read_fields, read_points, write_points

RNG = np.random.default_rng(0)
XYZ = np.round(RNG.normal(size=(40, 3)), 4)
COLORS = RNG.integers(0, 256, (40, 3))
NORMALS = XYZ / np.linalg.norm(XYZ, axis=1, keepdims=True)
COUNT = np.arange(40)[:, None]


def put(path, content):
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def table(path, names, *columns, separator=",", comment=""):
    rows = np.column_stack(columns)
    lines = [separator.join(f"{v:.10g}" for v in row) for row in rows]
    head = [comment + separator.join(names)] if names else []
    return put(path, "\n".join([*head, *lines, ""]))


# ------------------------------------------------------------------------ by name


@pytest.mark.parametrize(
    "names",
    [
        ["id", "x", "y", "z"],
        ["index", "X", "Y", "Z"],
        ["", "x", "y", "z"],
        ["time", "x [m]", "y [m]", "z [m]"],
        ["intensity", "pos_x", "pos_y", "pos_z"],
        ["label", "x_coord", "y_coord", "z_coord"],
        ["v", "Points:0", "Points:1", "Points:2"],
        ["q", "x1", "x2", "x3"],
        ["q", "x_0", "x_1", "x_2"],
        ["id", "easting", "northing", "height"],
        ["id", "PC1", "PC2", "PC3"],
        ["Unnamed: 0", "dim 1", "dim 2", "dim 3"],
    ],
)
def test_coordinates_by_their_names(tmp_path, names):
    path = table(tmp_path / "a.csv", names, COUNT, XYZ)
    points, attributes = read(path)
    np.testing.assert_array_equal(points, XYZ)
    assert len(attributes) == 1
    np.testing.assert_array_equal(next(iter(attributes.values())), COUNT.ravel())


def test_names_in_any_order_with_fields_between(tmp_path):
    path = table(
        tmp_path / "a.csv",
        ["red", "z", "nx", "green", "y", "blue", "ny", "nz", "class", "x"],
        *(COLORS[:, 0], XYZ[:, 2], NORMALS[:, 0], COLORS[:, 1], XYZ[:, 1]),
        *(COLORS[:, 2], NORMALS[:, 1], NORMALS[:, 2], COUNT % 3, XYZ[:, 0]),
    )
    points, attributes = read(path)
    np.testing.assert_array_equal(points, XYZ)
    assert {*attributes} == {"colors", "normals", "class"}
    assert attributes["colors"].dtype == np.uint8
    np.testing.assert_array_equal(attributes["colors"], COLORS)
    np.testing.assert_allclose(attributes["normals"], NORMALS, atol=1e-9)


def test_a_name_less_than_columns_as_r_writes_tables(tmp_path):
    path = table(tmp_path / "a.txt", ["x", "y", "z"], COUNT, XYZ, separator=" ")
    points, attributes = read(path)
    np.testing.assert_array_equal(points, XYZ)
    assert [*attributes] == ["index"]


@pytest.mark.parametrize("comment", ["# ", "//", "% "])
def test_names_in_a_comment(tmp_path, comment):
    names = ["x", "y", "z", "intensity"]
    path = table(tmp_path / "a.txt", names, XYZ, COUNT, separator=" ", comment=comment)
    points, attributes = read(path)
    np.testing.assert_array_equal(points, XYZ)
    assert [*attributes] == ["intensity"]


def test_longitude_and_latitude_are_no_lengths(tmp_path):
    degrees = np.column_stack([RNG.uniform(13, 14, 40), RNG.uniform(52, 53, 40)])
    path = table(tmp_path / "a.csv", ["lat", "lon", "alt"], degrees[:, ::-1], COUNT)
    with pytest.warns(rm.FileWarning, match="angles, not lengths.*project them"):
        points = read_points(path)
    np.testing.assert_allclose(points[:, :2], degrees, atol=1e-7)
    assert points.shape == (40, 3)


def test_names_that_say_nothing_of_coordinates(tmp_path):
    path = table(tmp_path / "a.csv", ["id", "length", "width", "mass"], COUNT, XYZ)
    with pytest.warns(rm.FileWarning, match="no columns are called x, y, z: .* length"):
        points = read_points(path)
    np.testing.assert_array_equal(points, XYZ)


def test_names_that_programs_make_up_are_none(tmp_path):
    path = table(tmp_path / "a.csv", ["V1", "V2", "V3", "V4"], COUNT, XYZ)
    with pytest.warns(rm.FileWarning, match="column 0 counts the rows"):
        np.testing.assert_array_equal(read_points(path), XYZ)


def test_words_become_numbers(tmp_path):
    lines = [
        "kind,x,y",
        *(f"{'tree' if i % 2 else 'car'},{i}.5,{i * i}.25" for i in range(9)),
    ]
    points, attributes = read(put(tmp_path / "a.csv", "\n".join(lines)))
    assert points.shape == (9, 2)
    assert attributes["kind"].tolist() == [0, 1] * 4 + [0]
    assert attributes["kind"].dtype == np.int32


def test_cells_that_are_empty_are_nan(tmp_path):
    path = put(tmp_path / "a.csv", "x,y,z\n1,2,3\n4,,6\nNA,null,9\n")
    points = read_points(path)
    np.testing.assert_array_equal(
        points, [[1, 2, 3], [4, np.nan, 6], [np.nan] * 2 + [9]]
    )


# ---------------------------------------------------------------------- by content


@pytest.mark.parametrize("suffix", [".txt", ".npy", ".csv"])
def test_colors_normals_and_counts_are_found_in_what_has_no_names(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"

    def write(*columns):
        if suffix == ".npy":
            np.save(path, np.column_stack(columns))
        else:
            table(path, [], *columns, separator="," if suffix == ".csv" else " ")

    write(XYZ, COLORS)
    with pytest.warns(rm.FileWarning, match="columns 3 to 5 hold colors; columns= dec"):
        points, attributes = read(path)
    np.testing.assert_array_equal(points, XYZ)
    np.testing.assert_array_equal(attributes["colors"], COLORS)
    write(XYZ, NORMALS, COLORS)
    with pytest.warns(rm.FileWarning, match="columns 3 to 5 hold normals"):
        points, attributes = read(path)
    assert {*attributes} == {"normals", "colors"}
    np.testing.assert_allclose(attributes["normals"], NORMALS, atol=1e-9)
    write(COUNT + 1, XYZ)
    with pytest.warns(rm.FileWarning, match="column 0 counts the rows"):
        points, attributes = read(path)
    np.testing.assert_array_equal(points, XYZ)
    assert [*attributes] == ["index"]
    write(XYZ, COUNT % 4)
    with pytest.warns(rm.FileWarning, match="column 3 holds a few whole numbers"):
        np.testing.assert_array_equal(read_points(path), XYZ)


@pytest.mark.parametrize("suffix", [".txt", ".npy", ".csv"])
def test_what_shows_no_sign_stays_a_coordinate(tmp_path, suffix):
    """Seven measured numbers, a plane of zeros, whole numbers in all columns."""
    path = tmp_path / f"a{suffix}"
    for points in (
        RNG.normal(size=(40, 7)),
        np.column_stack([XYZ, np.zeros(40)]),
        RNG.integers(0, 255, (40, 6)),
        np.arange(9 * 3).reshape(9, 3),
        np.column_stack([np.arange(40), XYZ[:, 0]]),  # a graph of a function
    ):
        if suffix == ".npy":
            np.save(path, points)
        else:
            table(path, [], points, separator="," if suffix == ".csv" else " ")
        assert read_points(path).shape == points.shape


@pytest.mark.parametrize("suffix", [".xyz", ".asc", ".pts"])
def test_formats_of_space_have_three_coordinates(tmp_path, suffix):
    path = table(tmp_path / f"a{suffix}", [], XYZ, XYZ[:, :1], COLORS, separator=" ")
    with pytest.warns(rm.FileWarning, match="others are intensity, red, green, blue"):
        points, attributes = read(path)
    np.testing.assert_array_equal(points, XYZ)
    assert {*attributes} == {"intensity", "colors"}


def test_a_first_column_that_only_increases_is_named(tmp_path):
    times = np.sort(RNG.uniform(0, 10, 40))
    path = table(tmp_path / "a.txt", [], times, XYZ, separator=" ")
    with pytest.warns(rm.FileWarning, match="only ever increases, as time does"):
        assert read_points(path).shape == (40, 4)


# -------------------------------------------------------------------- as asked for


@pytest.mark.parametrize(
    ("columns", "expected"),
    [
        ("x,y", [0, 1]),
        ("2,0", [2, 0]),
        (["z", 0], [2, 0]),
        ([-1], [3]),
        (np.array([1, 3]), [1, 3]),
        ("X, Z", [0, 2]),
    ],
)
@pytest.mark.parametrize(
    "suffix", [".csv", ".txt", ".ply", ".npz", ".vtk", ".vtu", ".vtp", ".parquet"]
)
def test_columns_that_were_asked_for(tmp_path, suffix, columns, expected):
    if suffix == ".parquet":
        pytest.importorskip("pyarrow")
    path = tmp_path / f"a{suffix}"
    write_points(path, XYZ, fields={"heat": COUNT.ravel() / 7})
    whole = np.column_stack([XYZ, COUNT / 7])
    np.testing.assert_array_equal(
        read_points(path, columns=columns), whole[:, expected]
    )
    # What is no coordinate is a field.
    left = {*range(4)} - {*expected}
    fields = read_fields(path, columns=columns)
    assert {*fields} == {("x", "y", "z", "heat")[i] for i in left}


def test_a_field_of_several_columns(tmp_path):
    write_points(
        tmp_path / "a.ply", XYZ, fields={"normals": NORMALS, "code": XYZ[:, :2]}
    )
    np.testing.assert_array_equal(
        read_points(tmp_path / "a.ply", columns="normals"), NORMALS
    )
    points, attributes = read(tmp_path / "a.ply", columns=["code", "z"])
    np.testing.assert_array_equal(points, XYZ)
    assert {*attributes} == {"x", "y", "normals"}


def test_ply_without_x_is_read_if_columns_say_what_is(tmp_path):
    head = (
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float u\nproperty float v\n"
    )
    path = put(tmp_path / "a.ply", head + "end_header\n1 2\n3 4\n")
    with pytest.raises(ValueError, match="expected vertex properties x, y, z, found u"):
        read_points(path)
    assert read_points(path, columns="u,v").tolist() == [[1, 2], [3, 4]]


@pytest.mark.parametrize(
    ("columns", "error", "message"),
    [
        ("x,w", ValueError, "columns: there is no 'w'; there are x, y, z"),
        ("0,3", ValueError, "columns: there is no column 3, only 0 to 2"),
        ("x,x", ValueError, "columns has 'x' twice"),
        (["x", 0], ValueError, "columns: 0 is there twice"),
        ("", ValueError, "columns is"),
        ([], ValueError, "columns is"),
        (1.5, TypeError, "columns must be names or numbers from 0"),
        ([True], TypeError, "columns must be names or numbers from 0"),
    ],
)
def test_columns_that_there_are_not(tmp_path, columns, error, message):
    path = table(tmp_path / "a.csv", ["x", "y", "z"], XYZ)
    with pytest.raises(error, match=message):
        read_points(path, columns=columns)


def test_columns_without_names_have_numbers(tmp_path):
    path = table(tmp_path / "a.csv", [], XYZ)
    with pytest.raises(
        ValueError, match="the columns have no names; say numbers, 0 to 2"
    ):
        read_points(path, columns="x,y,z")
    np.testing.assert_array_equal(read_points(path, columns="2,1"), XYZ[:, [2, 1]])


def test_words_are_no_coordinates(tmp_path):
    path = put(tmp_path / "a.csv", "x,y,kind\n1,2,a\n3,4,b\n")
    with pytest.raises(ValueError, match="columns: kind holds text, expected numbers"):
        read_points(path, columns="x,kind")


# ---------------------------------------------------------------- NumPy's archives


def test_archives_of_columns_and_records(tmp_path):
    np.savez(tmp_path / "a.npz", x=XYZ[:, 0], y=XYZ[:, 1], z=XYZ[:, 2], t=COUNT.ravel())
    points, attributes = read(tmp_path / "a.npz")
    np.testing.assert_array_equal(points, XYZ)
    assert [*attributes] == ["t"]
    records = np.zeros(40, dtype=[("id", "i8"), ("rgb", "u1", 3), ("pos", "f4", 3)])
    records["id"], records["pos"] = COUNT.ravel() + 2**60, XYZ
    np.save(tmp_path / "a.npy", records)
    points, attributes = read(tmp_path / "a.npy")
    np.testing.assert_array_equal(points, XYZ.astype("f4"))
    assert attributes["id"].tolist() == (COUNT.ravel() + 2**60).tolist()
    np.savez(tmp_path / "b.npz", features=XYZ[:, :2], xyz=XYZ)
    with pytest.warns(rm.FileWarning, match="of 2 arrays of two dimensions 'xyz' is"):
        np.testing.assert_array_equal(read_points(tmp_path / "b.npz"), XYZ)


# ------------------------------------------------------------ how tables are written


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("semicolons.csv", "x;y;z\n1,5;2;3\n4;5,25;6\n"),
        ("semicolons_and_points.csv", "1.5;2;3\n4;5.25;6\n"),
        ("tabs.csv", "x\ty\tz\n1.5\t2\t3\n4\t5.25\t6\n"),
        ("tabs.tsv", "1.5\t2\t3\n4\t5.25\t6\n"),
        ("blanks.csv", "1.5 2 3\n4 5.25 6\n"),
        ("commas.txt", "1.5,2,3\n4,5.25,6\n"),
        ("commas.xyz", "1.5, 2, 3\n4, 5.25, 6\n"),
        ("decimals.txt", "1,5 2 3\n4 5,25 6\n"),
        ("count.xyz", "2\n1.5 2 3\n4 5.25 6\n"),
        ("count_and_comment.xyz", "2\nfrom a scanner\n1.5 2 3\n4 5.25 6\n"),
        ("count.pts", "2\n1.5 2 3\n4 5.25 6\n"),
        ("windows.csv", "x,y,z\r\n1.5,2,3\r\n4,5.25,6\r\n"),
        ("old_mac.csv", "x,y,z\r1.5,2,3\r4,5.25,6\r"),
        ("utf16.csv", "x,y,z\n1.5,2,3\n4,5.25,6\n".encode("utf-16")),
        ("latin.csv", "x,y,z,größe °\n1.5,2,3,1\n4,5.25,6,1\n".encode("latin-1")),
        ("units.csv", "x,y,z\n[m],[m],[m]\n1.5,2,3\n4,5.25,6\n"),
        ("end.csv", "x,y,z,\n1.5,2,3,\n4,5.25,6,\n"),
        ("quotes.csv", '"x","y","z"\n"1.5","2","3"\n"4","5.25","6"\n'),
        ("comments.asc", "// a scan\n% more\n1.5 2 3 # one\n4 5.25 6\n"),
        ("bars.csv", "x|y|z\n1.5|2|3\n4|5.25|6\n"),
        ("markdown.txt", "x|y|z\n---|---|---\n1.5|2|3\n4|5.25|6\n"),
        ("fortran.txt", "1.5D+00 .2D+1 3d0\n4.D0 +5.25Q+00 0.6E+1\n"),
        ("fortran.csv", "x,y,z\n1.5D+00,0.2D+01,3\n4,5.25,6\n"),
        ("words.csv", "x,y,z,t\nm,m,m,degC\n1.5,2,3,9\n4,5.25,6,9\n"),
        ("words.txt", "x y z\ndouble double double\n1.5 2 3\n4 5.25 6\n"),
        ("units_decimals.csv", "x;y;z\n(m);(m);(m)\n1,5;2;3\n4;5,25;6\n"),
        ("excel.csv", "sep=;\nx;y;z\n1.5;2;3\n4;5.25;6\n"),
        ("sheets.csv", 'x,y,z\n"1,5","2","3"\n"4,0","5,25","6,0"\n'),
        ("no_mark.csv", "x,y,z\n1.5,2,3\n4,5.25,6\n".encode("utf-16-le")),
        ("no_mark_big.csv", "x,y,z\n1.5,2,3\n4,5.25,6\n".encode("utf-16-be")),
        ("printed.txt", "(1.5, 2, 3)\n(4, 5.25, 6)\n"),
        ("python.txt", "[[1.5, 2, 3],\n [4, 5.25, 6]]\n"),
        ("numpy.txt", "[[1.5  2.  3. ]\n [4.   5.25 6. ]]\n"),
        ("matlab.txt", "[1.5 2 3];\n[4 5.25 6];\n"),
        ("sizes.txt", "2 3\n1.5 2 3\n4 5.25 6\n"),
        ("table.csv.gz", gzip.compress(b"x,y,z\n1.5,2,3\n4,5.25,6\n", mtime=0)),
        ("table.txt.bz2", bz2.compress(b"1.5 2 3\n4 5.25 6\n")),
        ("table.xyz.xz", lzma.compress(b"1.5 2 3\n4 5.25 6\n")),
        ("not_said.csv", gzip.compress(b"1.5,2,3\n4,5.25,6\n", mtime=0)),
        ("two.csv.xz", lzma.compress(b"1.5,2,3\n") + lzma.compress(b"4,5.25,6\n")),
    ],
)
def test_tables_however_they_are_written(tmp_path, name, content):
    points = read_points(put(tmp_path / name, content))
    np.testing.assert_array_equal(points, [[1.5, 2, 3], [4, 5.25, 6]])


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.xyz", "3\n1 2 3\n4 5 6\n", "is truncated: expected 3 points, found 2"),
        ("a.csv", "x,y\n1,2\n3,4,5\n", "line 3: expected 2 numbers as before, found 3"),
        ("a.csv", "x,y\n1.5,2\n1_000,4\n", "line 3: expected numbers .* found '1_000'"),
        ("a.csv", "name,kind\na,b\nc,d\n", "expected numbers separated by commas"),
        ("a.csv", b"x,y\n1,2\n\x00,4\n", "is no text file"),
        ("a.csv", "x,y,z\na,b,c\nd,e,f\n", "expected numbers separated by commas"),
        ("a.csv", "1,2,3\n4,5\n6,7\n", "line 2: expected 3 numbers as before, found 2"),
        (
            "a.csv.gz",
            gzip.compress(b"1,2\n3,4\n", mtime=0)[:-9],
            "is compressed, and damaged",
        ),
        ("a.csv.bz2", bz2.compress(b"1,2\n3,4\n")[:-9], "is compressed, and damaged"),
        ("a.csv.xz", lzma.compress(b"1,2\n3,4\n")[:-9], "is compressed, and damaged"),
        ("a.csv.xz", lzma.compress(bytes(10**6)), "makes more than"),
        ("a.csv.bz2", bz2.compress(bytes(10**6)), "makes more than"),
        (
            "a.gz",
            gzip.compress(b"1,2\n" * 9, mtime=0),
            "a table with commas .*: say format 'csv'",
        ),
    ],
)
def test_tables_that_break(tmp_path, name, content, message):
    with pytest.raises(ValueError, match=message):
        read_points(put(tmp_path / name, content))


@pytest.mark.parametrize(
    "content",
    [
        ",0,1,2\n0,1.5,2.0,3.0\n1,4.0,5.25,6.0\n",  # pandas, with its index
        "0,1,2\n1.5,2.0,3.0\n4.0,5.25,6.0\n",  # and without
    ],
)
def test_numbers_of_columns_are_no_point(tmp_path, content):
    path = put(tmp_path / "a.csv", content)
    with pytest.warns(rm.FileWarning, match="0, 1, 2, is taken for the numbers of"):
        points = read_points(path)
    np.testing.assert_array_equal(points[:, -3:], [[1.5, 2, 3], [4, 5.25, 6]])
    whole = "0,1,2\n3,4,5\n6,7,8\n"  # a point like the others
    assert len(read_points(put(tmp_path / "b.csv", whole))) == 3


def test_titles_above_a_table(tmp_path):
    rows = "1.5,2,3,4\n4,5.25,6,4\n"
    head = "Survey of 12 May, north\nstation,7\n\nx,y,z,q\nm,m,m,s\n"
    path = put(tmp_path / "a.csv", head + rows)
    with pytest.warns(rm.FileWarning, match="the first 3 lines above the table are"):
        points, fields = read(path)
    np.testing.assert_array_equal(points, [[1.5, 2, 3], [4, 5.25, 6]])
    assert [*fields] == ["q"]


def test_the_first_row_of_tetgen_is_no_point(tmp_path):
    rows = "".join(f"{i + 1} {x} {y} {z}\n" for i, (x, y, z) in enumerate(XYZ.tolist()))
    path = put(tmp_path / "a.txt", f"{len(XYZ)} 3 0 0\n{rows}")
    with pytest.warns(rm.FileWarning) as caught:
        np.testing.assert_array_equal(read_points(path), XYZ)
    assert any("its first row tells how many" in str(w.message) for w in caught)


@pytest.mark.parametrize("value", ["-9999", "1e30", "-3.4028235e38", "99999.0"])
def test_numbers_that_stand_for_none_are_nan(tmp_path, value):
    rows = [[f"{v:.10g}" for v in row] for row in XYZ + 300]
    for i in (3, 8):
        rows[i][2] = value
    path = put(tmp_path / "a.csv", "\n".join(map(",".join, [["x", "y", "z"], *rows])))
    with pytest.warns(rm.FileWarning, match="numbers of coordinate 2, is read as NaN"):
        points = read_points(path)
    assert np.flatnonzero(np.isnan(points).any(axis=1)).tolist() == [3, 8]
    assert np.isfinite(points[:, :2]).all()


def test_numbers_among_others_are_numbers(tmp_path):
    heights = np.linspace(-12000, 3000, 40)
    heights[7] = -9999
    path = table(tmp_path / "a.csv", ["x", "y", "z"], XYZ[:, :2], heights)
    np.testing.assert_allclose(read_points(path)[:, 2], heights)


def test_cells_of_programs_that_hold_no_number(tmp_path):
    words = [
        "#N/A",
        ".",
        "-nan(ind)",
        "1.#QNAN",
        "-1.#IND00",
        "****",
        "#DIV/0!",
        "<NULL>",
    ]
    rows = "".join(f"1,2,{word}\n" for word in words)
    points = read_points(put(tmp_path / "a.csv", f"x,y,z\n{rows}1,2,3\n"))
    assert np.isnan(points[:-1, 2]).all()
    assert points[-1].tolist() == [1, 2, 3]


@pytest.mark.parametrize("names", [["N", "E", "Z"], ["n", "e", "h"]])
def test_north_and_east_are_in_the_order_of_a_map(tmp_path, names):
    path = table(tmp_path / "a.csv", names, XYZ[:, [1, 0, 2]])
    np.testing.assert_array_equal(read_points(path), XYZ)


def test_archives_of_others_with_faces(tmp_path):
    faces = np.array([[0, 1, 2], [1, 2, 3]])
    np.savez(tmp_path / "a.npz", vertices=XYZ, faces=faces, edges=faces[:, :2])
    with pytest.warns(rm.FileWarning) as caught:
        mesh = rm.io.read_complex(tmp_path / "a.npz")
    assert any("simplices are the array 'faces'" in str(w.message) for w in caught)
    np.testing.assert_array_equal(mesh.simplices, faces)
    np.savez(tmp_path / "a.npz", points=XYZ[:4], simplices=faces + 1)
    with pytest.raises(ValueError, match="count from 1: save them less 1"):
        rm.io.read_complex(tmp_path / "a.npz")


def test_objects_in_an_archive_are_named(tmp_path):
    held = np.empty(2, dtype=object)
    np.savez(tmp_path / "a.npz", clouds=held)
    with pytest.raises(ValueError, match="its arrays, clouds, hold Python objects"):
        read_points(tmp_path / "a.npz")


def test_nothing_is_written_as_if_it_were_compressed(tmp_path):
    with pytest.raises(ValueError, match="gz"):
        write_points(tmp_path / "a.csv.gz", XYZ)


def test_scans_one_after_the_other(tmp_path):
    text = "2\n1.5 2 3 9\n4 5.25 6 9\n1\n7 8 9 9\n"
    with pytest.warns(rm.FileWarning, match="others are intensity"):
        points = read_points(put(tmp_path / "a.pts", text.replace(" 9\n", " 9.5\n")))
    assert points.tolist() == [[1.5, 2, 3], [4, 5.25, 6], [7, 8, 9]]
    with pytest.raises(ValueError, match="is truncated: expected 5 points, found 3"):
        read_points(put(tmp_path / "b.pts", text.replace("\n1\n", "\n3\n")))


def test_a_fast_and_a_careful_reader_agree(tmp_path):
    points = RNG.normal(size=(300, 3)) * 10.0 ** RNG.integers(-300, 300, (300, 3))
    rows = [",".join(map(repr, row)) for row in points.tolist()]
    fast = read_points(put(tmp_path / "a.csv", "\n".join(rows)))
    careful = read_points(put(tmp_path / "b.csv", "\n".join([*rows, "1,,2"])))
    assert fast.tobytes() == points.tobytes()
    assert careful[:-1].tobytes() == points.tobytes()


def test_fields_go_out_and_come_back_in_tables(tmp_path):
    fields = {
        "colors": COLORS.astype(np.uint8),
        "normals": NORMALS,
        "heat": COUNT.ravel() / 3,
        "pair": XYZ[:, :2],
    }
    for suffix in (".csv", ".txt", ".xyz"):
        write_points(tmp_path / f"a{suffix}", XYZ, fields=fields)
        points, found = read(tmp_path / f"a{suffix}")
        assert points.tobytes() == XYZ.tobytes()
        assert {*found} == {*fields}
        for name, values in fields.items():
            np.testing.assert_array_equal(found[name], values, err_msg=name)
    with pytest.raises(ValueError, match="two columns would be called 'x'"):
        write_points(tmp_path / "b.csv", XYZ, fields={"x": XYZ[:, 0]})


def test_w_is_the_third_of_a_vector_beside_u_and_v(tmp_path):
    path = put(tmp_path / "a.csv", "x,y,z,u,v,w\n1,2,3,0,0,1\n4,5,6,0,0,1\n")
    points, fields = read(path)
    assert points.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert [*fields] == ["u", "v", "w"]


def test_a_comment_after_the_names_is_no_name(tmp_path):
    path = put(tmp_path / "a.csv", "x,y,z # mm\n1,2,3\n4,5,6\n")
    assert read_points(path).tolist() == [[1, 2, 3], [4, 5, 6]]


def test_a_separator_at_the_end_of_each_line_is_no_column(tmp_path):
    path = put(tmp_path / "a.csv", "1,2,3,\n4,5,6,\n7,8,9,\n")
    assert read_points(path).shape == (3, 3)


def test_a_separator_at_the_end_of_names_and_rows(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("x,y,z,\n" + "1.5,2,3,\n" * 3)
    points, attributes = rm.io.read(path)
    assert points.tolist() == [[1.5, 2, 3]] * 3
    assert attributes == {}
    path.write_text("x,y,z,\n1.5,2,3,\n1.5,2,3,7\n")  # something does stand there
    assert [*rm.io.read(path).attributes] == ["column_3"]


def test_coordinates_of_german_surveys(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("Nr;Rechtswert;Hochwert;H\u00f6he\n1;3,5;5,5;0,5\n2;4,5;6,5;1,5\n")
    points, attributes = rm.io.read(path)
    assert points.tolist() == [[3.5, 5.5, 0.5], [4.5, 6.5, 1.5]]
    assert [*attributes] == ["Nr"]
