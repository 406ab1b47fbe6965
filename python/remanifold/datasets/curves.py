# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves, open and closed, in the plane and in space."""

from __future__ import annotations

import numpy as np

from remanifold.datasets._drawing import (
    FloatArray,
    RandomState,
    _angles,
    _at_least,
    _count,
    _curve,
    _generator,
    _moved,
    _positive,
    _shares,
    _unit_circle,
)


def circle(
    num_samples: int, *, radius: float = 1.0, random_state: RandomState = None
) -> FloatArray:
    """Sample a circle in the plane.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    radius : float
        Radius of the circle.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 2)
        Samples, uniform in arc length.
    """
    rng, count = _generator(random_state), _count(num_samples)
    return _positive(radius, "radius") * _unit_circle(_angles(count, rng))


def ellipse(
    num_samples: int,
    *,
    semi_axes: tuple[float, float] = (2.0, 1.0),
    random_state: RandomState = None,
) -> FloatArray:
    """Sample an ellipse in the plane.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    semi_axes : tuple of two floats
        Half the lengths of the axes along x and y.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 2)
        Samples, uniform in arc length.
    """
    a = _positive(semi_axes[0], "semi_axes")
    b = _positive(semi_axes[1], "semi_axes")
    return _curve(
        lambda t: np.column_stack([a * np.cos(t), b * np.sin(t)]),
        (0.0, 2 * np.pi),
        num_samples,
        random_state,
    )


def planar_curve(
    num_samples: int,
    *,
    lobes: int = 5,
    depth: float = 0.25,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a closed curve with lobes in the plane (figure 3).

    Parameters
    ----------
    num_samples : int
        Number of samples.
    lobes : int
        Number of lobes of the curve r = 1 + depth cos(lobes phi).
    depth : float
        Depth of the lobes, at least 0 and below 1.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 2)
        Samples, uniform in arc length.
    """
    if not 0 <= depth < 1:
        msg = f"depth must be at least 0 and below 1, got {depth}"
        raise ValueError(msg)

    def curve(t: FloatArray) -> FloatArray:
        return (1 + depth * np.cos(lobes * t))[:, None] * _unit_circle(t)

    return _curve(curve, (0.0, 2 * np.pi), num_samples, random_state)


def planar_curves(num_samples: int, *, random_state: RandomState = None) -> FloatArray:
    """Sample two disjoint closed curves in the plane, side by side (figure 4).

    Parameters
    ----------
    num_samples : int
        Number of samples, shared in proportion to length.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 2)
        Samples, uniform in arc length; first a curve with three lobes, then an
        ellipse.
    """
    rng = _generator(random_state)
    counts = _shares(num_samples, [7.3, 5.7])
    first = planar_curve(counts[0], lobes=3, depth=0.3, random_state=rng)
    second = ellipse(counts[1], semi_axes=(0.6, 1.15), random_state=rng)
    return np.vstack([first, _moved(second, 2.2, 0.0)])


def spiral(
    num_samples: int,
    *,
    turns: float = 2.5,
    pitch: float = 1.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample an Archimedean spiral in the plane, a curve with two ends (figure 5).

    Parameters
    ----------
    num_samples : int
        Number of samples.
    turns : float
        Number of turns.
    pitch : float
        Distance between consecutive turns; the inner end is half of it away from
        the center.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 2)
        Samples, uniform in arc length.
    """
    _positive(turns, "turns")
    _positive(pitch, "pitch")

    def curve(t: FloatArray) -> FloatArray:
        return (pitch * (0.5 + t / (2 * np.pi)))[:, None] * _unit_circle(t)

    return _curve(curve, (0.0, 2 * np.pi * turns), num_samples, random_state)


def trefoil(
    num_samples: int, *, scale: float = 1.0, random_state: RandomState = None
) -> FloatArray:
    """Sample a trefoil knot in space.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    scale : float
        Factor on all coordinates; 1 gives a knot of radius 3.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, uniform in arc length.

    Notes
    -----
    (sin t + 2 sin 2t, cos t - 2 cos 2t, -sin 3t), the usual parametrization.
    """
    _positive(scale, "scale")

    def curve(t: FloatArray) -> FloatArray:
        x = np.sin(t) + 2 * np.sin(2 * t)
        y = np.cos(t) - 2 * np.cos(2 * t)
        return scale * np.column_stack([x, y, -np.sin(3 * t)])

    return _curve(curve, (0.0, 2 * np.pi), num_samples, random_state)


def closed_curve(
    num_samples: int, *, ambient_dim: int = 10, random_state: RandomState = None
) -> FloatArray:
    """Sample a closed curve that spans R^D.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    ambient_dim : int
        Dimension D of the space, at least 2.
    random_state : int, Generator, RandomState or None
        Source of randomness. It places the samples only; the curve is the same.

    Returns
    -------
    ndarray of shape (num_samples, ambient_dim)
        Samples, uniform in arc length.

    Notes
    -----
    The trigonometric moment curve (cos t, sin t, cos 2t / 4, sin 2t / 4, ...) with
    frequency k scaled by 1 / k^2. Its first two coordinates are a circle, so it
    never meets itself.
    """
    dim = _at_least(ambient_dim, 2, "ambient_dim")
    frequencies = np.arange(dim) // 2 + 1
    shifts = np.where(np.arange(dim) % 2 == 0, 0.0, -np.pi / 2)

    def curve(t: FloatArray) -> FloatArray:
        return np.asarray(
            np.cos(t[:, None] * frequencies + shifts) / frequencies**2,
            dtype=np.float64,
        )

    return _curve(curve, (0.0, 2 * np.pi), num_samples, random_state)


def interlocking_circles(
    num_samples: int, *, radius: float = 1.0, random_state: RandomState = None
) -> FloatArray:
    """Sample two interlocking circles in space, a Hopf link (figure 6).

    Parameters
    ----------
    num_samples : int
        Number of samples, half of them on each circle.
    radius : float
        Radius of both circles; each passes through the center of the other.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, uniform in arc length, one circle after the other.
    """
    rng = _generator(random_state)
    counts = _shares(num_samples, [1.0, 1.0])
    first = circle(counts[0], radius=radius, random_state=rng)
    second = circle(counts[1], radius=radius, random_state=rng)
    return np.vstack(
        [
            np.column_stack([first, np.zeros(len(first))]),
            np.column_stack(
                [second[:, 0] + radius, np.zeros(len(second)), second[:, 1]]
            ),
        ]
    )
