# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances along a complex."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Literal, TypeAlias, get_args

import numpy as np

from remanifold import _core
from remanifold._base.validation import check_choice, check_index_array
from remanifold.calculus.delaunay import DelaunayOperators
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
# Up to here distances are exact by default: vertices squared times sources. It is what
# windows take, about two seconds.
_EXACT_WORK = 5e8
# How often heat distances are found again from the directions of their gradients: the
# second time changes tetrahedra by a tenth of what the first does, and triangles hardly.
_AGAIN = 2


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
        self._method = method
        self._solvers: dict[int, _Solver] = {}
        if method == "exact" and complex_.dim > 2:
            msg = (
                'method="exact" is for curves and surfaces; use "heat" or "graph" for '
                f"dimension {complex_.dim}"
            )
            raise ValueError(msg)

    @functools.cached_property
    def _complex(self) -> ComplexData:
        """With coordinates."""
        whole = self._whole
        if whole.vertices is not None:
            return whole
        return ComplexData(whole.coordinates, whole.simplices)

    @functools.cached_property
    def _parts(self) -> list[parts.Part]:
        return parts.components(self._complex)

    @functools.cached_property
    def _sides(self) -> NDArray[np.float64]:
        """Lengths of the edges opposite to the vertices of the triangles, (M, 3)."""
        rows, source = self._whole.simplices, self._whole._source
        pairs = ((rows[:, (i + 1) % 3], rows[:, (i + 2) % 3]) for i in range(3))
        squares = [source.squared_distances(i, j) for i, j in pairs]
        return np.sqrt(np.stack(squares, axis=1))

    def from_sources(
        self, sources: ArrayLike, planned: int | None = None
    ) -> NDArray[np.float64]:
        """From each vertex to all, (S, N); infinite where no path leads.

        As many as are planned in all, now or later, say what can be afforded.
        """
        indices = _check_sources(self._whole, sources)
        method = self.method_for(max(planned or 0, len(indices)))
        if method == "graph" or self._whole.dim < 2:  # edges are all that there is
            return _along_edges(self._complex, indices)
        if method == "exact":
            return self._exact(indices)
        distances = np.full((len(indices), self._complex.num_vertices), np.inf)
        labels = self._complex.component_labels()
        for row, source in enumerate(indices):
            label = int(labels[source])
            part = self._parts[label]
            if label not in self._solvers:
                self._solvers[label] = _heat(part)
            own = part.vertex_indices
            away = self._solvers[label](int(np.searchsorted(own, source)))
            distances[row, own] = away
        return distances

    def method_for(self, count: int) -> GeodesicMethod:
        """What distances from so many vertices are computed by."""
        return self._affordable(count) if self._method == "auto" else self._method

    def _affordable(self, count: int) -> GeodesicMethod:
        whole = self._whole
        if whole.dim < 2:
            return "graph"
        cheap = float(whole.num_vertices) ** 2 * max(count, 1) <= _EXACT_WORK
        return "exact" if whole.dim == 2 and cheap and self._manifold else "heat"

    @functools.cached_property
    def _manifold(self) -> bool:
        return self._whole.topology().manifold

    def _exact(self, sources: NDArray[np.int32]) -> NDArray[np.float64]:
        """By windows on the edges; they follow from lengths, whatever the coordinates."""
        whole = self._whole
        if not self._manifold:
            labels = whole.component_labels()
            for label in np.unique(labels[sources]):
                if not whole.topology(int(label)).manifold:
                    msg = (
                        'method="exact" is for manifolds, and this complex is none, see '
                        'topology(); use "heat" or "graph"'
                    )
                    raise ValueError(msg)
        return _core.surface_distances(
            np.ascontiguousarray(whole.simplices),
            self._sides,
            whole.num_vertices,
            sources,
        )


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


def _heat(part: ComplexData) -> _Solver:
    """Heat method of Crane, Weischedel and Wardetzky on linear elements, for any K, D.

    On surfaces by intrinsic Delaunay triangles. Three things are not as published. Where
    heat meets the boundary at an angle its slope across is between none and that of heat
    that flows out: half of it is in the equation, instead of the mean of two solutions.
    Directions of the gradients of heat scatter, which makes distances too short by their
    mean cosine: those of the distances found hardly do, and from them distances are found
    again. And at the source, where no gradient is right, the edges are.
    """
    try:
        from scipy.sparse import diags
    except ImportError as error:
        msg = "the heat method needs SciPy: pip install remanifold[geodesic]"
        raise ImportError(msg) from error
    if part.dim == 2:
        operators: Operators = (flipped := DelaunayOperators(part))
        rows, sides = flipped.simplices, flipped.lengths
        ends = np.concatenate([rows[:, [i, i - 1]] for i in range(3)])
        lengths = np.concatenate([sides[:, i - 2] for i in range(3)])
    else:
        operators = Operators(part)
        ends, lengths = part.edges, edge_lengths(part)
    count = part.num_vertices
    if not operators.used.all() or operators.labels.max() > 0:
        msg = (
            "the heat method has no solution: a vertex is in simplices without volume "
            'only, or only these connect it; use method="graph"'
        )
        raise ValueError(msg)
    stiffness = operators.stiffness
    time = float(np.mean(lengths)) ** 2
    kept = operators.volumes + np.sqrt(time) / 2 * _boundary_shares(part)
    flow = factorized(diags(kept) + time * stiffness)
    # Up to a constant: the first vertex stays at zero.
    potential = factorized(stiffness[1:, 1:])

    def along(slopes: NDArray[np.float64]) -> NDArray[np.float64]:
        """The function whose gradients come nearest to these directions."""
        # Far away heat is too small to be squared.
        slopes /= np.maximum(np.abs(slopes).max(axis=1, keepdims=True), 1e-300)
        sizes = np.linalg.norm(slopes, axis=1, keepdims=True)
        slopes /= np.where(sizes > 0, sizes, 1.0)
        away = np.zeros(count)
        away[1:] = potential(operators.weak_divergence(slopes)[1:])
        return away

    def solve(source: int) -> NDArray[np.float64]:
        start = np.zeros(count)
        start[source] = 1.0
        away = along(-operators.frame_gradients(flow(start)))
        for _ in range(_AGAIN):
            away = along(operators.frame_gradients(away))
        near = np.full(count, np.inf)
        for column in range(2):
            own = ends[:, column] == source
            np.minimum.at(near, ends[own, 1 - column], lengths[own])
        near[source] = np.inf
        beside = np.flatnonzero(np.isfinite(near))
        away += (near[beside] - away[beside]).mean()
        away = np.maximum(away, 0.0)
        away[beside] = near[beside]
        away[source] = 0.0
        return away

    return solve


def _boundary_shares(part: ComplexData) -> NDArray[np.float64]:
    """Share of each vertex in the (K-1)-volume of the boundary, (N,)."""
    faces = parts.open_faces(part.simplices)
    if len(faces) == 0:
        return np.zeros(part.num_vertices)
    return Operators(ComplexData(part.coordinates, faces)).volumes
