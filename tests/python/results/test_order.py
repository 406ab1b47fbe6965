# SPDX-License-Identifier: GPL-3.0-or-later
"""What is not of the samples' geometry decides nothing: order, empty axes, search."""

from __future__ import annotations

import numpy as np
import pytest

import remanifold as rm
from remanifold import datasets

pytestmark = pytest.mark.filterwarnings("ignore::remanifold.RemanifoldWarning")


def lattice(side, dim):
    axes = np.meshgrid(*[np.arange(side, dtype=float)] * dim, indexing="ij")
    return np.stack(axes, axis=-1).reshape(-1, dim)


def lattice_sphere():
    points = lattice(16, 3)
    return points[abs(np.linalg.norm(points - 7.5, axis=1) - 6) < 0.5]


def regular_polygon(count):
    angles = 2 * np.pi * np.arange(count) / count
    return np.column_stack([np.cos(angles), np.sin(angles)])


def terrain():
    places = lattice(30, 2)
    return np.column_stack([places, np.sin(places[:, 0] / 4)])


def noisy(name, count, noise):
    points = datasets.SHAPES[name].generate(count, random_state=0)
    return datasets.add_noise(points, noise, random_state=1)


def among_clutter():
    clutter = np.random.default_rng(0).uniform(-1.5, 1.5, (60, 3))
    return np.vstack([datasets.torus(1500, random_state=0), clutter])


def shell_of_voxels():
    cube = lattice(20, 3) / 20 - 0.5
    far = np.linalg.norm(cube, axis=1)
    return cube[abs(far - 0.4) < 0.03]


def quantized_cube():
    cube = np.random.default_rng(3).random((500, 3))
    return np.column_stack([np.round(cube[:, :2] * 10) / 10, cube[:, 2]])


SAMPLES = {
    "square lattice": (lattice(15, 2), 2),
    "square lattice, rounded": (lattice(15, 2) / 7, 2),
    "cubic lattice": (lattice(8, 3), 3),
    "lattice on a torus": (datasets.grid_torus(960), 2),
    "voxels of a sphere": (lattice_sphere(), 2),
    "shell of voxels": (shell_of_voxels(), 2),
    "quantized cube": (quantized_cube(), 3),
    "terrain": (terrain(), 2),
    "straight row": (lattice(50, 2)[:50], 1),
    "regular polygon": (regular_polygon(60), 1),
    "torus": (datasets.torus(1000, random_state=0), 2),
    "noisy torus": (noisy("torus", 2000, 0.03), 2),
    "noisy trefoil": (noisy("trefoil", 300, 0.03), 1),
    "cap": (datasets.spherical_cap(400, random_state=1), 2),
    "three-torus": (datasets.flat_torus(600, dim=3, random_state=0), 3),
    "clutter": (among_clutter(), 2),
}


def canonical(simplices):
    rows = np.sort(simplices, axis=1)
    return rows[np.lexsort(rows.T[::-1])]


@pytest.mark.parametrize("name", SAMPLES)
def test_the_order_of_the_samples_decides_nothing(name):
    points, dim = SAMPLES[name]
    order = np.random.default_rng(3).permutation(len(points))
    as_given = rm.reconstruct(points, dim).simplices
    shuffled = rm.reconstruct(points[order], dim).simplices
    assert len(as_given) > 0
    np.testing.assert_array_equal(canonical(as_given), canonical(order[shuffled]))


def on_a_grid(name):
    """Coordinates to which small whole numbers can be added without rounding."""
    points, dim = SAMPLES[name]
    return np.round(points * 2.0**20) / 2.0**20, dim


@pytest.mark.parametrize("name", ["square lattice, rounded", "regular polygon", "cap"])
@pytest.mark.parametrize("kind", ["gram", "distances"])
def test_the_order_of_products_decides_nothing(name, kind):
    points, dim = SAMPLES[name]
    matrix = np.einsum("ik,jk->ij", points, points) if kind == "gram" else None
    if matrix is None:
        matrix = np.linalg.norm(points[:, None] - points, axis=2)
    order = np.random.default_rng(3).permutation(len(points))
    as_given = rm.reconstruct(**{kind: matrix}, dim=dim).simplices
    shuffled = rm.reconstruct(**{kind: matrix[np.ix_(order, order)]}, dim=dim).simplices
    np.testing.assert_array_equal(canonical(as_given), canonical(order[shuffled]))


PLACED = ["square lattice, rounded", "lattice on a torus", "noisy trefoil", "cap"]


@pytest.mark.parametrize("name", [*PLACED, "cubic lattice", "shell of voxels"])
def test_where_the_samples_lie_decides_nothing(name):
    points, dim = on_a_grid(name)
    expected = rm.reconstruct(points, dim).simplices
    moved = rm.reconstruct(points + 4.0, dim).simplices
    np.testing.assert_array_equal(canonical(moved), canonical(expected))
    scaled = rm.reconstruct(points * 2.0**-7, dim).simplices
    np.testing.assert_array_equal(scaled, expected)


@pytest.mark.parametrize("name", PLACED)
@pytest.mark.parametrize("more", [1, 9])
def test_axes_without_extent_decide_nothing(name, more):
    """Noise was shared out among them as well, and candidates were others."""
    points, dim = on_a_grid(name)
    expected = rm.reconstruct(points, dim).simplices
    padded = rm.reconstruct(np.pad(points, [(0, 0), (0, more)]), dim).simplices
    np.testing.assert_array_equal(canonical(padded), canonical(expected))


@pytest.mark.parametrize("name", SAMPLES)
def test_the_exact_search_decides_nothing(name):
    points, dim = SAMPLES[name]
    tree, brute = (
        rm.reconstruct(points, dim, search=search).simplices
        for search in ("kdtree", "brute_force")
    )
    np.testing.assert_array_equal(tree, brute)


def test_ends_of_noisy_curves_are_joined_alike():
    for seed in range(10):
        generator = np.random.default_rng(seed)
        angles = 2 * np.pi * generator.random(80)
        circle = np.column_stack([np.cos(angles), np.sin(angles)])
        points = circle + 0.02 * generator.normal(size=(80, 2))
        tree, brute = (
            rm.reconstruct(points, 1, search=search).simplices
            for search in ("kdtree", "brute_force")
        )
        np.testing.assert_array_equal(tree, brute)
