# SPDX-License-Identifier: GPL-3.0-or-later
"""Noise and order of the samples that the benchmarks draw."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import remanifold as rm


def spacing(points: Any) -> float:
    """The median distance to the nearest neighbor."""
    return float(np.median(rm.neighborhoods(points, 1, num_threads=1).distances))


def add_normal_noise(
    points: Any, dim: int, noise: float, seed: int, draw: Callable[[int, int], Any]
) -> Any:
    """Move points along the normals, which many more samples without noise show.

    ``draw`` takes a number of samples and a seed; ``noise`` is in spacings.
    """
    dense = draw(20 * len(points), seed + 1_000_000)
    both = np.vstack([points, dense])
    near = rm.neighborhoods(both, 10 * dim, num_threads=1).indices[: len(points)]
    tangents = np.linalg.svd(both[near] - points[:, None], full_matrices=False)[2]
    tangents = tangents[:, :dim]
    rng = np.random.default_rng(seed)
    moves = rng.normal(0.0, noise * spacing(points), points.shape)
    along = np.einsum("nkd,nd->nk", tangents, moves)
    return points + moves - np.einsum("nkd,nk->nd", tangents, along)


def distances_to_planes(
    positions: Any, dim: int, dense: Any, searched: int, patch: int
) -> Any:
    """Distances to a manifold that many samples without noise show.

    Each is that to the plane of so many dense samples near a position, which are looked
    for among so many neighbors.
    """
    both = np.vstack([positions, dense])
    # Of positions near each other enough dense samples must be left.
    near = rm.neighborhoods(both, searched, num_threads=1).indices[: len(positions)]
    order = np.argsort(near < len(positions), axis=1, kind="stable")
    patches = both[np.take_along_axis(near, order[:, :patch], axis=1)]
    nearest = patches[:, 0]  # on the manifold, as the mean of a bent patch is not
    planes = np.linalg.svd(patches - nearest[:, None], full_matrices=False)[2][:, :dim]
    away = positions - nearest
    along = np.einsum("nkd,nd->nk", planes, away)
    return np.linalg.norm(away - np.einsum("nkd,nk->nd", planes, along), axis=1)


def distances_to_torus(positions: Any) -> Any:
    """Distances to the torus with radii 1 and 0.4."""
    around = np.hypot(positions[:, 0], positions[:, 1]) - 1.0
    return np.abs(np.hypot(around, positions[:, 2]) - 0.4)


def morton_ordered(points: Any) -> Any:
    """The points sorted along a Morton curve, which keeps neighbors near each other."""
    used = points[:, :63]  # one bit each is all that 63 coordinates leave
    bits = 63 // used.shape[1]
    low, high = used.min(axis=0), used.max(axis=0)
    # Halved numbers of cells: rounding must not reach the cell beyond the last.
    scale = (2**bits - 0.5) / np.maximum(high - low, np.finfo(float).tiny).max()
    cells = ((used - low) * scale).astype(np.uint64)
    codes = np.zeros(len(points), dtype=np.uint64)
    for bit in reversed(range(bits)):
        for axis in range(used.shape[1]):
            codes = (codes << np.uint64(1)) | ((cells[:, axis] >> np.uint64(bit)) & 1)
    return np.ascontiguousarray(points[np.argsort(codes, kind="stable")])
