# SPDX-License-Identifier: GPL-3.0-or-later
"""Points from files and meshes to files; the suffix names the format.

Reading takes the points alone and keeps their order: ``.npy``, ``.npz``, ``.csv``,
``.txt``, ``.xyz``, ``.ply``, ``.obj``, ``.off``, ``.stl``, ``.vtk`` (legacy) and
``.vtu``. Writing takes the same formats except plain tables of points. Coordinates
are written so that they are read back unchanged, and a file appears under its name
only when it is complete.
"""

from __future__ import annotations

import csv
import os
import re
import secrets
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, NoReturn, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["check_output", "read_points", "write_mesh"]

FloatArray: TypeAlias = NDArray[np.float64]
StrPath: TypeAlias = str | os.PathLike[str]


# --------------------------------------------------------------------- reading


def read_points(path: StrPath) -> FloatArray:
    """Read points from a file.

    Parameters
    ----------
    path : str or path-like
        The file; its suffix names the format.

        ``.npy``, ``.npz``
            A two-dimensional array; complex numbers count as two real ones. Of an
            archive the array called ``points`` is read, or else the only array of two
            dimensions.
        ``.csv``, ``.txt``, ``.xyz``
            One point a line, separated by commas (``.csv``) or blanks. Every column
            is a coordinate. The first line may name the columns; blank lines and
            lines that begin with ``#`` are skipped.
        ``.ply``, ``.obj``, ``.off``, ``.vtk``, ``.vtu``
            All vertices, whether any face uses them or not. OFF may be of any
            dimension (``nOFF``); ``.vtu`` needs at least one cell.
        ``.stl``
            The corners of the facets; corners with the same coordinates become one
            point.

    Returns
    -------
    ndarray of shape (N, D)
        The points as float64, in the order of the file.

    Raises
    ------
    FileNotFoundError, IsADirectoryError, OSError
        If the file cannot be opened.
    ValueError
        If its suffix is unknown or its content is not what the suffix says. The
        message names the file, and the line where there are lines.

    Examples
    --------
    >>> import remanifold as rm
    >>> points = rm.io.read_points("scan.ply")  # doctest: +SKIP
    """
    path = Path(path)
    if path.is_dir():
        msg = f"{path}: is a directory, expected a file with points"
        raise IsADirectoryError(msg)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        known = ", ".join(_READERS)
        msg = f"{path}: cannot read points from {_suffix(path)}; use one of {known}"
        raise ValueError(msg)
    if not path.exists():
        msg = f"{path}: no such file"
        raise FileNotFoundError(msg)
    points = np.ascontiguousarray(reader(path), dtype=np.float64)
    if points.size == 0:
        _fail(path, "holds no points")
    return points


def _read_numpy(path: Path) -> FloatArray:
    with path.open("rb") as file:
        # A damaged file is reported by whatever stumbles over it first: zipfile,
        # zlib, the parser of NumPy's header, ...
        try:
            content = np.load(file, allow_pickle=False)
            arrays = None if isinstance(content, np.ndarray) else dict(content)
        except Exception as error:  # noqa: BLE001
            _fail(path, f"is damaged, truncated or no NumPy file ({error})", error)
    if arrays is None:
        return _matrix(path, "the array", content)
    if "points" in arrays:
        return _matrix(path, "the array 'points'", arrays["points"])
    matrices = [key for key, array in arrays.items() if array.ndim == 2]
    if len(matrices) != 1:
        found = ", ".join(f"{key} {array.shape}" for key, array in arrays.items())
        _fail(
            path,
            "expected an array 'points' or a single array of shape (N, D), "
            f"found {found or 'no arrays'}",
        )
    return _matrix(path, f"the array '{matrices[0]}'", arrays[matrices[0]])


def _matrix(path: Path, name: str, array: NDArray[np.generic]) -> FloatArray:
    if array.ndim != 2:
        _fail(path, f"{name} has shape {array.shape}, expected (N, D)")
    if array.dtype.kind not in "biufc":
        _fail(path, f"{name} holds {array.dtype}, expected numbers")
    if array.dtype.kind == "c":
        array = np.ascontiguousarray(array, dtype=np.complex128).view(np.float64)
    return array.astype(np.float64)


def _read_csv(path: Path) -> FloatArray:
    with _open_text(path) as file:
        rows = csv.reader(file, skipinitialspace=True)
        try:
            return _table(path, ((rows.line_num, row) for row in rows), "commas")
        except csv.Error as error:
            _fail(path, f"no comma-separated text ({error})", error, rows.line_num)


def _read_table(path: Path) -> FloatArray:
    with _open_text(path) as file:
        rows = ((number, line.split()) for number, line in enumerate(file, 1))
        return _table(path, rows, "blanks")


def _table(
    path: Path, rows: Iterator[tuple[int, list[str]]], separator: str
) -> FloatArray:
    points: list[list[float]] = []
    header_allowed = True
    for line, fields in rows:
        if not any(fields) or fields[0].startswith("#"):
            continue
        try:
            point = [float(field) for field in fields]
        except ValueError:
            if header_allowed and not any(_is_number(field) for field in fields):
                header_allowed = False
                continue
            culprit = next(field for field in fields if not _is_number(field))
            what = f"expected numbers separated by {separator}, found {culprit!r}"
            _fail(path, what, line=line)
        header_allowed = False
        if points and len(point) != len(points[0]):
            what = f"expected {len(points[0])} numbers as before, found {len(point)}"
            _fail(path, what, line=line)
        points.append(point)
    return np.array(points)


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return True


def _read_obj(path: Path) -> FloatArray:
    points = []
    with _open_text(path) as file:
        for line, text in enumerate(file, 1):
            fields = text.split()
            if fields and fields[0] == "v":
                points.append(_floats(path, line, fields[1:], 3))
    if not points:
        _fail(path, "expected lines 'v x y z', found none")
    return np.array(points)


def _read_off(path: Path) -> FloatArray:
    with _open_text(path) as file:
        lines = (
            (number, content)
            for number, text in enumerate(file, 1)
            if (content := text.partition("#")[0].split())
        )
        line, fields = next(lines, (1, [""]))
        header = re.fullmatch(r"(ST)?C?N?(n?)OFF", fields[0])
        if header is None or "BINARY" in fields:
            _fail(path, f"expected 'OFF' or 'nOFF', found {fields[0]!r}", line=line)
        counts = [(line, field) for field in fields[1:]]
        needed = 3 if header[2] else 2  # (dimension,) vertices, faces; edges optional
        while len(counts) < needed:
            line, fields = next(lines, (line, []))
            if not fields:
                _fail(path, "ends before the number of vertices")
            counts += [(line, field) for field in fields]
        dim, count = 3, _integer(path, *counts[0])
        if header[2]:
            dim, count = count, _integer(path, *counts[1])
        points: list[list[float]] = []
        for line, fields in lines:
            if len(points) == count:
                break
            points.append(_floats(path, line, fields, dim))
    if len(points) < count:
        _fail(path, f"is truncated: expected {count} vertices, found {len(points)}")
    return np.array(points).reshape(count, dim)


def _read_stl(path: Path) -> FloatArray:
    data = path.read_bytes()
    start = data[:1024].lower()
    if start.startswith(b"solid") and b"facet" in start:
        corners = _ascii_stl(path)
    else:
        corners = _binary_stl(path, data)
    unique, first = np.unique(corners, axis=0, return_index=True)
    return unique[np.argsort(first)]


def _ascii_stl(path: Path) -> FloatArray:
    corners = []
    last = ""
    with _open_text(path) as file:
        for line, text in enumerate(file, 1):
            words = text.strip().lower()
            last = words or last
            if words.startswith("vertex"):
                corners.append(_floats(path, line, words.split()[1:], 3))
    if not last.startswith("endsolid") or len(corners) % 3:
        _fail(path, "is truncated: expected facets of three vertices, then 'endsolid'")
    return np.array(corners)


def _binary_stl(path: Path, data: bytes) -> FloatArray:
    if len(data) < 84:
        _fail(path, f"is truncated: expected an STL header, found {len(data)} bytes")
    count = int.from_bytes(data[80:84], "little")
    facet = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("", "<u2")])
    expected = 84 + count * facet.itemsize
    if len(data) < expected:
        what = f"{count} facets in {expected} bytes, found {len(data)} bytes"
        _fail(path, f"is truncated or no STL: expected {what}")
    facets = np.frombuffer(data, facet, count, offset=84)
    return facets["corners"].reshape(-1, 3).astype(np.float64)


def _read_vtu(path: Path) -> FloatArray:
    import meshio

    try:
        return np.asarray(meshio.vtu.read(path).points, dtype=np.float64)
    except (Exception, SystemExit) as error:  # noqa: BLE001
        if b'NumberOfCells="0"' in path.read_bytes():
            what = "holds no cells, and meshio reads only grids with cells"
            _fail(path, f"{what}; save the points as .vtk or .ply", error)
        reason = str(error) or type(error).__name__
        _fail(path, f"is damaged, truncated or no unstructured grid ({reason})", error)


def _read_vtk(path: Path) -> FloatArray:
    data = path.read_bytes()
    header = re.match(rb"# vtk DataFile[^\n]*\n[^\n]*\n\s*(ASCII|BINARY)\s", data)
    if header is None:
        _fail(path, "expected a legacy VTK file, starting with '# vtk DataFile'")
    start = re.compile(rb"^\s*POINTS\s+(\d+)\s+(\w+)[ \t\r]*\n", re.MULTILINE).search(
        data, header.end()
    )
    if start is None:
        _fail(path, "expected a line 'POINTS n type', found none")
    size = 3 * int(start[1])
    if header[1] == b"ASCII":
        line = data.count(b"\n", 0, start.end()) + 1
        values: list[float] = []
        for text in data[start.end() :].decode("ascii", "replace").splitlines():
            if len(values) >= size:
                break
            fields = text.split()[: size - len(values)]
            values += _floats(path, line, fields, len(fields))
            line += 1
        points = np.array(values)
    else:
        types = {b"float": ">f4", b"double": ">f8"}
        if start[2] not in types:
            found = start[2].decode()
            _fail(path, f"expected points of type float or double, found {found}")
        dtype = np.dtype(types[start[2]])
        held = (len(data) - start.end()) // dtype.itemsize
        points = np.frombuffer(data, dtype, min(size, held), offset=start.end())
    if len(points) < size:
        what = f"expected {int(start[1])} points, found {len(points) // 3}"
        _fail(path, f"is truncated: {what}")
    return points.reshape(-1, 3).astype(np.float64)


# PLY: a text header describes elements, each a list of records with properties.

_PLY_TYPES = {
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


class _PlyElement:
    """Name, number of records, and properties: (name, type, type of the length)."""

    def __init__(self, name: str, count: int) -> None:
        self.name = name
        self.count = count
        self.properties: list[tuple[str, str, str | None]] = []

    def has_lists(self) -> bool:
        return any(length is not None for _, _, length in self.properties)


def _read_ply(path: Path) -> FloatArray:
    with path.open("rb") as file:
        encoding, elements, line = _ply_header(path, file)
        vertex = next((e for e in elements if e.name == "vertex"), None)
        if vertex is None:
            _fail(path, "expected an element 'vertex', found none")
        names = [name for name, _, _ in vertex.properties]
        axes = [axis for axis in "xyz" if axis in names]
        if len(axes) < 2:
            found = ", ".join(names) or "none"
            _fail(path, f"expected vertex properties x, y, z, found {found}")
        for element in elements[: elements.index(vertex)]:
            line += _skip_ply(path, file, encoding, element)
        if encoding == "ascii":
            return _ascii_ply(path, file, vertex, axes, line)
        return _binary_ply(path, file, encoding, vertex, axes)


def _ply_header(path: Path, file: IO[bytes]) -> tuple[str, list[_PlyElement], int]:
    """Read up to 'end_header': byte order or 'ascii', elements, number of lines."""
    if file.readline().rstrip() != b"ply":
        _fail(path, "expected a PLY file, whose first line is 'ply'", line=1)
    encodings = {"ascii": "ascii", "binary_little_endian": "<"}
    encodings["binary_big_endian"] = ">"
    encoding = None
    elements: list[_PlyElement] = []
    line, words = 1, [""]
    while words != ["end_header"]:
        line += 1
        text = file.readline().decode("ascii", "replace")
        if not text:
            _fail(path, "is truncated: the header has no 'end_header'")
        words = text.split()
        match words:
            case ["format", name, _] if name in encodings:
                encoding = encodings[name]
            case ["element", name, count]:
                elements.append(_PlyElement(name, _integer(path, line, count)))
            case ["property", "list", length, kind, name] if (
                elements and length in _PLY_TYPES and kind in _PLY_TYPES
            ):
                types = _PLY_TYPES[kind], _PLY_TYPES[length]
                elements[-1].properties.append((name, *types))
            case ["property", kind, name] if elements and kind in _PLY_TYPES:
                elements[-1].properties.append((name, _PLY_TYPES[kind], None))
            case [] | ["end_header"] | ["comment" | "obj_info", *_]:
                pass
            case _:
                what = f"no valid line of a PLY header: {text.strip()[:60]!r}"
                _fail(path, what, line=line)
    if encoding is None:
        _fail(path, "expected a line 'format ...' in the header")
    return encoding, elements, line


def _ascii_ply(
    path: Path, file: IO[bytes], element: _PlyElement, axes: list[str], line: int
) -> FloatArray:
    points = []
    for i in range(element.count):
        line += 1
        text = file.readline()
        if not text:
            _fail(path, f"is truncated: expected {element.count} vertices, found {i}")
        fields = text.decode("ascii", "replace").split()
        record: dict[str, str] = {}
        position = 0
        for name, _, length in element.properties:
            if position >= len(fields):
                what = f"expected {len(element.properties)} values, found {len(fields)}"
                _fail(path, what, line=line)
            if length is None:
                record[name] = fields[position]
            else:
                position += _integer(path, line, fields[position])
            position += 1
        points.append(_floats(path, line, [record[axis] for axis in axes], len(axes)))
    return np.array(points).reshape(-1, len(axes))


def _binary_ply(
    path: Path, file: IO[bytes], order: str, element: _PlyElement, axes: list[str]
) -> FloatArray:
    if element.has_lists():
        records = (
            _ply_record(path, file, order, element) for _ in range(element.count)
        )
        return np.array([[record[axis] for axis in axes] for record in records])
    dtype = np.dtype([(name, order + kind) for name, kind, _ in element.properties])
    found = (path.stat().st_size - file.tell()) // dtype.itemsize
    if found < element.count:
        what = f"expected {element.count} vertices, found {max(found, 0)}"
        _fail(path, f"is truncated: {what}")
    table = np.frombuffer(file.read(element.count * dtype.itemsize), dtype)
    return np.column_stack([table[axis].astype(np.float64) for axis in axes])


def _skip_ply(path: Path, file: IO[bytes], encoding: str, element: _PlyElement) -> int:
    """Skip an element; returns the number of lines skipped."""
    if encoding == "ascii":
        for _ in range(element.count):
            file.readline()
        return element.count
    if element.has_lists():
        for _ in range(element.count):
            _ply_record(path, file, encoding, element)
    else:
        size = sum(np.dtype(kind).itemsize for _, kind, _ in element.properties)
        file.seek(element.count * size, os.SEEK_CUR)
    return 0


def _ply_record(
    path: Path, file: IO[bytes], order: str, element: _PlyElement
) -> dict[str, float]:
    """Read one binary record; lists are skipped."""

    def take(kind: str) -> float:
        dtype = np.dtype(order + kind)
        data = file.read(dtype.itemsize)
        if len(data) < dtype.itemsize:
            _fail(path, f"is truncated in the element '{element.name}'")
        return float(np.frombuffer(data, dtype)[0])

    record = {}
    for name, kind, length in element.properties:
        if length is None:
            record[name] = take(kind)
        else:
            file.seek(int(take(length)) * np.dtype(kind).itemsize, os.SEEK_CUR)
    return record


_READERS: dict[str, Callable[[Path], FloatArray]] = {
    ".npy": _read_numpy,
    ".npz": _read_numpy,
    ".csv": _read_csv,
    ".txt": _read_table,
    ".xyz": _read_table,
    ".ply": _read_ply,
    ".obj": _read_obj,
    ".off": _read_off,
    ".stl": _read_stl,
    ".vtk": _read_vtk,
    ".vtu": _read_vtu,
}


# --------------------------------------------------------------------- writing


def write_mesh(path: StrPath, vertices: ArrayLike, simplices: ArrayLike) -> None:
    """Write vertices and simplices to a file.

    Parameters
    ----------
    path : str or path-like
        The file; its suffix names the format. A file of that name is replaced, but
        only when the new one is complete.

        ========== ============= ====================
        suffix     dimension D   simplices
        ========== ============= ====================
        ``.npz``   any           any
        ``.ply``   up to 3       edges, triangles
        ``.obj``   up to 3       edges, triangles
        ``.off``   up to 3       triangles
        ``.stl``   up to 3       triangles
        ``.vtk``   up to 3       edges, triangles, tetrahedra
        ``.vtu``   up to 3       edges, triangles, tetrahedra
        ========== ============= ====================

        An archive holds the arrays ``points`` and ``simplices``. In the other formats
        points of fewer than three coordinates are filled up with zeros. STL repeats
        the corners of each triangle and has no vertices of its own.
    vertices : array_like of shape (N, D)
        Coordinates, real numbers.
    simplices : array_like of shape (M, K + 1)
        Indices of vertices.

    Raises
    ------
    ValueError
        If the format cannot hold the mesh, or the arrays do not fit together.
    OSError
        If the file cannot be written. Nothing is left behind.

    Examples
    --------
    >>> import remanifold as rm
    >>> rm.io.write_mesh("mesh.ply", rec.vertices, rec.simplices)  # doctest: +SKIP
    """
    points, cells = _check_mesh(vertices, simplices)
    target = check_output(path, cells.shape[1] - 1, points.shape[1])
    writer = _WRITERS[target.suffix.lower()][0]
    if writer is not _write_npz:
        points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
    # Written beside the target, so that the last step is a rename within one folder.
    final = _final(target)
    partial = final.with_name(
        f".{final.stem}-{secrets.token_hex(6)}{target.suffix.lower()}"
    )
    try:
        writer(partial, points, cells)
        partial.replace(final)
    except OSError as error:
        msg = f"{target}: cannot write the file ({error.strerror or error})"
        raise OSError(error.errno, msg) from error
    finally:
        partial.unlink(missing_ok=True)


def check_output(
    path: StrPath, dim: int | None = None, ambient_dim: int | None = None
) -> Path:
    """Check that a mesh can be written to a file, before any work is done for it.

    Parameters
    ----------
    path : str or path-like
        The file to write to; its suffix names the format.
    dim : int, optional
        Dimension K of the simplices, if it is known already.
    ambient_dim : int, optional
        Number of coordinates, if it is known already.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    ValueError
        If the format is unknown or cannot hold such a mesh; the message names the
        formats that can.
    OSError
        If there is no such folder, or no file can be written to it.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in _WRITERS:
        known = ", ".join(_WRITERS)
        msg = f"{path}: cannot write a mesh to {_suffix(path)}; use one of {known}"
        raise ValueError(msg)

    def holds(dims: Sequence[int] | None) -> bool:
        if dims is None:
            return True
        return (dim is None or dim in dims) and (ambient_dim is None or ambient_dim < 4)

    dims = _WRITERS[suffix][1]
    if not holds(dims):
        if dims is not None and dim is not None and dim not in dims:
            names = {1: "edges", 2: "triangles", 3: "tetrahedra"}
            what = names.get(dim, f"simplices of dimension {dim}")
        else:
            what = f"points with {ambient_dim} coordinates"
        others = ", ".join(s for s, (_, dims) in _WRITERS.items() if holds(dims))
        msg = f"{path}: {_suffix(path)} cannot hold {what}; use {others}"
        raise ValueError(msg)
    if path.is_dir():
        msg = f"{path}: is a directory, expected the name of a file"
        raise IsADirectoryError(msg)
    if path.exists() and not path.is_file():
        msg = f"{path}: is not a regular file"
        raise ValueError(msg)
    folder = _final(path).parent
    if not folder.is_dir():
        msg = f"{path}: the folder {folder} does not exist"
        raise FileNotFoundError(msg)
    if not os.access(folder, os.W_OK):
        msg = f"{path}: no permission to write to the folder {folder}"
        raise PermissionError(msg)
    return path


def _final(path: Path) -> Path:
    """Follow links: a file behind a link is replaced, not the link."""
    return Path(os.path.realpath(path))


def _check_mesh(
    vertices: ArrayLike, simplices: ArrayLike
) -> tuple[FloatArray, NDArray[np.int64]]:
    points = np.asarray(vertices)
    cells = np.asarray(simplices)
    if points.ndim != 2 or points.shape[1] == 0 or points.dtype.kind not in "biuf":
        msg = (
            "vertices must be real numbers of shape (N, D), "
            f"got {points.dtype} {points.shape}"
        )
        raise ValueError(msg)
    if cells.ndim != 2 or cells.shape[1] < 2 or cells.dtype.kind not in "iu":
        msg = (
            "simplices must be integers of shape (M, K + 1) with K >= 1, "
            f"got {cells.dtype} {cells.shape}"
        )
        raise ValueError(msg)
    if cells.size and not 0 <= cells.min() <= cells.max() < len(points):
        msg = (
            f"simplices must hold indices from 0 to {len(points) - 1}, "
            f"got {cells.min()} to {cells.max()}"
        )
        raise ValueError(msg)
    return points.astype(np.float64), cells.astype(np.int64)


def _write_npz(path: Path, points: FloatArray, cells: NDArray[np.int64]) -> None:
    np.savez_compressed(path, points=points, simplices=cells.astype(np.int32))


# PLY and OBJ are written here, not by meshio: it knows no edges in either, and puts
# the date into both.


def _write_ply(path: Path, points: FloatArray, cells: NDArray[np.int64]) -> None:
    size = cells.shape[1]
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    header += [f"property double {axis}" for axis in "xyz"]
    if size == 2:
        header += [f"element edge {len(cells)}"]
        header += ["property int vertex1", "property int vertex2"]
        body = cells.astype("<i4").tobytes()
    else:
        header += [f"element face {len(cells)}"]
        header += ["property list uchar int vertex_indices"]
        records = np.empty(len(cells), [("size", "u1"), ("corners", "<i4", size)])
        records["size"] = size
        records["corners"] = cells
        body = records.tobytes()
    text = "\n".join([*header, "end_header", ""])
    path.write_bytes(text.encode() + points.astype("<f8").tobytes() + body)


def _write_obj(path: Path, points: FloatArray, cells: NDArray[np.int64]) -> None:
    element = "l" if cells.shape[1] == 2 else "f"
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
        file.writelines(
            f"{element} {' '.join(map(str, cell))}\n" for cell in (cells + 1).tolist()
        )


def _write_stl(path: Path, points: FloatArray, cells: NDArray[np.int64]) -> None:
    import meshio

    corners = points[cells]
    # meshio's own normals of degenerate triangles are NaN.
    normals = _unit(
        np.cross(
            _unit(corners[:, 1] - corners[:, 0]), _unit(corners[:, 2] - corners[:, 0])
        )
    )
    mesh = meshio.Mesh(
        points, [("triangle", cells)], cell_data={"facet_normals": [normals]}
    )
    meshio.stl.write(path, mesh)


def _unit(vectors: FloatArray) -> FloatArray:
    """Scale vectors to length 1; zero stays zero."""
    largest = np.max(np.abs(vectors), axis=1, keepdims=True, initial=0.0)
    vectors = vectors / np.where(largest > 0, largest, 1.0)
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.where(length > 0, length, 1.0))


def _write_meshio(path: Path, points: FloatArray, cells: NDArray[np.int64]) -> None:
    import meshio

    kind = {2: "line", 3: "triangle", 4: "tetra"}[cells.shape[1]]
    mesh = meshio.Mesh(points, [(kind, cells)])
    match path.suffix:
        case ".off":
            meshio.off.write(path, mesh)
        case ".vtk":
            meshio.vtk.write(path, mesh, fmt_version="4.2")
        case ".vtu":
            meshio.vtu.write(path, mesh)


# Suffix -> writer and the dimensions of the simplices it can hold (None: all, and
# points of any dimension).
_WRITERS: dict[
    str,
    tuple[
        Callable[[Path, FloatArray, NDArray[np.int64]], None], tuple[int, ...] | None
    ],
] = {
    ".ply": (_write_ply, (1, 2)),
    ".obj": (_write_obj, (1, 2)),
    ".off": (_write_meshio, (2,)),
    ".stl": (_write_stl, (2,)),
    ".vtk": (_write_meshio, (1, 2, 3)),
    ".vtu": (_write_meshio, (1, 2, 3)),
    ".npz": (_write_npz, None),
}


# --------------------------------------------------------------------- messages


def _fail(
    path: Path,
    what: str,
    cause: BaseException | None = None,
    line: int | None = None,
) -> NoReturn:
    where = f"{path}" if line is None else f"{path}, line {line}"
    msg = f"{where}: {what}"
    raise ValueError(msg) from cause


@contextmanager
def _open_text(path: Path) -> Iterator[IO[str]]:
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            yield file
    except UnicodeDecodeError as error:
        _fail(path, f"is no text file, as {_suffix(path)} files are", error)


def _suffix(path: Path) -> str:
    return path.suffix or "a file without a suffix"


def _floats(path: Path, line: int, fields: list[str], count: int) -> list[float]:
    """Read the first ``count`` fields of a line."""
    try:
        values = [float(field) for field in fields[:count]]
    except ValueError:
        values = []
    if len(values) < count:
        found = " ".join(fields) or "nothing"
        _fail(path, f"expected {count} numbers, found {found[:60]!r}", line=line)
    return values


def _integer(path: Path, line: int, field: str) -> int:
    if not field.isdecimal():
        _fail(path, f"expected a count, found {field[:60]!r}", line=line)
    return int(field)
