# SPDX-License-Identifier: GPL-3.0-or-later
"""Three coordinates to draw a complex by, whatever space it lies in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias, get_args

import numpy as np

from remanifold import _core
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line, rounded
from remanifold._base.validation import check_choice
from remanifold.complex.data import check_complex
from remanifold.complex.measures import edge_lengths

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.complex.data import ComplexData

EmbeddingMethod: TypeAlias = Literal["auto", "pca", "geodesic"]
METHODS: tuple[str, ...] = get_args(EmbeddingMethod)
ENOUGH = 0.95  # of the variance: PCA then needs no rival
MOST_LANDMARKS, LEAST_LANDMARKS = 100, 20
LANDMARK_WORK = 2_000_000  # vertices times landmarks
TIE = 1e-9  # relative difference of distances below which they count as the same
EXACT_PCA = 2_000  # rows or columns up to which all eigenvalues are computed


@dataclass(frozen=True, eq=False, repr=False)
class Embedding(ReadOnlyArrays):
    """Positions in space that stand for those of a complex. Arrays are read-only.

    Attributes
    ----------
    points : ndarray, shape (N, 3), float64
        Position of each vertex. With ``"geodesic"`` NaN for vertices in no simplex.
    method : {"coordinates", "pca", "geodesic"}
        How they were found; "coordinates" where the vertices have at most three, which
        are kept, zeros appended.
    label : str
        The same in words, with what is kept; empty where that is everything.
    kept : float
        Share of the variance of the vertices ("pca"), or of the sum of the positive
        eigenvalues of the doubly centered geodesic distances ("geodesic").
    """

    points: NDArray[np.float64]
    method: str
    label: str
    kept: float

    def __repr__(self) -> str:
        return one_line(
            self, points=len(self.points), method=self.method, kept=rounded(self.kept)
        )


def embed(complex: ComplexData, method: EmbeddingMethod = "auto") -> Embedding:
    """Find three coordinates for a complex in more dimensions.

    Parameters
    ----------
    complex : SimplicialComplex or Reconstruction
        A complex, also one known by inner products or distances only: these give
        coordinates by classical scaling.
    method : {"auto", "pca", "geodesic"}
        The three principal axes of the vertices; classical scaling of distances along
        the edges, from landmarks that are far from each other, components side by side;
        or the coordinates themselves where there are at most three, PCA where it keeps
        95 % of the variance, and else the one that keeps the lengths of the edges better
        up to a common factor.

    Returns
    -------
    Embedding
        The same for the same complex; the signs of the axes are fixed.

    Raises
    ------
    TypeError
        No complex.
    ValueError
        Unknown method.

    References
    ----------
    J. B. Tenenbaum, V. de Silva, J. C. Langford, A global geometric framework for
    nonlinear dimensionality reduction, Science 290, 2000.

    V. de Silva, J. B. Tenenbaum, Sparse multidimensional scaling using landmark points,
    Stanford University, 2004.

    Examples
    --------
    >>> import remanifold as rm
    >>> rec = rm.reconstruct(rm.datasets.flat_torus(400, random_state=0), 2)
    >>> rm.embed(rec, "pca").label
    'PCA to 3 of 4 dimensions, 78 % of the variance'
    """
    check_complex(complex)
    check_choice(method, "method", METHODS)
    coordinates = complex.coordinates
    count, dim = coordinates.shape
    if method == "auto" and dim <= 3:
        points = np.zeros((count, 3))
        points[:, :dim] = coordinates
        return Embedding(points, "coordinates", "", 1.0)
    used = np.zeros(count, dtype=bool)
    used[complex.simplices.ravel()] = True
    if not used.any():
        used[:] = True
    by_pca = _pca(coordinates, used, complex)
    if method == "pca" or len(complex.simplices) == 0:
        return by_pca
    if method == "auto" and by_pca.kept >= ENOUGH:
        return by_pca
    edges = _core.edges(complex.simplices, complex.num_vertices)
    lengths = edge_lengths(coordinates, edges)
    by_geodesics = _geodesic(complex, edges, lengths)
    if method == "geodesic":
        return by_geodesics
    better = _likeness(by_geodesics.points, edges, lengths) > _likeness(
        by_pca.points, edges, lengths
    )
    return by_geodesics if better else by_pca


def _likeness(
    points: NDArray[np.float64],
    edges: NDArray[np.int32],
    lengths: NDArray[np.float64],
) -> float:
    """Squared cosine between the lengths of the edges as drawn and as they are."""
    drawn = edge_lengths(points, edges)
    size = float(drawn @ drawn) * float(lengths @ lengths)
    return float(drawn @ lengths) ** 2 / size if size > 0 else 0.0


def _percent(share: float) -> str:
    """Never 100 % where something is lost."""
    return f"{min(99, round(100 * share)) if share < 1 - 1e-9 else 100} %"


def fixed_signs(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn columns so that the first of their largest entries is positive."""
    size = np.abs(vectors)
    first = (size >= size.max(axis=0) * (1 - 1e-6)).argmax(axis=0)
    signs = np.sign(vectors[first, np.arange(vectors.shape[1])])
    return np.asarray(np.where(signs == 0, 1.0, signs))


# ---------------------------------------------------------------------------- PCA


def _pca(
    points: NDArray[np.float64], used: NDArray[np.bool_], complex: ComplexData
) -> Embedding:
    """Axes of the vertices in simplices, so that no outlier turns them."""
    size = (
        float(np.abs(points[used]).max()) or 1.0
    )  # squares neither overflow nor vanish
    centered = points / size
    centered -= centered[used].mean(axis=0)
    own = centered[used]
    axes = _principal_axes(own)
    axes = axes * fixed_signs(axes)
    coordinates = centered @ axes
    total = float((own**2).sum())
    kept = float((coordinates[used] ** 2).sum()) / total if total > 0 else 1.0
    kept = min(kept, 1.0)
    drawn = np.zeros((len(points), 3))
    drawn[:, : axes.shape[1]] = coordinates * size
    dim = points.shape[1]
    how = f"PCA to {axes.shape[1]} of {dim} dimensions"
    if complex.vertices is None:
        how = (
            f"Classical scaling of the {complex._source.words} to {axes.shape[1]} "
            f"of {dim} dimensions"
        )
    return Embedding(drawn, "pca", f"{how}, {_percent(kept)} of the variance", kept)


def _principal_axes(centered: NDArray[np.float64]) -> NDArray[np.float64]:
    """Orthonormal columns, at most three, the widest first."""
    rows, columns = centered.shape
    count = min(3, rows, columns)
    if columns <= min(rows, EXACT_PCA) or columns <= 3:
        _, vectors = np.linalg.eigh(centered.T @ centered)
        return np.asarray(vectors[:, ::-1][:, :count])
    if rows <= EXACT_PCA:
        _, vectors = np.linalg.eigh(centered @ centered.T)
        spanned, _ = np.linalg.qr(centered.T @ vectors[:, ::-1][:, :count])
        return np.asarray(spanned)
    # Subspace iteration: ten rounds on a block wider than what is asked for.
    block = np.random.default_rng(0).normal(size=(columns, 16))
    for _ in range(10):
        block, _ = np.linalg.qr(centered.T @ (centered @ block))
    _, _, rotation = np.linalg.svd(centered @ block, full_matrices=False)
    return np.asarray(block @ rotation[:count].T)


# ---------------------------------------------------------------------- geodesics


class _Graph(NamedTuple):
    """Neighbors of each vertex in a row, compressed."""

    offsets: NDArray[np.int64]
    heads: NDArray[np.int32]
    lengths: NDArray[np.float64]


def _graph(
    edges: NDArray[np.int32], lengths: NDArray[np.float64], count: int
) -> _Graph:
    tails = edges.ravel()
    order = np.argsort(tails, kind="stable")
    heads = edges[:, ::-1].ravel()[order]
    offsets = np.concatenate([[0], np.cumsum(np.bincount(tails, minlength=count))])
    return _Graph(offsets, heads, np.repeat(lengths, 2)[order])


def _distances_from(graph: _Graph, source: int) -> NDArray[np.float64]:
    """Lengths of shortest paths (Bellman and Ford, over what changed last)."""
    distances = np.full(len(graph.offsets) - 1, np.inf)
    distances[source] = 0.0
    active = np.array([source])
    while len(active):
        starts = graph.offsets[active]
        degrees = graph.offsets[active + 1] - starts
        before = np.cumsum(degrees) - degrees
        places = np.repeat(starts - before, degrees) + np.arange(degrees.sum())
        heads = graph.heads[places]
        reached = np.repeat(distances[active], degrees) + graph.lengths[places]
        nearer = reached < distances[heads]
        heads, reached = heads[nearer], reached[nearer]
        order = np.lexsort((reached, heads))  # the nearest of each head first
        heads, reached = heads[order], reached[order]
        first = np.ones(len(heads), dtype=bool)
        first[1:] = heads[1:] != heads[:-1]
        active = heads[first]
        distances[active] = reached[first]
    return distances


def _geodesic(
    complex: ComplexData,
    edges: NDArray[np.int32],
    lengths: NDArray[np.float64],
) -> Embedding:
    """Each component by itself, then side by side."""
    count = complex.num_vertices
    graph = _graph(edges, lengths, count)
    labels = complex.component_labels()
    order = np.argsort(labels, kind="stable")
    order = order[labels[order] >= 0]
    members = np.split(order, np.flatnonzero(np.diff(labels[order])) + 1)
    budget = int(np.clip(LANDMARK_WORK // count, LEAST_LANDMARKS, MOST_LANDMARKS))
    points = np.full((count, 3), np.nan)
    kept = 0.0
    most = 0
    for own in members:
        landmarks = min(budget, len(own))
        points[own], share = _scale_component(graph, own, landmarks)
        kept += share * len(own) / len(order)
        most = max(most, landmarks)
    aside = ""
    if len(members) > 1:
        _set_side_by_side(points, members)
        aside = ", components side by side"
    label = (
        f"Geodesic distances from {most} landmarks, classical scaling, "
        f"{_percent(min(kept, 1.0))} of their variance{aside}"
    )
    return Embedding(points, "geodesic", label, min(kept, 1.0))


def farthest(distances: NDArray[np.float64]) -> int:
    """The lowest index of those farthest away: ties, as on grids, are not for rounding."""
    return int(np.argmax(distances >= (1 - TIE) * distances.max()))


def _scale_component(
    graph: _Graph, own: NDArray[np.intp], landmarks: int
) -> tuple[NDArray[np.float64], float]:
    """Landmark classical scaling: each landmark is the vertex farthest from the others."""
    # The first stands at an end, whatever vertex has the lowest index.
    next_one = farthest(_distances_from(graph, int(own[0]))[own])
    rows: list[NDArray[np.float64]] = []
    chosen: list[int] = []
    nearest = np.full(len(own), np.inf)
    for _ in range(landmarks):
        chosen.append(next_one)
        rows.append(_distances_from(graph, int(own[next_one]))[own])
        nearest = np.minimum(nearest, rows[-1])
        next_one = farthest(nearest)
        if nearest[next_one] == 0:
            break
    squared = np.array(rows) ** 2
    between = squared[:, chosen]
    mean = between.mean(axis=1)
    centered = -(between - mean - mean[:, None] + mean.mean()) / 2
    values, vectors = np.linalg.eigh((centered + centered.T) / 2)
    values, vectors = values[::-1], vectors[:, ::-1]
    positive = values > len(values) * np.finfo(float).eps * max(values[0], 0.0)
    total = float(values[positive].sum())
    points = np.zeros((len(own), 3))
    top = np.flatnonzero(positive[:3])
    if len(top) == 0:
        return points, 1.0
    axes = vectors[:, top] * fixed_signs(vectors[:, top])
    points[:, top] = ((mean[:, None] - squared) / 2).T @ (axes / np.sqrt(values[top]))
    return points, float(values[top].sum()) / total


def _set_side_by_side(
    points: NDArray[np.float64], members: list[NDArray[np.intp]]
) -> None:
    """In rows of a square, in the order of the components."""
    extents = [np.ptp(points[own], axis=0)[:2].max() for own in members]
    step = 1.15 * float(max(extents))
    columns = int(np.ceil(np.sqrt(len(members))))
    for place, own in enumerate(members):
        middle = (points[own].max(axis=0) + points[own].min(axis=0)) / 2
        row, column = divmod(place, columns)
        points[own] += np.array([column * step, -row * step, 0.0]) - middle
