# SPDX-License-Identifier: GPL-3.0-or-later
"""Charts: parts of a manifold with K coordinates, and the ways between them."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line, rounded
from remanifold._base.validation import check_index_array, check_values
from remanifold.calculus.elements import differences
from remanifold.calculus.operators import Operators
from remanifold.calculus.solving import scipy_module
from remanifold.calculus.unrolling import (
    circular,
    conformal,
    rigid,
    rim_of_disc,
    stretches_of,
)
from remanifold.complex.data import ComplexData
from remanifold.complex.faces import parities
from remanifold.complex.parts import Part, open_faces, take
from remanifold.complex.projection import PointsOnComplex, Projection, project

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.progress import Callback

    Floats = NDArray[np.float64]

# Gap between the charts of a texture, in units of the side of a square of their area, and
# by how much the square grows until they fit.
_MARGIN = 0.02
_MORE = 1.05
# Rounds for the mean tangent space, whose directions are far wider than the others.
_ITERATIONS = 6
# Parts beside it that a part may be joined with: those that share most with it.
_NEIGHBORS = 3


@dataclass(frozen=True, eq=False, repr=False)
class Chart(ReadOnlyArrays):
    """A part of a complex laid out in R^K. Arrays are read-only.

    Attributes
    ----------
    simplices : ndarray, shape (m,), int64
        Rows of the simplices of the complex, ascending.
    vertices : ndarray, shape (n,), int32
        Their vertices, ascending.
    coordinates : ndarray, shape (n, K), float64
        Where these are in the chart, in the unit of lengths on the manifold.
    stretches : ndarray, shape (m, K), float64
        By how much the chart stretches each simplex along its principal axes,
        ascending: 1 where it is isometric. Never negative but where nothing else was
        found, as the first of a simplex that is turned over. Zero for flat simplices.
    method : str
        How it was made: "rigid", "conformal", "circular" or "tangent".
    """

    simplices: NDArray[np.int64]
    vertices: NDArray[np.int32]
    coordinates: Floats
    stretches: Floats
    method: str
    # Simplices as numbers of the chart's vertices, in the order of the complex.
    _rows: NDArray[np.int32] = field(repr=False)

    @property
    def distortion(self) -> float:
        """By which factor a length is longer or shorter in the chart, at most.

        1 for an isometry; infinite where a simplex is turned over.
        """
        return _distortion(self.stretches)

    @functools.cached_property
    def _flat(self) -> ComplexData:
        return ComplexData(self.coordinates, self._rows)

    def __repr__(self) -> str:
        return one_line(
            self,
            simplices=len(self.simplices),
            method=self.method,
            distortion=rounded(self.distortion),
        )


@dataclass(frozen=True, eq=False, repr=False)
class ChartPoints(ReadOnlyArrays):
    """Points in charts. Arrays are read-only.

    Attributes
    ----------
    charts : ndarray, shape (Q,), int64
        Number of the chart that each lies in.
    coordinates : ndarray, shape (Q, K), float64
        Its coordinates there.
    distances : ndarray, shape (Q,), float64
        From each given point to the complex; zero for points that were on it.
    """

    charts: NDArray[np.int64]
    coordinates: Floats
    distances: Floats

    def __repr__(self) -> str:
        return one_line(self, points=len(self.charts), dim=self.coordinates.shape[1])

    def __len__(self) -> int:
        return len(self.charts)


@dataclass(frozen=True, eq=False, repr=False)
class Atlas(ReadOnlyArrays):
    """Charts that cover a complex, and the ways there and back. Arrays are read-only.

    Attributes
    ----------
    charts : tuple of Chart
        They overlap by a ring of simplices, but for small ones where the manifold bends
        too much.
    labels : ndarray, shape (M,), int64
        The chart that each simplex belongs to first; others may have it too.
    """

    charts: tuple[Chart, ...]
    labels: NDArray[np.int64]
    _complex: ComplexData = field(repr=False)
    _make: Callable[..., Any] = field(repr=False)

    @property
    def distortion(self) -> float:
        """The largest of the charts."""
        return max(chart.distortion for chart in self.charts)

    def __repr__(self) -> str:
        return one_line(
            self,
            charts=len(self.charts),
            dim=self._complex.dim,
            distortion=rounded(self.distortion),
        )

    def __len__(self) -> int:
        return len(self.charts)

    def transform(self, points: ArrayLike | PointsOnComplex) -> ChartPoints:
        """Chart and coordinates of points.

        Parameters
        ----------
        points : array_like, shape (Q, D), or PointsOnComplex
            Points, whose nearest points on the complex are taken, or the result of
            `SimplicialComplex.project` or `SimplicialComplex.sample`.

        Returns
        -------
        ChartPoints
        """
        place = points
        if not isinstance(place, PointsOnComplex):
            place = project(self._complex, place)
        self._check_place(place)
        charts = self.labels[place.simplices]
        found = np.empty((len(place), self._complex.dim))
        for number in np.unique(charts):
            own = charts == number
            found[own] = self._within(
                int(number), place.simplices[own], place.barycentric[own]
            )
        away = getattr(place, "distances", np.zeros(len(place)))
        return ChartPoints(charts, found, np.array(away))

    def locate(self, charts: int | ArrayLike, coordinates: ArrayLike) -> Projection:
        """Points of the complex from their chart and coordinates.

        Parameters
        ----------
        charts : int, or array_like of int, shape (Q,)
            Number of the chart of each.
        coordinates : array_like, shape (Q, K)
            Its coordinates there.

        Returns
        -------
        Projection
            On the complex. Its `distances` are how far the coordinates lie outside of
            the chart, whose nearest point is taken then; zero inside, up to rounding.
        """
        numbers, places = self._check_coordinates(charts, coordinates)
        size, dim = len(places), self._complex.dim
        simplices = np.zeros(size, dtype=np.int64)
        weights = np.zeros((size, dim + 1))
        away = np.zeros(size)
        for number in np.unique(numbers):
            own, chart = numbers == number, self.charts[number]
            found = project(chart._flat, places[own])
            simplices[own] = chart.simplices[found.simplices]
            weights[own], away[own] = found.barycentric, found.distances
        vertices = self._complex.vertices
        points = None
        if vertices is not None:
            corners = vertices[self._complex.simplices[simplices]]
            points = np.einsum("qi,qid->qd", weights, corners)
        return Projection(points, simplices, weights, away)

    def inverse_transform(
        self, charts: int | ArrayLike, coordinates: ArrayLike
    ) -> Floats:
        """Points of the space from their chart and coordinates.

        Parameters
        ----------
        charts : int, or array_like of int, shape (Q,)
            Number of the chart of each.
        coordinates : array_like, shape (Q, K)
            Its coordinates there; outside of the chart its nearest point is taken, and
            `locate` says how far away that is.

        Returns
        -------
        ndarray, shape (Q, D), float64

        Raises
        ------
        ValueError
            Wrong shape, no such chart, or a complex without coordinates: see `locate`.
        """
        points = self.locate(charts, coordinates).points
        if points is None:
            msg = "the complex has no coordinates: locate() has simplices and weights"
            raise ValueError(msg)
        return points

    def transition(self, source: int, target: int, coordinates: ArrayLike) -> Floats:
        """Coordinates in another chart.

        Parameters
        ----------
        source, target : int
            Numbers of the charts.
        coordinates : array_like, shape (Q, K)
            In the first of them.

        Returns
        -------
        ndarray, shape (Q, K), float64
            In the second; NaN for points that are not in both.
        """
        numbers, _ = self._check_coordinates([source, target], np.zeros((2, self._dim)))
        place = self.locate(source, coordinates)
        size = np.ptp(self.charts[source].coordinates, axis=0).max()
        chart = self.charts[int(numbers[1])]
        both = np.isin(place.simplices, chart.simplices)
        both &= place.distances <= _OUTSIDE * size
        found = np.full((len(place), self._dim), np.nan)
        found[both] = self._within(
            int(numbers[1]), place.simplices[both], place.barycentric[both]
        )
        return found

    def texture(self) -> Any:
        """The surface with all charts side by side in the unit square, for K = 2.

        Returns
        -------
        SimplicialComplex
            The triangles, each in its first chart, in the order of the charts. Vertices on
            seams are there once for each chart. Its `vertex_attributes` are ``uv``, the
            texture coordinates that files in OBJ and glTF have, ``chart``, and ``vertex``,
            the number of the vertex in the complex.

        Raises
        ------
        ValueError
            K is not 2.
        """
        if self._dim != 2:
            msg = f"textures are for surfaces, and the dimension is {self._dim}"
            raise ValueError(msg)
        rows, numbers, places, labels = [], [], [], []
        total = 0
        for number, chart in enumerate(self.charts):
            own = self.labels[chart.simplices] == number
            used, corners = np.unique(chart._rows[own], return_inverse=True)
            rows.append(corners.reshape(-1, 3) + total)
            numbers.append(chart.vertices[used])
            places.append(_lengthwise(chart.coordinates[used]))
            labels.append(np.full(len(used), number, dtype=np.int32))
            total += len(used)
        corner, side = _on_shelves(np.array([own.max(axis=0) for own in places]))
        places = [(a + b) / side for a, b in zip(places, corner, strict=True)]
        vertices = np.concatenate(numbers)
        attributes = {
            "uv": np.concatenate(places),
            "chart": np.concatenate(labels),
            "vertex": vertices,
        }
        simplices = np.concatenate(rows).astype(np.int32)
        return self._make(self._complex.coordinates[vertices], simplices, attributes)

    @property
    def _dim(self) -> int:
        return self._complex.dim

    def _within(
        self, number: int, simplices: NDArray[np.int64], weights: Floats
    ) -> Floats:
        """Coordinates in a chart of points in its simplices."""
        chart = self.charts[number]
        rows = chart._rows[np.searchsorted(chart.simplices, simplices)]
        return np.asarray(np.einsum("qi,qik->qk", weights, chart.coordinates[rows]))

    def _check_place(self, place: PointsOnComplex) -> None:
        if len(place) and (
            place.simplices.max() >= len(self.labels)
            or place.barycentric.shape[1] != self._dim + 1
        ):
            msg = "points are on another complex: their simplices do not exist here"
            raise ValueError(msg)

    def _check_coordinates(
        self, charts: int | ArrayLike, coordinates: ArrayLike
    ) -> tuple[NDArray[np.int64], Floats]:
        places = np.asarray(coordinates)
        if places.ndim != 2 or places.shape[1] != self._dim:
            msg = f"coordinates has shape {places.shape}, expected (Q, {self._dim})"
            raise ValueError(msg)
        places = check_values(places, "coordinates", len(places), ndim=2)
        given = np.asarray(charts)
        if given.ndim == 0:
            given = np.full(len(places), given)
        numbers: NDArray[np.int64] = check_index_array(given, "charts", np.int64)
        if len(numbers) != len(places):
            msg = f"charts has {len(numbers)} numbers for {len(places)} coordinates"
            raise ValueError(msg)
        outside = (numbers < 0) | (numbers >= len(self.charts))
        if outside.any():
            place = int(outside.argmax())
            msg = (
                f"charts[{place}] is {numbers[place]}, expected 0 to "
                f"{len(self.charts) - 1}"
            )
            raise ValueError(msg)
        return numbers, places


_BLOCK = 500  # edges at a time that are compared with all others
# Volume over that of a cube with the longest edge, of a simplex whose center may lie in
# another one by rounding.
_THIN = 1e-9
# Share of its size that a point may lie outside of a chart and still counts as in it.
_OUTSIDE = 1e-9


def _lengthwise(places: Floats) -> Floats:
    """Turned so that the longest direction is the first, from zero on."""
    middle = places - places.mean(axis=0)
    _, axes = np.linalg.eigh(middle.T @ middle)
    turn = axes[:, ::-1] * [1.0, np.sign(np.linalg.det(axes[:, ::-1]))]
    turned = middle @ turn
    return np.asarray(turned - turned.min(axis=0))


def _on_shelves(sizes: Floats) -> tuple[Floats, float]:
    """Lower left corners of boxes in a square, and its side: the highest boxes first."""
    gap = _MARGIN * np.sqrt(sizes.prod(axis=1).sum())
    wide = sizes + gap
    side = max(float(np.sqrt(wide.prod(axis=1).sum())), float(wide[:, 0].max()))
    corners = np.zeros_like(sizes)
    while True:
        x = y = shelf = 0.0
        for number in np.argsort(-wide[:, 1], kind="stable"):
            if x + wide[number, 0] > side and x > 0:
                x, y, shelf = 0.0, y + shelf, 0.0
            corners[number] = x, y
            x, shelf = x + wide[number, 0], max(shelf, wide[number, 1])
        if y + shelf <= side:
            return corners + gap / 2, side
        side *= _MORE


def make_atlas(
    whole: ComplexData,
    method: str,
    max_distortion: float,
    make: Callable[..., Any],
    progress: Callback | None = None,
) -> Atlas:
    """Cut until each part can be laid out; see `Calculus.charts`."""
    tell = progress or (lambda *_: None)
    num_done = 0
    adjacency = _adjacency(whole.simplices)
    lay_out = functools.partial(_with_ring, whole, method, max_distortion)
    labels = np.full(len(whole.simplices), -1, dtype=np.int64)
    done: list[tuple[NDArray[np.int64], Chart]] = []
    waiting = _connected(adjacency, np.arange(len(whole.simplices)))[::-1]
    while waiting:
        tell("charts", num_done, len(labels))
        region = waiting.pop()
        chart = lay_out(region)
        if chart is None:
            waiting += [
                piece
                for half in _halves(whole, region)[::-1]
                for piece in _connected(adjacency, half)[::-1]
            ]
            continue
        labels[region] = len(done)
        done.append((region, chart))
        num_done += len(region)
    tell("charts", len(labels), len(labels))
    _merge(adjacency, labels, done, lay_out, tell)
    kept, labels = np.unique(labels, return_inverse=True)
    charts = tuple(done[number][1] for number in kept)
    return Atlas(charts, labels.reshape(-1).astype(np.int64), whole, make)


def _merge(
    adjacency: Any,
    labels: NDArray[np.int64],
    done: list[tuple[NDArray[np.int64], Chart]],
    lay_out: Callable[[NDArray[np.int64]], Chart | None],
    tell: Callback,
) -> None:
    """Join parts with those beside them where that can be laid out as well.

    Once for each, the smallest first, with at most so many of its neighbors: all this
    takes a constant times what laying out all parts takes.
    """
    order = np.argsort([len(region) for region, _ in done], kind="stable")
    for place, number in enumerate(order):
        tell("joining charts", place, len(done))
        region = done[number][0]
        beside = labels[adjacency[region].indices]
        others, shared = np.unique(beside[beside != number], return_counts=True)
        for other in others[np.argsort(-shared, kind="stable")][:_NEIGHBORS]:
            union = np.sort(np.concatenate([region, done[other][0]]))
            found = lay_out(union)
            if found is not None:
                labels[region] = other
                done[other] = union, found
                break
    tell("joining charts", len(done), len(done))


def _with_ring(
    whole: ComplexData, method: str, limit: float, region: NDArray[np.int64]
) -> Chart | None:
    """The part and the simplices around it, by which it overlaps others.

    Where that is too much, at creases and the like, parts without a vertex inside alone.
    """
    used = np.zeros(whole.num_vertices, dtype=np.bool_)
    used[whole.simplices[region]] = True
    wider = np.flatnonzero(used[whole.simplices].any(axis=1))
    chart = _lay_out(whole, method, limit, wider)
    if chart is None:
        around = np.setdiff1d(wider, region, assume_unique=True)
        used[whole.simplices[around]] = False
        if not used.any() or len(region) == 1:
            chart = _lay_out(whole, method, limit, region)
    return chart


def _distortion(stretches: Floats) -> float:
    solid = stretches[stretches[:, -1] != 0]
    if len(solid) == 0:
        return 1.0
    least = solid[:, 0].min()
    return float(max(solid[:, -1].max(), 1 / least)) if least > 0 else np.inf


def _lay_out(
    whole: ComplexData, method: str, limit: float, region: NDArray[np.int64]
) -> Chart | None:
    """The part in R^K; None if that takes more distortion, or several sheets."""
    part = take(whole, whole.simplices[region])
    rows = _oriented(part.simplices)
    if rows is None:
        return None
    as_given = part.simplices
    part = Part(
        part.vertices,
        rows,
        vertex_indices=part.vertex_indices,
        _products=part._products,
    )
    operators = Operators(part)
    candidates: list[tuple[str, Callable[[], Floats]]] = []
    rim: NDArray[np.int32] | None = None
    if len(rows) == 1 or method == "tangent":
        candidates = [("tangent", lambda: _shadow(operators))]
    elif not operators.used.all() or operators.labels.max() > 0:
        return None  # only flat simplices hold it together: it is cut there
    elif whole.dim != 2:
        candidates = [("rigid", lambda: rigid(operators, _shadow(operators)))]
    else:
        rim = rim_of_disc(rows)
        if rim is None:
            return None
        flat = functools.cache(lambda: conformal(operators, rim))
        around = functools.cache(lambda: circular(operators, rim))
        if method == "conformal":
            candidates = [("conformal", flat), ("circular", around)]
        else:
            candidates = [
                ("rigid", lambda: rigid(operators, flat())),
                ("rigid", lambda: rigid(operators, around())),
                ("conformal", flat),
            ]
    for name, call in candidates:
        coordinates = call()
        stretches = stretches_of(operators, coordinates)
        if _distortion(stretches) <= limit and _single(
            coordinates, rows, disc=rim is not None
        ):
            used = part.vertex_indices
            return Chart(region, used, coordinates, stretches, name, _rows=as_given)
    return None


def _single(coordinates: Floats, rows: NDArray[np.int32], *, disc: bool) -> bool:
    """Whether no simplex lies on another one, where none is turned over.

    Then each center is in its own simplex, and each vertex in those that have it. Of a
    disc in the plane that the boundary does not cross itself is enough, and certain: it
    goes round each point inside once, as often as triangles lie there.
    """
    if len(rows) == 1:
        return True
    if rows.shape[1] == 3 and _crossing(coordinates, open_faces(rows)):
        return False
    if disc:
        return True
    flat = ComplexData(coordinates, rows)
    found = project(flat, coordinates[rows].mean(axis=1)).simplices
    solid = _solid(coordinates, rows)  # the centers of flat ones are in others too
    if (found != np.arange(len(rows)))[solid].any():
        return False
    at = project(flat, coordinates).simplices
    return bool((rows[at] == np.arange(len(coordinates))[:, None]).any(axis=1).all())


def _crossing(coordinates: Floats, edges: NDArray[np.int32]) -> bool:
    """Whether two edges in the plane meet elsewhere than at a vertex of both.

    All pairs: of the triangles of a part only their root lies on the boundary.
    """

    def side(a: Floats, b: Floats, c: Floats) -> Floats:
        u, v = b - a, c - a
        return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])

    start, end = coordinates[edges[:, 0]], coordinates[edges[:, 1]]
    for first in range(0, len(edges), _BLOCK):
        own = slice(first, first + _BLOCK)
        a, b = start[own, None], end[own, None]
        meet = side(a, b, start) * side(a, b, end) < 0
        meet &= side(start, end, a) * side(start, end, b) < 0
        share = (edges[own, None, :, None] == edges[None, :, None, :]).any(axis=(2, 3))
        if (meet & ~share).any():
            return True
    return False


def _solid(coordinates: Floats, rows: NDArray[np.int32]) -> NDArray[np.bool_]:
    edges = differences(coordinates, rows)
    sizes = np.linalg.norm(edges, axis=2).max(axis=1)
    volumes = np.abs(np.linalg.det(edges))
    return np.asarray(volumes > _THIN * sizes ** edges.shape[1])


def _shadow(operators: Operators) -> Floats:
    """On the mean tangent space of the part, about its center."""
    coordinates = operators.complex.coordinates
    frames = operators.ambient_frames()
    weights = operators.elements.volumes
    dim = operators.dim
    # The widest directions of all tangent spaces together, by iterating a subspace: there
    # may be many coordinates.
    ambient = coordinates.shape[1]
    wide = (frames * np.sqrt(weights)[:, None, None]).reshape(-1, ambient)
    axes = np.random.default_rng(0).normal(size=(ambient, min(2 * dim, ambient)))
    for _ in range(_ITERATIONS):
        axes = np.linalg.qr(wide.T @ (wide @ axes))[0]
    _, _, turn = np.linalg.svd(wide @ axes, full_matrices=False)
    axes = turn[:dim] @ axes.T
    found = (coordinates - coordinates.mean(axis=0)) @ axes.T
    turned = (np.linalg.det(operators.frame_gradients(found)) * weights).sum()
    if turned < 0:
        found[:, 0] *= -1
    return np.asarray(found)


def _shared_facets(
    simplices: NDArray[np.int32],
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of simplices that share a facet with each other only.

    And 1 where both are oriented alike across it, else -1.
    """
    count, corners = simplices.shape
    faces, signs = [], []
    for left_out in range(corners):
        face = np.delete(simplices, left_out, axis=1)
        order = np.argsort(face, axis=1, kind="stable")
        faces.append(np.take_along_axis(face, order, axis=1))
        signs.append((-1) ** left_out * np.broadcast_to(parities(order), count))
    table = np.concatenate(faces)
    order = np.lexsort(table.T[::-1])
    table, sign = table[order], np.concatenate(signs)[order]
    owner = order.astype(np.int64) % count
    same = (table[1:] == table[:-1]).all(axis=1)
    pair = same.copy()
    pair[1:] &= ~same[:-1]
    pair[:-1] &= ~same[1:]
    alike = -sign[:-1] * sign[1:]
    return owner[:-1][pair], owner[1:][pair], alike[pair]


def _adjacency(simplices: NDArray[np.int32]) -> Any:
    """Simplices that share a facet with each other only, (M, M)."""
    sparse = scipy_module("sparse")
    first, second, _ = _shared_facets(simplices)
    shape = (len(simplices), len(simplices))
    graph = sparse.csr_array((np.ones(len(first)), (first, second)), shape=shape)
    return (graph + graph.T).tocsr()


def _connected(adjacency: Any, region: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Parts of some simplices that are connected through facets."""
    csgraph = scipy_module("sparse.csgraph")
    if len(region) == 0:
        return []
    own = adjacency[region][:, region]
    _, labels = csgraph.connected_components(own, directed=False)
    order = np.argsort(labels, kind="stable")
    ends = np.cumsum(np.bincount(labels))[:-1]
    return [np.sort(region[part]) for part in np.split(order, ends)]


def _halves(whole: ComplexData, region: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Those nearer to one end of the part and to the other, along its edges."""
    sparse, csgraph = scipy_module("sparse"), scipy_module("sparse.csgraph")
    part = take(whole, whole.simplices[region])
    i, j = part.edges.T
    lengths = np.sqrt(part._source.squared_distances(i, j))
    shape = (part.num_vertices, part.num_vertices)
    graph = sparse.csr_array((lengths, (i, j)), shape=shape)

    def away(vertex: int) -> Floats:
        found = csgraph.dijkstra(graph, directed=False, indices=vertex)
        return np.asarray(np.where(np.isfinite(found), found, lengths.sum()))

    one = int(away(0).argmax())
    near = away(one)
    other = int(near.argmax())
    nearer = (near - away(other))[part.simplices].sum(axis=1) < 0
    if nearer.all() or not nearer.any():  # both ends are in all simplices
        nearer = np.arange(len(region)) < len(region) // 2
    return [region[nearer], region[~nearer]]


def _oriented(simplices: NDArray[np.int32]) -> NDArray[np.int32] | None:
    """Simplices connected through facets, all oriented as the first; None if they cannot.

    Facets that more than two share do not connect.
    """
    count = len(simplices)
    first, second, alike = _shared_facets(simplices)
    if len(first) == 0:
        return simplices if count == 1 else None
    sparse, csgraph = scipy_module("sparse"), scipy_module("sparse.csgraph")
    # Each simplex twice, once for each orientation: two sheets if it can be done.
    apart = np.where(alike > 0, 0, count)
    starts = np.concatenate([first, first + count])
    ends = np.concatenate([second + apart, second + count - apart])
    graph = sparse.csr_array(
        (np.ones(len(starts)), (starts, ends)), shape=(2 * count, 2 * count)
    )
    number, labels = csgraph.connected_components(graph, directed=False)
    if number != 2 or (labels[:count] == labels[count:]).any():
        return None
    turned = labels[:count] != labels[0]
    result = simplices.copy()
    result[turned, -2:] = result[turned, :-3:-1]
    return np.asarray(result)
