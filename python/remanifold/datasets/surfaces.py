# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed surfaces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from remanifold.datasets._drawing import (
    FloatArray,
    RandomState,
    _angles,
    _at_least,
    _check_multiple,
    _check_radii,
    _check_spacing_ratio,
    _count,
    _directions,
    _generator,
    _interlock,
    _jitter,
    _positive,
    _reject,
    _shares,
    _torus_points,
    _unit_circle,
)
from remanifold.datasets._fruits import _bowl_and_fruits


def sphere(
    num_samples: int,
    *,
    dim: int = 2,
    radius: float = 1.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample the sphere of dimension ``dim``.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    dim : int
        Dimension of the sphere, at least 1.
    radius : float
        Radius of the sphere.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, dim + 1)
        Samples, uniform in area.
    """
    rng, count = _generator(random_state), _count(num_samples)
    dim = _at_least(dim, 1, "dim")
    return _positive(radius, "radius") * _directions(count, dim + 1, rng)


def torus(
    num_samples: int,
    *,
    major_radius: float = 1.0,
    minor_radius: float = 0.4,
    spacing_ratio: float = 1.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a torus of revolution in space.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    major_radius : float
        Distance from the axis to the center of the tube.
    minor_radius : float
        Radius of the tube, below ``major_radius``.
    spacing_ratio : float
        Largest over smallest spacing, at least 1; the density goes with its square.
        The logarithm of the spacing is linear in cos u, u the angle around the axis.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, uniform in area where ``spacing_ratio`` is 1, else densest at the
        largest x.

    References
    ----------
    Diaconis, Holmes, Shahshahani, *Sampling from a Manifold*, 2013: the rejection
    that makes the samples uniform in area.
    """
    rng, count = _generator(random_state), _count(num_samples)
    _check_radii(major_radius, minor_radius)
    _check_spacing_ratio(spacing_ratio)

    def draw(n: int) -> tuple[FloatArray, FloatArray]:
        v = _angles(n, rng)
        return v[:, None], major_radius + minor_radius * np.cos(v)

    def draw_around(n: int) -> tuple[FloatArray, FloatArray]:
        u = _angles(n, rng)
        density: FloatArray = np.power(spacing_ratio, np.cos(u) - 1)
        return u[:, None], density

    v = _reject(draw, count, rng, major_radius + minor_radius)[:, 0]
    if spacing_ratio == 1:
        u = _angles(count, rng)
    else:
        u = _reject(draw_around, count, rng, 1.0)[:, 0]
    return _torus_points(u, v, major_radius, minor_radius)


def double_torus(
    num_samples: int,
    *,
    thickness: float = 0.2,
    length: float = 1.6,
    spacing_ratio: float = 1.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a smooth surface of genus 2 in space.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    thickness : float
        Half the height of the surface, below 1/4, where its holes close.
    length : float
        Half the length of the figure eight that the surface surrounds; it is 1 wide.
    spacing_ratio : float
        Largest over smallest spacing, at least 1. The spacing is linear in x.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, uniform in area where ``spacing_ratio`` is 1, else densest at the
        smallest x.

    Notes
    -----
    (w^2 (1 - w^2) - y^2)^2 + z^2 = thickness^2 with w = x / length. For a thickness of 0
    this is a figure eight with holes around x = ±length / sqrt(2). Samples are points
    where random lines parallel to the axes meet the surface, which every line does in
    closed form; kept with a chance of 1 over the sum of the normal's absolute
    coordinates, they are uniform.
    """
    rng, count = _generator(random_state), _count(num_samples)
    if not 0 < thickness < 0.25:
        msg = f"thickness must be between 0 and 1/4, got {thickness}"
        raise ValueError(msg)
    _positive(thickness, "thickness")
    _positive(length, "length")
    _check_spacing_ratio(spacing_ratio)
    extent = np.array(
        [
            length * np.sqrt((1 + np.sqrt(1 + 4 * thickness)) / 2),
            np.sqrt(0.25 + thickness),
            thickness,
        ]
    )
    # A line along x meets the surface at most eight times, along y four, along z two.
    chances = np.array([8, 4, 2]) / extent
    chances /= chances.sum()

    def meet(points: FloatArray, axes: NDArray[np.intp]) -> FloatArray:
        """Move points along their axes to one of the places on the surface, or NaN."""
        first, second, third = rng.choice([-1.0, 1.0], (3, len(points)))
        x, y, z = points.T
        level = first * np.sqrt(thickness**2 - z**2)  # of w^2 (1 - w^2) - y^2
        squared = (1 + second * np.sqrt(1 - 4 * (y**2 + level))) / 2
        eight = (x / length) ** 2 * (1 - (x / length) ** 2)
        places = [
            third * length * np.sqrt(squared),
            second * np.sqrt(eight - level),
            first * np.sqrt(thickness**2 - (eight - y**2) ** 2),
        ]
        moved: FloatArray = points.copy()
        moved[np.arange(len(points)), axes] = np.choose(axes, places)
        return moved

    def draw(n: int) -> tuple[FloatArray, FloatArray]:
        n *= 4  # most lines miss
        axes = rng.choice(3, n, p=chances)
        with np.errstate(invalid="ignore"):
            points = meet(rng.uniform(-extent, extent, (n, 3)), axes)
        points = points[~np.isnan(points).any(axis=1)]
        w, y, z = (points / [length, 1.0, 1.0]).T
        level = w**2 * (1 - w**2) - y**2
        normal = np.stack(
            [level * (2 * w - 4 * w**3) / length, -2 * y * level, z], axis=1
        )
        share = np.linalg.norm(normal, axis=1) / np.abs(normal).sum(axis=1)
        along = (1 + points[:, 0] / extent[0]) / 2
        return points, share / (1 + (spacing_ratio - 1) * along) ** 2

    return _reject(draw, count, rng, 1.0)


def grid_torus(
    num_samples: int = 960,
    *,
    num_around: int = 48,
    major_radius: float = 1.0,
    minor_radius: float = 0.4,
    staggered: bool = False,
    jitter: float = 0.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a torus of revolution on a regular grid of angles (figure 9).

    The four corners of every cell of the grid lie on a circle. Delaunay methods
    cannot decide which diagonal of such a cyclic quadrilateral to take: with a
    little jitter the paper's method takes both here and none there.

    Parameters
    ----------
    num_samples : int
        Number of samples, a multiple of ``num_around``.
    num_around : int
        Number of grid lines around the axis, at least 3.
    major_radius : float
        Distance from the axis to the center of the tube.
    minor_radius : float
        Radius of the tube, below ``major_radius``.
    staggered : bool
        Shift every other row around the axis by half a step, which turns the cyclic
        quadrilaterals into triangles. Take an even number of rows.
    jitter : float
        Standard deviation of a normal displacement of both angles, in units of the
        grid's spacing. The samples stay on the torus.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, not uniform in area.
    """
    rng, count = _generator(random_state), _count(num_samples)
    _check_radii(major_radius, minor_radius)
    rows = _at_least(num_around, 3, "num_around")
    _check_multiple(count, rows)
    i, j = np.divmod(np.arange(count), count // rows)
    shift = 0.5 * (j % 2) if staggered else 0.0
    displacement = _jitter(jitter) * rng.standard_normal((2, count))
    return _torus_points(
        2 * np.pi * (i + shift + displacement[0]) / rows,
        2 * np.pi * (j + displacement[1]) / (count // rows),
        major_radius,
        minor_radius,
    )


def klein_bottle(
    num_samples: int,
    *,
    major_radius: float = 1.0,
    minor_radius: float = 0.4,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample a Klein bottle in R^4.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    major_radius : float
        Radius of the circle that the tube follows.
    minor_radius : float
        Radius of the tube, below ``major_radius``.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 4)
        Samples, uniform in area.

    Notes
    -----
    ((R + r cos v) cos u, (R + r cos v) sin u, r sin v cos(u/2), r sin v sin(u/2)): a
    torus whose tube turns over by half a turn in the last two coordinates. The area
    element is r sqrt((R + r cos v)^2 + (r sin v)^2 / 4).
    """
    rng, count = _generator(random_state), _count(num_samples)
    _check_radii(major_radius, minor_radius)

    def draw(n: int) -> tuple[FloatArray, FloatArray]:
        v = _angles(n, rng)
        around = major_radius + minor_radius * np.cos(v)
        return v[:, None], np.hypot(around, minor_radius * np.sin(v) / 2)

    v = _reject(draw, count, rng, major_radius + minor_radius)[:, 0]
    u = _angles(count, rng)
    around = major_radius + minor_radius * np.cos(v)
    across = minor_radius * np.sin(v)
    return np.hstack(
        [
            around[:, None] * _unit_circle(u),
            across[:, None] * _unit_circle(u / 2),
        ]
    )


def projective_plane(
    num_samples: int, *, random_state: RandomState = None
) -> FloatArray:
    """Sample the real projective plane as the Veronese surface in R^5.

    Parameters
    ----------
    num_samples : int
        Number of samples.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 5)
        Samples on the unit sphere of R^5, uniform in area.

    Notes
    -----
    (sqrt(3) xy, sqrt(3) xz, sqrt(3) yz, sqrt(3) (x^2 - y^2) / 2, z^2 - (x^2 + y^2) / 2)
    of (x, y, z) on the unit sphere: antipodes have one image, and rotations of the
    sphere become rotations of R^5.
    """
    rng, count = _generator(random_state), _count(num_samples)
    x, y, z = _directions(count, 3, rng).T
    return np.column_stack(
        [
            np.sqrt(3) * x * y,
            np.sqrt(3) * x * z,
            np.sqrt(3) * y * z,
            np.sqrt(3) * (x**2 - y**2) / 2,
            z**2 - (x**2 + y**2) / 2,
        ]
    )


def interlocking_tori(
    num_samples: int,
    *,
    major_radius: float = 1.0,
    minor_radius: float = 0.3,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample two interlocking tori in space (figure 8).

    Parameters
    ----------
    num_samples : int
        Number of samples, half of them on each torus.
    major_radius : float
        Distance from each torus's axis to the center of its tube.
    minor_radius : float
        Radius of both tubes, below half of ``major_radius``, or the tori meet.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, uniform in area, one torus after the other.
    """
    if not minor_radius < major_radius / 2:
        msg = (
            "minor_radius must be below half of major_radius, got "
            f"{minor_radius} and {major_radius}"
        )
        raise ValueError(msg)
    rng = _generator(random_state)
    counts = _shares(num_samples, [1.0, 1.0])
    first, second = (
        torus(n, major_radius=major_radius, minor_radius=minor_radius, random_state=rng)
        for n in counts
    )
    return _interlock(first, second, major_radius)


def concentric_spheres(
    num_samples: int,
    *,
    spacings: float = 3.0,
    radius: float = 1.0,
    random_state: RandomState = None,
) -> FloatArray:
    """Sample two concentric spheres that are few spacings apart.

    Parameters
    ----------
    num_samples : int
        Number of samples on both together, above ``4 pi spacings^2``.
    spacings : float
        Distance between the spheres in units of the mean spacing, the square root of
        the area per sample; that is twice the mean distance to the nearest neighbor.
    radius : float
        Radius of the outer sphere.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples, uniform in area, the inner sphere first.
    """
    rng, count = _generator(random_state), _count(num_samples)
    # distance^2 = share (1 + (1 - distance)^2) on an outer sphere of radius 1
    share = 4 * np.pi * _positive(spacings, "spacings") ** 2 / count
    if share >= 1:
        msg = (
            f"num_samples must be above 4 pi spacings^2 = {share * count:.0f}, "
            f"got {count}"
        )
        raise ValueError(msg)
    inner = 1 - (np.sqrt(share * (2 - share)) - share) / (1 - share)
    radii = _positive(radius, "radius") * np.array([inner, 1.0])
    counts = _shares(count, list(radii**2))
    return np.vstack(
        [
            r * _directions(n, 3, rng)
            for r, n in zip(radii.tolist(), counts, strict=True)
        ]
    )


def fruit_bowl(num_samples: int, *, random_state: RandomState = None) -> FloatArray:
    """Sample a bowl with an orange, a pear and a lemon in it (figure 7).

    Parameters
    ----------
    num_samples : int
        Number of samples, shared in proportion to area.
    random_state : int, Generator, RandomState or None
        Source of randomness.

    Returns
    -------
    ndarray of shape (num_samples, 3)
        Samples on four disjoint closed surfaces of genus 0, uniform in area, one
        surface after the other.
    """
    rng = _generator(random_state)
    patches = _bowl_and_fruits()
    counts = _shares(num_samples, [patch.area for patch in patches])
    return np.vstack([p.sample(n, rng) for p, n in zip(patches, counts, strict=True)])
