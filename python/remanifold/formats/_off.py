# SPDX-License-Identifier: GPL-3.0-or-later
"""OFF of three coordinates, and nOFF of any number, as Geomview and GUDHI read it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.colors import byte_colors
from remanifold.formats._mesh import Faces, FileMesh, simplices_of_faces
from remanifold.formats._source import FloatArray, Source

Lines = Iterator[tuple[int, list[str]]]


def read_off(source: Source, with_fields: bool) -> FileMesh:
    """Read vertices and faces, colors and normals where the first word says so."""
    with source.text() as file:
        lines = (
            (number, content)
            for number, text in enumerate(file, 1)
            if (content := text.partition("#")[0].split())
        )
        kind, dim, count, num_faces = _header(source, lines)
        points: list[list[float]] = []
        others: list[list[float]] = []
        while len(points) < count:
            line, fields = next(lines, (0, []))
            if not fields:
                what = f"expected {count:,} vertices, found {len(points):,}"
                source.fail(f"is truncated: {what}")
            points.append(source.floats(line, fields, dim))
            if with_fields and kind and len(fields) > dim:
                rest = fields[dim:]
                others.append(source.floats(line, rest, len(rest)))
        mesh = FileMesh(np.array(points).reshape(count, dim))
        if count and len(others) == count and len({*map(len, others)}) == 1:
            mesh.fields = _fields(kind, dim, np.array(others))
        if source.cells:
            faces = _faces(source, lines, num_faces)
            mesh.cells = simplices_of_faces(source, mesh.points, faces)
    return mesh


def _fields(kind: str, dim: int, others: FloatArray) -> dict[str, NDArray[Any]]:
    """What follows the coordinates: normals (N), then colors (C)."""
    fields: dict[str, NDArray[Any]] = {}
    if "N" in kind and others.shape[1] >= dim:
        fields["normals"] = others[:, :dim]
        others = others[:, dim:]
    if "C" in kind and others.shape[1] >= 3:
        fields["colors"] = byte_colors(others[:, :4])
    return fields


def _header(source: Source, lines: Lines) -> tuple[str, int, int, int]:
    """Give the letters before OFF, the dimension, and the numbers of vertices and faces."""
    line, fields = next(lines, (1, [""]))
    header = re.fullmatch(r"(ST)?C?N?(n?)OFF", fields[0])
    if header is None or "BINARY" in fields:
        source.fail(f"expected 'OFF' or 'nOFF', found {fields[0][:60]!r}", line=line)
    counts = [(line, field) for field in fields[1:]]
    needed = 3 if header[2] else 2  # (dimension,) vertices, faces; edges optional
    while len(counts) < needed:
        line, fields = next(lines, (line, []))
        if not fields:
            source.fail("ends before the number of vertices")
        counts += [(line, field) for field in fields]
    dim = source.count(*counts.pop(0)) if header[2] else 3
    number = counts[1][1]  # of faces, which is anything where they are not read
    num_faces = int(number) if number.isascii() and number.isdecimal() else -1
    if dim == 0:
        source.fail("has points without coordinates", line=line)
    kind = header[0].partition("OFF")[0].removeprefix("ST")
    return kind, dim, source.count(*counts[0]), num_faces


def _faces(source: Source, lines: Lines, count: int) -> Faces:
    if count < 0:
        source.fail("expected the number of faces after that of the vertices")
    faces: list[list[int]] = []
    while len(faces) < count:
        line, fields = next(lines, (0, []))
        if not fields:
            source.fail(f"is truncated: expected {count:,} faces, found {len(faces):,}")
        size = source.count(line, fields[0])
        if len(fields) <= size:
            what = f"expected {size} vertices, found {len(fields) - 1}"
            source.fail(what, line=line)
        faces.append(source.indices(line, fields[1 : size + 1]))
    return Faces.of(faces)


def write_off(file: IO[bytes], mesh: FileMesh) -> None:
    """Write OFF up to R^3, nOFF beyond; with N for normals, C for colors."""
    count, dim = mesh.points.shape
    cells = next(iter(mesh.cells.values()), np.empty((0, 3), dtype=np.int64))
    rows = [[*map(repr, row)] for row in mesh.points.tolist()]
    kind = ""
    if "normals" in mesh.fields:
        kind = "N"
        for row, normal in zip(rows, mesh.fields["normals"].tolist(), strict=True):
            row += map(repr, normal)
    if "colors" in mesh.fields:
        kind = f"C{kind}"
        # Readers want four numbers.
        given = byte_colors(mesh.fields["colors"])
        colors = np.full((count, 4), 255 if given.dtype == np.uint8 else 1.0)
        colors[:, : given.shape[1]] = given
        if given.dtype == np.uint8:
            colors = colors.astype(np.uint8)
        for row, color in zip(rows, colors.tolist(), strict=True):
            row += map(repr, color)
    file.write(f"{kind}{'' if dim == 3 else 'n'}OFF\n".encode())
    file.writelines(f"# {line}\n".encode() for line in mesh.comment)
    start = "" if dim == 3 else f"{dim} "
    file.write(f"{start}{count} {len(cells)} 0\n".encode())
    file.writelines(f"{' '.join(row)}\n".encode() for row in rows)
    for cell in cells.tolist():
        file.write(f"{len(cell)} {' '.join(map(str, cell))}\n".encode())
