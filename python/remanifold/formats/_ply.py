# SPDX-License-Identifier: GPL-3.0-or-later
"""PLY: a text header describes elements, each a table of properties."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import IO, Any, Literal

import numpy as np
from numpy.typing import NDArray

from remanifold._base.colors import byte_colors
from remanifold.formats._columns import GROUPS, gathered, mesh_of_table
from remanifold.formats._mesh import (
    Faces,
    FileMesh,
    Table,
    check_corners,
    simplices_of_faces,
    strip_triangles,
)
from remanifold.formats._source import FloatArray, IntArray, Source

_TYPES = {
    name: kind
    for kind, names in {
        "i1": ["char", "int8"],
        "u1": ["uchar", "uint8"],
        "i2": ["short", "int16"],
        "u2": ["ushort", "uint16"],
        "i4": ["int", "int32"],
        "u4": ["uint", "uint32"],
        "i8": ["int64"],
        "u8": ["uint64"],
        "f4": ["float", "float32"],
        "f8": ["double", "float64"],
    }.items()
    for name in names
}
_ENCODINGS = {
    "ascii": "ascii",
    "binary_little_endian": "<",
    "binary_big_endian": ">",
}


@dataclass
class _Element:
    """Name, number of records, and properties: (name, type, type of the length)."""

    name: str
    count: int
    properties: list[tuple[str, str, str | None]] = field(default_factory=list)

    def has_lists(self) -> bool:
        return any(length is not None for _, _, length in self.properties)

    def least_size(self) -> int:
        """Bytes of a record whose lists are empty."""
        return sum(np.dtype(n or kind).itemsize for _, kind, n in self.properties)


@dataclass
class _Table:
    """Columns of an element: arrays, or Faces where the property is a list."""

    scalars: dict[str, NDArray[Any]]
    lists: dict[str, Faces]


def read_ply(source: Source, with_fields: bool) -> FileMesh:
    """Read vertices with their properties, edges, and faces."""
    with source.open() as file:
        encoding, elements, line, comments = _header(source, file)
        body = file.read()
    vertex = next((e for e in elements if e.name == "vertex"), None)
    if vertex is None:
        source.fail("expected an element 'vertex', found none")
    names = [name for name, _, _ in vertex.properties]
    axes = [axis for axis in "xyz" if axis in names]
    if len(axes) < 2 and source.columns is None:
        found = ", ".join(names) or "none"
        source.fail(f"expected vertex properties x, y, z, found {found}")
    reader = _Reader(source, body, encoding, line, elements)
    tables: dict[str, _Table] = {}
    waiting = list(elements)
    while waiting and (source.cells or "vertex" not in tables):
        element = waiting.pop(0)
        tables[element.name] = reader.element(element)
    reader.look_behind(waiting)
    scalars = tables["vertex"].scalars
    if source.columns is None and not {*axes} <= {*scalars}:
        source.fail("expected numbers x, y, z, found lists")
    table = Table([*scalars.values()], [*scalars])
    if source.columns is not None:
        mesh = mesh_of_table(source, table)
        axes = [axis for axis in axes if axis in scalars]
    else:
        columns = [scalars.pop(axis).astype(np.float64) for axis in axes]
        mesh = FileMesh(np.column_stack(columns).reshape(-1, len(axes)))
    if with_fields and source.columns is None:
        # What was written as a wider type than PLY has, by the comments.
        mesh.fields = gathered(_widened(scalars, comments))
    if source.cells:
        space = np.zeros((len(mesh.points), 3))
        for i, axis in enumerate(axes):
            space[:, i] = columns[i] if source.columns is None else scalars[axis]
        mesh.cells = _simplices(source, space, tables)
    return mesh


def _widened(
    scalars: dict[str, NDArray[Any]], comments: list[str]
) -> dict[str, NDArray[Any]]:
    """Whole numbers that `write_ply` wrote as doubles, for PLY has none of 64 bits."""
    wide = dict(scalars)
    for comment in comments:
        kind, _, name = comment.removeprefix(_WIDE).partition(" ")
        if not comment.startswith(_WIDE) or kind not in ("int64", "uint64"):
            continue
        values = wide.get(name)
        if values is not None and (np.abs(values) <= 2.0**53).all():
            wide[name] = values.astype(kind)
    return wide


def _simplices(
    source: Source, points: FloatArray, tables: dict[str, _Table]
) -> dict[int, IntArray]:
    cells: dict[int, IntArray] = {}
    lists = tables["face"].lists if "face" in tables else {}
    names = [n for n in ("vertex_indices", "vertex_index") if n in lists]
    if names:
        faces = lists[names[0]]
        cells = simplices_of_faces(source, points, faces)
    for strips in tables["tristrips"].lists.values() if "tristrips" in tables else ():
        held = strips.corners[strips.corners != -1]
        check_corners(source, held, len(points))
        cells[3] = np.vstack(
            [*([cells[3]] if 3 in cells else []), strip_triangles(strips)]
        )
    edges = tables["edge"].scalars if "edge" in tables else {}
    if {"vertex1", "vertex2"} <= {*edges}:
        pairs = np.column_stack([edges["vertex1"], edges["vertex2"]]).astype(np.int64)
        check_corners(source, pairs, len(points))
        cells[2] = np.vstack([pairs, *([cells[2]] if 2 in cells else [])])
    return cells


def _header(
    source: Source, file: IO[bytes]
) -> tuple[str, list[_Element], int, list[str]]:
    """Read up to 'end_header': byte order or 'ascii', elements, lines, comments."""
    if file.readline(64).rstrip() != b"ply":
        source.fail("expected a PLY file, whose first line is 'ply'", line=1)
    encoding = None
    elements: list[_Element] = []
    comments: list[str] = []
    line, words = 1, [""]
    while words != ["end_header"]:
        line += 1
        text = file.readline().decode("ascii", "replace")
        if not text:
            source.fail("is truncated: the header has no 'end_header'")
        words = text.split()
        match words:
            case ["format", name, _] if name in _ENCODINGS:
                encoding = _ENCODINGS[name]
            case ["element", name, count]:
                elements.append(_Element(name, source.count(line, count)))
            case ["property", "list", length, kind, name] if (
                elements and _TYPES.get(length, "f")[0] != "f" and kind in _TYPES
            ):
                types = _TYPES[kind], _TYPES[length]
                elements[-1].properties.append((name, *types))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1].properties.append((name, _TYPES[kind], None))
            case ["comment", *said]:
                comments.append(" ".join(said))
            case [] | ["end_header"] | ["obj_info", *_]:
                pass
            case _:
                what = f"no valid line of a PLY header: {text.strip()[:60]!r}"
                source.fail(what, line=line)
    if encoding is None:
        source.fail("expected a line 'format ...' in the header")
    for element in elements:
        names = [name for name, _, _ in element.properties]
        if len(names) > len({*names}):
            source.fail(f"the element '{element.name}' has a property twice")
    return encoding, elements, line, comments


class _Reader:
    """Reads one element after the other."""

    def __init__(
        self,
        source: Source,
        body: bytes,
        order: str,
        line: int,
        elements: list[_Element],
    ) -> None:
        self.source = source
        self.elements = elements
        self.body = body
        self.order = order  # of the bytes, or "ascii"
        self.line = line
        self.position = 0

    def element(self, element: _Element) -> _Table:
        if self.order == "ascii":
            return self._text(element)
        if not element.has_lists():
            return self._fixed(element)
        return self._same_lengths(element) or self._lists(element)

    def look_behind(self, unread: list[_Element]) -> None:
        """Say so where what is there is not what the header tells of."""
        if self.order == "ascii":
            rest = self.body[self.position :].splitlines()
            lines = sum(bool(line.strip()) for line in rest)
            left = lines - sum(element.count for element in unread)
            what = "line"
        else:
            for element in unread:
                self._skip(element)
            left = len(self.body) - self.position
            what = "byte"
            # Some programs end a file by a line break.
            if left > 0 and not self.body[self.position :].strip(b"\r\n\0 "):
                left = 0
        if left == 0:
            return
        told = ", ".join(f"{e.count:,} of '{e.name}'" for e in self.elements)
        found = (
            f"{left:,} {what}{'' if left == 1 else 's'} more"
            if left > 0
            else "less, or something else,"
        )
        self.source.guess(
            f"holds {found} than its header tells of ({told}): what is read may be a part "
            "of it; if the counts are wrong, mend them"
        )

    def _skip(self, element: _Element) -> None:
        """Go past an element; beyond the end where there is not so much."""
        if not element.has_lists():
            self.position += element.count * element.least_size()
            return
        start = self.position
        with contextlib.suppress(ValueError):
            if self._same_lengths(element) is not None:
                return
        body = self.body
        order: Literal["little", "big"] = "little" if self.order == "<" else "big"
        sizes = [
            (
                0 if length is None else np.dtype(length).itemsize,
                np.dtype(kind).itemsize,
            )
            for _, kind, length in element.properties
        ]
        place = start
        for _ in range(element.count):
            for width, size in sizes:
                number = (
                    int.from_bytes(body[place : place + width], order) if width else 1
                )
                place += width + number * size
            if place > len(body):
                break
        self.position = place

    def _truncated(self, element: _Element, found: int) -> None:
        kind = {"vertex": "vertices", "face": "faces", "edge": "edges"}
        what = kind.get(element.name, f"records of '{element.name}'")
        self.source.fail(
            f"is truncated: expected {element.count:,} {what}, found {found:,}"
        )

    def _text(self, element: _Element) -> _Table:
        """Records, one a line."""
        columns: list[list[Any]] = [[] for _ in element.properties]
        for i in range(element.count):
            self.line += 1
            end = self.body.find(b"\n", self.position)
            end = len(self.body) if end < 0 else end
            if self.position >= len(self.body):
                self._truncated(element, i)
            text = self.body[self.position : end].decode("ascii", "replace")
            self.position = end + 1
            self._record(element, text.split(), columns)
        scalars, lists = {}, {}
        for (name, kind, length), values in zip(
            element.properties, columns, strict=True
        ):
            if length is None:
                scalars[name] = _of_words(values, kind, name)
            else:
                lists[name] = Faces.of(values)
        return _Table(scalars, lists)

    def _record(
        self, element: _Element, fields: list[str], columns: list[list[Any]]
    ) -> None:
        source, position = self.source, 0
        short = f"expected {len(element.properties)} values, found {len(fields)}"
        for (_, _, length), column in zip(element.properties, columns, strict=True):
            if position >= len(fields):
                source.fail(short, line=self.line)
            if length is None:
                try:
                    float(fields[position])
                    column.append(fields[position])
                except ValueError:
                    found = " ".join(fields)[:60]
                    what = f"expected {len(fields)} numbers, found {found!r}"
                    source.fail(what, line=self.line)
            else:
                size = source.count(self.line, fields[position])
                values = fields[position + 1 : position + 1 + size]
                if len(values) < size:
                    what = f"expected a list of {size}, found {len(values)}"
                    source.fail(what, line=self.line)
                column.append(self._list(values))
                position += size
            position += 1

    def _list(self, values: list[str]) -> list[int]:
        try:
            return [int(value) for value in values]
        except ValueError:
            return [0 for _ in values]  # a list of other numbers, which none reads

    def _fixed(self, element: _Element) -> _Table:
        """Records of one size."""
        if not element.properties:
            return _Table({}, {})
        dtype = np.dtype(
            [(name, self.order + kind) for name, kind, _ in element.properties]
        )
        found = (len(self.body) - self.position) // dtype.itemsize
        if found < element.count:
            self._truncated(element, max(found, 0))
        table = np.frombuffer(self.body, dtype, element.count, self.position)
        self.position += element.count * dtype.itemsize
        return _Table(
            {
                name: table[name].astype(dtype[name].newbyteorder("="))
                for name in dtype.names or ()
            },
            {},
        )

    def _same_lengths(self, element: _Element) -> _Table | None:
        """Records whose lists are as long as those of the first, or None."""
        start = self.position
        if element.count * element.least_size() > len(self.body) - start:
            self.source.fail(f"is truncated in the element '{element.name}'")
        if element.count == 0:
            return None
        first = self._one(element)
        self.position = start
        columns: list[Any] = []
        for i, (_, kind, length) in enumerate(element.properties):
            if length is None:
                columns.append((f"v{i}", self.order + kind))
            else:
                columns.append((f"n{i}", self.order + length))
                columns.append((f"v{i}", self.order + kind, (len(first[i]),)))
        dtype = np.dtype(columns)
        if (len(self.body) - start) // dtype.itemsize < element.count:
            return None
        table = np.frombuffer(self.body, dtype, element.count, start)
        scalars: dict[str, NDArray[Any]] = {}
        lists: dict[str, Faces] = {}
        for i, (name, kind, length) in enumerate(element.properties):
            if length is None:
                scalars[name] = table[f"v{i}"].astype(kind)
                continue
            size = len(first[i])
            if (table[f"n{i}"] != size).any():
                return None
            with np.errstate(invalid="ignore"):  # lists of numbers that none reads
                flat = table[f"v{i}"].astype(np.int64).ravel()
            sizes = np.full(element.count, size, dtype=np.int64)
            lists[name] = Faces(flat, sizes)
        self.position += element.count * dtype.itemsize
        return _Table(scalars, lists)

    def _lists(self, element: _Element) -> _Table:
        """Records with lists of any length."""
        records = [self._one(element) for _ in range(element.count)]
        scalars: dict[str, NDArray[Any]] = {}
        lists: dict[str, Faces] = {}
        for i, (name, kind, length) in enumerate(element.properties):
            column = [record[i] for record in records]
            if length is None:
                scalars[name] = np.array(column, dtype=kind).ravel()
            else:
                sizes = np.array([len(part) for part in column], dtype=np.int64)
                with np.errstate(invalid="ignore"):
                    flat = np.concatenate([np.empty(0), *column]).astype(np.int64)
                lists[name] = Faces(flat, sizes)
        return _Table(scalars, lists)

    def _one(self, element: _Element) -> list[NDArray[Any]]:
        """Read one record; a scalar is an array of one."""
        record = []
        for _, kind, length in element.properties:
            size = 1 if length is None else int(self._take(element, length, 1)[0])
            record.append(self._take(element, kind, size))
        return record

    def _take(self, element: _Element, kind: str, count: int) -> NDArray[Any]:
        dtype = np.dtype(self.order + kind)
        end = self.position + count * dtype.itemsize
        if count < 0 or end > len(self.body):
            self.source.fail(f"is truncated in the element '{element.name}'")
        values = np.frombuffer(self.body, dtype, count, self.position)
        self.position = end
        return values


def _of_words(words: list[str], kind: str, name: str) -> NDArray[Any]:
    """Numbers of the type of a property; doubles where that has no room for them."""
    if kind[0] != "f":
        try:
            return np.array([int(word) for word in words], dtype=kind)
        except (ValueError, OverflowError):
            pass
    # Integers beyond their type stay what they are.
    with np.errstate(invalid="ignore", over="ignore"):
        numbers = np.array([float(word) for word in words], dtype=np.float64)
        narrow = numbers.astype(kind)
    wide = kind[0] != "f" and (narrow != numbers).any()
    # The digits of a coordinate say more than its type.
    return numbers if wide or name in "xyz" else narrow


# Written here, not by meshio: it knows no edges, and puts the date into the file.


def write_ply(file: IO[bytes], mesh: FileMesh) -> None:
    """Write binary PLY: vertices with their fields, then edges or triangles."""
    counts = {size: len(cells) for size, cells in mesh.cells.items()}
    file.write(ply_header(mesh, len(mesh.points), counts))
    for part in ply_body(mesh):
        file.write(part)


def ply_header(mesh: FileMesh, num_points: int, num_cells: dict[int, int]) -> bytes:
    """What a file begins with; of a mesh that is written in pieces by its first."""
    header = ["ply", "format binary_little_endian 1.0"]
    header += [f"comment {_WIDE}{kind} {name}" for name, kind in _wide_names(mesh)]
    header += [f"comment {line}" for line in mesh.comment]
    header += [f"element vertex {num_points}"]
    header += [
        f"property {_NAMES[a.dtype.str[1:]]} {name}" for name, a in _columns(mesh)
    ]
    for size, count in num_cells.items():
        if size == 2:
            header += [f"element edge {count}"]
            header += ["property int vertex1", "property int vertex2"]
        else:
            header += [f"element face {count}"]
            header += ["property list uchar int vertex_indices"]
    return "\n".join([*header, "end_header", ""]).encode("ascii", "replace")


def ply_body(mesh: FileMesh, like: FileMesh | None = None) -> Iterator[memoryview]:
    """Records of vertices, then of simplices; `like` another mesh in their types.

    Each is gone when the next is asked for.
    """
    columns = dict(_columns(mesh))
    types = {name: a.dtype for name, a in _columns(mesh if like is None else like)}
    for name, values in columns.items():
        if values.dtype != types[name] and (values.astype(types[name]) != values).any():
            msg = f"{name} has values that {types[name]}, the type of the first ones, has not"
            raise ValueError(msg)
    kinds = [(name, types[name].newbyteorder("<")) for name in columns]
    yield from _records(np.dtype(kinds), columns)
    for size, cells in mesh.cells.items():
        if size == 2:
            yield from _records(
                np.dtype([("corners", "<i4", size)]), {"corners": cells}
            )
        else:
            face = np.dtype([("size", "u1"), ("corners", "<i4", size)])
            sizes = np.broadcast_to(np.uint8(size), len(cells))
            yield from _records(face, {"size": sizes, "corners": cells})


_ROWS = 1 << 14  # that are written at a time: they stay in the cache


def _records(
    kind: np.dtype[Any], columns: dict[str, NDArray[Any]]
) -> Iterator[memoryview]:
    count = min(len(values) for values in columns.values())
    records = np.empty(min(count, _ROWS), kind)
    for begin in range(0, count, _ROWS):
        part = records[: min(_ROWS, count - begin)]
        for name, values in columns.items():
            part[name] = values[begin : begin + len(part)]
        yield part.view(np.uint8).data


_NAMES = {
    "i1": "char",
    "u1": "uchar",
    "i2": "short",
    "u2": "ushort",
    "i4": "int",
    "u4": "uint",
    "i8": "int64",  # of no standard, but read by some
    "u8": "uint64",
    "f4": "float",
    "f8": "double",
}
_WIDE = "remanifold "  # begins a comment on whole numbers that are written as doubles
_EXACT = 2**53  # up to which doubles hold all whole numbers


def _wide_names(mesh: FileMesh) -> list[tuple[str, str]]:
    wide = [
        (name, str(mesh.fields[given].dtype))
        for given, name in ((n, _word(n)) for n in mesh.fields)
        if mesh.fields[given].dtype.kind in "iu"
        and mesh.fields[given].dtype.itemsize == 8
        and mesh.fields[given].ndim == 1
    ]
    kinds = {name: values.dtype.kind for name, values in _columns(mesh)}
    return [(name, kind) for name, kind in wide if kinds[name] == "f"]


def _word(name: str) -> str:
    """A property is one word."""
    return "".join(c if "!" <= c <= "~" else "_" for c in name)


def _columns(mesh: FileMesh) -> list[tuple[str, NDArray[Any]]]:
    """Coordinates and fields, one column a property."""
    columns = [(axis, mesh.points[:, i]) for i, axis in enumerate("xyz")]
    for given, array in mesh.fields.items():
        name = _word(given)
        values = _narrow(byte_colors(array) if name == "colors" else array)
        if values.ndim == 1:
            columns.append((name, values))
            continue
        parts = (GROUPS[name][0] if name in GROUPS else ())[: values.shape[1]]
        if len(parts) != values.shape[1]:
            parts = tuple(f"{name}_{i}" for i in range(values.shape[1]))
        columns += [(part, values[:, i]) for i, part in enumerate(parts)]
    names = [name for name, _ in columns]
    for i, name in enumerate(names):
        if name in names[:i]:
            msg = f"fields: two columns of a .ply file would be called {name!r}"
            raise ValueError(msg)
    return columns


def _narrow(array: NDArray[Any]) -> NDArray[Any]:
    """Give the values a type that PLY has."""
    if array.dtype.kind == "b":
        return array.astype(np.uint8)
    if array.dtype.kind in "iu" and array.dtype.itemsize == 8:
        limits = np.iinfo(np.int32)
        if not array.size or limits.min <= array.min() <= array.max() <= limits.max:
            return array.astype(np.int32)
        # Doubles are what all programs read, and hold these exactly.
        if -_EXACT <= array.min() <= array.max() <= _EXACT:
            return array.astype(np.float64)
        return array
    if array.dtype.str[1:] not in _NAMES:
        return array.astype(np.float64)
    return array
