# SPDX-License-Identifier: GPL-3.0-or-later
"""The samples lie on their manifolds, uniformly, and come back with their seed."""

from __future__ import annotations

import inspect
import time

import numpy as np
import pytest

from remanifold import datasets
from remanifold.datasets import FIGURES, SHAPES

# For every shape an equation of its manifold: zero (or true) at each sample.
NORM = np.linalg.norm


def on_torus(points, major_radius=1.0, minor_radius=0.4):
    around = np.hypot(points[:, 0], points[:, 1]) - major_radius
    return np.hypot(around, points[:, 2]) - minor_radius


def on_planar_curve(points, lobes, depth):
    phi = np.arctan2(points[:, 1], points[:, 0])
    return NORM(points, axis=1) - 1 - depth * np.cos(lobes * phi)


def on_planar_curves(points):
    left = points[:, 0] < 1.45
    first, second = points[left], points[~left] - [2.2, 0.0]
    return np.concatenate(
        [
            on_planar_curve(first, 3, 0.3),
            (second[:, 0] / 0.6) ** 2 + (second[:, 1] / 1.15) ** 2 - 1,
        ]
    )


def on_spiral(points):
    turns = NORM(points, axis=1) - 0.5
    phi = np.arctan2(points[:, 1], points[:, 0]) / (2 * np.pi)
    return (turns - phi + 0.5) % 1.0 - 0.5


def on_trefoil(points):
    # x^2 + y^2 = 5 - 4 cos 3t, and z = -sin 3t.
    cosine = (5 - (points[:, :2] ** 2).sum(axis=1)) / 4
    return cosine**2 + points[:, 2] ** 2 - 1


def on_closed_curve(points):
    t = np.arctan2(points[:, 1], points[:, 0])
    k = np.arange(1, points.shape[1] // 2 + 1)
    expected = np.stack([np.cos(t[:, None] * k), np.sin(t[:, None] * k)], axis=2)
    return (points - (expected / (k**2)[:, None]).reshape(len(points), -1)).ravel()


def on_interlocking_circles(points):
    first = np.hypot(NORM(points[:, :2], axis=1) - 1, points[:, 2])
    second = np.hypot(NORM(points[:, [0, 2]] - [1, 0], axis=1) - 1, points[:, 1])
    return np.minimum(first, second)


def on_interlocking_tori(points):
    first = on_torus(points, minor_radius=0.3)
    second = on_torus(points[:, [0, 2, 1]] - [1, 0, 0], minor_radius=0.3)
    return np.minimum(np.abs(first), np.abs(second))


def on_klein_bottle(points):
    # In the frame that turns over with u, the tube is a circle.
    u = np.arctan2(points[:, 1], points[:, 0])
    around = NORM(points[:, :2], axis=1) - 1
    across = points[:, 2] * np.cos(u / 2) + points[:, 3] * np.sin(u / 2)
    outside = points[:, 3] * np.cos(u / 2) - points[:, 2] * np.sin(u / 2)
    return np.concatenate([np.hypot(around, across) - 0.4, outside])


def on_projective_plane(points):
    # The traceless symmetric matrix of the point has eigenvalues 2, -1, -1 (over 3).
    xy, xz, yz = points[:, :3].T / np.sqrt(3)
    difference, zz = 2 * points[:, 3] / np.sqrt(3), (2 * points[:, 4] + 1) / 3
    xx, yy = (1 - zz + difference) / 2, (1 - zz - difference) / 2
    matrices = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]).transpose(2, 0, 1)
    return (matrices @ matrices - matrices).ravel()


def on_rotations(points):
    matrices = points.reshape(-1, 3, 3)
    products = matrices @ matrices.transpose(0, 2, 1) - np.eye(3)
    return np.concatenate([products.ravel(), np.linalg.det(matrices) - 1])


def on_moebius_band(points):
    u = np.arctan2(points[:, 1], points[:, 0])
    along = NORM(points[:, :2], axis=1) - 1
    return along * np.sin(u / 2) - points[:, 2] * np.cos(u / 2)


def on_double_torus(points):
    x, y, z = points.T
    w = x / 1.6
    return (w**2 * (1 - w**2) - y**2) ** 2 + z**2 - 0.2**2


def on_concentric_spheres(points):
    radii = NORM(points, axis=1)
    count = np.count_nonzero(radii < radii.mean())  # inner samples come first
    inner, outer = radii[:count], radii[count:]
    return np.concatenate([inner - inner[0], outer - 1])


def in_flat_space(points, dim):
    """The points in coordinates of the space that they span; zero beyond ``dim``."""
    basis = np.linalg.svd(points, full_matrices=False)[2]
    coordinates = points @ basis.T
    np.testing.assert_allclose(coordinates[:, dim:], 0.0, atol=1e-12)
    return coordinates[:, :dim]


def on_embedded_flat_torus(points):
    # x is in the plane of both circles: |x|^2 = 2, and the products have rank 4.
    coordinates = in_flat_space(points, 4)
    return NORM(coordinates, axis=1) ** 2 - 2


def in_bent_ball(points):
    angle = np.arctan2(points[:, 0], 1 - points[:, -1])
    flat = np.column_stack([angle, points[:, 1:-1]])
    rolled = np.hypot(points[:, 0], 1 - points[:, -1]) - 1
    return np.concatenate([rolled, np.maximum(NORM(flat, axis=1) - 1, 0)])


def in_annulus(points):
    radii = NORM(points, axis=1)
    return np.clip(radii, 0.5, 1) - radii


def on_fruit_bowl(points):
    """Inside the box of the bowl and its fruits; the surfaces have no equation."""
    below, above = [-2.2, -2.2, -2.2], [2.2, 2.2, 0.7]
    return np.where(np.all((points >= below) & (points <= above), axis=1), 0.0, 1.0)


EQUATIONS = {
    "circle": lambda p: NORM(p, axis=1) - 1,
    "ellipse": lambda p: (p[:, 0] / 2) ** 2 + p[:, 1] ** 2 - 1,
    "planar_curve": lambda p: on_planar_curve(p, 5, 0.25),
    "planar_curves": on_planar_curves,
    "spiral": on_spiral,
    "trefoil": on_trefoil,
    "closed_curve": on_closed_curve,
    "closed_curve_in_100": on_closed_curve,
    "interlocking_circles": on_interlocking_circles,
    "sphere": lambda p: NORM(p, axis=1) - 1,
    "sphere_3": lambda p: NORM(p, axis=1) - 1,
    "sphere_4": lambda p: NORM(p, axis=1) - 1,
    "concentric_spheres": on_concentric_spheres,
    "torus": on_torus,
    "uneven_torus": on_torus,
    "double_torus": on_double_torus,
    "uneven_double_torus": on_double_torus,
    "grid_torus": on_torus,
    "klein_bottle": on_klein_bottle,
    "projective_plane": on_projective_plane,
    "interlocking_tori": on_interlocking_tori,
    "fruit_bowl": on_fruit_bowl,
    "flat_torus": lambda p: NORM(p.reshape(-1, 2, 2), axis=2).ravel() - 1,
    "flat_torus_in_100": on_embedded_flat_torus,
    "flat_torus_3": lambda p: NORM(p.reshape(-1, 3, 2), axis=2).ravel() - 1,
    "rotations": on_rotations,
    "sphere_times_circle": lambda p: np.concatenate(
        [NORM(p[:, :3], axis=1) - 1, NORM(p[:, 3:], axis=1) - 1]
    ),
    "sphere_times_sphere": lambda p: NORM(p.reshape(-1, 2, 3), axis=2).ravel() - 1,
    "moebius_band": on_moebius_band,
    "annulus": in_annulus,
    "annulus_in_4": lambda p: in_annulus(in_flat_space(p, 2)),
    "grid_cylinder": lambda p: NORM(p[:, :2], axis=1) - 1,
    "swiss_roll": lambda p: on_spiral(p[:, [0, 2]]),
    "spherical_cap": lambda p: NORM(p, axis=1) - 1 + np.minimum(p[:, 2] - 0.5, 0),
    "ball": lambda p: np.maximum(NORM(p, axis=1) - 1, 0),
    "bent_ball": in_bent_ball,
}


@pytest.mark.parametrize("name", SHAPES)
def test_samples_lie_on_the_manifold(name):
    shape = SHAPES[name]
    points = shape.generate(960, random_state=0)
    assert points.shape == (960, shape.ambient_dim)
    assert points.dtype == np.float64
    assert points.flags.c_contiguous
    # Not exactly 0: rounding, and fractions of a turn that wrap around.
    np.testing.assert_allclose(EQUATIONS[name](points), 0.0, atol=1e-7)
    assert len(np.unique(points, axis=0)) == 960


@pytest.mark.parametrize("name", SHAPES)
def test_random_state(name):
    generate = SHAPES[name].generate
    first = generate(144, random_state=7)
    np.testing.assert_array_equal(generate(144, random_state=7), first)
    np.testing.assert_array_equal(
        generate(144, random_state=np.random.default_rng(7)), first
    )
    if name not in {"grid_torus", "grid_cylinder"}:  # without jitter nothing is random
        assert not np.array_equal(generate(144, random_state=8), first)
        assert not np.array_equal(generate(144), generate(144))
        rng = np.random.default_rng(7)
        assert not np.array_equal(
            generate(144, random_state=rng), generate(144, random_state=rng)
        )


def test_legacy_random_state():
    first, second = (
        datasets.circle(5, random_state=np.random.RandomState(3)) for _ in range(2)
    )
    np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize("name", SHAPES)
def test_topology_in_the_table_is_consistent(name):
    shape = SHAPES[name]
    betti = shape.betti_numbers
    assert len(betti) == shape.dim + 1
    assert shape.components == betti[0] > 0
    mod3 = shape.betti_numbers_mod3
    assert len(mod3) == len(betti)
    signs = (-1) ** np.arange(len(betti))
    assert signs @ mod3 == shape.euler_characteristic
    assert all(np.array(mod3) <= betti)
    assert shape.closed == (shape.boundary_components == 0)
    if shape.closed:  # Poincaré duality with coefficients in Z/2
        assert betti == betti[::-1]
        assert shape.dim % 2 == 0 or shape.euler_characteristic == 0
        assert (mod3 == mod3[::-1]) == shape.orientable
        assert mod3[-1] == (shape.components if shape.orientable else 0)
    else:
        assert betti[-1] == mod3[-1] == 0


def test_defaults_of_a_shape():
    disk = datasets.Shape(datasets.ball, 2, 2, (1, 0, 0), closed=False)
    assert disk.boundary_components == 1
    assert disk.betti_numbers_mod3 == (1, 0, 0)
    assert SHAPES["annulus"].boundary_components == 2
    assert SHAPES["circle"].boundary_components == 0
    assert SHAPES["rotations"].betti_numbers_mod3 == (1, 0, 0, 1)


def test_known_euler_characteristics():
    expected = {"sphere": 2, "torus": 0, "klein_bottle": 0, "projective_plane": 1}
    expected |= {"fruit_bowl": 8, "ball": 1, "moebius_band": 0, "rotations": 0}
    found = {name: SHAPES[name].euler_characteristic for name in expected}
    assert found == expected


# What is no manifold: an equation of each set, zero at every sample.
NO_MANIFOLDS = {
    "figure_eight": lambda p: p[:, 1] ** 2 - p[:, 0] ** 2 * (1 - p[:, 0] ** 2),
    "crossing_balls": lambda p: p[:, 0] * p[:, 2],
    "branching": lambda p: np.sin(3 * np.arctan2(p[:, 1], p[:, 0])) * NORM(p, axis=1),
    "immersed_klein_bottle": lambda p: on_immersed_klein_bottle(p),
    "spindle_torus": lambda p: (
        (NORM(p, axis=1) ** 2 - 0.75) ** 2 - p[:, 0] ** 2 - p[:, 1] ** 2
    ),
    "double_cone": lambda p: NORM(p[:, :2], axis=1) - np.abs(p[:, 2]),
    "sphere_with_antenna": lambda p: np.where(
        NORM(p[:, :2], axis=1) < 1e-12,
        np.clip(p[:, 2], 1, 2) - p[:, 2],
        NORM(p, axis=1) - 1,
    ),
    "ball_on_disc": lambda p: np.where(
        NORM(p, axis=1) <= 0.3, 0.0, np.abs(p[:, 2]) + (NORM(p, axis=1) > 1)
    ),
}


def on_immersed_klein_bottle(points):
    u = np.arctan2(points[:, 1], points[:, 0]) / 2
    across = NORM(points[:, :2], axis=1) - 3
    x = np.cos(u) * across + np.sin(u) * points[:, 2]
    y = np.cos(u) * points[:, 2] - np.sin(u) * across
    return y**2 - 4 * x**2 * (1 - x**2)


@pytest.mark.parametrize("name", NO_MANIFOLDS)
def test_samples_of_what_is_no_manifold(name):
    generate = getattr(datasets, name)
    points = generate(500, random_state=0)
    assert points.shape[0] == 500
    assert points.dtype == np.float64
    np.testing.assert_allclose(NO_MANIFOLDS[name](points), 0.0, atol=1e-9)
    np.testing.assert_array_equal(points, generate(500, random_state=0))


def test_balls_share_what_the_space_does_not_hold():
    for ambient, rank in ((4, 4), (5, 5), (6, 6)):
        points = datasets.crossing_balls(
            600, dim=3, ambient_dim=ambient, angle=1.0, random_state=0
        )
        assert points.shape == (600, ambient)
        assert np.linalg.matrix_rank(points[:300]) == 3
        assert np.linalg.matrix_rank(points) == rank
        assert NORM(points, axis=1).max() <= 1


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("figure_eight", {"angle": np.pi}),
        ("crossing_balls", {"angle": 0.0}),
        ("crossing_balls", {"ambient_dim": 2}),
        ("crossing_balls", {"ambient_dim": 5}),
        ("immersed_klein_bottle", {"radius": 2.0}),
        ("spindle_torus", {"major_radius": 1.0}),
        ("double_cone", {"angle": np.pi / 2}),
        ("double_cone", {"dim": 1}),
        ("sphere_with_antenna", {"length": 0.0}),
        ("ball_on_disc", {"radius": 1.0}),
    ],
)
def test_what_is_no_manifold_has_limits(name, arguments):
    with pytest.raises(ValueError):
        getattr(datasets, name)(100, **arguments)


def test_klein_bottle_crosses_itself_uniformly_in_area():
    # By Pappus the area is that of the figure eight times the circle, up to the turn.
    points = datasets.immersed_klein_bottle(200_000, radius=50.0, random_state=0)
    angle = np.arctan2(points[:, 1], points[:, 0])
    counts = np.histogram(angle, bins=8)[0]
    assert np.abs(counts / 25_000 - 1).max() < 0.03
    across = NORM(points[:, :2], axis=1) - 50
    near = np.hypot(across, points[:, 2]) < 0.2
    # Length of the figure eight within 0.2 of its crossing, over all of it.
    v = np.linspace(0, 2 * np.pi, 400_001)
    eight = np.column_stack([np.sin(v), np.sin(2 * v)])
    steps = NORM(np.diff(eight, axis=0), axis=1)
    inside = NORM(eight[1:], axis=1) < 0.2
    assert near.mean() == pytest.approx(steps[inside].sum() / steps.sum(), rel=0.03)


def test_tables_are_complete():
    others = {"FIGURES", "SHAPES", "RandomState", "Shape"}
    others |= {"add_noise", "embed", "figure_samples", "spread"}
    others |= set(NO_MANIFOLDS)
    generators = {shape.generate for shape in SHAPES.values()}
    names = {getattr(g, "func", g).__name__ for g in generators}
    assert set(datasets.__all__) - others == names <= set(SHAPES)
    assert set(EQUATIONS) == set(SHAPES)
    assert set(FIGURES) == set(range(3, 10))
    assert set(FIGURES.values()) <= set(SHAPES)


# ---------------------------------------------------------------- uniformity

# Expected values of functions under the uniform measure, in closed form.
MEANS = {
    "sphere": (datasets.sphere, lambda p: p[:, 2] ** 2, 1 / 3),
    "sphere_3": (
        lambda n, **k: datasets.sphere(n, dim=3, **k),
        lambda p: p[:, 0] ** 2,
        1 / 4,
    ),
    # cos v has density (1 + r cos v / R) / 2 pi: its mean is r / 2R.
    "torus": (datasets.torus, lambda p: (NORM(p[:, :2], axis=1) - 1) / 0.4, 0.2),
    "annulus": (datasets.annulus, lambda p: NORM(p, axis=1) ** 2, 0.625),
    "ball": (datasets.ball, lambda p: NORM(p, axis=1) ** 3, 0.5),
    "spherical_cap": (datasets.spherical_cap, lambda p: p[:, 2], 0.75),
    "bent_ball": (
        datasets.bent_ball,
        lambda p: p[:, 1] ** 2 + p[:, 2] ** 2,
        2 / 5,
    ),
    "bent_disk": (
        lambda n, **k: datasets.bent_ball(n, dim=2, radius=2, bend_radius=3, **k),
        lambda p: (3 * np.arcsin(p[:, 0] / 3)) ** 2,
        1.0,
    ),
    "sphere_times_sphere": (
        lambda n, **k: datasets.sphere_times_sphere(n, radii=(1, 2), **k),
        lambda p: p[:, 1] ** 2 + p[:, 5] ** 2,
        1 / 3 + 4 / 3,
    ),
    "rotations": (datasets.rotations, lambda p: p[:, 0] ** 2, 1 / 3),
    "projective_plane": (datasets.projective_plane, lambda p: p[:, 4] ** 2, 1 / 5),
}


def mean_along(position, speed, turns=1.0):
    t = np.linspace(0, 2 * np.pi * turns, 100_001)
    return np.average(position(t), weights=speed(t))


# The same for curves, by integrals over arc length.
MEANS |= {
    "ellipse": (
        datasets.ellipse,
        lambda p: p[:, 0] ** 2,
        mean_along(
            lambda t: 4 * np.cos(t) ** 2,
            lambda t: np.hypot(2 * np.sin(t), np.cos(t)),
        ),
    ),
    "planar_curve": (
        datasets.planar_curve,
        lambda p: NORM(p, axis=1),
        mean_along(
            lambda t: 1 + np.cos(5 * t) / 4,
            lambda t: np.hypot(1 + np.cos(5 * t) / 4, 5 * np.sin(5 * t) / 4),
        ),
    ),
    "spiral": (
        datasets.spiral,
        lambda p: NORM(p, axis=1),
        mean_along(
            lambda t: 0.5 + t / (2 * np.pi),
            lambda t: np.hypot(0.5 + t / (2 * np.pi), 1 / (2 * np.pi)),
            turns=2.5,
        ),
    ),
    "trefoil": (
        datasets.trefoil,
        lambda p: p[:, 2] ** 2,
        mean_along(
            lambda t: np.sin(3 * t) ** 2,
            lambda t: np.sqrt(17 + 8 * np.cos(3 * t) + 9 * np.cos(3 * t) ** 2),
        ),
    ),
}


@pytest.mark.parametrize("name", MEANS)
def test_samples_are_uniform(name):
    generate, function, expected = MEANS[name]
    values = function(generate(40_000, random_state=1)).astype(float)
    error = 5 * values.std() / np.sqrt(len(values))  # five standard deviations
    assert values.mean() == pytest.approx(expected, abs=error)


@pytest.mark.parametrize("name", ["klein_bottle", "moebius_band", "fruit_bowl"])
def test_surfaces_are_uniform_in_area(name):
    from scipy.spatial import cKDTree

    points = SHAPES[name].generate(40_000, random_state=4)
    # The square of the distance to the 20th neighbor is inverse to the density.
    squared = cKDTree(points).query(points, k=21)[0][:, -1] ** 2
    # It must not depend on the distance from the axis.
    radius = NORM(points[:, :2], axis=1)
    half = radius > np.median(radius)
    assert squared[half].mean() == pytest.approx(squared[~half].mean(), rel=0.05)


def nearest_distances(points):
    from scipy.spatial import cKDTree

    return cKDTree(points).query(points, k=2)[0][:, 1]


def test_double_torus_is_uniform_in_area():
    from scipy.spatial import cKDTree

    points = datasets.double_torus(40_000, random_state=4)
    # The 10th neighbor: near enough for the surface to be flat.
    squared = cKDTree(points).query(points, k=11)[0][:, -1] ** 2
    x, y, z = np.abs(points.T)
    for half in (x > 0.8, y > 0.3, z > 0.15, points[:, 0] > 0, points[:, 2] > 0):
        assert 0.2 < half.mean() < 0.8
        assert squared[half].mean() == pytest.approx(squared[~half].mean(), rel=0.05)


@pytest.mark.parametrize("thickness", [0.05, 0.2, 0.249])
def test_double_torus_has_genus_2(thickness):
    # The body is an interval in z over its shadow on the plane, with as many holes.
    w = np.linspace(-1.2, 1.2, 481)
    y = np.linspace(-0.8, 0.8, 321)
    level = (w**2 * (1 - w**2))[:, None] - y**2
    shadow = np.abs(level) < thickness
    # 1 minus the number of holes is its Euler characteristic: corners, sides, squares.
    corners = np.pad(shadow, 1)
    vertices = corners[1:, 1:] | corners[:-1, 1:] | corners[1:, :-1] | corners[:-1, :-1]
    sides = corners[1:] | corners[:-1], corners[:, 1:] | corners[:, :-1]
    assert vertices.sum() - sum(s.sum() for s in sides) + shadow.sum() == -1


@pytest.mark.parametrize("name", ["uneven_torus", "uneven_double_torus"])
def test_spacing_varies_ten_to_one(name):
    points = SHAPES[name].generate(40_000, random_state=2)
    if name == "uneven_torus":
        turned = -points[:, 0] / NORM(points[:, :2], axis=1)  # -cos u
        spacing = 10 ** ((1 + turned) / 2)
    else:
        spacing = 1 + 9 * (1 + points[:, 0] / np.abs(points[:, 0]).max()) / 2
    order = np.argsort(spacing)
    assert spacing.max() / spacing.min() > 9
    ratio = (nearest_distances(points) / spacing)[order]
    means = [part.mean() for part in np.array_split(ratio, 20)]
    assert means == pytest.approx([np.mean(means)] * 20, rel=0.06)


def test_concentric_spheres_are_few_spacings_apart():
    for spacings in (1.5, 3):
        points = datasets.concentric_spheres(
            20_000, spacings=spacings, radius=2, random_state=1
        )
        radii = NORM(points, axis=1)
        inner, outer = radii.min(), radii.max()
        assert outer == pytest.approx(2)
        spacing = np.sqrt(4 * np.pi * (inner**2 + outer**2) / 20_000)
        assert outer - inner == pytest.approx(spacings * spacing, rel=1e-12)
        nearest = [
            nearest_distances(points[side]) for side in (radii < 1.99, radii > 1.99)
        ]
        assert [n.mean() for n in nearest] == pytest.approx([spacing / 2] * 2, rel=0.05)
    with pytest.raises(ValueError, match=r"above 4 pi spacings\^2 = 113, got 113"):
        datasets.concentric_spheres(113)
    assert datasets.concentric_spheres(114).shape == (114, 3)


def test_grid_cylinder_has_squares():
    points = datasets.grid_cylinder(480, num_around=24, radius=2).reshape(20, 24, 3)
    up = NORM(points[1:] - points[:-1], axis=2)
    np.testing.assert_allclose(up, 2 * np.pi * 2 / 24, rtol=1e-12)
    assert NORM(points[0, 0] - points[0, 1]) == pytest.approx(
        2 * 2 * np.sin(np.pi / 24)
    )
    shaken = datasets.grid_cylinder(480, jitter=1e-3, random_state=0)
    distance = NORM(shaken - datasets.grid_cylinder(480), axis=1)
    assert 0 < distance.max() < 1e-2
    with pytest.raises(ValueError, match="a multiple of num_around = 48, got 50"):
        datasets.grid_cylinder(50)


# -------------------------------------------------------------------- options


def test_options_that_set_shape_and_size():
    assert datasets.sphere(4, dim=5).shape == (4, 6)
    assert datasets.ball(4, dim=2).shape == (4, 2)
    assert datasets.closed_curve(4, ambient_dim=82).shape == (4, 82)
    assert datasets.closed_curve(4, ambient_dim=3).shape == (4, 3)
    assert datasets.annulus(4, ambient_dim=5).shape == (4, 5)
    assert datasets.bent_ball(4, dim=4).shape == (4, 5)
    assert datasets.flat_torus(4, dim=3, radii=[1, 2, 3]).shape == (4, 6)
    radii = NORM(datasets.flat_torus(9, dim=2, radii=[1, 2]).reshape(-1, 2, 2), axis=2)
    np.testing.assert_allclose(radii, [[1, 2]] * 9)
    assert NORM(datasets.circle(3, radius=5), axis=1) == pytest.approx([5, 5, 5])


def test_flat_torus_in_higher_dimension():
    points = datasets.flat_torus(50, dim=2, random_state=1)
    embedded = datasets.flat_torus(50, dim=2, ambient_dim=40, random_state=1)
    assert embedded.shape == (50, 40)
    np.testing.assert_allclose(embedded @ embedded.T, points @ points.T, atol=1e-12)


def test_embed_keeps_distances():
    points = datasets.torus(50, random_state=1)
    np.testing.assert_allclose(
        (datasets.embed(points, 7, 2) @ datasets.embed(points, 7, 2).T),
        points @ points.T,
        atol=1e-12,
    )
    with pytest.raises(ValueError, match="ambient_dim must be at least 3, got 2"):
        datasets.embed(points, 2)


def test_grid_torus_has_cyclic_quadrilaterals():
    points = datasets.grid_torus(48 * 20).reshape(48, 20, 3)
    corners = points[3, 4], points[4, 4], points[4, 5], points[3, 5]
    following = corners[1:] + corners[:1]
    a, b, c, d = (NORM(p - q) for p, q in zip(corners, following, strict=True))
    diagonals = NORM(corners[0] - corners[2]) * NORM(corners[1] - corners[3])
    assert a * c + b * d == pytest.approx(diagonals, rel=1e-12)  # Ptolemy
    shaken = datasets.grid_torus(48 * 20, jitter=1e-3, random_state=0)
    distance = NORM(shaken - points.reshape(-1, 3), axis=1)
    assert 0 < distance.max() < 1e-2
    with pytest.raises(ValueError, match="a multiple of num_around = 48, got 50"):
        datasets.grid_torus(50)


def test_staggered_rows():
    points = datasets.grid_torus(480, num_around=40, staggered=True).reshape(40, 12, 3)
    angle = np.arctan2(points[..., 1], points[..., 0])
    np.testing.assert_allclose(angle[3, ::2], 2 * np.pi * 3 / 40, rtol=1e-12)
    np.testing.assert_allclose(angle[3, 1::2], 2 * np.pi * 3.5 / 40, rtol=1e-12)


@pytest.mark.parametrize(
    ("number", "count"),
    [(3, 120), (4, 320), (5, 320), (6, 120), (7, 3338), (8, 2160), (9, 960)],
)
def test_samples_of_the_figures(number, count):
    shape = SHAPES[FIGURES[number]]
    points = datasets.figure_samples(number)
    assert points.shape == (count, shape.ambient_dim)
    np.testing.assert_allclose(EQUATIONS[FIGURES[number]](points), 0.0, atol=1e-7)
    np.testing.assert_array_equal(datasets.figure_samples(number), points)
    nearest = np.sort(NORM(points[:, None] - points[:500], axis=2), axis=0)[1]
    assert nearest.min() > 0.25 * nearest.max()  # evenly


def test_figures_that_do_not_exist():
    with pytest.raises(ValueError, match="one of the figures 3 to 9, got 2"):
        datasets.figure_samples(2)


def test_noise():
    points = np.zeros((20_000, 3))
    noisy = datasets.add_noise(points, 0.1, random_state=1)
    assert noisy.std(axis=0) == pytest.approx([0.1] * 3, rel=0.05)
    assert not points.any()


def test_spread_is_even():
    points = datasets.torus(3000, random_state=1)
    chosen = datasets.spread(points, 300, random_state=1)
    assert chosen.shape == (300, 3)
    assert {tuple(p) for p in chosen} <= {tuple(p) for p in points}

    def nearest(sample):
        distances = NORM(sample[:, None] - sample, axis=2)
        return np.sort(distances, axis=1)[:, 1]

    assert nearest(chosen).min() > 10 * nearest(points[:300]).min()
    with pytest.raises(ValueError, match="cannot choose 11 of 10 points"):
        datasets.spread(points[:10], 11)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("count", [0, -1])
def test_counts_must_be_positive(name, count):
    with pytest.raises(
        ValueError, match=f"num_samples must be at least 1, got {count}"
    ):
        SHAPES[name].generate(count)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: datasets.circle(3, radius=0), "radius must be positive"),
        (lambda: datasets.ellipse(3, semi_axes=(1, -1)), "semi_axes must be positive"),
        (lambda: datasets.planar_curve(3, depth=1), "depth must be"),
        (lambda: datasets.sphere(3, dim=0), "dim must be at least 1"),
        (lambda: datasets.torus(3, minor_radius=1), "0 < minor_radius < major_radius"),
        (lambda: datasets.torus(3, minor_radius=0), "0 < minor_radius < major_radius"),
        (lambda: datasets.interlocking_tori(3, minor_radius=0.5), "below half"),
        (lambda: datasets.flat_torus(3, dim=2, radii=[1, 2, 3]), "2 of them"),
        (lambda: datasets.flat_torus(3, radii=-1), "positive"),
        (lambda: datasets.annulus(3, inner_radius=2), "inner_radius < outer_radius"),
        (lambda: datasets.spherical_cap(3, angle=4), "angle must be between 0 and pi"),
        (lambda: datasets.spiral(3, turns=0), "turns must be positive"),
        (lambda: datasets.torus(3, spacing_ratio=0.5), "spacing_ratio must be at"),
        (lambda: datasets.double_torus(3, spacing_ratio=np.nan), "spacing_ratio must"),
        (lambda: datasets.double_torus(3, thickness=0.25), "thickness must be between"),
        (lambda: datasets.double_torus(3, length=0), "length must be positive"),
        (lambda: datasets.bent_ball(3, radius=4), "0 < radius < pi bend_radius"),
        (lambda: datasets.bent_ball(3, bend_radius=0), "bend_radius must be positive"),
        (lambda: datasets.annulus(3, ambient_dim=1), "ambient_dim must be at least 2"),
        (lambda: datasets.concentric_spheres(300, spacings=0), "spacings must be"),
        (lambda: datasets.sphere_times_sphere(3, radii=(1, 0)), "radii must be"),
    ],
)
def test_bad_options(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_counts_must_be_integers():
    with pytest.raises(TypeError, match=r"num_samples must be an integer, got 2\.5"):
        datasets.circle(2.5)
    assert datasets.circle(np.int64(2)).shape == (2, 2)


EXTREMES = (
    *(1e-300, 5e-324, 1e-150, 1e-9, 1 - 1e-12, 1e9, 1e150, 1e300, 1e308),
    *(np.inf, -np.inf, np.nan, 0.0, -1.0),
)
NUMBERS = [
    (name, parameter.name)
    for name in datasets.__all__
    if inspect.isfunction(getattr(datasets, name))
    for parameter in inspect.signature(getattr(datasets, name)).parameters.values()
    if isinstance(parameter.default, float)
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "parameter"), NUMBERS)
def test_whatever_is_asked_for_ends(name, parameter):
    """With samples that are numbers, or an error that says what is wrong."""
    generate = getattr(datasets, name)
    more = {"num_around": 12} if name.startswith("grid") else {}
    for value in EXTREMES:
        start = time.process_time()
        try:
            points = generate(240, random_state=0, **more, **{parameter: value})
        except ValueError as error:
            said = str(error)
            # Of a share of no samples the number is what is wrong.
            known = (parameter, "too extreme", "num_samples must be at least 1")
            assert any(word in said for word in known), (value, said)
        else:
            assert np.isfinite(points).all(), value
        assert time.process_time() - start < 10, value


def test_shapes_that_no_sample_hits():
    for extreme in ({"thickness": 1e-30}, {"spacing_ratio": 1e9}):
        with pytest.raises(ValueError, match="its parameters are too extreme"):
            datasets.double_torus(100, random_state=0, **extreme)
    # Rare ones are drawn.
    assert len(datasets.double_torus(50, spacing_ratio=40.0, random_state=0)) == 50
