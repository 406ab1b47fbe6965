# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole method in one call."""

from __future__ import annotations

import functools
import os
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold import _core
from remanifold._base.distinct import distinct
from remanifold._base.progress import progress_callback
from remanifold._base.samples import Points, looks_like_a_mark, looks_like_a_matrix
from remanifold._base.validation import (
    check_choice,
    check_dim,
    check_num_threads,
    check_positive,
    check_samples,
)
from remanifold.complex.data import ComplexData
from remanifold.complex.projection import project
from remanifold.formats.writing import check_fields
from remanifold.judging.quality import doubts_at_once, looks_like_a_boundary
from remanifold.method.cleaning import as_points, smoothing_of
from remanifold.method.deadline import Deadline
from remanifold.method.dimension import find_dimension, other_dimension
from remanifold.method.dropping import INVALID, filled, finite_rows, number_as_given
from remanifold.method.forecast import (
    check_memory,
    expected_seconds,
    largest_patch,
    least_seconds,
    refuse_late,
)
from remanifold.method.openings import openings_of
from remanifold.method.options import CHECKS, Options
from remanifold.method.programs import solve_program
from remanifold.method.provenance import Parameter, Used, parameters_of, provenance_of
from remanifold.method.steps import EdgeSets, Stars, warn_of_recall
from remanifold.results.reconstruction import Reconstruction
from remanifold.warnings import (
    DimensionWarning,
    DoubtWarning,
    DroppedWarning,
    ManifoldWarning,
    MatrixWarning,
    MissingWarning,
    TransposedWarning,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Literal

    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.progress import Callback
    from remanifold._base.samples import Input
    from remanifold.method.dimension import DimensionEstimate
    from remanifold.method.options import EdgeRule, Estimator, Method, Search

    Decisions = Sequence[tuple[NDArray[np.int32], bool]]


# What takes as long as so many patches is tried by one before.
MANY_PATCHES = 20


def reconstruct(
    points: ArrayLike | None = None,
    dim: int | Literal["auto"] | None = None,
    *,
    method: Method = "manifold",
    boundary: Literal["auto", False] | ArrayLike = "auto",
    hole_radius: float | None = None,
    significance: float | None = None,
    outliers: Literal["auto", False] | float | None = None,
    smooth: Literal["auto"] | bool | int | None = None,
    gram: ArrayLike | None = None,
    distances: ArrayLike | None = None,
    attributes: Mapping[str, ArrayLike] | None = None,
    invalid: Literal["raise", "drop"] = "raise",
    num_neighbors: int | None = None,
    estimator: Estimator | None = None,
    edges: EdgeRule | None = None,
    search: Search = "auto",
    checks: int = CHECKS,
    num_threads: int | None = None,
    max_memory: float | None = None,
    max_seconds: float | None = None,
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
        of the local scale (the distance to the (2K+2)-th neighbor, on curves to the
        tenth; for K = 2 about 1.4 times the root of the area per sample). By default
        from 3 for samples that lie at random to 1.4 for even ones, on curves 0.6 times
        that, and what `significance` says besides.
    significance : float, optional
        Manifold method, up to K = 3, where `hole_radius` is not given: where the complex
        goes through a place at which so many samples are missing that chance leaves one
        like it in no more than this share of such data, the place is opened. 1e-3 by
        default; 0 opens nothing. ``rec.openings`` lists what was decided.
    outliers : "auto", False or float, optional
        Distance from the manifold of the others at which a sample is left out, in local
        scales; "auto", by default with the manifold method, is 2. See `find_outliers`.
    smooth : "auto", False, True or int, optional
        Move the samples onto the manifold before: where they are noisy, not at all, in
        any case, or by fits to so many neighbors. See `remanifold.smooth`. By default
        "auto" with the manifold method where `points` are given, and else False.
    gram, distances : array_like, shape (N, N), optional
        Inner products or distances of the samples, instead of `points`. `gram` must be
        positive semidefinite, and Hermitian if complex; distances of samples to
        themselves are zero, up to rounding.
    attributes : mapping of str to array_like, optional
        What is known of each sample, such as its color: numbers or bool of shape (N,) or
        (N, C). They come back as `Reconstruction.vertex_attributes`, and go into files.
    invalid : {"raise", "drop"}
        Whether a sample with a coordinate that is not finite, or masked, is an error or
        left out. Samples keep their numbers; `Reconstruction.invalid` lists those left
        out.
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
    max_memory : float, optional
        Bytes that may be taken beyond the samples themselves: what `forecast` expects to
        take more is an error before any work. By default nothing is refused.
    max_seconds : float, optional
        Time that may be taken. When it is over in the last step the best manifold so far is
        returned: cavities that need a program stay open, ``repair.num_out_of_time`` counts
        them, and the verdict says so. What needs no program is finished, in time linear in
        N. Such a result depends on the machine. Before that step, or where `forecast`
        expects no chance of getting there, it is an error.
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
    MemoryError
        More memory than `max_memory` is to be expected.
    TimeoutError
        `max_seconds` are over before there is any simplex, or cannot do.

    Warns
    -----
    ManifoldWarning
        The result lacks something, or noise drowns the shape.
    DoubtWarning
        The samples do not determine the result, as far as that shows without measuring:
        `Reconstruction.quality` does, in about the same time again.
    DimensionWarning
        Another dimension fits, or the one that was found is uncertain.
    DroppedWarning
        Outliers were left out and `outliers` was not given.
    MatrixWarning
        The points are a symmetric matrix, as those of products and distances are.
    MissingWarning
        One sample has more copies than chance leaves, as what marks missing ones.
    TransposedWarning
        More coordinates than samples, and too few of these for a single fit.
    RecallWarning
        The approximate search missed neighbors.

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
    options = Options(
        method=method,
        boundary=boundary,
        hole_radius=hole_radius,
        significance=significance,
        outliers=outliers,
        smooth=smooth,
        num_neighbors=num_neighbors,
        estimator=estimator,
        edges=edges,
        search=search,
        checks=checks,
    )
    rows = None
    if points is not None and invalid != "raise":
        points, rows = finite_rows(points, invalid)
    given = points if rows is None else np.asarray(points)[rows]
    check_choice(invalid, "invalid", INVALID)
    remedy = 'invalid="drop" leaves such samples out'
    samples = check_samples(given, gram, distances, remedy)
    count = len(samples) if rows is None else len(np.asarray(points))
    if isinstance(samples, Points) and (said := looks_like_a_matrix(samples.matrix)):
        warnings.warn(said, MatrixWarning, stacklevel=2)
    known = check_fields(attributes, count, "attributes")
    threads = check_num_threads(num_threads)
    found = None
    if isinstance(dim, str) and dim == "auto":
        found = find_dimension(samples, threads, progress)
        dim = found.dim
    if max_memory is not None:
        most = check_positive(max_memory, "max_memory")
        columns = samples.matrix.shape[1] if isinstance(samples, Points) else 0
        k = check_dim(dim, samples)
        check_memory(len(samples), columns, k, most, products=columns == 0)
    deadline = None
    if max_seconds is not None:
        deadline = Deadline(check_positive(max_seconds, "max_seconds"))
        k = check_dim(dim, samples)
        _refuse_late(samples, k, deadline.seconds, threads or os.cpu_count() or 1)
    rec = reconstruct_samples(
        samples,
        dim,
        options,
        threads,
        progress,
        rows,
        count,
        found=found,
        deadline=deadline,
        more={
            "invalid": Parameter(invalid, invalid != "raise"),
            "attributes": Parameter(", ".join(known) or None, bool(known)),
        },
    )
    _warn_of_nonsense(rec, samples, options)
    for name, array in known.items():
        rec.vertex_attributes[name] = array.copy()
        rec.vertex_attributes[name].flags.writeable = False
    return rec


def reconstruct_samples(
    samples: Input,
    dim: int | str | None,
    options: Options,
    threads: int,
    progress: bool | Callback | None,
    rows: NDArray[np.int64] | None = None,
    count: int | None = None,
    *,
    found: DimensionEstimate | None = None,
    deadline: Deadline | None = None,
    more: Mapping[str, Parameter] | None = None,
    decisions: Decisions = (),
) -> Reconstruction:
    """The same for samples that were checked, or those with some numbers of so many.

    Decisions on openings hold whatever the options say.
    """
    k = check_dim(dim, samples)
    smooths = options.smoothing_of(samples) is not False
    given = as_points(samples) if smooths else samples
    total = len(samples) if count is None else count
    decided = [
        (
            place if rows is None else np.searchsorted(rows, place).astype(np.int32),
            is_open,
        )
        for place, is_open in decisions
    ]
    choices = options.of_rows(rows, total).for_core(samples, k, decided)
    result: dict[str, Any]
    with progress_callback(progress) as callback:
        if deadline is not None:
            callback = deadline.watch(callback)
        if options.is_paper:
            result = _core.reconstruct_paper(
                given, choices, num_threads=threads, progress=callback
            )
        else:
            result = _core.reconstruct(
                given,
                choices,
                solve=solve_program if deadline is None else deadline.solve,
                on_other_dim=functools.partial(_warn_of_dimension, k),
                num_threads=threads,
                progress=callback,
            )
    warn_of_recall(result["search"], result["recall"], stacklevel=4)
    known = isinstance(samples, Points)
    invalid = np.empty(0, dtype=np.int32)
    if rows is not None:
        number_as_given(result, given, rows, total)
        samples = Points(filled(samples.matrix, rows, total, np.nan))
        given = samples
        invalid = np.setdiff1d(np.arange(total), rows).astype(np.int32)
    smoothing = None
    if smooths:
        smoothing = smoothing_of(given, result["cleaning"], k, known)
    vertices = None
    if known:
        vertices = samples.matrix.view() if smoothing is None else smoothing.points
    attached = result["cleaning"]["attached"]
    if vertices is not None and len(attached) and len(result["simplices"]):
        vertices = vertices.copy()
        # Samples that are no points are in no simplex.
        at_resolution = ComplexData(np.nan_to_num(vertices), result["simplices"])
        vertices[attached] = project(
            at_resolution, vertices[attached], num_threads=threads or None
        ).points
    if smoothing is not None and smoothing.drowned:
        warnings.warn(
            f"noise drowns the shape: the samples lie {smoothing.noise:.3g} off any "
            f"manifold; about {smoothing.enough_samples:,} samples would do",
            ManifoldWarning,
            stacklevel=3,
        )
    report = {}
    paper: dict[str, Any] = {}
    if options.is_paper:
        paper = {
            "tangent_simplices": result["tangent_simplices"],
            "edge_sets": EdgeSets(
                result["edge_set_offsets"], result["edge_set_indices"]
            ),
            "stars": Stars(result["star_offsets"], result["star_simplices"]),
            "unbounded": result["unbounded"],
            "edge_rule": options.edge_rule,
        }
    else:
        rule, mask = options.boundary_rule(total)
        reopened = np.zeros(total, dtype=bool)
        for one in result["openings"]:
            if one["given"] and one["open"]:
                reopened[one["samples"]] = True
        result["repair"]["num_out_of_time"] = (
            0 if deadline is None else deadline.num_left
        )
        report = _finish_report(result["repair"], k, rule, mask, reopened)
        if len(result["simplices"]) == 0:
            warnings.warn(
                f"no {k}-dimensional simplices: the samples span too little, or are too "
                "far apart",
                ManifoldWarning,
                stacklevel=3,
            )
    tangents = result["tangents"] if known else None
    frames = tangents if isinstance(tangents, tuple) else None
    used = Used(
        dim=k,
        found=found,
        num_distinct=len(distinct(result["representatives"])) - len(invalid),
        search=result["search"],
        hole_radius=report.get("hole_radius", float("nan")),
        smoothing=smoothing,
        num_threads=threads,
    )
    rec = Reconstruction(
        vertices=vertices,
        samples=samples.matrix.view() if known else None,
        simplices=result["simplices"],
        # A copy lies where its sample lies, in whose name the simplices are.
        boundary=result["boundary"][result["representatives"]],
        representatives=result["representatives"],
        outliers=result["cleaning"]["outliers"],
        invalid=invalid,
        attached=attached,
        smoothing=smoothing,
        method=options.method,
        estimator=options.tangent_estimator,
        search=result["search"],
        num_neighbors=options.neighbors(k),
        recall=result["recall"],
        timings=result["timings"],
        openings=openings_of(result.get("openings", []), k, options.chance),
        significance=0.0 if options.is_paper else options.chance,
        provenance=provenance_of(
            samples, parameters_of(options, samples, used, more or {})
        ),
        _report=report,
        _frames=frames,
        _decisions=tuple(decisions),
        _options=options,
        _products=None if known else samples,
        **paper,
    )
    # What is known already fills the places of the cached properties.
    computed = {"tangents": tangents, "edges": result.get("edges")}
    for name, array in computed.items():
        if isinstance(array, np.ndarray):
            array.flags.writeable = False
            vars(rec)[name] = array
    return rec


def _reconstruct_again(rec: Reconstruction, decisions: Decisions) -> Reconstruction:
    """The same call with other decisions on openings."""
    options = rec._options
    assert options is not None
    samples = rec._products
    rows = None
    if rec.samples is not None:
        if len(rec.invalid):
            rows = np.setdiff1d(np.arange(rec.num_samples), rec.invalid)
        samples = Points(rec.samples if rows is None else rec.samples[rows])
    assert samples is not None
    kept = ("invalid", "attributes")
    said = "places reopened or closed by hand"
    again = reconstruct_samples(
        samples,
        rec.dim,
        options,
        check_num_threads(None),
        None,
        rows,
        rec.num_samples,
        more={
            **{name: rec.parameters[name] for name in kept if name in rec.parameters},
            "decisions": Parameter(len(decisions), False, said),
        },
        decisions=decisions,
    )
    again.vertex_attributes.update(rec.vertex_attributes)
    return again


def _warn_of_nonsense(rec: Reconstruction, samples: Input, options: Options) -> None:
    """Say at once what would else be found out when somebody asks."""
    count, columns = samples.matrix.shape
    # What no fit can be made of, and would be many more samples the other way round.
    if (
        isinstance(samples, Points)
        and count <= _core.jet_neighbors(rec.dim)
        and columns > count
    ):
        _warn(
            TransposedWarning,
            f"points has {count:,} samples of {columns:,} coordinates, too few to tell "
            f"anything: if it holds {columns:,} samples, transpose it",
        )
    if said := looks_like_a_mark(samples, rec.representatives, rec.simplices):
        _warn(MissingWarning, said)
    # What was asked for is no news.
    if len(rec.outliers) and options.outliers is None:
        left = len(rec.outliers)
        are = (
            "sample is an outlier and was"
            if left == 1
            else "samples are outliers and were"
        )
        _warn(DroppedWarning, f"{left:,} {are} left out; outliers=False keeps all")
    other = rec.smoothing is not None and rec.smoothing.fitting_dim is not None
    if not other and (said := looks_like_a_boundary(rec)):
        _warn(DimensionWarning, said)
    doubts = doubts_at_once(rec)
    if doubts:
        more = f" (and {len(doubts) - 1} more)" if len(doubts) > 1 else ""
        _warn(
            DoubtWarning, f"the result is in doubt: {doubts[0]}{more}; see rec.quality"
        )


def _refuse_late(samples: Input, dim: int, seconds: float, threads: int) -> None:
    """Before any work that would be in vain; a patch tells, where it is a small part."""
    count = len(samples)
    if isinstance(samples, Points) and count > MANY_PATCHES * largest_patch(dim):
        expected = expected_seconds(samples.matrix, dim, by_one_thread)
        if expected is not None:
            least = least_seconds(expected, dim) / threads
            refuse_late(seconds, least, count, dim)


def by_one_thread(patch: NDArray[np.float64], dim: int) -> object:
    """What `expected_seconds` times."""
    return reconstruct(patch, dim, num_threads=1)


def _warn(kind: type[Warning], text: str) -> None:
    warnings.warn(text, kind, stacklevel=4)


def _warn_of_dimension(dim: int, fitting: int) -> None:
    """While there is time to stop; not from the thread of the caller."""
    warnings.warn(other_dimension(dim, fitting), DimensionWarning, stacklevel=1)


def _finish_report(
    report: dict[str, Any],
    dim: int,
    rule: str,
    mask: NDArray[np.bool_],
    reopened: NDArray[np.bool_],
) -> dict[str, Any]:
    """Sort the open faces into boundary and holes, and warn of what is no manifold."""
    sets = _core.face_sets(report["open_faces"])
    count = int(sets.max()) + 1 if len(sets) else 0
    marked = np.full(len(sets), rule == "auto")
    if rule == "given":
        marked = mask[report["open_faces"]].all(axis=1)
    marked |= reopened[report["open_faces"]].all(axis=1)
    # Samples may lie beyond the marked ones next to them: a rim is one by most of it.
    unmarked = np.bincount(sets, ~marked) > np.bincount(sets) / 2
    in_hole = unmarked[sets]
    holes = int(np.count_nonzero(unmarked))
    beyond = distinct(report["open_faces"][~marked & ~in_hole])
    if rule == "given":
        beyond = beyond[~mask[beyond]]
    report |= {
        "num_boundary_components": count - holes,
        "num_holes": holes,
        "hole_faces": report["open_faces"][in_hole],
        "unstarred_simplices": np.empty((0, dim + 1), dtype=np.int32),
    }
    lacks = [
        f"{number} {one if number == 1 else more} {what}"
        for number, one, more, what in (
            (
                len(report["callous_faces"]),
                "face",
                "faces",
                "in more than two simplices",
            ),
            (
                len(report["singular_vertices"]),
                *("vertex", "vertices", "without a proper link"),
            ),
            (holes, "hole", "holes", "where boundary= asks for none"),
            (
                len(beyond),
                *("sample", "samples", "on rims that boundary= does not mark"),
            ),
            (
                report["num_unsolved"] - report["num_out_of_time"],
                *("cavity", "cavities", "without a solution"),
            ),
            (
                report["num_out_of_time"],
                *("cavity", "cavities", "for which there was no time"),
            ),
        )
        if number
    ]
    if lacks:
        warnings.warn(
            f"the result lacks something: {', '.join(lacks)}; see repair.remaining()",
            ManifoldWarning,
            stacklevel=4,
        )
    return report


# This module knows that one, and not the other way round.
Reconstruction._rebuild = staticmethod(_reconstruct_again)
