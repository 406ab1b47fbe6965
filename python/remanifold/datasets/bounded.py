# SPDX-License-Identifier: GPL-3.0-or-later
"""Manifolds with boundary."""

from __future__ import annotations

import numpy as np

from remanifold.datasets._drawing import (
    FloatArray,
    RandomState,
    _angles,
    _at_least,
    _check_multiple,
    _check_radii,
    _count,
    _directions,
    _generator,
    _jitter,
    _positive,
    _reject,
    _unit_circle,
)
from remanifold.datasets.changes import embed
from remanifold.datasets.curves import spiral


def moebius_band(
    num_samples: int,
    *,
    radius: float = 1.0,
    half_width: float = 0.4,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a Moebius band in space.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    radius : float
        Radius of the center line.
    half_width : float
        Half the width of the band, below ``radius``.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, uniform in area.
    """
    rng, count = _generator(random_state), _count(num_samples)
    _check_radii(radius, half_width, ("radius", "half_width"))

    def draw(n: int) -> tuple[FloatArray, FloatArray]:
        u, w = _angles(n, rng), rng.uniform(-half_width, half_width, n)
        around = radius + w * np.cos(u / 2)
        return np.column_stack([u, w]), np.hypot(around, w / 2)

    bound = float(np.hypot(radius + half_width, half_width / 2))
    u, w = _reject(draw, count, rng, bound).T
    around = radius + w * np.cos(u / 2)
    return np.column_stack([around[:, None] * _unit_circle(u), w * np.sin(u / 2)])


def annulus(
    num_samples: int,
    *,
    inner_radius: float = 0.5,
    outer_radius: float = 1.0,
    ambient_dim: int | None = None,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a flat annulus in the plane.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    inner_radius : float
        Radius of the hole, positive.
    outer_radius : float
        Radius of the outer circle, above ``inner_radius``.
    ambient_dim : int, optional
        Embed the annulus isometrically into this dimension, at least 2, by a random
        orthonormal map.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 2) or (num_samples, ambient_dim)
        Samples, uniform in area.
    """
    rng, count = _generator(random_state), _count(num_samples)
    _check_radii(outer_radius, inner_radius, ("outer_radius", "inner_radius"))
    radii = np.sqrt(rng.uniform(inner_radius**2, outer_radius**2, count))
    points = radii[:, None] * _unit_circle(_angles(count, rng))
    return points if ambient_dim is None else embed(points, ambient_dim, rng)


def grid_cylinder(
    num_samples: int = 960,
    *,
    num_around: int = 48,
    radius: float = 1.0,
    jitter: float = 0.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample an open cylinder in space on a regular grid of squares.

    Parameters
    ----------
    num_samples : int
        Number of samples, a multiple of ``num_around``; more make the cylinder higher.
    num_around : int
        Number of samples on each circle, at least 3.
    radius : float
        Radius of the cylinder.
    jitter : float
        Standard deviation of a normal displacement around and along the axis, in units
        of the grid's spacing. The samples stay on the cylinder.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, circle by circle.
    """
    rng, count = _generator(random_state), _count(num_samples)
    columns = _at_least(num_around, 3, "num_around")
    _check_multiple(count, columns)
    rows, column = np.divmod(np.arange(count), columns)
    displacement = _jitter(jitter) * rng.standard_normal((2, count))
    step = 2 * np.pi / columns
    around = _unit_circle(step * (column + displacement[0]))
    return _positive(radius, "radius") * np.column_stack(
        [around, step * (rows + displacement[1])]
    )


def swiss_roll(
    num_samples: int,
    *,
    turns: float = 1.5,
    pitch: float = 1.0,
    height: float = 3.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a Swiss roll in space: an Archimedean spiral times an interval.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    turns : float
        Number of turns.
    pitch : float
        Distance between consecutive turns.
    height : float
        Length of the interval.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, uniform in area (those of scikit-learn's ``make_swiss_roll`` are
        denser inside); the height is the coordinate in the middle, as there.
    """
    rng = _generator(random_state)
    points = spiral(num_samples, turns=turns, pitch=pitch, random_state=rng)
    heights = rng.uniform(0.0, _positive(height, "height"), len(points))
    return np.column_stack([points[:, 0], heights, points[:, 1]])


def spherical_cap(
    num_samples: int,
    *,
    angle: float = np.pi / 3,
    radius: float = 1.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample the cap of a sphere in space.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    angle : float
        Angle between the cap's axis and its rim, in radians, below pi.
    radius : float
        Radius of the sphere.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, uniform in area.
    """
    rng, count = _generator(random_state), _count(num_samples)
    if not 0 < angle < np.pi:
        msg = f"angle must be between 0 and pi, got {angle}"
        raise ValueError(msg)
    z = rng.uniform(np.cos(angle), 1.0, count)
    around = np.sqrt(1 - z**2)[:, None] * _unit_circle(_angles(count, rng))
    return _positive(radius, "radius") * np.column_stack([around, z])


def ball(
    num_samples: int,
    *,
    dim: int = 3,
    radius: float = 1.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample the ball of dimension ``dim``.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    dim : int
        Dimension of the ball, at least 1.
    radius : float
        Radius of the ball.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, dim)
        Samples, uniform in volume.
    """
    rng, count = _generator(random_state), _count(num_samples)
    dim = _at_least(dim, 1, "dim")
    radii = _positive(radius, "radius") * rng.uniform(size=count) ** (1 / dim)
    return radii[:, None] * _directions(count, dim, rng)


def bent_ball(
    num_samples: int,
    *,
    dim: int = 3,
    radius: float = 1.0,
    bend_radius: float = 1.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a ball of dimension ``dim`` that is bent into one dimension more.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    dim : int
        Dimension of the ball, at least 1.
    radius : float
        Radius of the ball, below pi ``bend_radius``, or its ends meet.
    bend_radius : float
        Radius of the cylinder that the ball is rolled onto along its first coordinate.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, dim + 1)
        Samples, uniform in volume: bending keeps lengths.
    """
    _check_radii(
        np.pi * _positive(bend_radius, "bend_radius"),
        radius,
        ("pi bend_radius", "radius"),
    )
    flat = ball(num_samples, dim=dim, radius=radius, random_state=random_state)
    angle = flat[:, 0] / bend_radius
    return np.column_stack(
        [bend_radius * np.sin(angle), flat[:, 1:], bend_radius * (1 - np.cos(angle))]
    )
