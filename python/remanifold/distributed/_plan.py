# SPDX-License-Identifier: GPL-3.0-or-later
"""How space is cut into tiles, and these into cells: a balanced kd-tree over some samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

# Cells of a tile: what lies around a tile is read by cells.
CELLS_PER_TILE = 64


@dataclass(frozen=True)
class Plan:
    """A kd-tree whose leaves are cells, and which tile each cell is in.

    Inner nodes have an axis and a value, below which samples go left; children are
    numbers of nodes, or ~cell for leaves.
    """

    axes: NDArray[np.int64]
    values: NDArray[np.float64]
    children: NDArray[np.int64]  # (nodes, 2)
    cell_low: NDArray[np.float64]  # (cells, D); -inf and inf at the ends
    cell_high: NDArray[np.float64]
    tile_of_cell: NDArray[np.int64]
    low: NDArray[np.float64]  # extents of all samples
    high: NDArray[np.float64]

    @property
    def num_tiles(self) -> int:
        """Tiles are numbered from 0."""
        return int(self.tile_of_cell[-1]) + 1

    def cells_of(self, points: NDArray[np.float64]) -> NDArray[np.int64]:
        """The cell of each point."""
        node = np.zeros(len(points), dtype=np.int64)
        if not len(self.axes):
            return node
        inner = np.arange(len(points))
        while len(inner):
            at = node[inner]
            right = points[inner, self.axes[at]] >= self.values[at]
            node[inner] = self.children[at, right.astype(np.int64)]
            inner = inner[node[inner] >= 0]
        return ~node

    def tiles_of(self, points: NDArray[np.float64]) -> NDArray[np.int64]:
        """The tile of each point."""
        return self.tile_of_cell[self.cells_of(points)]

    def box(self, tile: int, halo: float) -> tuple[NDArray[np.float64], ...]:
        """Ends of a tile's box with so much around it; infinite where nothing is beyond."""
        own = self.tile_of_cell == tile
        low = self.cell_low[own].min(axis=0) - halo
        high = self.cell_high[own].max(axis=0) + halo
        low[low <= self.low] = -np.inf
        high[high > self.high] = np.inf
        return low, high

    def cells_inside(
        self,
        cells: NDArray[np.int64],
        low: NDArray[np.float64],
        high: NDArray[np.float64],
    ) -> NDArray[np.bool_]:
        """Which of some cells a box holds as a whole."""
        inside = (self.cell_low[cells] >= low) & (self.cell_high[cells] <= high)
        found: NDArray[np.bool_] = np.all(inside, axis=1)
        return found

    def neighbors_of(self, tile: int, distance: float) -> list[int]:
        """Tiles whose boxes are within a distance, in each coordinate."""
        low, high = self.box(tile, distance)
        return [
            other
            for other in np.unique(
                self.tile_of_cell[self.cells_within(low, high)]
            ).tolist()
            if other != tile
        ]

    def cells_within(
        self, low: NDArray[np.float64], high: NDArray[np.float64]
    ) -> NDArray[np.int64]:
        """Cells that a box meets, ascending."""
        meets = (self.cell_low <= high) & (self.cell_high >= low)
        return np.flatnonzero(meets.all(axis=1))


def make_plan(
    some: NDArray[np.float64],
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    num_samples: int,
    tile_size: int,
) -> Plan:
    """Halve the longest axis at the median until tiles, and cells, are small enough."""
    share = num_samples / len(some)
    axes: list[int] = []
    values: list[float] = []
    children: list[list[int]] = []
    lows: list[NDArray[np.float64]] = []
    highs: list[NDArray[np.float64]] = []
    tiles: list[int] = []
    num_tiles = 0

    def cut(
        rows: NDArray[np.int64],
        own_low: NDArray[np.float64],
        own_high: NDArray[np.float64],
        tile: int,
    ) -> int:
        nonlocal num_tiles
        if tile < 0 and len(rows) * share <= tile_size:
            tile = num_tiles
            num_tiles += 1
        wanted = tile_size / CELLS_PER_TILE if tile >= 0 else tile_size
        points = some[rows]
        extent = np.ptp(points, axis=0) if len(rows) else np.zeros(some.shape[1])
        axis = int(np.argmax(extent))
        if len(rows) * share <= wanted or extent[axis] == 0 or len(rows) < 4:
            if tile < 0:
                tile = num_tiles
                num_tiles += 1
            lows.append(own_low)
            highs.append(own_high)
            tiles.append(tile)
            return ~(len(tiles) - 1)
        middle = float(np.partition(points[:, axis], len(rows) // 2)[len(rows) // 2])
        left = points[:, axis] < middle
        if not left.any():  # many agree: the next larger one divides them
            middle = float(points[points[:, axis] > middle, axis].min())
            left = points[:, axis] < middle
        node = len(axes)
        axes.append(axis)
        values.append(middle)
        children.append([0, 0])
        left_high = own_high.copy()
        left_high[axis] = middle
        right_low = own_low.copy()
        right_low[axis] = middle
        children[node][0] = cut(rows[left], own_low, left_high, tile)
        children[node][1] = cut(rows[~left], right_low, own_high, tile)
        return node

    endless = np.full(some.shape[1], np.inf)
    cut(np.arange(len(some)), -endless, endless, -1)
    return Plan(
        np.array(axes, dtype=np.int64),
        np.array(values, dtype=np.float64),
        np.array(children, dtype=np.int64).reshape(-1, 2),
        np.array(lows),
        np.array(highs),
        np.array(tiles, dtype=np.int64),
        low,
        high,
    )
