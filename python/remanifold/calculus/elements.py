# SPDX-License-Identifier: GPL-3.0-or-later
"""Simplices as linear elements: volumes, frames and gradients, from edge lengths."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from remanifold.complex.measures import gram_matrices

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.complex.data import ComplexData

# Least eigenvalue of the inner products of the edges, over their mean, of a simplex that
# has gradients. Squares of lengths are rounded to 2^-52: a third of the digits are left.
FLAT = 2.0**-40


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
    size, dim = len(complex_.simplices), complex_.dim
    return _elements(size, dim, gram_matrices(complex_))


def elements_of_triangles(lengths: NDArray[np.float64]) -> Elements:
    """Elements, from the lengths of the sides opposite to the corners."""
    opposite = lengths**2
    gram = np.empty((len(lengths), 2, 2))
    gram[:, 0, 0], gram[:, 1, 1] = opposite[:, 2], opposite[:, 1]
    gram[:, 0, 1] = gram[:, 1, 0] = (opposite @ [-1.0, 1.0, 1.0]) / 2
    scale = opposite[:, 1:].mean(axis=1)
    scale[scale == 0] = 1.0
    blocks = [(slice(0, len(gram)), gram / scale[:, None, None], scale)]
    return _elements(len(lengths), 2, blocks)


def _elements(
    size: int,
    dim: int,
    blocks: Iterable[tuple[slice, NDArray[np.float64], NDArray[np.float64]]],
) -> Elements:
    volumes = np.zeros(size)
    frames = np.zeros((size, dim, dim))
    products = np.zeros((size, dim + 1, dim + 1))
    flat = np.ones(size, dtype=np.bool_)
    for rows, gram, scale in blocks:
        solid = _least(gram) > FLAT
        own = np.arange(rows.start, rows.stop)[solid]
        factors, inverse = _factors(gram[solid])
        unit = np.sqrt(scale[solid])
        flat[own] = False
        # Of the diagonal: its product is the root of the determinant.
        diagonals = np.diagonal(factors, axis1=1, axis2=2)
        volumes[own] = (diagonals * unit[:, None]).prod(axis=1) / math.factorial(dim)
        frames[own] = factors * unit[:, None, None]
        inverse /= scale[solid][:, None, None]
        full = np.empty((len(own), dim + 1, dim + 1))
        full[:, 1:, 1:] = inverse
        full[:, 0, 1:] = full[:, 1:, 0] = -inverse.sum(axis=2)
        full[:, 0, 0] = inverse.sum(axis=(1, 2))
        products[own] = full
    return Elements(volumes, frames, products, flat)


def _least(gram: NDArray[np.float64]) -> NDArray[np.float64]:
    """Least eigenvalues; of two by two in closed form, which takes a tenth of the time."""
    if gram.shape[1] != 2:
        return np.asarray(np.linalg.eigvalsh(gram)[:, 0])
    a, b, c = gram[:, 0, 0], gram[:, 0, 1], gram[:, 1, 1]
    largest = (a + c) / 2 + np.hypot((a - c) / 2, b)
    return np.asarray((a * c - b * b) / np.where(largest > 0, largest, 1.0))


def _factors(
    gram: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cholesky factors and inverses."""
    if gram.shape[1] != 2:
        return np.asarray(np.linalg.cholesky(gram)), np.asarray(np.linalg.inv(gram))
    a, b, c = gram[:, 0, 0], gram[:, 0, 1], gram[:, 1, 1]
    determinant = a * c - b * b
    root = np.sqrt(a)
    factors, inverse = np.zeros_like(gram), np.empty_like(gram)
    factors[:, 0, 0], factors[:, 1, 0] = root, b / root
    factors[:, 1, 1] = np.sqrt(determinant) / root
    inverse[:, 0, 0], inverse[:, 1, 1] = c / determinant, a / determinant
    inverse[:, 0, 1] = inverse[:, 1, 0] = -b / determinant
    return factors, inverse


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
