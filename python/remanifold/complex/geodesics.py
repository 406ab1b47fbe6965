# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances along a complex."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

import numpy as np

from remanifold._base.validation import check_choice, check_index_array
from remanifold.complex import parts
from remanifold.complex.data import ComplexData
from remanifold.complex.graphs import edge_graph, edge_lengths
from remanifold.complex.projection import edge_triangles, simplex_volumes

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

GeodesicMethod: TypeAlias = Literal["auto", "graph", "heat", "exact"]
METHODS: tuple[str, ...] = get_args(GeodesicMethod)
# Smallest singular value of a simplex that has gradients, over its largest.
_FLAT = 1e-10
_Solver: TypeAlias = Callable[[int], "NDArray[np.float64]"]


def geodesic_distances(
    complex_: ComplexData, sources: ArrayLike, method: GeodesicMethod = "auto"
) -> NDArray[np.float64]:
    """Distances, as `SimplicialComplex.geodesic_distances` describes them."""
    check_choice(method, "method", METHODS)
    indices = _check_sources(complex_, sources)
    if complex_.vertices is None:
        complex_ = ComplexData(complex_.coordinates, complex_.simplices)
    if method == "auto":
        method = "graph" if complex_.dim < 2 else "heat"
    if method == "graph" or complex_.dim < 2:  # edges are all that there is
        return _along_edges(complex_, indices)
    surface_in_space = complex_.dim == 2 and (complex_.ambient_dim or 9) <= 3
    make: Callable[[ComplexData], _Solver]
    if method == "exact":
        if not surface_in_space:
            msg = (
                'method="exact" is for curves, and surfaces in at most three '
                'coordinates; use "heat" or "graph"'
            )
            raise ValueError(msg)
        make = _exact
    else:
        make = _heat_in_space if surface_in_space else _heat
    distances = np.full((len(indices), complex_.num_vertices), np.inf)
    labels = complex_.component_labels()
    wanted = labels[indices]
    for label, part in enumerate(parts.components(complex_)):
        if label not in wanted:
            continue
        solve = make(part)
        own = part.vertex_indices
        for row in np.flatnonzero(wanted == label):
            away = solve(int(np.searchsorted(own, indices[row])))
            distances[row, own] = away
    return distances


def _check_sources(complex_: ComplexData, sources: ArrayLike) -> NDArray[np.int32]:
    indices: NDArray[np.int32] = check_index_array(
        np.atleast_1d(np.asarray(sources)), "sources", np.int32
    )
    count = complex_.num_vertices
    outside = (indices < 0) | (indices >= count)
    if outside.any():
        place = int(outside.argmax())
        msg = f"sources[{place}] is {indices[place]}, expected 0 to {count - 1}"
        raise ValueError(msg)
    unused = ~np.isin(indices, complex_.simplices)
    if unused.any():
        place = int(unused.argmax())
        msg = (
            f"sources[{place}] is vertex {indices[place]}, which is in no simplex: "
            "no other vertex can be reached from there"
        )
        raise ValueError(msg)
    return indices


def _along_edges(
    complex_: ComplexData, sources: NDArray[np.int32]
) -> NDArray[np.float64]:
    try:
        from scipy.sparse.csgraph import dijkstra
    except ImportError as error:
        msg = "distances along edges need SciPy: pip install remanifold[geodesic]"
        raise ImportError(msg) from error
    graph = edge_graph(complex_)
    if len(sources) == 0:
        return np.empty((0, complex_.num_vertices))
    distances: NDArray[np.float64] = dijkstra(graph, directed=False, indices=sources)
    return distances


def _positions(part: ComplexData) -> NDArray[np.float64]:
    """Three coordinates."""
    vertices = part.coordinates
    return np.pad(vertices, [(0, 0), (0, 3 - vertices.shape[1])])


def _heat_in_space(part: ComplexData) -> _Solver:
    """Heat method on the intrinsic Delaunay triangulation, by geometry-central."""
    try:
        import potpourri3d
    except ImportError as error:
        msg = (
            "the heat method on surfaces in space needs potpourri3d: pip install "
            "remanifold[geodesic]"
        )
        raise ImportError(msg) from error
    solver = potpourri3d.MeshHeatMethodDistanceSolver(
        _positions(part), np.asarray(part.simplices, dtype=np.int64)
    )

    def solve(source: int) -> NDArray[np.float64]:
        away = np.asarray(solver.compute_distance(source), dtype=np.float64)
        return _from_source(away, source)

    return solve


def _exact(part: ComplexData) -> _Solver:
    """Exact distances by windows on the edges (Mitchell, Mount, Papadimitriou)."""
    try:
        from pygeodesic.geodesic import PyGeodesicAlgorithmExact
    except ImportError as error:
        msg = "exact distances need pygeodesic: pip install remanifold[geodesic]"
        raise ImportError(msg) from error
    if not part.topology().manifold:  # pygeodesic crashes, or stops at such places
        msg = (
            'method="exact" is for manifolds, and this complex is none, see topology(); '
            'use "heat" or "graph"'
        )
        raise ValueError(msg)
    algorithm = PyGeodesicAlgorithmExact(_positions(part), part.simplices)

    def solve(source: int) -> NDArray[np.float64]:
        away, _ = algorithm.geodesicDistances(np.array([source]), None)
        return np.asarray(away, dtype=np.float64)

    return solve


def _heat(part: ComplexData) -> _Solver:
    """Heat method of Crane, Weischedel and Wardetzky on linear elements, for any K, D."""
    try:
        from scipy.sparse import csc_matrix, diags
        from scipy.sparse.linalg import splu
    except ImportError as error:
        msg = "the heat method needs SciPy: pip install remanifold[geodesic]"
        raise ImportError(msg) from error
    cells, count = part.simplices, part.num_vertices
    gradients, volumes = _gradients(part)
    stiffness_of = np.einsum("m,mik,mjk->mij", volumes, gradients, gradients)
    arity = cells.shape[1]
    rows = np.repeat(cells, arity, axis=1).ravel()
    columns = np.tile(cells, (1, arity)).ravel()
    stiffness = csc_matrix((stiffness_of.ravel(), (rows, columns)), (count, count))
    mass = np.bincount(
        cells.ravel(), np.repeat(volumes / arity, arity), minlength=count
    )
    time = float(np.mean(edge_lengths(part))) ** 2
    try:
        flow = splu((diags(mass) + time * stiffness).tocsc())
        # Up to a constant: the first vertex stays at zero.
        potential = splu(stiffness[1:, 1:].tocsc()) if count > 1 else None
    except RuntimeError as error:
        msg = (
            "the heat method has no solution: a vertex is in simplices without volume "
            'only; use method="graph"'
        )
        raise ValueError(msg) from error

    def solve(source: int) -> NDArray[np.float64]:
        start = np.zeros(count)
        start[source] = 1.0
        heat: NDArray[np.float64] = flow.solve(start)
        slopes = -np.einsum("mi,mik->mk", heat[cells], gradients)
        # Far away heat is too small to be squared.
        slopes /= np.maximum(np.abs(slopes).max(axis=1, keepdims=True), 1e-300)
        lengths = np.linalg.norm(slopes, axis=1, keepdims=True)
        slopes /= np.where(lengths > 0, lengths, 1.0)
        sums = volumes[:, None] * np.einsum("mik,mk->mi", gradients, slopes)
        divergence = np.bincount(cells.ravel(), sums.ravel(), minlength=count)
        away = np.zeros(count)
        if potential is not None:
            away[1:] = potential.solve(divergence[1:])
        return _from_source(away, source)

    return solve


def _from_source(potential: NDArray[np.float64], source: int) -> NDArray[np.float64]:
    """Turn a potential into distances."""
    distances: NDArray[np.float64] = np.maximum(potential - potential[source], 0.0)
    return distances


def _gradients(
    part: ComplexData,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Gradients of the barycentric coordinates, (M, K+1, K), and volumes."""
    size, dim = len(part.simplices), part.dim
    gradients = np.zeros((size, dim + 1, dim))
    for rows, triangles in edge_triangles(part):
        dual: Any = np.linalg.pinv(triangles, rcond=_FLAT)
        gradients[rows, 1:, : triangles.shape[1]] = dual
    gradients[:, 0] = -gradients[:, 1:].sum(axis=1)
    return gradients, simplex_volumes(part)
