# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids of heights as text, Esri's ASCII raster, as a point for each cell."""

from __future__ import annotations

import math
import re

import numpy as np

from remanifold.formats._mesh import FileMesh
from remanifold.formats._source import Source
from remanifold.formats._text import split_lines

_KEYS = (
    "ncols",
    "nrows",
    "xllcorner",
    "yllcorner",
    "xllcenter",
    "yllcenter",
    "cellsize",
)


def read_grid(source: Source) -> FileMesh | None:
    """Centers of the cells with their heights, NaN where there is none; or None."""
    lines = split_lines(source.decoded())
    if not lines or not re.match(r"\s*ncols\s", lines[0], re.IGNORECASE):
        return None
    head: dict[str, float] = {}
    start = 0
    while start < len(lines) and re.match(r"\s*[A-Za-z]", lines[start]):
        words = lines[start].split()
        head[words[0].lower()] = source.floats(start + 1, words[1:], 1)[0]
        start += 1
    sizes = ("ncols", "nrows", "cellsize")
    missing = [key for key in sizes if not 0 < head.get(key, 0) < math.inf]
    if missing:
        source.fail(f"is a grid of heights without {', '.join(missing)} in its header")
    width, height, size = int(head["ncols"]), int(head["nrows"]), head["cellsize"]
    words = " ".join(lines[start:]).replace(",", ".").split()
    if len(words) != width * height:
        what = f"expected {height} rows of {width} heights"
        source.fail(f"is truncated or damaged: {what}, found {len(words):,} numbers")
    try:
        heights = np.array(words, dtype=np.float64).reshape(height, width)
    except ValueError as error:
        source.fail(f"holds a height that is no number ({error})", error)
    heights[heights == head.get("nodata_value", -9999.0)] = np.nan
    half = size / 2
    left = head.get("xllcenter", head.get("xllcorner", 0.0) + half)
    low = head.get("yllcenter", head.get("yllcorner", 0.0) + half)
    x = left + size * np.arange(width)
    y = low + size * np.arange(height)[::-1]
    mesh = FileMesh(
        np.column_stack([np.tile(x, height), np.repeat(y, width), heights.ravel()])
    )
    mesh.chosen = "coordinates are the centers of a grid's cells and their heights"
    return mesh
