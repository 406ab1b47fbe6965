# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarser meshes for display, by clusters of vertices (Rossignac and Borrel, 1993)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def thinned(
    points: NDArray[np.float64], cells: NDArray[np.int32], limit: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """At most `limit` cells that look like the given ones.

    Parameters
    ----------
    points : ndarray, shape (N, 3)
        Positions; those of vertices in cells are finite.
    cells : ndarray, shape (M, 2) or (M, 3)
        Edges or triangles.
    limit : int
        Most cells.

    Returns
    -------
    kept : ndarray of int, shape (P,)
        Vertices that are left, ascending.
    cells : ndarray, shape (at most `limit`, 2 or 3)
        Cells, as indices of `kept`.
    """
    used = np.zeros(len(points), dtype=bool)
    used[cells.ravel()] = True
    kept = np.flatnonzero(used)
    number = np.zeros(len(points), dtype=np.intp)
    number[kept] = np.arange(len(kept))
    rows = number[cells]
    if len(rows) <= limit:
        return kept, rows
    own = points[kept]
    dim = cells.shape[1] - 1
    side = own[rows[:, 0]] - own[rows[:, 1]]
    spacing = float(np.sqrt((side**2).sum(axis=1)).mean())
    extent = float(np.ptp(own, axis=0).max())
    # As many grid cells are met as the surface has squares of their width.
    width = max(spacing * (len(rows) / limit) ** (1 / dim) * 0.8, extent * 1e-6)
    while width > 0:
        leaders = _leaders(own, width)
        coarse = _distinct(leaders[rows])
        if len(coarse) == 0:
            break
        if len(coarse) <= limit:
            left, coarse = np.unique(coarse, return_inverse=True)
            return kept[left], coarse.reshape(-1, dim + 1)
        width *= 1.12
    # All at one place, or so many edges of a solid that clusters swallow all.
    some = rows[np.arange(limit) * len(rows) // limit]
    left, rows = np.unique(some, return_inverse=True)
    return kept[left], rows.reshape(-1, dim + 1)


def _leaders(points: NDArray[np.float64], width: float) -> NDArray[np.intp]:
    """Of each point, that of its grid cell nearest to the mean of the points in it."""
    grid = np.floor((points - points.min(axis=0)) / width).astype(np.int64)
    shape = grid.max(axis=0) + 1
    keys = (grid[:, 0] * shape[1] + grid[:, 1]) * shape[2] + grid[:, 2]
    _, cluster, size = np.unique(keys, return_inverse=True, return_counts=True)
    cluster = cluster.ravel()
    means = np.stack([np.bincount(cluster, column) / size for column in points.T], 1)
    away = ((points - means[cluster]) ** 2).sum(axis=1)
    order = np.lexsort((away, cluster))
    firsts = order[np.cumsum(size) - size]
    return np.asarray(firsts[cluster])


def _distinct(rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Cells with as many vertices as before, each once, turned as they were."""
    ordered = np.sort(rows, axis=1)
    whole = (ordered[:, 1:] != ordered[:, :-1]).all(axis=1)
    rows, ordered = rows[whole], ordered[whole]
    order = np.lexsort(ordered.T[::-1])
    ordered = ordered[order]
    new = np.ones(len(ordered), dtype=bool)
    new[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    return np.asarray(rows[np.sort(order[new])])
