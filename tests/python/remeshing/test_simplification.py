# SPDX-License-Identifier: GPL-3.0-or-later
"""Fewer vertices, the same topology, and how far the rest lies from what is left."""

import itertools

import numpy as np
import pytest

import remanifold as rm
from calculus_meshes import known_by


def spheres_and_band():
    ball = rm.datasets.sphere(150, random_state=0)
    band = rm.datasets.moebius_band(200, random_state=0)
    return np.concatenate([ball, np.add(ball, [9, 0, 0]), np.add(band, [0, 9, 0])])


MANIFOLDS = {
    "torus": (lambda: rm.datasets.torus(500, random_state=0), 2, 30),
    "Klein bottle": (lambda: rm.datasets.klein_bottle(700, random_state=0), 2, 40),
    "Moebius band": (lambda: rm.datasets.moebius_band(300, random_state=0), 2, 20),
    "annulus": (lambda: rm.datasets.annulus(300, random_state=0), 2, 20),
    "3-sphere": (lambda: rm.datasets.sphere(200, dim=3, random_state=0), 3, 30),
    "ball": (lambda: rm.datasets.ball(200, random_state=0), 3, 80),
    "components": (spheres_and_band, 2, 60),
    "circle": (lambda: rm.datasets.circle(100, random_state=0), 1, 8),
}


@pytest.fixture(scope="module", params=MANIFOLDS)
def manifold(request):
    draw, dim, few = MANIFOLDS[request.param]
    rec = rm.reconstruct(draw(), dim)
    assert rec.topology().manifold
    return rec, few


def what_stays(complex_):
    found = complex_.topology()
    return (
        found.manifold,
        found.betti_numbers,
        found.components,
        found.boundary_components,
        found.orientable,
        found.euler_characteristic,
    )


def test_topology_and_openings_stay(manifold):
    rec, few = manifold
    found = rec.simplify(few, even=True)
    assert what_stays(found) == what_stays(rec)
    assert found.reached
    assert found.num_vertices == few
    np.testing.assert_array_equal(found.vertices, rec.vertices[found.vertex_indices])
    # Vertices of the boundary are on the boundary.
    if not rec.topology().closed:
        rim = np.unique(rec.boundary_complex().vertex_indices)
        own = found.vertex_indices[found.boundary_complex().vertex_indices]
        assert np.isin(own, rim).all()


def test_errors_are_upper_bounds(manifold):
    rec, few = manifold
    found = rec.simplify(few)
    assert what_stays(found) == what_stays(rec)
    true = found.project(rec.vertices).distances
    assert (found.errors >= true - 1e-12).all()
    assert (found.errors[found.vertex_indices] == 0).all()
    # Mostly the simplex that took the place is the nearest one.
    assert found.errors.mean() < 1.1 * true.mean()


def test_up_to_an_error(manifold):
    rec, _ = manifold
    limit = 0.05
    found = rec.simplify(max_error=limit)
    assert what_stays(found) == what_stays(rec)
    assert 0 < found.errors.max() <= limit
    assert found.project(rec.vertices).distances.max() <= limit
    both = rec.simplify(found.num_vertices + 5, max_error=limit)
    assert both.num_vertices == found.num_vertices + 5


def test_errors_beside_those_of_a_sphere():
    """Edges of length h on the unit sphere stand off by h^2 / 8, triangles by h^2 / 6."""
    rec = rm.reconstruct(rm.datasets.sphere(1500, random_state=0), 2)
    found = rec.simplify(300)
    true = found.project(rec.vertices).distances
    area = 4 * np.pi / (2 * 300 - 4)
    regular = 4 / np.sqrt(3) * area / 6  # h^2 / 6 of triangles of this area
    assert true.max() < 2 * regular
    normals = found.vertex_normals
    assert ((normals * found.vertices).sum(axis=1) > 0.95).all()


def test_flat_parts_go_and_bent_ones_stay():
    """A roof: nothing is lost but along the ridge, which its ends keep."""
    x, y = np.meshgrid(np.arange(21.0), np.arange(21.0), indexing="ij")
    z = 5 - np.abs(x - 10)
    number = np.arange(441).reshape(21, 21)
    a, b, c, d = (
        part.ravel()
        for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    )
    roof = rm.SimplicialComplex(
        np.stack([x, y, z], axis=2).reshape(-1, 3),
        np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]),
    )
    found = roof.simplify(max_error=1e-9)
    assert found.num_vertices < 30
    assert found.volume() == pytest.approx(roof.volume())
    assert np.isin(number[[0, 10, 20]][:, [0, 20]], found.vertex_indices).all()


def test_orientation_attributes_and_fixed_vertices():
    points = rm.datasets.torus(600, random_state=0)
    rec = rm.reconstruct(points, 2)
    named = rm.SimplicialComplex(
        points, rec.simplices, vertex_attributes={"row": np.arange(600)}
    )
    found = named.simplify(100, keep=[3, 5, 8])
    assert np.isin([3, 5, 8], found.vertex_indices).all()
    np.testing.assert_array_equal(found.vertex_attributes["row"], found.vertex_indices)
    corners = found.vertices[found.simplices]
    inside = np.einsum(
        "md,md->m", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])
    )
    whole = points[rec.simplices]
    before = np.einsum("md,md->m", whole[:, 0], np.cross(whole[:, 1], whole[:, 2]))
    assert np.sign(inside.sum()) == np.sign(before.sum())
    ways = np.concatenate([found.simplices[:, [i, (i + 1) % 3]] for i in range(3)])
    assert len(np.unique(ways, axis=0)) == len(ways)  # each edge once in each direction


def test_known_by_products_only():
    points = rm.datasets.flat_torus(200, random_state=0)
    by_points = rm.reconstruct(points, 2)
    by_products = known_by("distances", by_points)
    found = by_products.simplify(60)
    assert found.vertices is None
    assert what_stays(found) == what_stays(by_points)
    assert found.volume() == pytest.approx(by_points.simplify(60).volume(), rel=1e-9)


def test_where_it_is_no_manifold_all_stays():
    """Two spheres that share a vertex."""
    ball = rm.reconstruct(rm.datasets.sphere(200, random_state=0), 2)
    other = np.where(ball.simplices == 0, 0, ball.simplices + 199)
    both = rm.SimplicialComplex(
        np.concatenate([ball.vertices, 2 * ball.vertices[0] - ball.vertices[1:]]),
        np.concatenate([ball.simplices, other]),
    )
    assert both.topology().singular_vertices.tolist() == [0]
    found = both.simplify(40)
    assert found.vertex_indices[found.topology().singular_vertices].tolist() == [0]
    assert found.topology().betti_numbers == both.topology().betti_numbers


def test_as_few_as_the_topology_allows():
    """The boundary of a tetrahedron, seven vertices of a torus and no fewer."""
    solid = np.array(list(itertools.combinations(range(4), 3)))
    tetrahedron = rm.SimplicialComplex(np.eye(4)[:, :3], solid)
    found = tetrahedron.simplify(3)
    assert found.num_vertices == 4
    assert not found.reached
    torus = rm.reconstruct(rm.datasets.torus(500, random_state=0), 2)
    found = torus.simplify(3)
    assert not found.reached
    assert 7 <= found.num_vertices < 30
    assert what_stays(found) == what_stays(torus)


def test_missing_vertices_have_no_error():
    path = rm.SimplicialComplex([[0.0], [1], [2], [9]], [[0, 1], [1, 2]])
    found = path.simplify(2)
    assert found.vertex_indices.tolist() == [0, 2]
    np.testing.assert_array_equal(found.errors, [0, 0, 0, np.nan])


def test_vertices_that_stay_take_their_neighbors_in():
    """Of a triangle cut into four only what is asked for: its corners and one more."""
    fine = rm.SimplicialComplex([[0, 0], [4, 0], [0, 4]], [[0, 1, 2]]).subdivide(2)
    inner = int(np.flatnonzero((fine.vertices == 1).all(axis=1))[0])
    found = fine.simplify(4, keep=[0, 1, 2, inner])
    assert found.vertex_indices.tolist() == [0, 1, 2, inner]
    assert found.volume() == pytest.approx(8)


def test_progress_is_told_and_ends_it():
    rec = rm.reconstruct(rm.datasets.sphere(500, random_state=0), 2)
    ball = rec.subdivide(3, fitted=False)

    class StopError(Exception):
        pass

    def stop(step, done, total):
        assert step in ("prepare", "simplification")
        assert 0 <= done <= total
        raise StopError

    with pytest.raises(StopError):
        ball.simplify(100, progress=stop)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"num_vertices": 2}, "num_vertices is 2, expected at least 3"),
        ({"max_error": -1.0}, "max_error is -1.0"),
        ({"num_vertices": 9, "keep": [999]}, r"keep\[0\] is 999"),
        ({"num_vertices": 9.5}, "num_vertices must be an integer"),
        ({}, "give num_vertices or max_error"),
    ],
)
def test_bad_input_is_named(options, message):
    triangle = rm.SimplicialComplex(np.eye(3), [[0, 1, 2]])
    with pytest.raises((ValueError, TypeError), match=message):
        triangle.simplify(**options)


def test_points_have_no_edges():
    with pytest.raises(ValueError, match="no edge to collapse"):
        rm.SimplicialComplex([[0.0], [1]], [[0], [1]]).simplify(1)
