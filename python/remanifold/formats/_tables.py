# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of points as text, and NumPy's files."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from remanifold.formats._mesh import FileMesh
from remanifold.formats._source import FloatArray, Source

# Names that an archive gives to its own arrays.
RESERVED = ("points", "simplices")


def read_csv(source: Source, cells: bool) -> FileMesh:  # noqa: ARG001  has none
    """Numbers separated by commas."""
    with source.text() as file:
        rows = csv.reader(file, skipinitialspace=True)
        try:
            points = _table(source, ((rows.line_num, row) for row in rows), "commas")
        except csv.Error as error:
            source.fail(f"no comma-separated text ({error})", error, rows.line_num)
    return FileMesh(points)


def read_table(source: Source, cells: bool) -> FileMesh:  # noqa: ARG001  has none
    """Numbers separated by blanks."""
    with source.text() as file:
        rows = ((number, line.split()) for number, line in enumerate(file, 1))
        return FileMesh(_table(source, rows, "blanks"))


def _table(
    source: Source, rows: Iterator[tuple[int, list[str]]], separator: str
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
            what = f"expected numbers separated by {separator}, found {culprit[:60]!r}"
            source.fail(what, line=line)
        header_allowed = False
        if points and len(point) != len(points[0]):
            what = f"expected {len(points[0])} numbers as before, found {len(point)}"
            source.fail(what, line=line)
        points.append(point)
    return np.array(points)


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return True


def read_numpy(source: Source, cells: bool) -> FileMesh:
    """Read an array, or an archive of points, simplices and fields."""
    with source.open() as file:
        # A damaged file is reported by whatever stumbles over it first: zipfile,
        # zlib, the parser of NumPy's header, ...
        try:
            content = np.load(file, allow_pickle=False)
            arrays = None if isinstance(content, np.ndarray) else dict(content)
        except Exception as error:  # noqa: BLE001
            source.fail(f"is damaged, truncated or no NumPy file ({error})", error)
    if arrays is None:
        return FileMesh(_matrix(source, "the array", content))
    name = "points"
    if name not in arrays:
        matrices = [key for key, array in arrays.items() if array.ndim == 2]
        if len(matrices) != 1:
            found = ", ".join(f"{key} {array.shape}" for key, array in arrays.items())
            source.fail(
                "expected an array 'points' or a single array of shape (N, D), "
                f"found {found or 'no arrays'}"
            )
        name = matrices[0]
    mesh = FileMesh(_matrix(source, f"the array '{name}'", arrays[name]))
    if cells:
        if "simplices" in arrays:
            simplices = _simplices(source, arrays["simplices"], len(mesh.points))
            mesh.cells[simplices.shape[1]] = simplices
        mesh.fields = {
            key: array
            for key, array in arrays.items()
            if key not in (*RESERVED, name)
            and array.ndim in (1, 2)
            and len(array) == len(mesh.points)
            and array.dtype.kind in "biuf"
        }
    return mesh


def _simplices(
    source: Source, array: NDArray[Any], num_points: int
) -> NDArray[np.int64]:
    if array.ndim != 2 or array.shape[1] < 1 or array.dtype.kind not in "iu":
        source.fail(
            "the array 'simplices' must hold integers of shape (M, K + 1), "
            f"found {array.dtype} {array.shape}"
        )
    if array.size and not 0 <= array.min() <= array.max() < num_points:
        source.fail(
            f"the array 'simplices' must hold indices from 0 to {num_points - 1}, "
            f"found {array.min()} to {array.max()}"
        )
    return array.astype(np.int64)


def _matrix(source: Source, name: str, array: NDArray[Any]) -> FloatArray:
    if array.ndim != 2:
        source.fail(f"{name} has shape {array.shape}, expected (N, D)")
    if array.dtype.kind not in "biufc":
        source.fail(f"{name} holds {array.dtype}, expected numbers")
    if array.dtype.kind == "c":
        array = np.ascontiguousarray(array, dtype=np.complex128).view(np.float64)
    return array.astype(np.float64)


def write_npz(file: IO[bytes], mesh: FileMesh) -> None:
    """Write an archive: points, simplices, and each field by its name."""
    arrays: dict[str, NDArray[Any]] = {"points": mesh.points}
    for cells in mesh.cells.values():
        arrays["simplices"] = cells.astype(np.int32)
    np.savez_compressed(file, **arrays, **mesh.fields)  # type: ignore[arg-type]


def write_npy(file: IO[bytes], mesh: FileMesh) -> None:
    """Write the array of the points."""
    np.save(file, mesh.points, allow_pickle=False)


def write_csv(file: IO[bytes], mesh: FileMesh) -> None:
    """Write one point a line, after the names of the coordinates."""
    dim = mesh.points.shape[1]
    names = "xyz"[:dim] if dim <= 3 else [f"x{i}" for i in range(1, dim + 1)]
    file.write(f"{','.join(names)}\n".encode())
    _write_rows(file, mesh.points, ",")


def write_table(file: IO[bytes], mesh: FileMesh) -> None:
    """Write one point a line."""
    _write_rows(file, mesh.points, " ")


def _write_rows(file: IO[bytes], points: FloatArray, separator: str) -> None:
    for row in points.tolist():
        file.write(f"{separator.join(map(repr, row))}\n".encode())
