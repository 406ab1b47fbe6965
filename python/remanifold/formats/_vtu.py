# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK's XML files of unstructured grids, read by meshio."""

from __future__ import annotations

import base64
import zlib
from typing import IO, Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from remanifold.formats._mesh import Faces, FileMesh
from remanifold.formats._source import Source
from remanifold.formats._vtk import LINE, POLYGON, QUAD, TETRA, TRIANGLE, cells_of_grid

_KINDS = {
    "vertex": 1,
    "line": LINE,
    "triangle": TRIANGLE,
    "polygon": POLYGON,
    "quad": QUAD,
    "tetra": TETRA,
}
_WRITTEN = {1: 1, 2: LINE, 3: TRIANGLE, 4: TETRA}


def read_vtu(source: Source, cells: bool) -> FileMesh:
    """Read points, cells, and what is said about the points."""
    import meshio

    try:
        with source.on_disk() as path:
            grid = meshio.vtu.read(path)
        points = np.asarray(grid.points, dtype=np.float64)
        if points.ndim != 2:
            source.fail("holds no points")
    except (Exception, SystemExit) as error:  # noqa: BLE001
        if b'NumberOfCells="0"' in source.data:
            what = "holds no cells, and meshio reads only grids with cells"
            source.fail(f"{what}; save the points as .vtk or .ply", error)
        reason = str(error) or type(error).__name__
        what = f"is damaged, truncated or no unstructured grid ({reason})"
        source.fail(what, error)
    mesh = FileMesh(points)
    if cells:
        mesh.cells = _cells(source, mesh, grid.cells)
        mesh.fields = _fields(source, len(points), grid.point_data or {})
    return mesh


def _cells(source: Source, mesh: FileMesh, blocks: Any) -> dict[int, Any]:
    corners: list[Any] = [np.empty(0, dtype=np.int64)]
    sizes, types = [], []
    for block in blocks:
        if block.type not in _KINDS:
            source.fail(
                f"holds cells of the type {block.type!r}; only edges, polygons and "
                "tetrahedra can be read"
            )
        for cell in block.data:
            corners.append(np.asarray(cell, dtype=np.int64).ravel())
            sizes.append(len(corners[-1]))
        types += [_KINDS[block.type]] * len(block.data)
    faces = Faces(np.concatenate(corners), np.array(sizes, dtype=np.int64))
    return cells_of_grid(source, mesh.points, faces, np.array(types, dtype=np.int64))


def _fields(source: Source, count: int, given: dict[str, Any]) -> dict[str, Any]:
    fields = {}
    for name, values in given.items():
        array = np.asarray(values)
        if array.ndim == 0 or len(array) != count:
            source.fail(f"{name!r} has shape {array.shape} for {count} points")
        # One component, said or not, is the same.
        fields[name] = array.ravel() if array.shape == (count, 1) else array
    return fields


# Written here, not by meshio, which writes to named files only.

_BLOCK = 1 << 20  # bytes that are compressed together


def write_vtu(file: IO[bytes], mesh: FileMesh) -> None:
    """Write an unstructured grid, compressed; points without cells as a cell each."""
    count = len(mesh.points)
    cells = next(iter(mesh.cells.values()), np.arange(count)[:, None])
    number, size = cells.shape
    offsets = np.arange(1, number + 1) * size
    types = np.full(number, _WRITTEN[size], dtype=np.uint8)
    kind = (
        'type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        'header_type="UInt64" compressor="vtkZLibDataCompressor"'
    )
    parts = [
        '<?xml version="1.0"?>',
        f"<VTKFile {kind}>",
        "<UnstructuredGrid>",
        f'<Piece NumberOfPoints="{count}" NumberOfCells="{number}">',
        "<Points>",
        _data_array("Points", mesh.points),
        "</Points>",
        "<Cells>",
        _data_array("connectivity", cells.astype(np.int64).ravel()),
        _data_array("offsets", offsets.astype(np.int64)),
        _data_array("types", types),
        "</Cells>",
    ]
    if mesh.fields:
        fields = [_data_array(name, array) for name, array in mesh.fields.items()]
        parts += ["<PointData>", *fields, "</PointData>"]
    parts += ["</Piece>", "</UnstructuredGrid>", "</VTKFile>", ""]
    file.write("\n".join(parts).encode())


def _data_array(name: str, array: NDArray[Any]) -> str:
    kinds = {"u": "UInt", "i": "Int", "f": "Float", "b": "UInt"}
    if array.dtype.kind == "f" and array.dtype.itemsize not in (4, 8):
        array = array.astype(np.float64)
    kind = f"{kinds[array.dtype.kind]}{8 * array.dtype.itemsize}"
    width = 1 if array.ndim == 1 else array.shape[1]
    data = array.astype(array.dtype.newbyteorder("<")).tobytes()
    blocks = [data[i : i + _BLOCK] for i in range(0, len(data), _BLOCK)]
    packed = [zlib.compress(block) for block in blocks]
    sizes = [len(blocks), _BLOCK, len(data) % _BLOCK, *map(len, packed)]
    header = base64.b64encode(np.array(sizes, dtype="<u8").tobytes()).decode()
    body = base64.b64encode(b"".join(packed)).decode()
    return (
        f"<DataArray type={quoteattr(kind)} Name={quoteattr(name)} "
        f'NumberOfComponents="{width}" format="binary">{header}{body}</DataArray>'
    )
