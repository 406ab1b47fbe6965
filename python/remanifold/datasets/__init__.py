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

from remanifold.datasets._drawing import RandomState
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
from remanifold.datasets.changes import add_noise, embed, spread
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
from remanifold.datasets.shapes import FIGURES, SHAPES, Shape, figure_samples
from remanifold.datasets.singular import (
    ball_on_disc,
    branching,
    crossing_balls,
    double_cone,
    figure_eight,
    immersed_klein_bottle,
    sphere_with_antenna,
    spindle_torus,
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


def __dir__() -> list[str]:
    """Public names only."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
