# SPDX-License-Identifier: GPL-3.0-or-later
"""STL: the corners of facets, as text or binary."""

from __future__ import annotations

from typing import IO

import numpy as np

from remanifold.io._mesh import FileMesh
from remanifold.io._source import FloatArray, Source


def read_stl(source: Source, cells: bool) -> FileMesh:
    """Corners with the same coordinates become one vertex."""
    start = source.data[:1024].lower()
    if start.startswith(b"solid") and b"facet" in start:
        corners = _ascii(source)
    else:
        corners = _binary(source)
    points, first, inverse = np.unique(
        corners.reshape(-1, 3), axis=0, return_index=True, return_inverse=True
    )
    order = np.argsort(first)
    mesh = FileMesh(points[order])
    if cells:
        rank = np.empty(len(order), dtype=np.int64)
        rank[order] = np.arange(len(order))
        mesh.cells[3] = rank[np.ravel(inverse)].reshape(-1, 3)
    return mesh


def _ascii(source: Source) -> FloatArray:
    corners = []
    last = ""
    with source.text() as file:
        for line, text in enumerate(file, 1):
            words = text.strip().lower()
            last = words or last
            if words.startswith("vertex"):
                corners.append(source.floats(line, words.split()[1:], 3))
    if not last.startswith("endsolid") or len(corners) % 3:
        what = "expected facets of three vertices, then 'endsolid'"
        source.fail(f"is truncated: {what}")
    return np.array(corners)


def _binary(source: Source) -> FloatArray:
    data = source.data
    if len(data) < 84:
        source.fail(f"is truncated: expected an STL header, found {len(data)} bytes")
    count = int.from_bytes(data[80:84], "little")
    facet = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("", "<u2")])
    expected = 84 + count * facet.itemsize
    if len(data) < expected:
        what = f"{count} facets in {expected} bytes, found {len(data)} bytes"
        source.fail(f"is truncated or no STL: expected {what}")
    facets = np.frombuffer(data, facet, count, offset=84)
    return facets["corners"].reshape(-1, 3).astype(np.float64)


def write_stl(file: IO[bytes], mesh: FileMesh) -> None:
    """Write text, which unlike binary STL holds doubles."""
    corners = mesh.points[mesh.cells[3]]
    # In this way very long and very short edges neither overflow nor vanish, and a
    # degenerate triangle has the normal zero.
    normals = _unit(
        np.cross(
            _unit(corners[:, 1] - corners[:, 0]), _unit(corners[:, 2] - corners[:, 0])
        )
    )
    file.write(b"solid\n")
    for normal, facet in zip(normals.tolist(), corners.tolist(), strict=True):
        rows = [f"vertex {x!r} {y!r} {z!r}\n" for x, y, z in facet]
        x, y, z = normal
        file.write(
            f"facet normal {x!r} {y!r} {z!r}\nouter loop\n{''.join(rows)}"
            "endloop\nendfacet\n".encode()
        )
    file.write(b"endsolid\n")


def _unit(vectors: FloatArray) -> FloatArray:
    """Scale vectors to length 1; zero stays zero."""
    largest = np.max(np.abs(vectors), axis=1, keepdims=True, initial=0.0)
    vectors = vectors / np.where(largest > 0, largest, 1.0)
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.where(length > 0, length, 1.0))
