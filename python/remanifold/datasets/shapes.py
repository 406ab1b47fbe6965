# SPDX-License-Identifier: GPL-3.0-or-later
"""All generators with the topology of what they sample, and the figures of the paper."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from remanifold.datasets._drawing import FloatArray, _interlock
from remanifold.datasets._fruits import _bowl_and_fruits
from remanifold.datasets.any_dimension import (
    flat_torus,
    rotations,
    sphere_times_circle,
    sphere_times_sphere,
)
from remanifold.datasets.bounded import (
    annulus,
    ball,
    bent_ball,
    grid_cylinder,
    moebius_band,
    spherical_cap,
    swiss_roll,
)
from remanifold.datasets.changes import spread
from remanifold.datasets.curves import (
    circle,
    closed_curve,
    ellipse,
    interlocking_circles,
    planar_curve,
    planar_curves,
    spiral,
    trefoil,
)
from remanifold.datasets.surfaces import (
    concentric_spheres,
    double_torus,
    fruit_bowl,
    grid_torus,
    interlocking_tori,
    klein_bottle,
    projective_plane,
    sphere,
    torus,
)


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
