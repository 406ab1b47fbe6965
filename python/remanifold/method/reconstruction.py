# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole method in one call."""

from __future__ import annotations

import functools
import os
import warnings
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold import _core
from remanifold._base.progress import progress_callback
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.validation import (
    check_boundary,
    check_choice,
    check_dim,
    check_int,
    check_num_neighbors,
    check_num_threads,
    check_outliers,
    check_positive,
    check_samples,
    check_smooth,
)
from remanifold.complex.simplicial_complex import SimplicialComplex
from remanifold.io.writing import holds_fields
from remanifold.judging.quality import Quality, assess
from remanifold.method.cleaning import as_points, smoothing_of
from remanifold.method.dimension import find_dimension
from remanifold.method.programs import solve_program
from remanifold.method.steps import (
    CHECKS,
    EDGE_RULES,
    ESTIMATORS,
    SEARCHES,
    EdgeSets,
    Stars,
    warn_of_recall,
)
from remanifold.warnings import ManifoldWarning

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.progress import Callback
    from remanifold.io._source import StrPath
    from remanifold.method.cleaning import Smoothing

METHODS = ("manifold", "paper")
_QUALITY_FIELDS = (
    *("spacing", "curvature", "reach", "sampling_ratio", "tangent_confidence"),
    *("disputed", "fold", "gap", "doubtful"),
)


@dataclass(frozen=True, eq=False)
class Repair(ReadOnlyArrays):
    """What was disputed, what was done about it, and what the result lacks.

    The paper's method repairs nothing: there this says what it leaves.

    Attributes
    ----------
    method : str
        Method of the reconstruction.
    open_faces : ndarray, shape (H, K), int32
        (K-1)-faces in one simplex only.
    num_boundary_components : int
        Connected sets of open faces that count as boundary. Manifold method: all with
        ``boundary="auto"``, those within the mask with a mask, none with
        ``boundary=False``. Paper: those with a vertex that is a boundary sample or has
        one in its edge set.
    num_holes : int
        The other connected sets of open faces.
    hole_faces : ndarray, shape (G, K), int32
        The faces of these.
    callous_faces : ndarray, shape (F, K), int32
        (K-1)-faces in more than two simplices.
    unstarred_simplices : ndarray, shape (U, K+1), int32
        Paper: simplices that are cliques of the graph but in the star of none of their
        vertices.
    singular_vertices : ndarray of int32
        Manifold method: vertices whose link is neither a sphere nor a ball, by the same
        test as `Topology.singular_vertices` up to K = 3.
    unused_vertices : ndarray of int32
        Samples in no simplex but for merged copies and `Reconstruction.outliers`. With
        the manifold method they are too far from all simplices around their neighbors.
    merged_samples : int
        Samples that coincide with one of lower index and were merged with it.
    hole_radius : float
        Manifold method: radius of the smallest round hole left open, in local scales.
    num_agreed : int
        Manifold method: star simplices that are in the stars of all their vertices.
    disputed_simplices : ndarray, shape (P, K+1), int32
        Manifold method: star simplices that are not.
    filled_simplices : ndarray, shape (C, K+1), int32
        Manifold method: simplices that the chain of least energy chose.
    inserted_vertices : ndarray of int32
        Manifold method: samples that the chain left out, put back by subdivision.
    num_cavities, num_programs, num_integer_programs : int
        Manifold method: cavities filled; those of them that were linear programs, and
        integer programs.
    num_unsolved : int
        Programs without a solution within the solver's limits.
    """

    method: str
    open_faces: NDArray[np.int32]
    num_boundary_components: int
    num_holes: int
    hole_faces: NDArray[np.int32]
    callous_faces: NDArray[np.int32]
    unstarred_simplices: NDArray[np.int32]
    singular_vertices: NDArray[np.int32]
    unused_vertices: NDArray[np.int32]
    merged_samples: int
    hole_radius: float
    num_agreed: int
    disputed_simplices: NDArray[np.int32]
    filled_simplices: NDArray[np.int32]
    inserted_vertices: NDArray[np.int32]
    num_cavities: int
    num_programs: int
    num_integer_programs: int
    num_unsolved: int

    @property
    def num_callouses(self) -> int:
        """Faces in more than two simplices, and cliques in no star."""
        return len(self.callous_faces) + len(self.unstarred_simplices)

    def remaining(self) -> list[tuple[str, tuple[int, ...]]]:
        """All that is left to mend: the reason and the vertices of each place."""
        return [
            *(("open face", tuple(f)) for f in self.hole_faces.tolist()),
            *(("callous face", tuple(f)) for f in self.callous_faces.tolist()),
            *(
                ("unstarred simplex", tuple(s))
                for s in self.unstarred_simplices.tolist()
            ),
            *(("singular vertex", (v,)) for v in self.singular_vertices.tolist()),
            *(("unused vertex", (v,)) for v in self.unused_vertices.tolist()),
        ]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Reconstruction(SimplicialComplex):
    """A reconstructed manifold and the intermediate results. Arrays are read-only.

    Attributes
    ----------
    vertices : ndarray, shape (N, D), float64, or None
        Where the samples stand in the complex: `samples`, or `smoothing.points`.
    samples : ndarray, shape (N, D), float64, or None
        The samples, a view of the given array where that was C-contiguous float64; None
        where only `gram` or `distances` were given. They are as good vertices as
        `vertices`, noise included.
    simplices : ndarray, shape (M, K+1), int32
        K-simplices, rows in the order of their sorted vertices. Columns ascend, but with
        the manifold method the last two may have changed places: where a set of simplices
        connected through faces is orientable, the order of the columns orients them
        alike, with positive volume where K = D and where K = D - 1 and the set is closed
        (outward normals).
    boundary : ndarray, shape (N,), bool
        Samples on an open face (paper: samples without a tangent basis, BD).
    representatives : ndarray, shape (N,), int32
        Lowest index of the samples that coincide with each sample.
    outliers : ndarray of int32
        Samples left out, ascending: they do not lie on the manifold of the others.
    smoothing : Smoothing or None
        How noisy the samples were and what was done about it; None with
        ``smooth=False``.
    method, estimator, search : str
        How the result was made.
    num_neighbors : int
        Neighbors per sample for the tangent spaces.
    recall : float
        Share of true neighbors found, below 1 only for the approximate search.
    timings : dict of str to float
        Wall seconds of each step. Whatever reads coordinates counts as neighborhoods.
    tangent_simplices : ndarray, shape (N, K+1), int32
        Paper: tangent basis tuples, nearest first; -1 where there is none. This and what
        follows is None with the manifold method.
    edge_sets : EdgeSets
        Paper: edge set of each sample.
    stars : Stars
        Paper: K-simplices dual to the vertices of each local region, its sample first.
    unbounded : ndarray, shape (N,), bool
        Paper: samples whose local region is unbounded.
    edge_rule : str
        Paper: which edges count. `edges` are those of the graph whose cliques the
        simplices are.
    """

    samples: NDArray[np.float64] | None
    boundary: NDArray[np.bool_]
    representatives: NDArray[np.int32]
    outliers: NDArray[np.int32]
    smoothing: Smoothing | None
    method: str
    estimator: str
    search: str
    num_neighbors: int
    recall: float
    timings: dict[str, float]
    tangent_simplices: NDArray[np.int32] | None = None
    edge_sets: EdgeSets | None = None
    stars: Stars | None = None
    unbounded: NDArray[np.bool_] | None = None
    edge_rule: str | None = None
    _report: dict[str, Any] = field(default_factory=dict)
    _frames: tuple[NDArray[np.float64], NDArray[np.int32], float] | None = None

    def __post_init__(self) -> None:
        """The arrays come from the core: nothing to check."""
        ReadOnlyArrays.__post_init__(self)

    def __repr__(self) -> str:
        ambient = (
            "" if self.ambient_dim is None else f", ambient_dim={self.ambient_dim}"
        )
        return (
            f"Reconstruction(samples={self.num_samples}{ambient}, dim={self.dim}, "
            f"simplices={len(self.simplices)}, method={self.method!r})"
        )

    def report(
        self,
        path: str | os.PathLike[str],
        title: str | None = None,
        command: str | None = None,
    ) -> None:
        """Write a page that shows the result and says how far to trust it.

        Parameters
        ----------
        path, title, command
            As in `remanifold.write_report`.
        """
        from remanifold.page.report_page import write_report

        write_report(self, path, title, command)

    @property
    def num_samples(self) -> int:
        """N, copies included."""
        return len(self.boundary)

    @property
    def num_vertices(self) -> int:
        """The same: samples in no simplex count."""
        return self.num_samples

    @functools.cached_property
    def tangents(self) -> NDArray[np.float64] | None:
        """Orthonormal bases of the tangent spaces, (N, K, D); NaN where there is none.

        None where only products are known. With many coordinates they are written out,
        from `vertices`, when first asked for.
        """
        if self.vertices is None or self._frames is None:
            return None
        bases = _core.tangent_bases(self.vertices, *self._frames, 0, None)
        bases.flags.writeable = False
        return bases

    @functools.cached_property
    def repair(self) -> Repair:
        """What was disputed and mended, and what the result lacks; computed once."""
        own = self.representatives == np.arange(self.num_samples)
        merged = int(np.count_nonzero(~own))
        if self.edge_sets is None or self.stars is None:
            return Repair(method=self.method, merged_samples=merged, **self._report)
        report = _core.paper_report(
            self.simplices,
            *self.edge_sets,
            *self.stars,
            self.boundary,
            0,
            None,
        )
        used = np.zeros(self.num_samples, dtype=bool)
        used[self.simplices.ravel()] = True
        used[self.outliers] = True  # reported as such
        none = np.empty(0, dtype=np.int32)
        no_simplices = np.empty((0, self.dim + 1), dtype=np.int32)
        return Repair(
            method=self.method,
            **report,
            singular_vertices=none,
            unused_vertices=np.flatnonzero(own & ~used).astype(np.int32),
            merged_samples=merged,
            hole_radius=float("nan"),
            num_agreed=0,
            disputed_simplices=no_simplices,
            filled_simplices=no_simplices,
            inserted_vertices=none,
            num_cavities=0,
            num_programs=0,
            num_integer_programs=0,
            num_unsolved=0,
        )

    @functools.cached_property
    def quality(self) -> Quality:
        """Whether and where the samples are dense enough for the result; computed once.

        Takes about as long as the reconstruction.
        """
        return assess(self)

    def write(
        self,
        path: StrPath,
        fields: str | Mapping[str, ArrayLike] | None = "auto",
        *,
        format: str | None = None,
    ) -> None:
        """Write the complex to a file; its suffix names the format.

        Parameters
        ----------
        path : str or path-like
            The file, see `SimplicialComplex.write`.
        fields : "auto", "all", None or mapping of str to array_like
            Values at the vertices. "auto": those of `fields` that cost nothing, where
            the format has fields. "all": those of `quality` too, which takes about as
            long as the reconstruction if it has not been asked for before.
        format : str, optional
            The format by its suffix, such as "ply", whatever the name of the file.

        Raises
        ------
        ValueError
            If the format cannot hold the complex or the fields.
        OSError
            If the file cannot be written. Nothing is left behind.
        """
        if isinstance(fields, str):
            check_choice(fields, "fields", ("auto", "all"))
            if fields == "all" or holds_fields(path, format):
                fields = self.fields(quality=True if fields == "all" else None)
            else:
                fields = None
        super().write(path, fields, format=format)

    def fields(self, *, quality: bool | None = None) -> dict[str, NDArray[Any]]:
        """Values at the vertices, by their names, as files and viewers take them.

        Parameters
        ----------
        quality : bool, optional
            With the arrays of `quality`: by default if it has been computed already.

        Returns
        -------
        dict of str to ndarray
            Arrays of shape (N,). Always ``boundary`` and ``outlier``; with `quality`
            ``spacing``, ``curvature``, ``reach``, ``sampling_ratio``,
            ``tangent_confidence``, ``disputed``, ``fold``, ``gap`` and ``doubtful``.
        """
        outlier = np.zeros(self.num_samples, dtype=np.bool_)
        outlier[self.outliers] = True
        fields: dict[str, NDArray[Any]] = {
            "boundary": self.boundary,
            "outlier": outlier,
        }
        if quality is None:
            quality = "quality" in vars(self)
        if quality:
            fields |= {name: getattr(self.quality, name) for name in _QUALITY_FIELDS}
        return fields


def reconstruct(
    points: ArrayLike | None = None,
    dim: int | str | None = None,
    *,
    method: str = "manifold",
    boundary: str | bool | ArrayLike = "auto",
    hole_radius: float | None = None,
    outliers: str | bool | float | None = None,
    smooth: str | bool | int = False,
    gram: ArrayLike | None = None,
    distances: ArrayLike | None = None,
    num_neighbors: int | None = None,
    estimator: str | None = None,
    edges: str | None = None,
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
    dim : int or "auto"
        K, the dimension of the manifold; "auto" for that of `estimate_dimension`, with a
        `DimensionWarning` where its confidence is below a half.
    method : {"manifold", "paper"}
        The chain of least energy through the simplices that all samples agree on, or the
        simplicial complex SC(X) of Freedman (2002).
    boundary : {"auto", False} or array_like of bool, shape (N,)
        Manifold method: holes wider than `hole_radius` stay open; everything is closed;
        or faces may be open where all their vertices are marked.
    hole_radius : float, optional
        Radius of the smallest round hole that ``boundary="auto"`` leaves open, in units
        of the local scale (the distance to the (2K+2)-th neighbor, for K = 2 about 1.4
        times the root of the area per sample; for K = 1 to the sixth). By default from
        3 for samples that lie at random to 1.4 for even ones.
    outliers : "auto", False or float, optional
        Distance from the manifold of the others at which a sample is left out, in local
        scales; "auto", by default with the manifold method, is 2. See `find_outliers`.
    smooth : False, "auto", True or int
        Move the samples onto the manifold before: not at all, where they are noisy, in
        any case, or by fits to so many neighbors. See `remanifold.smooth`.
    gram, distances : array_like, shape (N, N), optional
        Inner products or distances of the samples, instead of `points`. `gram` must be
        positive semidefinite, and Hermitian if complex.
    num_neighbors : int, optional
        Neighbors per sample for the tangent spaces: by default 3 times the unknowns of a
        quadratic fit, 3 (K + K (K+1) / 2); with the paper's method its r K = 10 K.
    estimator : {"enclosure", "pca", "jet"}, optional
        Tangent spaces, see `tangent_spaces`. "jet" by default, the paper's "enclosure"
        with its method.
    edges : {"mutual", "either"}, optional
        Paper: edges seen from both ends (by default), or from at least one.
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
    manifold = method == "manifold"
    if estimator is None:
        estimator = "jet" if manifold else "enclosure"
    check_choice(estimator, "estimator", ESTIMATORS)
    check_choice(search, "search", SEARCHES)
    samples = check_samples(points, gram, distances)
    if isinstance(dim, str) and dim == "auto":
        dim = find_dimension(samples, check_num_threads(num_threads), progress)
    k = check_dim(dim, samples)
    if num_neighbors is None and manifold:
        num_neighbors = 3 * (k + k * (k + 1) // 2)
    neighbors = check_num_neighbors(num_neighbors, k)
    checks = check_int(checks, "checks", minimum=1)
    threads = check_num_threads(num_threads)
    rule, mask = check_boundary(boundary, len(samples.matrix))
    radius = 0.0 if hole_radius is None else check_positive(hole_radius, "hole_radius")
    if manifold and edges is not None:
        msg = 'edges is for method="paper" only'
        raise ValueError(msg)
    if not manifold and rule != "auto":
        msg = 'boundary is for method="manifold" only'
        raise ValueError(msg)
    edges = "mutual" if edges is None else edges
    check_choice(edges, "edges", EDGE_RULES)
    distance = check_outliers(
        ("auto" if manifold else False) if outliers is None else outliers
    )
    smoothing_neighbors, only_noise = check_smooth(smooth, k)
    given = as_points(samples) if smoothing_neighbors >= 0 else samples
    result: dict[str, Any]
    with progress_callback(progress) as callback:
        common = (given.kind, given.matrix, k, neighbors, estimator)
        cleaning = (distance, smoothing_neighbors, only_noise)
        if manifold:
            result = _core.reconstruct_manifold(
                *common,
                rule,
                mask,
                radius,
                *cleaning,
                search,
                checks,
                solve_program,
                threads,
                callback,
            )
        else:
            result = _core.reconstruct_paper(
                *common, edges, *cleaning, search, checks, threads, callback
            )
    warn_of_recall(result["search"], result["recall"])
    known = samples.kind == "points"
    smoothing = None
    if smoothing_neighbors >= 0:
        smoothing = smoothing_of(given, result["cleaning"], known)
    vertices = None
    if known:
        vertices = samples.matrix.view() if smoothing is None else smoothing.points
    report = {}
    paper: dict[str, Any] = {}
    if manifold:
        report = _finish_report(result["repair"], k, rule, mask)
        if len(result["simplices"]) == 0:
            warnings.warn(
                f"no {k}-dimensional simplices: the samples span too little, or are too "
                "far apart",
                ManifoldWarning,
                stacklevel=2,
            )
    else:
        paper = {
            "tangent_simplices": result["tangent_simplices"],
            "edge_sets": EdgeSets(
                result["edge_set_offsets"], result["edge_set_indices"]
            ),
            "stars": Stars(result["star_offsets"], result["star_simplices"]),
            "unbounded": result["unbounded"],
            "edge_rule": edges,
        }
    tangents = result["tangents"] if known else None
    frames = tangents if isinstance(tangents, tuple) else None
    rec = Reconstruction(
        vertices=vertices,
        samples=samples.matrix.view() if known else None,
        simplices=result["simplices"],
        boundary=result["boundary"],
        representatives=result["representatives"],
        outliers=result["cleaning"]["outliers"],
        smoothing=smoothing,
        method=method,
        estimator=estimator,
        search=result["search"],
        num_neighbors=neighbors,
        recall=result["recall"],
        timings=result["timings"],
        _report=report,
        _frames=frames,
        _products=None if known else (samples.kind, samples.matrix.view()),
        **paper,
    )
    # What is known already fills the places of the cached properties.
    computed = {"tangents": tangents, "edges": result.get("edges")}
    for name, array in computed.items():
        if isinstance(array, np.ndarray):
            array.flags.writeable = False
            vars(rec)[name] = array
    return rec


def _finish_report(
    report: dict[str, Any], dim: int, rule: str, mask: NDArray[np.bool_]
) -> dict[str, Any]:
    """Sort the open faces into boundary and holes, and warn of what is no manifold."""
    sets = _core.face_sets(report["open_faces"])
    count = int(sets.max()) + 1 if len(sets) else 0
    marked = np.full(len(sets), rule == "auto")
    if rule == "given":
        marked = mask[report["open_faces"]].all(axis=1)
    in_hole = np.isin(sets, sets[~marked])
    holes = len(np.unique(sets[~marked]))
    report |= {
        "num_boundary_components": count - holes,
        "num_holes": holes,
        "hole_faces": report["open_faces"][in_hole],
        "unstarred_simplices": np.empty((0, dim + 1), dtype=np.int32),
    }
    lacks = [
        f"{number} {what}"
        for number, what in (
            (len(report["callous_faces"]), "faces in more than two simplices"),
            (len(report["singular_vertices"]), "vertices without a proper link"),
            (holes, "holes where boundary= asks for none"),
            (report["num_unsolved"], "cavities without a solution"),
        )
        if number
    ]
    if lacks:
        warnings.warn(
            f"the result lacks something: {', '.join(lacks)}; see repair.remaining()",
            ManifoldWarning,
            stacklevel=3,
        )
    return report
