# SPDX-License-Identifier: GPL-3.0-or-later
"""Simplices as linear elements: volumes, frames and gradients, from edge lengths."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from remanifold import _core

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.complex.data import ComplexData


class Elements(NamedTuple):
    """The K-simplices of a complex, M rows each.

    Attributes
    ----------
    volumes : ndarray, shape (M,), float64
        K-volumes; zero where a simplex is flat or its lengths are those of none.
    frames : ndarray, shape (M, K, K), float64
        Edges from the first vertex, as rows, in an orthonormal frame of the simplex;
        lower triangular. Zero where flat.
    products : ndarray, shape (M, K+1, K+1), float64
        Inner products of the gradients of the barycentric coordinates. Zero where flat.
    flat : ndarray, shape (M,), bool
        Simplices without gradients.
    """

    volumes: NDArray[np.float64]
    frames: NDArray[np.float64]
    products: NDArray[np.float64]
    flat: NDArray[np.bool_]


def elements_of(complex_: ComplexData) -> Elements:
    """Elements, from the distances between the vertices alone."""
    simplices = np.ascontiguousarray(complex_.simplices)
    if complex_.vertices is not None:
        points = np.ascontiguousarray(complex_.vertices)
        return Elements(*_core.linear_elements(points, simplices))
    first, second = np.triu_indices(complex_.dim + 1, 1)
    squares = complex_._source.squared_distances(
        simplices[:, first], simplices[:, second]
    )
    return Elements(
        *_core.linear_elements_of_lengths(complex_.dim, np.ascontiguousarray(squares))
    )


def elements_of_triangles(lengths: NDArray[np.float64]) -> Elements:
    """Elements, from the lengths of the sides opposite to the corners."""
    squares = np.ascontiguousarray(lengths[:, ::-1] ** 2)
    return Elements(*_core.linear_elements_of_lengths(2, squares))


def solve_frames(
    frames: NDArray[np.float64], right: NDArray[np.float64], *, transposed: bool = False
) -> NDArray[np.float64]:
    """Solve with lower triangular matrices, (M, K, K), for (M, K) or (M, K, C)."""
    dim = frames.shape[1]
    found = np.empty_like(right)
    wide = frames.reshape(*frames.shape, *(1,) * (right.ndim - 2))
    for i in reversed(range(dim)) if transposed else range(dim):
        found[:, i] = right[:, i]
        for j in range(i + 1, dim) if transposed else range(i):
            found[:, i] -= (wide[:, j, i] if transposed else wide[:, i, j]) * found[
                :, j
            ]
        found[:, i] /= wide[:, i, i]
    return found


def differences(
    values: NDArray[np.float64], simplices: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Values along the edges from the first vertex, (M, K) or (M, K, C)."""
    return np.asarray(values[simplices[:, 1:]] - values[simplices[:, :1]])
