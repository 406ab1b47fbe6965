# SPDX-License-Identifier: GPL-3.0-or-later
"""Complexes as objects of GUDHI, trimesh, PyVista, meshio, NetworkX and SciPy."""

from __future__ import annotations

import sys

import meshio
import networkx as nx
import numpy as np
import pytest
import trimesh
from scipy.sparse.csgraph import connected_components, dijkstra

import remanifold as rm
from remanifold import interoperability


@pytest.fixture(scope="module")
def torus():
    return rm.reconstruct(rm.datasets.torus(400, random_state=0), 2)


@pytest.fixture(scope="module")
def torus4():
    """A surface in R^4."""
    return rm.reconstruct(rm.datasets.flat_torus(300, random_state=0), 2)


EDGES = rm.SimplicialComplex([[0, 0], [3, 4], [3, 5], [9, 9]], [[0, 1], [2, 1]])
TETRAHEDRA = rm.SimplicialComplex(
    np.random.default_rng(0).normal(size=(6, 3)), [[0, 1, 2, 3], [1, 2, 3, 5]]
)
BY_GRAM = rm.reconstruct(
    gram=(p := rm.datasets.circle(60, random_state=0)) @ p.T, dim=1
)


def test_gudhi_finds_the_homology(torus):
    tree = torus.to_gudhi()
    assert tree.dimension() == 2
    assert tree.num_vertices() == 400
    assert tree.num_simplices() == sum(torus.topology().num_simplices)
    assert {value for _, value in tree.get_simplices()} == {0.0}
    tree.compute_persistence(persistence_dim_max=True)
    assert tuple(tree.betti_numbers()) == torus.topology().betti_numbers == (1, 2, 1)


def test_gudhi_filtration_is_the_largest_value_of_the_vertices(torus):
    height = torus.vertices[:, 0]
    tree = torus.to_gudhi(height)
    for simplex, value in tree.get_simplices():
        assert value == height[simplex].max()
    pairs = tree.persistence(persistence_dim_max=True)
    # Standing upright the torus has four critical points: four essential classes.
    essential = [(k, b) for k, (b, d) in pairs if d == np.inf]
    assert sorted(k for k, _ in essential) == [0, 1, 1, 2]
    assert min(essential) == (0, height.min())
    assert max(essential) == (2, pytest.approx(height.max(), abs=1e-12))


def test_gudhi_without_coordinates_and_in_any_dimension():
    assert BY_GRAM.to_gudhi().num_simplices() == 120
    complex = rm.SimplicialComplex(np.eye(6), [[0, 1, 2, 3, 4]])
    assert complex.to_gudhi().num_simplices() == 31


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (np.zeros(3), r"must hold 4 numbers, one for each vertex, got float64 \(3,\)"),
        (["a"] * 4, "must hold 4 numbers"),
        ([0, 1, np.nan, 2], r"filtration\[2\] is nan"),
    ],
)
def test_gudhi_refuses_other_functions(values, message):
    with pytest.raises(ValueError, match=message):
        EDGES.to_gudhi(values)


def test_trimesh_is_oriented_and_keeps_all_vertices(torus):
    mesh = torus.to_trimesh(torus.fields())
    assert isinstance(mesh, trimesh.Trimesh)
    np.testing.assert_array_equal(mesh.vertices, torus.vertices)
    np.testing.assert_array_equal(mesh.faces, torus.simplices)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0  # outward
    assert mesh.euler_number == 0
    np.testing.assert_array_equal(mesh.vertex_attributes["boundary"], torus.boundary)
    flat = rm.SimplicialComplex([[0, 0], [1, 0], [0, 1], [5, 5]], [[0, 1, 2]])
    mesh = flat.to_trimesh()
    assert mesh.vertices.shape == (4, 3)
    assert mesh.area == pytest.approx(0.5)
    mesh.vertices[0] = 7  # a copy
    assert flat.vertices[0, 0] == 0


def test_pyvista(torus):
    pyvista = pytest.importorskip("pyvista")
    mesh = torus.to_pyvista({"height": torus.vertices[:, 2]})
    assert isinstance(mesh, pyvista.PolyData)
    assert (mesh.n_points, mesh.n_cells) == (400, 800)
    np.testing.assert_array_equal(mesh.points, torus.vertices)
    np.testing.assert_array_equal(mesh.regular_faces, torus.simplices)
    np.testing.assert_array_equal(mesh.point_data["height"], torus.vertices[:, 2])
    assert mesh.n_open_edges == 0
    lines = EDGES.to_pyvista()
    assert lines.lines.tolist() == [2, 0, 1, 2, 2, 1]
    assert lines.n_points == 4
    assert lines.n_cells == 2
    grid = TETRAHEDRA.to_pyvista()
    assert isinstance(grid, pyvista.UnstructuredGrid)
    np.testing.assert_array_equal(grid.cells_dict[10], TETRAHEDRA.simplices)


@pytest.mark.parametrize("complex", [EDGES, TETRAHEDRA])
def test_meshio_and_back(complex):
    mesh = complex.to_meshio({"number": np.arange(complex.num_vertices)})
    assert isinstance(mesh, meshio.Mesh)
    assert mesh.point_data["number"].tolist() == [*range(complex.num_vertices)]
    back = rm.SimplicialComplex.from_meshio(mesh)
    np.testing.assert_array_equal(back.vertices, complex.vertices)
    np.testing.assert_array_equal(back.simplices, complex.simplices)


def test_meshio_with_cells_of_many_kinds():
    points = np.random.default_rng(0).normal(size=(5, 3))
    cells = [("line", [[0, 1]]), ("triangle", [[0, 1, 2]]), ("vertex", [[0]])]
    cells += [("triangle", [[1, 2, 3]]), ("quad", [[0, 1, 2, 3]])]
    mesh = meshio.Mesh(points, [(kind, np.array(data)) for kind, data in cells])
    found = rm.SimplicialComplex.from_meshio(mesh)
    assert found.simplices.tolist() == [[0, 1, 2], [1, 2, 3]]
    found = rm.SimplicialComplex.from_meshio(mesh, dim=1)
    assert found.simplices.tolist() == [[0, 1]]
    with pytest.raises(
        ValueError, match="no tetrahedra, its cells are: line, quad, tr"
    ):
        rm.SimplicialComplex.from_meshio(mesh, dim=3)
    with pytest.raises(
        ValueError, match="mesh has no simplices, its cells are: vertex"
    ):
        interoperability.from_meshio(meshio.Mesh(points, [("vertex", [[0]])]))


def test_networkx_has_positions_and_lengths(torus):
    graph = torus.to_networkx()
    assert graph.number_of_nodes() == 400
    assert sorted(map(sorted, graph.edges)) == torus.edges.tolist()
    for i, j, length in graph.edges.data("length"):
        ends = torus.vertices[[i, j]]
        assert length == pytest.approx(np.linalg.norm(ends[0] - ends[1]))
    np.testing.assert_array_equal(graph.nodes[7]["pos"], torus.vertices[7])
    assert nx.is_connected(graph)
    assert nx.number_connected_components(EDGES.to_networkx()) == 2
    without = BY_GRAM.to_networkx()
    assert without.number_of_edges() == 60
    assert without.nodes[0] == {}
    points = rm.datasets.circle(60, random_state=0)
    for i, j, length in without.edges.data("length"):
        assert length == pytest.approx(np.linalg.norm(points[i] - points[j]))
        assert length == BY_GRAM.to_scipy_graph()[i, j]


def test_networkx_has_attributes():
    labels, colors = [4, 5, 6], np.arange(9).reshape(3, 3)
    path = rm.SimplicialComplex(
        np.eye(3),
        [[0, 1], [1, 2]],
        vertex_attributes={"label": labels, "colors": colors},
    )
    nodes = path.to_networkx().nodes
    assert [nodes[i]["label"] for i in range(3)] == labels
    np.testing.assert_array_equal(nodes[1]["colors"], colors[1])
    assert path.to_networkx(None).nodes[0].keys() == {"pos"}
    own = path.to_networkx({"height": [0.5, 1.5, 2.5]}).nodes
    assert [own[i]["height"] for i in range(3)] == [0.5, 1.5, 2.5]
    with pytest.raises(ValueError, match="'pos' is the name of the coordinates"):
        path.to_networkx({"pos": [1, 2, 3]})


def test_scipy_graph(torus):
    graph = torus.to_scipy_graph()
    assert graph.shape == (400, 400)
    assert (abs(graph - graph.T)).max() == 0
    assert graph.nnz == 2 * len(torus.edges)
    assert connected_components(graph)[0] == 1
    lengths = nx.single_source_dijkstra_path_length(
        torus.to_networkx(), 0, weight="length"
    )
    found = dijkstra(graph, indices=0)
    np.testing.assert_allclose(found, [lengths[i] for i in range(400)])


def test_edges_of_length_zero_are_stored():
    complex = rm.SimplicialComplex([[1.0], [1.0], [2.0]], [[0, 1], [1, 2]])
    graph = rm.edge_graph(complex)
    assert graph.nnz == 4
    assert graph[0, 1] == 0


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (EDGES.to_trimesh, "trimesh has no edges, only triangles"),
        (TETRAHEDRA.to_trimesh, "trimesh has no tetrahedra, only triangles"),
        (
            rm.SimplicialComplex(np.eye(4), [[0, 1, 2]]).to_trimesh,
            "trimesh shows three coordinates, the complex has 4: project",
        ),
        (
            rm.SimplicialComplex(np.eye(4), [[0, 1, 2]]).to_pyvista,
            "PyVista shows three coordinates",
        ),
        (
            rm.SimplicialComplex(np.eye(5), [[0, 1, 2, 3, 4]]).to_meshio,
            "meshio has no simplices of dimension 4",
        ),
        (BY_GRAM.to_pyvista, "no coordinates, only inner products"),
        (BY_GRAM.to_meshio, "no coordinates, only inner products"),
        (
            lambda: TETRAHEDRA.to_pyvista({"a": np.zeros(5)}),
            r"fields\['a'\] has shape \(5,\), expected \(6,\)",
        ),
    ],
)
def test_what_cannot_be(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_four_coordinates_where_there_is_room(torus4):
    assert torus4.to_meshio().points.shape == (300, 4)
    assert torus4.to_networkx().number_of_edges() == len(torus4.edges)


@pytest.mark.parametrize(
    ("module", "extra", "call"),
    [
        ("trimesh", "mesh", rm.SimplicialComplex(np.eye(3), [[0, 1, 2]]).to_trimesh),
        ("pyvista", "mesh", EDGES.to_pyvista),
        ("networkx", "graph", EDGES.to_networkx),
        ("scipy.sparse", "graph", EDGES.to_scipy_graph),
        ("scipy.sparse", "graph", EDGES.to_scipy),
        ("open3d", "open3d", EDGES.to_open3d),
    ],
)
def test_packages_that_are_not_installed(monkeypatch, module, extra, call):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=rf"pip install remanifold\[{extra}\]"):
        call()


# --- Back again ---------------------------------------------------------------------


def assert_same_complex(one, other):
    np.testing.assert_array_equal(one.vertices, other.vertices)
    np.testing.assert_array_equal(one.simplices, other.simplices)


def test_trimesh_and_back(torus):
    heat = {"heat": np.arange(400)}
    back = interoperability.from_trimesh(torus.to_trimesh(heat))
    assert_same_complex(torus, back)
    np.testing.assert_array_equal(back.vertex_attributes["heat"], heat["heat"])


def test_pyvista_and_back(torus):
    pytest.importorskip("pyvista")
    for complex in (torus, TETRAHEDRA):
        heat = {"heat": np.arange(float(complex.num_vertices))}
        back = interoperability.from_pyvista(complex.to_pyvista(heat))
        assert_same_complex(complex, back)
        np.testing.assert_array_equal(back.vertex_attributes["heat"], heat["heat"])
    space = rm.SimplicialComplex(np.eye(3), [[0, 1], [1, 2]])
    assert_same_complex(space, interoperability.from_pyvista(space.to_pyvista()))
    with pytest.raises(ValueError, match="no tetrahedra, only triangles"):
        interoperability.from_pyvista(torus.to_pyvista(), dim=3)


RGBA = np.random.default_rng(3).integers(0, 256, (400, 4)).astype(np.uint8)


def test_attributes_go_along(torus, open3d):  # noqa: ARG001
    """Colors as each library shows them, without being named again."""
    normals = torus.vertex_normals
    known = {"colors": RGBA, "heat": np.arange(400), "normals": normals}
    own = rm.SimplicialComplex(torus.vertices, torus.simplices, vertex_attributes=known)
    mesh = own.to_trimesh()
    np.testing.assert_array_equal(mesh.visual.vertex_colors, RGBA)
    np.testing.assert_array_equal(mesh.vertex_normals, normals)
    np.testing.assert_array_equal(mesh.vertex_attributes["heat"], np.arange(400))
    assert {*own.to_meshio().point_data} == {*known}
    np.testing.assert_allclose(own.to_open3d().vertex_colors, RGBA[:, :3] / 255)
    for bare in (own.to_trimesh(None), own.to_meshio(None), own.to_open3d(None)):
        assert len(getattr(bare, "vertex_attributes", ())) == 0
        assert len(getattr(bare, "point_data", ())) == 0
    assert len(own.to_open3d(None).vertex_colors) == 0
    del mesh.vertex_attributes["colors"]
    back = interoperability.from_trimesh(mesh).vertex_attributes
    np.testing.assert_array_equal(back["colors"], RGBA)
    wide = rm.SimplicialComplex(
        torus.vertices,
        torus.simplices,
        vertex_attributes={"colors": RGBA[:, :3].astype(np.uint16) * 256},
    )
    np.testing.assert_array_equal(
        wide.to_trimesh().visual.vertex_colors[:, :3], RGBA[:, :3]
    )
    np.testing.assert_allclose(wide.to_open3d().vertex_colors, RGBA[:, :3] / 255)
    pytest.importorskip("pyvista")
    data = wide.to_pyvista().point_data
    assert data["colors"].dtype == np.uint8
    np.testing.assert_array_equal(data["colors"], RGBA[:, :3])
    assert len(wide.to_pyvista(None).point_data) == 0
    with pytest.raises(ValueError, match="fields is 'all', expected one of 'auto'"):
        own.to_pyvista("all")


def test_networkx_and_back(torus):
    knot = rm.reconstruct(rm.datasets.trefoil(60, random_state=0), 1)
    back = interoperability.from_networkx(knot.to_networkx())
    np.testing.assert_array_equal(back.vertices, knot.vertices)
    assert back.simplices.tolist() == knot.edges.tolist()
    graph = torus.to_networkx()
    del graph.nodes[3]["pos"]
    with pytest.raises(ValueError, match="node 3 has no position"):
        interoperability.from_networkx(graph)


def test_gudhi_and_back(torus):
    back = interoperability.from_gudhi(torus.to_gudhi(), torus.vertices)
    np.testing.assert_array_equal(back.simplices, np.sort(torus.simplices, axis=1))


class Vectors(np.ndarray):
    """What Open3D's Vector3dVector and its like are to their users."""

    def __new__(cls, values):
        return np.array(values).view(cls)


class Held:
    """Geometry of Open3D as far as its documentation says what it has."""

    def __init__(self, points, cells):
        self.vertex_colors, self.vertex_normals = Vectors([]), Vectors([])
        setattr(self, "points" if self.cells == "lines" else "vertices", points)
        setattr(self, self.cells, cells)


@pytest.fixture
def open3d(monkeypatch):
    """The package, or what stands for it where it is not installed."""
    try:
        import open3d
    except ImportError:
        from types import SimpleNamespace

        kinds = {"LineSet": "lines", "TriangleMesh": "triangles", "TetraMesh": "tetras"}
        geometry = {n: type(n, (Held,), {"cells": c}) for n, c in kinds.items()}
        names = ("Vector3dVector", *(f"Vector{n}iVector" for n in (2, 3, 4)))
        open3d = SimpleNamespace(
            geometry=SimpleNamespace(**geometry),
            utility=SimpleNamespace(**dict.fromkeys(names, Vectors)),
        )
        monkeypatch.setitem(sys.modules, "open3d", open3d)
    return open3d


def test_open3d_and_back(torus, open3d):
    colors = np.linspace(0, 255, 1200).reshape(400, 3).astype(np.uint8)
    fields = {"colors": colors, "normals": torus.vertex_normals, "heat": np.ones(400)}
    mesh = torus.to_open3d(fields)
    assert isinstance(mesh, open3d.geometry.TriangleMesh)
    back = interoperability.from_open3d(mesh)
    assert_same_complex(torus, back)
    np.testing.assert_allclose(back.vertex_attributes["colors"], colors / 255)
    np.testing.assert_array_equal(
        back.vertex_attributes["normals"], torus.vertex_normals
    )
    space = rm.SimplicialComplex(np.eye(3), [[0, 1], [1, 2]])
    for complex in (TETRAHEDRA, space):
        assert_same_complex(complex, interoperability.from_open3d(complex.to_open3d()))


def test_open3d_refuses(torus4, open3d):  # noqa: ARG001
    with pytest.raises(ValueError, match="Open3D shows three coordinates"):
        torus4.to_open3d()
    with pytest.raises(ValueError, match="Open3D has no simplices of dimension 4"):
        rm.SimplicialComplex(np.eye(5), [[0, 1, 2, 3, 4]]).to_open3d()


def test_scipy_has_the_homology(torus, torus4):
    klein = rm.reconstruct(rm.datasets.klein_bottle(200, random_state=0), 2)
    ball = rm.reconstruct(rm.datasets.ball(60, random_state=0), 3)
    for complex in (torus, torus4, klein, ball, EDGES, TETRAHEDRA):
        matrices = complex.to_scipy()
        assert len(matrices.boundaries) == complex.dim
        for lower, upper in zip(
            matrices.boundaries, matrices.boundaries[1:], strict=False
        ):
            assert abs(lower.astype(int) @ upper.astype(int)).sum() == 0
        if len(complex.simplices) > 500:  # the ranks are those of dense matrices
            continue
        # Over the rationals, which for these is over Z3.
        ranks = [np.linalg.matrix_rank(b.toarray()) for b in matrices.boundaries]
        counts = [len(s) for s in matrices.simplices]
        betti = [
            count - below - above
            for count, below, above in zip(
                counts, [0, *ranks], [*ranks, 0], strict=True
            )
        ]
        betti[0] -= complex.num_vertices - complex.topology().num_vertices
        assert tuple(betti) == complex.topology().betti_numbers_mod3


def test_scipy_keeps_orientation_and_order(torus):
    matrices = torus.to_scipy()
    np.testing.assert_array_equal(matrices.simplices[2], torus.simplices)
    np.testing.assert_array_equal(matrices.simplices[1], torus.edges)
    assert matrices.boundaries[1].sum(axis=1).any() == False
    cap = rm.reconstruct(rm.datasets.spherical_cap(300, random_state=0), 2)
    matrices = cap.to_scipy()
    rim = np.flatnonzero(matrices.boundaries[1].sum(axis=1))
    expected = np.sort(cap.boundary_complex().vertex_indices)
    np.testing.assert_array_equal(np.unique(matrices.simplices[1][rim]), expected)
    graph = torus.to_scipy_graph()
    assert abs(matrices.adjacency.astype(int)).sum() == 2 * len(cap.edges)
    assert (torus.to_scipy().adjacency != (graph != 0)).nnz == 0


def test_scipy_without_coordinates():
    assert BY_GRAM.to_scipy().boundaries[0].shape == (60, 60)
