# SPDX-License-Identifier: GPL-3.0-or-later
"""Coordinates for samples known only by inner products or distances, and for others."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from remanifold._base.validation import check_matrix, check_values

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.samples import Input


class ClassicalScaling(NamedTuple):
    """An isometric embedding about the centroid of the samples (classical scaling)."""

    coordinates: NDArray[np.float64]  # (N, r)
    lengths: NDArray[np.float64]  # of its columns
    squared_norms: NDArray[np.float64]  # of the samples about the centroid
    row_means: NDArray[np.float64]  # of the Gram matrix as given
    mean: float


def classical_scaling(samples: Input) -> ClassicalScaling:
    """Isometric coordinates, those of eigenvalues above rounding; O(N^3)."""
    gram = samples.products()
    gram = (gram + gram.T) / 2
    row_means = gram.mean(axis=0)
    mean = float(row_means.mean())
    centered = gram - row_means[:, None] - row_means[None, :] + mean
    values, vectors = np.linalg.eigh(centered)
    largest = max(float(values[-1]), 0.0)
    kept = values > len(values) * np.finfo(np.float64).eps * largest
    lengths = np.sqrt(values[kept][::-1])
    coordinates = vectors[:, kept][:, ::-1] * lengths
    if not kept.any():  # all samples coincide
        coordinates, lengths = np.zeros((len(gram), 1)), np.ones(1)
    return ClassicalScaling(
        np.ascontiguousarray(coordinates),
        lengths,
        np.diagonal(centered).copy(),
        row_means,
        mean,
    )


def place_by_products(
    scaling: ClassicalScaling, products: ArrayLike, squared_norms: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Coordinates of points with these inner products, and what they leave out."""
    table = check_matrix(products, "products", len(scaling.coordinates))
    norms = check_values(squared_norms, "squared_norms", len(table), ndim=1)
    means = table.mean(axis=1)
    about_centroid = table - means[:, None] - scaling.row_means[None, :] + scaling.mean
    return _place(scaling, about_centroid, norms - 2 * means + scaling.mean)


def place_by_distances(
    scaling: ClassicalScaling, distances: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Coordinates of points at these distances, and what they leave out."""
    table = check_matrix(distances, "distances", len(scaling.coordinates))
    if (table < 0).any():
        row, column = (int(i) for i in np.argwhere(table < 0)[0])
        msg = f"distances[{row}, {column}] is {table[row, column]}, expected 0 or more"
        raise ValueError(msg)
    squared = np.square(table)
    norms = squared.mean(axis=1) - scaling.squared_norms.mean()
    products = (norms[:, None] + scaling.squared_norms[None, :] - squared) / 2
    return _place(scaling, products, norms)


def _place(
    scaling: ClassicalScaling,
    products: NDArray[np.float64],
    squared_norms: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """From inner products about the centroid."""
    # Row by row, so that an answer does not depend on what else is asked.
    axes = scaling.coordinates / np.square(scaling.lengths)
    places = np.empty((len(products), axes.shape[1]))
    for row, own in zip(places, products, strict=True):
        row[:] = own @ axes
    rest = squared_norms - np.square(places).sum(axis=1)
    return places, np.sqrt(np.maximum(rest, 0.0))
