# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes to any sample: other spaces, noise, other density."""

from __future__ import annotations

import numpy as np

from remanifold.datasets._drawing import (
    FloatArray,
    RandomState,
    _at_least,
    _count,
    _generator,
)


def embed(
    points: FloatArray, ambient_dim: int, random_state: RandomState = None
) -> FloatArray:
    """Embed points isometrically into a space of higher dimension.

    Parameters
    ----------
    points : ndarray of shape (N, D)
        Points.
    ambient_dim : int
        Dimension of the new space, at least D.
    random_state : int, Generator, RandomState or None
        Source of the random orthonormal map.

    Returns
    -------
    ndarray of shape (N, ambient_dim)
        The points under a random linear isometry.
    """
    rng = _generator(random_state)
    dim = _at_least(ambient_dim, points.shape[1], "ambient_dim")
    basis = np.linalg.qr(rng.standard_normal((dim, points.shape[1])))[0]
    return np.asarray(points @ basis.T, dtype=np.float64)


def add_noise(
    points: FloatArray, scale: float, random_state: RandomState = None
) -> FloatArray:
    """Add normal noise to every coordinate.

    Parameters
    ----------
    points : ndarray of shape (N, D)
        Points.
    scale : float
        Standard deviation of the noise in each coordinate.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (N, D)
        The points with noise.
    """
    rng = _generator(random_state)
    return np.asarray(points + scale * rng.standard_normal(points.shape))


def spread(
    points: FloatArray, num_samples: int, random_state: RandomState = None
) -> FloatArray:
    """Choose samples that are spread evenly over the points.

    Greedy farthest points: each choice is the point farthest from those chosen
    before. Draw some ten times as many samples as needed and keep an even subset.

    Parameters
    ----------
    points : ndarray of shape (N, D)
        Points to choose from.
    num_samples : int
        How many to choose, at most N.
    random_state : int, Generator, RandomState or None
        Source of the first choice.

    Returns
    -------
    ndarray of shape (num_samples, D)
        The chosen points, in the order of the choice.

    References
    ----------
    Gonzalez, *Clustering to minimize the maximum intercluster distance*, 1985.
    """
    rng, count = _generator(random_state), _count(num_samples)
    if count > len(points):
        msg = f"cannot choose {count} of {len(points)} points"
        raise ValueError(msg)
    chosen = np.empty(count, dtype=np.intp)
    chosen[0] = rng.integers(len(points))
    nearest = np.full(len(points), np.inf)
    for i in range(1, count):
        difference = points - points[chosen[i - 1]]
        squared_distance = np.einsum("ij,ij->i", difference, difference)
        np.minimum(nearest, squared_distance, out=nearest)
        chosen[i] = np.argmax(nearest)
    return points[chosen]
