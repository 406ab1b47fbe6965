# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples in special position: coinciding, dependent, tied, tiny, huge, too few."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial import ConvexHull, Delaunay
from scipy.spatial.distance import cdist

import reference as ref
import remanifold as rm


def reconstruct(points, dim, **options):
    return rm.reconstruct(points, dim, method="paper", **options)


def simplex_set(simplices):
    return {tuple(row) for row in simplices.tolist()}


def agreed(stars, dim):
    """Simplices that are in the stars of all their vertices."""
    rows = np.sort(stars.simplices, axis=1)
    simplices, votes = np.unique(rows, axis=0, return_counts=True)
    return simplices[votes == dim + 1]


def volumes(points, simplices):
    edges = points[simplices[:, 1:]] - points[simplices[:, :1]]
    return np.sqrt(np.linalg.det(edges @ edges.transpose(0, 2, 1)))


def most_cofaces(simplices):
    """The largest number of simplices around one of their facets."""
    size = simplices.shape[1]
    faces = np.vstack([np.delete(simplices, column, axis=1) for column in range(size)])
    return np.unique(faces, axis=0, return_counts=True)[1].max()


def embeddings(dim):
    """Isometries of R^dim into other spaces: identity, rotated, in more dimensions."""
    rng = np.random.default_rng(3)
    rotated = np.linalg.qr(rng.normal(size=(dim, dim)))[0]
    larger = np.linalg.qr(rng.normal(size=(dim + 3, dim)))[0].T
    return [np.eye(dim), rotated, larger]


# --- Few, coinciding, dependent -------------------------------------------------


@pytest.mark.parametrize("extra", [1, 2, 20])
@pytest.mark.parametrize("dim", [1, 2, 3])
def test_all_samples_coincide(extra, dim):
    num = dim + extra
    result = reconstruct(np.full((num, 3), 0.1), dim)
    assert result.simplices.shape == (0, dim + 1)
    assert result.edges.shape == (0, 2)
    assert result.boundary.all()
    assert result.representatives.tolist() == [0] * num
    assert (result.tangent_simplices == -1).all()
    assert np.isnan(result.tangents).all()


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_fewer_samples_than_neighbors(dim):
    points = np.random.default_rng(dim).normal(size=(30, 4))
    for num in range(dim + 1, 4 * dim + 4):
        result = reconstruct(points[:num], dim)
        expected = ref.reconstruct(points[:num], dim)
        found = rm.neighborhoods(points[:num], 10 * dim)
        np.testing.assert_array_equal(found.indices, expected.neighborhoods)
        assert result.boundary.tolist() == expected.tangents.boundary.tolist()
        np.testing.assert_array_equal(
            result.tangent_simplices, expected.tangents.simplices
        )
        np.testing.assert_array_equal(result.simplices, expected.simplices)


@pytest.mark.parametrize("dim", [1, 2])
@pytest.mark.parametrize("kind", ["points", "gram", "distances"])
def test_copies_change_nothing_and_are_mapped_back(dim, kind):
    rng = np.random.default_rng(dim)
    points = ref.draw_sample("sphere", 80, dim, 5, rng)
    which = rng.permutation(np.repeat(np.arange(80), rng.integers(1, 4, 80)))
    _, first = np.unique(which, return_index=True)

    def known_by(points):
        if kind == "points":
            return {"points": points}
        matrix = points @ points.T if kind == "gram" else cdist(points, points)
        return {kind: matrix}

    single = rm.reconstruct(**known_by(points), dim=dim, method="paper")
    copied = rm.reconstruct(**known_by(points[which]), dim=dim, method="paper")
    np.testing.assert_array_equal(copied.representatives, first[which])
    np.testing.assert_array_equal(copied.boundary, single.boundary[which])
    np.testing.assert_array_equal(
        copied.tangent_simplices, first[single.tangent_simplices[which]]
    )
    expected = np.sort(first[single.simplices], axis=1)
    assert simplex_set(copied.simplices) == simplex_set(expected)
    near = rm.neighborhoods(num_neighbors=9, **known_by(points))
    near_copied = rm.neighborhoods(num_neighbors=9, **known_by(points[which]))
    np.testing.assert_array_equal(near_copied.indices, first[near.indices[which]])
    np.testing.assert_allclose(near_copied.distances, near.distances[which], rtol=1e-12)


def test_zeros_of_either_sign_coincide():
    points = np.array([[0.0, 1.0], [-0.0, 1.0], [1.0, -0.0], [1.0, 0.0]])
    result = reconstruct(points, 1)
    assert result.representatives.tolist() == [0, 0, 2, 2]


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("spacing", ["even", "random"])
def test_samples_on_a_line_span_no_plane(dim, spacing):
    rng = np.random.default_rng(0)
    position = np.arange(40.0) if spacing == "even" else rng.uniform(size=40)
    for direction in ([1, 0, 0], [1, 2, -2], rng.normal(size=3)):
        result = reconstruct(np.outer(position, direction), dim)
        assert result.boundary.all()
        assert len(result.simplices) == 0


@pytest.mark.parametrize("ambient", [1, 2, 3])
@pytest.mark.parametrize("spacing", ["even", "random"])
def test_samples_on_a_line_make_a_path(ambient, spacing):
    rng = np.random.default_rng(1)
    position = np.arange(40.0) if spacing == "even" else np.sort(rng.uniform(size=40))
    points = np.outer(position, [1, -2, 0.5][:ambient])
    path = list(pairwise(range(40)))
    mutual = reconstruct(points, 1)
    assert np.flatnonzero(mutual.boundary).tolist() == [0, 39]
    assert not mutual.unbounded.any()
    assert simplex_set(mutual.simplices) == set(path[1:-1])
    assert simplex_set(reconstruct(points, 1, edges="either").simplices) == set(path)


# --- Ties -----------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(5, 5), (8, 13), (20, 20)])
@pytest.mark.parametrize("embedding", embeddings(2))
@pytest.mark.parametrize("edges", ["mutual", "either"])
def test_a_square_grid_is_cleanly_triangulated(shape, embedding, edges):
    flat = np.argwhere(np.ones(shape)).astype(float)
    result = reconstruct(flat @ embedding, 2, edges=edges)
    inner = ((flat > 0) & (flat < np.array(shape) - 1)).all(axis=1)
    assert not result.boundary[inner].any()
    simplices = result.simplices[inner[result.simplices].all(axis=1)]
    if edges == "mutual":
        assert most_cofaces(result.simplices) <= 2
    # Half squares, two in each, on the same diagonal.
    np.testing.assert_allclose(volumes(flat, simplices), 1)
    center = flat[simplices].mean(axis=1)
    squares, halves = np.unique(np.floor(center), axis=0, return_counts=True)
    assert len(squares) == (shape[0] - 3) * (shape[1] - 3)
    assert (halves == 2).all()
    assert most_cofaces(simplices) == 2
    length = np.linalg.norm(flat[result.edges[:, 0]] - flat[result.edges[:, 1]], axis=1)
    diagonals = result.edges[inner[result.edges].all(axis=1) & (length > 1.2)]
    assert len(diagonals) == len(squares)
    assert (length < 1.5).all() or edges == "either"


@pytest.mark.parametrize("embedding", embeddings(3))
def test_a_cubic_grid_is_filled(embedding):
    flat = np.argwhere(np.ones((6, 6, 6))).astype(float)
    result = reconstruct(flat @ embedding, 3)
    inner = ((flat > 0) & (flat < 5)).all(axis=1)
    assert not result.boundary[inner].any()
    simplices = agreed(result.stars, 3)
    simplices = simplices[inner[simplices].all(axis=1)]
    assert most_cofaces(simplices) == 2
    cubes, where = np.unique(
        np.floor(flat[simplices].mean(axis=1)), axis=0, return_inverse=True
    )
    assert len(cubes) == 27
    filled = np.bincount(where.ravel(), volumes(flat, simplices) / 6)
    np.testing.assert_allclose(filled, 1)
    # Every simplex of the stars is a clique; cliques may be more.
    assert simplex_set(simplices) <= simplex_set(result.simplices)


@pytest.mark.parametrize("num", [24, 64, 1000])
@pytest.mark.parametrize("embedding", embeddings(2))
def test_a_regular_polygon_closes(num, embedding):
    angles = 2 * np.pi * np.arange(num) / num
    points = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ embedding
    polygon = {tuple(sorted((i, (i + 1) % num))) for i in range(num)}
    assert simplex_set(reconstruct(points, 1).simplices) == polygon


@pytest.mark.parametrize("num", [6, 7, 12, 30])
@pytest.mark.parametrize("embedding", embeddings(2))
def test_cocircular_rings_are_cleanly_triangulated(num, embedding):
    angles = 2 * np.pi * np.arange(num) / num
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    flat = np.vstack([[[0, 0]], ring, 1.5 * ring, 2 * ring, 2.5 * ring])
    frames = np.broadcast_to(embedding, (len(flat), *embedding.shape))
    regions = rm.local_regions(flat @ embedding, frames)
    simplices = agreed(regions.stars, 2)
    within = simplices[(simplices <= 3 * num).all(axis=1)]
    assert most_cofaces(simplices) == 2
    area = ConvexHull(2 * ring).volume
    np.testing.assert_allclose(volumes(flat, within).sum() / 2, area)


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
def test_corners_of_a_cube_tie_all_at_once(dim):
    corners = np.argwhere(np.ones((2,) * dim)).astype(float)
    frames = np.broadcast_to(np.eye(dim), (len(corners), dim, dim))
    simplices = agreed(rm.local_regions(corners, frames).stars, dim)
    np.testing.assert_allclose(
        volumes(corners, simplices).sum(), np.prod(1 + np.arange(dim))
    )
    assert most_cofaces(simplices) <= 2


# --- Flat spaces, stacked samples ------------------------------------------------


@pytest.mark.parametrize(("dim", "num"), [(2, 500), (3, 300), (4, 120)])
def test_regions_in_their_own_space_are_dual_to_delaunay(dim, num):
    points = np.random.default_rng(dim).normal(size=(num, dim))
    regions = rm.local_regions(points, np.broadcast_to(np.eye(dim), (num, dim, dim)))
    delaunay = Delaunay(points)
    starts, neighbors = delaunay.vertex_neighbor_vertices
    np.testing.assert_array_equal(regions.edge_sets.offsets, starts)
    for begin, end in pairwise(starts):
        expected = np.sort(neighbors[begin:end])
        np.testing.assert_array_equal(regions.edge_sets.indices[begin:end], expected)
    on_hull = np.isin(np.arange(num), delaunay.convex_hull)
    np.testing.assert_array_equal(regions.unbounded, on_hull)
    expected = np.sort(delaunay.simplices, axis=1)
    assert len(regions.stars.simplices) == (dim + 1) * len(expected)
    assert simplex_set(agreed(regions.stars, dim)) == simplex_set(expected)


def test_samples_straight_above_do_not_cut():
    flat = np.random.default_rng(4).normal(size=(60, 2))
    frames = np.broadcast_to(np.eye(2), (60, 2, 2))
    single = rm.edge_sets(flat, frames)
    layers = np.vstack(
        [np.pad(flat, [(0, 0), (0, 1)], constant_values=z) for z in (0, 1)]
    )
    stacked = rm.edge_sets(layers, np.broadcast_to(np.eye(2, 3), (120, 2, 3)))
    np.testing.assert_array_equal(stacked.offsets[:61], single.offsets)
    end = single.offsets[-1]
    np.testing.assert_array_equal(stacked.indices[:end], single.indices)
    np.testing.assert_array_equal(stacked.indices[end:], single.indices + 60)


def test_a_tower_cuts_no_horizontal_plane():
    points = np.outer(np.arange(20.0), [0, 0, 1])
    regions = rm.local_regions(points, np.broadcast_to(np.eye(2, 3), (20, 2, 3)))
    assert len(regions.edge_sets.indices) == 0
    assert len(regions.stars.simplices) == 0
    assert regions.unbounded.all()
    assert np.isinf(regions.radii).all()


# --- Tiny, huge, far from the origin ---------------------------------------------


@pytest.mark.parametrize("ambient", [3, 40])
@pytest.mark.parametrize("scale", [1e-150, 1e-20, 1e20, 1e150])
def test_tiny_and_huge_coordinates(ambient, scale):
    points = ref.draw_sample("torus", 300, 2, ambient, np.random.default_rng(8))
    expected = reconstruct(points, 2)
    result = reconstruct(points * scale, 2)
    np.testing.assert_array_equal(result.simplices, expected.simplices)
    np.testing.assert_array_equal(result.boundary, expected.boundary)
    np.testing.assert_array_equal(result.tangent_simplices, expected.tangent_simplices)
    np.testing.assert_allclose(result.tangents, expected.tangents, atol=1e-9)


@pytest.mark.parametrize("ambient", [3, 40])
@pytest.mark.parametrize("num", [100, 1500])
def test_far_from_the_origin(ambient, num):
    points = ref.draw_sample("torus", num, 2, ambient, np.random.default_rng(9))
    far = points + 1e7
    near = far - 1e7  # exact: the rounding of `far` is in both
    expected = reconstruct(near, 2)
    result = reconstruct(far, 2)
    np.testing.assert_array_equal(result.simplices, expected.simplices)
    np.testing.assert_array_equal(result.edges, expected.edges)
    np.testing.assert_array_equal(result.boundary, expected.boundary)
    np.testing.assert_array_equal(result.tangent_simplices, expected.tangent_simplices)
    found, wanted = rm.neighborhoods(far, 12), rm.neighborhoods(near, 12)
    np.testing.assert_array_equal(found.indices, wanted.indices)
    np.testing.assert_allclose(found.distances, wanted.distances, rtol=1e-12)
