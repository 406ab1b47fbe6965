# SPDX-License-Identifier: GPL-3.0-or-later
"""Complexes as objects of other libraries, and what theirs hold."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias

import numpy as np

from remanifold._base.colors import are_colors, byte_colors
from remanifold._base.validation import check_choice
from remanifold.complex.data import check_complex
from remanifold.complex.faces import boundary_operators
from remanifold.complex.graphs import edge_lengths
from remanifold.formats._mesh import simplex_name
from remanifold.formats.writing import check_fields

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold.complex.data import ComplexData

    Fields: TypeAlias = Literal["auto"] | Mapping[str, ArrayLike] | None

# Numbers of VTK's types of cells, and their names in meshio, by dimension.
_VTK_CELLS = {1: 3, 2: 5, 3: 10}
_MESHIO_CELLS = {0: "vertex", 1: "line", 2: "triangle", 3: "tetra"}


def to_gudhi(complex: ComplexData, filtration: ArrayLike | None = None) -> Any:
    """Simplex tree of GUDHI, with all faces.

    Parameters
    ----------
    complex : SimplicialComplex
        With coordinates or without.
    filtration : array_like of shape (N,), optional
        A function on the vertices; a simplex has the largest value of its vertices (the
        lower star filtration). By default all values are zero.

    Returns
    -------
    gudhi.SimplexTree
        Its vertices are those that the simplices use.

    Raises
    ------
    ValueError
        `filtration` is not a number for each vertex.
    """
    from gudhi import SimplexTree

    check_complex(complex)
    simplices = complex.simplices
    values = np.zeros(len(simplices))
    tree = SimplexTree()
    if filtration is None:
        # A copy: older releases refuse what cannot be written to.
        tree.insert_batch(np.array(simplices.T, order="C"), values)
        return tree
    heights = np.asarray(filtration)
    n = complex.num_vertices
    if heights.shape != (n,) or heights.dtype.kind not in "biuf":
        msg = (
            f"filtration must hold {n} numbers, one for each vertex, got "
            f"{heights.dtype} {heights.shape}"
        )
        raise ValueError(msg)
    heights = heights.astype(np.float64)
    if np.isnan(heights).any():
        msg = f"filtration[{int(np.isnan(heights).argmax())}] is nan"
        raise ValueError(msg)
    # No vertex begins after its simplices, so they start as low as can be.
    tree.insert_batch(
        np.array(simplices.T, order="C"), np.full(len(simplices), -np.inf)
    )
    for vertex in np.unique(simplices).tolist():
        tree.assign_filtration([vertex], heights[vertex])
    tree.make_filtration_non_decreasing()
    return tree


def to_trimesh(complex: ComplexData, fields: Fields = "auto") -> Any:
    """Triangles as an object of trimesh.

    Parameters
    ----------
    complex : SimplicialComplex
        Of dimension 2, in at most three coordinates, to which zeros are added.
    fields : "auto", None or mapping of str to array_like
        Values at the vertices, which become `vertex_attributes`. "auto": those of the
        complex. ``colors`` and ``normals`` of three numbers each are shown as well: they
        become ``visual.vertex_colors`` and ``vertex_normals``.

    Returns
    -------
    trimesh.Trimesh
        Vertices in their order, none merged, faces oriented as the simplices are.

    Raises
    ------
    ValueError
        Not triangles, or more than three coordinates.
    ImportError
        trimesh is not installed.
    """
    points = _space(complex, "trimesh", (2,))
    trimesh = _needed("trimesh", "mesh")
    known = _fields(complex, fields, len(points))
    colors, normals = known.get("colors"), known.get("normals")
    return trimesh.Trimesh(
        vertices=points,
        faces=complex.simplices.astype(np.int64),
        vertex_attributes=known or None,
        vertex_colors=(
            byte_colors(colors) if colors is not None and are_colors(colors) else None
        ),
        vertex_normals=normals if _are_vectors(normals) else None,
        process=False,
    )


def to_pyvista(complex: ComplexData, fields: Fields = "auto") -> Any:
    """Edges, triangles or tetrahedra as an object of PyVista.

    Parameters
    ----------
    complex : SimplicialComplex
        Of dimension up to 3, in at most three coordinates, to which zeros are added.
    fields : "auto", None or mapping of str to array_like
        Values at the vertices, which become `point_data`. "auto": the complex's
        `vertex_attributes`. ``colors`` are bytes there, as VTK has them:
        ``mesh.plot(scalars="colors", rgb=True)`` shows them.

    Returns
    -------
    pyvista.PolyData or pyvista.UnstructuredGrid
        The latter for tetrahedra.

    Raises
    ------
    ValueError
        Simplices of more than three dimensions, or more than three coordinates.
    ImportError
        PyVista is not installed.
    """
    points = _space(complex, "PyVista", (1, 2, 3))
    values = _fields(complex, fields, len(points))
    pyvista = _needed("pyvista", "mesh")
    count, size = complex.simplices.shape
    cells = np.column_stack([np.full(count, size), complex.simplices]).ravel()
    if complex.dim == 3:
        types = np.full(count, _VTK_CELLS[3], dtype=np.uint8)
        mesh = pyvista.UnstructuredGrid(cells, types, points)
    elif complex.dim == 2:
        mesh = pyvista.PolyData(points, faces=cells)
    else:
        mesh = pyvista.PolyData(points, lines=cells)
    for name, array in values.items():
        shown = name == "colors" and are_colors(array)
        mesh.point_data[name] = byte_colors(array) if shown else array
    return mesh


def to_meshio(complex: ComplexData, fields: Fields = "auto") -> Any:
    """Edges, triangles or tetrahedra as a mesh of meshio.

    Parameters
    ----------
    complex : SimplicialComplex
        Of dimension up to 3, in any number of coordinates.
    fields : "auto", None or mapping of str to array_like
        Values at the vertices, which become `point_data`. "auto": the complex's
        `vertex_attributes`.

    Returns
    -------
    meshio.Mesh
        With one block of cells.

    Raises
    ------
    ValueError
        Simplices of more than three dimensions.
    """
    import meshio

    points = _coordinates(complex)
    _check_dim(complex, "meshio", tuple(_MESHIO_CELLS))
    cells = [(_MESHIO_CELLS[complex.dim], complex.simplices.copy())]
    values = _fields(complex, fields, len(points))
    return meshio.Mesh(points.copy(), cells, point_data=values)


def arrays_of_meshio(
    mesh: Any, dim: int | None = None
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Points and simplices, as `interoperability.from_meshio` describes them."""
    dims = {name: k for k, name in _MESHIO_CELLS.items() if k}
    blocks: dict[int, list[NDArray[np.int64]]] = {}
    for block in mesh.cells:
        if block.type in dims:
            cells = np.asarray(block.data, dtype=np.int64)
            blocks.setdefault(dims[block.type], []).append(cells)
    wanted = max(blocks, default=None) if dim is None else dim
    if wanted not in blocks:
        found = ", ".join(sorted({block.type for block in mesh.cells})) or "nothing"
        what = "simplices" if dim is None else simplex_name(dim)
        msg = f"mesh has no {what}, its cells are: {found}"
        raise ValueError(msg)
    simplices = np.vstack(blocks[wanted]).astype(np.int32)
    return np.asarray(mesh.points, dtype=np.float64), simplices


def to_networkx(complex: ComplexData, fields: Fields = "auto") -> Any:
    """Vertices and edges as a graph of NetworkX.

    Parameters
    ----------
    complex : SimplicialComplex
        With coordinates or without.
    fields : "auto", None or mapping of str to array_like
        Values at the vertices, (N,) or (N, C), kept at the nodes by their names: numbers,
        or arrays of C. By default the ``vertex_attributes`` of the complex.

    Returns
    -------
    networkx.Graph
        Nodes 0 to N - 1, each with its coordinates as ``pos`` where there are any, and
        the edges, each with its ``length``.

    Raises
    ------
    ValueError
        A field is called ``pos``.
    ImportError
        NetworkX is not installed.
    """
    check_complex(complex)
    networkx = _needed("networkx", "graph")
    graph = networkx.Graph()
    count = complex.num_vertices
    held: dict[str, list[Any]] = {}
    for name, values in _fields(complex, fields, count).items():
        if name == "pos":
            msg = "fields: 'pos' is the name of the coordinates; take another one"
            raise ValueError(msg)
        held[name] = values.tolist() if values.ndim == 1 else [*values]
    if complex.vertices is not None:
        held["pos"] = [*complex.vertices]
    graph.add_nodes_from(
        (i, {name: values[i] for name, values in held.items()}) for i in range(count)
    )
    lengths = edge_lengths(complex).tolist()
    graph.add_edges_from(
        (i, j, {"length": length})
        for (i, j), length in zip(complex.edges.tolist(), lengths, strict=True)
    )
    return graph


def to_open3d(complex: ComplexData, fields: Fields = "auto") -> Any:
    """Edges, triangles or tetrahedra as an object of Open3D.

    Parameters
    ----------
    complex : SimplicialComplex
        Of dimension up to 3, in at most three coordinates, to which zeros are added.
    fields : "auto", None or mapping of str to array_like
        Of these ``colors`` (numbers from 0 to 1, bytes, or of 16 bits) and ``normals``
        are taken, each of shape (N, 3), for triangles and tetrahedra; Open3D has no room
        for others. "auto": those of the complex's `vertex_attributes`.

    Returns
    -------
    open3d.geometry.LineSet, TriangleMesh or TetraMesh
        Vertices in their order, simplices as they are oriented.

    Raises
    ------
    ValueError
        Simplices of more than three dimensions, or more than three coordinates.
    ImportError
        Open3D is not installed.
    """
    points = _space(complex, "Open3D", (1, 2, 3))
    known = _fields(complex, fields, len(points))
    open3d = _needed("open3d", "open3d")
    utility, geometry = open3d.utility, open3d.geometry
    places = utility.Vector3dVector(points)
    cells = complex.simplices.astype(np.int32)
    if complex.dim == 1:
        return geometry.LineSet(places, utility.Vector2iVector(cells))
    if complex.dim == 2:
        mesh = geometry.TriangleMesh(places, utility.Vector3iVector(cells))
    else:
        mesh = geometry.TetraMesh(places, utility.Vector4iVector(cells))
    colors, normals = known.get("colors"), known.get("normals")
    if colors is not None and are_colors(colors):
        shares = colors[:, :3]
        if colors.dtype.kind != "f" or colors.max() > 1:
            shares = byte_colors(shares) / 255.0
        mesh.vertex_colors = utility.Vector3dVector(shares.astype(np.float64))
    if _are_vectors(normals):
        assert normals is not None
        mesh.vertex_normals = utility.Vector3dVector(normals.astype(np.float64))
    return mesh


def arrays_of_open3d(mesh: Any) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Points and simplices of an object of Open3D."""
    if hasattr(mesh, "lines"):
        return np.array(mesh.points, dtype=np.float64), _rows(mesh.lines, 2)
    cells = mesh.tetras if hasattr(mesh, "tetras") else mesh.triangles
    size = 4 if hasattr(mesh, "tetras") else 3
    return np.array(mesh.vertices, dtype=np.float64), _rows(cells, size)


def arrays_of_trimesh(mesh: Any) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Points and triangles of an object of trimesh."""
    return np.array(mesh.vertices, dtype=np.float64), _rows(mesh.faces, 3)


def arrays_of_pyvista(
    mesh: Any, dim: int | None = None
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Points and simplices, as `interoperability.from_pyvista` describes them."""
    grid = mesh if hasattr(mesh, "cells_dict") else mesh.cast_to_unstructured_grid()
    blocks = {k: grid.cells_dict.get(cell) for k, cell in _VTK_CELLS.items()}
    found = [k for k, cells in blocks.items() if cells is not None and len(cells)]
    wanted = max(found, default=None) if dim is None else dim
    if wanted not in found:
        what = "simplices" if dim is None else simplex_name(dim)
        have = ", ".join(simplex_name(k) for k in found) or "nothing of the kind"
        msg = f"mesh has no {what}, only {have}; triangulate() cuts polygons"
        raise ValueError(msg)
    return np.array(grid.points, dtype=np.float64), _rows(blocks[wanted], wanted + 1)


def arrays_of_networkx(
    graph: Any,
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Positions and edges, as `interoperability.from_networkx` describes them."""
    nodes = [*graph.nodes]
    lacking = [node for node in nodes if "pos" not in graph.nodes[node]]
    if lacking:
        msg = f"the node {lacking[0]!r} has no position: give each a 'pos'"
        raise ValueError(msg)
    number = {node: i for i, node in enumerate(nodes)}
    points = np.array([graph.nodes[node]["pos"] for node in nodes], dtype=np.float64)
    edges = [sorted((number[a], number[b])) for a, b in graph.edges]
    return points, _rows(sorted(edges), 2)


def arrays_of_gudhi(tree: Any) -> NDArray[np.int32]:
    """Simplices of the highest dimension of a simplex tree."""
    dim = tree.dimension()
    rows = [sorted(s) for s, _ in tree.get_skeleton(dim) if len(s) == dim + 1]
    return _rows(sorted(rows), dim + 1)


def _rows(cells: Any, size: int) -> NDArray[np.int32]:
    return np.array(cells, dtype=np.int32).reshape(-1, size)


class Matrices(NamedTuple):
    """A complex as sparse matrices.

    Attributes
    ----------
    adjacency : scipy.sparse.csr_array, shape (N, N), bool
        Symmetric; which vertices have an edge between them.
    boundaries : tuple of K scipy.sparse.csr_array of int8
        ``boundaries[k - 1]`` is the boundary operator from k-simplices to their faces,
        with entries 1 and -1: the product of each with the next is zero.
    simplices : tuple of K + 1 ndarray, shape (M_k, k+1), int32
        What rows and columns stand for. Vertices are all N; below K the faces of the
        simplices, sorted, oriented by ascending vertices; in K the simplices as they
        are, with their orientation.
    """

    adjacency: Any
    boundaries: tuple[Any, ...]
    simplices: tuple[NDArray[np.int32], ...]


def to_scipy(complex: ComplexData) -> Matrices:
    """Adjacency and boundary operators as sparse matrices of SciPy.

    Parameters
    ----------
    complex : SimplicialComplex
        With coordinates or without, of any dimension.

    Returns
    -------
    Matrices
        ``adjacency``, ``boundaries`` and the ``simplices`` that these are about.
        `edge_graph` has the lengths of the edges.

    Raises
    ------
    ImportError
        SciPy is not installed.

    Notes
    -----
    The sum of the columns of the last operator is the boundary of an oriented complex,
    zero where it is closed. Betti numbers are the dimensions of the homology: number of
    k-simplices less the ranks of the operators from and to them.
    """
    check_complex(complex)
    sparse = _needed("scipy.sparse", "graph")
    count = complex.num_vertices
    boundaries, levels = boundary_operators(complex.simplices, count)
    i, j = complex.edges.T
    pairs = (np.concatenate([i, j]), np.concatenate([j, i]))
    ones = np.ones(2 * len(i), dtype=np.bool_)
    adjacency = sparse.csr_array((ones, pairs), shape=(count, count))
    return Matrices(adjacency, boundaries, levels)


def _fields(
    complex: ComplexData, fields: Fields, count: int
) -> dict[str, NDArray[Any]]:
    """Values at the vertices: the complex's own, those that were given, or none."""
    if isinstance(fields, str):
        check_choice(fields, "fields", ("auto",))
        return complex.vertex_attributes
    return check_fields(fields, count)


def _are_vectors(values: NDArray[Any] | None) -> bool:
    return values is not None and values.ndim == 2 and values.shape[1] == 3


def _needed(module: str, extra: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError as error:
        msg = f"this needs {module}: pip install remanifold[{extra}]"
        raise ImportError(msg) from error


def _coordinates(complex: ComplexData) -> NDArray[np.float64]:
    check_complex(complex)
    if complex.vertices is None:
        msg = "complex has no coordinates, only inner products or distances"
        raise ValueError(msg)
    return complex.vertices


def _check_dim(complex: ComplexData, who: str, dims: tuple[int, ...]) -> None:
    if complex.dim not in dims:
        known = " or ".join(simplex_name(dim) for dim in dims)
        msg = f"{who} has no {simplex_name(complex.dim)}, only {known}"
        raise ValueError(msg)


def _space(
    complex: ComplexData, who: str, dims: tuple[int, ...]
) -> NDArray[np.float64]:
    """Vertices as points of R^3."""
    points = _coordinates(complex)
    _check_dim(complex, who, dims)
    if points.shape[1] > 3:
        msg = (
            f"{who} shows three coordinates, the complex has {points.shape[1]}: project "
            "its vertices first, as in rm.SimplicialComplex(vertices[:, :3], simplices)"
        )
        raise ValueError(msg)
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
