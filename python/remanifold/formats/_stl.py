# SPDX-License-Identifier: GPL-3.0-or-later
"""STL: the corners of facets, as text or binary."""

from __future__ import annotations

from typing import IO

import numpy as np

from remanifold.formats._mesh import FileMesh, first_of_equal_rows
from remanifold.formats._source import FloatArray, Source


def read_stl(source: Source, with_fields: bool) -> FileMesh:  # noqa: ARG001  has none
    """Corners with the same coordinates become one vertex."""
    start = source.data[:1024].lower()
    if start.startswith(b"solid") and b"facet" in start:
        corners = _ascii(source)
    else:
        corners = _binary(source)
    first, places = first_of_equal_rows(corners)
    mesh = FileMesh(corners[first])
    if source.cells:
        mesh.cells[3] = places.reshape(-1, 3)
    return mesh


# The words of a facet but for its numbers, by their places.
_WORDS = dict(
    zip(
        (0, 1, 5, 6, 7, 11, 15, 19, 20),
        b"facet normal outer loop vertex vertex vertex endloop endfacet".split(),
        strict=True,
    )
)


_PART = 1 << 24  # bytes that are read at once


def _regular(source: Source) -> FloatArray | None:
    """Read facets written as by most programs, fast; None if anything is unusual."""
    data = source.data
    start, end = data.find(b"facet"), data.rfind(b"endsolid")
    parts = []
    while 0 <= start < end:
        stop = data.rfind(b"endfacet", start, min(start + _PART, end)) + len(
            b"endfacet"
        )
        part = _regular_part(data[start:stop].split()) if stop > start else None
        if part is None:
            return None
        parts.append(part)
        start = data.find(b"facet", stop, end)
        if data[stop : start if start >= 0 else end].strip():
            return None
    return np.concatenate(parts) if parts else None


def _regular_part(words: list[bytes]) -> FloatArray | None:
    count = len(words) // 21
    if count == 0 or len(words) % 21:
        return None
    for place, word in _WORDS.items():
        if words[place::21].count(word) != count:
            return None
    places = [*range(8, 11), *range(12, 15), *range(16, 19)]
    try:
        numbers = [[*map(float, words[place::21])] for place in places]
    except ValueError:
        return None
    return np.asarray(np.array(numbers).T.reshape(-1, 3))


def _ascii(source: Source) -> FloatArray:
    regular = _regular(source)
    if regular is not None:
        return regular
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
        source.fail(f"is truncated: expected an STL header, found {len(data):,} bytes")
    count = int.from_bytes(data[80:84], "little")
    facet = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("", "<u2")])
    expected = 84 + count * facet.itemsize
    if len(data) < expected:
        what = f"{count:,} facets in {expected:,} bytes, found {len(data):,} bytes"
        source.fail(f"is truncated or no STL: expected {what}")
    facets = np.frombuffer(data, facet, count, offset=84)
    return facets["corners"].reshape(-1, 3).astype(np.float64)


_LONGEST_NAME = 200  # readers look for the first facet not far from the beginning


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
    lines = [f"vertex {x!r} {y!r} {z!r}\n" for x, y, z in mesh.points.tolist()]
    # One line, which some readers cut at 80 letters: what made it, and the last digest.
    name = " ".join(["solid", *mesh.comment[:1], *mesh.comment[1:][-1:]])
    file.write(f"{name[:_LONGEST_NAME]}\n".encode())
    for normal, (a, b, c) in zip(normals.tolist(), mesh.cells[3].tolist(), strict=True):
        x, y, z = normal
        file.write(
            f"facet normal {x:.9g} {y:.9g} {z:.9g}\nouter loop\n"
            f"{lines[a]}{lines[b]}{lines[c]}endloop\nendfacet\n".encode()
        )
    file.write(b"endsolid\n")


def _unit(vectors: FloatArray) -> FloatArray:
    """Scale vectors to length 1; zero stays zero."""
    largest = np.max(np.abs(vectors), axis=1, keepdims=True, initial=0.0)
    vectors = vectors / np.where(largest > 0, largest, 1.0)
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors / np.where(length > 0, length, 1.0))
