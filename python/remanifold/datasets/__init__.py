# SPDX-License-Identifier: GPL-3.0-or-later
"""Sampled manifolds with known topology.

Every generator takes the number of samples first, everything else by keyword, and
returns a float64 array of shape ``(num_samples, D)``. Samples are drawn uniformly
in arc length, area or volume unless the generator says otherwise. ``random_state``
follows the convention of :mod:`sklearn.datasets`: an int for a reproducible sample, a
generator to draw from, None for fresh randomness.

:data:`SHAPES` lists every generator, some once more with other options, with the
topology of its manifold, and :data:`FIGURES` the examples of figures 3 to 9 of Freedman,
*Efficient Simplicial Reconstructions of Manifolds from Their Samples*, IEEE TPAMI
24(10), 2002.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "FIGURES",
    "SHAPES",
    "RandomState",
    "Shape",
    "add_noise",
    "annulus",
    "ball",
    "ball_on_disc",
    "bent_ball",
    "branching",
    "circle",
    "closed_curve",
    "concentric_spheres",
    "crossing_balls",
    "double_cone",
    "double_torus",
    "ellipse",
    "embed",
    "figure_eight",
    "figure_samples",
    "flat_torus",
    "fruit_bowl",
    "grid_cylinder",
    "grid_torus",
    "immersed_klein_bottle",
    "interlocking_circles",
    "interlocking_tori",
    "klein_bottle",
    "moebius_band",
    "planar_curve",
    "planar_curves",
    "projective_plane",
    "rotations",
    "sphere",
    "sphere_times_circle",
    "sphere_times_sphere",
    "sphere_with_antenna",
    "spherical_cap",
    "spindle_torus",
    "spiral",
    "spread",
    "swiss_roll",
    "torus",
    "trefoil",
]

FloatArray: TypeAlias = NDArray[np.float64]
RandomState: TypeAlias = int | np.random.Generator | np.random.RandomState | None


# --------------------------------------------------------------------- curves


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


# ------------------------------------------------------------ closed surfaces


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
    displacement = jitter * rng.standard_normal((2, count))
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


def figure_samples(number: int) -> FloatArray:
    """Arrange samples for a figure of Freedman (2002).

    The paper asks for dense samples without noise and does not say how its own were
    placed. These are placed evenly, but for figure 9, whose point is that they are not.

    Parameters
    ----------
    number : int
        Number of the figure, 3 to 9. :data:`FIGURES` names its shape.

    Returns
    -------
    ndarray of shape (N, D)
        Samples, the same in every call.

        ==== ===== =====================================================
        no.  N     placed
        ==== ===== =====================================================
        3    120   farthest points of random samples, see :func:`spread`
        4    320   the same
        5    320   the same
        6    120   the same
        7    3338  as on geodesic spheres, stretched over the four surfaces
        8    2160  in staggered rows, with a jitter of 2 % of the spacing
        9    960   on a regular grid, with a jitter of 2 % of the spacing
        ==== ===== =====================================================

    Examples
    --------
    >>> import remanifold as rm
    >>> rm.datasets.figure_samples(6).shape
    (120, 3)
    """
    if number not in FIGURES:
        known = f"{min(FIGURES)} to {max(FIGURES)}"
        msg = f"number must be one of the figures {known}, got {number}"
        raise ValueError(msg)
    if number == 7:
        frequencies = (16, 6, 5, 4)
        patches = zip(_bowl_and_fruits(), frequencies, strict=True)
        return np.vstack([patch.geodesic(frequency) for patch, frequency in patches])
    if number == 8:
        first, second = (
            grid_torus(
                1080,
                num_around=60,
                minor_radius=0.3,
                staggered=True,
                jitter=0.02,
                random_state=seed,
            )
            for seed in (0, 1)
        )
        return _interlock(first, second, 1.0)
    if number == 9:
        return grid_torus(960, jitter=0.02, random_state=0)
    count = {3: 120, 4: 320, 5: 320, 6: 120}[number]
    dense = SHAPES[FIGURES[number]].generate(20 * count, random_state=0)
    return spread(dense, count, random_state=0)


# ------------------------------------------------- manifolds of any dimension


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
            sphere(num_samples, radius=sphere_radius, random_state=rng),
            circle(num_samples, radius=circle_radius, random_state=rng),
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


# ------------------------------------------------------ manifolds with boundary


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
    displacement = jitter * rng.standard_normal((2, count))
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


# ----------------------------------------------------------- no manifolds


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
    counts = _shares(num_samples, [1 - share, share])
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
    counts = _shares(num_samples, [1 - share, share])
    radii = rng.uniform(radius**dim, 1.0, (counts[0], 1)) ** (1 / dim)
    disc = radii * _directions(counts[0], dim, rng)
    solid = ball(counts[1], dim=dim + 1, radius=radius, random_state=rng)
    return np.vstack([np.pad(disc, ((0, 0), (0, 1))), solid])


# --------------------------------------------------------------- on any sample


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


# ----------------------------------------------------------------- the tables


@dataclass(frozen=True)
class Shape:
    """A generator and the topology of the manifold that it samples.

    Attributes
    ----------
    generate : callable
        The generator; its defaults give the manifold described here.
    dim : int
        Dimension K of the manifold.
    ambient_dim : int
        Dimension D of the space.
    betti_numbers : tuple of K + 1 ints
        Betti numbers with coefficients in Z/2.
    closed : bool
        Whether the manifold has no boundary.
    orientable : bool
        Whether the manifold is orientable.
    boundary_components : int
        Number of connected components of the boundary; by default 1 where the
        manifold is not closed.
    betti_numbers_mod3 : tuple of K + 1 ints
        Betti numbers with coefficients in Z/3; by default those in Z/2. They differ
        where there is 2-torsion.
    """

    generate: Callable[..., FloatArray]
    dim: int
    ambient_dim: int
    betti_numbers: tuple[int, ...]
    closed: bool = True
    orientable: bool = True
    boundary_components: int = -1
    betti_numbers_mod3: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        """Fill in the defaults that depend on other attributes."""
        if self.boundary_components < 0:
            object.__setattr__(self, "boundary_components", int(not self.closed))
        if not self.betti_numbers_mod3:
            object.__setattr__(self, "betti_numbers_mod3", self.betti_numbers)

    @property
    def components(self) -> int:
        """Number of connected components."""
        return self.betti_numbers[0]

    @property
    def euler_characteristic(self) -> int:
        """Alternating sum of the Betti numbers."""
        return sum((-1) ** k * b for k, b in enumerate(self.betti_numbers))


#: Manifolds with known topology, by name.
SHAPES: dict[str, Shape] = {
    "circle": Shape(circle, 1, 2, (1, 1)),
    "ellipse": Shape(ellipse, 1, 2, (1, 1)),
    "planar_curve": Shape(planar_curve, 1, 2, (1, 1)),
    "planar_curves": Shape(planar_curves, 1, 2, (2, 2)),
    "spiral": Shape(spiral, 1, 2, (1, 0), closed=False, boundary_components=2),
    "trefoil": Shape(trefoil, 1, 3, (1, 1)),
    "closed_curve": Shape(closed_curve, 1, 10, (1, 1)),
    "closed_curve_in_100": Shape(
        partial(closed_curve, ambient_dim=100), 1, 100, (1, 1)
    ),
    "interlocking_circles": Shape(interlocking_circles, 1, 3, (2, 2)),
    "sphere": Shape(sphere, 2, 3, (1, 0, 1)),
    "sphere_3": Shape(partial(sphere, dim=3), 3, 4, (1, 0, 0, 1)),
    "sphere_4": Shape(partial(sphere, dim=4), 4, 5, (1, 0, 0, 0, 1)),
    "concentric_spheres": Shape(concentric_spheres, 2, 3, (2, 0, 2)),
    "torus": Shape(torus, 2, 3, (1, 2, 1)),
    "uneven_torus": Shape(partial(torus, spacing_ratio=10.0), 2, 3, (1, 2, 1)),
    "grid_torus": Shape(grid_torus, 2, 3, (1, 2, 1)),
    "double_torus": Shape(double_torus, 2, 3, (1, 4, 1)),
    "uneven_double_torus": Shape(
        partial(double_torus, spacing_ratio=10.0), 2, 3, (1, 4, 1)
    ),
    "klein_bottle": Shape(
        klein_bottle,
        2,
        4,
        (1, 2, 1),
        orientable=False,
        betti_numbers_mod3=(1, 1, 0),
    ),
    "projective_plane": Shape(
        projective_plane,
        2,
        5,
        (1, 1, 1),
        orientable=False,
        betti_numbers_mod3=(1, 0, 0),
    ),
    "interlocking_tori": Shape(interlocking_tori, 2, 3, (2, 4, 2)),
    "fruit_bowl": Shape(fruit_bowl, 2, 3, (4, 0, 4)),
    "flat_torus": Shape(flat_torus, 2, 4, (1, 2, 1)),
    "flat_torus_in_100": Shape(partial(flat_torus, ambient_dim=100), 2, 100, (1, 2, 1)),
    "flat_torus_3": Shape(partial(flat_torus, dim=3), 3, 6, (1, 3, 3, 1)),
    "rotations": Shape(rotations, 3, 9, (1, 1, 1, 1), betti_numbers_mod3=(1, 0, 0, 1)),
    "sphere_times_circle": Shape(sphere_times_circle, 3, 5, (1, 1, 1, 1)),
    "sphere_times_sphere": Shape(sphere_times_sphere, 4, 6, (1, 0, 2, 0, 1)),
    "moebius_band": Shape(
        moebius_band, 2, 3, (1, 1, 0), closed=False, orientable=False
    ),
    "annulus": Shape(annulus, 2, 2, (1, 1, 0), closed=False, boundary_components=2),
    "annulus_in_4": Shape(
        partial(annulus, ambient_dim=4),
        2,
        4,
        (1, 1, 0),
        closed=False,
        boundary_components=2,
    ),
    "grid_cylinder": Shape(
        grid_cylinder, 2, 3, (1, 1, 0), closed=False, boundary_components=2
    ),
    "swiss_roll": Shape(swiss_roll, 2, 3, (1, 0, 0), closed=False),
    "spherical_cap": Shape(spherical_cap, 2, 3, (1, 0, 0), closed=False),
    "ball": Shape(ball, 3, 3, (1, 0, 0, 0), closed=False),
    "bent_ball": Shape(bent_ball, 3, 4, (1, 0, 0, 0), closed=False),
}

#: Names in `SHAPES` of the manifolds of figures 3 to 9 of Freedman (2002).
FIGURES: dict[int, str] = {
    3: "planar_curve",
    4: "planar_curves",
    5: "spiral",
    6: "interlocking_circles",
    7: "fruit_bowl",
    8: "interlocking_tori",
    9: "grid_torus",
}


# ------------------------------------------------------------ drawing at random


def _generator(random_state: RandomState) -> np.random.Generator:
    if isinstance(random_state, np.random.RandomState):
        return np.random.Generator(random_state._bit_generator)
    return np.random.default_rng(random_state)


def _angles(count: int, rng: np.random.Generator) -> FloatArray:
    return rng.uniform(0.0, 2 * np.pi, count)


def _unit_circle(angles: FloatArray) -> FloatArray:
    return np.column_stack([np.cos(angles), np.sin(angles)])


def _directions(count: int, dim: int, rng: np.random.Generator) -> FloatArray:
    vectors = rng.standard_normal((count, dim))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def _reject(
    draw: Callable[[int], tuple[FloatArray, FloatArray]],
    count: int,
    rng: np.random.Generator,
    bound: float,
) -> FloatArray:
    """Keep parameters with a chance of density / bound, until there are enough."""
    kept: list[FloatArray] = []
    while (missing := count - sum(map(len, kept))) > 0:
        parameters, density = draw(2 * missing + 8)
        kept.append(parameters[rng.uniform(0.0, bound, len(density)) < density])
    return np.concatenate(kept)[:count]


def _curve(
    curve: Callable[[FloatArray], FloatArray],
    interval: tuple[float, float],
    num_samples: int,
    random_state: RandomState,
) -> FloatArray:
    """Sample a curve uniformly in arc length, measured on a fine polygon."""
    rng, count = _generator(random_state), _count(num_samples)
    t = np.linspace(*interval, 20_001)
    length = np.linalg.norm(np.diff(curve(t), axis=0), axis=1).cumsum()
    length = np.concatenate([[0.0], length])
    return curve(np.interp(rng.uniform(0.0, length[-1], count), length, t))


def _torus_points(
    u: FloatArray, v: FloatArray, major_radius: float, minor_radius: float
) -> FloatArray:
    around = major_radius + minor_radius * np.cos(v)
    return np.column_stack(
        [around[:, None] * _unit_circle(u), minor_radius * np.sin(v)]
    )


def _interlock(first: FloatArray, second: FloatArray, offset: float) -> FloatArray:
    return np.vstack([first, _moved(second[:, [0, 2, 1]], offset, 0.0, 0.0)])


class _Patch:
    """A surface of revolution, its area measured on a grid of 256 x 256 cells.

    Samples lie exactly on the surface; within a cell the density is that of its
    center. ``u`` is the angle around the axis, ``v`` goes from one pole to the other.
    """

    def __init__(
        self,
        surface: Callable[[FloatArray, FloatArray], FloatArray],
        v_end: float,
        cells: int = 256,
    ) -> None:
        self._surface = surface
        self._step = np.array([2 * np.pi, v_end]) / cells
        self._corners = np.indices((cells, cells)).reshape(2, -1).T * self._step
        u, v = (self._corners + self._step / 2).T
        du, dv = self._step / 2
        along_u = surface(u + du, v) - surface(u - du, v)
        along_v = surface(u, v + dv) - surface(u, v - dv)
        self._areas = np.linalg.norm(np.cross(along_u, along_v), axis=1)
        self.area = float(self._areas.sum())

    def sample(self, count: int, rng: np.random.Generator) -> FloatArray:
        cells = rng.choice(len(self._areas), count, p=self._areas / self.area)
        parameters = self._corners[cells] + rng.uniform(size=(count, 2)) * self._step
        return self._surface(*parameters.T)

    def geodesic(self, frequency: int) -> FloatArray:
        """Points of a geodesic sphere, stretched so that areas keep their proportion."""
        x, y, z = _geodesic_sphere(frequency).T
        rows = round(np.sqrt(len(self._areas)))
        below = self._areas.reshape(rows, rows).sum(axis=0).cumsum() / self.area
        edges = np.arange(rows + 1) * self._step[1]
        share = np.clip((1 - z) / 2, 0.0, 1.0)
        v = np.interp(share, np.concatenate([[0.0], below]), edges)
        return self._surface(np.arctan2(y, x), v)


def _geodesic_sphere(frequency: int) -> FloatArray:
    """Vertices of an icosahedron whose edges are split into ``frequency`` parts.

    There are 10 frequency^2 + 2, turned at random so that no axis is special.
    """
    golden = (1 + np.sqrt(5)) / 2
    corners = np.array(
        [
            np.roll([0.0, one, phi], turn)
            for turn in range(3)
            for one in (-1.0, 1.0)
            for phi in (-golden, golden)
        ]
    )
    touching = np.linalg.norm(corners[:, None] - corners, axis=2) < 2.1
    weights = np.array(
        [
            (i, j, frequency - i - j)
            for i in range(frequency + 1)
            for j in range(frequency + 1 - i)
        ]
    )
    points = np.vstack(
        [
            weights @ corners[list(face)]
            for face in combinations(range(12), 3)
            if touching[np.ix_(face, face)].all()
        ]
    )
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    _, first = np.unique(points.round(9), axis=0, return_index=True)
    turn = np.linalg.qr(np.random.default_rng(0).standard_normal((3, 3)))[0]
    return np.asarray(points[first] @ turn)


# --------------------------------------------------------- the bowl and its fruits


def _bowl_and_fruits() -> list[_Patch]:
    fruits = [_Patch(surface, np.pi) for surface in (_orange, _pear, _lemon)]
    return [_Patch(_bowl, 3.0), *fruits]


def _bowl(u: FloatArray, v: FloatArray) -> FloatArray:
    # A thick cap of a sphere. Its outline: up the outside, over the rim, down again.
    outside, rim, inside = (np.clip(v - start, 0.0, 1.0) for start in range(3))
    depth = 1.15 * (outside - inside)
    radius = 2.0 + 0.2 * np.cos(np.pi * rim)
    height = 0.2 * np.sin(np.pi * rim)
    outline = np.column_stack(
        [
            radius * np.sin(depth) + height * np.cos(depth),
            -radius * np.cos(depth) + height * np.sin(depth),
        ]
    )
    return np.column_stack([outline[:, :1] * _unit_circle(u), outline[:, 1]])


def _orange(u: FloatArray, v: FloatArray) -> FloatArray:
    around = 0.6 * np.sin(v)[:, None] * _unit_circle(u)
    points = np.column_stack([around, 0.56 * np.cos(v)])
    return _moved(points, -0.64, 0.4, -0.4)


def _pear(u: FloatArray, v: FloatArray) -> FloatArray:
    around = (0.46 * np.sin(v) * (1 - 0.35 * np.cos(v)))[:, None] * _unit_circle(u)
    points = np.column_stack([around, 0.72 * np.cos(v)])
    return _moved(points, 0.8, 0.4, -0.2)


def _lemon(u: FloatArray, v: FloatArray) -> FloatArray:
    around = 0.38 * np.sin(v)[:, None] * _unit_circle(u)
    points = np.column_stack([0.52 * np.cos(v), around])
    return _moved(points, 0.1, -0.76, -0.72)


def _moved(points: FloatArray, *offset: float) -> FloatArray:
    return np.asarray(points + np.array(offset))


# ------------------------------------------------------------------- validation


def _count(num_samples: int) -> int:
    return _at_least(num_samples, 1, "num_samples")


def _at_least(value: int, minimum: int, name: str) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        msg = f"{name} must be an integer, got {value!r}"
        raise TypeError(msg) from None
    if number < minimum:
        msg = f"{name} must be at least {minimum}, got {number}"
        raise ValueError(msg)
    return number


def _positive(value: float, name: str) -> float:
    if not value > 0:
        msg = f"{name} must be positive, got {value}"
        raise ValueError(msg)
    return value


def _below_pi(angle: float, name: str) -> float:
    if not 0 < angle < np.pi:
        msg = f"{name} must be between 0 and pi, got {angle}"
        raise ValueError(msg)
    return angle


def _check_radii(
    outer: float,
    inner: float,
    names: tuple[str, str] = ("major_radius", "minor_radius"),
) -> None:
    if not 0 < inner < outer:
        msg = f"0 < {names[1]} < {names[0]} must hold, got {inner} and {outer}"
        raise ValueError(msg)


def _check_multiple(count: int, num_around: int) -> None:
    if count % num_around:
        msg = (
            f"num_samples must be a multiple of num_around = {num_around}, got {count}"
        )
        raise ValueError(msg)


def _check_spacing_ratio(spacing_ratio: float) -> None:
    if not 1 <= spacing_ratio < np.inf:
        msg = f"spacing_ratio must be at least 1 and finite, got {spacing_ratio}"
        raise ValueError(msg)


def _shares(num_samples: int, weights: Sequence[float]) -> list[int]:
    """Split the samples in proportion to the weights; the last takes the rest."""
    count = _count(num_samples)
    edges = np.rint(np.cumsum(weights) / np.sum(weights) * count).astype(int)
    return [int(n) for n in np.diff(edges, prepend=0)]
