# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances along complexes, beside those of the manifolds they stand for."""

import subprocess
import sys

import numpy as np
import pytest

import remanifold as rm
from remanifold._base.samples import Distances
from remanifold.calculus import geodesics
from remanifold.complex.graphs import edge_graph
from remanifold.results.simplicial_complex import Subcomplex

SOURCES = [0, 7]


@pytest.fixture(scope="module")
def sphere():
    points = rm.datasets.sphere(2000, random_state=0)
    true = np.arccos(np.clip(points[SOURCES] @ points.T, -1, 1))
    return rm.reconstruct(points, 2), true


@pytest.fixture(scope="module")
def flat_torus():
    angles = 2 * np.pi * np.random.default_rng(0).random((1000, 2))
    away = np.abs(angles[SOURCES, None] - angles[None])
    away = np.minimum(away, 2 * np.pi - away)
    points = np.hstack([np.cos(angles), np.sin(angles)])
    return rm.reconstruct(points, 2), np.linalg.norm(away, axis=2)


def relative_errors(found, true):
    assert (found[range(len(SOURCES)), SOURCES] == 0).all()
    return (found - true) / np.maximum(true, 0.1)


# What was measured, with a margin of a third.
@pytest.mark.parametrize(
    ("method", "error"), [("graph", 0.07), ("heat", 0.01), ("exact", 0.002)]
)
def test_distances_on_a_sphere(sphere, method, error):
    rec, true = sphere
    found = rec.geodesic_distances(SOURCES, method)
    errors = relative_errors(found, true)
    assert np.abs(errors).mean() < error
    if method == "graph":
        assert errors.min() > -0.01  # detours
    if method == "exact":
        np.testing.assert_array_equal(rec.geodesic_distances(SOURCES), found)


@pytest.mark.parametrize(
    ("method", "error"), [("graph", 0.08), ("heat", 0.02), ("exact", 0.003)]
)
@pytest.mark.parametrize("ambient", [4, 20])
def test_distances_on_a_flat_torus(flat_torus, method, error, ambient):
    rec, true = flat_torus
    if ambient > 4:
        placed = rm.datasets.embed(rec.vertices, ambient, random_state=0)
        rec = rm.SimplicialComplex(placed, rec.simplices)
    errors = relative_errors(rec.geodesic_distances(SOURCES, method), true)
    assert np.abs(errors).mean() < error


def test_distances_on_a_three_sphere():
    points = np.random.default_rng(0).normal(size=(1500, 4))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    rec = rm.reconstruct(points, 3)
    true = np.arccos(np.clip(points[SOURCES] @ points.T, -1, 1))
    mean = {
        method: np.abs(
            relative_errors(rec.geodesic_distances(SOURCES, method), true)
        ).mean()
        for method in ("graph", "auto")
    }
    assert mean["auto"] < 0.05
    assert mean["auto"] < 0.6 * mean["graph"]


@pytest.mark.slow
def test_heat_is_nearer_than_that_of_others(sphere):
    """By the library that the method came with: too short by their mean cosine."""
    potpourri3d = pytest.importorskip("potpourri3d")
    rec, true = sphere
    solver = potpourri3d.MeshHeatMethodDistanceSolver(
        rec.vertices, rec.simplices.astype(np.int64)
    )
    theirs = np.array([solver.compute_distance(source) for source in SOURCES])
    own = rec.geodesic_distances(SOURCES, "heat")
    assert np.abs(own - true).mean() < np.abs(theirs - true).mean() / 2


def test_heat_on_a_disk_with_its_boundary():
    """Straight lines; where heat is thought to stay inside it is off by 0.014."""
    random = np.random.default_rng(0)
    angle, radius = 2 * np.pi * random.random(2000), np.sqrt(random.random(2000))
    disk = rm.reconstruct(
        np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1), 2
    )
    found = disk.geodesic_distances([0, 7, 100], "heat")
    true = np.linalg.norm(disk.vertices - disk.vertices[[0, 7, 100]][:, None], axis=2)
    assert np.abs(found - true).mean() < 0.008


def test_heat_falls_off_without_underflow():
    # A strip of 1000 edge lengths: heat at its end is far below the least number.
    along = np.arange(1000.0)
    vertices = np.concatenate(
        [np.stack([along, np.full(1000, y), 0 * along, 0 * along], 1) for y in (0, 1)]
    )
    first = np.arange(999)
    rows = np.concatenate(
        [
            np.stack([first, first + 1, first + 1000], axis=1),
            np.stack([first + 1, first + 1000, first + 1001], axis=1),
        ]
    )
    found = rm.SimplicialComplex(vertices, rows).geodesic_distances([0], "heat")
    assert found[0, 500] == pytest.approx(500, rel=0.05)


def test_curves_are_exact():
    vertices = [[0, 0], [3, 4], [3, 5], [9, 9], [2, 0], [7, 7]]
    path = rm.SimplicialComplex(vertices, [[0, 1], [1, 2], [0, 4]])
    expected = [[0, 5, 6, np.inf, 2, np.inf], [6, 1, 0, np.inf, 8, np.inf]]
    for method in ("auto", "graph", "heat", "exact"):
        assert path.geodesic_distances([0, 2], method).tolist() == expected


def test_products_are_as_good(flat_torus):
    rec, _ = flat_torus
    known = rm.reconstruct(gram=rec.vertices @ rec.vertices.T, dim=2)
    np.testing.assert_array_equal(  # the orientation may be the other one
        np.sort(known.simplices, axis=1), np.sort(rec.simplices, axis=1)
    )
    for method in ("graph", "heat", "exact"):
        np.testing.assert_allclose(
            known.geodesic_distances(0, method),
            rec.geodesic_distances(0, method),
            atol=1e-6,
        )


@pytest.mark.parametrize("method", ["graph", "heat", "exact"])
def test_other_components_are_infinitely_far(method):
    ball = rm.datasets.sphere(300, random_state=0)
    points = np.vstack([ball + 9, ball, [[99, 99, 99]]])
    rec = rm.reconstruct(points, 2)
    labels = rec.component_labels()
    assert labels[600] == -1
    found = rec.geodesic_distances([5, 400], method)
    np.testing.assert_array_equal(np.isfinite(found[0]), labels == labels[5])
    np.testing.assert_array_equal(np.isfinite(found[1]), labels == labels[400])


def test_graph_of_the_edges():
    square = rm.SimplicialComplex(
        [[0, 0], [3, 0], [3, 4], [0, 4], [8, 8]], [[0, 1, 2], [0, 2, 3]]
    )
    graph = edge_graph(square)
    assert graph.shape == (5, 5)
    assert graph.nnz == 10
    expected = np.zeros((5, 5))
    for i, j, length in ((0, 1, 3), (1, 2, 4), (0, 2, 5), (2, 3, 3), (0, 3, 4)):
        expected[i, j] = expected[j, i] = length
    np.testing.assert_array_equal(graph.toarray(), expected)


def test_coinciding_vertices_are_near():
    path = rm.SimplicialComplex(
        [[0, 0], [1, 0], [1, 0], [2, 0]], [[0, 1], [1, 2], [2, 3]]
    )
    assert path.geodesic_distances(0).tolist() == [[0, 1, 1, 2]]


@pytest.mark.parametrize("method", ["graph", "heat", "exact"])
def test_three_triangles_at_an_edge(method):
    pages = rm.SimplicialComplex(
        [[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, 0, 0]],
        [[0, 1, 2], [0, 1, 3], [0, 1, 4]],
    )
    if method == "exact":
        with pytest.raises(ValueError, match="is for manifolds"):
            pages.geodesic_distances(2, method)
        return
    found = pages.geodesic_distances(2, method)
    assert np.isfinite(found).all()
    assert found[0, 3] == pytest.approx(2, rel=0.35)


@pytest.mark.parametrize(
    ("sources", "message"),
    [
        ([0, 9], r"sources\[1\] is 9, expected 0 to 3"),
        (-1, r"sources\[0\] is -1"),
        ([3], r"sources\[0\] is vertex 3, which is in no simplex"),
        ([0.5], "sources must be a one-dimensional integer array"),
        ([[0, 1]], "sources must be a one-dimensional integer array"),
    ],
)
def test_bad_sources_are_refused(sources, message):
    complex_ = rm.SimplicialComplex(np.eye(4), [[0, 1, 2]])
    with pytest.raises(ValueError, match=message):
        complex_.geodesic_distances(sources)


def test_bad_methods_are_refused(flat_torus):
    rec, _ = flat_torus
    solid = rm.SimplicialComplex(np.eye(4), [[0, 1, 2, 3]])
    with pytest.raises(ValueError, match=r"exact.* for curves and surfaces"):
        solid.geodesic_distances(0, "exact")
    with pytest.raises(ValueError, match="method is 'best'"):
        rec.geodesic_distances(0, "best")
    flat = rm.SimplicialComplex([[0, 0, 0, 0], [1, 0, 0, 0], [2, 0, 0, 0]], [[0, 1, 2]])
    with pytest.raises(ValueError, match="no solution"):
        flat.geodesic_distances(0, "heat")
    assert rec.geodesic_distances([], "heat").shape == (0, 1000)
    assert rec.geodesic_distances([], "graph").shape == (0, 1000)


@pytest.mark.parametrize("method", ["graph", "heat"])
def test_missing_packages_are_named(method):
    script = (
        "import sys; sys.modules['scipy'] = None; import remanifold as rm\n"
        "triangle = rm.SimplicialComplex([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])\n"
        "try:\n"
        f"    triangle.geodesic_distances(0, {method!r})\n"
        "except ImportError as error:\n"
        "    print(error)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert "pip install remanifold[geodesic]" in done.stdout


def test_exact_paths_pass_corners_of_the_boundary():
    """An L of unit squares: straight, then around the inner corner."""
    corners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
    shape = rm.SimplicialComplex(corners, [[0, 1, 3], [1, 2, 3], [0, 3, 5], [3, 4, 5]])
    away = shape.geodesic_distances([2, 4, 1], "exact")
    assert away[0, 4] == pytest.approx(2, abs=1e-14)
    assert away[1, 1] == pytest.approx(1 + np.sqrt(2), abs=1e-14)
    assert away[2, 5] == pytest.approx(2 * np.sqrt(2), abs=1e-14)


def test_exact_paths_on_a_cube_and_around_a_saddle():
    """Unfolded: opposite corners of a cube are sqrt(5) apart."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    squares = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4)]
    squares.append((1, 3, 7, 5))
    rows = [tri for a, b, c, d in squares for tri in ((a, b, c), (a, c, d))]
    cube = rm.SimplicialComplex(corners, rows)
    away = cube.geodesic_distances(range(8), "exact")
    np.testing.assert_allclose(away, away.T, atol=1e-14)
    apart = np.abs(corners[:, None] - corners).sum(axis=2)
    true = np.sqrt([0, 1, 2, 5])[apart]
    np.testing.assert_allclose(away, true, atol=1e-14)


def test_exact_distances_are_those_of_a_flat_klein_bottle():
    """By lengths alone: a grid whose columns join after a turn over."""
    size = 12
    i, j = np.divmod(np.arange(size * size), size)

    def number(a, b):
        return (a % size) * size + np.where(a // size % 2, -b, b) % size

    rows = np.concatenate(
        [
            np.stack([number(i, j), number(i + 1, j), number(i + 1, j + 1)], axis=1),
            np.stack([number(i, j), number(i + 1, j + 1), number(i, j + 1)], axis=1),
        ]
    )
    images = [
        np.stack([a * size + i, (-j if a % 2 else j) + b * size], axis=1)
        for a in (-1, 0, 1)
        for b in (-2, -1, 0, 1, 2)
    ]
    places = np.stack([i, j], axis=1)
    apart = np.linalg.norm(places[:, None, None] - np.stack(images, axis=1), axis=3)
    true = apart.min(axis=2)
    bottle = Subcomplex(
        None,
        rows.astype(np.int32),
        vertex_indices=np.arange(size * size, dtype=np.int32),
        _products=Distances(true),
    )
    assert not bottle.topology().orientable
    sources = [0, 17, 100]
    found = bottle.geodesic_distances(sources, "exact")
    np.testing.assert_allclose(found, true[sources], atol=1e-12)


def test_the_default_is_exact_where_it_is_cheap(monkeypatch, sphere):
    rec, _ = sphere
    exact = rec.geodesic_distances(0, "exact")
    np.testing.assert_array_equal(rec.geodesic_distances(0), exact)
    monkeypatch.setattr(geodesics, "_EXACT_WORK", 1e6)
    heat = rec.geodesic_distances(0, "heat")
    np.testing.assert_array_equal(rec.geodesic_distances(0), heat)


def test_exact_distances_where_vertices_coincide():
    """Flat triangles: not below what is straight, nor above the way along the edges."""
    points = rm.datasets.torus(300, random_state=0)
    rows = rm.reconstruct(points, 2).simplices
    coarse = rm.SimplicialComplex(np.round(points * 2) / 2, rows)
    assert len(coarse.calculus.flat_simplices) > 300
    found = coarse.geodesic_distances(0, "exact")[0]
    straight = np.linalg.norm(coarse.vertices - coarse.vertices[0], axis=1)
    assert (found >= straight - 1e-12).all()
    assert (found <= coarse.geodesic_distances(0, "graph")[0] + 1e-12).all()
