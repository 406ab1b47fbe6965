# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavefront OBJ: lines that begin with v, l and f."""

from __future__ import annotations

from collections.abc import Iterator
from typing import IO

import numpy as np

from remanifold.formats._mesh import (
    Faces,
    FileMesh,
    check_corners,
    polyline_edges,
    simplices_of_faces,
)
from remanifold.formats._source import Source


def read_obj(source: Source, cells: bool) -> FileMesh:
    """Read vertices, polylines and faces; texture and normals are skipped."""
    points: list[list[float]] = []
    faces: list[list[int]] = []
    lines: list[list[int]] = []
    with source.text() as file:
        for number, text in _whole_lines(file):
            fields = text.split()
            if not fields:
                continue
            if fields[0] == "v":
                points.append(source.floats(number, fields[1:], 3))
            elif cells and fields[0] in ("f", "fo", "l"):
                least = 2 if fields[0] == "l" else 3
                corners = _corners(source, number, fields[1:], len(points), least)
                (lines if fields[0] == "l" else faces).append(corners)
    if not points:
        source.fail("expected lines 'v x y z', found none")
    mesh = FileMesh(np.array(points))
    if faces:
        mesh.cells = simplices_of_faces(source, mesh.points, Faces.of(faces))
    if lines:
        mesh.cells[2] = polyline_edges(lines)
        check_corners(source, mesh.cells[2], len(points))
    return mesh


def _whole_lines(file: IO[str]) -> Iterator[tuple[int, str]]:
    """Lines with their numbers; those that end with a backslash go on."""
    begun, at = "", 0
    for number, text in enumerate(file, 1):
        at = at or number
        if text.rstrip("\r\n").endswith("\\"):
            begun += text.rstrip("\r\n")[:-1] + " "
            continue
        yield at, begun + text
        begun, at = "", 0
    if begun:
        yield at, begun


def _corners(
    source: Source, line: int, fields: list[str], num_points: int, least: int
) -> list[int]:
    """Vertices of a face: from 1, or from -1 backwards; what follows / is skipped."""
    if any("/" in field for field in fields):
        fields = [field.partition("/")[0] for field in fields]
    found = source.indices(line, fields)
    if len(found) < least:
        source.fail(f"expected {least} vertices or more, found {len(found)}", line=line)
    if 0 in found:
        source.fail("has vertex 0; vertices count from 1", line=line)
    corners = [index - 1 if index > 0 else num_points + index for index in found]
    if min(corners) < 0:
        source.fail(f"has vertex {min(found)} of {num_points} so far", line=line)
    return corners


def write_obj(file: IO[bytes], mesh: FileMesh) -> None:
    """Write vertices, then edges or triangles."""
    file.writelines(
        f"v {x!r} {y!r} {z!r}\n".encode() for x, y, z in mesh.points.tolist()
    )
    for size, cells in mesh.cells.items():
        element = "l" if size == 2 else "f"
        for cell in (cells + 1).tolist():
            file.write(f"{element} {' '.join(map(str, cell))}\n".encode())
