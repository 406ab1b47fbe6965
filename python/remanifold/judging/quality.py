# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the samples are dense enough for the result, and where they are not."""

from __future__ import annotations

import math
import textwrap
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from remanifold import _core
from remanifold._base.distinct import distinct
from remanifold._base.html import fragment, histogram
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.samples import Points
from remanifold._base.text import besides, two_digits
from remanifold.judging.findings import Findings, Sign
from remanifold.judging.signs import (
    NOWHERE,
    close_decisions,
    count_of,
    disputes,
    edges_among,
    is_covered,
    is_only_boundary,
    misfits,
    narrow_neighbors,
    noise_signs,
    only_boundary,
    outlier_signs,
    parts_left_out,
    signs_of,
    singular_signs,
    too_few,
)
from remanifold.judging.singularities import (
    Neighbors,
    neighbors_wanted,
)
from remanifold.method.dimension import other_dimension

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold._base.samples import Input
    from remanifold.method.result import ReconstructionData, Repair
FEW = 20_000  # samples among which crossings are looked for without a sign
COORDINATES = 3  # that a verdict names


class Reason(NamedTuple):
    """A sign that the sampling does not determine the result, and the samples there.

    Its kind is "sampling", "noise" where the samples lie too far off a manifold, or
    "singular" where the data is no manifold at all.
    """

    text: str
    samples: NDArray[np.int64]
    kind: Literal["sampling", "noise", "singular"] = "sampling"

    def __str__(self) -> str:
        count = len(self.samples)
        where = f" ({count:,} sample{'' if count == 1 else 's'})" if count else ""
        said = f"{self.kind}: {self.text}{where}"
        return textwrap.fill(said, 88, subsequent_indent="  ")

    def __repr__(self) -> str:
        return f"Reason({self.text!r}, samples={len(self.samples)}, kind={self.kind!r})"


@dataclass(frozen=True, eq=False, repr=False)
class Quality(ReadOnlyArrays):
    """Sampling report. Arrays are read-only; copies have the values of their sample.

    Attributes
    ----------
    spacing : ndarray, shape (N,), float64
        Local scale h: the distance to the (2K+2)-th neighbor, on curves to the tenth,
        smoothed by the median over these neighbors. `hole_radius` is in the same unit.
    curvature : ndarray, shape (N,), float64
        Largest norm of the second fundamental form, from a quadric fitted to 3 K (K + 3)
        neighbors. NaN where there are too few.
    reach : ndarray, shape (N,), float64
        Least distance to the medial axis by Federer's formula, 1 / reach = max over q of
        ``2 d(q - x, T_x) / |q - x|^2``, over the same neighbors: curvature bounds it, and so
        do sheets nearby. Infinite where the neighborhood is flat, NaN without a tangent
        space. Where the sampling is sparse it is an upper bound at best.
    sampling_ratio : ndarray, shape (N,), float64
        Spacing over reach, the rho of a rho-sample.
    tangent_confidence : ndarray, shape (N,), float64
        From 0 to 1: volume that the simplices around a sample have on its tangent space,
        over their own volume. 0 without a tangent space or without simplices.
    disputed : ndarray, shape (N,), float64
        From 0 to 1: of the simplices proposed around a sample, the share on which not
        all vertices agree. 0 with the paper's method.
    boundary : ndarray, shape (N,), bool
        Samples on an open face.
    fold : ndarray, shape (N,), float64
        Largest angle in degrees by which two simplices deviate from continuing each
        other, away from the boundary.
    gap : ndarray, shape (N,), float64
        Radius of the largest empty ball that a simplex at the sample spans, over the
        spacing around it, away from the boundary.
    doubtful : ndarray, shape (N,), bool
        Samples that one of the reasons names.
    noise : float
        Root mean square distance of the samples from quadrics fitted to their
        neighborhoods, over the spacing, without what shrinks as the neighborhoods do.
        0.18 on a surface is half the median distance to the nearest neighbor.
    ok : bool
        No reason for doubt.
    reasons : tuple of Reason
        What casts doubt on the result, each with the samples concerned (none where all
        are).
    recommended_samples : int or None
        About how many samples would do; None where that is not the remedy, or nothing is
        wrong.
    verdict : str
        All this in one line.

    Notes
    -----
    A manifold is rho-sampled if no point of it is farther than rho times its distance to
    the medial axis from a sample. One strong sign or two weak ones make a verdict; what
    they are and how often they are right is in the page on the sampling report.

    References
    ----------
    D. Freedman, Efficient Simplicial Reconstructions of Manifolds from Their Samples,
    IEEE Transactions on Pattern Analysis and Machine Intelligence 24(10), 2002.

    E. Aamari, J. Kim, F. Chazal, B. Michel, A. Rinaldo, L. Wasserman, Estimating the
    reach of a manifold, Electronic Journal of Statistics 13(1), 2019.
    """

    spacing: NDArray[np.float64]
    curvature: NDArray[np.float64]
    reach: NDArray[np.float64]
    sampling_ratio: NDArray[np.float64]
    tangent_confidence: NDArray[np.float64]
    disputed: NDArray[np.float64]
    boundary: NDArray[np.bool_]
    fold: NDArray[np.float64]
    gap: NDArray[np.float64]
    doubtful: NDArray[np.bool_]
    noise: float
    ok: bool
    reasons: tuple[Reason, ...]
    recommended_samples: int | None
    verdict: str

    def __str__(self) -> str:
        return "\n".join([self.verdict, *(f"- {r.text}" for r in self.reasons)])

    def _repr_html_(self) -> str:
        answer = (
            "no reason for doubt" if self.ok else f"in doubt: {self.reasons[0].text}"
        )
        noise = f"{self.noise:.3g} spacings" if math.isfinite(self.noise) else "unknown"
        rows: list[tuple[str, object]] = [
            ("samples in doubt", f"{int(self.doubtful.sum()):,}"),
            ("noise", noise),
        ]
        if self.recommended_samples is not None:
            rows.append(("samples that would do", f"{self.recommended_samples:,}"))
        rows += [("and", reason.text) for reason in self.reasons[1:4]]
        chart = histogram("spacing over reach", self.sampling_ratio)
        more = besides(self.verdict, answer)
        return fragment(answer, rows, chart, f"{more}." if more else "")

    def __repr__(self) -> str:
        return f"Quality(ok={self.ok}, verdict={self.verdict!r})"


# ----------------------------------------------------------------------- the report


def assess(rec: ReconstructionData) -> Quality:
    """Measure the samples of a reconstruction and judge."""
    source = rec._source
    own = _own(rec)
    few = np.count_nonzero(own) <= FEW
    measured, neighbors = _measure(source, rec, list_neighbors=bool(few))
    spacing, reach = measured["spacing"], measured["reach"]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = spacing / reach
        scatter = _share(measured["scatter"], spacing)
        wide_scatter = _share(measured["wide_scatter"], spacing)
    seen = _seen(rec)
    findings = replace(
        seen,
        spacing=spacing,
        reach=reach,
        ratio=ratio,
        confidence=measured["tangent_share"],
        fold=measured["fold"],
        gap=measured["gap"],
        strange=measured["nearest_strange"],
        disputed=_disputed(rec.simplices, rec.repair, rec.representatives),
        noise=_noise(scatter[seen.own], wide_scatter[seen.own], rec.dim),
    )
    signs = sorted(signs_of(findings), key=lambda sign: not sign.strong)
    signs += outlier_signs(rec)
    if signs or few:
        neighbors = neighbors or _neighbors(source, rec)
        signs = [*singular_signs(findings, source, neighbors), *signs]
    if not any(sign.strong for sign in signs) and len(signs) < 2:
        signs = []
    fitting = None if rec.smoothing is None else rec.smoothing.fitting_dim
    if fitting is not None and fitting < rec.dim:
        everywhere = np.flatnonzero(findings.own)
        fitting = None if is_covered(findings, everywhere) else fitting
    if fitting is not None and not any(sign.kind == "singular" for sign in signs):
        text = other_dimension(rec.dim, fitting)
        signs = [Sign(True, text, NOWHERE, kind="singular"), *signs]
    signs = [*noise_signs(rec, findings, bool(signs)), *signs]
    reasons = tuple(Reason(sign.text, sign.samples, sign.kind) for sign in signs)
    doubtful = np.zeros(rec.num_samples, dtype=bool)
    for reason in reasons:
        doubtful[reason.samples] = True
        reason.samples.flags.writeable = False
    doubtful = doubtful[rec.representatives]
    recommended = _recommended(findings, signs)
    return Quality(
        spacing=spacing,
        curvature=measured["curvature"],
        reach=reach,
        sampling_ratio=ratio,
        tangent_confidence=findings.confidence,
        disputed=findings.disputed,
        boundary=measured["rim"] == 2,
        fold=findings.fold,
        gap=findings.gap,
        doubtful=doubtful,
        noise=findings.noise,
        ok=not reasons,
        reasons=reasons,
        recommended_samples=recommended,
        verdict=_verdict(findings, reasons, recommended, rec.vertices),
    )


def _own(rec: ReconstructionData) -> NDArray[np.bool_]:
    """Samples that were not left out, copies apart."""
    own = np.asarray(rec.representatives == np.arange(rec.num_samples))
    own[rec.left_out] = False
    return own


def _seen(rec: ReconstructionData) -> Findings:
    """What shows in the result, nothing being measured yet."""
    own = _own(rec)
    unknown = np.broadcast_to(np.nan, rec.num_samples)
    return Findings(
        rec=rec,
        dim=rec.dim,
        ambient_dim=rec.ambient_dim,
        samples=rec._source,
        num_samples=int(np.count_nonzero(own)),
        num_simplices=len(rec.simplices),
        simplices=rec.simplices,
        repair=rec.repair,
        openings=rec.openings,
        significance=rec.significance,
        own=own,
        spacing=unknown,
        reach=unknown,
        ratio=unknown,
        confidence=unknown,
        fold=unknown,
        gap=unknown,
        strange=unknown,
        disputed=unknown,
        noise=math.nan,
    )


def doubts_at_once(rec: ReconstructionData) -> list[str]:
    """Those strong signs that show in the result without measuring anything.

    Each of them alone makes `assess` doubt the result.
    """
    found = _seen(rec)
    if found.num_simplices == 0:
        return []  # which is said already
    signs = [*too_few(found)]
    if not signs:
        kinds = (misfits, close_decisions, parts_left_out, disputes)
        signs = [sign for kind in kinds for sign in kind(found)]
    return [sign.text for sign in signs if sign.strong]


def looks_like_a_boundary(rec: ReconstructionData) -> str:
    """Words for samples of a solid that are all on its boundary, else nothing."""
    return only_boundary(rec.dim) if is_only_boundary(rec) else ""


def _jets(rec: ReconstructionData) -> NDArray[np.float64] | None:
    """Tangent spaces of the result, where the core would fit the same ones."""
    usual = rec.estimator == "jet" and rec.num_neighbors == narrow_neighbors(rec.dim)
    # Of few samples half are fitted to.
    own = rec.representatives == np.arange(rec.num_samples)
    usual &= np.count_nonzero(own) - len(rec.left_out) > 2 * rec.num_neighbors
    # In many coordinates it fits others, and writing them out costs more than that.
    direct = rec.ambient_dim is not None and rec.ambient_dim <= rec.num_neighbors
    return rec.tangents if usual and direct and rec.search != "approximate" else None


def _kept(rec: ReconstructionData) -> NDArray[np.bool_]:
    kept = np.ones(rec.num_samples, dtype=bool)
    kept[rec.left_out] = False
    return kept


def _search(samples: Input, rec: ReconstructionData) -> dict[str, Any]:
    # What was smoothed had coordinates, but these are the samples as they were given.
    return {
        "search": rec.search if isinstance(samples, Points) else "auto",
        "checks": _core.CHECKS,
        "num_threads": 0,
        "progress": None,
    }


def _neighbors(samples: Input, rec: ReconstructionData) -> Neighbors:
    """Those that `_measure` lists, where it was not asked to."""
    kept = _kept(rec)
    if len(rec.left_out):
        samples = samples.subset(kept)
    return _listed(
        _core.list_neighbors(
            samples, neighbors_wanted(rec.dim), **_search(samples, rec)
        ),
        kept,
    )


def _listed(
    listed: tuple[NDArray[np.int32], NDArray[np.int32]], kept: NDArray[np.bool_]
) -> Neighbors:
    numbers, near = listed
    return Neighbors(np.flatnonzero(kept).astype(np.int32)[numbers], near)


def _measure(
    samples: Input, rec: ReconstructionData, *, list_neighbors: bool
) -> tuple[dict[str, NDArray[Any]], Neighbors | None]:
    """By the core, as if there were no outliers; theirs is NaN, or nothing.

    With the neighbors of all samples if asked for: more than the measures need, but one
    search finds both.
    """
    kept = _kept(rec)
    simplices = rec.simplices
    tangents = _jets(rec)
    if len(rec.left_out):
        samples = samples.subset(kept)
        number = np.cumsum(kept, dtype=np.int32) - np.int32(1)
        simplices = number[simplices]
        tangents = None if tangents is None else tangents[kept]
    measured: dict[str, NDArray[Any]] = _core.quality(
        samples,
        simplices,
        tangents,
        num_neighbors=0,
        num_listed=neighbors_wanted(rec.dim) if list_neighbors else 0,
        **_search(samples, rec),
    )
    listed = measured.pop("numbers"), measured.pop("near")
    if len(rec.left_out):
        for name, values in measured.items():
            nothing = np.nan if values.dtype.kind == "f" else 0
            spread = np.full(rec.num_samples, nothing, dtype=values.dtype)
            spread[kept] = values
            measured[name] = spread
    return measured, _listed(listed, kept) if list_neighbors else None


def _share(
    values: NDArray[np.float64], spacing: NDArray[np.float64]
) -> NDArray[np.float64]:
    return np.where(spacing > 0, values / spacing, np.nan)


def _disputed(
    simplices: NDArray[np.int32], repair: Repair, representatives: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Share of the disputed among the simplices proposed around each sample."""
    count = len(representatives)
    against, chosen, all_of = (
        np.bincount(rows.ravel(), minlength=count)
        for rows in (repair.disputed_simplices, repair.filled_simplices, simplices)
    )
    proposed = against + np.maximum(all_of - chosen, 0)
    shares = against / np.maximum(proposed, 1)
    return np.asarray(shares[representatives], dtype=np.float64)


def _noise(
    scatter: NDArray[np.float64], wide_scatter: NDArray[np.float64], dim: int
) -> float:
    """Scatter over the spacing that does not shrink with the neighborhoods.

    The wide ones have twice as many samples. What a quadric leaves of the shape grows
    with the third power of the width, and so does its square 2^(6 / K) times.
    """
    known = np.isfinite(scatter)
    if not known.any():
        return math.nan
    narrow = float(np.median(scatter[known]))
    known = np.isfinite(wide_scatter)
    if not known.any():
        return narrow
    wide = float(np.median(wide_scatter[known]))
    growth = 2.0 ** (6 / dim)
    return math.sqrt(max(0.0, (growth * narrow**2 - wide**2) / (growth - 1)))


# ------------------------------------------------------------------------ the verdict


def _recommended(found: Findings, signs: list[Sign]) -> int | None:
    """N (ratio / allowed ratio)^K by the sign that asks for most, to two digits."""
    growths = [sign.growth for sign in signs if sign.growth > 1]
    if not growths:
        return None
    return two_digits(found.num_samples * max(growths) ** found.dim)


def _verdict(
    found: Findings,
    reasons: tuple[Reason, ...],
    recommended: int | None,
    points: NDArray[np.float64] | None,
) -> str:
    of = count_of(found.num_samples, "sample")
    if not reasons:
        ratio = found.quantile(found.ratio, 0.95)
        if ratio == 0:  # a region of R^K does not bend
            return f"sampling is dense enough: nothing bends at 95 % of {of}"
        return (
            f"sampling is dense enough: the spacing is at most {ratio:.2g} times the "
            f"reach at 95 % of {of}"
        )
    if reasons[0].kind in ("singular", "noise"):
        return reasons[0].text
    marked = distinct(np.concatenate([reason.samples for reason in reasons]))
    parts = [reasons[0].text]
    if len(marked):
        head = f"sampling is too sparse at {len(marked):,} of {of}"
        place, together = _place(found, marked)
        where = f"{'mostly' if together else 'for one'} near sample {place}"
        if points is not None:
            numbers = ", ".join(f"{c:.4g}" for c in points[place][:COORDINATES])
            more = ", ..." if points.shape[1] > COORDINATES else ""
            where += f" at ({numbers}{more})"
        head += f", {where}"
    else:
        verb = "does" if found.num_samples == 1 else "do"
        head = f"{of} {verb} not determine the result"
    if recommended is not None:
        parts.append(f"about {recommended:,} would do")
    return f"{head}: {'; '.join(parts)}"


def _place(found: Findings, marked: NDArray[np.int64]) -> tuple[int, bool]:
    """The middle of the largest connected set of samples, and if it has most of them.

    The middle is the sample with most neighbors in the set, the first of these.
    """
    inside = np.zeros(len(found.own), dtype=bool)
    inside[marked] = True
    edges = edges_among(found.simplices, inside)
    if len(edges) == 0:
        return int(marked[0]), len(marked) == 1
    labels = _core.component_labels(edges, len(inside))
    sizes = np.bincount(labels[labels >= 0])
    degrees = np.bincount(edges.ravel(), minlength=len(inside))
    degrees[labels != int(np.argmax(sizes))] = 0
    return int(np.argmax(degrees)), bool(2 * sizes.max() >= len(marked))
