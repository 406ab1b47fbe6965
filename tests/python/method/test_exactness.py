# SPDX-License-Identifier: GPL-3.0-or-later
"""Where rounding could decide: lattices up to errors, planes of samples, single precision."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull
from scipy.spatial.distance import cdist

import remanifold as rm
from remanifold import datasets

pytestmark = pytest.mark.filterwarnings("ignore::remanifold.RemanifoldWarning")


def lattice(side, dim):
    axes = np.meshgrid(*[np.arange(side, dtype=float)] * dim, indexing="ij")
    return np.stack(axes, axis=-1).reshape(-1, dim)


def volumes(points, simplices):
    edges = points[simplices[:, 1:]] - points[simplices[:, :1]]
    return np.linalg.det(edges) / (2 if points.shape[1] == 2 else 6)


@pytest.mark.parametrize("error", [0, 1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11])
@pytest.mark.parametrize(("side", "dim"), [(12, 2), (5, 3)])
@pytest.mark.parametrize("spacing", [1, 1 / 7])
def test_lattices_are_filled(side, dim, error, spacing):
    """Flat simplices between the cells of a lattice left holes of no width."""
    wrong = np.random.default_rng(0).uniform(-error, error, (side**dim, dim))
    points = spacing * (lattice(side, dim) + wrong)
    rec = rm.reconstruct(points, dim)
    found = volumes(points, rec.simplices) / spacing**dim
    assert found.sum() == pytest.approx((side - 1) ** dim, rel=1e-9)
    assert found.min() > 0.9 / (2 if dim == 2 else 6)
    assert rec.topology().manifold


@pytest.mark.parametrize("count", [200, 400])
def test_samples_in_five_planes(count):
    points = np.random.default_rng(0).uniform(size=(count, 3))
    points[:, 2] = np.round(4 * points[:, 2]) / 4
    rec = rm.reconstruct(points, 3)
    found = volumes(points, rec.simplices)
    assert found.min() > 1e-9
    assert len(rec.repair.unused_vertices) == 0
    assert 0.85 < found.sum() / ConvexHull(points).volume < 1 + 1e-9
    assert rec.topology().manifold


def single(points):
    """Distances as a program in single precision finds them, from products."""
    p = points.astype(np.float32)
    norms = (p**2).sum(axis=1)
    squares = np.maximum(norms[:, None] + norms - 2 * p @ p.T, 0)
    np.fill_diagonal(squares, 0)
    return np.sqrt(squares)


@pytest.mark.parametrize("asymmetry", [0.0, 2e-7])
@pytest.mark.parametrize("find", [single, lambda p: cdist(p, p).astype(np.float32)])
def test_distances_in_single_precision(find, asymmetry):
    points = datasets.torus(300, random_state=0)
    distances = find(points)
    assert distances.dtype == np.float32
    shaken = np.random.default_rng(1).uniform(-1, 1, distances.shape)
    distances *= (1 + asymmetry * shaken).astype(np.float32)
    found = rm.reconstruct(distances=distances, dim=2).topology()
    assert found.closed
    assert found.betti_numbers == (1, 2, 1)
