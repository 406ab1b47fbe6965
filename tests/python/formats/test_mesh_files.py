# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes as other programs write them: VTK's XML, strips, quadratic cells, glTF, colors."""

from __future__ import annotations

import base64
import json
import lzma
import struct
import zlib

import meshio
import numpy as np
import pytest
import trimesh

import remanifold as rm
from remanifold.io import (
    read,
    read_complex,
    read_fields,
    read_points,
    write_complex,
    write_mesh,
    write_points,
)

RNG = np.random.default_rng(2)
SQUARE = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]]
POINTS = RNG.normal(size=(6, 3))
TRIANGLES = np.array([[0, 1, 2], [1, 3, 2], [5, 3, 4]])
EDGES = np.array([[0, 1], [1, 2], [4, 2], [4, 5]])
FIELDS = {
    "colors": RNG.integers(0, 256, (6, 3)).astype(np.uint8),
    "normals": POINTS / np.linalg.norm(POINTS, axis=1, keepdims=True),
    "heat": RNG.normal(size=6),
    "id": np.arange(6) + 2**60,
}


def put(path, content):
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


# -------------------------------------------------------------------- VTK's XML files


def data_array(name, values, form, kind=None, order="<", word="u4"):
    """An array as text, as base64, or as what is appended at an offset."""
    values = np.asarray(values)
    kinds = {
        "f8": "Float64",
        "f4": "Float32",
        "i8": "Int64",
        "i4": "Int32",
        "u1": "UInt8",
    }
    kind = kind or kinds[values.dtype.str[1:]]
    width = 1 if values.ndim == 1 else values.shape[1]
    head = f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{width}" '
    if form == "ascii":
        words = " ".join(map(repr, values.ravel().tolist()))
        return f'{head}format="ascii">{words}</DataArray>', b""
    data = values.astype(values.dtype.newbyteorder(order)).tobytes()
    number = np.dtype(order + word)
    packers = {"zlib": zlib.compress, "lzma": lzma.compress}
    pack = packers.get(form.partition("-")[2])
    if pack is None:
        body = np.array([len(data)], number).tobytes() + data
        text = base64.b64encode(body).decode()
    else:
        blocks = [data[i : i + 64] for i in range(0, len(data), 64)]
        packed = [pack(block) for block in blocks]
        sizes = np.array([len(blocks), 64, len(data) % 64, *map(len, packed)], number)
        text = base64.b64encode(sizes.tobytes()).decode()
        text += base64.b64encode(b"".join(packed)).decode()
        body = sizes.tobytes() + b"".join(packed)
    if form.startswith("binary"):
        return f'{head}format="binary">\n {text}\n</DataArray>', b""
    raw = body if form.startswith("raw") else text.encode()
    return f'{head}format="appended" offset="OFFSET"/>', raw


def vtk_xml(kind, parts, form, order="<", word="u4", counts=""):
    """A whole file; parts are words of XML, or the arguments of `data_array`."""
    names = {"zlib": "vtkZLibDataCompressor", "lzma": "vtkLZMADataCompressor"}
    compressor = names.get(form.partition("-")[2])
    settings = f'byte_order="{"Little" if order == "<" else "Big"}Endian" '
    settings += f'header_type="{"UInt32" if word == "u4" else "UInt64"}" '
    settings += f'compressor="{compressor}"' if compressor else ""
    body, appended = [], b""
    for part in parts:
        if isinstance(part, str):
            body.append(part)
            continue
        text, data = data_array(*part, form, order=order, word=word)
        body.append(text.replace("OFFSET", str(len(appended))))
        appended += data
    text = f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" {settings}>\n'
    text += f"<{kind}><Piece {counts}>" + "\n".join(body) + f"</Piece></{kind}>\n"
    whole = text.encode()
    if appended:
        encoding = "raw" if form.startswith("raw") else "base64"
        whole += f'<AppendedData encoding="{encoding}">\n_'.encode() + appended
        whole += b"\n</AppendedData>\n"
    return whole + b"</VTKFile>\n"


FORMS = [
    *("ascii", "binary", "binary-zlib", "binary-lzma", "appended", "appended-zlib"),
    *("raw", "raw-zlib", "raw-lzma"),
]


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(("order", "word"), [("<", "u4"), (">", "u8")])
def test_every_encoding_of_vtk_xml(tmp_path, form, order, word):
    heat = np.arange(6) / 7
    cells = [
        "<Polys>",
        ("connectivity", TRIANGLES.ravel()),
        ("offsets", np.array([3, 6, 9])),
        "</Polys>",
    ]
    parts = [
        *("<Points>", ("Points", POINTS), "</Points>", *cells),
        *("<PointData>", ("heat", heat), "</PointData>"),
    ]
    counts = 'NumberOfPoints="6" NumberOfPolys="3"'
    path = put(
        tmp_path / "a.vtp", vtk_xml("PolyData", parts, form, order, word, counts)
    )
    found = read_complex(path)
    assert found.vertices.tobytes() == POINTS.tobytes()
    np.testing.assert_array_equal(found.simplices, TRIANGLES)
    np.testing.assert_array_equal(found.vertex_attributes["heat"], heat)


@pytest.mark.parametrize("dim", [1, 2])
def test_vtp_goes_out_and_comes_back(tmp_path, dim):
    pyvista = pytest.importorskip("pyvista")
    simplices = TRIANGLES if dim == 2 else EDGES
    write_mesh(tmp_path / "a.vtp", POINTS, simplices, fields=FIELDS)
    found = read_complex(tmp_path / "a.vtp")
    np.testing.assert_array_equal(found.simplices, simplices)
    for name, values in FIELDS.items():
        np.testing.assert_array_equal(found.vertex_attributes[name], values)
        assert found.vertex_attributes[name].dtype == values.dtype
    mesh = pyvista.read(tmp_path / "a.vtp")
    np.testing.assert_array_equal(mesh.points, POINTS)
    corners = (mesh.faces if dim == 2 else mesh.lines).reshape(-1, dim + 2)[:, 1:]
    np.testing.assert_array_equal(corners, simplices)


def test_vtp_and_vtu_that_vtk_wrote(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    mesh = pyvista.PolyData(POINTS, faces=np.column_stack([[3] * 3, TRIANGLES]).ravel())
    mesh.point_data["heat"] = FIELDS["heat"]
    grid = mesh.cast_to_unstructured_grid()
    for data, suffix in ((mesh, ".vtp"), (grid, ".vtu")):
        for binary in (True, False):
            data.save(tmp_path / f"a{suffix}", binary=binary)
            found = read_complex(tmp_path / f"a{suffix}")
            np.testing.assert_allclose(found.vertices, POINTS, rtol=1e-6)
            np.testing.assert_array_equal(found.simplices, TRIANGLES)
            heat = found.vertex_attributes["heat"]
            np.testing.assert_allclose(heat, FIELDS["heat"], rtol=1e-6)


def test_points_without_cells_in_vtu(tmp_path):
    parts = ["<Points>", ("Points", POINTS), "</Points>", "<Cells/>"]
    counts = 'NumberOfPoints="6" NumberOfCells="0"'
    path = put(
        tmp_path / "a.vtu", vtk_xml("UnstructuredGrid", parts, "ascii", counts=counts)
    )
    np.testing.assert_array_equal(read_points(path), POINTS)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "vtkZLibData",
            "vtkLZ4Data",
            "compressed by vtkLZ4DataCompressor, which is not",
        ),
        ('NumberOfPoints="6"', 'NumberOfPoints="7"', "expected 21 numbers in 'Points'"),
        (
            'NumberOfPoints="6"',
            'NumberOfPoints="six"',
            "expected a count for NumberOfPoi",
        ),
        ("Float64", "String", "'Points' holds String, expected numbers"),
        ("</VTKFile>", "", "damaged, truncated or no XML file"),
        ('type="PolyData"', 'type="ImageData"', "<VTKFile> of type 'ImageData'"),
    ],
)
def test_vtp_that_is_damaged(tmp_path, old, new, message):
    write_mesh(tmp_path / "a.vtp", POINTS, TRIANGLES)
    text = (tmp_path / "a.vtp").read_text()
    assert old in text
    with pytest.raises(ValueError, match=message):
        read_complex(put(tmp_path / "b.vtp", text.replace(old, new, 1)))


# ------------------------------------------------------- strips and quadratic cells


def signed_volumes(found):
    corners = found.vertices[found.simplices]
    edges = corners[:, 1:] - corners[:, :1]
    if found.dim == 3:
        return np.linalg.det(edges) / 6
    if found.dim == 2:
        return np.cross(edges[:, 0], edges[:, 1])[:, 2] / 2
    return np.linalg.norm(edges[:, 0], axis=1)


def vtk_text(points, kind, cell, dataset="UNSTRUCTURED_GRID"):
    rows = "\n".join(" ".join(map(str, point)) for point in points)
    corners = " ".join(map(str, cell))
    return (
        f"# vtk DataFile Version 3.0\nx\nASCII\nDATASET {dataset}\n"
        f"POINTS {len(points)} double\n{rows}\nCELLS 1 {len(cell) + 1}\n"
        f"{len(cell)} {corners}\nCELL_TYPES 1\n{kind}\n"
    )


def middles(corners, pairs):
    corners = np.asarray(corners, dtype=float)
    return [
        *corners.tolist(),
        *(corners[list(pair)].mean(axis=0).tolist() for pair in pairs),
    ]


TETRA = [[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6]]
AROUND = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]


@pytest.mark.parametrize(
    ("kind", "points", "count", "volume"),
    [
        (6, [[0, 0, 0], [2, 0, 0], [0, 2, 0], [2, 2, 0], [0, 4, 0]], 3, 6),
        (8, [[0, 0, 0], [2, 0, 0], [0, 2, 0], [2, 2, 0]], 2, 4),
        (21, middles(SQUARE[:2], [(0, 1)]), 2, 2),
        (22, middles(SQUARE[:3], AROUND[:3]), 4, 2),
        (23, middles(SQUARE, [(0, 1), (1, 2), (2, 3), (3, 0)]), 6, 4),
        (24, middles(TETRA, AROUND), 8, 36),
    ],
)
@pytest.mark.parametrize("suffix", [".vtk", ".vtu"])
def test_cells_that_are_cut(tmp_path, suffix, kind, points, count, volume):
    """All nodes are used, pieces have one sign, and together they are the cell."""
    cell = [*range(len(points))]
    if suffix == ".vtk":
        content = vtk_text(points, kind, cell)
    else:
        parts = [
            *("<Points>", ("Points", np.array(points, dtype=float)), "</Points>"),
            *(
                "<Cells>",
                ("connectivity", np.array(cell)),
                ("offsets", np.array([len(cell)])),
            ),
            *(("types", np.array([kind], dtype=np.uint8)), "</Cells>"),
        ]
        counts = f'NumberOfPoints="{len(points)}" NumberOfCells="1"'
        content = vtk_xml("UnstructuredGrid", parts, "ascii", counts=counts)
    found = read_complex(put(tmp_path / f"a{suffix}", content))
    assert len(found.simplices) == count
    assert (np.unique(found.simplices) == cell).all()
    volumes = signed_volumes(found)
    assert (volumes > 0).all()
    assert volumes.sum() == pytest.approx(volume)
    topology = found.topology()
    assert topology.manifold
    assert topology.betti_numbers[0] == 1
    assert not any(topology.betti_numbers[1:])


@pytest.mark.parametrize(
    ("kind", "nodes", "message"),
    [
        (11, 8, r"holds voxels \(VTK's type 11\).*by Tetrahedralize"),
        (12, 8, "holds hexahedra"),
        (13, 6, "holds wedges"),
        (14, 5, "holds pyramids"),
        (42, 8, "holds polyhedra"),
        (99, 3, r"holds cells \(VTK's type 99\)"),
        (24, 9, "a cell of type 24 that has not 10 nodes"),
    ],
)
def test_cells_that_are_named(tmp_path, kind, nodes, message):
    points = RNG.normal(size=(nodes, 3)).tolist()
    path = put(tmp_path / "a.vtk", vtk_text(points, kind, [*range(nodes)]))
    with pytest.raises(ValueError, match=message):
        read_complex(path)
    assert len(read_points(path)) == nodes


STRIP = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [2, 2, 0], [0, 4, 0], [9, 0, 0], [9, 1, 0]]


def test_strips_in_polygon_files(tmp_path):
    rows = "\n".join(" ".join(map(str, p)) for p in STRIP)
    text = (
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\n"
        f"POINTS 7 float\n{rows}\nTRIANGLE_STRIPS 2 10\n5 0 1 2 3 4\n3 1 5 6\n"
    )
    ply = (
        "ply\nformat ascii 1.0\nelement vertex 7\nproperty float x\nproperty float y\n"
        "property float z\nelement tristrips 1\nproperty list int int vertex_indices\n"
        f"end_header\n{rows}\n9 0 1 2 3 4 -1 1 5 6\n"
    )
    parts = [
        *(
            "<Points>",
            ("Points", np.array(STRIP, dtype=float)),
            "</Points>",
            "<Strips>",
        ),
        ("connectivity", np.array([0, 1, 2, 3, 4, 1, 5, 6])),
        *(("offsets", np.array([5, 8])), "</Strips>"),
    ]
    counts = 'NumberOfPoints="7" NumberOfStrips="2"'
    for name, content in (
        ("a.vtk", text),
        ("a.ply", ply),
        ("a.vtp", vtk_xml("PolyData", parts, "ascii", counts=counts)),
    ):
        found = read_complex(put(tmp_path / name, content))
        assert len(found.simplices) == 4
        volumes = signed_volumes(found)
        assert (volumes > 0).all()
        assert volumes.sum() == pytest.approx(6 + 3.5)


# ------------------------------------------------------------------------------- glTF


@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
@pytest.mark.parametrize("dim", [1, 2])
def test_gltf_comes_back(tmp_path, suffix, dim):
    simplices = TRIANGLES if dim == 2 else EDGES
    fields = {n: FIELDS[n] for n in ("colors", "normals", "heat")}
    write_mesh(tmp_path / f"a{suffix}", POINTS, simplices, fields=fields)
    found = read_complex(tmp_path / f"a{suffix}")
    np.testing.assert_array_equal(found.vertices, POINTS.astype("f4"))
    np.testing.assert_array_equal(found.simplices, simplices)
    attributes = found.vertex_attributes
    assert attributes["colors"].dtype == np.uint8
    np.testing.assert_array_equal(attributes["colors"][:, :3], fields["colors"])
    np.testing.assert_allclose(attributes["normals"], fields["normals"], atol=1e-6)
    np.testing.assert_array_equal(attributes["heat"], fields["heat"].astype("f4"))


def test_glb_that_trimesh_wrote(tmp_path):
    """Two meshes where their nodes put them: scaled, turned, moved."""
    scene = trimesh.Scene()
    mesh = trimesh.Trimesh(POINTS, TRIANGLES, process=False)
    turn = trimesh.transformations.rotation_matrix(0.7, [1, 2, 3], [0.5, 0, 0])
    turn[:3, :3] *= 2.5
    scene.add_geometry(mesh, node_name="a")
    scene.add_geometry(mesh, node_name="b", transform=turn)
    scene.export(tmp_path / "a.glb")
    found = read_complex(tmp_path / "a.glb")
    assert len(found.simplices) == 6
    moved = POINTS @ turn[:3, :3].T + turn[:3, 3]
    expected = np.vstack([POINTS, moved])
    np.testing.assert_allclose(found.vertices, expected, rtol=0, atol=1e-5)
    np.testing.assert_array_equal(
        found.simplices, np.vstack([TRIANGLES, TRIANGLES + 6])
    )


def gltf(points, primitive, indices=None, **more):
    """JSON of one primitive, with its arrays as a data URI."""
    data = np.asarray(points, dtype="<f4").tobytes()
    views = [{"buffer": 0, "byteLength": len(data)}]
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3"}
    ]
    primitive = {"attributes": {"POSITION": 0}, **primitive}
    if indices is not None:
        extra = np.asarray(indices, dtype="<u2").tobytes()
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(extra)})
        kind = {"componentType": 5123, "count": len(indices), "type": "SCALAR"}
        accessors.append({"bufferView": 1, **kind})
        primitive["indices"] = 1
        data += extra
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    scene = {
        "asset": {"version": "2.0"},
        "meshes": [{"primitives": [primitive]}],
        "nodes": [{"mesh": 0, "translation": [0, 0, 1]}],
        "scenes": [{"nodes": [0]}],
        "buffers": [{"byteLength": len(data), "uri": uri}],
        "bufferViews": views,
        "accessors": accessors,
    }
    return json.dumps(scene | more)


@pytest.mark.parametrize(
    ("mode", "indices", "expected"),
    [
        (4, None, [[0, 1, 2], [3, 4, 5]]),
        (4, [0, 1, 2, 2, 1, 3], [[0, 1, 2], [2, 1, 3]]),
        (5, [0, 1, 2, 3, 4], [[0, 1, 2], [1, 3, 2], [2, 3, 4]]),
        (6, [0, 1, 2, 3, 4], [[0, 1, 2], [0, 2, 3], [0, 3, 4]]),
        (1, [0, 1, 2, 3], [[0, 1], [2, 3]]),
        (2, [0, 1, 2], [[0, 1], [1, 2], [2, 0]]),
        (3, [0, 1, 2], [[0, 1], [1, 2]]),
    ],
)
def test_modes_of_gltf(tmp_path, mode, indices, expected):
    path = put(tmp_path / "a.gltf", gltf(POINTS, {"mode": mode}, indices))
    found = read_complex(path)
    assert {tuple(row) for row in np.sort(found.simplices).tolist()} == {
        tuple(sorted(row)) for row in expected
    }
    np.testing.assert_allclose(found.vertices, POINTS + np.array([0, 0, 1]), atol=1e-6)


def test_gltf_of_points_and_with_a_file_beside_it(tmp_path):
    path = put(tmp_path / "a.gltf", gltf(POINTS, {"mode": 0}))
    assert read_points(path).shape == (6, 3)
    scene = json.loads(gltf(POINTS, {"mode": 0}))
    put(tmp_path / "a b.bin", np.asarray(POINTS, dtype="<f4").tobytes())
    scene["buffers"][0]["uri"] = "a%20b.bin"
    put(tmp_path / "b.gltf", json.dumps(scene))
    assert read_points(tmp_path / "b.gltf").shape == (6, 3)
    for uri in ("../a.bin", "c.bin", "/etc/passwd"):
        scene["buffers"][0]["uri"] = uri
        put(tmp_path / "c.gltf", json.dumps(scene))
        with pytest.raises(ValueError, match=r"needs the file .* beside it"):
            read_points(tmp_path / "c.gltf")


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (
            {"extensionsRequired": ["KHR_draco_mesh_compression"]},
            "compressed by KHR_dr",
        ),
        ({"asset": {"version": "1.0"}}, "is glTF of version 1.0, expected 2"),
        ({"accessors": []}, "its JSON does not fit together"),
        ({"nodes": [{"children": [0], "mesh": 0}]}, "its nodes contain each other"),
        ({"nodes": [{}]}, "holds no meshes"),
        ({"buffers": [{"uri": "data:,AAAA"}]}, "end beyond its data"),
    ],
)
def test_gltf_that_is_damaged(tmp_path, more, message):
    path = put(tmp_path / "a.gltf", gltf(POINTS, {}, **more))
    with pytest.raises(ValueError, match=message):
        read_complex(path)


def test_glb_that_is_damaged(tmp_path):
    write_mesh(tmp_path / "a.glb", POINTS, TRIANGLES)
    data = (tmp_path / "a.glb").read_bytes()
    for content, message in (
        (data[:-4], "is truncated: expected"),
        (b"glTF" + struct.pack("<I", 1) + data[8:], "is glTF of version 1, expected 2"),
        (b"glXX" + data[4:], "begins with 'glTF'"),
    ):
        with pytest.raises(ValueError, match=message):
            read_points(put(tmp_path / "b.glb", content))


# ------------------------------------------------------- colors and normals elsewhere


@pytest.mark.parametrize("suffix", [".obj", ".off"])
@pytest.mark.parametrize("names", [["colors"], ["normals"], ["colors", "normals"]])
def test_colors_and_normals_of_text_formats(tmp_path, suffix, names):
    path = tmp_path / f"a{suffix}"
    fields = {name: FIELDS[name] for name in names}
    write_mesh(path, POINTS, TRIANGLES, fields=fields)
    found = read_complex(path)
    assert found.vertices.tobytes() == POINTS.tobytes()
    np.testing.assert_array_equal(found.simplices, TRIANGLES)
    assert {*found.vertex_attributes} == {*names}
    for name in names:
        values = found.vertex_attributes[name]
        np.testing.assert_array_equal(values[:, :3], FIELDS[name])
    mesh = trimesh.load(path, process=False)
    np.testing.assert_array_equal(mesh.faces, TRIANGLES)
    if "colors" in names and suffix == ".obj":
        seen = np.asarray(mesh.visual.vertex_colors)[:, :3]
        np.testing.assert_array_equal(seen, FIELDS["colors"])
    with pytest.raises(ValueError, match="cannot hold the fields 'heat'"):
        write_mesh(path, POINTS, TRIANGLES, fields={**fields, "heat": FIELDS["heat"]})


def test_colors_of_obj_with_few_digits(tmp_path):
    lines = [f"v {i} 0 0 {i / 255:.4f} 0.5020 1" for i in range(4)]
    fields = read_fields(put(tmp_path / "a.obj", "\n".join(lines)))
    assert fields["colors"].tolist() == [[i, 128, 255] for i in range(4)]
    # Normals of corners, not of vertices, are none of these.
    text = "\n".join([*lines, *["vn 0 0 1"] * 4, "f 1//2 2//2 3//2"])
    assert {*read_fields(put(tmp_path / "b.obj", text))} == {"colors"}


@pytest.mark.parametrize("dtype", [np.uint16, np.float64])
@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".glb"])
def test_colors_of_other_types_become_bytes_for_viewers(tmp_path, dtype, suffix):
    scale = 257 if dtype is np.uint16 else 1 / 255
    colors = (FIELDS["colors"].astype(float) * scale).astype(dtype)
    path = tmp_path / f"a{suffix}"
    write_mesh(path, POINTS, TRIANGLES, fields={"colors": colors})
    found = read_fields(path)["colors"]
    assert found.dtype == np.uint8
    np.testing.assert_array_equal(found[:, :3], FIELDS["colors"])


# ------------------------------------------------------------------ whole numbers


@pytest.mark.parametrize(
    "values",
    [
        np.array([2**40, 0, 1, 2, 3, -(2**53)]),
        np.array([2**62 + 1, 0, 1, 2, 3, -(2**62) - 1]),
        np.array([2**64 - 1, 0, 1, 2, 3, 4], dtype=np.uint64),
        np.array([5, 4, 3, 2, 1, 0]),
    ],
)
def test_whole_numbers_of_ply_stay_whole(tmp_path, values):
    write_mesh(tmp_path / "a.ply", POINTS, TRIANGLES, fields={"id": values})
    found = read_fields(tmp_path / "a.ply")["id"]
    assert found.dtype.kind == values.dtype.kind
    assert found.tolist() == values.tolist()
    # What doubles hold is read by programs that know no int64.
    if np.abs(values.astype(float)).max() <= 2**53:
        mesh = trimesh.load(tmp_path / "a.ply", process=False)
        np.testing.assert_array_equal(mesh.vertices, POINTS)
        mesh = meshio.read(tmp_path / "a.ply")
        np.testing.assert_array_equal(mesh.point_data["id"], values)


def test_whole_numbers_of_text_ply(tmp_path):
    head = "ply\nformat ascii 1.0\nelement vertex 2\n"
    head += "".join(f"property double {axis}\n" for axis in "xyz")
    text = head + "property int64 id\nend_header\n0 0 0 9007199254740993\n1 1 1 -7\n"
    assert read_fields(put(tmp_path / "a.ply", text))["id"].tolist() == [2**53 + 1, -7]


# ----------------------------------------------------------- attributes of a complex


def test_attributes_of_a_complex_travel(tmp_path):
    whole = rm.SimplicialComplex(POINTS, TRIANGLES, vertex_attributes=FIELDS)
    part = whole.subset([2])
    for name, values in FIELDS.items():
        np.testing.assert_array_equal(part.vertex_attributes[name], values[3:])
        assert not part.vertex_attributes[name].flags.writeable
    edge = whole.boundary_complex()
    np.testing.assert_array_equal(
        edge.vertex_attributes["heat"], FIELDS["heat"][edge.vertex_indices]
    )
    for suffix in (".ply", ".vtk", ".vtu", ".vtp", ".npz"):
        write_complex(tmp_path / f"a{suffix}", whole)
        found = read_complex(tmp_path / f"a{suffix}")
        assert {*found.vertex_attributes} == {*FIELDS}
        found.write(tmp_path / f"b{suffix}")
        first, second = ((tmp_path / f"{n}{suffix}").read_bytes() for n in "ab")
        assert first == second
    whole.write(tmp_path / "a.obj")  # what it holds
    assert {*read_complex(tmp_path / "a.obj").vertex_attributes} == {
        "colors",
        "normals",
    }
    whole.write(tmp_path / "a.stl")
    whole.write(tmp_path / "c.ply", fields=None)
    assert read_fields(tmp_path / "c.ply") == {}
    with pytest.raises(ValueError, match="fields is 'some', expected one of 'auto'"):
        whole.write(tmp_path / "d.ply", fields="some")
    with pytest.raises(ValueError, match=r"vertex_attributes\['a'\] has shape \(5,\)"):
        rm.SimplicialComplex(POINTS, TRIANGLES, vertex_attributes={"a": np.ones(5)})


def test_fields_are_read_where_faces_cannot_be(tmp_path):
    write_mesh(tmp_path / "a.ply", POINTS, TRIANGLES, fields=FIELDS)
    data = (tmp_path / "a.ply").read_bytes()
    path = put(tmp_path / "b.ply", data[:-8] + b"\xff" * 8)
    points, attributes = read(path)
    assert points.tobytes() == POINTS.tobytes()
    assert {*attributes} == {*FIELDS}
    with pytest.raises(ValueError, match="has a face with vertex"):
        read_complex(path)


def test_points_with_colors_in_all_formats_that_hold_them(tmp_path):
    for suffix in (
        ".ply",
        ".obj",
        ".off",
        ".vtk",
        ".vtu",
        ".vtp",
        ".csv",
        ".txt",
        ".npz",
    ):
        path = tmp_path / f"a{suffix}"
        write_points(path, POINTS, fields={"colors": FIELDS["colors"]})
        points, attributes = read(path)
        assert points.tobytes() == POINTS.tobytes(), suffix
        np.testing.assert_array_equal(attributes["colors"][:, :3], FIELDS["colors"])


# ---------------------------------------------------- counts that are less than what is there

HEAD = (
    "ply\nformat {}\nelement vertex {}\nproperty float x\nproperty float y\n"
    "property float z\nelement face {}\nproperty list uchar int vertex_indices\n"
    "end_header\n"
)
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1]], dtype="f4")
POLYGONS = ([0, 1, 2], [1, 2, 3], [0, 1, 3, 2])


def ply(encoding, vertices, faces):
    head = HEAD.format(encoding, vertices, faces).encode()
    if encoding.startswith("ascii"):
        rows = [*CORNERS.tolist(), *([len(p), *p] for p in POLYGONS)]
        return head + "\n".join(" ".join(map(str, row)) for row in rows).encode()
    order = "<" if "little" in encoding else ">"
    body = CORNERS.astype(order + "f4").tobytes()
    for polygon in POLYGONS:
        body += bytes([len(polygon)]) + np.array(polygon, order + "i4").tobytes()
    return head + body


@pytest.mark.parametrize("read", [rm.io.read_points, rm.io.read_complex])
@pytest.mark.parametrize(
    "encoding", ["ascii 1.0", "binary_little_endian 1.0", "binary_big_endian 1.0"]
)
def test_ply_with_more_than_its_header_says(tmp_path, encoding, read):
    path = tmp_path / "a.ply"
    path.write_bytes(ply(encoding, 4, 3) + b"\r\n\r\n")
    read(path)  # and no warning
    path.write_bytes(ply(encoding, 4, 2))
    words = r"a\.ply: holds \d+ (line|bytes?)s? more than its header tells of \(4 of "
    with pytest.warns(rm.FileWarning, match=words):
        read(path)
    # Then what follows the vertices is no such thing as the header says.
    path.write_bytes(ply(encoding, 3, 3))
    if read is rm.io.read_points:
        with pytest.warns(rm.FileWarning, match=r"header tells of \(3 of 'vertex'"):
            assert len(read(path)) == 3
    else:
        with pytest.raises((ValueError, rm.FileWarning)):
            read(path)
