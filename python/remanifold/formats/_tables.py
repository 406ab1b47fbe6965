# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of points as text, and NumPy's files."""

from __future__ import annotations

import csv
import io
import operator
import os
import zipfile
from collections.abc import Mapping
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from remanifold.formats._arrays import Held, archive_arrays, damage, read_npy
from remanifold.formats._columns import GROUPS, mesh_of_table, named_columns
from remanifold.formats._grid import read_grid
from remanifold.formats._mesh import FileMesh, Table
from remanifold.formats._molecule import read_molecule
from remanifold.formats._source import FloatArray, Source
from remanifold.formats._text import read_columns
from remanifold.formats.saved import is_saved, mesh_of_saved

# Names that an archive gives to its own arrays.
RESERVED = ("points", "simplices")


def read_csv(source: Source, with_fields: bool) -> FileMesh:  # noqa: ARG001  fields come along
    """Cells separated by commas, or by semicolons or tabs where the file does so."""
    return mesh_of_table(source, read_columns(source, ","))


def read_tsv(source: Source, with_fields: bool) -> FileMesh:  # noqa: ARG001
    """Cells separated by tabs."""
    return mesh_of_table(source, read_columns(source, "\t"))


def read_table(source: Source, with_fields: bool) -> FileMesh:  # noqa: ARG001
    """Cells separated by blanks; the first line may be the number of the points."""
    return mesh_of_table(source, read_columns(source, None, counted=True))


def read_xyz(source: Source, with_fields: bool) -> FileMesh:
    """Points of a scanner, or the atoms of a molecule."""
    molecule = read_molecule(source)
    return read_table(source, with_fields) if molecule is None else molecule


def read_asc(source: Source, with_fields: bool) -> FileMesh:
    """Points of a scanner, or a grid of heights."""
    grid = read_grid(source)
    return read_table(source, with_fields) if grid is None else grid


def read_numpy(source: Source, with_fields: bool) -> FileMesh:
    """Read an array, or an archive of points, simplices and fields."""
    with source.open() as file:
        if is_saved(file):
            return mesh_of_saved(source, file)
        if zipfile.is_zipfile(file):
            file.seek(0)
            with damage(source):
                archive = zipfile.ZipFile(file)
            with archive:
                arrays = archive_arrays(source, archive)
                return mesh_of_arrays(source, arrays, with_fields)
        size = file.seek(0, os.SEEK_END)
        file.seek(0)
        with damage(source):
            content = read_npy(file, size)
    if content.dtype.names is not None:
        return mesh_of_table(source, _structured(source, content))
    points = _matrix(source, "the array", content)
    if content.dtype.kind == "c":
        return FileMesh(points)
    return mesh_of_table(source, Table([*points.T]))


def _structured(source: Source, array: NDArray[Any]) -> Table:
    """Columns of records; those of several numbers become several columns."""
    columns: list[NDArray[Any]] = []
    names: list[str] = []
    for name in array.dtype.names or ():
        values = array[name].reshape(array.size, -1)
        if values.dtype.kind not in "biufUS":
            source.fail(f"the column {name!r} holds {values.dtype}, expected numbers")
        columns += [*values.T]
        width = values.shape[1]
        names += [name] if width == 1 else [f"{name}_{i}" for i in range(width)]
    return Table(columns, names)


# What archives of others call the coordinates, most telling first.
_POINTS = (
    *("points", "xyz", "coords", "coordinates", "positions", "pos", "vertices", "X"),
    *("point_cloud", "pointcloud", "pcd", "pts"),
)


_SIMPLICES = frozenset(
    (
        *("faces", "f", "triangles", "tris", "trivs", "cells", "elements", "edges"),
        *("tets", "tetrahedra", "tetras", "simplexes"),
    )
)


def mesh_of_arrays(
    source: Source, arrays: Mapping[str, Held], with_fields: bool
) -> FileMesh:
    """Points, simplices and fields from arrays by their names; no others are read."""
    mesh = _points_among(source, arrays)
    # Where there are columns these are the fields already.
    if mesh.table is not None or not (with_fields or source.cells or source.columns):
        return mesh
    count = len(mesh.points)
    named = _simplices_among(source, arrays) if source.cells else None
    if named is not None:
        simplices = _simplices(source, named, arrays[named].read(), count)
        mesh.cells[simplices.shape[1]] = simplices
    mesh.fields |= {
        key: array.read()
        for key, array in arrays.items()
        if key not in (*RESERVED, mesh.chosen, named)
        and array.ndim in (1, 2)
        and array.nbytes
        and len(array) == count
        and array.dtype.kind in "biuf"
    }
    mesh.chosen = f"coordinates are the array {mesh.chosen!r}" if mesh.chosen else ""
    return mesh


def _points_among(source: Source, arrays: Mapping[str, Held]) -> FileMesh:
    names = [key for key, array in arrays.items() if array.ndim == 2]
    lengths = {len(array) for array in arrays.values() if array.ndim == 1}
    asked = source.columns[0] if source.columns and len(source.columns) == 1 else None
    if isinstance(asked, str) and asked in names:
        name, source.columns = asked, None  # an array, not a column of one
    elif "points" in arrays:
        name = "points"
    elif len(names) == 1:
        (name,) = names
    elif not names and len(lengths) == 1 and {"x", "y"} <= {k.lower() for k in arrays}:
        table = Table([array.read() for array in arrays.values()], [*arrays])
        return mesh_of_table(source, table)
    elif any(key in names for key in _POINTS):
        name = next(key for key in _POINTS if key in names)
        source.guess(f"of {len(names)} arrays of two dimensions {name!r} is read")
    else:
        if arrays and all(array.dtype.hasobject for array in arrays.values()):
            source.fail(
                f"its arrays, {', '.join(arrays)}, hold Python objects, which are not "
                "loaded, for they can run anything: save numbers, as in "
                "array.astype(float)"
            )
        found = ", ".join(f"{key} {array.shape}" for key, array in arrays.items())
        remedy = f": columns={names[0]!r} would read one of them" if names else ""
        source.fail(
            "expected an array 'points' or a single array of shape (N, D), "
            f"found {found or 'no arrays'}{remedy}"
        )
    mesh = FileMesh(_matrix(source, f"the array '{name}'", arrays[name].read()))
    mesh.chosen = name
    return mesh


def _simplices_among(source: Source, arrays: Mapping[str, Held]) -> str | None:
    """Name of the array of simplices; others call them faces, triangles, cells."""
    if "simplices" in arrays:
        return "simplices"
    found = [
        (array.shape[1], name)
        for name, array in arrays.items()
        if name.lower() in _SIMPLICES and array.ndim == 2 and array.dtype.kind in "iu"
    ]
    if not found:
        return None
    name = max(found, key=operator.itemgetter(0))[1]
    source.guess(f"simplices are the array {name!r}")
    return name


def _simplices(
    source: Source, name: str, array: NDArray[Any], num_points: int
) -> NDArray[np.int64]:
    if array.ndim != 2 or array.shape[1] < 1 or array.dtype.kind not in "iu":
        source.fail(
            f"the array {name!r} must hold integers of shape (M, K + 1), "
            f"found {array.dtype} {array.shape}"
        )
    if array.size and not 0 <= array.min() <= array.max() < num_points:
        from_one = array.min() == 1 and array.max() == num_points
        remedy = "; they count from 1: save them less 1" if from_one else ""
        source.fail(
            f"the array {name!r} must hold indices from 0 to {num_points - 1}, "
            f"found {array.min()} to {array.max()}{remedy}"
        )
    return array.astype(np.int64)


def _matrix(source: Source, name: str, array: NDArray[Any]) -> FloatArray:
    if array.ndim != 2:
        more = ""
        if array.ndim > 2:
            more = f"; reshape(-1, {array.shape[-1]}) makes points of an image"
        source.fail(f"{name} has shape {array.shape}, expected (N, D){more}")
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
    # Stored as `numpy.savez` does: to deflate takes many times as long as to write, for a
    # third of the size.
    with zipfile.ZipFile(file, "w") as archive:
        for name, array in {**arrays, **mesh.fields}.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.save(member, array, allow_pickle=False)
        archive.comment = "\n".join(mesh.comment).encode()


def write_npy(file: IO[bytes], mesh: FileMesh) -> None:
    """Write the array of the points."""
    np.save(file, mesh.points, allow_pickle=False)


def write_csv(file: IO[bytes], mesh: FileMesh) -> None:
    """Write one point a line, after the names of the columns."""
    names, columns = columns_of(mesh)
    head = io.StringIO()
    csv.writer(head, lineterminator="\n").writerow(names)
    file.write(head.getvalue().encode())
    _write_rows(file, columns, ",")


def write_table(file: IO[bytes], mesh: FileMesh) -> None:
    """Write one point a line; columns beyond three have names, in a comment."""
    names, columns = columns_of(mesh)
    if len(columns) > 3:
        # One word each: what separates names are blanks.
        words = [
            "".join(c if c.isprintable() and c != " " else "_" for c in n)
            for n in names
        ]
        file.write(f"# {' '.join(words)}\n".encode())
    _write_rows(file, columns, " ")


def columns_of(mesh: FileMesh) -> tuple[list[str], list[NDArray[Any]]]:
    """Columns to write, under names that a reader knows."""
    table = named_columns(
        mesh, lambda name, width: name in GROUPS and 3 <= width <= len(GROUPS[name][0])
    )
    names = table.names or []
    for i, name in enumerate(names):
        if name in names[:i]:
            msg = f"fields: two columns would be called {name!r}"
            raise ValueError(msg)
    return names, table.columns


def _write_rows(file: IO[bytes], columns: list[NDArray[Any]], separator: str) -> None:
    # A double tells a narrower number exactly.
    words = [
        [
            *map(
                repr,
                column.astype(
                    int if column.dtype.kind == "b" else column.dtype
                ).tolist(),
            )
        ]
        for column in columns
    ]
    for row in zip(*words, strict=True):
        file.write(f"{separator.join(row)}\n".encode())
