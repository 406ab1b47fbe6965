# SPDX-License-Identifier: GPL-3.0-or-later
"""Shortest paths, cells around sites, means and logarithms, from distances along a complex."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line, rounded
from remanifold.calculus.curvature import fit_at
from remanifold.calculus.solving import scipy_module
from remanifold.complex.embedding import farthest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.calculus.geodesics import Distances
    from remanifold.calculus.operators import Operators
    from remanifold.complex.data import ComplexData

    Floats = NDArray[np.float64]

# Vertices that a path may pass: no farther from both ends together than the way along the
# edges, which is too long by about a tenth, and so much besides.
_DETOUR = 1.2
_MORE_THAN_UNKNOWNS = 1  # sources of exact distances for a logarithm
_MOST_STEPS = 100_000_000  # between points on the edges of simplices, 60 bytes each
_RINGS = 2  # of vertices around a coarse path that a finer one may pass


class Polyline(NamedTuple):
    """Points on edges, from the start to the end.

    Attributes
    ----------
    edges : ndarray, shape (P, 2), int32
        Ends of the edge that each lies on; at a vertex that vertex twice.
    shares : ndarray, shape (P,), float64
        How far along the edge.
    """

    edges: NDArray[np.int32]
    shares: Floats


@dataclass(frozen=True, eq=False, repr=False)
class VoronoiCells(ReadOnlyArrays):
    """Which of some sites is nearest along a complex. Arrays are read-only.

    Attributes
    ----------
    sites : ndarray, shape (S,), int64
        Their vertices.
    labels : ndarray, shape (N,), int64
        Row of `sites` that is nearest to each vertex, the first of equals; -1 where no
        path leads to any.
    distances : ndarray, shape (N,), float64
        How far it is; infinite where there is none.
    volumes : ndarray, shape (S,), float64
        K-volume of each cell, by the shares of its vertices.
    """

    sites: NDArray[np.int64]
    labels: NDArray[np.int64]
    distances: Floats
    volumes: Floats

    def __repr__(self) -> str:
        return one_line(self, sites=len(self.sites), vertices=len(self.labels))


@dataclass(frozen=True, eq=False, repr=False)
class FrechetMean(ReadOnlyArrays):
    """The vertex with the least mean square of distances. Arrays are read-only.

    Attributes
    ----------
    vertex : int
        The lowest of those that have it.
    variance : float
        The mean square there.
    spread : ndarray, shape (N,), float64
        The mean square at each vertex; infinite where a sample cannot be reached.
    """

    vertex: int
    variance: float
    spread: Floats

    def __repr__(self) -> str:
        return one_line(self, vertex=self.vertex, variance=rounded(self.variance))


@dataclass(frozen=True, eq=False, repr=False)
class LogarithmMap(ReadOnlyArrays):
    """Where all vertices lie as seen from one. Arrays are read-only.

    Attributes
    ----------
    coordinates : ndarray, shape (N, K), float64
        Normal coordinates: in the direction in which the shortest path leaves, as far as
        it is long. NaN where no path leads.
    tangents : ndarray, shape (K, D), float64
        The tangent vectors that they refer to.
    vertex : int
        Where they are zero.
    """

    coordinates: Floats
    tangents: Floats
    vertex: int

    def __repr__(self) -> str:
        return one_line(self, vertex=self.vertex, vertices=len(self.coordinates))


def lengths_of(complex_: ComplexData) -> Floats:
    """Of the edges, also where no coordinates are known."""
    i, j = complex_.edges.T
    return np.sqrt(complex_._source.squared_distances(i, j))


def refined_path(
    complex_: ComplexData, start: int, end: int, points: int
) -> Polyline | None:
    """Shortest path through vertices and points on the edges; None where none leads.

    Points that share a simplex are joined by straight lines: with one point an edge
    near the shortest path along the edges, then with all of them near that path.

    Raises
    ------
    ValueError
        So many points that their steps would not fit.
    """
    csgraph = scipy_module("sparse.csgraph")
    count, edges = complex_.num_vertices, complex_.edges
    graph = _symmetric(lengths_of(complex_), edges, count)
    away = csgraph.dijkstra(graph, directed=False, indices=[start, end])
    if not np.isfinite(away[0, end]):
        return None
    limit = _DETOUR * away[0, end] + 2 * graph.data.max()
    simplices = np.sort(complex_.simplices, axis=1)
    near = simplices[(away.sum(axis=0) <= limit)[simplices].all(axis=1)]
    found = _through(complex_, near, start, end, min(points, 1))
    if points > 1:
        passed = np.zeros(count, dtype=np.bool_)
        passed[found.edges] = True
        for _ in range(_RINGS):
            passed[simplices[passed[simplices].any(axis=1)]] = True
        near = simplices[passed[simplices].all(axis=1)]
        found = _through(complex_, near, start, end, points)
    return found


def _through(
    complex_: ComplexData,
    near: NDArray[np.int32],
    start: int,
    end: int,
    points: int,
) -> Polyline:
    """Shortest path through these simplices; their vertices ascend."""
    count = complex_.num_vertices
    # Points of a simplex: its corners, and those on its edges, each a pair of corners
    # and how far along. On an edge they are numbered from its lower vertex on.
    corners = near.shape[1]
    pairs = list(itertools.combinations(range(corners), 2))
    number = corners + len(pairs) * points
    steps_each = number * (number - 1) // 2
    if points > 1 and len(near) * steps_each > _MOST_STEPS:
        msg = (
            f"points is {points}, which makes {len(near) * steps_each:,} steps in "
            f"{len(near):,} simplices, more than {_MOST_STEPS:,}: give fewer points"
        )
        raise ValueError(msg)
    shares = np.arange(1, points + 1) / (points + 1)
    keys = np.stack(
        [near[:, i].astype(np.int64) * count + near[:, j] for i, j in pairs]
    )
    known, numbers = np.unique(keys, return_inverse=True)
    numbers = numbers.reshape(keys.shape)
    names = [near[:, i].astype(np.int64) for i in range(corners)]
    weights = [np.eye(corners)[i] for i in range(corners)]
    for pair, own in zip(pairs, numbers, strict=True):
        for k, share in enumerate(shares):
            names.append(count + own * points + k)
            weight = np.zeros(corners)
            weight[list(pair)] = 1 - share, share
            weights.append(weight)
    squares = complex_._source.squared_distances(near[:, :, None], near[:, None, :])
    one, other = np.triu_indices(len(names), 1)
    apart = np.array(weights)[one] - np.array(weights)[other]
    products = np.einsum("pi,pj->pij", apart, apart).reshape(len(apart), -1) / -2
    steps = np.sqrt(np.maximum(squares.reshape(len(near), -1) @ products.T, 0.0))
    table = np.stack(names, axis=1)
    ends = np.sort(np.stack([table[:, one].ravel(), table[:, other].ravel()]), 0)
    # The same step in two simplices counts once: equal up to rounding.
    total = count + len(known) * points
    _, once = np.unique(ends[0] * total + ends[1], return_index=True)
    graph = _symmetric(steps.ravel()[once], ends[:, once].T, total)
    _, before = scipy_module("sparse.csgraph").dijkstra(
        graph, directed=False, indices=start, return_predecessors=True
    )
    way = [end]
    while way[-1] != start:
        way.append(int(before[way[-1]]))
    places = np.array(way[::-1])
    on_edge = places >= count
    found = np.repeat(places[:, None], 2, axis=1)
    along = np.zeros(len(places))
    if points:
        edge, step = np.divmod(places[on_edge] - count, points)
        found[on_edge] = np.stack(np.divmod(known[edge], count), axis=1)
        along[on_edge] = shares[step]
    return Polyline(found.astype(np.int32), along)


def _symmetric(lengths: Floats, edges: NDArray[Any], count: int) -> Any:
    """Graph of edges; of the two ways SciPy takes the one that is there."""
    sparse = scipy_module("sparse")
    return sparse.csr_array((lengths, (edges[:, 0], edges[:, 1])), shape=(count, count))


def farthest_points(
    distances: Distances, used: NDArray[np.bool_], count: int, start: int
) -> NDArray[np.int64]:
    """Vertices, each as far as can be from those before it."""
    chosen = [start]
    nearest = np.where(used, np.inf, -np.inf)
    while len(chosen) < count:
        away = distances.from_sources(chosen[-1:], count)[0]
        nearest = np.minimum(nearest, away)
        nearest[~used] = -np.inf
        nearest[chosen[-1]] = 0.0
        chosen.append(farthest(nearest))
    return np.array(chosen, dtype=np.int64)


def voronoi_cells(
    distances: Distances, operators: Operators, sites: NDArray[np.int64]
) -> VoronoiCells:
    """Nearest sites; see `Calculus.voronoi_cells`."""
    nearest = np.full(operators.count, np.inf)
    labels = np.full(operators.count, -1, dtype=np.int64)
    for row, site in enumerate(sites):
        away = distances.from_sources([int(site)], len(sites))[0]
        away[site] = 0.0
        nearer = away < nearest
        nearest[nearer], labels[nearer] = away[nearer], row
    reached = labels >= 0
    shares = operators.volumes[reached]
    volumes = np.bincount(labels[reached], shares, len(sites)).astype(np.float64)
    return VoronoiCells(sites, labels, nearest, volumes)


def frechet_mean(
    distances: Distances, vertices: NDArray[np.int64], weights: Floats
) -> FrechetMean:
    """Least mean square; see `Calculus.mean`."""
    spread: Floats = np.zeros(0)
    for vertex, weight in zip(vertices, weights / weights.sum(), strict=True):
        away = distances.from_sources([int(vertex)], len(vertices))[0]
        square = weight * away**2
        spread = square if len(spread) == 0 else spread + square
    vertex = int(np.argmin(spread))
    return FrechetMean(vertex, float(spread[vertex]), spread)


def _spread(places: Floats, count: int) -> NDArray[np.int64]:
    """Some of the places around the origin, each the farthest from it and those before."""
    nearest = np.linalg.norm(places, axis=1)
    chosen: list[int] = []
    for _ in range(count):
        chosen.append(int(nearest.argmax()))
        away = np.linalg.norm(places - places[chosen[-1]], axis=1)
        nearest = np.minimum(nearest, away)
    return np.array(chosen, dtype=np.int64)


def logarithm_map(
    distances: Distances, complex_: ComplexData, vertex: int
) -> LogarithmMap:
    """From how squared distances change around a vertex; see `Calculus.logarithm`.

    Half the square of the distance to a point is, around the vertex, a function whose
    slope is minus the logarithm of the point (Gauss's lemma): one fit of degree 2
    serves all points.
    """
    dim = complex_.dim
    near, tangents, places = fit_at(complex_, vertex)
    pairs = list(itertools.combinations_with_replacement(range(dim), 2))
    chosen = np.arange(len(near))
    # Exact distances have no noise that more of them would average.
    few = dim + len(pairs) + _MORE_THAN_UNKNOWNS
    if few < len(near) and distances.method_for(few + 1) == "exact":
        chosen = _spread(places, few)
    own = distances.from_sources([vertex], len(chosen) + 1)[0]
    own[vertex] = 0.0
    rows = distances.from_sources(near[chosen], len(chosen) + 1)
    rows[np.arange(len(chosen)), near[chosen]] = 0.0
    around = places[chosen]
    terms = np.concatenate(
        [-around, np.stack([around[:, i] * around[:, j] for i, j in pairs], axis=1)],
        axis=1,
    )
    reached = np.isfinite(own)
    change = (rows[:, reached] ** 2 - own[reached] ** 2) / 2
    slopes = np.linalg.lstsq(terms, change, rcond=None)[0][:dim].T
    coordinates = np.full((len(own), dim), np.nan)
    coordinates[reached] = slopes
    # The nearest ones are where they are seen.
    coordinates[near] = places
    sizes = np.linalg.norm(coordinates[reached], axis=1)
    scale = own[reached] / np.where(sizes > 0, sizes, 1.0)
    coordinates[reached] *= scale[:, None]
    return LogarithmMap(coordinates, tangents, vertex)
