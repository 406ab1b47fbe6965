# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions by intrinsic Delaunay triangles beside what they are in closed form."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

import remanifold as rm
from calculus_meshes import known_by


def thin_square(count=200, seed=0):
    """A square in five coordinates by the triangles that are best after a shear.

    No sample is so near to the border that the angle opposite to a border edge is obtuse.
    """
    rng = np.random.default_rng(seed)
    steps = np.arange(20) / 20
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    side = np.stack([steps - 0.5, np.full(20, -0.5)], axis=1)
    rim = np.vstack([side @ np.linalg.matrix_power(turn, i) for i in range(4)])
    plane = np.vstack([rim, 0.94 * (rng.random((count, 2)) - 0.5)])
    thin = Delaunay(plane @ [[1.0, 0.0], [3.0, 1.0]]).simplices.astype(np.int32)
    return plane, rm.SimplicialComplex(
        rm.datasets.embed(plane, 5, random_state=0), thin
    )


def thin_disk(count=1500, seed=0):
    """A disk by the triangles that are best after a shear."""
    rng = np.random.default_rng(seed)
    angles = np.arange(120) / 120 * 2 * np.pi
    inner = np.sqrt(rng.random((count, 1))) * 0.98
    turns = rng.random(count) * 2 * np.pi
    rim, inside = (np.stack([np.cos(t), np.sin(t)], axis=1) for t in (angles, turns))
    plane = np.vstack([rim, inner * inside])
    thin = Delaunay(plane @ [[1.0, 0.0], [3.0, 1.0]]).simplices.astype(np.int32)
    return rm.SimplicialComplex(plane, thin)


def off_diagonal(matrix):
    matrix = matrix.tocoo()
    return matrix.data[matrix.row != matrix.col]


@pytest.mark.parametrize("kind", ["points", "gram", "distances"])
def test_a_square_has_the_matrices_of_its_delaunay_triangulation(kind):
    plane, thin = thin_square()
    best = rm.SimplicialComplex(plane, Delaunay(plane).simplices.astype(np.int32))
    thin = thin if kind == "points" else known_by(kind, thin)
    calculus = thin.calculus
    for name in ("stiffness", "mass"):
        found = getattr(calculus, name)(delaunay=True).toarray()
        expected = getattr(best.calculus, name)().toarray()
        np.testing.assert_allclose(found, expected, atol=1e-9)
    assert calculus.intrinsic_delaunay().num_flips > 50
    assert calculus.intrinsic_delaunay().complete


@pytest.mark.parametrize("shear", [0, 4])
def test_no_weight_is_negative_at_a_boundary(shear):
    """Angles opposite to border edges of random samples are obtuse."""
    rng = np.random.default_rng(3)
    plane = rng.random((150, 2))
    thin = Delaunay(plane @ [[1.0, 0.0], [shear, 1.0]]).simplices.astype(np.int32)
    # A page at an edge: three triangles there.
    page = np.append(thin[0, :2], 150)[None].astype(np.int32)
    high = np.append(plane[thin[0, :2]].mean(axis=0), 0.3)
    points = np.vstack([np.pad(plane, [(0, 0), (0, 1)]), high])
    for complex_ in (
        rm.SimplicialComplex(plane, thin),
        rm.SimplicialComplex(points, np.vstack([thin, page])),
    ):
        calculus = complex_.calculus
        assert off_diagonal(calculus.stiffness()).max() > 0.1
        weights = calculus.stiffness(delaunay=True)
        assert off_diagonal(weights).max() < 1e-9
        np.testing.assert_allclose(weights.sum(axis=1), 0, atol=1e-9)
        np.testing.assert_allclose((weights - weights.T).toarray(), 0, atol=1e-12)
        area = complex_.volume()
        assert calculus.mass(lumped=True, delaunay=True).sum() == pytest.approx(area)
        assert len(calculus.intrinsic_delaunay().triangles) == len(complex_.simplices)


@pytest.mark.parametrize("kind", ["points", "distances"])
def test_heat_on_a_disk_whatever_its_triangles(kind):
    """Long edges at the border and thin triangles: 1.3 % of the mean distance."""
    rng = np.random.default_rng(1)
    turns, radii = 2 * np.pi * rng.random(600), np.sqrt(rng.random(600))
    plane = radii[:, None] * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    true = np.linalg.norm(plane[[0, 50], None] - plane, axis=2)
    wide = rm.datasets.embed(plane, 5, random_state=0)
    found = []
    for shear in (1, 8):
        thin = Delaunay(plane * [1, shear]).simplices.astype(np.int32)
        disk = rm.SimplicialComplex(wide, thin)
        disk = disk if kind == "points" else known_by(kind, disk)
        found.append(disk.geodesic_distances([0, 50], "heat"))
        assert np.abs(found[-1] - true).mean() < 0.03 * true.mean()
    np.testing.assert_allclose(found[0], found[1], atol=1e-6)


def test_triangles_on_a_klein_bottle():
    points = rm.datasets.klein_bottle(600, random_state=0)
    rec = rm.reconstruct(points, 2)
    calculus = rec.calculus
    assert off_diagonal(calculus.stiffness()).max() > 0.01
    weights = calculus.stiffness(delaunay=True)
    assert off_diagonal(weights).max() < 1e-9
    np.testing.assert_allclose(weights.sum(axis=1), 0, atol=1e-9)
    lumped = calculus.mass(lumped=True, delaunay=True)
    assert lumped.sum() == pytest.approx(rec.volume())
    found = calculus.intrinsic_delaunay()
    assert len(found.triangles) == len(rec.simplices)
    assert found.num_flips > 0


def test_harmonic_functions_keep_between_what_is_fixed():
    """With negative weights they do not."""
    thin = thin_disk(300)
    rim = thin.calculus.boundary_vertices
    rng = np.random.default_rng(1)
    outside = []
    for delaunay in (False, True):
        worst = 0.0
        for _ in range(20):
            found = thin.calculus.poisson(
                np.zeros(thin.num_vertices),
                rim,
                rng.integers(0, 2, len(rim)),
                delaunay=delaunay,
            ).values
            worst = max(worst, -found.min(), found.max() - 1)
        outside.append(worst)
    assert outside[0] > 1e-3
    assert outside[1] < 1e-12


def test_the_spectrum_of_a_thinly_triangulated_disk():
    """Squares of the zeros of the derivatives of Bessel functions."""
    thin = thin_disk()
    expected = np.square([1.841184, 1.841184, 3.054237, 3.054237, 3.831706])
    plain, best = (
        thin.calculus.spectrum(6, delaunay=delaunay).eigenvalues[1:]
        for delaunay in (False, True)
    )
    far = np.abs(best / expected - 1).max()
    assert far < 0.02
    assert far < np.abs(plain / expected - 1).max() / 2


def test_flat_triangles_are_flipped_away():
    """A vertex on the edge of two triangles, which the other two use only."""
    points = [[0, 0], [2, 0], [1, 1], [1, -1], [1, 0]]
    flat = rm.SimplicialComplex(
        points, np.array([[0, 1, 4], [0, 1, 2], [0, 3, 4], [1, 4, 3]], np.int32)
    )
    assert len(flat.calculus.flat_simplices) == 1
    calculus = flat.calculus
    assert calculus.mass(lumped=True, delaunay=True).sum() == pytest.approx(2)
    np.testing.assert_allclose(
        calculus.stiffness(delaunay=True) @ [0, 2, 1, 1, 1],
        [-1, 1, 0, 0, 0],
        atol=1e-12,
    )


def test_other_dimensions_are_refused():
    path = rm.SimplicialComplex([[0], [1], [3]], [[0, 1], [1, 2]])
    with pytest.raises(ValueError, match="dimension 1: leave it out"):
        path.calculus.stiffness(delaunay=True)
    with pytest.raises(ValueError, match="dimension 1"):
        path.calculus.intrinsic_delaunay()
