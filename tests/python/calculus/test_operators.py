# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators beside what they are for functions and forms in closed form."""

import pickle

import numpy as np
import pytest

import remanifold as rm
from calculus_meshes import cube, known_by, torus_grid

CUBES = [(1, 6), (2, 5), (3, 3), (4, 2), (5, 1)]
THREE_PAGES = rm.SimplicialComplex(
    [[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, 0, 0]],
    [[0, 1, 2], [0, 1, 3], [0, 1, 4]],
)


def rotated(complex_, ambient):
    placed = rm.datasets.embed(complex_.vertices, ambient, random_state=0)
    return rm.SimplicialComplex(placed, complex_.simplices)


@pytest.mark.parametrize(("dim", "per_side"), CUBES)
def test_linear_functions_on_a_cube(dim, per_side):
    """Of integrals, products and gradients of linear functions nothing is lost."""
    flat = cube(per_side, dim, jitter=0.2)
    x = flat.vertices
    solid = rotated(flat, dim + 2)
    calculus = solid.calculus
    np.testing.assert_allclose(calculus.integrate(x), 0.5)
    assert calculus.vertex_volumes.sum() == pytest.approx(1)
    assert calculus.integrate(x[:, 0]) == pytest.approx(0.5)
    product = 1 / 3 if dim == 1 else 1 / 4
    assert x[:, 0] @ calculus.mass() @ x[:, -1] == pytest.approx(product)
    slope = np.arange(1.0, dim + 1)
    assert slope @ x.T @ calculus.stiffness() @ x @ slope == pytest.approx(
        slope @ slope
    )
    steps = calculus.gradient(x @ slope)
    assert steps.shape == (len(solid.simplices), dim + 2)
    np.testing.assert_allclose(np.linalg.norm(steps, axis=1), np.linalg.norm(slope))
    within = calculus.gradient(x @ slope, intrinsic=True)
    np.testing.assert_allclose(np.linalg.norm(within, axis=1), np.linalg.norm(slope))
    # Along the first edge, which is the first axis.
    first = x[solid.simplices[:, 1]] - x[solid.simplices[:, 0]]
    length = np.linalg.norm(first, axis=1)
    np.testing.assert_allclose(within[:, 0], first @ slope / length)
    inside = np.setdiff1d(np.arange(len(x)), calculus.boundary_vertices)
    assert len(inside) == (per_side - 1) ** dim
    laplacian = calculus.laplacian(x)
    np.testing.assert_allclose(laplacian[inside], 0, atol=1e-10)
    by_divergence = calculus.divergence(calculus.gradient(x[:, 0]))
    np.testing.assert_allclose(by_divergence, laplacian[:, 0], atol=1e-10)
    np.testing.assert_allclose(
        calculus.divergence(within, intrinsic=True),
        calculus.laplacian(x @ slope),
        atol=1e-10,
    )


@pytest.mark.parametrize(("dim", "per_side"), CUBES)
def test_constant_forms_on_a_cube(dim, per_side):
    """The squared norm of dx_1 ... dx_k is the volume, by either star."""
    solid = cube(per_side, dim, jitter=0.2)
    for degree in range(dim + 1):
        faces = solid.calculus.faces(degree)
        corners = solid.vertices[faces]
        edges = (corners[:, 1:] - corners[:, :1])[:, :, :degree]
        form = np.linalg.det(edges) / np.prod(np.arange(1, degree + 1))
        for diagonal in (False, True):
            star = solid.calculus.hodge_star(degree, diagonal=diagonal)
            assert form @ star @ form == pytest.approx(1)
            assert star.shape == (len(faces), len(faces))
        values = np.linalg.eigvalsh(solid.calculus.hodge_star(degree).toarray())
        assert values.min() > 0


@pytest.mark.parametrize(("dim", "per_side"), CUBES)
def test_forms_and_functions_have_the_same_operators(dim, per_side):
    calculus = cube(per_side, dim, jitter=0.2).calculus
    step = calculus.exterior_derivative(0)
    stiffness = step.T @ calculus.hodge_star(1) @ step
    np.testing.assert_allclose(
        stiffness.toarray(), calculus.stiffness().toarray(), atol=1e-10
    )
    np.testing.assert_allclose(
        calculus.hodge_star(0).toarray(), calculus.mass().toarray(), atol=1e-14
    )
    lumped = calculus.mass(lumped=True).diagonal()
    np.testing.assert_allclose(lumped, calculus.mass().sum(axis=1))
    random = np.random.default_rng(0)
    for degree in range(1, dim + 1):
        one = random.normal(size=len(calculus.faces(degree)))
        other = random.normal(size=len(calculus.faces(degree - 1)))
        derivative = calculus.exterior_derivative(degree - 1)
        there = (derivative @ other) @ calculus.hodge_star(degree) @ one
        back = calculus.codifferential(degree, one)
        assert other @ calculus.hodge_star(degree - 1) @ back == pytest.approx(there)
        if degree > 1:
            twice = calculus.codifferential(degree - 1, back)
            np.testing.assert_allclose(twice, 0, atol=1e-6 * np.abs(back).max())
    u = random.normal(size=len(lumped))
    np.testing.assert_allclose(
        calculus.mass() @ calculus.hodge_laplacian(0, u),
        calculus.stiffness() @ u,
        atol=1e-10,
    )


def test_harmonic_form_of_a_torus():
    """The angle along a circle of a grid: neither curl nor divergence."""
    torus, angles = torus_grid(12)
    calculus = torus.calculus
    edges = calculus.faces(1)
    for axis in range(2):
        form = angles[edges[:, 1], axis] - angles[edges[:, 0], axis]
        form = (form + np.pi) % (2 * np.pi) - np.pi
        np.testing.assert_allclose(calculus.hodge_laplacian(1, form), 0, atol=1e-10)
        # Cut along a diagonal the cells of the grid are flat: (pi / step)^2 (2 sin)^2.
        length = 2 * np.sin(np.pi / 12)
        expected = (2 * np.pi / 12 / length) ** 2 * 144 * length**2
        assert form @ calculus.hodge_star(1) @ form == pytest.approx(expected)


@pytest.mark.parametrize("kind", ["gram", "distances"])
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_lengths_are_enough(kind, dim):
    solid = cube(3, dim, jitter=0.2)
    known = known_by(kind, solid)
    for name in ("mass", "stiffness"):
        np.testing.assert_allclose(
            getattr(known.calculus, name)().toarray(),
            getattr(solid.calculus, name)().toarray(),
            atol=1e-11,
        )
    u = solid.vertices[:, 0]
    np.testing.assert_allclose(
        known.calculus.gradient(u, intrinsic=True),
        solid.calculus.gradient(u, intrinsic=True),
        atol=1e-11,
    )
    assert known.calculus.gradient(u).shape[1] == known.coordinates.shape[1]
    ends = solid.calculus.boundary_vertices
    found = known.calculus.poisson(0 * u, ends, u[ends]).values
    np.testing.assert_allclose(found, u, atol=1e-10)


def test_cotangents_as_by_others():
    potpourri3d = pytest.importorskip("potpourri3d")
    rec = rm.reconstruct(rm.datasets.torus(400, random_state=0), 2)
    rows = rec.simplices.astype(np.int64)
    stiffness = potpourri3d.cotan_laplacian(rec.vertices, rows)
    np.testing.assert_allclose(
        rec.calculus.stiffness().toarray(), stiffness.toarray(), atol=1e-6
    )
    np.testing.assert_allclose(
        rec.calculus.vertex_volumes, potpourri3d.vertex_areas(rec.vertices, rows)
    )


# Spheres and flat tori: coordinates are eigenfunctions, of K and of 1. Errors as
# measured with these samples, with a margin of a half.
@pytest.mark.parametrize(
    ("name", "dim", "count", "eigenvalue", "error"),
    [
        ("circle", 1, 200, 1, 0.0007),
        ("sphere", 2, 1000, 2, 0.0066),
        ("flat_torus", 2, 1000, 1, 0.012),
        ("sphere", 3, 1000, 3, 0.032),
    ],
)
def test_poisson_on_closed_manifolds(name, dim, count, eigenvalue, error):
    make = getattr(rm.datasets, name)
    options = {} if name == "circle" else {"dim": dim}
    rec = rm.reconstruct(make(count, random_state=0, **options), dim)
    source = rec.vertices[:, 0]
    found = rec.calculus.poisson(source)
    assert rec.calculus.integrate(found.values) == pytest.approx(0, abs=1e-10)
    mean = rec.calculus.integrate(source) / rec.volume()
    assert found.imbalance == pytest.approx([mean])
    expected = -source / eigenvalue
    assert np.abs(found.values - expected).mean() < error * np.abs(expected).max()


def test_poisson_with_both_conditions():
    """u = 1 - x^2 / 2, its slope zero at x = 0 and at the sides, its values fixed at 1."""
    square = cube(16, 2)
    x = square.vertices[:, 0]
    found = square.calculus.poisson(-np.ones(len(x)), x == 1, 0.5)
    np.testing.assert_allclose(found.values, 1 - x**2 / 2, atol=1e-3)
    assert found.imbalance.tolist() == [0]


def test_components_are_solved_by_themselves():
    grid, _ = torus_grid(8)
    one, count = grid.vertices, 64
    apart = rm.SimplicialComplex(
        np.vstack([one, one, [[9, 9, 9, 9]]]),
        np.vstack([grid.simplices, grid.simplices + count]),
    )
    calculus = apart.calculus
    assert calculus.missing_vertices.tolist() == [2 * count]
    source = np.concatenate([one[:, 0] + 3, one[:, 1], [np.nan]])
    found = calculus.poisson(np.stack([source, 2 * source], axis=1), [count], [[5, 7]])
    assert np.isnan(found.values[-1]).all()
    assert np.isfinite(found.values[:-1]).all()
    np.testing.assert_allclose(found.imbalance, [[3, 6], [0, 0]], atol=1e-12)
    alone = grid.calculus.poisson(one[:, 0])
    np.testing.assert_allclose(found.values[:count, 0], alone.values, atol=1e-10)
    assert found.values[count].tolist() == [5, 7]
    laplacian = calculus.laplacian(source)
    assert np.isnan(laplacian).tolist() == [False] * 2 * count + [True]


def test_flat_simplices_are_left_out():
    """One of no area between two triangles, and one whose lengths are impossible."""
    thin = rm.SimplicialComplex(
        [[0, 0], [1, 0], [0, 1], [2, 0], [9, 9]], [[0, 1, 2], [0, 1, 3], [1, 2, 3]]
    )
    assert thin.calculus.flat_simplices.tolist() == [1]
    assert thin.calculus.missing_vertices.tolist() == [4]
    assert np.isfinite(thin.calculus.stiffness().toarray()).all()
    np.testing.assert_allclose(thin.calculus.gradient([0, 1, 0, 2, 0])[1], 0)
    np.testing.assert_allclose(
        thin.calculus.gradient([0, 1, 0, 2, 0])[[0, 2]], [[1, 0]] * 2
    )
    away = np.array([[0, 1, 5], [1, 0, 1], [5, 1, 0.0]])
    impossible = known_by("distances", rm.SimplicialComplex(np.eye(3), [[0, 1, 2]]))
    impossible._products.matrix[...] = away
    assert impossible.calculus.flat_simplices.tolist() == [0]
    assert impossible.calculus.missing_vertices.tolist() == [0, 1, 2]


def test_three_triangles_at_an_edge():
    calculus = THREE_PAGES.calculus
    assert calculus.singular_vertices.tolist() == [0, 1]
    # Fixed at the three tips the function is linear on each page.
    found = calculus.poisson(np.zeros(5), [2, 3, 4], [3, 0, 0]).values
    np.testing.assert_allclose(found[:2], 1)


def test_non_orientable_and_bounded():
    band = rm.reconstruct(rm.datasets.moebius_band(800, random_state=0), 2)
    calculus = band.calculus
    ends = calculus.boundary_vertices
    found = calculus.poisson(np.zeros(800), ends, 1.0).values
    np.testing.assert_allclose(found, 1)
    found = calculus.poisson(-np.ones(800), ends).values
    assert found.min() == 0
    # The band is 0.8 wide: half the square of half of that, up to its bend.
    assert found.max() == pytest.approx(0.08, rel=0.1)


def test_made_once_and_again():
    square = cube(2, 2)
    assert square.calculus is square.calculus
    assert repr(square.calculus) == "Calculus(vertices=9, dim=2)"
    copy = pickle.loads(pickle.dumps(square))
    assert (copy.calculus.stiffness() != square.calculus.stiffness()).nnz == 0
    square.calculus.stiffness().data[:] = 0
    assert square.calculus.stiffness().data.any()


@pytest.mark.parametrize(
    ("call", "error", "says"),
    [
        (lambda c: c.hodge_star(3), ValueError, "degree is 3, expected 0 to 2"),
        (
            lambda c: c.exterior_derivative(2),
            ValueError,
            "degree is 2, expected 0 to 1",
        ),
        (
            lambda c: c.codifferential(0, []),
            ValueError,
            "degree is 0, expected at least",
        ),
        (lambda c: c.codifferential(1, [1]), ValueError, r"form has shape \(1,\), exp"),
        (lambda c: c.faces("1"), TypeError, "degree must be an integer"),
        (lambda c: c.integrate([1]), ValueError, r"values has shape \(1,\), expected"),
        (lambda c: c.gradient(np.eye(9)), ValueError, r"values has shape \(9, 9\)"),
        (lambda c: c.laplacian([np.nan] * 9), ValueError, r"values\[0\] is nan"),
        (
            lambda c: c.integrate(np.ma.masked_less(range(9), 3)),
            ValueError,
            "is masked",
        ),
        (lambda c: c.divergence(np.ones((8, 3))), ValueError, r"expected \(8, 2\)"),
        (lambda c: c.poisson([1] * 9, [9]), ValueError, r"fixed\[0\] is 9, expected"),
        (lambda c: c.poisson([1] * 9, [1], [1, 2]), ValueError, r"values has shape"),
        (lambda c: c.poisson([1] * 9, [1, 1]), ValueError, "for the second time"),
    ],
)
def test_wrong_input(call, error, says):
    with pytest.raises(error, match=says):
        call(cube(2, 2).calculus)


def test_what_has_no_calculus():
    with pytest.raises(ValueError, match="0 simplices of dimension 1"):
        _ = rm.SimplicialComplex([[0, 0]], np.empty((0, 2), int)).calculus
    lonely = rm.SimplicialComplex([[0, 0], [1, 0], [0, 1], [5, 5]], [[0, 1, 2]])
    with pytest.raises(ValueError, match=r"fixed\[0\] is vertex 3, which is in no"):
        lonely.calculus.poisson(np.zeros(4), [3])
