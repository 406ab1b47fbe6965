# SPDX-License-Identifier: GPL-3.0-or-later
"""PTX: scans as images, each with where its scanner stood."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold.formats._mesh import FileMesh
from remanifold.formats._source import FloatArray, Source
from remanifold.formats._text import split_lines

_HEAD = 10  # lines: columns, rows, where the scanner is, its axes, a matrix


def read_ptx(source: Source, with_fields: bool) -> FileMesh:  # noqa: ARG001  fields come along
    """Read all scans in common coordinates; pixels without a point are NaN."""
    lines = split_lines(source.decoded())
    points: list[FloatArray] = []
    others: list[FloatArray] = []
    scans: list[NDArray[np.int32]] = []
    line = 0
    while line < len(lines):
        if not lines[line].strip():
            line += 1
            continue
        part, matrix, line = _scan(source, lines, line)
        unseen = (part[:, :3] == 0).all(axis=1)
        with np.errstate(over="ignore", invalid="ignore"):
            moved = part[:, :3] @ matrix[:3, :3] + matrix[3, :3]
        moved[unseen] = np.nan
        points.append(moved)
        others.append(part[:, 3:])
        scans.append(np.full(len(part), len(scans), dtype=np.int32))
    if not points:
        source.fail("is empty")
    widths = {part.shape[1] for part in others}
    if len(widths) > 1:
        source.fail("holds scans with and without colors")
    values = np.concatenate(others)
    fields: dict[str, NDArray[Any]] = {"intensity": values[:, 0]} if values.size else {}
    if values.shape[1] == 4:
        fields["colors"] = np.clip(values[:, 1:], 0, 255).astype(np.uint8)
    if len(scans) > 1:
        fields["scan"] = np.concatenate(scans)
    mesh = FileMesh(np.concatenate(points), fields=fields)
    mesh.chosen = f"coordinates are those of {len(scans)} scans, put together"
    return mesh


def _scan(
    source: Source, lines: list[str], start: int
) -> tuple[FloatArray, FloatArray, int]:
    """Rows of one scan, its matrix, and the line after it."""
    if len(lines) < start + _HEAD:
        source.fail(f"is truncated: expected a header of {_HEAD} lines", line=start + 1)
    width, height = (
        source.count(start + i + 1, lines[start + i].strip()) for i in (0, 1)
    )
    for i in range(2, 6):
        source.floats(start + i + 1, lines[start + i].split(), 3)
    matrix = np.array(
        [
            source.floats(start + i + 1, lines[start + i].split(), 4)
            for i in range(6, 10)
        ]
    )
    first = start + _HEAD
    rows = lines[first : first + width * height]
    if len(rows) < width * height:
        what = f"expected {width:,} by {height:,} points, found {len(rows):,}"
        source.fail(f"is truncated: {what}")
    columns = len(rows[0].split()) if rows else 3
    if columns not in (3, 4, 7):
        what = f"expected 3, 4 or 7 numbers a point, found {columns}"
        source.fail(what, line=first + 1)
    found = np.empty((len(rows), columns))
    for i, row in enumerate(rows):
        words = row.split()
        if len(words) != columns:
            what = f"expected {columns} numbers, found {len(words)}"
            source.fail(what, line=first + i + 1)
        found[i] = source.floats(first + i + 1, words, columns)
    return found, matrix, first + len(rows)
