# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed manifolds of any dimension."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remanifold.datasets._drawing import (
    FloatArray,
    RandomState,
    _angles,
    _at_least,
    _count,
    _directions,
    _generator,
    _positive,
    _unit_circle,
)
from remanifold.datasets.changes import embed
from remanifold.datasets.curves import circle
from remanifold.datasets.surfaces import sphere


def flat_torus(
    num_samples: int,
    *,
    dim: int = 2,
    radii: float | Sequence[float] = 1.0,
    ambient_dim: int | None = None,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample the product of ``dim`` circles in R^(2 dim).

    Parameters
    ----------
    num_samples : int
        Number of samples.
    dim : int
        Number of circles, at least 1.
    radii : float or sequence of ``dim`` floats
        Radii of the circles.
    ambient_dim : int, optional
        Embed the torus isometrically into this dimension, at least ``2 * dim``, by a
        random orthonormal map.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 2 * dim) or (num_samples, ambient_dim)
        Samples, uniform in volume.
    """
    rng, count = _generator(random_state), _count(num_samples)
    dim = _at_least(dim, 1, "dim")
    scales = np.asarray(radii, dtype=np.float64)
    if scales.shape not in {(), (dim,)} or not np.all(scales > 0):
        msg = f"radii must be one positive number or {dim} of them, got {radii}"
        raise ValueError(msg)
    for scale in scales.ravel():
        _positive(float(scale), "radii")
    scales = np.broadcast_to(scales, (dim,))
    points = np.hstack([r * _unit_circle(_angles(count, rng)) for r in scales])
    return points if ambient_dim is None else embed(points, ambient_dim, rng)


def rotations(num_samples: int, *, random_state: RandomState = None) -> FloatArray:
    """Sample the rotation group SO(3) as 3 x 3 matrices in R^9.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 9)
        Rotation matrices, row by row, uniform in volume (Haar measure).

    References
    ----------
    Shoemake, *Uniform random rotations*, Graphics Gems III, 1992.
    """
    rng, count = _generator(random_state), _count(num_samples)
    w, x, y, z = _directions(count, 4, rng).T
    return np.column_stack(
        [
            1 - 2 * (y * y + z * z),
            2 * (x * y - w * z),
            2 * (x * z + w * y),
            2 * (x * y + w * z),
            1 - 2 * (x * x + z * z),
            2 * (y * z - w * x),
            2 * (x * z - w * y),
            2 * (y * z + w * x),
            1 - 2 * (x * x + y * y),
        ]
    )


def sphere_times_circle(
    num_samples: int,
    *,
    sphere_radius: float = 1.0,
    circle_radius: float = 1.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample the product S^2 x S^1 in R^5.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    sphere_radius : float
        Radius of the sphere, coordinates 0 to 2.
    circle_radius : float
        Radius of the circle, coordinates 3 and 4.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 5)
        Samples, uniform in volume.
    """
    rng = _generator(random_state)
    return np.hstack(
        [
            sphere(
                num_samples,
                radius=_positive(sphere_radius, "sphere_radius"),
                random_state=rng,
            ),
            circle(
                num_samples,
                radius=_positive(circle_radius, "circle_radius"),
                random_state=rng,
            ),
        ]
    )


def sphere_times_sphere(
    num_samples: int,
    *,
    radii: tuple[float, float] = (1.0, 1.0),
    random_state: RandomState = None,
) -> FloatArray:
    """Sample the product S^2 x S^2 in R^6.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    radii : tuple of two floats
        Radii of the spheres, coordinates 0 to 2 and 3 to 5.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 6)
        Samples, uniform in volume.
    """
    rng, count = _generator(random_state), _count(num_samples)
    return np.hstack(
        [_positive(radius, "radii") * _directions(count, 3, rng) for radius in radii]
    )
