# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the samples are dense enough for the result, and where they are not."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from remanifold import _core
from remanifold._base.html import fragment, histogram
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.samples import Points
from remanifold._base.text import two_digits
from remanifold.judging.removal import mark_rows, removal_changes
from remanifold.judging.singularities import (
    KINDS,
    LOWER,
    Neighbors,
    neighbors_wanted,
    places_among,
    verdict_on,
)
from remanifold.method.dimension import other_dimension

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold._base.samples import Input
    from remanifold.complex.topology import Topology
    from remanifold.method.openings import Opening
    from remanifold.method.result import ReconstructionData, Repair

MAX_UNUSED = 0.01  # of the samples
COORDINATES = 3  # that a verdict names


class Reason(NamedTuple):
    """A sign that the sampling does not determine the result, and the samples there.

    Its kind is "sampling", "noise" where the samples lie too far off a manifold, or
    "singular" where the data is no manifold at all.
    """

    text: str
    samples: NDArray[np.int64]
    kind: Literal["sampling", "noise", "singular"] = "sampling"


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
        return fragment(answer, rows, chart, f"{self.verdict}.")

    def __repr__(self) -> str:
        return f"Quality(ok={self.ok}, verdict={self.verdict!r})"


# ------------------------------------------------------------------------- limits


@dataclass(frozen=True)
class _Limits:
    """Where a sign is strong, and from where on it is a weak one (`some_...`).

    Measured on half of the runs of ``benchmarks/critical_sampling.py``.
    """

    # Samples at folds wider than so many degrees, plus so many a unit of noise.
    folded: int
    fold: float
    some_folded: int
    some_fold: float
    fold_by_noise: float
    # Samples so near, in spacings, to others that are far along the result.
    near: int
    distance: float
    some_distance: float
    # Share of disputed simplices.
    disputed: float
    some_disputed: float
    # Openings narrower than so many times hole_radius.
    opening: float
    some_opening: float
    # Balls that large expected among as many samples at random: powers of ten.
    gap: float
    some_gap: float
    # Spacing over reach at 5 % of the samples, tangent confidence at 5 %, and scatter
    # about the fits over the spacing, which for curves takes the place of the first.
    some_ratio: float
    some_confidence: float
    scatter: float = math.inf
    some_scatter: float = math.inf


_CURVES = _Limits(
    folded=2,
    fold=160,
    some_folded=1,
    some_fold=90,
    fold_by_noise=600,
    near=1,
    distance=0.4,
    some_distance=0.7,
    disputed=0.4,
    some_disputed=0.6,
    opening=0,
    some_opening=0,
    gap=-4,
    some_gap=-2,
    some_ratio=2.45,
    some_confidence=0.4,
    scatter=0.4,
    some_scatter=0.3,
)
_SURFACES = _Limits(
    folded=4,
    fold=130,
    some_folded=3,
    some_fold=115,
    fold_by_noise=500,
    near=2,
    distance=0.85,
    some_distance=1.0,
    disputed=0.8,
    some_disputed=0.75,
    opening=1.0,
    some_opening=1.0,
    gap=-2.3,
    some_gap=-0.7,
    some_ratio=2.0,
    some_confidence=0.3,
)
_THREE = _Limits(
    folded=6,
    fold=140,
    some_folded=4,
    some_fold=120,
    fold_by_noise=500,
    near=2,
    distance=0.85,
    some_distance=1.0,
    disputed=0.9,
    some_disputed=0.85,
    opening=0.3,
    some_opening=0.5,
    gap=-2.3,
    some_gap=-1,
    some_ratio=2.25,
    some_confidence=0.25,
)
_MORE = _Limits(
    folded=8,
    fold=160,
    some_folded=6,
    some_fold=150,
    fold_by_noise=500,
    near=2,
    distance=0.85,
    some_distance=1.0,
    disputed=0.97,
    some_disputed=0.92,
    opening=0.2,
    some_opening=0.3,
    gap=-2.3,
    some_gap=-1,
    some_ratio=2.25,
    some_confidence=0.25,
)
_LIMITS = {1: _CURVES, 2: _SURFACES, 3: _THREE}

MOST_FOLD = 176.0  # degrees that noise may account for, with the limit itself
MOST_NOISE = 0.2  # over the spacing, beyond which it is no longer told from sparsity
MANY_OUTLIERS = 0.05  # share of the samples
# A line of samples with a surface through it: this share of them and more inside of that,
# where it bends by no more degrees.
COVERED, SMOOTH_FOLD = 0.5, 60.0
MOST_STRAY = 128  # of them that tell which dimension they fill
STRAY_ERRORS = 2.0  # standard errors by which it is more than that of the manifold
FEW = 20_000  # samples among which crossings are looked for without a sign
LONG_EDGE = 1.2  # spacings
MOST_LONG_EDGES = 50  # that are looked at
LEAST_SHEET = 16  # triangles
CROSSING = 0.5  # distance of a sample from the middle over half the length
MOST_OPENED = 10  # closed places that are taken out to see what that does
# Chance of a gap as large as one that was closed, up to which that is in doubt: so many of
# the results that are right are doubted for it. Joints are in doubt in any case.
RARE_GAP = 0.04
SURE = 0.1  # of the significance, below which an opening is beyond doubt
NORMAL_QUARTILES = 1.349  # standard deviations between them
LAYERS_SHARE = 0.75  # of the samples, those nearest to the middle
LAYERS_ERRORS = 3.0  # standard errors from which on too few samples lie in the middle
NO_NOISE = 1e-3  # chance that normal noise moves any sample so far
LEAST_GAPS = 30  # samples from which the evenness is judged
MUCH_LEFT = 0.15  # of the spacing: noise that makes samples propose other simplices
ENOUGH = 1.0  # spacing over reach that is asked for when recommending


# ----------------------------------------------------------------------- the report


@dataclass
class _Findings:
    """What is known about the samples and the result."""

    rec: ReconstructionData
    dim: int
    ambient_dim: int | None
    samples: Input
    num_samples: int  # without copies
    num_simplices: int
    simplices: NDArray[np.int32]
    repair: Repair
    openings: tuple[Opening, ...]
    significance: float
    own: NDArray[np.bool_]  # not a copy
    boundary: NDArray[np.bool_]
    spacing: NDArray[np.float64]
    reach: NDArray[np.float64]
    ratio: NDArray[np.float64]
    confidence: NDArray[np.float64]
    fold: NDArray[np.float64]
    gap: NDArray[np.float64]
    strange: NDArray[np.float64]  # distance to the nearest far along the result
    disputed: NDArray[np.float64]
    noise: float
    limits: _Limits = field(init=False)

    def __post_init__(self) -> None:
        self.limits = _LIMITS.get(self.dim, _MORE)

    @property
    def topology(self) -> Topology:
        """Computed when first asked for: most first looks do without."""
        return self.rec.topology()

    @functools.cached_property
    def rows(self) -> NDArray[np.int32]:
        """The simplices, the vertices of each ascending."""
        return np.sort(self.simplices, axis=1)

    @functools.cached_property
    def on_rim(self) -> NDArray[np.bool_]:
        """Samples of open faces."""
        marked = np.zeros(len(self.own), dtype=bool)
        marked[self.repair.open_faces] = True
        return marked

    def where(self, mask: NDArray[np.bool_]) -> NDArray[np.int64]:
        return np.flatnonzero(mask & self.own)

    def is_sure(self, opening: Opening) -> bool:
        """Whether an opening is far from being closed."""
        return opening.significance <= SURE * self.significance

    def quantile(self, values: NDArray[np.float64], q: float) -> float:
        known = values[self.own & np.isfinite(values)]
        return float(np.quantile(known, q)) if len(known) else math.nan


class _Sign(NamedTuple):
    strong: bool
    text: str
    samples: NDArray[np.int64]
    growth: float = math.nan  # of the number of samples that would remove it
    kind: Literal["sampling", "noise", "singular"] = "sampling"


def assess(rec: ReconstructionData) -> Quality:
    """Measure the samples of a reconstruction and judge."""
    source = rec._source
    measured, neighbors = _measure(source, rec)
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
    signs = sorted(_signs(findings), key=lambda sign: not sign.strong)
    signs += _outliers(rec)
    if signs or findings.num_samples <= FEW:
        signs = [*_singularities(findings, source, neighbors), *signs]
    if not any(sign.strong for sign in signs) and len(signs) < 2:
        signs = []
    fitting = None if rec.smoothing is None else rec.smoothing.fitting_dim
    if fitting is not None and fitting < rec.dim:
        everywhere = np.flatnonzero(findings.own)
        fitting = None if _is_covered(findings, everywhere) else fitting
    if fitting is not None and not any(sign.kind == "singular" for sign in signs):
        text = other_dimension(rec.dim, fitting)
        signs = [_Sign(True, text, _NOWHERE, kind="singular"), *signs]
    signs = [*_noise_signs(rec, findings, bool(signs)), *signs]
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


def _seen(rec: ReconstructionData) -> _Findings:
    """What shows in the result, nothing being measured yet."""
    own = rec.representatives == np.arange(rec.num_samples)
    own[rec.left_out] = False
    unknown = np.broadcast_to(np.nan, rec.num_samples)
    return _Findings(
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
        boundary=rec.boundary,
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
    signs = [*_too_few(found)]
    if not signs:
        kinds = (_misfits, _close_decisions, _parts, _disputes)
        signs = [sign for kind in kinds for sign in kind(found)]
    return [sign.text for sign in signs if sign.strong]


def looks_like_a_boundary(rec: ReconstructionData) -> str:
    """Words for samples of a solid that are all on its boundary, else nothing."""
    if rec.ambient_dim != rec.dim or rec.dim == 1 or len(rec.simplices) == 0:
        return ""
    rim = rec.boundary[np.unique(rec.simplices)]
    few = len(rim) < 4 * (rec.dim + 1)
    return "" if few or not rim.all() else _only_boundary(rec.dim)


def _only_boundary(dim: int) -> str:
    return (
        f"every sample is on the boundary of the {dim}-dimensional result: they may be of "
        f"its boundary, dim={dim - 1}"
    )


def _jets(rec: ReconstructionData) -> NDArray[np.float64] | None:
    """Tangent spaces of the result, where the core would fit the same ones."""
    usual = rec.estimator == "jet" and rec.num_neighbors == _fitted(rec.dim)
    # Of few samples half are fitted to.
    own = rec.representatives == np.arange(rec.num_samples)
    usual &= np.count_nonzero(own) - len(rec.left_out) > 2 * rec.num_neighbors
    # In many coordinates it fits others, and writing them out costs more than that.
    direct = rec.ambient_dim is not None and rec.ambient_dim <= rec.num_neighbors
    return rec.tangents if usual and direct and rec.search != "approximate" else None


def _measure(
    samples: Input, rec: ReconstructionData
) -> tuple[dict[str, NDArray[Any]], Neighbors]:
    """By the core, as if there were no outliers; theirs is NaN, or nothing."""
    kept = np.ones(rec.num_samples, dtype=bool)
    kept[rec.left_out] = False
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
        num_listed=neighbors_wanted(rec.dim),
        # What was smoothed had coordinates, but these are the samples as they were given.
        search=rec.search if isinstance(samples, Points) else "auto",
        checks=_core.CHECKS,
        num_threads=0,
        progress=None,
    )
    near, numbers = measured.pop("near"), measured.pop("numbers")
    if len(rec.left_out):
        numbers = np.flatnonzero(kept).astype(np.int32)[numbers]
        for name, values in measured.items():
            nothing = np.nan if values.dtype.kind == "f" else 0
            spread = np.full(rec.num_samples, nothing, dtype=values.dtype)
            spread[kept] = values
            measured[name] = spread
    return measured, Neighbors(numbers, near)


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


# -------------------------------------------------------------------------- signs


def _signs(found: _Findings) -> Iterator[_Sign]:
    """All signs, the plainest first. A new kind of doubt is one more line here."""
    yield from _out_of_time(found)
    few = list(_too_few(found))
    yield from few
    if not few:
        yield from _not_a_manifold(found)
        yield from _strange_neighbors(found)
        yield from _crossings(found)
        yield from _folds(found)
        yield from _gaps(found)
        yield from _openings(found)
        yield from _close_decisions(found)
        yield from _necks(found)
        yield from _strips(found)
        yield from _bridges(found)
        yield from _parts(found)
        yield from _disputes(found)
        yield from _sparsity(found)


def _fitted(dim: int) -> int:
    """Neighbors of the narrow fits."""
    return _core.jet_neighbors(dim)


def _singularities(
    found: _Findings, samples: Input, neighbors: Neighbors
) -> Iterator[_Sign]:
    """Where the samples are no K-manifold at all."""
    if len(neighbors.samples) <= 2 * found.dim + 2:
        return
    places = [
        place
        for place in places_among(samples, found.dim, neighbors).places
        if place.kind != KINDS[LOWER] or not _is_covered(found, place.samples)
    ]
    if places:
        marked = np.unique(np.concatenate([place.samples for place in places]))
        yield _Sign(
            True,
            verdict_on(found.dim, places),
            marked.astype(np.int64),
            kind="singular",
        )


def _is_covered(found: _Findings, samples: NDArray[Any]) -> bool:
    """Whether samples along lines are those of a manifold that is sampled denser along them.

    Most of them then lie inside the result, which is smooth there and as all agree.
    """
    inside = np.zeros(len(found.own), dtype=bool)
    inside[found.rows] = True
    inside[found.repair.filled_simplices] = False
    inside &= found.fold <= SMOOTH_FOLD
    samples = samples[~found.on_rim[samples]]
    return bool(np.count_nonzero(inside[samples]) > COVERED * len(samples))


_NOWHERE = np.empty(0, dtype=np.int64)


def _noise_signs(
    rec: ReconstructionData, found: _Findings, doubted: bool
) -> Iterator[_Sign]:
    """Noise that drowns the shape, that is none, or that explains what is doubted."""
    smoothing, moved = rec.smoothing, rec.smoothing is not None and rec.smoothing.moved
    if moved and smoothing is not None:
        yield from _no_noise(rec)
        noise, rest = smoothing.noise, smoothing.remaining_error
        if smoothing.drowned:
            yield _Sign(
                True,
                f"noise drowns the shape: the samples lie {noise:.3g} off any manifold, "
                f"smoothed about {rest:.3g}; about {smoothing.enough_samples:,} samples "
                "would do",
                _NOWHERE,
                kind="noise",
            )
        elif doubted and (
            len(rec.attached) > 0
            or rest > MUCH_LEFT * found.quantile(found.spacing, 0.5)
        ):
            yield _Sign(
                True,
                f"noise: the samples lie {noise:.3g} off the manifold, smoothed about "
                f"{rest:.3g}, which is much for their spacing; four times as many would "
                "halve it",
                _NOWHERE,
                kind="noise",
            )
    elif doubted and smoothing is None and isinstance(found.samples, Points):
        options = _core.Options(dim=rec.dim, smooth=True, only_noise=True)
        kept = np.ones(rec.num_samples, dtype=bool)
        kept[rec.left_out] = False
        report = _core.clean(
            found.samples.subset(kept), options, num_threads=0, progress=None
        )
        noise = report["noise"]
        if report["num_neighbors"] > 0 and noise > MUCH_LEFT * found.quantile(
            found.spacing, 0.5
        ):
            yield _Sign(
                True,
                f'noise: the samples lie {noise:.3g} off the manifold; smooth="auto" '
                f"would leave about {report['remaining_error']:.3g}",
                _NOWHERE,
                kind="noise",
            )


def _no_noise(rec: ReconstructionData) -> Iterator[_Sign]:
    """What smoothing took for noise though noise does not lie like that."""
    assert rec.smoothing is not None
    residuals = rec.residuals
    if residuals is None or rec.ambient_dim is None or not rec.smoothing.noise > 0:
        return
    smoothed = np.ones(rec.num_samples, dtype=bool)
    smoothed[rec.outliers] = smoothed[rec.invalid] = False
    if not smoothed.any():
        return
    squares = (residuals / rec.smoothing.noise) ** 2
    normals = _normal_directions(squares[smoothed], rec.ambient_dim - rec.dim)
    if _has_layers(squares[smoothed], normals):
        yield _Sign(
            True,
            "smoothing has joined two layers: no noise about one leaves so few "
            "samples in the middle; smooth=False keeps them apart",
            np.flatnonzero(smoothed).astype(np.int64),
        )
    # Squares of normal noise over all normal directions are above this with a chance of
    # e^-x each (Laurent and Massart, 2000).
    smoothed[rec.attached] = False
    x = math.log(rec.num_samples / NO_NOISE)
    most = (normals + 2 * math.sqrt(normals * x) + 2 * x) / normals
    far = smoothed & (squares > most)
    beyond = _groups(rec.simplices, far, rec.dim + 2)
    if len(beyond):
        most_moved = math.sqrt(float(squares[beyond].max()))
        yield _Sign(
            True,
            f"smoothing moved {_count(len(beyond), 'sample')} by more than noise "
            f"explains, up to {most_moved:.1f} times as far as the others: another part "
            "of the manifold is near, or it bends or ends there",
            beyond,
        )


def _normal_directions(squares: NDArray[np.float64], most: int) -> float:
    """Directions of the noise, which may be fewer than those normal to the manifold.

    Samples in many coordinates seldom have noise in all of them. The cube root of a sum of
    c squares of normal variables is nearly normal, with a variance of v = 2 / (9 c) over
    the square of its mean 1 - v (Wilson and Hilferty, 1931); quartiles do not heed what is
    no noise.
    """
    low, middle, high = np.quantile(np.cbrt(squares), [0.25, 0.5, 0.75])
    if not middle > 0:
        return 1.0
    ratio = ((high - low) / (NORMAL_QUARTILES * middle)) ** 2
    # v / (1 - v)^2 = ratio, without cancellation
    v = 2 * ratio / (2 * ratio + 1 + math.sqrt(4 * ratio + 1))
    told = 2 / (9 * v) if v > 0 else math.inf
    return float(min(max(1.0, told), max(1, most)))


def _has_layers(squares: NDArray[np.float64], normals: float) -> bool:
    """Whether samples lie more often at some distance from the middle than in it.

    Noise in c directions with its peak in the middle has a density that falls with the
    distance to the power of c (Olshen and Savage, 1970): of the samples up to any
    distance half or more lie within half of this power.
    """
    inner = np.sort(squares)[: math.ceil(LAYERS_SHARE * len(squares))]
    within = np.count_nonzero(inner <= inner[-1] * 0.5 ** (2 / normals))
    fewest = len(inner) / 2 - LAYERS_ERRORS * math.sqrt(len(inner)) / 2
    return bool(within < fewest)


def _groups(
    simplices: NDArray[np.int32], marked: NDArray[np.bool_], least: int
) -> NDArray[np.int64]:
    """Marked samples in sets that simplices connect, of so many of them or more.

    A part of a manifold has K + 2 at least, a stray sample is alone.
    """
    labels = _core.component_labels(_edges_among(simplices, marked), len(marked))
    together = np.flatnonzero(marked & (labels >= 0))
    sizes = np.bincount(labels[together], minlength=1)
    return together[sizes[labels[together]] >= least].astype(np.int64)


def _edges_among(
    simplices: NDArray[np.int32], marked: NDArray[np.bool_]
) -> NDArray[np.int32]:
    """Edges between marked samples, each once."""
    rows = np.sort(simplices[np.count_nonzero(marked[simplices], axis=1) >= 2], axis=1)
    pairs = itertools.combinations(range(simplices.shape[1]), 2)
    edges = np.concatenate([rows[:, pair] for pair in pairs])
    return np.unique(edges[marked[edges].all(axis=1)], axis=0)


def _num_stray(rec: ReconstructionData) -> int:
    """Outliers, if they fill more dimensions than a part of the manifold does, else 0."""
    out = rec.outliers.astype(np.int64)
    own = out[rec.representatives[out] == out]
    # Few of many, since at their own spacing even samples with noise fill space.
    some = own[np.linspace(0, len(own) - 1, min(len(own), MOST_STRAY)).astype(np.int64)]
    dim = _dimension_of(rec._source, some)
    error = dim / math.sqrt(max(1, len(some)))
    return len(own) if dim - STRAY_ERRORS * error > rec.dim else 0


def _outliers(rec: ReconstructionData) -> Iterator[_Sign]:
    """Many samples that were left out and may be a part of the manifold."""
    out = rec.outliers.astype(np.int64)
    if len(out) > MANY_OUTLIERS * rec.num_samples and _num_stray(rec) == 0:
        yield _Sign(
            True,
            f"{_count(len(out), 'sample')} were left out as outliers: stray, or the "
            "sampling is too sparse there",
            out,
        )


def _dimension_of(samples: Input, some: NDArray[np.int64]) -> float:
    """Dimension that a few of the samples fill, 0 where that cannot be told.

    By the ratios of the distances to the second and to the first nearest, whose logarithms
    are exponential with the dimension as their rate (Facco et al., 2017).
    """
    if len(some) < 3:
        return 0.0
    squares = samples.squared_distances(some[:, None], some[None, :])
    np.fill_diagonal(squares, np.inf)
    nearest = np.partition(squares, 1, axis=1)[:, :2]
    nearest = nearest[nearest[:, 0] > 0]
    total = float(np.log(nearest[:, 1] / nearest[:, 0]).sum()) / 2
    return len(nearest) / total if total > 0 else 0.0


def _out_of_time(found: _Findings) -> Iterator[_Sign]:
    number = found.repair.num_out_of_time
    if number:
        yield _Sign(
            True,
            f"max_seconds were over before {_count(number, 'program')} of cavities: "
            "what they would have filled is open",
            np.unique(found.repair.open_faces).astype(np.int64),
        )


def _too_few(found: _Findings) -> Iterator[_Sign]:
    needed = _fitted(found.dim) + 1
    if found.num_samples < needed:
        yield _Sign(
            True,
            f"{found.num_samples:,} samples are fewer than the {needed} that tell "
            "anything about the shape",
            _NOWHERE,
            2 * needed / found.num_samples,
        )
    elif found.num_simplices == 0:
        yield _Sign(True, "there are no simplices", _NOWHERE)


def _is_only_boundary(found: _Findings) -> bool:
    """Whether samples of a solid are all on its boundary, which chance does not explain.

    That n of a convex body are in convex position has a chance below (c / n^2)^n in the
    plane (Barany, 1999) and less in space: with 4 (K + 1) samples below 1e-6.
    """
    if not found.ambient_dim == found.dim > 1:
        return False
    rim = found.boundary[np.unique(found.simplices)]
    return len(rim) >= 4 * (found.dim + 1) and bool(rim.all())


def _not_a_manifold(found: _Findings) -> Iterator[_Sign]:
    topology = found.topology
    bad = topology.singular_vertices
    if len(bad):
        yield _Sign(
            True,
            f"the result is no manifold around {_count(len(bad), 'sample')}",
            bad.astype(np.int64),
            _growth_by_ratio(found, bad),
        )
    if _is_only_boundary(found):
        yield _Sign(
            True,
            _only_boundary(found.dim),
            _NOWHERE,
        )
    yield from _misfits(found)
    if (
        topology.manifold
        and topology.closed
        and not topology.orientable
        and found.ambient_dim == found.dim + 1
    ):
        yield _Sign(
            True,
            "the result is closed and has one side only, which no manifold of "
            f"codimension 1 in R^{found.ambient_dim} has",
            _NOWHERE,
        )


def _misfits(found: _Findings) -> Iterator[_Sign]:
    """Samples in no simplex, and those that have lost some."""
    cut, unused = found.repair.cut_vertices, found.repair.unused_vertices
    if len(cut):
        yield _Sign(
            True,
            f"around {_count(len(cut), 'sample')} the simplices made no manifold, and all "
            "but one fan of them were taken out",
            cut.astype(np.int64),
        )
    if len(unused) > MAX_UNUSED * found.num_samples:
        yield _Sign(
            True,
            f"{_count(len(unused), 'sample')} fit nowhere",
            unused.astype(np.int64),
        )


def _strange_neighbors(found: _Findings) -> Iterator[_Sign]:
    limits = found.limits
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = found.strange / found.spacing
    near = found.where(distance < limits.distance)
    strong = len(near) >= limits.near
    if not strong:
        near = found.where(distance < limits.some_distance)
    if len(near):
        limit = limits.distance if strong else limits.some_distance
        yield _Sign(
            strong,
            f"{_count(len(near), 'sample')} nearer than {limit:g} times the spacing to "
            "others that are far along the result: parts of the manifold are closer "
            "together than the samples on them",
            near,
            float(np.median(2 / distance[near])) / ENOUGH,
        )


def _crossings(found: _Findings) -> Iterator[_Sign]:
    """Long edges of a curve that run right by samples elsewhere on it."""
    edges = found.simplices
    if found.dim != 1 or len(edges) == 0:
        return
    lengths = np.sqrt(found.samples.squared_distances(edges[:, 0], edges[:, 1]))
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = lengths / found.spacing[edges].mean(axis=1)
    longest = np.argsort(-relative, kind="stable")[:MOST_LONG_EDGES]
    crossing = []
    for e in longest[relative[longest] > LONG_EDGE].tolist():
        ends = edges[e]
        squared = found.samples.squares_to_middle(*ends.tolist())
        at_ends = (edges == ends[0]) | (edges == ends[1])
        squared[edges[at_ends.any(axis=1)].ravel()] = np.inf
        if squared[found.own].min() < (CROSSING * lengths[e] / 2) ** 2:
            crossing.append(ends)
    if crossing:
        yield _Sign(
            True,
            f"{_count(len(crossing), 'edge')} longer than the spacing right by other "
            "samples: parts of the manifold may have been joined that are not",
            np.unique(crossing).astype(np.int64),
        )


def _folds(found: _Findings) -> Iterator[_Sign]:
    limits = found.limits
    # Among few samples the fits tell noise and bends apart no longer.
    told_apart = found.num_samples >= 4 * _fitted(found.dim) and found.noise > 0
    excused = limits.fold_by_noise * min(found.noise, MOST_NOISE) if told_apart else 0.0
    for strong, number, angle in (
        (True, limits.folded, limits.fold),
        (False, limits.some_folded, limits.some_fold),
    ):
        least = min(MOST_FOLD, angle + excused)
        folded = found.where(found.fold > least)
        if len(folded) >= number:
            folded = _without_stray(found, folded)
        if len(folded) >= number:
            yield _Sign(
                strong,
                f"the result folds back by more than {least:.0f} degrees at "
                f"{_count(len(folded), 'sample')}",
                folded,
                _growth_by_ratio(found, folded),
            )
            return


def _without_stray(found: _Findings, folded: NDArray[np.int64]) -> NDArray[np.int64]:
    """Folds without those around one sample each, as near ones of stray samples make.

    Where no more of these are than stray samples were left out.
    """
    marked = np.zeros(len(found.own), dtype=bool)
    marked[folded] = True
    edges = _edges_among(found.simplices, marked)
    labels = _core.component_labels(edges, len(marked))
    alone = labels[folded] < 0
    number = labels[folded[~alone]]
    sizes = np.bincount(number, minlength=1)
    degrees = np.bincount(edges.ravel(), minlength=len(marked))
    hubs = folded[~alone][degrees[folded[~alone]] == sizes[number] - 1]
    around_one = np.zeros(len(sizes), dtype=bool)
    around_one[labels[hubs]] = True
    stray = int(np.count_nonzero(alone) + np.count_nonzero(around_one))
    if stray == 0 or stray > _num_stray(found.rec):
        return folded
    alone[~alone] = around_one[number]
    return folded[~alone]


def _gaps(found: _Findings) -> Iterator[_Sign]:
    """Empty balls larger than samples at random leave.

    The number of samples that would fill the empty ball of a Delaunay simplex has, in a
    Poisson process, a Gamma distribution of order K (Miles, 1974).
    """
    limits = found.limits
    log_chance = _log_chance(found.gap, found.dim)
    log_expected = log_chance * _evenness(found, log_chance) + math.log10(
        found.num_simplices
    )
    strong = True
    wide = found.where(log_expected < limits.gap)
    if len(wide) == 0:
        strong = False
        wide = found.where(log_expected < limits.some_gap)
    if len(wide) == 0:
        return
    largest = float(found.gap[wide].max())
    radius = found.repair.hole_radius
    yield _Sign(
        strong,
        f"simplices at {_count(len(wide), 'sample')} span a gap of {largest:.1f} "
        "spacings, wider than samples at random leave: a hole may have been closed",
        wide,
        radius / largest if radius > largest else math.nan,
    )


def _log_chance(gap: NDArray[np.float64], dim: int) -> NDArray[np.float64]:
    """Decimal logarithm of the chance that a simplex spans a larger gap."""
    inside = _core.scale_neighbors(dim) * gap**dim
    terms = np.zeros_like(inside)
    term = np.ones_like(inside)
    for k in range(dim):
        terms += term
        term = term * inside / (k + 1)
    return np.asarray((np.log(terms) - inside) / math.log(10))


def _evenness(found: _Findings, log_chance: NDArray[np.float64]) -> float:
    """Below 1 where large gaps are more frequent than among samples at random.

    From the gap that a hundredth of the samples exceed, at least 30.
    """
    rank = max(LEAST_GAPS, found.num_samples // 100)
    if found.num_samples < 2 * rank:
        return 1.0
    seen = float(np.partition(log_chance[found.own], rank)[rank])
    simplices_at = (found.dim + 1) * found.num_simplices / found.num_samples
    # Three in four simplices have their center inside.
    random = math.log10((rank + 0.5) / found.num_samples / (0.75 * simplices_at))
    return min(1.0, min(random, -0.3) / seen) if seen < 0 else 1.0


def _openings(found: _Findings) -> Iterator[_Sign]:
    """Openings so narrow that they may be gaps between samples."""
    faces, radius = found.repair.open_faces, found.repair.hole_radius
    if found.dim == 1 or len(faces) == 0 or math.isnan(radius):
        return
    sets = _core.face_sets(faces)
    size = np.bincount(sets, _face_sizes(found, faces))
    # Radius of a round opening with a rim of this size.
    dim = found.dim
    sphere = 2 * math.pi ** (dim / 2) / math.gamma(dim / 2)
    share = (size / sphere) ** (1 / (dim - 1)) / radius
    # Where samples are missing beyond doubt the width does not matter, unless a single
    # simplex would close the rim.
    sure = np.zeros(len(found.own), dtype=bool)
    for opening in found.openings:
        if opening.decision == "open" and found.is_sure(opening):
            sure[opening.samples] = True
    count = np.bincount(sets)
    known = np.bincount(sets, sure[faces].all(axis=1)) > count / 2
    share[known & (count > dim + 1)] = np.inf
    limits = found.limits
    strong = bool((share < limits.opening).any())
    narrow = share < (limits.opening if strong else limits.some_opening)
    if narrow.any():
        rims = np.unique(faces[narrow[sets]]).astype(np.int64)
        yield _Sign(
            strong,
            f"{_count(int(narrow.sum()), 'opening')} narrower than the hole radius may "
            "be nothing but gaps between samples",
            rims,
            1 / float(share.min()),
        )


def _described(opening: Opening) -> str:
    spacings = 2 * opening.radius / opening.spacing
    return (
        f"a {opening.kind} of {spacings:.1f} spacings with {opening.missing:.0f} samples "
        "missing"
    )


def _samples_of(openings: list[Opening]) -> NDArray[np.int64]:
    samples = np.concatenate([opening.samples for opening in openings])
    return np.unique(samples).astype(np.int64)


def _matters(found: _Findings, opening: Opening) -> bool:
    """Whether the topology is another one without what goes through a closed place."""
    through = mark_rows(found.rows, opening.simplices, len(found.own))
    return not through.any() or _changes(found, through)


def _changes(found: _Findings, removed: NDArray[np.bool_]) -> bool:
    """Whether the topology is another one without some simplices."""
    return removal_changes(found.rows, removed, found.repair.open_faces, len(found.own))


def _necks(found: _Findings) -> Iterator[_Sign]:
    """Triangles that have no sample inside the surface and join what is apart else.

    A neck or band as narrow cannot be told from a bridge between two rims.
    """
    if found.dim != 2 or len(found.repair.open_faces) == 0:
        return
    rows, on_rim = found.rows, found.on_rim
    thin = np.flatnonzero(on_rim[rows].all(axis=1))
    if len(thin) == 0 or len(thin) == len(rows):
        return
    groups = _core.face_sets(rows[thin])
    count = int(groups.max()) + 1
    chosen = [thin[groups == group] for group in range(min(count, MOST_OPENED))]
    if count > MOST_OPENED:
        chosen = [thin]
    necks = []
    for one in chosen:
        removed = np.zeros(len(rows), dtype=bool)
        removed[one] = True
        if _changes(found, removed):
            necks.append(rows[one])
    if necks:
        samples = np.unique(np.concatenate(necks)).astype(np.int64)
        yield _Sign(
            True,
            f"{_count(len(necks), 'neck')} without a sample inside: what it joins may "
            "be apart; more samples there would tell",
            samples,
        )


def _strips(found: _Findings) -> Iterator[_Sign]:
    """Simplices between samples around an open place that reach from rim to rim.

    No sample lies in them, as none does in the place, which may go on there.
    """
    open_holes = [
        opening
        for opening in found.openings
        if opening.kind == "hole" and opening.decision == "open"
    ]
    if not open_holes or len(found.repair.open_faces) == 0:
        return
    around = found.on_rim.copy()
    around[_samples_of(open_holes)] = True
    rows, rim = found.rows, np.sort(found.repair.open_faces, axis=1)
    thin = np.flatnonzero(around[rows].all(axis=1))
    parts = _core.face_sets(rows[thin]) if len(thin) else np.empty(0, np.int64)
    strips = []
    for part in np.argsort(-np.bincount(parts), kind="stable")[:MOST_OPENED]:
        one = thin[parts == part]
        faces = [np.delete(rows[one], i, axis=1) for i in range(found.dim + 1)]
        ends = np.concatenate(faces)
        ends = ends[mark_rows(ends, rim, len(found.own))]
        if len(ends) < 2 or _core.face_sets(ends).max() == 0:
            continue
        removed = np.zeros(len(rows), dtype=bool)
        removed[one] = True
        if _changes(found, removed):
            strips.append(rows[one])
    if strips:
        yield _Sign(
            True,
            f"{_count(len(strips), 'strip')} without a sample inside, next to a hole "
            "that was left open: what it joins may be apart",
            np.unique(np.concatenate([rows.ravel() for rows in strips])).astype(
                np.int64
            ),
        )


def _bridges(found: _Findings) -> Iterator[_Sign]:
    """Places one edge wide between two sheets: the edge reaches from rim to rim."""
    if found.dim != 2 or len(found.repair.open_faces) == 0:
        return
    rows, on_rim = found.rows, found.on_rim
    at_rim = np.flatnonzero(np.count_nonzero(on_rim[rows], axis=1) >= 2)
    edges = rows[at_rim][:, [[0, 1], [0, 2], [1, 2]]]
    of_edge = np.repeat(at_rim, 3)
    edges, number = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
    inside = on_rim[edges].all(axis=1) & (np.bincount(number.ravel()) == 2)
    crossed = np.unique(of_edge[inside[number.ravel()]])
    if len(crossed) == 0:
        return
    rest = np.delete(rows, crossed, axis=0)
    sets = _core.face_sets(rest)
    wide = np.bincount(sets) >= LEAST_SHEET if len(rest) else np.empty(0, dtype=bool)
    whole = np.count_nonzero(np.bincount(_core.face_sets(rows)) >= LEAST_SHEET)
    if np.count_nonzero(wide) <= whole:
        return
    sheet = np.full(len(found.own), -1)
    sheet[rest[wide[sets]].ravel()] = np.repeat(sets[wide[sets]], 3)
    between = np.concatenate([rows[crossed], rest[~wide[sets]]])
    parts = _core.face_sets(between)
    bridges = []
    for part in range(int(parts.max()) + 1):
        samples = np.unique(between[parts == part])
        if len(np.unique(sheet[samples][sheet[samples] >= 0])) >= 2:
            bridges.append(samples)
    if bridges:
        yield _Sign(
            True,
            f"{_count(len(bridges), 'bridge')} one edge wide: the sheets joined there "
            "may be apart; more samples there would tell",
            np.concatenate(bridges).astype(np.int64),
        )


def _needed(found: _Findings, opening: Opening) -> str:
    """How many samples more or less missing would decide otherwise."""
    if not 0 < found.significance < 1 or not opening.expected > 0:
        return ""
    asked = -math.log1p(-found.significance)
    decay = _core.opening_decay(found.dim)
    count = opening.dispersion * abs(math.log(opening.expected / asked)) / decay
    more = "more" if opening.decision == "closed" else "fewer"
    return (
        f", as it is with {_count(max(1, math.ceil(count)), 'sample')} {more} missing"
    )


def _why_closed(found: _Findings, opening: Opening) -> str:
    what, chance = _described(opening), f"{opening.significance:.2g}"
    radius = None if found.rec._options is None else found.rec._options.hole_radius
    if radius is not None:
        return (
            f"{what} was closed because hole_radius is {radius:g}, but chance leaves one as "
            f"large in {chance} of such data"
        )
    if opening.significance <= found.significance:
        return (
            f"{what} was opened and filled again by what all samples there agree on, but "
            f"chance leaves one as large in {chance} of such data"
        )
    return (
        f"{what} was closed, but chance leaves one as large in {chance} of such data: from "
        f"significance={chance} on it is open{_needed(found, opening)}"
    )


def _close_decisions(found: _Findings) -> Iterator[_Sign]:
    """Gaps that chance leaves now and then, and openings that it could have left."""
    options = found.rec._options
    if options is not None and not isinstance(options.boundary, str):
        return  # what is open was said
    wide = [
        opening
        for opening in found.openings
        if opening.decision == "closed"
        and not opening.given
        and (opening.kind == "joint" or opening.significance <= RARE_GAP)
    ]
    # The least likely first; among many the rest counts without a look.
    wide.sort(key=lambda opening: opening.significance)
    wide = [
        opening
        for number, opening in enumerate(wide)
        if number >= MOST_OPENED or _matters(found, opening)
    ]
    if wide:
        widest = wide[0]
        yield _Sign(True, _why_closed(found, widest), _samples_of(wide))
    near = [
        opening
        for opening in found.openings
        if opening.decision == "open"
        and opening.kind in ("gap", "hole")
        and not opening.given
        and not found.is_sure(opening)
    ]
    if near:
        least = max(near, key=lambda opening: opening.significance)
        yield _Sign(
            True,
            f"{_described(least)} was left open, but below significance="
            f"{least.significance:.2g} it is closed{_needed(found, least)}",
            _samples_of(near),
        )


def _parts(found: _Findings) -> Iterator[_Sign]:
    """Few samples far from all others, in no simplex."""
    parts = [opening for opening in found.openings if opening.kind == "part"]
    if parts:
        samples = _samples_of(parts)
        yield _Sign(
            True,
            f"{_count(len(parts), 'part')} of {_count(len(samples), 'sample')} far from "
            "all others, with too few samples for a manifold, left out",
            samples,
        )


def _face_sizes(found: _Findings, faces: NDArray[np.int32]) -> NDArray[np.float64]:
    """Volumes of (K-1)-simplices over the spacing to that power."""
    order = found.dim - 1
    first, others = faces[:, :1], faces[:, 1:]
    from_first = found.samples.squared_distances(first, others)
    among = found.samples.squared_distances(others[:, :, None], others[:, None, :])
    gram = (from_first[:, :, None] + from_first[:, None, :] - among) / 2
    volumes = np.sqrt(np.maximum(np.linalg.det(gram), 0)) / math.factorial(order)
    return np.asarray(volumes / found.spacing[faces].mean(axis=1) ** order)


def _disputes(found: _Findings) -> Iterator[_Sign]:
    against = len(found.repair.disputed_simplices)
    share = against / max(1, against + found.repair.num_agreed)
    limits = found.limits
    unsure = found.quantile(found.confidence, 0.05)
    if share > limits.some_disputed or unsure < limits.some_confidence:
        strong = share > limits.disputed
        worst = found.where((found.disputed > limits.some_disputed) & (share > 0.5))
        text = f"{share:.0%} of the simplices that samples propose are disputed"
        if share <= limits.some_disputed:
            worst = found.where(found.confidence < limits.some_confidence)
            text = (
                f"the simplices at {_count(len(worst), 'sample')} stand off the tangent "
                "space"
            )
        yield _Sign(strong, text, worst, _growth_by_ratio(found, worst))


def _sparsity(found: _Findings) -> Iterator[_Sign]:
    limits = found.limits
    if found.noise > limits.some_scatter:
        yield _Sign(
            found.noise > limits.scatter,
            f"the samples lie {found.noise:.2f} spacings off any smooth manifold: noise, "
            "or bends between the samples",
            _NOWHERE,
        )
    elif found.quantile(found.ratio, 0.95) > limits.some_ratio:
        sparse = found.where(found.ratio > limits.some_ratio)
        yield _Sign(
            False,
            f"the spacing is more than {limits.some_ratio:g} times the reach at "
            f"{_count(len(sparse), 'sample')}",
            sparse,
            _growth_by_ratio(found, sparse),
        )


# ------------------------------------------------------------------------ the verdict


def _count(number: int, what: str) -> str:
    return f"{number:,} {what}" if number == 1 else f"{number:,} {what}s"


def _growth_by_ratio(found: _Findings, samples: NDArray[Any]) -> float:
    ratios = found.ratio[samples]
    ratios = ratios[np.isfinite(ratios)]
    return float(np.median(ratios)) / ENOUGH if len(ratios) else math.nan


def _recommended(found: _Findings, signs: list[_Sign]) -> int | None:
    """N (ratio / allowed ratio)^K by the sign that asks for most, to two digits."""
    growths = [sign.growth for sign in signs if sign.growth > 1]
    if not growths:
        return None
    return two_digits(found.num_samples * max(growths) ** found.dim)


def _verdict(
    found: _Findings,
    reasons: tuple[Reason, ...],
    recommended: int | None,
    points: NDArray[np.float64] | None,
) -> str:
    of = _count(found.num_samples, "sample")
    if not reasons:
        ratio = found.quantile(found.ratio, 0.95)
        return (
            f"sampling is dense enough: the spacing is at most {ratio:.2g} times the "
            f"reach at 95 % of {of}"
        )
    if reasons[0].kind in ("singular", "noise"):
        return reasons[0].text
    marked = np.unique(np.concatenate([reason.samples for reason in reasons]))
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
        head = f"{of} do not determine the result"
    if recommended is not None:
        parts.append(f"about {recommended:,} would do")
    return f"{head}: {'; '.join(parts)}"


def _place(found: _Findings, marked: NDArray[np.int64]) -> tuple[int, bool]:
    """The middle of the largest connected set of samples, and if it has most of them.

    The middle is the sample with most neighbors in the set, the first of these.
    """
    inside = np.zeros(len(found.own), dtype=bool)
    inside[marked] = True
    rows = found.simplices[inside[found.simplices].sum(axis=1) > 1]
    columns = [(i, j) for j in range(rows.shape[1]) for i in range(j)]
    edges = np.concatenate(
        [rows[:, list(pair)] for pair in columns] or [np.empty((0, 2), np.int32)]
    )
    edges = np.sort(edges[inside[edges].all(axis=1)], axis=1)
    if len(edges) == 0:
        return int(marked[0]), len(marked) == 1
    edges = np.unique(edges, axis=0)
    labels = _core.component_labels(edges, len(inside))
    sizes = np.bincount(labels[labels >= 0])
    degrees = np.bincount(edges.ravel(), minlength=len(inside))
    degrees[labels != int(np.argmax(sizes))] = 0
    return int(np.argmax(degrees)), bool(2 * sizes.max() >= len(marked))
