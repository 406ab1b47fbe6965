# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals at the vertices of a hypersurface."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from remanifold.complex.parts import face_keys

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.complex.data import ComplexData

    Floats = NDArray[np.float64]

_ROWS = 1 << 18  # simplices at a time


def vertex_normals(complex_: ComplexData) -> NDArray[np.float64]:
    """Unit normals, as `SimplicialComplex.vertex_normals` describes them."""
    points, dim = complex_.vertices, complex_.dim
    if points is None or points.shape[1] != dim + 1:
        space = "" if points is None else f", not {points.shape[1]}"
        msg = (
            f"a complex of dimension {dim} has normals in {dim + 1} coordinates{space}"
        )
        raise ValueError(msg)
    sums = np.zeros(points.shape)
    simplices = complex_.simplices
    for start in range(0, len(simplices), _ROWS):
        rows = simplices[start : start + _ROWS]
        corners = points[rows]
        for i in range(dim + 1):
            others = np.delete(corners, i, axis=1)
            edges = others - corners[:, i, None]
            # Inverted at the vertex, a sphere through it is a plane, over which the
            # simplices around it lie like the faces of a pyramid: their products add up
            # to that of its base, whatever their shapes.
            squares = (edges**2).sum(axis=2)
            squares[squares == 0] = 1.0
            edges /= squares[:, :, None]
            _add(sums, rows[:, i], (-1) ** i * _products(edges))
    sums[_contradictory(simplices)] = np.nan
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(sums / np.where(length > 0, length, np.nan))


def _contradictory(simplices: NDArray[np.int32]) -> NDArray[np.int32]:
    """Vertices of faces from which both simplices go round the same way."""
    size = simplices.shape[1]
    faces, signs = [], []
    for i in range(size):
        face = np.delete(simplices, i, axis=1)
        inversions = sum(
            (face[:, a] > face[:, b]).astype(np.int64)
            for a in range(size - 1)
            for b in range(a + 1, size - 1)
        )
        faces.append(np.sort(face, axis=1))
        signs.append(
            (-1) ** ((inversions + i) % 2) * np.ones(len(face), dtype=np.int64)
        )
    rows, sign = np.concatenate(faces), np.concatenate(signs)
    keys = face_keys(rows)
    if keys is not None:
        # The same face with the same sign twice.
        ascending = np.sort(keys * 2 + (sign > 0))
        if not (ascending[1:] == ascending[:-1]).any():
            return np.empty(0, dtype=np.int32)
    order = np.lexsort(rows.T)
    rows, sign = rows[order], sign[order]
    same = (rows[1:] == rows[:-1]).all(axis=1) & (sign[1:] == sign[:-1])
    return np.unique(rows[1:][same])


def _add(sums: Floats, rows: NDArray[np.int32], values: Floats) -> None:
    for axis in range(sums.shape[1]):
        sums[:, axis] += np.bincount(rows, values[:, axis], len(sums))


def _products(edges: Floats) -> Floats:
    """What is orthogonal to K vectors of K + 1 coordinates, as the cross product is."""
    count, _, space = edges.shape
    if space == 3:
        return np.asarray(np.cross(edges[:, 0], edges[:, 1]))
    found = np.empty((count, space))
    for axis in range(space):
        minor = np.delete(edges, axis, axis=2)
        # With the normal first the determinant is positive.
        found[:, axis] = (-1) ** axis * np.linalg.det(minor)
    return found
