# SPDX-License-Identifier: GPL-3.0-or-later
"""Manifolds that no threshold was chosen with, for dimensions.py."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Manifold:
    label: str
    dim: int
    num_samples: int
    points: Callable[[int, np.random.Generator], Any]

    def draw(self, num_samples: int, seed: int) -> Any:
        return self.points(num_samples, np.random.default_rng(seed))


def _helix(n: int, rng: np.random.Generator) -> Any:
    t = rng.uniform(0, 20, n)
    return np.column_stack([np.cos(t), np.sin(t), 0.15 * t])


def _lissajous(n: int, rng: np.random.Generator) -> Any:
    t = rng.uniform(0, 2 * np.pi, n)
    return np.column_stack([np.sin(3 * t), np.sin(4 * t + 0.5), np.cos(5 * t)])


def _helicoid(n: int, rng: np.random.Generator) -> Any:
    u, v = rng.uniform(-1, 1, n), rng.uniform(0, 9, n)
    return np.column_stack([u * np.cos(v), u * np.sin(v), 0.4 * v])


def _saddle(n: int, rng: np.random.Generator) -> Any:
    x = rng.normal(size=(n, 2))
    return np.column_stack([x, x[:, 0] ** 2 - x[:, 1] ** 2])


def _cone(n: int, rng: np.random.Generator) -> Any:
    r, a = np.sqrt(rng.uniform(0, 1, n)), rng.uniform(0, 2 * np.pi, n)
    return np.column_stack([r * np.cos(a), r * np.sin(a), 2 * r])


def _sphere(n: int, dim: int, rng: np.random.Generator) -> Any:
    x = rng.normal(size=(n, dim + 1))
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def _times_circle(n: int, rng: np.random.Generator) -> Any:
    x, a = _sphere(n, 3, rng), rng.uniform(0, 2 * np.pi, n)
    return np.column_stack([x, np.cos(a), np.sin(a)])


def _pairs(n: int, rng: np.random.Generator) -> Any:
    """Orthonormal pairs of vectors in R^4, uniform up to the signs, which are drawn."""
    pairs = np.linalg.qr(rng.normal(size=(n, 4, 2)))[0]
    return pairs * np.sign(rng.normal(size=(n, 1, 2)))


def _planes(n: int, rng: np.random.Generator) -> Any:
    pairs = _pairs(n, rng)
    return (pairs @ pairs.transpose(0, 2, 1)).reshape(n, 16)


def _cosines(dim: int, ambient_dim: int) -> Callable[[int, np.random.Generator], Any]:
    fixed = np.random.default_rng(99)
    weights = fixed.normal(size=(dim, ambient_dim))
    phases = fixed.uniform(0, 2 * np.pi, ambient_dim)
    return lambda n, rng: np.cos(rng.uniform(-1, 1, (n, dim)) @ weights + phases)


OTHERS = (
    Manifold("helix in R^3", 1, 300, _helix),
    Manifold("Lissajous curve in R^3", 1, 500, _lissajous),
    Manifold("helicoid in R^3", 2, 800, _helicoid),
    Manifold("saddle in R^3, normal density", 2, 800, _saddle),
    Manifold(
        "ellipsoid in R^3, uneven",
        2,
        500,
        lambda n, rng: _sphere(n, 2, rng) * [3, 1, 0.5],
    ),
    Manifold("cone in R^3", 2, 600, _cone),
    Manifold("cosines of 2 in R^20", 2, 600, _cosines(2, 20)),
    Manifold("cosines of 3 in R^20", 3, 1200, _cosines(3, 20)),
    Manifold("cosines of 4 in R^30", 4, 3000, _cosines(4, 30)),
    Manifold("S^3 x S^1 in R^6", 4, 2000, _times_circle),
    Manifold("planes of R^4 in R^16", 4, 3000, _planes),
    Manifold("5-sphere in R^6", 5, 2000, lambda n, rng: _sphere(n, 5, rng)),
    Manifold(
        "orthonormal pairs in R^8", 5, 4000, lambda n, rng: _pairs(n, rng).reshape(n, 8)
    ),
)
