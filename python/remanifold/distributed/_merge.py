# SPDX-License-Identifier: GPL-3.0-or-later
"""From what each tile says to what the whole says, the same in any order."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold import _core
from remanifold._base.samples import Points
from remanifold.distributed._store import Arrays, Part, Store

# What a tile says of its patches.
PATCHES = (
    *("orientable", "component", "open", "patches"),
    *("first", "first_points", "first_sign", "volumes", "sizes"),
)


class _SignedSets:
    """Disjoint sets with a sign between members."""

    def __init__(self, size: int) -> None:
        self.parent = list(range(size))
        self.sign = [1] * size

    def find(self, node: int) -> tuple[int, int]:
        path = []
        while self.parent[node] != node:
            path.append(node)
            node = self.parent[node]
        sign = 1
        for member in reversed(path):
            sign *= self.sign[member]
            self.parent[member] = node
            self.sign[member] = sign
        return node, sign

    def join(self, a: int, b: int, product: int) -> bool:
        """Demand a sign; False where that contradicts."""
        root_a, sign_a = self.find(a)
        root_b, sign_b = self.find(b)
        if root_a == root_b:
            return sign_a * sign_b == product
        child, root = max(root_a, root_b), min(root_a, root_b)
        self.parent[child] = root
        self.sign[child] = sign_a * sign_b * product
        return True


def ranked_piece(
    counts: list[tuple[NDArray[np.uint64], NDArray[np.int64]]], rank: int
) -> tuple[int, int]:
    """The key that the rank-th of all that were counted has, and its rank among these."""
    keys = np.concatenate([one for one, _ in counts])
    numbers = np.concatenate([one for _, one in counts])
    pieces, slot = np.unique(keys, return_inverse=True)
    ends = np.cumsum(np.bincount(slot, weights=numbers).astype(np.int64))
    at = int(np.searchsorted(ends, rank, side="right"))
    return int(pieces[at]), rank - (int(ends[at - 1]) if at else 0)


@dataclass
class Whole:
    """What the tiles are together."""

    turns: list[NDArray[np.int8]]  # of the patches of each tile; 0 where none
    num_components: int
    orientable: bool
    num_unsure: (
        int  # closed patches with so little volume that rounding may orient them
    )


def merge(
    store: Store, parts: list[Part], whole: Any, ambient_dim: int, dim: int
) -> Whole:
    """Join the patches of the tiles along the seams, and turn each as in one piece."""
    tiles = [store.get(part, *PATCHES) for part in parts]  # no simplices
    counts = [len(tile["orientable"]) for tile in tiles]
    starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    sets, components = _SignedSets(int(starts[-1])), _SignedSets(int(starts[-1]))
    twisted = []
    for t, tile in enumerate(tiles):
        twisted += (starts[t] + np.flatnonzero(~tile["orientable"])).tolist()
        lowest: dict[int, int] = {}
        for patch, label in enumerate(tile["component"].tolist()):
            components.join(
                int(starts[t] + patch),
                lowest.setdefault(label, int(starts[t] + patch)),
                1,
            )
    for t, part in enumerate(parts):
        for other in map(int, part.meta["seams"]):
            if other < t or other not in part.meta["joins"]:
                continue
            patch_here, sign_here = _seam(store, part, other)
            patch_there, sign_there = _seam(store, parts[other], t)
            products = sign_here * sign_there
            joins = np.stack([patch_here, patch_there, products], axis=1)
            for a, b, product in np.unique(joins, axis=0).tolist():
                node_a, node_b = int(starts[t] + a), int(starts[other] + b)
                components.join(node_a, node_b, 1)
                if not sets.join(node_a, node_b, product):
                    twisted.append(node_a)
    nodes_found = [sets.find(node) for node in range(int(starts[-1]))]
    roots, signs = np.array(nodes_found, dtype=np.int64).reshape(-1, 2).T
    is_open, has_own = np.zeros(len(roots)), np.zeros(len(roots), dtype=bool)
    volumes, sizes = np.zeros(len(roots)), np.zeros(len(roots))
    for t, tile in enumerate(tiles):
        nodes = starts[t] + np.arange(counts[t])
        np.add.at(is_open, roots[nodes], tile["open"])
        nodes = starts[t] + tile["patches"].astype(np.int64)
        has_own[roots[nodes]] = True
        np.add.at(volumes, roots[nodes], signs[nodes] * tile["volumes"])
        np.add.at(sizes, roots[nodes], tile["sizes"])
    turn = _first_signs(tiles, starts, roots, signs, whole)
    if ambient_dim - dim in (0, 1):
        by_volume = (is_open == 0) | (ambient_dim == dim)
        turn = np.where(by_volume & (volumes != 0), np.sign(volumes), turn)
    else:
        by_volume = np.zeros(len(roots), dtype=bool)
    orientable = np.ones(len(roots), dtype=bool)
    orientable[[sets.find(node)[0] for node in twisted]] = False
    turn = np.where(orientable, turn, 0)
    turns = [
        (turn[roots[begin:end]] * signs[begin:end]).astype(np.int8)
        for begin, end in itertools.pairwise(starts)
    ]
    # The sign of a sum that rounding could turn is none to go by.
    unsure = by_volume & orientable & has_own & (np.abs(volumes) <= 1e-9 * sizes)
    own = np.flatnonzero(has_own)
    return Whole(
        turns,
        len({components.find(int(node))[0] for node in own}),
        bool(orientable[own].all()),
        int(unsure.sum()),
    )


def _seam(store: Store, part: Part, other: int) -> tuple[NDArray[Any], NDArray[Any]]:
    patch, sign = f"seam_patch_{other}", f"seam_sign_{other}"
    arrays = store.get(part, patch, sign)
    return arrays[patch], arrays[sign]


def _first_signs(
    tiles: list[Arrays],
    starts: NDArray[np.int64],
    roots: NDArray[np.int64],
    signs: NDArray[np.int64],
    whole: Any,
) -> NDArray[np.float64]:
    """What gives ascending columns to the first simplex of each patch."""
    result = np.zeros(len(roots))
    nodes = np.concatenate(
        [starts[t] + tile["patches"].astype(np.int64) for t, tile in enumerate(tiles)]
    )
    if not len(nodes):
        return result
    numbers = np.concatenate([tile["first"] for tile in tiles])
    points = np.concatenate([tile["first_points"] for tile in tiles])
    own_signs = np.concatenate([tile["first_sign"] for tile in tiles])
    samples, at = np.unique(numbers, return_index=True)
    order, _ = _core.part_order(
        Points(np.ascontiguousarray(points.reshape(-1, points.shape[-1])[at])), whole, 1
    )
    place = np.empty(len(samples), dtype=np.int64)
    place[order] = np.arange(len(order))
    placed = np.sort(place[np.searchsorted(samples, numbers)], axis=1)
    ranked = np.lexsort((*placed.T[::-1], roots[nodes]))
    firsts = ranked[np.unique(roots[nodes][ranked], return_index=True)[1]]
    result[roots[nodes[firsts]]] = signs[nodes[firsts]] * own_signs[firsts]
    return result
