# SPDX-License-Identifier: GPL-3.0-or-later
"""The nearest points of a complex, values there, and points drawn at random."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from remanifold._base.progress import progress_callback
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.scaling import place_by_distances, place_by_products
from remanifold._base.text import one_line, rounded
from remanifold._base.validation import (
    check_int,
    check_num_threads,
    check_points,
    check_values_where,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.progress import Callback
    from remanifold.complex.data import ComplexData

RandomState: TypeAlias = int | np.random.Generator | np.random.RandomState | None


@dataclass(frozen=True, eq=False, repr=False)
class PointsOnComplex(ReadOnlyArrays):
    """Points of a complex. Arrays are read-only.

    Attributes
    ----------
    points : ndarray, shape (Q, D), float64, or None
        The points; None where the complex has no coordinates.
    simplices : ndarray, shape (Q,), int64
        Row of `SimplicialComplex.simplices` that each point lies in.
    barycentric : ndarray, shape (Q, K+1), float64
        Barycentric coordinates there, in the order of the columns: not negative, of sum
        1 up to rounding.
    """

    points: NDArray[np.float64] | None
    simplices: NDArray[np.int64]
    barycentric: NDArray[np.float64]

    def __repr__(self) -> str:
        return one_line(self, **self._summary())

    def _summary(self) -> dict[str, object]:
        return {
            "points": len(self),
            "ambient_dim": None if self.points is None else self.points.shape[1],
            "dim": self.barycentric.shape[1] - 1,
        }

    def __len__(self) -> int:
        return len(self.simplices)


@dataclass(frozen=True, eq=False, repr=False)
class Projection(PointsOnComplex):
    """The points of a complex nearest to others. Arrays are read-only.

    Attributes
    ----------
    points, simplices, barycentric : ndarray
        As in `PointsOnComplex`.
    distances : ndarray, shape (Q,), float64
        From each given point to its nearest.
    """

    distances: NDArray[np.float64]

    def _summary(self) -> dict[str, object]:
        largest = rounded(float(self.distances.max())) if len(self) else None
        return {**super()._summary(), "largest_distance": largest}


def project(
    complex_: ComplexData,
    points: ArrayLike | None = None,
    *,
    products: ArrayLike | None = None,
    squared_norms: ArrayLike | None = None,
    distances: ArrayLike | None = None,
    num_threads: int | None = None,
    progress: bool | Callback | None = None,
) -> Projection:
    """Nearest points, as `SimplicialComplex.project` describes them."""
    if len(complex_.simplices) == 0:
        msg = "the complex has no simplices, so nothing is nearest"
        raise ValueError(msg)
    threads = check_num_threads(num_threads)
    queries, residuals = _queries(complex_, points, products, squared_norms, distances)
    with progress_callback(progress) as callback:
        found = complex_._search(threads, callback).nearest(queries, threads, callback)
    nearest, simplices, barycentric, away = found
    return Projection(
        points=None if complex_.vertices is None else nearest,
        simplices=simplices,
        barycentric=barycentric.reshape(len(queries), complex_.dim + 1),
        distances=away if residuals is None else np.hypot(away, residuals),
    )


def _queries(
    complex_: ComplexData,
    points: ArrayLike | None,
    products: ArrayLike | None,
    squared_norms: ArrayLike | None,
    distances: ArrayLike | None,
) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Positions in `coordinates`, and distances from the space these span."""
    samples = complex_._source
    given = {
        "points": points is not None,
        "gram": products is not None or squared_norms is not None,
        "distances": distances is not None,
    }
    wanted = {
        "points": "points",
        "gram": "products= and squared_norms=",
        "distances": "distances=",
    }[samples.kind]
    if not given.pop(samples.kind) or any(given.values()):
        msg = (
            f"this complex is known by its {samples.kind}: give {wanted}, and nothing "
            "else"
        )
        raise TypeError(msg)
    if distances is not None:
        return place_by_distances(complex_._scaling, distances)
    if points is not None:
        return check_queries(complex_, points), None
    if products is None or squared_norms is None:
        missing = "products" if products is None else "squared_norms"
        msg = f"{missing} is missing: products and squared_norms go together"
        raise TypeError(msg)
    return place_by_products(complex_._scaling, products, squared_norms)


def check_queries(complex_: ComplexData, points: ArrayLike) -> NDArray[np.float64]:
    """As many coordinates as the complex has; no points are fine."""
    ambient = complex_.ambient_dim
    array = np.asarray(points)
    if array.ndim == 2 and len(array) == 0 and array.shape[1] == ambient:
        return np.empty(array.shape)
    queries = check_points(points)
    if queries.shape[1] != ambient:
        msg = (
            f"points has shape {array.shape}, expected {ambient} columns, the "
            "coordinates of the complex"
        )
        raise ValueError(msg)
    return queries


def interpolate(
    complex_: ComplexData,
    values: ArrayLike,
    points: ArrayLike | PointsOnComplex,
    **options: Any,
) -> NDArray[np.float64]:
    """Values at points, as `SimplicialComplex.interpolate` describes them."""
    used = np.zeros(complex_.num_vertices, dtype=np.bool_)
    used[complex_.simplices] = True
    table = check_values_where(values, "values", used)
    place = points
    if not isinstance(place, PointsOnComplex):
        place = project(complex_, place, **options)
    elif len(place) and (
        place.simplices.max() >= len(complex_.simplices)
        or place.barycentric.shape[1] != complex_.dim + 1
    ):
        msg = "points are on another complex: their simplices do not exist here"
        raise ValueError(msg)
    return _weighted(table, complex_.simplices[place.simplices], place.barycentric)


def _weighted(
    table: NDArray[np.float64],
    corners: NDArray[np.int32],
    weights: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Sum over the corners, in their order: a row does not depend on the others."""
    shape = (len(corners), *table.shape[1:])
    total = np.zeros(shape)
    for column in range(corners.shape[1]):
        weight = weights[:, column].reshape(-1, *(1,) * (table.ndim - 1))
        total += weight * table[corners[:, column]]
    return total


def sample(
    complex_: ComplexData,
    volumes: NDArray[np.float64],
    num_points: int,
    random_state: RandomState = None,
) -> PointsOnComplex:
    """Random points by `simplex_volumes`, as `SimplicialComplex.sample` describes them."""
    count = check_int(num_points, "num_points", minimum=0)
    random = _generator(random_state)
    ends = np.cumsum(volumes)
    if len(ends) == 0 or not ends[-1] > 0:
        msg = "the complex has no volume to draw points from"
        raise ValueError(msg)
    # Below the last end: simplices of no volume at the end are not drawn.
    where = random.random(count) * ends[-1]
    last = np.searchsorted(ends, ends[-1])
    simplices = np.minimum(np.searchsorted(ends, where, side="right"), last)
    shares = random.standard_exponential((count, complex_.dim + 1))
    shares /= shares.sum(axis=1, keepdims=True)
    points = None
    if complex_.vertices is not None:
        points = _weighted(complex_.vertices, complex_.simplices[simplices], shares)
    return PointsOnComplex(points, simplices.astype(np.int64), shares)


def _generator(random_state: RandomState) -> np.random.Generator:
    if isinstance(random_state, np.random.RandomState):
        return np.random.Generator(random_state._bit_generator)
    if random_state is None or isinstance(random_state, np.random.Generator):
        return np.random.default_rng(random_state)
    return np.random.default_rng(check_int(random_state, "random_state", minimum=0))


def simplex_volumes(complex_: ComplexData) -> NDArray[np.float64]:
    """K-volume of each simplex; 1 for points."""
    factorial = float(np.prod(np.arange(1, complex_.dim + 1), dtype=np.float64))
    volumes = np.empty(len(complex_.simplices))
    for rows, triangles in edge_triangles(complex_):
        diagonals = np.diagonal(triangles, axis1=1, axis2=2)
        full = triangles.shape[1] == complex_.dim
        volumes[rows] = np.abs(diagonals.prod(axis=1)) / factorial if full else 0.0
    return volumes


def edge_triangles(
    complex_: ComplexData,
) -> Any:
    """Edges from the first vertex in orthonormal coordinates, blocks of simplices.

    Yields the slice of the simplices and their edges as the columns of upper triangular
    matrices, (m, min(K, D), K).
    """
    coordinates = complex_.coordinates
    cells = complex_.simplices
    block = max(1, 2**21 // max(1, cells.shape[1] * coordinates.shape[1]))
    for start in range(0, len(cells), block):
        rows = slice(start, min(start + block, len(cells)))
        corners = coordinates[cells[rows]]
        edges = corners[:, 1:] - corners[:, :1]
        yield rows, np.linalg.qr(edges.transpose(0, 2, 1), mode="r")
