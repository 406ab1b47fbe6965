# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a complex is another one without some of its simplices."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from remanifold import _core

if TYPE_CHECKING:
    from numpy.typing import NDArray


def mark_rows(
    rows: NDArray[np.int32], wanted: NDArray[np.int32], num_vertices: int
) -> NDArray[np.bool_]:
    """Which rows are among the wanted ones, all with ascending vertices."""
    touched = np.zeros(num_vertices, dtype=bool)
    touched[wanted] = True
    near = np.flatnonzero(touched[rows].all(axis=1))
    own = {*map(tuple, wanted.tolist())}
    marked = np.zeros(len(rows), dtype=bool)
    marked[near] = [tuple(row) in own for row in rows[near].tolist()]
    return marked


def removal_changes(
    rows: NDArray[np.int32],
    removed: NDArray[np.bool_],
    rim: NDArray[np.int32],
    num_vertices: int,
) -> bool:
    """Whether components, Euler characteristic or number of rims become others.

    They do not where simplices are taken away from a rim: the rim moves. Faces are
    counted around the removed simplices only, components only where the count is even.

    Parameters
    ----------
    rows : ndarray, shape (M, K+1), int32
        Simplices, the vertices of each ascending.
    removed : ndarray, shape (M,), bool
    rim : ndarray, shape (H, K), int32
        Faces of a single simplex, the vertices of each ascending.
    num_vertices : int

    Returns
    -------
    bool
    """
    dim = rows.shape[1] - 1
    touched = np.zeros(num_vertices, dtype=bool)
    touched[rows[removed]] = True
    near = np.flatnonzero(touched[rows].any(axis=1))
    around, rest = rows[near], rows[near[~removed[near]]]
    euler = (-1) ** dim * int(np.count_nonzero(removed))
    for k in range(dim):
        vanished = len(_faces(around, k)[0]) - len(_faces(rest, k)[0])
        euler += (-1) ** k * vanished
    if euler != 0:
        return True
    whole = _core.component_labels(rows, num_vertices).max(initial=-1)
    left = _core.component_labels(rows[~removed], num_vertices).max(initial=-1)
    if whole != left:
        return True
    faces, cofaces = _faces(rest, dim - 1)
    inside = touched[faces].any(axis=1)  # those whose cofaces are all here
    kept = ~touched[rim].any(axis=1)
    moved = np.concatenate([rim[kept], faces[inside & (cofaces == 1)]])
    return _number_of_sets(rim) != _number_of_sets(moved)


def closing_changes(
    rows: NDArray[np.int32],
    added: NDArray[np.int32],
    rim: NDArray[np.int32],
    num_vertices: int,
) -> bool:
    """Whether components, Euler characteristic or number of rims become others.

    By simplices that close an open place. Where they do not fit what is there, are all
    there already or have a vertex that nothing else has, it is not known what closing it
    would do, and that counts as a change.

    Parameters
    ----------
    rows : ndarray, shape (M, K+1), int32
        Simplices, the vertices of each ascending.
    added : ndarray, shape (A, K+1), int32
        Simplices through the place, of which some may be among `rows`.
    rim : ndarray, shape (H, K), int32
        Faces of a single one of the `rows`, the vertices of each ascending.
    num_vertices : int

    Returns
    -------
    bool
    """
    dim = rows.shape[1] - 1
    added = np.unique(np.sort(added, axis=1), axis=0)
    touched = np.zeros(num_vertices, dtype=bool)
    touched[added] = True
    near = rows[touched[rows].any(axis=1)]
    added = added[~mark_rows(added, near, num_vertices)]
    used = np.zeros(num_vertices, dtype=bool)
    used[rows] = True
    if len(added) == 0 or not used[added].all():
        return True
    of_added, _ = _faces(added, dim - 1)
    faces, cofaces = _faces(np.concatenate([near, added]), dim - 1)
    own = mark_rows(faces, of_added, num_vertices)
    if (cofaces[own] > 2).any():
        return True
    kept = ~mark_rows(rim, of_added, num_vertices)
    moved = np.concatenate([rim[kept], faces[own & (cofaces == 1)]])
    closed = np.concatenate([rows, added])
    removed = np.arange(len(closed)) >= len(rows)
    return removal_changes(closed, removed, moved, num_vertices)


def _faces(
    rows: NDArray[np.int32], dim: int
) -> tuple[NDArray[np.int32], NDArray[np.intp]]:
    """Faces of a dimension, and in how many of the rows each is."""
    columns = [list(own) for own in combinations(range(rows.shape[1]), dim + 1)]
    faces = np.concatenate([rows[:, own] for own in columns])
    return np.unique(faces, axis=0, return_counts=True)


def _number_of_sets(faces: NDArray[np.int32]) -> int:
    return int(_core.face_sets(faces).max(initial=-1)) + 1
