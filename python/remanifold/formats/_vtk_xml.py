# SPDX-License-Identifier: GPL-3.0-or-later
"""VTK's XML files: polygons (.vtp) and unstructured grids (.vtu)."""

from __future__ import annotations

import base64
import binascii
import lzma
import re
import zlib
from html import escape
from typing import IO, Any
from xml.etree import ElementTree as ET

import numpy as np
from numpy.typing import NDArray

from remanifold.formats._mesh import Faces, FileMesh
from remanifold.formats._source import FloatArray, IntArray, Source
from remanifold.formats._vtk import (
    LINE,
    POLYGON,
    POLYLINE,
    STRIP,
    TETRA,
    TRIANGLE,
    cells_of_grid,
)

_TYPES = {
    **{f"Int{8 * size}": f"i{size}" for size in (1, 2, 4, 8)},
    **{f"UInt{8 * size}": f"u{size}" for size in (1, 2, 4, 8)},
    "Float32": "f4",
    "Float64": "f8",
}
_ENCODINGS = ("ascii", "utf-16-le", "utf-16-be")
_COMPRESSORS = ("", "vtkZLibDataCompressor", "vtkLZMADataCompressor")
# Kinds of cells of a .vtp file, and what they are among those of a grid.
_KINDS = {"Lines": POLYLINE, "Strips": STRIP, "Polys": POLYGON}
_WRITTEN = {1: 1, 2: LINE, 3: TRIANGLE, 4: TETRA}


def read_vtp(source: Source, with_fields: bool) -> FileMesh:
    """Read points, polygons, lines and strips, and what is said about the points."""
    return _Reader(source, "PolyData").read(with_fields)


def read_vtu(source: Source, with_fields: bool) -> FileMesh:
    """Read points, cells, and what is said about the points."""
    return _Reader(source, "UnstructuredGrid").read(with_fields)


class _Reader:
    """The parsed file and its arrays."""

    def __init__(self, source: Source, kind: str) -> None:
        self.source = source
        self.kind = kind
        # Appended data may be bytes as they are, which no XML has.
        found = re.search(rb"<AppendedData([^>]*)>\s*_", source.data)
        text, self.appended, self.raw = source.data, b"", False
        if found is not None:
            end = source.data.rfind(b"</AppendedData")
            if end < found.end():
                source.fail("is truncated: its appended data have no end")
            self.appended = source.data[found.end() : end]
            self.raw = b"raw" in found[1]
            text = source.data[: found.end()] + source.data[end:]
        # VTK writes none, and entities are how little text becomes much.
        if any("<!DOCTYPE".encode(code) in text for code in _ENCODINGS):
            source.fail("is no VTK file: it declares a type of document")
        try:
            self.root = ET.fromstring(text)
        except (ET.ParseError, ValueError, LookupError) as error:
            reason = " ".join(str(error).split())
            source.fail(f"is damaged, truncated or no XML file ({reason})", error)
        found_kind = self.root.get("type")
        if self.root.tag != "VTKFile" or found_kind != kind:
            what = f"<{self.root.tag[:40]}> of type {found_kind!r}"
            source.fail(f"is damaged, truncated or of another kind: {what}, not {kind}")
        order = self.root.get("byte_order", "LittleEndian")
        self.order = ">" if order == "BigEndian" else "<"
        self.word = np.dtype(
            self.order + _TYPES.get(self.root.get("header_type", "UInt32"), "u4")
        )
        self.compressor = self.root.get("compressor", "")
        if self.compressor not in _COMPRESSORS:
            source.fail(
                f"is compressed by {self.compressor[:60]}, which is not read; save it "
                "with ZLib"
            )

    def read(self, with_fields: bool) -> FileMesh:
        pieces = self.root.findall(f"{self.kind}/Piece")
        if not pieces:
            self.source.fail("is damaged or truncated: it has no pieces")
        parts = [self._piece(piece, with_fields) for piece in pieces]
        mesh = FileMesh(np.concatenate([part.points for part in parts]))
        start = 0
        for part in parts:
            for size, held in part.cells.items():
                before = mesh.cells.get(size, np.empty((0, size), dtype=np.int64))
                mesh.cells[size] = np.concatenate([before, held + start])
            start += len(part.points)
        for name, first in parts[0].fields.items():
            values = [part.fields.get(name) for part in parts]
            if all(v is not None and v.shape[1:] == first.shape[1:] for v in values):
                mesh.fields[name] = np.concatenate(values)  # type: ignore[arg-type]
        return mesh

    def _piece(self, piece: ET.Element, with_fields: bool) -> FileMesh:
        count = self._count(piece, "NumberOfPoints")
        array = piece.find("Points/DataArray")
        points: FloatArray = np.empty((0, 3))
        if array is not None and count:
            points = self._array(array, count, 3).astype(np.float64)
        elif count:
            self.source.fail("is damaged or truncated: it has no points")
        mesh = FileMesh(points)
        if self.source.cells:
            faces, types = self._cells(piece)
            mesh.cells = cells_of_grid(self.source, points, faces, types)
        data = piece.findall("PointData/DataArray") if with_fields else []
        for array in data:
            name = array.get("Name", "")
            width = self._count(array, "NumberOfComponents", 1) or 1
            values = self._array(array, count, width)
            if name:
                mesh.fields[name] = values.ravel() if width == 1 else values
        return mesh

    def _count(self, element: ET.Element, key: str, usual: int = 0) -> int:
        text = element.get(key, str(usual)).strip()
        if not (text.isascii() and text.isdecimal()) or len(text) > 15:
            self.source.fail(f"expected a count for {key}, found {text[:60]!r}")
        return int(text)

    def _cells(self, piece: ET.Element) -> tuple[Faces, IntArray]:
        groups: list[tuple[Faces, IntArray]] = []
        if self.kind == "UnstructuredGrid":
            number = self._count(piece, "NumberOfCells")
            faces = self._faces(piece.find("Cells"), number)
            if number == 0:
                return faces, np.empty(0, dtype=np.int64)
            array = piece.find("Cells/DataArray[@Name='types']")
            if array is None:
                self.source.fail("is damaged or truncated: its cells have no types")
            groups.append(
                (faces, self._array(array, number, 1).ravel().astype(np.int64))
            )
        else:
            for name, kind in _KINDS.items():
                number = self._count(piece, f"NumberOf{name}")
                faces = self._faces(piece.find(name), number)
                groups.append((faces, np.full(number, kind, dtype=np.int64)))
        faces = Faces(
            np.concatenate([faces.corners for faces, _ in groups]),
            np.concatenate([faces.sizes for faces, _ in groups]),
        )
        return faces, np.concatenate([types for _, types in groups])

    def _faces(self, cells: ET.Element | None, number: int) -> Faces:
        if number == 0:
            none = np.empty(0, dtype=np.int64)
            return Faces(none, none)
        arrays = {} if cells is None else {a.get("Name"): a for a in cells}
        if not {"connectivity", "offsets"} <= {*arrays}:
            self.source.fail("is damaged or truncated: its cells have no corners")
        ends = self._array(arrays["offsets"], number, 1).ravel().astype(np.int64)
        sizes = np.diff(ends, prepend=0)
        if (sizes < 0).any():
            self.source.fail("is damaged: the offsets of its cells do not ascend")
        corners = self._array(arrays["connectivity"], int(ends[-1]), 1)
        return Faces(corners.ravel().astype(np.int64), sizes)

    def _array(self, array: ET.Element, rows: int, width: int) -> NDArray[Any]:
        """Numbers of a DataArray, in so many rows and columns."""
        name = array.get("Name", "Points")[:60]
        kind = _TYPES.get(array.get("type", ""))
        if kind is None:
            what = f"{name!r} holds {array.get('type', 'nothing')[:40]}"
            self.source.fail(f"{what}, expected numbers")
        expected = rows * width
        form = array.get("format", "ascii")
        if form == "ascii":
            words = (array.text or "").split()
            try:
                numbers = np.array(
                    words, dtype=np.float64 if kind[0] == "f" else object
                )
                with np.errstate(over="ignore"):
                    values = numbers.astype(kind)
            except (ValueError, OverflowError) as error:
                self.source.fail(f"{name!r} holds what is no number ({error})", error)
        else:
            try:
                # One block more than there should be tells that there are too many.
                data = self._bytes(array, form, expected * np.dtype(kind).itemsize)
            except (ValueError, zlib.error, lzma.LZMAError, binascii.Error) as error:
                what = f"the data of {name!r} cannot be read ({error})"
                self.source.fail(f"is damaged or truncated: {what}", error)
            dtype = np.dtype(self.order + kind)
            whole = len(data) // dtype.itemsize * dtype.itemsize
            values = np.frombuffer(data[:whole], dtype).astype(kind)
        if len(values) != expected:
            what = f"expected {expected:,} numbers in {name!r}, found {len(values):,}"
            self.source.fail(f"is damaged or truncated: {what}")
        return values.reshape(rows, width)

    def _bytes(self, array: ET.Element, form: str, wanted: int) -> bytes:
        if form == "appended":
            data = self.appended[self._count(array, "offset") :]
            if self.raw:
                return self._unpacked(data, wanted)
        elif form == "binary":
            data = "".join((array.text or "").split()).encode("ascii", "replace")
        else:
            msg = f"format {form[:40]!r}"
            raise ValueError(msg)
        # Base64 of the header, then of the rest; together where nothing is compressed.
        header = self._header_size(_decoded(data, 3 * self.word.itemsize))
        if not self.compressor:
            size = int(self._words(_decoded(data, self.word.itemsize), 1)[0])
            whole = _decoded(data, header + min(size, len(data)))
            return self._unpacked(whole, wanted)
        start = -(-header // 3) * 4
        head = _decoded(data[:start], header)
        total = int(self._words(head, header // self.word.itemsize)[3:].sum())
        rest = _decoded(data[start:], min(total, len(data)))
        return self._unpacked(head + rest, wanted)

    def _header_size(self, start: bytes) -> int:
        """Bytes before the data: their size, or the numbers and sizes of blocks."""
        if not self.compressor:
            return self.word.itemsize
        blocks = int(self._words(start, 1)[0])
        if blocks > len(self.source.data):
            msg = f"{blocks} blocks"
            raise ValueError(msg)
        return (3 + blocks) * self.word.itemsize

    def _words(self, data: bytes, count: int) -> NDArray[np.int64]:
        if len(data) < count * self.word.itemsize:
            msg = "it ends too early"
            raise ValueError(msg)
        found = np.frombuffer(data, self.word, count).astype(np.int64)
        if (found < 0).any() or (found > 1 << 40).any():
            msg = "sizes make no sense"
            raise ValueError(msg)
        return found

    def _unpacked(self, data: bytes, wanted: int) -> bytes:
        header = self._header_size(data)
        numbers = self._words(data, header // self.word.itemsize)
        if not self.compressor:
            size = int(numbers[0])
            if len(data) < header + size:
                msg = f"expected {size:,} bytes, found {len(data) - header:,}"
                raise ValueError(msg)
            return data[header : header + size]
        size, parts, place = int(numbers[1]), [], header
        found = 0
        for length in numbers[3:].tolist():
            part = data[place : place + length]
            place += length
            if self.compressor == "vtkZLibDataCompressor":
                unpacked = zlib.decompressobj().decompress(part, max(size, 1))
            else:
                unpacked = lzma.LZMADecompressor().decompress(part, max(size, 1))
            parts.append(unpacked)
            found += len(unpacked)
            if found > wanted:
                break
        return b"".join(parts)


def _decoded(data: bytes, size: int) -> bytes:
    """The first bytes that base64 stands for."""
    return base64.b64decode(data[: -(-size // 3) * 4], validate=True)[:size]


# Written here, not by meshio, which writes to named files only.

_BLOCK = 1 << 20  # bytes that are compressed together


def write_vtu(file: IO[bytes], mesh: FileMesh) -> None:
    """Write an unstructured grid, compressed; points without cells as a cell each."""
    count = len(mesh.points)
    cells = next(iter(mesh.cells.values()), np.arange(count)[:, None])
    number, size = cells.shape
    types = np.full(number, _WRITTEN[size], dtype=np.uint8)
    piece = f'<Piece NumberOfPoints="{count}" NumberOfCells="{number}">'
    parts = ["<Cells>", *_corners(cells), _data_array("types", types), "</Cells>"]
    _write(file, "UnstructuredGrid", piece, parts, mesh)


def write_vtp(file: IO[bytes], mesh: FileMesh) -> None:
    """Write polygons or lines, compressed; points without cells as a vertex each."""
    count = len(mesh.points)
    cells = next(iter(mesh.cells.values()), np.arange(count)[:, None])
    number, size = cells.shape
    names = {1: "Verts", 2: "Lines", 3: "Polys"}
    counts = "".join(
        f' NumberOf{name}="{number if name == names[size] else 0}"'
        for name in ("Verts", "Lines", "Strips", "Polys")
    )
    piece = f'<Piece NumberOfPoints="{count}"{counts}>'
    name = names[size]
    _write(file, "PolyData", piece, [f"<{name}>", *_corners(cells), f"</{name}>"], mesh)


def _corners(cells: IntArray) -> list[str]:
    number, size = cells.shape
    offsets = np.arange(1, number + 1) * size
    return [
        _data_array("connectivity", cells.astype(np.int64).ravel()),
        _data_array("offsets", offsets.astype(np.int64)),
    ]


def _write(
    file: IO[bytes], kind: str, piece: str, cells: list[str], mesh: FileMesh
) -> None:
    settings = (
        f'type="{kind}" version="1.0" byte_order="LittleEndian" '
        'header_type="UInt64" compressor="vtkZLibDataCompressor"'
    )
    parts = [
        '<?xml version="1.0"?>',
        *_comment(mesh.comment),
        f"<VTKFile {settings}>",
        f"<{kind}>",
        piece,
        "<Points>",
        _data_array("Points", mesh.points),
        "</Points>",
        *cells,
    ]
    if mesh.fields:
        fields = [_data_array(name, array) for name, array in mesh.fields.items()]
        parts += ["<PointData>", *fields, "</PointData>"]
    parts += ["</Piece>", f"</{kind}>", "</VTKFile>", ""]
    file.write("\n".join(parts).encode())


def _comment(lines: list[str]) -> list[str]:
    """Of XML, in which no two hyphens may follow each other."""
    if not lines:
        return []
    text = "\n".join(line.replace("-", "&#45;") for line in lines)
    return [f"<!--\n{text}\n-->"]


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
        f'<DataArray type="{kind}" Name="{escape(name)}" '
        f'NumberOfComponents="{width}" format="binary">{header}{body}</DataArray>'
    )
