# SPDX-License-Identifier: GPL-3.0-or-later
"""Elements, local fits, rotations and systems of the core, beside NumPy and SciPy."""

import math

import numpy as np
import pytest

import remanifold as rm
from remanifold import _core
from remanifold.calculus.solving import factorized


@pytest.mark.parametrize("dim", [1, 2, 3, 4, 6])
def test_elements_are_those_of_numpy(dim):
    random = np.random.default_rng(dim)
    points = random.normal(size=(40, dim + 2)) * 1e3
    rows = np.array([random.permutation(40)[: dim + 1] for _ in range(60)])
    rows = rows.astype(np.int32)
    volumes, frames, products, flat = _core.linear_elements(points, rows)
    edges = points[rows[:, 1:]] - points[rows[:, :1]]
    grams = edges @ edges.transpose(0, 2, 1)
    assert not flat.any()
    expected = np.sqrt(np.linalg.det(grams)) / math.factorial(dim)
    np.testing.assert_allclose(volumes, expected, rtol=1e-9)
    np.testing.assert_allclose(frames @ frames.transpose(0, 2, 1), grams, rtol=1e-9)
    assert (np.triu(frames, 1) == 0).all()
    inverse = np.linalg.inv(grams)
    np.testing.assert_allclose(products[:, 1:, 1:], inverse, rtol=1e-6)
    size = np.abs(products).max(axis=(1, 2))[:, None]
    assert (np.abs(products.sum(axis=2)) < 1e-9 * size).all()
    first, second = np.triu_indices(dim + 1, 1)
    squares = ((points[rows[:, first]] - points[rows[:, second]]) ** 2).sum(axis=2)
    by_lengths = _core.linear_elements_of_lengths(dim, np.ascontiguousarray(squares))
    for one, other in zip((volumes, frames, products), by_lengths, strict=False):
        np.testing.assert_allclose(other, one, rtol=1e-9, atol=1e-12 * size.max())


def test_flat_elements_have_no_gradients():
    """Collinear, coinciding, and just flat and just not."""
    points = np.array([[0, 0], [1, 0], [3, 0], [0, 0], [1, 5e-6], [1, 1e-6]])
    rows = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 4], [0, 2, 5]], dtype=np.int32)
    volumes, _, products, flat = _core.linear_elements(points, rows)
    assert flat.tolist() == [True, True, False, True]
    np.testing.assert_allclose(volumes, [0, 0, 7.5e-6, 0], rtol=1e-5)
    assert (products[flat] == 0).all()
    # Lengths of no triangle.
    flat = _core.linear_elements_of_lengths(2, np.array([[1.0, 1.0, 9.0]]))[3]
    assert flat.tolist() == [True]
    with pytest.raises(ValueError, match="vertex 6 of 6 points"):
        _core.linear_elements(points, np.array([[0, 1, 6]], dtype=np.int32))
    with pytest.raises(ValueError, match="4 squared lengths"):
        _core.linear_elements_of_lengths(2, np.ones((1, 4)))


@pytest.mark.parametrize("dim", [1, 2])
def test_second_forms_of_spheres_are_exact(dim):
    """In a space turned and with coordinates to spare, whatever the radius."""
    random = np.random.default_rng(0)
    ball = rm.datasets.sphere(1000, dim=dim, random_state=0)
    rec = rm.reconstruct(ball, dim)
    turn = np.linalg.qr(random.normal(size=(dim + 30, dim + 30)))[0]
    points = np.ascontiguousarray(3 * np.pad(ball, ((0, 0), (0, 29))) @ turn)
    own = np.arange(1000, dtype=np.int32)
    edges = np.ascontiguousarray(rec.edges)
    tangents, forms = _core.second_forms(points, edges, dim, own, 0)
    unit = tangents @ tangents.transpose(0, 2, 1)
    np.testing.assert_allclose(
        unit, np.broadcast_to(np.eye(dim), unit.shape), atol=1e-9
    )
    # Up to what is left after three turns of the tangent spaces.
    assert np.median(np.abs(np.einsum("nkd,nd->nk", tangents, points))) < 1e-6
    inward = -points / 9
    expected = np.eye(dim)[None, :, :, None] * inward[:, None, None, :]
    assert np.median(np.abs(forms - expected)) < 1e-6
    one = _core.second_forms(points, edges, dim, own[7:8], 1)
    np.testing.assert_array_equal(one[1][0], forms[7])


def test_second_forms_need_enough_others():
    """Four triangles, and vertices that all lie on one line."""
    points = np.random.default_rng(0).normal(size=(5, 3))
    edges = np.array([[0, 1], [0, 2], [0, 3], [0, 4]], dtype=np.int32)
    own = np.arange(5, dtype=np.int32)
    assert np.isnan(_core.second_forms(points, edges, 2, own, 1)[0]).all()
    line = np.arange(90.0).reshape(30, 3)
    i, j = np.triu_indices(30, 1)
    pairs = np.stack([i, j], axis=1).astype(np.int32)
    tangents, _ = _core.second_forms(line, pairs, 2, np.arange(30, dtype=np.int32), 1)
    assert np.isnan(tangents).all()


@pytest.mark.parametrize("dim", [1, 2, 3, 5])
def test_rotations_are_the_nearest(dim):
    maps = np.random.default_rng(dim).normal(size=(200, dim, dim))
    maps[0] = 0
    found = _core.nearest_rotations(maps)
    np.testing.assert_allclose(np.linalg.det(found), 1)
    np.testing.assert_allclose(
        found @ found.transpose(0, 2, 1),
        np.broadcast_to(np.eye(dim), found.shape),
        atol=1e-12,
    )
    # Those of the singular vectors, the last turned where space is turned over.
    left, _, right = np.linalg.svd(maps)
    left[np.linalg.det(left @ right) < 0, :, -1] *= -1
    np.testing.assert_allclose(found[1:], (left @ right)[1:], atol=1e-9)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_systems_are_solved_by_either_library(dim):
    rec = rm.reconstruct(rm.datasets.sphere(300, dim=dim, random_state=0), dim)
    matrix = rec.calculus.stiffness()[1:, 1:]
    right = np.random.default_rng(0).normal(size=(299, 3))
    found = factorized(matrix)(right)
    np.testing.assert_allclose(matrix @ found, right, atol=1e-9)
    np.testing.assert_allclose(factorized(matrix)(right[:, 0]), found[:, 0])


def test_singular_systems_are_refused():
    indices = np.array([0, 1, 0, 1], dtype=np.int32)
    with pytest.raises(ValueError, match="singular"):
        _core.SparseFactors(np.array([0, 2, 4], dtype=np.int32), indices, np.ones(4))
