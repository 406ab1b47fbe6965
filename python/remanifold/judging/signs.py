# SPDX-License-Identifier: GPL-3.0-or-later
"""Signs that the samples do not determine the result: what each is, and where."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold import _core
from remanifold._base.distinct import distinct
from remanifold._base.samples import Points
from remanifold.judging.corners import length_through_corner
from remanifold.judging.findings import SURE, Findings, Sign
from remanifold.judging.removal import (
    closing_changes,
    mark_rows,
    removal_changes,
)
from remanifold.judging.singularities import (
    KINDS,
    LOWER,
    Neighbors,
    places_among,
    verdict_on,
)
from remanifold.judging.waists import tubes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold._base.samples import Input
    from remanifold.method.openings import Opening
    from remanifold.method.result import ReconstructionData

MAX_UNUSED = 0.01  # of the samples
MOST_FOLD = 176.0  # degrees that noise may account for, with the limit itself
MOST_NOISE = 0.2  # over the spacing, beyond which it is no longer told from sparsity
MANY_OUTLIERS = 0.05  # share of the samples
# A line of samples with a surface through it: this share of them and more inside of that,
# where it bends by no more degrees.
COVERED, SMOOTH_FOLD = 0.5, 60.0
MOST_STRAY = 128  # of them that tell which dimension they fill
STRAY_NEIGHBORS = 4  # of each that are asked: with more a part that bends fills space
# Neighborhoods overlap: the sum of the logarithms varies so many times as much as if they
# did not, 1.3 to 1.8 times in simulations of 5 to 128 samples in 1 to 3 dimensions.
STRAY_OVERLAP = 1.65
STRAY_ERRORS = 2.0  # standard errors by which it is more than that of the manifold
LONG_EDGE = 1.2  # spacings
MOST_LONG_EDGES = 50  # that are looked at
LEAST_SHEET = 16  # triangles
MOST_AROUND = 18  # triangles on one side of a loop of three edges
CROSSING = 0.5  # distance of a sample from the middle over half the length
MOST_OPENED = 10  # closed places that are taken out to see what that does
# Chance of a gap as large as one that was closed, up to which that is in doubt: so many of
# the results that are right are doubted for it. Joints are in doubt unless they are corners.
RARE_GAP = 0.04
CORNER_STEPS = 6  # along a curve that tell its direction, as for joints
NORMAL_QUARTILES = 1.349  # standard deviations between them
LAYERS_SHARE = 0.75  # of the samples, those nearest to the middle
LAYERS_ERRORS = 3.0  # standard errors from which on too few samples lie in the middle
NO_NOISE = 1e-3  # chance that normal noise moves any sample so far
LEAST_GAPS = 30  # samples from which the evenness is judged
MUCH_LEFT = 0.15  # of the spacing: noise that makes samples propose other simplices
ENOUGH = 1.0  # spacing over reach that is asked for when recommending


def signs_of(found: Findings) -> Iterator[Sign]:
    """All signs, the plainest first. A new kind of doubt is one more line here."""
    yield from _out_of_time(found)
    few = list(too_few(found))
    yield from few
    if not few:
        yield from _not_a_manifold(found)
        yield from _strange_neighbors(found)
        yield from _crossings(found)
        yield from _folds(found)
        yield from _gaps(found)
        yield from _openings(found)
        yield from close_decisions(found)
        yield from _necks(found)
        yield from _strips(found)
        yield from _bridges(found)
        yield from _waists(found)
        yield from parts_left_out(found)
        yield from disputes(found)
        yield from _sparsity(found)


def narrow_neighbors(dim: int) -> int:
    """Neighbors of the narrow fits."""
    return _core.jet_neighbors(dim)


def singular_signs(
    found: Findings, samples: Input, neighbors: Neighbors
) -> Iterator[Sign]:
    """Where the samples are no K-manifold at all."""
    if len(neighbors.samples) <= 2 * found.dim + 2:
        return
    places = [
        place
        for place in places_among(samples, found.dim, neighbors).places
        if place.kind != KINDS[LOWER] or not is_covered(found, place.samples)
    ]
    if places:
        marked = distinct(np.concatenate([place.samples for place in places]))
        yield Sign(
            True,
            verdict_on(found.dim, places),
            marked.astype(np.int64),
            kind="singular",
        )


def is_covered(found: Findings, samples: NDArray[Any]) -> bool:
    """Whether samples along lines are those of a manifold that is sampled denser along them.

    Most of them then lie inside the result, which is smooth there and as all agree.
    """
    inside = np.zeros(len(found.own), dtype=bool)
    inside[found.rows] = True
    inside[found.repair.filled_simplices] = False
    inside &= found.fold <= SMOOTH_FOLD
    samples = samples[~found.on_rim[samples]]
    return bool(np.count_nonzero(inside[samples]) > COVERED * len(samples))


NOWHERE = np.empty(0, dtype=np.int64)


def noise_signs(
    rec: ReconstructionData, found: Findings, doubted: bool
) -> Iterator[Sign]:
    """Noise that drowns the shape, that is none, or that explains what is doubted."""
    smoothing, moved = rec.smoothing, rec.smoothing is not None and rec.smoothing.moved
    if moved and smoothing is not None:
        yield from _no_noise(rec)
        noise, rest = smoothing.noise, smoothing.remaining_error
        if smoothing.drowned:
            yield Sign(
                True,
                f"noise drowns the shape: the samples lie {noise:.3g} off any manifold, "
                f"smoothed about {rest:.3g}; about {smoothing.enough_samples:,} samples "
                "would do",
                NOWHERE,
                kind="noise",
            )
        elif doubted and (
            len(rec.attached) > 0
            or rest > MUCH_LEFT * found.quantile(found.spacing, 0.5)
        ):
            yield Sign(
                True,
                f"noise: the samples lie {noise:.3g} off the manifold, smoothed about "
                f"{rest:.3g}, which is much for their spacing; four times as many would "
                "halve it",
                NOWHERE,
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
            yield Sign(
                True,
                f'noise: the samples lie {noise:.3g} off the manifold; smooth="auto" '
                f"would leave about {report['remaining_error']:.3g}",
                NOWHERE,
                kind="noise",
            )


def _no_noise(rec: ReconstructionData) -> Iterator[Sign]:
    """What smoothing took for noise though noise does not lie like that."""
    assert rec.smoothing is not None
    residuals = rec.residuals
    if residuals is None or rec.samples is None or not rec.smoothing.noise > 0:
        return
    smoothed = np.ones(rec.num_samples, dtype=bool)
    smoothed[rec.outliers] = smoothed[rec.invalid] = False
    if not smoothed.any():
        return
    squares = (residuals / rec.smoothing.noise) ** 2
    given = np.ascontiguousarray(rec.samples[smoothed], dtype=np.float64)
    codim = _core.affine_dim(given, 1) - rec.dim
    normals = _normal_directions(squares[smoothed], codim)
    if _has_layers(squares[smoothed], normals):
        yield Sign(
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
        yield Sign(
            True,
            f"smoothing moved {count_of(len(beyond), 'sample')} by more than noise "
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
    labels = _core.component_labels(edges_among(simplices, marked), len(marked))
    together = np.flatnonzero(marked & (labels >= 0))
    sizes = np.bincount(labels[together], minlength=1)
    return together[sizes[labels[together]] >= least].astype(np.int64)


def edges_among(
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
    dim, count = _dimension_of(rec._source, some)
    if not dim > rec.dim:
        return 0
    # The sum of the logarithms is distributed as Gamma, whose cube root is nearly normal
    # (Wilson and Hilferty, 1931).
    order = count / STRAY_OVERLAP
    errors = 3 * math.sqrt(order) * (1 - 1 / (9 * order) - (rec.dim / dim) ** (1 / 3))
    return len(own) if errors > STRAY_ERRORS else 0


def outlier_signs(rec: ReconstructionData) -> Iterator[Sign]:
    """Many samples that were left out and may be a part of the manifold."""
    out = rec.outliers.astype(np.int64)
    if len(out) > MANY_OUTLIERS * rec.num_samples and _num_stray(rec) == 0:
        yield Sign(
            True,
            f"{count_of(len(out), 'sample')} were left out as outliers: stray, or the "
            "sampling is too sparse there",
            out,
        )


def _dimension_of(samples: Input, some: NDArray[np.int64]) -> tuple[float, int]:
    """Dimension that a few of the samples fill, 0 where that cannot be told.

    By the ratios of the distances to the last of some neighbors and to those before it,
    whose logarithms are exponential with the dimension as their rate (Levina and Bickel,
    2004). Besides the number of the logarithms.
    """
    number = min(STRAY_NEIGHBORS, len(some) - 1)
    if number < 2:
        return 0.0, 0
    squares = samples.squared_distances(some[:, None], some[None, :])
    np.fill_diagonal(squares, np.inf)
    nearest = np.sort(squares, axis=1)[:, :number]
    nearest = nearest[nearest[:, 0] > 0]
    total = float(np.log(nearest[:, -1:] / nearest[:, :-1]).sum()) / 2
    count = len(nearest) * (number - 1)
    return (count / total, count) if total > 0 else (0.0, 0)


def _out_of_time(found: Findings) -> Iterator[Sign]:
    number = found.repair.num_out_of_time
    if number:
        yield Sign(
            True,
            f"max_seconds were over before {count_of(number, 'program')} of cavities: "
            "what they would have filled is open",
            distinct(found.repair.open_faces).astype(np.int64),
        )


def too_few(found: Findings) -> Iterator[Sign]:
    """Fewer samples than a fit needs."""
    needed = narrow_neighbors(found.dim) + 1
    if found.num_samples < needed:
        yield Sign(
            True,
            f"{count_of(found.num_samples, 'sample')} "
            f"{'is' if found.num_samples == 1 else 'are'} fewer than the {needed} that "
            "tell anything about the shape",
            NOWHERE,
            2 * needed / found.num_samples,
        )
    elif found.num_simplices == 0:
        yield Sign(True, "there are no simplices", NOWHERE)


def only_boundary(dim: int) -> str:
    """What to say where every sample is on the boundary."""
    return (
        f"every sample is on the boundary of the {dim}-dimensional result: they may be of "
        f"its boundary, dim={dim - 1}"
    )


def is_only_boundary(rec: ReconstructionData) -> bool:
    """Whether samples of a solid are all on its boundary, which chance does not explain.

    That n of a convex body are in convex position has a chance below (c / n^2)^n in the
    plane (Barany, 1999) and less in space: with 4 (K + 1) samples below 1e-6.
    """
    if not rec.ambient_dim == rec.dim > 1:
        return False
    rim = rec.boundary[distinct(rec.simplices)]
    return len(rim) >= 4 * (rec.dim + 1) and bool(rim.all())


def _not_a_manifold(found: Findings) -> Iterator[Sign]:
    topology = found.topology
    bad = topology.singular_vertices
    if len(bad):
        yield Sign(
            True,
            f"the result is no manifold around {count_of(len(bad), 'sample')}",
            bad.astype(np.int64),
            _growth_by_ratio(found, bad),
        )
    if is_only_boundary(found.rec):
        yield Sign(
            True,
            only_boundary(found.dim),
            NOWHERE,
        )
    yield from misfits(found)
    if (
        topology.manifold
        and topology.closed
        and not topology.orientable
        and found.ambient_dim == found.dim + 1
    ):
        yield Sign(
            True,
            "the result is closed and has one side only, which no manifold of "
            f"codimension 1 in R^{found.ambient_dim} has",
            NOWHERE,
        )


def misfits(found: Findings) -> Iterator[Sign]:
    """Samples in no simplex, and those that have lost some."""
    cut, unused = found.repair.cut_vertices, found.repair.unused_vertices
    if len(cut):
        yield Sign(
            True,
            f"around {count_of(len(cut), 'sample')} the simplices made no manifold, and all "
            "but one fan of them were taken out",
            cut.astype(np.int64),
        )
    if len(unused) > MAX_UNUSED * found.num_samples:
        yield Sign(
            True,
            f"{count_of(len(unused), 'sample')} fit nowhere",
            unused.astype(np.int64),
        )


def _strange_neighbors(found: Findings) -> Iterator[Sign]:
    limits = found.limits
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = found.strange / found.spacing
    near = found.where(distance < limits.distance)
    strong = len(near) >= limits.near
    if not strong:
        near = found.where(distance < limits.some_distance)
    if len(near):
        limit = limits.distance if strong else limits.some_distance
        yield Sign(
            strong,
            f"{count_of(len(near), 'sample')} nearer than {limit:g} times the spacing to "
            "others that are far along the result: parts of the manifold are closer "
            "together than the samples on them",
            near,
            float(np.median(2 / distance[near])) / ENOUGH,
        )


def _crossings(found: Findings) -> Iterator[Sign]:
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
        yield Sign(
            True,
            f"{count_of(len(crossing), 'edge')} longer than the spacing right by other "
            "samples: parts of the manifold may have been joined that are not",
            distinct(np.asarray(crossing)).astype(np.int64),
        )


def _folds(found: Findings) -> Iterator[Sign]:
    limits = found.limits
    # Among few samples the fits tell noise and bends apart no longer.
    told_apart = (
        found.num_samples >= 4 * narrow_neighbors(found.dim) and found.noise > 0
    )
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
            yield Sign(
                strong,
                f"the result folds back by more than {least:.0f} degrees at "
                f"{count_of(len(folded), 'sample')}",
                folded,
                _growth_by_ratio(found, folded),
            )
            return


def _without_stray(found: Findings, folded: NDArray[np.int64]) -> NDArray[np.int64]:
    """Folds without those around one sample each, as near ones of stray samples make.

    Where no more of these are than stray samples were left out.
    """
    marked = np.zeros(len(found.own), dtype=bool)
    marked[folded] = True
    edges = edges_among(found.simplices, marked)
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


def _gaps(found: Findings) -> Iterator[Sign]:
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
    yield Sign(
        strong,
        f"simplices at {count_of(len(wide), 'sample')} span a gap of {largest:.1f} "
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


def _evenness(found: Findings, log_chance: NDArray[np.float64]) -> float:
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


def _openings(found: Findings) -> Iterator[Sign]:
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
        rims = distinct(faces[narrow[sets]]).astype(np.int64)
        yield Sign(
            strong,
            f"{count_of(int(narrow.sum()), 'opening')} narrower than the hole radius may "
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
    return distinct(samples).astype(np.int64)


def _matters(found: Findings, opening: Opening) -> bool:
    """Whether the topology is another one without what goes through a closed place."""
    through = mark_rows(found.rows, opening.simplices, len(found.own))
    return not through.any() or _changes(found, through)


def _matters_open(found: Findings, opening: Opening) -> bool:
    """Whether the topology is another one with an open place closed, as far as is seen."""
    rim = np.sort(found.repair.open_faces, axis=1)
    return closing_changes(found.rows, opening.simplices, rim, len(found.own))


def _changes(found: Findings, removed: NDArray[np.bool_]) -> bool:
    """Whether the topology is another one without some simplices."""
    return removal_changes(found.rows, removed, found.repair.open_faces, len(found.own))


def _necks(found: Findings) -> Iterator[Sign]:
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
        samples = distinct(np.concatenate(necks)).astype(np.int64)
        yield Sign(
            True,
            f"{count_of(len(necks), 'neck')} without a sample inside: what it joins may "
            "be apart; more samples there would tell",
            samples,
        )


def _strips(found: Findings) -> Iterator[Sign]:
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
    if len(open_holes) <= MOST_OPENED:
        open_holes = [one for one in open_holes if _matters_open(found, one)]
        if not open_holes:
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
        yield Sign(
            True,
            f"{count_of(len(strips), 'strip')} without a sample inside, next to a hole "
            "that was left open: what it joins may be apart",
            distinct(np.concatenate([rows.ravel() for rows in strips])).astype(
                np.int64
            ),
        )


def _bridges(found: Findings) -> Iterator[Sign]:
    """Places one edge wide between two sheets: the edge reaches from rim to rim."""
    if found.dim != 2 or len(found.repair.open_faces) == 0:
        return
    rows, on_rim = found.rows, found.on_rim
    at_rim = np.flatnonzero(np.count_nonzero(on_rim[rows], axis=1) >= 2)
    edges = rows[at_rim][:, [[0, 1], [0, 2], [1, 2]]]
    of_edge = np.repeat(at_rim, 3)
    edges, number = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
    inside = on_rim[edges].all(axis=1) & (np.bincount(number.ravel()) == 2)
    crossed = distinct(of_edge[inside[number.ravel()]])
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
        samples = distinct(between[parts == part])
        if len(distinct(sheet[samples][sheet[samples] >= 0])) >= 2:
            bridges.append(samples)
    if bridges:
        yield Sign(
            True,
            f"{count_of(len(bridges), 'bridge')} one edge wide: the sheets joined there "
            "may be apart; more samples there would tell",
            np.concatenate(bridges).astype(np.int64),
        )


def _waists(found: Findings) -> Iterator[Sign]:
    """Loops of three edges around a tube, the least that a triangulation can have.

    A tube as narrow has its axis nearer than its samples are to each other. It cannot be
    told from two sheets that come near each other and were joined.
    """
    if found.dim != 2 or len(found.rows) < 2 * LEAST_SHEET:
        return
    # Around the tube the surface turns by 360 degrees in so many triangles.
    bent = ~(found.fold < 360 / MOST_AROUND)
    waists = tubes(found.rows, bent, LEAST_SHEET)
    if len(waists):
        yield Sign(
            True,
            f"{count_of(len(waists), 'loop')} of three edges around a tube: what it joins "
            "may be apart; more samples there would tell",
            distinct(waists).astype(np.int64),
        )


def _needed(found: Findings, opening: Opening) -> str:
    """How many samples more or less missing would decide otherwise."""
    if not 0 < found.significance < 1 or not opening.expected > 0:
        return ""
    asked = -math.log1p(-found.significance)
    decay = _core.opening_decay(found.dim)
    count = opening.dispersion * abs(math.log(opening.expected / asked)) / decay
    more = "more" if opening.decision == "closed" else "fewer"
    return (
        f", as it is with {count_of(max(1, math.ceil(count)), 'sample')} {more} missing"
    )


def _why_closed(found: Findings, opening: Opening) -> str:
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


def _chance_of_corner(found: Findings, joint: Opening) -> float:
    """Chance that data without ends leaves a corner somewhere with as wide a gap.

    Such a curve goes on straight to where both sides meet, and has as many places for a gap
    as samples. 0 where they do not meet.
    """
    length = length_through_corner(
        found.samples, found.rows, joint.samples, joint.spacing, CORNER_STEPS
    )
    weight = length / (joint.spacing * joint.dispersion)
    return -math.expm1(-found.num_samples * math.exp(-weight))


def close_decisions(found: Findings) -> Iterator[Sign]:
    """Gaps that chance leaves now and then, and openings that it could have left."""
    options = found.rec._options
    if options is not None and not isinstance(options.boundary, str):
        return  # what is open was said
    wide = [
        opening
        for opening in found.openings
        if opening.decision == "closed"
        and not opening.given
        and (
            _chance_of_corner(found, opening)
            if opening.kind == "joint"
            else opening.significance
        )
        <= RARE_GAP
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
        yield Sign(True, _why_closed(found, widest), _samples_of(wide))
    near = [
        opening
        for opening in found.openings
        if opening.decision == "open"
        and opening.kind in ("gap", "hole")
        and not opening.given
        and not found.is_sure(opening)
    ]
    near.sort(key=lambda opening: -opening.significance)
    near = [
        opening
        for number, opening in enumerate(near)
        if number >= MOST_OPENED or _matters_open(found, opening)
    ]
    corners = [
        opening
        for opening in found.openings
        if opening.kind == "joint"
        and opening.decision == "open"
        and not opening.given
        and _chance_of_corner(found, opening) > SURE * found.significance
    ]
    if corners:
        widest = max(corners, key=lambda opening: opening.missing)
        yield Sign(
            True,
            f"{_described(widest)} was left open, but both sides lead to one point: a "
            "corner of the curve may be there",
            _samples_of(corners),
        )
    if near:
        least = near[0]
        yield Sign(
            True,
            f"{_described(least)} was left open, but below significance="
            f"{least.significance:.2g} it is closed{_needed(found, least)}",
            _samples_of(near),
        )


def parts_left_out(found: Findings) -> Iterator[Sign]:
    """Few samples far from all others, in no simplex."""
    parts = [opening for opening in found.openings if opening.kind == "part"]
    if parts:
        samples = _samples_of(parts)
        yield Sign(
            True,
            f"{count_of(len(parts), 'part')} of {count_of(len(samples), 'sample')} far from "
            "all others, with too few samples for a manifold, left out",
            samples,
        )


def _face_sizes(found: Findings, faces: NDArray[np.int32]) -> NDArray[np.float64]:
    """Volumes of (K-1)-simplices over the spacing to that power."""
    order = found.dim - 1
    first, others = faces[:, :1], faces[:, 1:]
    from_first = found.samples.squared_distances(first, others)
    among = found.samples.squared_distances(others[:, :, None], others[:, None, :])
    gram = (from_first[:, :, None] + from_first[:, None, :] - among) / 2
    volumes = np.sqrt(np.maximum(np.linalg.det(gram), 0)) / math.factorial(order)
    return np.asarray(volumes / found.spacing[faces].mean(axis=1) ** order)


def disputes(found: Findings) -> Iterator[Sign]:
    """Simplices that samples propose and others do not, or that stand up."""
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
                f"the simplices at {count_of(len(worst), 'sample')} stand off the tangent "
                "space"
            )
        yield Sign(strong, text, worst, _growth_by_ratio(found, worst))


def _sparsity(found: Findings) -> Iterator[Sign]:
    limits = found.limits
    if found.noise > limits.some_scatter:
        yield Sign(
            found.noise > limits.scatter,
            f"the samples lie {found.noise:.2f} spacings off any smooth manifold: noise, "
            "or bends between the samples",
            NOWHERE,
        )
    elif found.quantile(found.ratio, 0.95) > limits.some_ratio:
        sparse = found.where(found.ratio > limits.some_ratio)
        yield Sign(
            False,
            f"the spacing is more than {limits.some_ratio:g} times the reach at "
            f"{count_of(len(sparse), 'sample')}",
            sparse,
            _growth_by_ratio(found, sparse),
        )


def count_of(number: int, what: str) -> str:
    """A number with its noun."""
    return f"{number:,} {what}" if number == 1 else f"{number:,} {what}s"


def _growth_by_ratio(found: Findings, samples: NDArray[Any]) -> float:
    ratios = found.ratio[samples]
    ratios = ratios[np.isfinite(ratios)]
    return float(np.median(ratios)) / ENOUGH if len(ratios) else math.nan
