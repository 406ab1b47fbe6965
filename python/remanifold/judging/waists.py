# SPDX-License-Identifier: GPL-3.0-or-later
"""The narrowest tubes of triangulated surfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def tubes(
    rows: NDArray[np.int32], bent: NDArray[np.bool_], least: int
) -> NDArray[np.int32]:
    """Loops of three edges that bound no disc of fewer triangles than so many.

    Parameters
    ----------
    rows : ndarray, shape (M, 3), int32
        Triangles of a surface, the vertices of each ascending.
    bent : ndarray, shape (N,), bool
        Vertices of which each loop has one at least.
    least : int
        Triangles on either side from which on a loop counts.

    Returns
    -------
    ndarray, shape (L, 3), int32
        The vertices of each loop, ascending.
    """
    near = np.zeros(len(bent), dtype=bool)
    near[rows[bent[rows].any(axis=1)]] = True
    loops = _empty_triangles(rows[near[rows].any(axis=1)])
    loops = loops[bent[loops].any(axis=1)]
    if len(loops) == 0:
        return loops
    surface = _Surface(rows)
    found = [loop for loop in loops if surface.is_wide(loop, least)]
    return np.array(found, dtype=np.int32).reshape(-1, 3)


class _Surface:
    """Triangles and those next to them."""

    def __init__(self, rows: NDArray[np.int32]) -> None:
        self._rows = rows
        self._count = int(rows.max()) + 1
        keys = _keys(rows, self._count)
        self._order = np.argsort(keys, kind="stable")
        self._keys = keys[self._order]

    def is_wide(self, loop: NDArray[np.int32], least: int) -> bool:
        """Whether so many triangles are on either side of a loop."""
        walls = _keys(loop[None, :], self._count).tolist()
        sides = self._at(walls[0])
        return len(sides) == 2 and all(
            self._reaches(first, {*walls}, least) for first in sides
        )

    def _at(self, key: int) -> list[int]:
        begin = np.searchsorted(self._keys, key)
        end = np.searchsorted(self._keys, key, side="right")
        numbers: list[int] = (self._order[begin:end] % len(self._rows)).tolist()
        return numbers

    def _reaches(self, first: int, walls: set[int], least: int) -> bool:
        seen, waiting = {first}, [first]
        while waiting and len(seen) < least:
            row = self._rows[waiting.pop()]
            for key in _keys(row[None, :], self._count).tolist():
                if key not in walls:
                    new = [other for other in self._at(key) if other not in seen]
                    seen.update(new)
                    waiting.extend(new)
        return len(seen) >= least


def _keys(rows: NDArray[np.int32], count: int) -> NDArray[np.int64]:
    """Numbers of the edges of triangles: all of one kind, then those of the next."""
    edges = np.concatenate([rows[:, :2], rows[:, ::2], rows[:, 1:]]).astype(np.int64)
    return edges[:, 0] * count + edges[:, 1]


def _empty_triangles(rows: NDArray[np.int32]) -> NDArray[np.int32]:
    """Three edges that meet in pairs and bound no triangle."""
    if len(rows) == 0:
        return rows
    count = int(rows.max()) + 1
    keys = np.unique(_keys(rows, count))
    tails, heads = keys // count, keys % count
    # Each edge with those that go on from its head to higher numbers.
    begin = np.searchsorted(tails, heads)
    number = np.searchsorted(tails, heads, side="right") - begin
    edge = np.repeat(np.arange(len(keys)), number)
    within = np.arange(len(edge)) - np.repeat(np.cumsum(number) - number, number)
    last = heads[begin[edge] + within]
    place = np.searchsorted(keys, tails[edge] * count + last)
    closed = keys[np.minimum(place, len(keys) - 1)] == tails[edge] * count + last
    loops = np.stack([tails[edge], heads[edge], last], axis=1)[closed]
    bound = np.searchsorted(keys, _keys(rows, count)[: len(rows)]) * count + rows[:, 2]
    loops = loops[~np.isin(edge[closed] * count + last[closed], bound)]
    empty: NDArray[np.int32] = loops.astype(np.int32)
    return empty
