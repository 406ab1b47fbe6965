# SPDX-License-Identifier: GPL-3.0-or-later
"""Complexes on which functions are known in closed form."""

import itertools

import numpy as np

import remanifold as rm


def _cells(per_side, dim, periodic):
    """Cubes of a grid, each cut into simplices along its diagonal."""
    count = per_side if periodic else per_side + 1
    corner = np.stack(
        np.meshgrid(*[np.arange(per_side)] * dim, indexing="ij"), axis=-1
    ).reshape(-1, dim)
    rows = []
    for way in itertools.permutations(range(dim)):
        at = corner.copy()
        columns = [at.copy()]
        for axis in way:
            at[:, axis] += 1
            columns.append(at.copy())
        rows.append(
            np.stack(
                [
                    np.ravel_multi_index(tuple(c.T % count), (count,) * dim)
                    for c in columns
                ],
                axis=1,
            )
        )
    return np.concatenate(rows)


def cube(per_side, dim, jitter=0.0):
    """The unit cube of R^dim, its inner vertices moved."""
    points = np.stack(
        np.meshgrid(*[np.arange(per_side + 1) / per_side] * dim, indexing="ij"), axis=-1
    ).reshape(-1, dim)
    inner = ((points > 0) & (points < 1)).all(axis=1)
    moves = np.random.default_rng(0).uniform(-jitter, jitter, points.shape) / per_side
    return rm.SimplicialComplex(
        points + inner[:, None] * moves, _cells(per_side, dim, periodic=False)
    )


def torus_grid(per_side, dim=2):
    """The flat torus of unit circles in R^(2 dim), and its angles."""
    angles = np.stack(
        np.meshgrid(*[2 * np.pi * np.arange(per_side) / per_side] * dim, indexing="ij"),
        axis=-1,
    ).reshape(-1, dim)
    points = np.concatenate([np.cos(angles), np.sin(angles)], axis=1)
    return rm.SimplicialComplex(points, _cells(per_side, dim, periodic=True)), angles


def known_by(kind, complex_):
    """The same complex, its vertices known by products or distances only."""
    from remanifold._base.samples import Distances, Gram
    from remanifold.results.simplicial_complex import Subcomplex

    points = complex_.vertices
    away = np.linalg.norm(points[:, None] - points, axis=2)
    matrix = {"gram": Gram(points @ points.T), "distances": Distances(away)}[kind]
    return Subcomplex(
        None,
        complex_.simplices,
        vertex_indices=np.arange(len(points), dtype=np.int32),
        _products=matrix,
    )
