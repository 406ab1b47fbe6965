# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances along a complex."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Literal, TypeAlias, get_args

import numpy as np

from remanifold._base.validation import check_choice, check_index_array
from remanifold.calculus.operators import Operators
from remanifold.calculus.solving import factorized
from remanifold.complex import parts
from remanifold.complex.data import ComplexData
from remanifold.complex.graphs import edge_graph, edge_lengths

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

GeodesicMethod: TypeAlias = Literal["auto", "graph", "heat", "exact"]
METHODS: tuple[str, ...] = get_args(GeodesicMethod)
_Solver: TypeAlias = Callable[[int], "NDArray[np.float64]"]


def geodesic_distances(
    complex_: ComplexData, sources: ArrayLike, method: GeodesicMethod = "auto"
) -> NDArray[np.float64]:
    """Distances, as `SimplicialComplex.geodesic_distances` describes them."""
    check_choice(method, "method", METHODS)
    return Distances(complex_, method).from_sources(sources)


class Distances:
    """Distances from any vertices, with what they need made once for each component."""

    def __init__(self, complex_: ComplexData, method: GeodesicMethod) -> None:
        self._whole = complex_
        if complex_.vertices is None:
            complex_ = ComplexData(complex_.coordinates, complex_.simplices)
        self._complex = complex_
        if method == "auto":
            method = "graph" if complex_.dim < 2 else "heat"
        self._make: Callable[[ComplexData], _Solver] | None = None
        if method == "graph" or complex_.dim < 2:  # edges are all that there is
            return
        surface_in_space = complex_.dim == 2 and (complex_.ambient_dim or 9) <= 3
        if method == "heat":
            self._make = _heat_in_space if surface_in_space else _heat
        elif surface_in_space:
            self._make = _exact
        else:
            msg = (
                'method="exact" is for curves, and surfaces in at most three '
                'coordinates; use "heat" or "graph"'
            )
            raise ValueError(msg)
        self._solvers: dict[int, _Solver] = {}

    @functools.cached_property
    def _parts(self) -> list[parts.Part]:
        return parts.components(self._complex)

    def from_sources(self, sources: ArrayLike) -> NDArray[np.float64]:
        """From each vertex to all, (S, N); infinite where no path leads."""
        indices = _check_sources(self._whole, sources)
        if self._make is None:
            return _along_edges(self._complex, indices)
        distances = np.full((len(indices), self._complex.num_vertices), np.inf)
        labels = self._complex.component_labels()
        for row, source in enumerate(indices):
            label = int(labels[source])
            part = self._parts[label]
            if label not in self._solvers:
                self._solvers[label] = self._make(part)
            own = part.vertex_indices
            away = self._solvers[label](int(np.searchsorted(own, source)))
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
        from scipy.sparse import diags
    except ImportError as error:
        msg = "the heat method needs SciPy: pip install remanifold[geodesic]"
        raise ImportError(msg) from error
    operators = Operators(part)
    count = part.num_vertices
    if not operators.used.all() or operators.labels.max() > 0:
        msg = (
            "the heat method has no solution: a vertex is in simplices without volume "
            'only, or only these connect it; use method="graph"'
        )
        raise ValueError(msg)
    stiffness = operators.stiffness
    time = float(np.mean(edge_lengths(part))) ** 2
    flow = factorized(diags(operators.volumes) + time * stiffness)
    # Up to a constant: the first vertex stays at zero.
    potential = factorized(stiffness[1:, 1:])

    def solve(source: int) -> NDArray[np.float64]:
        start = np.zeros(count)
        start[source] = 1.0
        slopes = -operators.frame_gradients(flow(start))
        # Far away heat is too small to be squared.
        slopes /= np.maximum(np.abs(slopes).max(axis=1, keepdims=True), 1e-300)
        lengths = np.linalg.norm(slopes, axis=1, keepdims=True)
        slopes /= np.where(lengths > 0, lengths, 1.0)
        away = np.zeros(count)
        away[1:] = potential(operators.weak_divergence(slopes)[1:])
        return _from_source(away, source)

    return solve


def _from_source(potential: NDArray[np.float64], source: int) -> NDArray[np.float64]:
    """Turn a potential into distances."""
    distances: NDArray[np.float64] = np.maximum(potential - potential[source], 0.0)
    return distances
