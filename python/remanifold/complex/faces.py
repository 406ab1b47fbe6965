# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces of all dimensions of a complex, numbered, and what their boundaries are."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def boundary_operators(
    simplices: NDArray[np.int32], count: int
) -> tuple[tuple[Any, ...], tuple[NDArray[np.int32], ...]]:
    """Boundary operators as sparse matrices, and the simplices that they are about.

    Operators from dimension 1 to K, of int8; simplices of dimension 0 to K. Below K
    these are sorted, and oriented by ascending vertices.
    """
    from scipy import sparse

    levels: list[NDArray[np.int32]] = [simplices]
    boundaries: list[Any] = []
    for size in range(simplices.shape[1], 1, -1):
        rows = levels[0]
        order = np.argsort(rows, axis=1, kind="stable")
        ascending = np.take_along_axis(rows, order, axis=1)
        turned = parities(order)
        faces = np.concatenate([np.delete(ascending, i, axis=1) for i in range(size)])
        signs = np.concatenate([turned * (-1) ** i for i in range(size)])
        columns = np.tile(np.arange(len(rows)), size)
        known, number = _numbered(faces, count)
        shape = (len(known), len(rows))
        entries = (signs.astype(np.int8), (number, columns))
        boundaries.insert(0, sparse.csr_array(entries, shape=shape))
        levels.insert(0, known)
    return tuple(boundaries), tuple(levels)


def face_numbers(
    simplices: NDArray[np.int32], dim: int, count: int
) -> tuple[list[tuple[int, ...]], NDArray[np.int64]]:
    """Which faces of a dimension each simplex has, as rows of `boundary_operators`.

    Simplices ascend. Returns the faces as places in a simplex, and their numbers, one
    column each.
    """
    size = simplices.shape[1]
    places = list(itertools.combinations(range(size), dim + 1))
    if dim == size - 1:
        return places, np.arange(len(simplices), dtype=np.int64)[:, None]
    faces = np.concatenate([simplices[:, list(place)] for place in places])
    _, number = _numbered(faces, count)
    return places, np.ascontiguousarray(number.reshape(len(places), -1).T)


def _numbered(
    faces: NDArray[np.int32], count: int
) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Different rows in their order, and which of them each row is; vertices are all."""
    if faces.shape[1] == 1:
        return np.arange(count, dtype=np.int32)[:, None], faces[:, 0].astype(np.int64)
    known, number = np.unique(faces, axis=0, return_inverse=True)
    return known.astype(np.int32), number.reshape(-1).astype(np.int64)


def parities(order: NDArray[np.intp]) -> NDArray[np.int64]:
    """1 for even permutations, -1 for odd ones."""
    size = order.shape[1]
    inversions = sum(
        (order[:, i] > order[:, j]).astype(np.int64)
        for i in range(size)
        for j in range(i + 1, size)
    )
    return np.asarray(1 - 2 * (inversions % 2))
