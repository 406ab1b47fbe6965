# SPDX-License-Identifier: GPL-3.0-or-later
"""The steps of the method, each a function of arrays."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from remanifold import _core
from remanifold._base.html import fragment, histogram, number, shares
from remanifold._base.progress import progress_callback
from remanifold._base.text import one_line
from remanifold._base.validation import (
    check_bases,
    check_choice,
    check_dim,
    check_index_array,
    check_int,
    check_num_neighbors,
    check_num_threads,
    check_points,
    check_samples,
)
from remanifold.method.options import (
    CHECKS,
    EDGE_RULES,
    ESTIMATORS,
    EXACT_SEARCHES,
    SEARCHES,
)
from remanifold.warnings import RecallWarning

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.progress import Callback
    from remanifold.method.options import EdgeRule, Estimator, ExactSearch, Search


class Neighborhoods(NamedTuple):
    """Nearest other samples of each sample, nearest first."""

    indices: NDArray[np.int32]
    distances: NDArray[np.float64]

    def __repr__(self) -> str:
        samples, neighbors = self.indices.shape
        return one_line(self, samples=samples, num_neighbors=neighbors)

    def _repr_html_(self) -> str:
        samples, neighbors = self.indices.shape
        answer = f"the {neighbors:,} nearest of each of {samples:,} samples"
        chart = histogram("distance to the farthest", self.distances[:, -1])
        median = float(np.median(self.distances[:, 0])) if samples else np.nan
        return fragment(answer, [("median nearest", number(median))], chart)


class TangentSpaces(NamedTuple):
    """Approximate tangent space of each sample."""

    bases: NDArray[np.float64] | None
    simplices: NDArray[np.int32]
    boundary: NDArray[np.bool_]

    def __repr__(self) -> str:
        return one_line(
            self,
            samples=len(self.boundary),
            ambient_dim=None if self.bases is None else self.bases.shape[2],
            dim=self.simplices.shape[1] - 1,
            boundary=int(np.count_nonzero(self.boundary)),
        )

    def _repr_html_(self) -> str:
        lacking, total = int(np.count_nonzero(self.boundary)), len(self.boundary)
        dim = self.simplices.shape[1] - 1
        answer = f"tangent spaces of dimension {dim} at {total - lacking:,} samples"
        parts = [("with one", total - lacking), ("without", lacking)]
        rows = [("samples", f"{total:,}"), ("without one", f"{lacking:,}")]
        return fragment(answer, rows, shares("Samples", parts))


class EdgeSets(NamedTuple):
    """Edge set of each sample, in compressed rows."""

    offsets: NDArray[np.int64]
    indices: NDArray[np.int32]

    def __repr__(self) -> str:
        return one_line(self, samples=len(self.offsets) - 1, indices=len(self.indices))

    def _repr_html_(self) -> str:
        sizes = np.diff(self.offsets).astype(np.float64)
        answer = f"{len(self.indices):,} edges, seen from {len(sizes):,} samples"
        return fragment(answer, [], histogram("edges of a sample", sizes))


class Stars(NamedTuple):
    """Star of each sample, in compressed rows; offsets count simplices."""

    offsets: NDArray[np.int64]
    simplices: NDArray[np.int32]

    def __repr__(self) -> str:
        return one_line(
            self,
            samples=len(self.offsets) - 1,
            dim=self.simplices.shape[1] - 1,
            simplices=len(self.simplices),
        )

    def _repr_html_(self) -> str:
        sizes = np.diff(self.offsets).astype(np.float64)
        answer = (
            f"{len(self.simplices):,} simplices, in stars of {len(sizes):,} samples"
        )
        return fragment(answer, [], histogram("simplices of a star", sizes))


class LocalRegions(NamedTuple):
    """Local region of each sample, by what it is dual to."""

    edge_sets: EdgeSets
    stars: Stars
    unbounded: NDArray[np.bool_]
    radii: NDArray[np.float64]

    def __repr__(self) -> str:
        return one_line(
            self,
            samples=len(self.radii),
            dim=self.stars.simplices.shape[1] - 1,
            edges=len(self.edge_sets.indices),
            simplices=len(self.stars.simplices),
            unbounded=int(np.count_nonzero(self.unbounded)),
        )

    def _repr_html_(self) -> str:
        unbounded = int(np.count_nonzero(self.unbounded))
        answer = (
            f"local regions of {len(self.radii):,} samples, {unbounded:,} unbounded"
        )
        rows = [
            ("edges", f"{len(self.edge_sets.indices):,}"),
            ("simplices", f"{len(self.stars.simplices):,}"),
        ]
        return fragment(answer, rows, histogram("radius", self.radii))


def warn_of_recall(search: str, recall: float, stacklevel: int = 3) -> None:
    """Say how much an approximate search missed."""
    if search == "approximate" and recall < 1:
        warnings.warn(
            f"the approximate search found {recall:.2%} of the neighbors of a "
            "few samples: some regions are too large; raise checks, or search exactly",
            RecallWarning,
            stacklevel=stacklevel,
        )


def neighborhoods(
    points: ArrayLike | None = None,
    num_neighbors: int | None = None,
    *,
    gram: ArrayLike | None = None,
    distances: ArrayLike | None = None,
    search: Search = "auto",
    checks: int = CHECKS,
    num_threads: int | None = None,
    progress: bool | Callback | None = None,
) -> Neighborhoods:
    """Exact nearest neighbors of every sample.

    Which of equally far samples is listed first, or at all, follows from where points are,
    not from their order: along a curve through all of them. Products and distances have
    ties by index. Coinciding samples count as one: no row lists a copy of its own sample,
    and copies stand in rows under their lowest index.

    Parameters
    ----------
    points : array_like, shape (N, D)
        Samples; complex samples count as real ones of dimension 2 D.
    num_neighbors : int
        Neighbors per sample, at least 1.
    gram, distances : array_like, shape (N, N), optional
        Inner products or distances of the samples, instead of `points`.
    search : {"auto", "kdtree", "brute_force", "approximate"}
        FLANN's single kd-tree (exact), blocked comparison with all samples (exact), or
        FLANN's k-means tree (not exact: a `RecallWarning` says how far off).
    checks : int
        Leaves the approximate search visits.
    num_threads : int, optional
        All cores by default. The result does not depend on it.
    progress : bool or callable, optional
        True for a bar, or a function of (step, done, total).

    Returns
    -------
    Neighborhoods
        ``indices`` (N, m) int32 and ``distances`` (N, m) float64 in the units of the
        samples, nearest first; m is `num_neighbors` or the number of other distinct
        samples, whichever is less.

    Examples
    --------
    >>> import remanifold as rm
    >>> rm.neighborhoods([[0.0], [1.0], [3.0]], 1).indices.ravel().tolist()
    [1, 0, 1]
    """
    samples = check_samples(points, gram, distances)
    count = check_int(num_neighbors, "num_neighbors", minimum=1)
    check_choice(search, "search", SEARCHES)
    with progress_callback(progress) as callback:
        indices, lengths, method, recall = _core.neighborhoods(
            samples,
            num_neighbors=count,
            search=search,
            checks=check_int(checks, "checks", minimum=1),
            num_threads=check_num_threads(num_threads),
            progress=callback,
        )
    warn_of_recall(method, recall)
    return Neighborhoods(indices, lengths)


def tangent_spaces(
    points: ArrayLike | None = None,
    dim: int | None = None,
    num_neighbors: int | None = None,
    estimator: Estimator = "enclosure",
    *,
    gram: ArrayLike | None = None,
    distances: ArrayLike | None = None,
    search: ExactSearch = "auto",
    num_threads: int | None = None,
    progress: bool | Callback | None = None,
) -> TangentSpaces:
    """Approximate tangent space of every sample (Freedman 2002, section 3.1).

    Parameters
    ----------
    points : array_like, shape (N, D)
        Samples; complex samples count as real ones of dimension 2 D.
    dim : int
        K, the dimension of the manifold.
    num_neighbors : int, optional
        m, the size of the neighborhoods; 10 K by default.
    estimator : {"enclosure", "pca", "jet"}
        The paper's first enclosing tuple; the K leading principal directions; or these
        tilted by two rounds of quadratic fits (error of second order in the spacing).
    gram, distances : array_like, shape (N, N), optional
        Inner products or distances of the samples, instead of `points`.
    search : {"auto", "kdtree", "brute_force"}
        An exact search, see `neighborhoods`.
    num_threads, progress
        As in `neighborhoods`.

    Returns
    -------
    TangentSpaces
        ``bases`` (N, K, D) float64 with orthonormal rows, NaN where there is none, and
        None for `gram` and `distances`; ``simplices`` (N, K+1) int32, the tangent basis
        tuples of the paper, nearest first, -1 where there is none and for the other
        estimators; ``boundary`` (N,) bool, the samples without a tangent basis.

    Examples
    --------
    >>> import remanifold as rm
    >>> rm.tangent_spaces([[0.0], [1.0], [3.0]], 1).simplices.tolist()
    [[-1, -1], [0, 2], [-1, -1]]
    """
    samples = check_samples(points, gram, distances)
    k = check_dim(dim, samples)
    check_choice(estimator, "estimator", ESTIMATORS)
    check_choice(search, "search", EXACT_SEARCHES)
    with progress_callback(progress) as callback:
        bases, simplices, boundary = _core.tangent_spaces(
            samples,
            dim=k,
            num_neighbors=check_num_neighbors(num_neighbors, k),
            estimator=estimator,
            search=search,
            checks=CHECKS,
            num_threads=check_num_threads(num_threads),
            progress=callback,
        )
    return TangentSpaces(bases, simplices, boundary)


def local_regions(
    points: ArrayLike,
    bases: ArrayLike,
    boundary: ArrayLike | None = None,
    *,
    search: ExactSearch = "auto",
    num_threads: int | None = None,
    progress: bool | Callback | None = None,
) -> LocalRegions:
    """Local region of every sample (Freedman 2002, section 3.2), exact over all samples.

    The region of x is its tangent space cut by the bisecting halfspaces of x with every
    other sample. It is given by its dual: the samples whose bisectors bound it (edge
    set) and the K-simplices dual to its vertices (star). Ties of cocircular samples are
    broken by weights of at most 1e-10 of the squared spacing.

    Parameters
    ----------
    points : array_like, shape (N, D)
        Samples.
    bases : array_like, shape (N, K, D)
        Orthonormal basis of each tangent space; NaN where there is none.
    boundary : array_like of bool, shape (N,), optional
        Samples that have no region, besides those without a basis.
    search : {"auto", "kdtree", "brute_force"}
        An exact search, see `neighborhoods`.
    num_threads, progress
        As in `neighborhoods`.

    Returns
    -------
    LocalRegions
        ``edge_sets``; ``stars``, with the sample itself in the first column;
        ``unbounded`` (N,) bool; ``radii`` (N,) float64, the distance of the farthest
        vertex of the region, infinite where it is unbounded, NaN where there is none.
    """
    array = check_points(points)
    frames, missing = check_bases(bases, boundary, array)
    check_choice(search, "search", EXACT_SEARCHES)
    with progress_callback(progress) as callback:
        offsets, indices, star_offsets, stars, radii = _core.local_regions(
            array,
            frames,
            missing,
            search=search,
            checks=CHECKS,
            num_threads=check_num_threads(num_threads),
            progress=callback,
        )
    return LocalRegions(
        EdgeSets(offsets, indices), Stars(star_offsets, stars), np.isinf(radii), radii
    )


def edge_sets(
    points: ArrayLike,
    bases: ArrayLike,
    boundary: ArrayLike | None = None,
    *,
    search: ExactSearch = "auto",
    num_threads: int | None = None,
    progress: bool | Callback | None = None,
) -> EdgeSets:
    """Edge set of every sample: the samples whose bisectors bound its local region.

    `local_regions` also gives the stars.

    Parameters
    ----------
    points, bases, boundary, search, num_threads, progress
        As in `local_regions`.

    Returns
    -------
    EdgeSets
        ``offsets`` (N+1,) int64 and ``indices`` int32: the edge set of sample i is
        ``indices[offsets[i]:offsets[i + 1]]``, ascending.
    """
    return local_regions(
        points,
        bases,
        boundary,
        search=search,
        num_threads=num_threads,
        progress=progress,
    ).edge_sets


def clique_complex(
    offsets: ArrayLike,
    indices: ArrayLike,
    dim: int,
    edges: EdgeRule = "mutual",
    *,
    num_threads: int | None = None,
    progress: bool | Callback | None = None,
) -> NDArray[np.int32]:
    """Cliques of dim + 1 samples in the graph of edge sets (Freedman 2002, section 3.3).

    Parameters
    ----------
    offsets, indices : array_like of int, shapes (N+1,) and (E,)
        Edge set of each sample, in compressed rows.
    dim : int
        K, the dimension of the simplices.
    edges : {"mutual", "either"}
        Join x and y where each is in the edge set of the other, or where at least one
        is.
    num_threads, progress
        As in `neighborhoods`.

    Returns
    -------
    ndarray, shape (M, K+1), int32
        Simplices, columns ascending, rows sorted.

    Examples
    --------
    >>> import remanifold as rm
    >>> rm.clique_complex([0, 2, 4, 6], [1, 2, 0, 2, 0, 1], 2).tolist()
    [[0, 1, 2]]
    """
    check_choice(edges, "edges", EDGE_RULES)
    with progress_callback(progress) as callback:
        return _core.clique_complex(
            check_index_array(offsets, "offsets", np.int64),
            check_index_array(indices, "indices", np.int32),
            dim=check_int(dim, "dim", minimum=1),
            edges=edges,
            num_threads=check_num_threads(num_threads),
            progress=callback,
        )
