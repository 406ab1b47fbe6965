# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of scanners and of data science: PCD, PTX, E57, Parquet, Zarr, COPC, grids."""

from __future__ import annotations

import struct
import sys

import laspy
import numpy as np
import pytest

import remanifold as rm
from remanifold.formats import _pcd
from remanifold.io import read, read_points, write_points

RNG = np.random.default_rng(1)
XYZ = RNG.normal(size=(30, 3)).astype("f4").astype(float)
COLORS = RNG.integers(0, 256, (30, 3)).astype(np.uint8)
LABELS = RNG.integers(0, 5, 30).astype(np.int32)


def put(path, content):
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


# ---------------------------------------------------------------------------- PCD


def lzf(data):
    """Compress as LibLZF does, but for its hashing: repeats are looked for everywhere."""
    out, literal, i = bytearray(), bytearray(), 0

    def flush():
        for start in range(0, len(literal), 32):
            part = literal[start : start + 32]
            out.append(len(part) - 1)
            out.extend(part)
        literal.clear()

    while i < len(data):
        length, where = 0, -1
        for start in range(max(0, i - 8192), i):
            size = 0
            while (
                size < 264
                and i + size < len(data)
                and data[start + size] == data[i + size]
            ):
                size += 1
            if size > length:
                length, where = size, start
        if length < 3:
            literal.append(data[i])
            i += 1
            continue
        flush()
        offset, rest = i - where - 1, length - 2
        if rest < 7:
            out += bytes([rest << 5 | offset >> 8, offset & 255])
        else:
            out += bytes([7 << 5 | offset >> 8, rest - 7, offset & 255])
        i += length
    flush()
    return bytes(out)


def pcd(kind, width=30, height=1, points=XYZ):
    """A file as PCL writes it: x, y, z, a gap, packed colors, labels, two more numbers."""
    count = width * height
    head = (
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
        "FIELDS x y z _ rgb label pair\nSIZE 4 4 4 1 4 4 2\nTYPE F F F U F U I\n"
        f"COUNT 1 1 1 4 1 1 2\nWIDTH {width}\nHEIGHT {height}\n"
        f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA {kind}\n"
    ).encode()
    bits = COLORS.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], dtype=np.uint32)
    pair = np.column_stack([LABELS, -LABELS]).astype("<i2")
    columns = [
        *(points[:, axis].astype("<f4").tobytes() for axis in range(3)),
        b"\0" * 4 * count,
        bits.astype("<u4").tobytes(),
        LABELS.astype("<u4").tobytes(),
        pair.tobytes(),
    ]
    sizes = [4, 4, 4, 4, 4, 4, 4]
    if kind == "ascii":
        rgb = bits.astype("<u4").view("<f4")
        rows = [
            " ".join([*map(repr, p), "0 0 0 0", str(c), str(n), str(n), str(-n)])
            for p, c, n in zip(points.tolist(), rgb, LABELS.tolist(), strict=True)
        ]
        return head + "\n".join([*rows, ""]).encode()
    if kind == "binary":
        rows = [
            b"".join(
                c[i * s : (i + 1) * s] for c, s in zip(columns, sizes, strict=True)
            )
            for i in range(count)
        ]
        return head + b"".join(rows)
    body = b"".join(columns)
    packed = lzf(body)
    return head + struct.pack("<II", len(packed), len(body)) + packed


@pytest.mark.parametrize("kind", ["ascii", "binary", "binary_compressed"])
def test_pcd(tmp_path, kind):
    path = put(tmp_path / "a.pcd", pcd(kind))
    points, attributes = read(path)
    np.testing.assert_array_equal(points, XYZ)
    assert {*attributes} == {"colors", "label", "pair"}
    np.testing.assert_array_equal(attributes["colors"], COLORS)
    np.testing.assert_array_equal(attributes["label"], LABELS)
    np.testing.assert_array_equal(
        attributes["pair"], np.column_stack([LABELS, -LABELS])
    )
    assert attributes["label"].dtype == np.uint32
    assert read_points(path, columns="x,label").shape == (30, 2)


@pytest.mark.parametrize("kind", ["ascii", "binary", "binary_compressed"])
def test_pcd_with_more_than_its_header_says(tmp_path, kind):
    data = pcd(kind)
    few = data.replace(b"WIDTH 30", b"WIDTH 20").replace(b"POINTS 30", b"POINTS 20")
    more = {"ascii": few, "binary": few, "binary_compressed": data + b"more"}[kind]
    with pytest.warns(rm.FileWarning, match="more .*its header tells of") as caught:
        found = read_points(put(tmp_path / "a.pcd", more))
    assert len(found) == (30 if kind == "binary_compressed" else 20)
    assert "WIDTH" in str(caught[0].message)
    # Some programs fill up the last block.
    assert len(read_points(put(tmp_path / "a.pcd", data + b"\n\0\0\0"))) == 30


def test_repeats_that_go_on_into_themselves():
    for data in (b"ab" * 300, b"\0" * 1000, bytes(range(250)) * 3, RNG.bytes(400)):
        packed = lzf(data)
        assert _pcd._lzf(None, memoryview(packed), len(data)) == data


def test_pcd_of_an_image_with_pixels_that_saw_nothing(tmp_path):
    points = XYZ.copy()
    points[[0, 7, 29]] = np.nan
    path = put(tmp_path / "a.pcd", pcd("binary", 6, 5, points))
    np.testing.assert_array_equal(read_points(path), points)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"DATA binary", b"DATA zip   ", "line 11: no valid line of a PCD header"),
        (b"SIZE 4 4 4 1 4 4 2", b"SIZE 4 4 4 1 4 4 3", "which is none of PCD's"),
        (b"SIZE 4 4 4 1 4 4 2", b"SIZE 4 4 4 1 4 4", "differ in length"),
        (b"POINTS 30", b"POINTS 31", "is truncated: expected 31 points, found 30"),
        (
            b"POINTS 30",
            b"POINTS 99999999999",
            "is truncated: expected 99,999,999,999 po",
        ),
        (b"HEIGHT 1", b"HEIGHT 2", "has 30 points in an image of 30 by 2"),
        (b"FIELDS x y z", b"FIELDS a b c", "no columns are called x, y, z"),
    ],
)
def test_pcd_that_is_damaged(tmp_path, old, new, message):
    path = put(tmp_path / "a.pcd", pcd("binary").replace(old, new))
    with pytest.raises((ValueError, rm.FileWarning), match=message) as caught:
        read_points(path)
    assert str(path) in str(caught.value)


def test_compressed_pcd_that_is_damaged(tmp_path):
    data = pcd("binary_compressed")
    start = data.index(b"compressed\n") + len(b"compressed\n")
    for spoiled, message in (
        (data[:-5], "compressed bytes"),
        (data[: start + 4], "is truncated: expected 30 points, found none"),
        (
            data[: start + 4] + b"\xff" * 4 + data[start + 8 :],
            "take 840 bytes, it has 4",
        ),
        (data[: start + 8] + b"\x3f\xff" * 500, "make no sense|expected 840 bytes"),
    ):
        with pytest.raises(ValueError, match=message):
            read_points(put(tmp_path / "a.pcd", spoiled))


# ---------------------------------------------------------------------------- PTX


def ptx(points, matrix, colors=True):
    rows = [
        f"{x} {y} {z} 0.5" + (f" {r} {g} {b}" if colors else "")
        for (x, y, z), (r, g, b) in zip(points.tolist(), COLORS.tolist(), strict=True)
    ]
    head = ["5", "6", "0 0 0", "1 0 0", "0 1 0", "0 0 1"]
    head += [" ".join(map(str, row)) for row in matrix.tolist()]
    return "\n".join([*head, *rows, ""])


def test_ptx(tmp_path):
    """Two scans, of which the second was moved; a pixel without a point is NaN."""
    turn = np.eye(4)
    turn[:3, :3] = [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]
    turn[3, :3] = [10, 20, 30]
    seen = XYZ.copy()
    seen[4] = 0
    path = put(tmp_path / "a.ptx", ptx(XYZ, np.eye(4)) + ptx(seen, turn))
    points, attributes = read(path)
    np.testing.assert_array_equal(points[:30], XYZ)
    expected = np.column_stack([10 - XYZ[:, 1], 20 + XYZ[:, 0], 30 + XYZ[:, 2]])
    expected[4] = np.nan
    np.testing.assert_allclose(points[30:], expected)
    np.testing.assert_array_equal(attributes["colors"], np.vstack([COLORS, COLORS]))
    assert attributes["scan"].tolist() == [0] * 30 + [1] * 30
    assert (attributes["intensity"] == 0.5).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda text: text[:-40],
            "is truncated: expected 5 by 6 points|expected 7 numb",
        ),
        (lambda text: text.replace("5\n6\n", "5\nsix\n"), "line 2: expected a count"),
        (lambda text: text[:20], "is truncated: expected a header of 10 lines"),
        (lambda text: text.replace(" 0.5", " zero", 1), "line 11: expected 7 numbers"),
        (lambda text: text[:0], "is empty"),
    ],
)
def test_ptx_that_is_damaged(tmp_path, change, message):
    with pytest.raises(ValueError, match=message):
        read_points(put(tmp_path / "a.ptx", change(ptx(XYZ, np.eye(4)))))


# -------------------------------------------------------------- molecules and grids


def test_a_molecule(tmp_path):
    text = "3\nwater\nO 0.0 0.0 0.1\nH1 0.7 0.0 -0.5\n cl -0.7 0.0 -0.5 0.25\n"
    points, attributes = read(put(tmp_path / "a.xyz", text))
    assert points.tolist() == [[0, 0, 0.1], [0.7, 0, -0.5], [-0.7, 0, -0.5]]
    assert attributes["atomic_number"].tolist() == [8, 1, 17]
    with pytest.warns(rm.FileWarning, match="more than one molecule: the first, of 3"):
        assert len(read_points(put(tmp_path / "b.xyz", text + text))) == 3
    for old, new, message in (
        ("3\n", "4\n", "is truncated: expected 4 atoms, found 3"),
        ("0.7 0.0 -0.5\n", "0.7 zero -0.5\n", "line 4: expected 3 numbers"),
    ):
        with pytest.raises(ValueError, match=message):
            read_points(put(tmp_path / "c.xyz", text.replace(old, new, 1)))


def test_what_stands_behind_the_atoms(tmp_path):
    rows = ["C 0 0 0.5 -0.25 CA", "O 1 0 0.5 0.5 OB", "H 0 1 0.5 0 CA"]
    path = put(tmp_path / "a.xyz", "\n".join(["3", "", *rows]))
    points, attributes = read(path)
    assert points.tolist() == [[0, 0, 0.5], [1, 0, 0.5], [0, 1, 0.5]]
    assert attributes["atomic_number"].tolist() == [6, 8, 1]
    assert attributes["column_4"].tolist() == [-0.25, 0.5, 0]
    assert attributes["column_5"].tolist() == [0, 1, 0]  # CA, OB


def test_a_molecule_in_extended_xyz(tmp_path):
    """Its comment says which columns are what, in any order."""
    comment = 'Lattice="9 0 0 0 9 0 0 0 9" Properties=species:S:1:id:I:1:pos:R:3:'
    comment += "forces:R:3:fixed:L:1:kind:S:1 energy=-1.5"
    rows = [
        "C 7 0 0 0.5 1 2 3 T ring",
        "O 8 1 0 0.5 4 5 6 F tail",
        "H 9 0 1 0.5 7 8 9 F ring",
    ]
    path = put(tmp_path / "a.xyz", "\n".join(["3", comment, *rows]))
    points, attributes = read(path)
    assert points.tolist() == [[0, 0, 0.5], [1, 0, 0.5], [0, 1, 0.5]]
    assert attributes["atomic_number"].tolist() == [6, 8, 1]
    assert attributes["id"].tolist() == [7, 8, 9]
    assert attributes["id"].dtype == np.int64
    assert attributes["forces"].tolist() == [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    assert attributes["fixed"].tolist() == [True, False, False]
    assert attributes["kind"].tolist() == [0, 1, 0]
    assert [*attributes] == ["atomic_number", "id", "forces", "fixed", "kind"]
    short = put(tmp_path / "b.xyz", path.read_text().replace(" F tail", ""))
    with pytest.raises(ValueError, match="line 4: expected 10 columns as 'Properties'"):
        read(short)


def test_a_grid_of_heights(tmp_path):
    text = (
        "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 50\ncellsize 10\n"
        "NODATA_value -9999\n1 2 -9999\n4 5 6\n"
    )
    points = read_points(put(tmp_path / "a.asc", text))
    assert points[[0, 3, 5]].tolist() == [[105, 65, 1], [105, 55, 4], [125, 55, 6]]
    assert np.isnan(points[2]).tolist() == [False, False, True]
    for old, new, message in (
        ("4 5 6", "4 5", "expected 2 rows of 3 heights, found 5 numbers"),
        ("cellsize 10\n", "", "without cellsize in its header"),
        ("4 5 6", "4 5 x", "a height that is no number"),
    ):
        with pytest.raises(ValueError, match=message):
            read_points(put(tmp_path / "b.asc", text.replace(old, new)))


# --------------------------------------------------------------------- LAS and COPC


@pytest.mark.parametrize("name", ["a.las", "a.laz", "a.copc.laz"])
def test_las_with_colors_of_16_bits(tmp_path, name):
    header = laspy.LasHeader(point_format=7, version="1.4")
    header.scales = [0.001] * 3
    cloud = laspy.LasData(header)
    cloud.x, cloud.y, cloud.z = XYZ.T
    for i, part in enumerate(("red", "green", "blue")):
        setattr(cloud, part, COLORS[:, i].astype(np.uint16) * 257)
    cloud.classification = LABELS.astype(np.uint8)
    cloud.write(tmp_path / name)
    points, attributes = read(tmp_path / name)
    np.testing.assert_allclose(points, XYZ, atol=0.00051)
    np.testing.assert_array_equal(attributes["colors"], COLORS.astype(int) * 257)
    np.testing.assert_array_equal(attributes["classification"], LABELS)
    # What viewers read has bytes.
    write_points(tmp_path / "a.ply", points, fields=attributes)
    np.testing.assert_array_equal(read(tmp_path / "a.ply")[1]["colors"], COLORS)


# ------------------------------------------------- by libraries that may be absent


@pytest.mark.parametrize(
    ("suffix", "module", "extra"),
    [
        (".e57", "pye57", "e57"),
        (".parquet", "pyarrow.parquet", "parquet"),
        (".zarr", "zarr", "zarr"),
        (".laz", "laspy", "las"),
    ],
)
def test_a_library_that_is_absent_is_named(
    tmp_path, monkeypatch, suffix, module, extra
):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=rf"pip install remanifold\[{extra}\]"):
        read_points(put(tmp_path / f"a{suffix}", "x"))


def test_e57(tmp_path):
    pye57 = pytest.importorskip("pye57")
    data = {f"cartesian{axis}": XYZ[:, i] for i, axis in enumerate("XYZ")}
    data |= {f"color{c}": COLORS[:, i] for i, c in enumerate(("Red", "Green", "Blue"))}
    data["intensity"] = LABELS.astype(np.float32)
    data["cartesianInvalidState"] = (np.arange(30) == 3).astype(np.int8)
    path = tmp_path / "a.e57"
    half = np.sqrt(0.5)
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw(data)
        file.write_scan_raw(
            data,
            rotation=np.array([half, 0, 0, half]),  # a quarter turn about z
            translation=np.array([10.0, 20.0, 30.0]),
        )
    points, attributes = read(path)
    valid = np.arange(30) != 3
    np.testing.assert_allclose(points[:30][valid], XYZ[valid])
    assert np.isnan(points[[3, 33]]).all()
    expected = np.column_stack([10 - XYZ[:, 1], 20 + XYZ[:, 0], 30 + XYZ[:, 2]])
    np.testing.assert_allclose(points[30:][valid], expected[valid])
    np.testing.assert_array_equal(attributes["colors"], np.vstack([COLORS] * 2))
    np.testing.assert_array_equal(attributes["intensity"], np.tile(LABELS, 2))
    assert attributes["scan"].tolist() == [0] * 30 + [1] * 30
    data = path.read_bytes()
    for content, message in (
        (data[:-100], "is truncated: expected"),
        (data[:30], "expected an E57 header"),
        (b"ply\n", "expected an E57 file.*it seems to be a PLY file"),
        (data[:2000] + b"\xff" * 8 + data[2008:], "damaged, truncated or no E57 file"),
    ):
        with pytest.raises(ValueError, match=message):
            read_points(put(tmp_path / "b.e57", content))


def test_parquet(tmp_path):
    arrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    columns = {
        "id": np.arange(30) + 2**60,
        "X": XYZ[:, 0],
        "Y": [None, *XYZ[1:, 1]],
        "Z": XYZ[:, 2].astype("f4"),
        "kind": ["tree", "car", None] * 10,
        "code": [*COLORS.astype(float)],
        "when": np.arange(30).astype("M8[s]"),
    }
    parquet.write_table(arrow.table(columns), tmp_path / "a.parquet")
    points, attributes = read(tmp_path / "a.parquet")
    np.testing.assert_array_equal(points[1:], XYZ[1:])
    assert np.isnan(points[0, 1])
    assert attributes["id"].tolist() == columns["id"].tolist()
    assert attributes["kind"].tolist() == [2, 1, 0] * 10
    np.testing.assert_array_equal(attributes["code"], COLORS)
    assert attributes["when"].tolist() == [1000000 * i for i in range(30)]
    fields = {"colors": COLORS, "heat": XYZ[:, 0], "inside": LABELS > 2}
    write_points(tmp_path / "b.parquet", XYZ, fields=fields)
    points, found = read(tmp_path / "b.parquet")
    assert points.tobytes() == XYZ.tobytes()
    for name, values in fields.items():
        np.testing.assert_array_equal(found[name], values)
    data = (tmp_path / "b.parquet").read_bytes()
    for content in (data[:-9], data[:60], b"PAR1", b""):
        with pytest.raises(ValueError, match="damaged, truncated or no Parquet file"):
            read_points(put(tmp_path / "c.parquet", content))


def test_zarr(tmp_path):
    zarr = pytest.importorskip("zarr")
    group = zarr.open_group(str(tmp_path / "a.zarr"), mode="w")
    group["points"] = XYZ
    group["label"] = LABELS
    points, attributes = read(tmp_path / "a.zarr")
    np.testing.assert_array_equal(points, XYZ)
    np.testing.assert_array_equal(attributes["label"], LABELS)
    zarr.save(str(tmp_path / "b.zarr"), XYZ)
    np.testing.assert_array_equal(read_points(tmp_path / "b.zarr"), XYZ)
    (tmp_path / "c.zarr").mkdir()
    for path in (tmp_path / "c.zarr", put(tmp_path / "d.zarr", "nothing")):
        with pytest.raises(ValueError, match="damaged or no array of Zarr"):
            read_points(path)
    with pytest.raises(IsADirectoryError, match="is a directory, expected a file"):
        read_points(tmp_path / "a.zarr", format="ply")
