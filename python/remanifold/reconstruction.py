# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole method in one call."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold import _core
from remanifold._progress import progress_callback
from remanifold._read_only import ReadOnlyArrays
from remanifold._validation import (
    check_choice,
    check_dim,
    check_int,
    check_num_neighbors,
    check_num_threads,
    check_samples,
)
from remanifold.steps import (
    CHECKS,
    EDGE_RULES,
    ESTIMATORS,
    SEARCHES,
    EdgeSets,
    Stars,
    warn_of_recall,
)
from remanifold.topology import Topology, topology_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold._progress import Callback

METHODS = ("paper",)


@dataclass(frozen=True, eq=False)
class Repair(ReadOnlyArrays):
    """What the result lacks or has too much of.

    The paper's method repairs nothing; this says what it leaves.

    Attributes
    ----------
    method : str
        Method of the reconstruction.
    callous_faces : ndarray, shape (F, K), int32
        (K-1)-faces in more than two simplices.
    unstarred_simplices : ndarray, shape (U, K+1), int32
        Simplices that are cliques of the graph but in the star of none of their
        vertices.
    open_faces : ndarray, shape (H, K), int32
        (K-1)-faces in one simplex only.
    num_holes : int
        Connected sets of open faces away from all boundary samples.
    num_boundary_components : int
        Connected sets of open faces with a vertex that is a boundary sample or has one
        in its edge set.
    unused_vertices : ndarray of int32
        Samples in no simplex; merged copies are not listed.
    merged_samples : int
        Samples that coincide with one of lower index and were merged with it.
    """

    method: str
    callous_faces: NDArray[np.int32]
    unstarred_simplices: NDArray[np.int32]
    open_faces: NDArray[np.int32]
    num_holes: int
    num_boundary_components: int
    unused_vertices: NDArray[np.int32]
    merged_samples: int

    @property
    def num_callouses(self) -> int:
        """Faces in more than two simplices, and cliques in no star."""
        return len(self.callous_faces) + len(self.unstarred_simplices)


@dataclass(frozen=True, eq=False, repr=False)
class Reconstruction(ReadOnlyArrays):
    """A reconstructed manifold and the intermediate results. Arrays are read-only.

    Attributes
    ----------
    vertices : ndarray, shape (N, D), float64, or None
        The samples, a view of the given array where that was C-contiguous float64; None
        where only `gram` or `distances` were given.
    simplices : ndarray, shape (M, K+1), int32
        K-simplices, columns ascending, rows sorted.
    edges : ndarray, shape (E, 2), int32
        Edges of the graph whose cliques are the simplices, i < j, sorted.
    boundary : ndarray, shape (N,), bool
        Samples without a tangent basis, the paper's BD.
    tangents : ndarray, shape (N, K, D), float64, or None
        Orthonormal bases of the tangent spaces, NaN on the boundary.
    tangent_simplices : ndarray, shape (N, K+1), int32
        Tangent basis tuples, nearest first; -1 where there is none.
    edge_sets : EdgeSets
        Edge set of each sample.
    stars : Stars
        K-simplices dual to the vertices of each local region, its sample first.
    unbounded : ndarray, shape (N,), bool
        Samples whose local region is unbounded.
    representatives : ndarray, shape (N,), int32
        Lowest index of the samples that coincide with each sample.
    dim, ambient_dim : int
        K and D (None where only products are known).
    method, estimator, edge_rule, search : str
        How the result was made.
    num_neighbors : int
        Neighbors per sample for the tangent spaces.
    recall : float
        Share of true neighbors found, below 1 only for the approximate search.
    timings : dict of str to float
        Wall seconds of each step. Whatever reads coordinates counts as neighborhoods.
    """

    vertices: NDArray[np.float64] | None
    simplices: NDArray[np.int32]
    edges: NDArray[np.int32]
    boundary: NDArray[np.bool_]
    tangents: NDArray[np.float64] | None
    tangent_simplices: NDArray[np.int32]
    edge_sets: EdgeSets
    stars: Stars
    unbounded: NDArray[np.bool_]
    representatives: NDArray[np.int32]
    dim: int
    ambient_dim: int | None
    method: str
    estimator: str
    edge_rule: str
    search: str
    num_neighbors: int
    recall: float
    timings: dict[str, float]

    def __repr__(self) -> str:
        ambient = (
            "" if self.ambient_dim is None else f", ambient_dim={self.ambient_dim}"
        )
        return (
            f"Reconstruction(samples={self.num_samples}{ambient}, dim={self.dim}, "
            f"simplices={len(self.simplices)}, method={self.method!r})"
        )

    @property
    def num_samples(self) -> int:
        """N, copies included."""
        return len(self.boundary)

    def topology(self) -> Topology:
        """Topology of the complex; computed once."""
        return self._topology

    @functools.cached_property
    def _topology(self) -> Topology:
        return topology_of(self.simplices, self.num_samples)

    @functools.cached_property
    def repair(self) -> Repair:
        """Report of callouses, holes and samples left out; computed once."""
        report = _core.paper_report(
            self.simplices, *self.edge_sets, *self.stars, self.boundary, 0, None
        )
        indices = np.arange(self.num_samples, dtype=np.int32)
        used = np.zeros(self.num_samples, dtype=bool)
        used[self.simplices.ravel()] = True
        own = self.representatives == indices
        return Repair(
            method=self.method,
            **report,
            unused_vertices=indices[own & ~used],
            merged_samples=int(np.count_nonzero(~own)),
        )

    def component_labels(self) -> NDArray[np.int32]:
        """Component of each sample, in order of lowest vertex; -1 in no simplex."""
        return _core.component_labels(self.simplices, self.num_samples)


def reconstruct(
    points: ArrayLike | None = None,
    dim: int | None = None,
    *,
    method: str = "paper",
    gram: ArrayLike | None = None,
    distances: ArrayLike | None = None,
    num_neighbors: int | None = None,
    estimator: str = "enclosure",
    edges: str = "mutual",
    search: str = "auto",
    checks: int = CHECKS,
    num_threads: int | None = None,
    progress: bool | Callback | None = None,
) -> Reconstruction:
    """Reconstruct a K-manifold from its samples.

    Parameters
    ----------
    points : array_like, shape (N, D)
        Samples; complex samples count as real ones of dimension 2 D.
    dim : int
        K, the dimension of the manifold.
    method : {"paper"}
        The simplicial complex SC(X) of Freedman (2002).
    gram, distances : array_like, shape (N, N), optional
        Inner products or distances of the samples, instead of `points`. `gram` must be
        positive semidefinite, and Hermitian if complex.
    num_neighbors : int, optional
        Neighbors per sample for the tangent spaces (the paper's r K); 10 K by default.
    estimator : {"enclosure", "pca", "jet"}
        Tangent spaces, see `tangent_spaces`.
    edges : {"mutual", "either"}
        Edges seen from both ends, or from at least one.
    search : {"auto", "kdtree", "brute_force", "approximate"}
        Neighbor search, see `neighborhoods`.
    checks : int
        Leaves the approximate search visits.
    num_threads : int, optional
        All cores by default. The result does not depend on it.
    progress : bool or callable, optional
        True for a bar, or a function of (step, done, total).

    Returns
    -------
    Reconstruction

    Raises
    ------
    ValueError
        Samples empty, masked, not finite, of the wrong shape or too few; `dim` out of
        range; `gram` not positive semidefinite or not Hermitian.
    TypeError
        Not numbers; `dim` not an integer.

    References
    ----------
    D. Freedman, Efficient Simplicial Reconstructions of Manifolds from Their Samples,
    IEEE Transactions on Pattern Analysis and Machine Intelligence 24(10), 2002.

    Examples
    --------
    >>> import remanifold as rm
    >>> rec = rm.reconstruct(rm.datasets.circle(100, random_state=0), 1)
    >>> rec.topology().betti_numbers
    (1, 1)
    """
    check_choice(method, "method", METHODS)
    check_choice(estimator, "estimator", ESTIMATORS)
    check_choice(edges, "edges", EDGE_RULES)
    check_choice(search, "search", SEARCHES)
    samples = check_samples(points, gram, distances)
    k = check_dim(dim, samples)
    neighbors = check_num_neighbors(num_neighbors, k)
    with progress_callback(progress) as callback:
        result: dict[str, Any] = _core.reconstruct_paper(
            samples.kind,
            samples.matrix,
            k,
            neighbors,
            estimator,
            edges,
            search,
            check_int(checks, "checks", minimum=1),
            check_num_threads(num_threads),
            callback,
        )
    warn_of_recall(result["search"], result["recall"])
    vertices = None
    if samples.kind == "points":
        vertices = samples.matrix.view()
    return Reconstruction(
        vertices=vertices,
        simplices=result["simplices"],
        edges=result["edges"],
        boundary=result["boundary"],
        tangents=result["tangents"],
        tangent_simplices=result["tangent_simplices"],
        edge_sets=EdgeSets(result["edge_set_offsets"], result["edge_set_indices"]),
        stars=Stars(result["star_offsets"], result["star_simplices"]),
        unbounded=result["unbounded"],
        representatives=result["representatives"],
        dim=k,
        ambient_dim=None if vertices is None else vertices.shape[1],
        method=method,
        estimator=estimator,
        edge_rule=edges,
        search=result["search"],
        num_neighbors=neighbors,
        recall=result["recall"],
        timings=result["timings"],
    )
