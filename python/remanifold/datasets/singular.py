# SPDX-License-Identifier: GPL-3.0-or-later
"""What is no manifold: crossings, branchings, cones, parts of several dimensions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remanifold.datasets._drawing import (
    FloatArray,
    RandomState,
    _angles,
    _at_least,
    _below_pi,
    _check_radii,
    _count,
    _curve,
    _directions,
    _generator,
    _positive,
    _reject,
    _share,
    _shares,
    _torus_points,
    _unit_circle,
)
from remanifold.datasets.bounded import ball


def figure_eight(
    num_samples: int, *, angle: float = np.pi / 2, random_state: RandomState = None
) -> FloatArray:
    """Sample a closed curve in the plane that crosses itself at the origin.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    angle : float
        Angle of the crossing, in radians, below pi.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 2)
        Samples, uniform in arc length.

    Notes
    -----
    Gerono's lemniscate (sin t, s sin t cos t), s the tangent of half the angle.
    """
    slope = np.tan(_below_pi(angle, "angle") / 2)

    def curve(t: FloatArray) -> FloatArray:
        return np.column_stack([np.sin(t), slope * np.sin(t) * np.cos(t)])

    return _curve(curve, (0.0, 2 * np.pi), num_samples, random_state)


def crossing_balls(
    num_samples: int,
    *,
    dim: int = 2,
    ambient_dim: int | None = None,
    angle: float = np.pi / 2,
    num_sheets: int = 2,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample flat balls that pass through each other at the origin.

    Parameters
    ----------
    num_samples : int
        Number of samples, the same on each ball.
    dim : int
        Dimension K of the balls, which have radius 1.
    ambient_dim : int, optional
        Dimension D of the space, from K + 1, the default, to 2 K. The balls share
        2 K - D dimensions.
    angle : float
        Angle between one ball and the next, in radians, below pi; in all dimensions
        that they do not share.
    num_sheets : int
        Number of balls, at least 1.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, ambient_dim)
        Samples, uniform in volume, one ball after the other.
    """
    rng, dim = _generator(random_state), _at_least(dim, 1, "dim")
    ambient = dim + 1 if ambient_dim is None else ambient_dim
    turned = _at_least(ambient, dim + 1, "ambient_dim") - dim
    if turned > dim:
        msg = f"ambient_dim is {ambient}, expected at most 2 dim = {2 * dim}"
        raise ValueError(msg)
    _below_pi(angle, "angle")
    counts = _shares(num_samples, [1.0] * _at_least(num_sheets, 1, "num_sheets"))
    sheets = []
    for i, count in enumerate(counts):
        flat = ball(count, dim=dim, random_state=rng)
        lifted = flat[:, :turned] * np.sin(i * angle)
        flat[:, :turned] *= np.cos(i * angle)
        sheets.append(np.hstack([flat, lifted]))
    return np.vstack(sheets)


def branching(
    num_samples: int,
    *,
    dim: int = 1,
    angles: Sequence[float] = (0.0, 2 * np.pi / 3, 4 * np.pi / 3),
    random_state: RandomState = None,
) -> FloatArray:
    """Sample half balls that meet along their flat sides, like the pages of a book.

    Parameters
    ----------
    num_samples : int
        Number of samples, the same on each half.
    dim : int
        Dimension K of the halves, which have radius 1.
    angles : sequence of float
        Direction of each half around the common side, in radians. Three thirds of a
        full turn make a Y; 0, pi / 2 and pi a T.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, dim + 1)
        Samples, uniform in volume, one half after the other.
    """
    rng, dim = _generator(random_state), _at_least(dim, 1, "dim")
    pages = []
    for angle, count in zip(
        angles, _shares(num_samples, [1.0] * len(angles)), strict=True
    ):
        flat = ball(count, dim=dim, random_state=rng)
        away = np.abs(flat[:, :1])
        pages.append(
            np.hstack([away * np.cos(angle), away * np.sin(angle), flat[:, 1:]])
        )
    return np.vstack(pages)


def immersed_klein_bottle(
    num_samples: int,
    *,
    radius: float = 3.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a Klein bottle in R^3, which crosses itself along a circle.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    radius : float
        Radius of the circle, above 2.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, uniform in area.

    Notes
    -----
    A figure eight (sin v, sin 2v), the sheets of which cross at 53 degrees, carried
    around the circle while it turns over by half a turn.
    """
    rng, count = _generator(random_state), _count(num_samples)
    _check_radii(radius, 2.0, ("radius", "2"))

    def draw(n: int) -> tuple[FloatArray, FloatArray]:
        u, v = _angles(n, rng), _angles(n, rng)
        c, s = np.cos(u / 2), np.sin(u / 2)
        across = c * np.sin(v) - s * np.sin(2 * v)
        # Along v the curve moves in the plane across the circle; along u around it,
        # and in that plane by half the turn.
        speed = np.column_stack([np.cos(v), 2 * np.cos(2 * v)])
        shape = np.column_stack([np.sin(v), np.sin(2 * v)])
        turn = 0.5 * (speed[:, 0] * shape[:, 0] + speed[:, 1] * shape[:, 1])
        around = (radius + across) * np.hypot(speed[:, 0], speed[:, 1])
        return np.column_stack([u, v]), np.hypot(around, turn)

    u, v = _reject(draw, count, rng, 2.3 * (radius + 1.5)).T
    c, s = np.cos(u / 2), np.sin(u / 2)
    across = radius + c * np.sin(v) - s * np.sin(2 * v)
    return np.column_stack(
        [across[:, None] * _unit_circle(u), s * np.sin(v) + c * np.sin(2 * v)]
    )


def spindle_torus(
    num_samples: int,
    *,
    major_radius: float = 0.5,
    minor_radius: float = 1.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a torus of revolution that meets itself in two points of its axis.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    major_radius : float
        Distance from the axis to the center of the tube.
    minor_radius : float
        Radius of the tube, above ``major_radius``.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, uniform in area. Near either point the surface is a double cone.
    """
    rng, count = _generator(random_state), _count(num_samples)
    _check_radii(minor_radius, major_radius, ("minor_radius", "major_radius"))

    def draw(n: int) -> tuple[FloatArray, FloatArray]:
        v = _angles(n, rng)
        return v[:, None], np.abs(major_radius + minor_radius * np.cos(v))

    v = _reject(draw, count, rng, major_radius + minor_radius)[:, 0]
    return _torus_points(_angles(count, rng), v, major_radius, minor_radius)


def double_cone(
    num_samples: int,
    *,
    dim: int = 2,
    angle: float = np.pi / 4,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample two cones that touch at their tips.

    Parameters
    ----------
    num_samples : int
        Number of samples, half of them on each cone.
    dim : int
        Dimension K of the cones, at least 2.
    angle : float
        Angle between the axis and the cones, in radians, below pi / 2.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, dim + 1)
        Samples, uniform in area, at most 1 from the tip; the axis is the last
        coordinate.
    """
    rng, dim = _generator(random_state), _at_least(dim, 2, "dim")
    if not 0 < angle < np.pi / 2:
        msg = f"angle must be between 0 and pi / 2, got {angle}"
        raise ValueError(msg)
    first, second = _shares(num_samples, [1.0, 1.0])
    count = first + second
    radii = rng.uniform(0.0, 1.0, (count, 1)) ** (1 / dim)
    around = np.sin(angle) * radii * _directions(count, dim, rng)
    signs = np.repeat([1.0, -1.0], [first, second])[:, None]
    return np.hstack([around, np.cos(angle) * signs * radii])


def sphere_with_antenna(
    num_samples: int,
    *,
    length: float = 1.0,
    share: float = 0.05,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a sphere of radius 1 with a line that stands on it.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    length : float
        Length of the line.
    share : float
        Share of the samples that lie on the line.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, uniform in area on the sphere, then uniform in length on the line.
    """
    rng = _generator(random_state)
    counts = _shares(num_samples, [1 - _share(share, "share"), share])
    line = np.zeros((counts[1], 3))
    line[:, 2] = 1 + rng.uniform(0.0, _positive(length, "length"), counts[1])
    return np.vstack([_directions(counts[0], 3, rng), line])


def ball_on_disc(
    num_samples: int,
    *,
    dim: int = 2,
    radius: float = 0.3,
    share: float = 0.5,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a flat disc with a solid ball of one dimension more in its middle.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    dim : int
        Dimension K of the disc, which has radius 1.
    radius : float
        Radius of the ball, below 1.
    share : float
        Share of the samples that lie in the ball.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, dim + 1)
        Samples, uniform in volume; those of the disc, which lie outside the ball,
        first.
    """
    rng, dim = _generator(random_state), _at_least(dim, 1, "dim")
    _check_radii(1.0, radius, ("1", "radius"))
    counts = _shares(num_samples, [1 - _share(share, "share"), share])
    radii = rng.uniform(radius**dim, 1.0, (counts[0], 1)) ** (1 / dim)
    disc = radii * _directions(counts[0], dim, rng)
    solid = ball(counts[1], dim=dim + 1, radius=radius, random_state=rng)
    return np.vstack([np.pad(disc, ((0, 0), (0, 1))), solid])
