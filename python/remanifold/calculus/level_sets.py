# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a function has a value: points, polylines, triangles, for any K."""

from __future__ import annotations

import functools
import itertools
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from remanifold.complex.faces import parities

if TYPE_CHECKING:
    from numpy.typing import NDArray


class LevelSet(NamedTuple):
    """A complex of dimension K - 1 whose vertices lie on edges.

    Attributes
    ----------
    simplices : ndarray, shape (M', K), int32
    edges : ndarray, shape (N', 2), int32
        Ends of the edge that each vertex lies on, below the level and above it; the
        same twice where the level is met at a vertex.
    shares : ndarray, shape (N',), float64
        How far each lies along its edge, from 0 to 1.
    """

    simplices: NDArray[np.int32]
    edges: NDArray[np.int32]
    shares: NDArray[np.float64]


@functools.cache
def _staircases(
    low: int, high: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """A product of two simplices cut into simplices, each an ascending way.

    Returns the corners of both as (ways, K) each, and the orientation of each piece in
    a simplex whose corners are the low ones and then the high ones, so that the values
    ascend along its normal.
    """
    ways = []
    for up in itertools.combinations(range(low + high - 2), high - 1):
        at, way = [0, 0], [(0, 0)]
        for step in range(low + high - 2):
            at[step in up] += 1
            way.append((at[0], at[1]))
        ways.append(way)
    corners = np.array(ways, dtype=np.int64)
    count = low + high
    # Half way along each edge the pieces are as they are for any values.
    places = (
        np.eye(count)[corners[:, :, 0]] + np.eye(count)[low + corners[:, :, 1]]
    ) / 2
    normal = np.concatenate([-np.ones(low) / low, np.ones(high) / high])
    rows = np.concatenate(
        [
            np.broadcast_to(normal, (len(places), 1, count)),
            places[:, 1:] - places[:, :1],
        ],
        axis=1,
    )[:, :, 1:]
    signs = np.sign(np.linalg.det(rows)).astype(np.int64)
    return corners[:, :, 0], corners[:, :, 1], signs


def level_set(
    simplices: NDArray[np.int32], values: NDArray[np.float64], level: float
) -> LevelSet:
    """Cut each simplex; neighbors agree, since their corners are in one order."""
    above = values >= level
    corners = simplices.shape[1]
    number = above[simplices].sum(axis=1)
    cut = simplices[(number > 0) & (number < corners)]
    # Low corners first, each kind by number.
    order = np.lexsort((cut, above[cut]), axis=1) if len(cut) else cut.astype(np.intp)
    ordered = np.take_along_axis(cut, order, axis=1)
    turned = parities(order) if len(cut) else np.empty(0, dtype=np.int64)
    lows = (~above[ordered]).sum(axis=1)
    pieces: list[NDArray[np.int32]] = []
    for low in range(1, corners):
        own = lows == low
        below, over, signs = _staircases(low, corners - low)
        ends = np.stack([ordered[own][:, below], ordered[own][:, low + over]], axis=3)
        # The last two corners change places where the orientation is the other one.
        if corners > 2:
            wrong = turned[own][:, None] * signs < 0
            ends[wrong, -2:] = ends[wrong, :-3:-1]
        pieces.append(ends.reshape(-1, corners - 1, 2))
    found = np.concatenate(pieces)
    # Values that are met at a vertex are met there for all edges to it.
    met = values[found[:, :, 1]] == level
    found[met, 0] = found[met, 1]
    flat = found.reshape(-1, 2)
    edges, number_of = np.unique(flat, axis=0, return_inverse=True)
    rows = number_of.reshape(-1, corners - 1)
    ascending = np.sort(rows, axis=1)
    whole = (ascending[:, 1:] != ascending[:, :-1]).all(axis=1)
    _, first = np.unique(ascending[whole], axis=0, return_index=True)
    rows = rows[whole][np.sort(first)]
    used = np.unique(rows)
    edges = edges[used]
    start, end = values[edges[:, 0]], values[edges[:, 1]]
    steps = np.where(end > start, end - start, 1.0)
    return LevelSet(
        np.searchsorted(used, rows).astype(np.int32),
        edges.astype(np.int32),
        np.clip((level - start) / steps, 0.0, 1.0),
    )
