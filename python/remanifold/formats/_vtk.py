# SPDX-License-Identifier: GPL-3.0-or-later
"""Legacy VTK files: polygonal data and unstructured grids, versions 1 to 5."""

from __future__ import annotations

import re
from typing import IO, Any, NoReturn
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from remanifold.formats._mesh import (
    Faces,
    FileMesh,
    check_corners,
    polyline_edges,
    simplex_name,
    simplices_of_faces,
    strip_triangles,
)
from remanifold.formats._source import FloatArray, IntArray, Source

_TYPES = {
    "bit": "u1",
    "unsigned_char": "u1",
    "char": "i1",
    "unsigned_short": "u2",
    "short": "i2",
    "unsigned_int": "u4",
    "int": "i4",
    "unsigned_long": "u8",
    "long": "i8",
    "vtktypeint64": "i8",
    "vtkidtype": "i4",
    "float": "f4",
    "double": "f8",
}
_NAMES = {
    "b1": "unsigned_char",
    "u1": "unsigned_char",
    "i1": "char",
    "i2": "short",
    "u2": "unsigned_short",
    "i4": "int",
    "u4": "unsigned_int",
    "i8": "long",
    "u8": "unsigned_long",
    "f4": "float",
    "f8": "double",
}
# Cell types: vertices, edges, polylines, triangles, polygons, tetrahedra.
VERTICES, LINE, POLYLINE, TRIANGLE, POLYGON, QUAD, TETRA = (1, 2), 3, 4, 5, 7, 9, 10
EMPTY, STRIP, PIXEL = 0, 6, 8
# Cells with nodes on their edges, cut so that all nodes are used: what they become and
# its corners. The inner edge of a tetrahedron goes from the middle of 01 to that of 23.
_SPLIT: dict[int, tuple[int, list[list[int]]]] = {
    PIXEL: (QUAD, [[0, 1, 3, 2]]),
    21: (LINE, [[0, 2], [2, 1]]),
    22: (TRIANGLE, [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]]),
    23: (
        TRIANGLE,
        [[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 6], [4, 6, 7]],
    ),
    24: (
        TETRA,
        [
            *([0, 4, 6, 7], [4, 1, 5, 8], [6, 5, 2, 9], [7, 8, 9, 3]),
            *([4, 5, 6, 9], [4, 6, 7, 9], [4, 7, 8, 9], [4, 8, 5, 9]),
        ],
    ),
}
_NODES = {PIXEL: 4, 21: 3, 22: 6, 23: 8, 24: 10}
# What cells that are no simplices are called, and by what they become some.
_OTHERS = {
    11: "voxels",
    12: "hexahedra",
    13: "wedges",
    14: "pyramids",
    15: "prisms",
    16: "prisms",
    25: "quadratic hexahedra",
    26: "quadratic wedges",
    27: "quadratic pyramids",
    42: "polyhedra",
}
_WRITTEN = {2: LINE, 3: TRIANGLE, 4: TETRA}
WIDTHS = ("1", "2", "3", "4")  # of SCALARS, where it is said
_WORD = re.compile(rb"\s*(\S+)")


def read_vtk(source: Source, with_fields: bool) -> FileMesh:
    """Read points, cells, and what is said about the points."""
    return _Reader(source).read(with_fields)


class _Reader:
    """Goes through the words of a file; arrays are taken as a whole."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.data = source.data
        header = re.match(
            rb"# vtk DataFile[^\n]*\n[^\n]*\n\s*(ASCII|BINARY)\s", self.data
        )
        if header is None:
            source.fail("expected a legacy VTK file, starting with '# vtk DataFile'")
        self.binary = header[1] == b"BINARY"
        self.position = header.end()

    def read(self, with_fields: bool) -> FileMesh:
        mesh: FileMesh | None = None
        kinds: dict[str, Faces] = {}
        types: IntArray | None = None
        while (word := self._word()) is not None:
            key = word.upper()
            if key == "POINTS":
                mesh = FileMesh(self._points())
                if not (with_fields or self.source.cells):
                    return mesh
            elif key in ("VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS", "CELLS"):
                kinds[key] = self._faces(key)
            elif key == "CELL_TYPES":
                types = self._array("int", self._count()).astype(np.int64)
            elif key == "METADATA":
                self._skip_metadata()
            elif key == "POINT_DATA" and mesh is not None:
                count = self._count()
                if count != len(mesh.points):
                    self._fail(f"has {count:,} values for {len(mesh.points):,} points")
                mesh.fields = self._attributes(count)
            elif key == "CELL_DATA":
                self._attributes(self._count())
            elif key == "DATASET":
                self._dataset()
            elif key == "FIELD":
                self._field_data(None)
            else:
                self._fail(f"expected a keyword such as POINTS, found {word[:60]!r}")
        if mesh is None:
            self._fail("expected a line 'POINTS n type', found none")
        if self.source.cells:
            mesh.cells = _cells(self.source, mesh.points, kinds, types)
        return mesh

    def _fail(self, what: str) -> NoReturn:
        if self.binary:
            self.source.fail(what)
        line = self.data.count(b"\n", 0, self.position) + 1
        self.source.fail(what, line=line)

    def _word(self) -> str | None:
        found = _WORD.match(self.data, self.position)
        if found is None:
            return None
        self.position = found.end()
        return found[1][:200].decode("ascii", "replace")

    def _need(self) -> str:
        word = self._word()
        if word is None:
            self._fail("is truncated")
        return word

    def _count(self) -> int:
        word = self._need()
        if not (word.isascii() and word.isdecimal()) or len(word) > 15:
            self._fail(f"expected a count, found {word[:60]!r}")
        return int(word)

    def _end_line(self) -> None:
        """Binary data begin after the end of the line."""
        end = self.data.find(b"\n", self.position)
        self.position = len(self.data) if end < 0 else end + 1

    def _dataset(self) -> None:
        name = self._need().upper()
        if name not in ("POLYDATA", "UNSTRUCTURED_GRID"):
            what = "expected DATASET POLYDATA or UNSTRUCTURED_GRID"
            remedy = "save it as one of these"
            self._fail(f"{what}, found {name[:60]!r}; {remedy}")

    def _points(self) -> FloatArray:
        count, kind = self._count(), self._need().lower()
        if kind not in ("float", "double"):
            self._fail(f"expected points of type float or double, found {kind[:60]}")
        try:
            points = self._array(kind, 3 * count, exact=True)
        except _TruncatedError as error:
            what = f"expected {count:,} points, found {error.found // 3:,}"
            self.source.fail(f"is truncated: {what}")
        return points.reshape(-1, 3).astype(np.float64)

    def _array(self, kind: str, size: int, exact: bool = False) -> NDArray[Any]:
        try:
            return self._binary(kind, size) if self.binary else self._text(kind, size)
        except _TruncatedError as error:
            if exact:
                raise
            what = f"expected {size} numbers, found {error.found}"
            self.source.fail(f"is truncated: {what}")

    def _binary(self, kind: str, size: int) -> NDArray[Any]:
        if kind not in _TYPES:
            self._fail(f"holds numbers of type {kind[:60]!r}")
        self._end_line()
        dtype = np.dtype(">" + _TYPES[kind])
        held = (len(self.data) - self.position) // dtype.itemsize
        if kind == "bit":
            size = (size + 7) // 8
        if held < size:
            raise _TruncatedError(held)
        values = np.frombuffer(self.data, dtype, size, self.position)
        self.position += size * dtype.itemsize
        return values.astype(dtype.newbyteorder("="))

    def _text(self, kind: str, size: int) -> NDArray[Any]:
        """Read words up to the number asked for, from lines that hold numbers only."""
        if kind not in _TYPES:
            self._fail(f"holds numbers of type {kind[:60]!r}")
        values: list[float] = []
        while len(values) < size:
            found = re.compile(rb"\s*([^\n]*\S)").match(self.data, self.position)
            if found is None:
                raise _TruncatedError(len(values))
            words = found[1].decode("ascii", "replace").split()
            taken = words[: size - len(values)]
            self.position = found.start(1)
            try:
                numbers = [float(word) for word in taken]
            except ValueError:
                shown = " ".join(taken)[:60]
                self._fail(f"expected {len(taken)} numbers, found {shown!r}")
            values += numbers
            if len(taken) == len(words):
                self.position = found.end()
            else:
                for _ in taken:
                    self._word()
        with np.errstate(invalid="ignore", over="ignore"):
            array = np.array(values, dtype=np.float64)
            kind = _TYPES[kind]
            return array if kind[0] == "f" else array.astype(kind)

    def _faces(self, key: str) -> Faces:
        """Read cells: sizes among the corners, or since version 5 offsets before."""
        first, second = self._count(), self._count()
        mark = self.position
        word = self._word()
        if word is None or word.upper() != "OFFSETS":
            self.position = mark
            flat = self._array("int", second).astype(np.int64)
            return self._with_sizes(key, flat, first)
        offsets = self._array(self._need().lower(), first).astype(np.int64)
        if self._need().upper() != "CONNECTIVITY":
            self._fail("expected CONNECTIVITY after OFFSETS")
        corners = self._array(self._need().lower(), second).astype(np.int64)
        sizes = np.diff(offsets)
        if first and (offsets[0] or offsets[-1] != second or (sizes < 0).any()):
            self._fail(f"the offsets of {key} do not fit their corners")
        return Faces(corners, sizes)

    def _with_sizes(self, key: str, flat: IntArray, count: int) -> Faces:
        starts = np.empty(count, dtype=np.int64) if count <= len(flat) else None
        if starts is None:
            self._fail(f"{key} holds fewer numbers than cells")
        position = 0
        sizes = flat.tolist()
        for i in range(count):
            if position >= len(sizes) or sizes[position] < 0:
                self._fail(f"the sizes of {key} do not fit their corners")
            starts[i] = position
            position += sizes[position] + 1
        if position != len(flat):
            self._fail(f"the sizes of {key} do not fit their corners")
        return Faces(np.delete(flat, starts), flat[starts])

    def _skip_metadata(self) -> None:
        """Metadata end with an empty line."""
        end = re.compile(rb"\n[ \t\r]*\n").search(self.data, self.position)
        self.position = len(self.data) if end is None else end.end()

    def _attributes(self, count: int) -> dict[str, NDArray[Any]]:
        """Read what is said about points or cells."""
        fields: dict[str, NDArray[Any]] = {}
        while True:
            mark, word = self.position, self._word()
            key = "" if word is None else word.upper()
            if key == "SCALARS":
                name, kind = unquote(self._need()), self._need().lower()
                width = self._optional(WIDTHS)
                if self._optional(("LOOKUP_TABLE",)):
                    self._need()
                fields[name] = self._values(kind, count, int(width or 1))
            elif key in ("VECTORS", "NORMALS"):
                name, kind = unquote(self._need()), self._need().lower()
                fields[name] = self._values(kind, count, 3)
            elif key == "FIELD":
                fields |= self._field_data(count)
            elif key == "METADATA":
                self._skip_metadata()
            elif key in ("POINT_DATA", "CELL_DATA", ""):
                self.position = mark
                return fields
            else:  # what none needs here, and of unknown length
                self.position = len(self.data)
                return fields

    def _optional(self, words: tuple[str, ...]) -> str | None:
        """Read a word if it is one of these."""
        mark, word = self.position, self._word()
        if word is not None and word.upper() in words:
            return word
        self.position = mark
        return None

    def _field_data(self, count: int | None) -> dict[str, NDArray[Any]]:
        """Read named arrays, all of the same length unless they belong to the file."""
        fields = {}
        self._need()
        for _ in range(self._count()):
            while self._optional(("METADATA",)):
                self._skip_metadata()
            name = unquote(self._need())
            width, length, kind = self._count(), self._count(), self._need().lower()
            if count is not None and length != count:
                self._fail(f"{name[:60]!r} has {length:,} values, expected {count:,}")
            fields[name] = self._values(kind, length, width)
        return fields

    def _values(self, kind: str, count: int, width: int) -> NDArray[Any]:
        values = self._array(kind, width * count)
        if kind == "bit" and self.binary:
            values = np.unpackbits(values)[: width * count]
        return values if width == 1 else values.reshape(count, width)


class _TruncatedError(Exception):
    def __init__(self, found: int) -> None:
        super().__init__()
        self.found = found


def _cells(
    source: Source, points: FloatArray, kinds: dict[str, Faces], types: IntArray | None
) -> dict[int, IntArray]:
    cells: dict[int, IntArray] = {}
    if "CELLS" in kinds:
        faces = kinds["CELLS"]
        if types is None or len(types) != len(faces.sizes):
            source.fail("expected as many CELL_TYPES as CELLS")
        return cells_of_grid(source, points, faces, types)
    if "POLYGONS" in kinds:
        cells = simplices_of_faces(source, points, kinds["POLYGONS"])
    if "TRIANGLE_STRIPS" in kinds:
        strips = kinds["TRIANGLE_STRIPS"]
        check_corners(source, strips.corners, len(points))
        held = [cells[3]] if 3 in cells else []
        cells[3] = np.concatenate([*held, strip_triangles(strips)])
    if "LINES" in kinds:
        cells[2] = _edges(source, kinds["LINES"], len(points))
    return cells


def _edges(source: Source, faces: Faces, num_points: int) -> IntArray:
    check_corners(source, faces.corners, num_points)
    if (faces.sizes == 2).all():
        return faces.corners.reshape(-1, 2)
    ends = np.cumsum(faces.sizes)[:-1]
    return polyline_edges([part.tolist() for part in np.split(faces.corners, ends)])


def cells_of_grid(
    source: Source, points: FloatArray, faces: Faces, types: IntArray
) -> dict[int, IntArray]:
    """Simplices of an unstructured grid, by the numbers VTK gives to types of cells."""
    check_corners(source, faces.corners, len(points))
    faces, types = _simplified(source, faces, types)
    known = (EMPTY, *VERTICES, LINE, POLYLINE, TRIANGLE, POLYGON, QUAD, TETRA)
    wrong = ~np.isin(types, known)
    if wrong.any():
        kind = int(types[wrong][0])
        name = _OTHERS.get(kind, "cells")
        source.fail(
            f"holds {name} (VTK's type {kind}); only edges, polygons and "
            f"{simplex_name(3)} can be read: triangulate it first, in ParaView by "
            "Tetrahedralize, in PyVista by triangulate()"
        )
    for kind, size in ((LINE, 2), (TRIANGLE, 3), (QUAD, 4), (TETRA, 4)):
        if (faces.sizes[types == kind] != size).any():
            source.fail(f"holds a cell of type {kind} that has not {size} corners")
    cells: dict[int, IntArray] = {}
    starts = np.cumsum(faces.sizes) - faces.sizes
    flat = np.isin(types, (TRIANGLE, POLYGON, QUAD))
    if flat.any():
        cells |= simplices_of_faces(source, points, _some(faces, flat))
    lines = np.isin(types, (LINE, POLYLINE))
    if lines.any():
        cells[2] = _edges(source, _some(faces, lines), len(points))
    solid = types == TETRA
    if solid.any():
        cells[4] = faces.corners[starts[solid][:, None] + np.arange(4)]
    return cells


def _simplified(
    source: Source, faces: Faces, types: IntArray
) -> tuple[Faces, IntArray]:
    """Strips and cells with more nodes than corners as several simple ones, at the end."""
    unusual = np.isin(types, (STRIP, *_SPLIT))
    if not unusual.any():
        return faces, types
    kept = _some(faces, ~unusual)
    corners, sizes, kinds = [kept.corners], [kept.sizes], [types[~unusual]]
    for kind in np.unique(types[unusual]).tolist():
        chosen = _some(faces, types == kind)
        if kind == STRIP:
            becomes, rows = TRIANGLE, strip_triangles(chosen)
        else:
            becomes, places = _SPLIT[kind]
            if (chosen.sizes != _NODES[kind]).any():
                what = f"a cell of type {kind} that has not {_NODES[kind]} nodes"
                source.fail(f"holds {what}")
            nodes = chosen.corners.reshape(-1, _NODES[kind])
            rows = nodes[:, places].reshape(-1, len(places[0]))
        corners.append(rows.ravel())
        sizes.append(np.full(len(rows), rows.shape[1], dtype=np.int64))
        kinds.append(np.full(len(rows), becomes, dtype=np.int64))
    simple = Faces(np.concatenate(corners), np.concatenate(sizes))
    return simple, np.concatenate(kinds)


def _some(faces: Faces, wanted: NDArray[np.bool_]) -> Faces:
    return Faces(faces.corners[np.repeat(wanted, faces.sizes)], faces.sizes[wanted])


_LONGEST_TITLE = 250


def write_vtk(file: IO[bytes], mesh: FileMesh) -> None:
    """Write a binary unstructured grid; points without cells as a cell each."""
    count = len(mesh.points)
    # A line of at most 256 characters.
    brief = [line for line in mesh.comment if line.startswith(("input", "output"))]
    title = ", ".join([*mesh.comment[:1], *brief])[:_LONGEST_TITLE] or "remanifold"
    file.write(f"# vtk DataFile Version 4.2\n{title}\nBINARY\n".encode())
    file.write(f"DATASET UNSTRUCTURED_GRID\nPOINTS {count} double\n".encode())
    file.write(mesh.points.astype(">f8").tobytes())
    cells, kind = np.arange(count)[:, None], VERTICES[0]
    for size, held in mesh.cells.items():
        cells, kind = held, _WRITTEN[size]
    number, size = cells.shape
    rows = np.column_stack([np.full(number, size), cells])
    file.write(f"\nCELLS {number} {rows.size}\n".encode())
    file.write(rows.astype(">i4").tobytes())
    file.write(f"\nCELL_TYPES {number}\n".encode())
    file.write(np.full(number, kind, dtype=">i4").tobytes())
    file.write(b"\n")
    if not mesh.fields:
        return
    file.write(f"POINT_DATA {count}\nFIELD fields {len(mesh.fields)}\n".encode())
    for name, array in mesh.fields.items():
        values = array if array.dtype.str[1:] in _NAMES else array.astype(np.float64)
        word = _NAMES[values.dtype.str[1:]]
        width = 1 if values.ndim == 1 else values.shape[1]
        file.write(f"{_quoted(name)} {width} {count} {word}\n".encode())
        file.write(values.astype(values.dtype.newbyteorder(">")).tobytes() + b"\n")


def _quoted(name: str) -> str:
    """Write blanks and the like as VTK does, as %20."""
    kept = (c if 33 <= ord(c) < 127 and c not in '%"' else None for c in name)
    return "".join(
        c if c is not None else "".join(f"%{byte:02X}" for byte in name[i].encode())
        for i, c in enumerate(kept)
    )
