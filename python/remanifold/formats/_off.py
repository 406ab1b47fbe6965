# SPDX-License-Identifier: GPL-3.0-or-later
"""OFF of three coordinates, and nOFF of any number, as Geomview and GUDHI read it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import IO

import numpy as np

from remanifold.formats._mesh import Faces, FileMesh, simplices_of_faces
from remanifold.formats._source import Source

Lines = Iterator[tuple[int, list[str]]]


def read_off(source: Source, cells: bool) -> FileMesh:
    """Read vertices and faces; colors and normals are skipped."""
    with source.text() as file:
        lines = (
            (number, content)
            for number, text in enumerate(file, 1)
            if (content := text.partition("#")[0].split())
        )
        dim, count, num_faces = _header(source, lines)
        points: list[list[float]] = []
        while len(points) < count:
            line, fields = next(lines, (0, []))
            if not fields:
                what = f"expected {count} vertices, found {len(points)}"
                source.fail(f"is truncated: {what}")
            points.append(source.floats(line, fields, dim))
        mesh = FileMesh(np.array(points).reshape(count, dim))
        if cells:
            faces = _faces(source, lines, num_faces)
            mesh.cells = simplices_of_faces(source, mesh.points, faces)
    return mesh


def _header(source: Source, lines: Lines) -> tuple[int, int, int]:
    """Give the dimension and the numbers of vertices and of faces."""
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
    return dim, source.count(*counts[0]), num_faces


def _faces(source: Source, lines: Lines, count: int) -> Faces:
    if count < 0:
        source.fail("expected the number of faces after that of the vertices")
    faces: list[list[int]] = []
    while len(faces) < count:
        line, fields = next(lines, (0, []))
        if not fields:
            source.fail(f"is truncated: expected {count} faces, found {len(faces)}")
        size = source.count(line, fields[0])
        if len(fields) <= size:
            what = f"expected {size} vertices, found {len(fields) - 1}"
            source.fail(what, line=line)
        faces.append(source.indices(line, fields[1 : size + 1]))
    return Faces.of(faces)


def write_off(file: IO[bytes], mesh: FileMesh) -> None:
    """Write OFF up to R^3, nOFF beyond."""
    count, dim = mesh.points.shape
    cells = next(iter(mesh.cells.values()), np.empty((0, 3), dtype=np.int64))
    start = "OFF\n" if dim == 3 else f"nOFF\n{dim} "
    file.write(f"{start}{count} {len(cells)} 0\n".encode())
    for row in mesh.points.tolist():
        file.write(f"{' '.join(map(repr, row))}\n".encode())
    for cell in cells.tolist():
        file.write(f"{len(cell)} {' '.join(map(str, cell))}\n".encode())
