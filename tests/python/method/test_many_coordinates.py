# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples in so many coordinates that products and distances replace reading them."""

import pickle

import numpy as np
import pytest

import remanifold as rm

pytestmark = pytest.mark.slow

MANY = 300  # far above what counts as many


def isometry(ambient_dim, dim, seed=0):
    rng = np.random.default_rng(seed)
    return np.linalg.qr(rng.standard_normal((ambient_dim, dim)))[0].T


def torus(num, seed=0):
    angles = np.random.default_rng(seed).random((num, 2)) * 2 * np.pi
    return np.c_[np.cos(angles), np.sin(angles)]


def unoriented(rec):
    return np.sort(rec.simplices, axis=1)


def projectors(bases):
    return bases.transpose(0, 2, 1) @ bases


@pytest.mark.parametrize("method", ["manifold", "paper"])
@pytest.mark.parametrize("search", ["auto", "kdtree", "brute_force"])
def test_the_same_as_in_few_coordinates(method, search):
    few = torus(700)
    many = few @ isometry(MANY, 4)
    expected = rm.reconstruct(few, 2, method=method)
    found = rm.reconstruct(many, 2, method=method, search=search)
    np.testing.assert_array_equal(unoriented(found), unoriented(expected))
    np.testing.assert_array_equal(found.boundary, expected.boundary)
    turned = expected.tangents @ isometry(MANY, 4)
    inside = ~np.isnan(turned).any(axis=(1, 2))
    np.testing.assert_allclose(
        projectors(found.tangents[inside]), projectors(turned[inside]), atol=1e-9
    )


def test_surface_with_boundary_looks_at_all_samples():
    few = np.random.default_rng(5).random((600, 2))
    many = few @ isometry(MANY, 2)
    for method in ("manifold", "paper"):
        expected = rm.reconstruct(few, 2, method=method, estimator="pca")
        found = rm.reconstruct(
            many, 2, method=method, estimator="pca", search="brute_force"
        )
        np.testing.assert_array_equal(unoriented(found), unoriented(expected))


@pytest.mark.parametrize("method", ["manifold", "paper"])
def test_tangents_are_those_of_the_step(method):
    points = torus(300) @ isometry(MANY, 4)
    points = np.vstack([points, points[3:9]])
    rec = rm.reconstruct(points, 2, method=method, search="brute_force")
    steps = rm.tangent_spaces(
        points,
        2,
        rec.num_neighbors,
        estimator=rec.estimator,
        search="brute_force",
    )
    copy = pickle.loads(pickle.dumps(rec))
    for tangents in (rec.tangents, copy.tangents):
        np.testing.assert_array_equal(tangents, steps.bases)
        assert not tangents.flags.writeable
    assert rec.tangents is rec.tangents
    np.testing.assert_allclose(
        rec.tangents @ rec.tangents.transpose(0, 2, 1),
        np.broadcast_to(np.eye(2), (len(points), 2, 2)),
        atol=1e-13,
    )


@pytest.mark.parametrize("exponent", [-700, 0, 700])
def test_scale_and_constant_coordinates_change_nothing(exponent):
    points = torus(300) @ isometry(MANY, 4)
    expected = rm.reconstruct(points, 2)
    scaled = np.ldexp(points, exponent)
    scaled = np.insert(scaled, 7, 1e300, axis=1)
    found = rm.reconstruct(scaled, 2)
    np.testing.assert_array_equal(found.simplices, expected.simplices)
    np.testing.assert_allclose(
        np.delete(found.tangents, 7, axis=2), expected.tangents, atol=1e-12
    )
    assert (found.tangents[:, :, 7] == 0).all()


@pytest.mark.parametrize("method", ["manifold", "paper"])
def test_ties_of_a_grid(method):
    axes = np.meshgrid(np.arange(14.0), np.arange(11.0), indexing="ij")
    few = np.stack([*axes, 0 * axes[0]], axis=-1).reshape(-1, 3)
    many = np.zeros((len(few), MANY))
    many[:, [11, 107, 291]] = few
    expected = rm.reconstruct(few, 2, method=method)
    found = rm.reconstruct(many, 2, method=method, search="brute_force")
    np.testing.assert_array_equal(unoriented(found), unoriented(expected))


def awkward():
    rng = np.random.default_rng(1)
    sheet = torus(200) @ isometry(MANY, 4)
    noise = rng.standard_normal(sheet.shape)
    yield "one-hot", np.vstack([np.eye(150), 3 * np.eye(150)])
    yield "bits", rng.integers(0, 2, (300, 130)).astype(float)
    yield "near copies", np.vstack([sheet, sheet + 1e-9 * noise, sheet + 3e-12 * noise])
    yield "two clusters", np.vstack([1e-4 * sheet, 1e-4 * sheet[:99] + 1e3])
    yield "outlier", np.vstack([sheet, sheet[:1] + 1e7])
    yield "few", sheet[:5]


@pytest.mark.parametrize(
    ("name", "points"), [pytest.param(*a, id=a[0]) for a in awkward()]
)
@pytest.mark.parametrize("count", [2, 17, 80])
def test_what_products_cannot_tell_apart(name, points, count):
    del name
    by_tree = rm.neighborhoods(points, count, search="kdtree")
    for threads in (1, 3):
        by_products = rm.neighborhoods(
            points, count, search="brute_force", num_threads=threads
        )
        np.testing.assert_array_equal(by_products.indices, by_tree.indices)
        np.testing.assert_array_equal(by_products.distances, by_tree.distances)


def test_results_do_not_depend_on_threads():
    points = torus(900, seed=3) @ isometry(MANY + 3, 4)
    results = [rm.reconstruct(points, 2, num_threads=t) for t in (1, 2, 5)]
    for result in results[1:]:
        np.testing.assert_array_equal(result.simplices, results[0].simplices)
        np.testing.assert_array_equal(result.tangents, results[0].tangents)
