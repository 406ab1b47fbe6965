# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh as one file, written piece by piece as `remanifold.io.write_mesh` would."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from remanifold._base.files import complete_file
from remanifold.distributed._sources import Source
from remanifold.formats._mesh import FileMesh
from remanifold.formats._ply import ply_body, ply_header

VERTICES = 1_000_000  # at once


def check_mesh(path: Path, dim: int, ambient_dim: int, num_samples: int) -> None:
    """Refuse what the format does not hold."""
    if path.suffix.lower() != ".ply":
        msg = f"{path.name}: a distributed result is written as .ply, or stays in its parts"
        raise ValueError(msg)
    if dim > 2 or ambient_dim > 3:
        msg = (
            f"{path.name}: .ply holds edges and triangles in up to 3 coordinates, not "
            f"dimension {dim} in R^{ambient_dim}: the parts in the work directory hold all"
        )
        raise ValueError(msg)
    if num_samples > np.iinfo(np.int32).max:
        msg = f"{path.name}: .ply has no room for numbers of {num_samples:,} vertices"
        raise ValueError(msg)


def write_ply(
    path: Path,
    source: Source,
    num_samples: int,
    dim: int,
    num_simplices: int,
    blocks: Iterator[NDArray[np.int64]],
    *,
    with_attributes: bool,
) -> None:
    """Write vertices with their attributes, then edges or triangles."""
    check_mesh(path, dim, source.shape()[1], num_samples)

    def part(begin: int) -> FileMesh:
        end = min(begin + VERTICES, num_samples)
        points = source.read(begin, end)
        points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
        fields = source.attributes(begin, end) if with_attributes else {}
        return FileMesh(points, fields=fields)

    with complete_file(path) as file:
        first = part(0)
        file.write(ply_header(first, num_samples, {dim + 1: num_simplices}))
        for begin in range(0, num_samples, VERTICES):
            for data in ply_body(part(begin) if begin else first, like=first):
                file.write(data)
        for block in blocks:
            for data in ply_body(FileMesh(np.empty((0, 3)), {dim + 1: block})):
                file.write(data)
