# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a complex as complexes of their own."""

import pickle

import numpy as np
import pytest

import remanifold as rm

TETRAHEDRON = rm.SimplicialComplex(
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [9, 9, 9]], [[0, 1, 2, 3]]
)


def rows(complex_):
    """Simplices by the numbers of the whole."""
    return complex_.vertex_indices[complex_.simplices].tolist()


def test_subset_by_mask_and_by_number():
    rec = rm.reconstruct(rm.datasets.torus(400, random_state=0), 2)
    chosen = np.array([5, 3, 700])
    part = rec.subset(chosen)
    np.testing.assert_array_equal(rows(part), rec.simplices[chosen])
    np.testing.assert_array_equal(part.vertex_indices, np.unique(rec.simplices[chosen]))
    np.testing.assert_array_equal(part.vertices, rec.vertices[part.vertex_indices])
    mask = np.zeros(len(rec.simplices), dtype=bool)
    mask[chosen] = True
    by_mask = rec.subset(mask)
    np.testing.assert_array_equal(rows(by_mask), rec.simplices[[3, 5, 700]])
    assert repr(part).startswith("Subcomplex(vertices=")
    assert rec.subset(~mask).topology().boundary_components > 0
    restored = pickle.loads(pickle.dumps(part))
    np.testing.assert_array_equal(restored.vertex_indices, part.vertex_indices)
    assert not restored.simplices.flags.writeable


def test_subset_of_products():
    points = rm.datasets.circle(60, random_state=0)
    rec = rm.reconstruct(gram=points @ points.T, dim=1)
    part = rec.subset([1, 2])
    whole = rm.SimplicialComplex(points, rec.simplices)
    assert part.vertices is None
    assert part.num_vertices == len(part.vertex_indices)
    assert part.volume() == pytest.approx(whole.subset([1, 2]).volume())


@pytest.mark.parametrize(
    ("simplices", "error", "message"),
    [
        ([0, 1], ValueError, r"simplices\[1\] is 1, expected 0 to 0"),
        ([-1], ValueError, r"simplices\[0\] is -1"),
        ([0, 0], ValueError, r"simplices\[1\] is 0, for the second time"),
        ([True, False], ValueError, r"bool array of shape \(1,\)"),
        ([0.5], ValueError, "integer array"),
    ],
)
def test_bad_subsets_are_refused(simplices, error, message):
    with pytest.raises(error, match=message):
        TETRAHEDRON.subset(simplices)


def test_components_in_order_of_their_labels():
    points = rm.datasets.figure_samples(8)
    rec = rm.reconstruct(points, 2)
    parts = rec.components()
    labels = rec.component_labels()
    assert len(parts) == 2
    for label, part in enumerate(parts):
        np.testing.assert_array_equal(
            part.vertex_indices, np.flatnonzero(labels == label)
        )
        assert part.topology().betti_numbers == (1, 2, 1)
    assert sum(len(part.simplices) for part in parts) == len(rec.simplices)
    assert TETRAHEDRON.subset([]).components() == []


def test_boundary_of_a_tetrahedron_points_outward():
    surface = TETRAHEDRON.boundary_complex()
    assert surface.topology().betti_numbers == (1, 0, 1)
    assert surface.vertex_indices.tolist() == [0, 1, 2, 3]
    corners = surface.vertices[surface.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outward = corners.mean(axis=1) - TETRAHEDRON.vertices[:4].mean(axis=0)
    assert (np.einsum("ij,ij->i", normals, outward) > 0).all()
    none = surface.boundary_complex()
    assert (none.dim, none.num_vertices, len(none.simplices)) == (1, 0, 0)
    assert none.topology().betti_numbers == (0, 0)
    assert (none.volume(), none.components()) == (0, [])
    with pytest.raises(ValueError, match="no simplices"):
        none.project([[0, 0, 0]])


@pytest.mark.parametrize("dim", [2, 3, 4, 5])
def test_boundaries_have_no_boundary_and_are_oriented(dim):
    vertices = np.random.default_rng(dim).normal(size=(dim + 2, dim))
    # Two simplices at a common facet, oriented alike.
    first = list(range(dim + 1))
    second = [dim + 1, *range(1, dim + 1)]
    second[-2:] = second[:-3:-1]
    shell = rm.SimplicialComplex(vertices, [first, second]).boundary_complex()
    assert len(shell.simplices) == 2 * dim
    # Each ridge comes once with either sign.
    signs = {}
    for row in shell.simplices.tolist():
        for left_out in range(dim):
            face = row[:left_out] + row[left_out + 1 :]
            swaps = sum(a > b for i, a in enumerate(face) for b in face[i + 1 :])
            key = tuple(sorted(face))
            signs[key] = signs.get(key, 0) + (-1) ** (swaps + left_out)
    assert set(signs.values()) == {0}


def test_boundary_of_a_curve_are_points():
    path = rm.SimplicialComplex([[0, 0], [1, 0], [2, 0], [3, 3]], [[0, 1], [1, 2]])
    ends = path.boundary_complex()
    assert (ends.dim, rows(ends)) == (0, [[0], [2]])
    topology = ends.topology()
    assert topology.betti_numbers == (2,)
    assert (topology.manifold, topology.closed, topology.components) == (True, True, 2)
    assert ends.volume() == 2
    assert ends.component_labels().tolist() == [0, 1]
    with pytest.raises(ValueError, match="a complex of points has no boundary"):
        ends.boundary_complex()


def test_boundary_of_a_band_is_one_curve():
    rec = rm.reconstruct(rm.datasets.moebius_band(1000, random_state=0), 2)
    rim = rec.boundary_complex()
    assert rim.topology().betti_numbers == (1, 1)
    expected = np.sort(rec.repair.open_faces, axis=1)
    np.testing.assert_array_equal(np.sort(rows(rim), axis=1), expected)
