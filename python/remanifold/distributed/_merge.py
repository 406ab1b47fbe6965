# SPDX-License-Identifier: GPL-3.0-or-later
"""From what each tile says to what the whole says, the same in any order."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remanifold import _core
from remanifold._base.samples import Points
from remanifold.distributed._store import Arrays, Part, Store


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


def value_at(store: Store, parts: list[Part], name: str, rank: int) -> float:
    """The rank-th smallest, from 0, of positive values in many parts, one at a time."""
    prefix, known = np.uint64(0), 0
    for bits in (20, 40, 64):
        pieces: dict[int, int] = {}
        for values in _bits_of(store, parts, name, prefix, known):
            keys, counts = np.unique(values >> np.uint64(64 - bits), return_counts=True)
            for key, count in zip(keys.tolist(), counts.tolist(), strict=True):
                pieces[key] = pieces.get(key, 0) + count
        for key in sorted(pieces):
            if rank < pieces[key]:
                prefix, known = np.uint64(key), bits
                break
            rank -= pieces[key]
    return float(np.array([prefix], dtype=np.uint64).view(np.float64)[0])


def _bits_of(
    store: Store, parts: list[Part], name: str, prefix: np.uint64, known: int
) -> Iterator[NDArray[np.uint64]]:
    for part in parts:
        values = store.get(part, name)[name].view(np.uint64)
        if known:
            values = values[values >> np.uint64(64 - known) == prefix]
        yield values


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
    tiles = [store.get(part) for part in parts]
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
            here, there = f"seam_patch_{other}", f"seam_patch_{t}"
            if other < t or here not in tiles[t]:
                continue
            products = tiles[t][f"seam_sign_{other}"] * tiles[other][f"seam_sign_{t}"]
            joins = np.stack([tiles[t][here], tiles[other][there], products], axis=1)
            for a, b, product in np.unique(joins, axis=0).tolist():
                node_a, node_b = int(starts[t] + a), int(starts[other] + b)
                components.join(node_a, node_b, 1)
                if not sets.join(node_a, node_b, product):
                    twisted.append(node_a)
    roots = np.array([sets.find(node)[0] for node in range(int(starts[-1]))])
    signs = np.array([sets.find(node)[1] for node in range(int(starts[-1]))])
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
