# SPDX-License-Identifier: GPL-3.0-or-later
"""Curvatures beside those of the manifolds that the samples are of."""

import numpy as np
import pytest

import remanifold as rm
from calculus_meshes import cube, known_by, torus_grid


# Scalar curvature, and the errors as measured (largest of all vertices), with a margin.
@pytest.mark.parametrize(
    ("draw", "dim", "scalar", "mean", "error"),
    [
        (lambda: rm.datasets.circle(200, random_state=0), 1, 0, 1, 1e-9),
        (lambda: 2 * rm.datasets.sphere(500, random_state=0), 2, 0.5, 0.5, 1e-6),
        (
            lambda: rm.datasets.flat_torus(1500, random_state=0),
            2,
            0,
            np.sqrt(0.5),
            0.1,
        ),
        (lambda: rm.datasets.sphere(1000, dim=3, random_state=0), 3, 6, 1, 1e-4),
        (
            lambda: rm.datasets.rotations(1500, random_state=0),
            3,
            0.75,
            1 / 3**0.5,
            1e-3,
        ),
        (
            lambda: rm.datasets.sphere_times_circle(2000, random_state=0),
            3,
            2,
            np.sqrt(5) / 3,
            0.6,
        ),
    ],
)
@pytest.mark.slow
def test_scalar_and_mean_curvature(draw, dim, scalar, mean, error):
    rec = rm.reconstruct(draw(), dim)
    found = rec.calculus.curvature()
    assert len(found.missing) == 0
    assert np.abs(found.scalar - scalar).max() < error
    sizes = np.linalg.norm(found.mean_curvature_vectors, axis=1)
    assert np.abs(sizes - mean).max() < error
    np.testing.assert_allclose(np.einsum("nii->n", found.ricci), found.scalar)
    if dim > 1:
        planes = [(i, j) for i in range(dim) for j in range(i)]
        total = 2 * sum(found.sectional(i, j) for i, j in planes)
        np.testing.assert_allclose(total, found.scalar, atol=1e-12)
    products = found.tangents @ found.tangents.transpose(0, 2, 1)
    np.testing.assert_allclose(
        products, np.broadcast_to(np.eye(dim), products.shape), atol=1e-9
    )
    # The second fundamental form has values in the normal space.
    inside = np.einsum("nijd,nkd->nijk", found.second_form, found.tangents)
    assert np.abs(inside).max() < 0.05


def test_principal_curvatures_of_a_torus():
    """1 / 0.4 across, and cos v / (1 + 0.4 cos v) along; outward normals."""
    points = rm.datasets.torus(3000, random_state=0)
    rec = rm.reconstruct(points, 2)
    found = rec.calculus.curvature()
    around = np.hypot(points[:, 0], points[:, 1])
    cosine = (around - 1) / 0.4
    expected = np.stack([np.full(3000, -2.5), -cosine / around], axis=1)
    errors = np.abs(found.principal_curvatures - expected)
    assert errors.mean() < 0.012
    assert np.abs(found.scalar / 2 - expected.prod(axis=1)).mean() < 0.035
    # Across is in the plane of the axis.
    away = np.stack([-points[:, 1], points[:, 0], 0 * around], axis=1) / around[:, None]
    across = np.einsum("nd,nd->n", found.principal_directions[:, 0], away)
    assert np.abs(across).mean() < 0.02
    inward = rm.SimplicialComplex(rec.vertices, rec.simplices[:, ::-1])
    np.testing.assert_allclose(
        inward.calculus.curvature().principal_curvatures,
        -found.principal_curvatures[:, ::-1],
    )


@pytest.mark.slow
def test_errors_fall_with_the_square_of_the_spacing():
    """Four times the samples: about a quarter, on an ellipsoid, where nothing is exact."""
    errors = []
    for count in (1000, 4000):
        points = rm.datasets.sphere(count, random_state=0) * [1, 1.3, 1.6]
        rec = rm.reconstruct(points, 2)
        a, b, c = 1, 1.3**2, 1.6**2
        x, y, z = points.T
        support = x**2 / a**2 + y**2 / b**2 + z**2 / c**2
        gauss = 1 / (a * b * c * support**2)
        errors.append(np.abs(rec.calculus.curvature().scalar / 2 - gauss).mean())
    assert errors[1] < 0.4 * errors[0]
    assert errors[1] < 0.01


def test_products_have_the_same_curvature():
    grid, _ = torus_grid(12)
    known = known_by("distances", grid).calculus.curvature()
    np.testing.assert_allclose(
        known.scalar, grid.calculus.curvature().scalar, atol=1e-5
    )


@pytest.mark.parametrize(
    ("draw", "euler"),
    [
        (lambda: rm.datasets.sphere(500, random_state=0), 2),
        (lambda: rm.datasets.double_torus(2500, random_state=0), -2),
        (lambda: rm.datasets.klein_bottle(1500, random_state=0), 0),
        (lambda: rm.datasets.projective_plane(1000, random_state=0), 1),
        (lambda: rm.datasets.moebius_band(800, random_state=0), 0),
        (lambda: rm.datasets.spherical_cap(800, random_state=0), 1),
    ],
)
def test_gauss_and_bonnet(draw, euler):
    rec = rm.reconstruct(draw(), 2)
    found = rec.calculus.angle_defects()
    assert found.expected == 2 * np.pi * euler
    assert found.total == pytest.approx(found.expected, abs=1e-9)
    assert len(found.singular) == 0
    rim = rec.calculus.boundary_vertices
    np.testing.assert_array_equal(
        np.flatnonzero(np.isnan(found.gaussian_curvature)), rim
    )
    inside = np.setdiff1d(np.arange(len(rec.vertices)), rim)
    np.testing.assert_allclose(
        (found.gaussian_curvature * rec.calculus.vertex_volumes)[inside],
        found.defects[inside],
    )


def test_defects_of_a_cube_and_of_lengths():
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    solid = rm.SimplicialComplex(corners, cube(1, 3).simplices)
    surface = solid.boundary_complex()
    found = surface.calculus.angle_defects()
    np.testing.assert_allclose(found.defects, np.pi / 2)
    again = known_by("gram", surface).calculus.angle_defects()
    np.testing.assert_allclose(again.defects, np.pi / 2)


def test_places_that_are_no_surface():
    pages = rm.SimplicialComplex(
        [[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [5, 5, 5]],
        [[0, 1, 2], [0, 1, 3], [0, 1, 4]],
    )
    found = pages.calculus.angle_defects()
    assert found.singular.tolist() == [0, 1]
    assert np.isnan(found.defects).tolist() == [True, True, False, False, False, True]
    bent = pages.calculus.curvature()
    assert bent.missing.tolist() == [0, 1, 2, 3, 4, 5]  # too few for any fit
    assert np.isnan(bent.second_form).all()


def test_wrong_questions():
    calculus = cube(3, 3).calculus
    with pytest.raises(ValueError, match="the dimension is 3"):
        calculus.angle_defects()
    grid, _ = torus_grid(10)
    found = grid.calculus.curvature()
    with pytest.raises(ValueError, match="in 3 coordinates, not 4"):
        _ = found.principal_curvatures
    with pytest.raises(ValueError, match="first and second are 0 and 2"):
        found.sectional(0, 2)
    assert repr(found) == "Curvature(vertices=100, dim=2, ambient_dim=4, missing=0)"
    assert grid.calculus.element_shapes().shape == (200,)
