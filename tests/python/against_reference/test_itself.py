# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference on what is known by other means: it must be right to judge."""

import math
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
import scipy.spatial

import reference as ref

pytestmark = pytest.mark.slow


def test_tied_neighbors_come_by_index_and_copies_as_one():
    points = np.array([[0.0, 0], [1, 0], [0, 1], [0, 0], [-1, 0], [0, 1], [3, 0]])
    assert ref.representatives(points).tolist() == [0, 1, 2, 0, 4, 2, 6]
    indices, distances = ref.neighborhoods(points, 3)
    assert indices[0].tolist() == indices[3].tolist() == [1, 2, 4]
    assert distances[0].tolist() == [1, 1, 1]
    assert ref.neighborhoods(points, 50)[0].shape == (7, 4)


@pytest.mark.parametrize(
    ("x", "expected"),
    [
        ([0.25, 0.25, 9.0], True),
        ([0.5, 0.5, -9.0], True),
        ([0.0, 0.0, 1.0], True),
        ([0.51, 0.5, 0.0], False),
        ([-0.01, 0.5, 0.0], False),
    ],
)
def test_enclosed_projects_onto_the_plane_of_the_tuple(x, expected):
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    assert ref.enclosed(np.array(x), corners) is expected


def test_dependent_tuples_enclose_nothing():
    line = np.array([[0.0, 0, 0], [1, 1, 0], [2, 2, 0]])
    assert not ref.enclosed(np.array([1.0, 1, 0]), line)


def exact_thetas(x, corners):
    """Rational barycentric coordinates of the projection onto a triangle."""
    x, a, b, c = ([Fraction(float(v)) for v in p] for p in (x, *corners))
    u, v, z = ([p - q for p, q in zip(end, a, strict=True)] for end in (b, c, x))

    def dot(p, q):
        return sum(s * t for s, t in zip(p, q, strict=True))

    det = dot(u, u) * dot(v, v) - dot(u, v) ** 2
    first = (dot(u, z) * dot(v, v) - dot(v, z) * dot(u, v)) / det
    second = (dot(v, z) * dot(u, u) - dot(u, z) * dot(u, v)) / det
    return 1 - first - second, first, second


@pytest.mark.parametrize("ambient", [2, 3, 20])
def test_tangent_basis_is_the_first_tuple_that_qualifies(ambient):
    points = np.random.default_rng(ambient).normal(size=(12, ambient))
    nbds = ref.neighborhoods(points, 8)[0]
    order = sorted(combinations(range(8), 3), key=lambda t: (t[2], t[1], t[0]))

    def qualifies(x, corners):
        return all(
            (min(exact_thetas(points[p], points[list(corners)])) >= 0) == (p == x)
            for p in {x, *nbds[x]} - {*corners}
        )

    for x, nbd in enumerate(nbds):
        expected = next(
            (nbd[list(t)] for t in order if qualifies(x, nbd[list(t)])), None
        )
        found = ref.tangent_basis(points, x, nbd, 2)
        np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("dim", [2, 3, 4])
def test_regions_in_their_own_space_are_dual_to_delaunay(dim):
    points = np.random.default_rng(dim).normal(size=(40, dim))
    delaunay = scipy.spatial.Delaunay(points)
    starts, neighbors = delaunay.vertex_neighbor_vertices
    frames = np.broadcast_to(np.eye(dim), (40, dim, dim))
    regions = ref.local_regions(points, frames)
    for x, region in enumerate(regions):
        expected = np.sort(neighbors[starts[x] : starts[x + 1]])
        np.testing.assert_array_equal(region.edge_set, expected)
        assert region.unbounded == (x in delaunay.convex_hull)
    expected = np.unique(np.sort(delaunay.simplices, axis=1), axis=0)
    np.testing.assert_array_equal(ref.agreed(regions, dim), expected)


def test_edge_sets_in_rational_arithmetic():
    rng = np.random.default_rng(11)
    points = rng.normal(size=(40, 5))
    frames = np.linalg.qr(rng.normal(size=(40, 5, 2)))[0].transpose(0, 2, 1)
    for x, region in enumerate(ref.local_regions(points, frames)):
        exact = ref.exact_edge_set(points, x, frames[x])
        np.testing.assert_array_equal(region.edge_set, exact)


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
@pytest.mark.parametrize("unbounded", [False, True])
def test_hull_vertices_are_the_constraints_that_bind(dim, unbounded):
    rng = np.random.default_rng(dim)
    duals = rng.normal(size=(25, dim)) * rng.uniform(size=(25, 1))
    duals[:, 0] = np.abs(duals[:, 0]) if unbounded else duals[:, 0]
    vertices, facets, open_ended = ref.hull_with_origin(duals)
    margins = [ref.binding_margin(duals, q) for q in range(25)]
    assert set(np.flatnonzero(np.array(margins) > 0)) == set(vertices)
    assert np.abs(margins).min() > 1e-9
    assert open_ended is unbounded
    for facet in combinations(range(25), dim):
        is_facet = np.isin(np.sort(facets, axis=1), facet).all(axis=1).any()
        assert (ref.facet_margin(duals, np.array(facet)) > 0) == is_facet


def test_a_flat_hull_is_taken_in_the_space_it_spans():
    duals = np.array([[1.0, 1, 0], [2, 2, 0], [-1, -1, 0]])
    vertices, facets, unbounded = ref.hull_with_origin(duals)
    assert sorted(vertices) == [1, 2]
    assert len(facets) == 0
    assert unbounded


def test_cliques_by_brute_force():
    rng = np.random.default_rng(7)
    pairs = np.argwhere(np.triu(rng.uniform(size=(14, 14)) < 0.6, 1))
    edges = set(map(tuple, pairs.tolist()))
    for size in (2, 3, 4, 5):
        expected = [
            subset
            for subset in combinations(range(14), size)
            if edges.issuperset(combinations(subset, 2))
        ]
        assert list(map(tuple, ref.cliques(pairs, size).tolist())) == expected
    assert ref.cliques(pairs[:0], 3).shape == (0, 3)


@pytest.mark.parametrize("ambient", [2, 3, 50])
def test_a_circle_becomes_a_closed_polygon(ambient):
    rng = np.random.default_rng(ambient)
    angles = 2 * np.pi * (np.arange(60) + rng.uniform(-0.3, 0.3, 60)) / 60
    points = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    result = ref.reconstruct(ref.embedded(points, ambient, rng), 1)
    polygon = {tuple(sorted((i, (i + 1) % 60))) for i in range(60)}
    assert set(map(tuple, result.simplices.tolist())) == polygon


def test_a_sphere_becomes_a_closed_surface():
    points = ref.draw_sample("sphere", 150, 2, 3, np.random.default_rng(0))
    result = ref.reconstruct(points, 2)
    surface = ref.agreed(result.regions, 2)
    faces = np.vstack([surface[:, [0, 1]], surface[:, [0, 2]], surface[:, [1, 2]]])
    faces, cofaces = np.unique(faces, axis=0, return_counts=True)
    assert (cofaces == 2).all()
    assert 150 - len(faces) + len(surface) == 2
    np.testing.assert_array_equal(faces, result.edges)
    # Cliques also fill the three neighbors of a vertex with no others.
    degrees = np.bincount(result.edges.ravel())
    assert len(result.simplices) == len(surface) + (degrees == 3).sum()


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_inner_products_or_distances_alone_give_the_same_complex(dim):
    points = ref.draw_sample("sphere", 30, dim, 12, np.random.default_rng(dim))
    distances = scipy.spatial.distance.cdist(points, points)
    expected = ref.reconstruct(points, dim, 12)
    for same in (
        ref.points_from_gram(points @ points.T),
        ref.points_from_distances(distances),
    ):
        result = ref.reconstruct(same, dim, 12)
        np.testing.assert_array_equal(result.neighborhoods, expected.neighborhoods)
        np.testing.assert_array_equal(
            result.tangents.simplices, expected.tangents.simplices
        )
        np.testing.assert_array_equal(result.edges, expected.edges)
        np.testing.assert_array_equal(result.simplices, expected.simplices)


# --- The chain ------------------------------------------------------------------


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
def test_measures_of_regular_simplices(dim):
    corners = ref.embedded(np.eye(dim + 1), dim + 3, np.random.default_rng(dim))[None]
    edges = dim * (dim + 1) // 2
    volume = np.sqrt(dim + 1) / math.factorial(dim)
    assert ref.volumes(corners) == pytest.approx(volume)
    assert ref.circumradii(corners) == pytest.approx(np.sqrt(dim / (dim + 1)))
    assert ref.squared_edges(corners) == pytest.approx(2 * edges)
    scales = np.full(dim + 1, 3.0)
    energy = ref.energies(corners[0], scales, np.arange(dim + 1)[None])
    assert energy == pytest.approx(volume * 2 * edges / 3 ** (dim + 2))


def test_scales_are_medians_of_distances_to_a_neighbor():
    line = np.arange(40.0)[:, None]
    # The sixth neighbor is three away, the tenth five; at the ends they are farther.
    assert ref.local_scales(line, 2, 15)[6:34].tolist() == [3] * 28
    assert ref.local_scales(line, 1, 15)[10:30].tolist() == [5] * 20
    assert ref.local_scales(line, 1, 6)[6:34].tolist() == [3] * 28
    # The second neighbors of these are 3, 2, 3, 6, 12 away, the third 7, 6, 4, 7, 14.
    wide = np.array([[0.0], [1], [3], [7], [15]])
    assert ref.local_scales(wide, 2, 2).tolist() == [3, 3, 3, 3, 6]
    assert ref.local_scales(wide, 2, 3).tolist() == [6, 6, 6, 6, 6]


def test_patches_are_connected_through_facets():
    triangles = np.array([[0, 1, 2], [1, 2, 3], [3, 4, 5], [4, 5, 6], [6, 7, 8]])
    labels = ref.patches(triangles)
    assert labels[0] == labels[1] != labels[2] == labels[3] != labels[4] != labels[0]


def square_hole(prices=50.0):
    """A square with a corner raised: two ways to fill it, and facets to leave open."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0.2], [0, 1, 0]])
    candidates = np.array(list(combinations(range(4), 3)))
    facets, has = ref.facets_of(candidates)
    rim = [tuple(f) not in ((0, 2), (1, 3)) for f in facets.tolist()]
    return ref.Cavities(
        np.empty((0, 3), int),
        candidates,
        ref.energies(points, np.ones(4), candidates),
        facets,
        has,
        np.array(rim, int),
        np.full(len(facets), prices),
        0,
    )


def test_the_cheapest_diagonal_fills_a_square():
    cavity = square_hole()
    filling = ref.fill(cavity)
    chosen = set(map(tuple, cavity.candidates[filling.chosen].tolist()))
    assert chosen == {(0, 1, 3), (1, 2, 3)}  # the diagonal that is not raised
    assert filling.energy == pytest.approx(cavity.energies[filling.chosen].sum())
    assert (filling.open_facets, filling.unique) == (0, True)
    # Every choice by itself.
    best = min(
        sum(cavity.energies[list(choice)])
        for choice in ([0, 2], [1, 3])  # 012 + 023, 013 + 123
    )
    assert filling.energy == pytest.approx(best)


def test_a_hole_stays_where_that_is_cheaper():
    filling = ref.fill(square_hole(prices=0.1))
    assert not filling.chosen.any()
    assert filling.open_facets == 4
    assert filling.energy == pytest.approx(0.4)


def test_ties_are_not_unique():
    cavity = square_hole()
    flat = cavity._replace(energies=np.full(4, 0.5))
    assert not ref.fill(flat).unique
