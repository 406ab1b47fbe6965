# SPDX-License-Identifier: GPL-3.0-or-later
"""More vertices, and evenly spread ones, on the manifold."""

import numpy as np
import pytest
from test_simplification import what_stays

import remanifold as rm


@pytest.mark.parametrize("dim", [1, 2, 3, 4])
def test_pieces_of_a_simplex(dim):
    corners = np.random.default_rng(0).normal(size=(dim + 1, dim))
    for order in (np.arange(dim + 1), np.arange(dim + 1)[::-1]):
        simplex = rm.SimplicialComplex(corners, order[None])
        found = simplex.subdivide()
        assert len(found.simplices) == 2**dim
        assert found.topology().betti_numbers == simplex.topology().betti_numbers
        assert found.topology().manifold
        edges = found.vertices[found.simplices[:, 1:]]
        edges = edges - found.vertices[found.simplices[:, :1]]
        whole = corners[order[1:]] - corners[order[0]]
        np.testing.assert_allclose(np.linalg.det(edges), np.linalg.det(whole) / 2**dim)
        ends = found.vertex_attributes["edge"]
        np.testing.assert_allclose(found.vertices, corners[ends].mean(axis=1))


@pytest.mark.parametrize(("count", "dim"), [(300, 2), (300, 3), (60, 1)])
def test_new_vertices_are_on_spheres(count, dim):
    points = rm.datasets.sphere(count, dim=dim, random_state=0)
    rec = rm.reconstruct(points, dim)
    found = rec.subdivide()
    assert what_stays(found) == what_stays(rec)
    off = np.abs(np.linalg.norm(found.vertices, axis=1) - 1)
    flat = np.abs(np.linalg.norm(rec.subdivide(fitted=False).vertices, axis=1) - 1)
    assert off.max() < flat.max() / 10


def test_new_vertices_converge_to_a_torus():
    """Their distances fall with the fourth power of the edges, the square of N."""
    off = []
    for count in (800, 3200):
        rec = rm.reconstruct(rm.datasets.torus(count, random_state=0), 2)
        x, y, z = rec.subdivide().vertices.T
        off.append(np.median(np.abs(np.hypot(np.hypot(x, y) - 1, z) - 0.4)[count:]))
    assert off[1] < off[0] / 10
    assert off[0] < 1e-3


@pytest.mark.parametrize("wanted", [250, 1000])
def test_resampled_evenly(wanted):
    rec = rm.reconstruct(rm.datasets.torus(600, random_state=0), 2)
    found = rec.resample(wanted)
    assert found.num_vertices == wanted
    assert what_stays(found) == what_stays(rec)
    spread = []
    for complex_ in (rec, found):
        i, j = complex_.edges.T
        lengths = np.linalg.norm(complex_.vertices[i] - complex_.vertices[j], axis=1)
        spread.append(lengths.std() / lengths.mean())
    assert spread[1] < 0.7 * spread[0]
    x, y, z = found.vertices.T
    assert np.abs(np.hypot(np.hypot(x, y) - 1, z) - 0.4).max() < 0.05


def test_bad_numbers_are_named():
    triangle = rm.SimplicialComplex(np.eye(3), [[0, 1, 2]])
    with pytest.raises(ValueError, match="rounds is 0, expected at least 1"):
        triangle.subdivide(0)
    with pytest.raises(ValueError, match="num_vertices is 2, expected at least 3"):
        triangle.resample(2)


@pytest.mark.parametrize("dim", [1, 2, 3])
@pytest.mark.parametrize("rounds", [40, 2**31 - 1])
def test_more_simplices_than_can_be_numbered_are_refused_at_once(dim, rounds):
    """Memory ran out after seconds, and what was missing was not said."""
    simplex = rm.SimplicialComplex(np.eye(dim + 1), np.arange(dim + 1)[None])
    with pytest.raises(ValueError, match=r"rounds is \d+, which makes 2\^\d+ times"):
        simplex.subdivide(rounds)
    with pytest.raises(
        ValueError, match="num_vertices is 1000000000, expected at most"
    ):
        simplex.resample(1_000_000_000)
