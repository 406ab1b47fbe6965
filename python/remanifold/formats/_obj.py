# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavefront OBJ: lines that begin with v, l and f."""

from __future__ import annotations

from collections.abc import Iterator
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from remanifold._base.colors import byte_colors
from remanifold.formats._mesh import (
    Faces,
    FileMesh,
    check_corners,
    polyline_edges,
    simplices_of_faces,
)
from remanifold.formats._source import FloatArray, Source


def read_obj(source: Source, with_fields: bool) -> FileMesh:
    """Vertices, polylines and faces; colors, normals, textures where vertices have them."""
    points: list[list[float]] = []
    colors: list[list[float]] = []
    normals: list[list[float]] = []
    texture: list[list[float]] = []
    faces: list[list[int]] = []
    lines: list[list[int]] = []
    # Whether each corner has the texture, the normal of the number of its vertex.
    own_texture = own_normals = True
    with source.text() as file:
        for number, text in _whole_lines(file):
            fields = text.split()
            if not fields:
                continue
            if fields[0] == "v":
                points.append(source.floats(number, fields[1:], 3))
                if with_fields and len(fields) >= 7:
                    colors.append(source.floats(number, fields[4:], 3))
            elif with_fields and fields[0] == "vn":
                normals.append(source.floats(number, fields[1:], 3))
            elif with_fields and fields[0] == "vt" and len(fields) > 2:
                texture.append(source.floats(number, fields[1:], 2))
            elif fields[0] in ("f", "fo", "l"):
                own_texture = own_texture and _own(fields[1:], 1)
                own_normals = own_normals and _own(fields[1:], 2)
                if not source.cells:
                    continue
                least = 2 if fields[0] == "l" else 3
                corners = _corners(source, number, fields[1:], len(points), least)
                (lines if fields[0] == "l" else faces).append(corners)
    if not points:
        source.fail("expected lines 'v x y z', found none")
    mesh = FileMesh(np.array(points))
    if len(colors) == len(points):
        mesh.fields["colors"] = _bytes(np.array(colors))
    if own_normals and len(normals) == len(points):
        mesh.fields["normals"] = np.array(normals)
    if own_texture and len(texture) == len(points):
        mesh.fields["uv"] = np.array(texture)
    if faces and source.cells:
        mesh.cells = simplices_of_faces(source, mesh.points, Faces.of(faces))
    if lines and source.cells:
        mesh.cells[2] = polyline_edges(lines)
        check_corners(source, mesh.cells[2], len(points))
    return mesh


def _own(fields: list[str], place: int) -> bool:
    """Whether no corner of a face names a texture or normal of another number."""
    parts = [field.split("/") for field in fields]
    return all(len(part) <= place or part[place] in ("", part[0]) for part in parts)


def _bytes(colors: FloatArray) -> NDArray[Any]:
    """Shares of 255, as they are written with a few digits; other colors stay."""
    scaled = colors * 255 if colors.max(initial=0) <= 1 else colors
    whole = np.rint(scaled)
    if (np.abs(scaled - whole) > 0.02).any() or not (
        0 <= whole.min() <= whole.max() < 256
    ):
        return colors
    return whole.astype(np.uint8)


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
    """Write vertices, their colors after them, normals and textures, then simplices."""
    colors = mesh.fields.get("colors")
    rows = mesh.points
    if colors is not None:
        shares = byte_colors(colors)[:, :3].astype(np.float64)
        rows = np.column_stack(
            [rows, shares / 255 if shares.max(initial=0) > 1 else shares]
        )
    file.writelines(f"# {line}\n".encode() for line in mesh.comment)
    file.writelines(f"v {' '.join(map(repr, row))}\n".encode() for row in rows.tolist())
    normals = mesh.fields.get("normals")
    if normals is not None:
        file.writelines(
            f"vn {x!r} {y!r} {z!r}\n".encode() for x, y, z in normals.tolist()
        )
    texture = mesh.fields.get("uv")
    if texture is not None:
        file.writelines(f"vt {u!r} {v!r}\n".encode() for u, v in texture.tolist())
    for size, cells in mesh.cells.items():
        element = "l" if size == 2 else "f"
        words = [*map(str, range(1, len(mesh.points) + 1))]
        if size > 2 and (texture is not None or normals is not None):
            words = [
                f"{word}/{word if texture is not None else ''}"
                f"{'/' + word if normals is not None else ''}"
                for word in words
            ]
        for cell in cells.tolist():
            corners = " ".join([words[corner] for corner in cell])
            file.write(f"{element} {corners}\n".encode())
