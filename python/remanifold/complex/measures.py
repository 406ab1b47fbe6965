# SPDX-License-Identifier: GPL-3.0-or-later
"""Lengths, angles and shapes of simplices, from distances between vertices alone."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from remanifold.complex.data import ComplexData

_BLOCK = 50_000  # simplices at a time


def edge_lengths(
    points: NDArray[np.float64], edges: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Lengths of edges, in blocks: the coordinates may be many."""
    lengths = np.empty(len(edges))
    block = max(1, 4_000_000 // points.shape[1])
    for start in range(0, len(edges), block):
        i, j = edges[start : start + block].T
        lengths[start : start + block] = np.linalg.norm(points[i] - points[j], axis=1)
    return lengths


def gram_matrices(
    complex: ComplexData,
) -> Iterator[tuple[slice, NDArray[np.float64], NDArray[np.float64]]]:
    """Inner products of the edges that leave the first vertex, scaled to trace K.

    Yields the slice of the simplices, the matrices, and what they were divided by.
    """
    rows = complex.simplices
    source = complex._source
    dim = complex.dim
    for start in range(0, len(rows), _BLOCK):
        part = rows[start : start + _BLOCK]
        first, others = part[:, :1], part[:, 1:]
        away = source.squared_distances(first, others)
        gram = np.empty((len(part), dim, dim))
        for i, j in itertools.product(range(dim), repeat=2):
            between = source.squared_distances(others[:, i], others[:, j])
            gram[:, i, j] = (away[:, i] + away[:, j] - between) / 2
        size = away.mean(axis=1)
        size[size == 0] = 1.0
        yield slice(start, start + len(part)), gram / size[:, None, None], size


def shapes(complex: ComplexData) -> NDArray[np.float64]:
    """Shape quality of each simplex, (M,): 1 if regular, 0 if flat.

    The volume over that of a regular simplex with the same mean square of the edges, for
    triangles 4 sqrt(3) area / (a^2 + b^2 + c^2).
    """
    dim = complex.dim
    result = np.empty(len(complex.simplices))
    # The determinant of a regular simplex with edges of length one.
    regular = (dim + 1) / 2.0**dim
    for own, gram, _ in gram_matrices(complex):
        diagonal = np.einsum("nii->n", gram)
        # Sum of all squared edges: those of the first vertex, and those between.
        edges = (dim + 1) * diagonal - gram.sum(axis=(1, 2))
        mean = edges / (dim * (dim + 1) / 2)
        mean[mean <= 0] = 1.0
        volume = np.maximum(np.linalg.det(gram / mean[:, None, None]), 0.0)
        result[own] = np.sqrt(volume / regular)
    return np.minimum(result, 1.0)


def angles(complex: ComplexData) -> NDArray[np.float64]:
    """Angles in degrees between the facets of each simplex, flat ones left out.

    Those of the corners of triangles, the dihedral ones of tetrahedra.
    """
    dim = complex.dim
    found = []
    for _, gram, _ in gram_matrices(complex):
        solid = np.linalg.det(gram) > 1e-14
        inverse = np.linalg.inv(gram[solid])
        # Gradients of all barycentric coordinates: they sum to zero.
        full = np.empty((len(inverse), dim + 1, dim + 1))
        full[:, 1:, 1:] = inverse
        full[:, 0, 1:] = full[:, 1:, 0] = -inverse.sum(axis=2)
        full[:, 0, 0] = inverse.sum(axis=(1, 2))
        for i, j in itertools.combinations(range(dim + 1), 2):
            cosine = -full[:, i, j] / np.sqrt(full[:, i, i] * full[:, j, j])
            found.append(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
    return np.concatenate(found) if found else np.empty(0)


def edge_ratios(complex: ComplexData) -> NDArray[np.float64]:
    """Shorter over longer of two edges, at each vertex of a curve that has two."""
    edges = complex.simplices
    lengths = np.sqrt(complex._source.squared_distances(edges[:, 0], edges[:, 1]))
    ends = edges.ravel()
    order = np.argsort(ends, kind="stable")
    degree = np.bincount(ends, minlength=complex.num_vertices)
    start = (np.cumsum(degree) - degree)[degree == 2]
    pairs = np.repeat(lengths, 2)[order][start[:, None] + np.arange(2)]
    longer = pairs.max(axis=1)
    return np.asarray(pairs.min(axis=1)[longer > 0] / longer[longer > 0])


def at_vertices(
    complex: ComplexData, values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Mean over the simplices of each vertex, NaN where there are none."""
    corners = complex.simplices.ravel()
    count = np.bincount(corners, minlength=complex.num_vertices)
    total = np.bincount(
        corners,
        np.repeat(values, complex.dim + 1),
        minlength=complex.num_vertices,
    )
    with np.errstate(invalid="ignore"):
        return np.asarray(total / count)
