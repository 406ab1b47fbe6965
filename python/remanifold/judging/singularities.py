# SPDX-License-Identifier: GPL-3.0-or-later
"""Where samples are no manifold: crossings, branchings, parts of another dimension."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import gamma, pi
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from remanifold import _core
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.samples import Points
from remanifold._base.scaling import classical_scaling
from remanifold._base.validation import (
    check_dim,
    check_int,
    check_num_threads,
    check_samples,
)
from remanifold.method.steps import neighborhoods

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.samples import Input

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]
    Bools = NDArray[np.bool_]

KINDS = ("regular", "crossing", "lower dimension", "higher dimension")
REGULAR, CROSSING, LOWER, HIGHER = range(4)

# Angles that tell planes apart: within FLAT two planes are one and the same, beyond
# APART they are two; directions of one branch lie within NARROW of each other.
FLAT, APART, NARROW = np.radians([20.0, 25.0, 15.0])
# A plane may miss a sample that it passes through by this per distance, besides some
# part of a spacing: what noise of a quarter of a spacing does to small fits.
SLOPE = 0.07
CLEAN = (
    0.35  # largest spread off a plane over the smallest in it, of a plane that counts
)
ROUND = 0.2  # smallest spread in it over the largest
SUSPICIOUS = 0.2  # spread off the plane of a wide neighborhood that is worth a look
UNFIT = 0.12  # the same after a quadratic fit
INNER = 2.0  # spacings; nearer samples do not tell in which direction they lie
EXPLAINED = 0.85  # share of near samples that the branches of a crossing hold
# The tip of a cone: near it, so much of what has planes has one that passes, and at least
# so many samples do, of which the largest set of like planes has no more than this share.
# Looked for within all of the reach and within part of it.
TIP_PASSING, TIP_FEWEST, TIP_ALIKE = 0.7, 20, 0.6
TIP_REACHES = (1.0, 0.6)
# Cosine to a probing direction of what lies that way, and how many must, on a line and
# beyond.
TOWARDS = 0.65
HITS_ON_A_LINE, HITS = 3, 2
DIAGONALS = 6  # coordinates whose diagonals are probed
MOST_BRANCHES = 6
ASKEW = 0.36  # squared mean over mean square of places along a face, at its end one
CLAIMED = 1.6  # of NARROW: directions this near a branch are its own
# Of a cone: directions and planes that follow each other on it, the fewest of a piece, how
# round the piece is, and how far from the center it stands, where it is no plane.
CONE_STEP, CONE_APART = np.radians(30.0), 0.25
CONE_FEWEST, CONE_ROUND, CONE_OFFSET = 8, 0.5, 0.3
# Of the numbers of branches seen by the samples of a place: branches are rather missed
# than seen twice.
SEEN = 0.8
NUM_HYPOTHESES = 24
NUM_DIRECTIONS = 32
BLOCK = 2_000_000  # numbers in the largest array of a block


class Place(NamedTuple):
    """A place where the samples are no K-manifold.

    Attributes
    ----------
    kind : str
        "crossing", "lower dimension" or "higher dimension".
    samples : ndarray of int32
        Samples where it shows, ascending.
    center : ndarray, shape (D,), float64, or None
        The one of them nearest to their mean; None where only products are known.
    dim : int
        Dimension of the part; K for a crossing.
    branches : int
        Crossing: how many half sheets meet along a common face, 4 where two sheets pass
        through each other, 3 where one ends on another; 0 where what meets has only a
        point, or a face of lower dimension, in common.
    """

    kind: str
    samples: NDArray[np.int32]
    center: NDArray[np.float64] | None
    dim: int
    branches: int


@dataclass(frozen=True, eq=False)
class Singularities(ReadOnlyArrays):
    """Where samples are no K-manifold.

    Attributes
    ----------
    dim : int
        K.
    kind : ndarray, shape (N,), int8
        0 for regular samples, 1 at crossings and branchings, 2 and 3 in parts of lower
        and of higher dimension.
    places : tuple of Place
        Sets of such samples near each other, by their lowest sample.
    verdict : str
        One sentence.
    """

    dim: int
    kind: NDArray[np.int8] = field(repr=False)
    places: tuple[Place, ...] = field(repr=False)
    verdict: str


class _Scales(NamedTuple):
    """Numbers of neighbors, and what goes with them, by dimension."""

    plane: int  # of the small fits
    spacing: int
    wide: int  # of the fit that makes a sample suspicious
    nested: tuple[int, ...]  # of a solid
    branches: int  # in which branches are counted
    reach: float  # the same in spacings
    fewest: int  # samples of a branch
    steps: tuple[float, ...]  # spacings between which each branch has samples
    start: float  # spacings from which on its planes are fitted well
    miss: float  # spacings by which a plane that passes through a sample may miss it


def _scales(dim: int, num_neighbors: int | None) -> _Scales:
    plane = (dim + 1) ** 2
    nested: tuple[int, ...]
    steps: tuple[float, ...]
    if dim == 1:
        nested, steps = (6, 12, 24, 48, 96), (0.5, 8.0, 16.0)
        scales = _Scales(plane, 12, 12, nested, 48, 20.0, 5, steps, 12.0, 1.0)
    elif dim == 2:
        scales = _Scales(
            plane,
            9,
            40,
            (9, 18, 36, 60, 100),
            200,
            6.5,
            5,
            (0.5, 1.7, 3.0, 4.5),
            4.0,
            0.5,
        )
    else:
        nested = tuple(plane * 2**i for i in range(5))
        steps = (0.5, 1.7, 3.0)
        scales = _Scales(plane, plane, 4 * plane, nested, 300, 4.5, 6, steps, 3.5, 0.5)
    return scales if num_neighbors is None else scales._replace(branches=num_neighbors)


class Neighbors(NamedTuple):
    """Neighborhoods that somebody has found already."""

    samples: NDArray[np.int32]  # whose they are
    near: NDArray[np.int32]  # places among these, nearest first


class _Samples(NamedTuple):
    """Samples with their neighborhoods."""

    points: Floats
    dim: int
    near: NDArray[np.int32]  # neighbors
    num_spaced: int  # neighbors that a spacing spans
    spread_out: Floats  # the distance that they span in units of the spacing
    spreads: dict[int, Floats]  # of neighborhoods by size, (N, K+1) each

    def distances(self, rows: Any, rank: int) -> Floats:
        """From some samples to their neighbors of one rank, from 0."""
        apart = self.points[self.near[rows, rank]] - self.points[rows]
        return np.asarray(np.linalg.norm(apart, axis=-1))

    def spacing(self, rows: Integers) -> Floats:
        """Around some samples: the median over near neighbors."""
        return np.asarray(
            np.median(self.spread_out[self.near[rows, : self.num_spaced]], axis=1)
        )


class _Planes(NamedTuple):
    """Planes of some samples, fitted to few neighbors."""

    place: Integers  # (N,): row of each sample below
    centers: Floats  # a point of each plane
    bases: Floats  # (n, K, D)
    clean: Bools  # planes that count


def find_singularities(
    points: ArrayLike | None = None,
    dim: int | None = None,
    *,
    gram: ArrayLike | None = None,
    distances: ArrayLike | None = None,
    num_neighbors: int | None = None,
    num_threads: int | None = None,
) -> Singularities:
    """Find where samples are no K-manifold.

    Parameters
    ----------
    points : array_like, shape (N, D)
        Samples; complex samples count as real ones of dimension 2 D.
    dim : int
        K, the dimension that the manifold should have.
    gram, distances : array_like, shape (N, N), optional
        Inner products or distances of the samples, instead of `points`. They are turned
        into coordinates, in time N^3.
    num_neighbors : int, optional
        Neighbors of a suspicious sample among which branches are counted: by default 48
        for curves, 200 for surfaces, 300 otherwise.
    num_threads : int, optional
        Of the search for neighbors; all cores by default. The result does not depend on
        it.

    Returns
    -------
    Singularities
        ``kind`` (N,) int8, ``places`` and ``verdict``.

    Raises
    ------
    ValueError, TypeError
        As for `reconstruct`.

    Notes
    -----
    A sample is suspicious where a quadric fits its neighborhood badly. There the planes
    of samples a few spacings away are gathered, each fitted to few neighbors, of which
    only those that pass through the sample count: sheets beside it do not. Two of them
    that differ meet in a face; where three half sheets or more leave it, the sample is
    a branching, and so it is where two planes surround it each, or where the planes
    form two closed cones. An edge, a corner or a boundary has two, or one. A part is
    of lower dimension where neighborhoods of two sizes are flat in fewer directions,
    of higher dimension where neighborhoods of all sizes are round in more and nothing
    but such neighborhoods is near.

    What is faint is missed on purpose: crossings below 30 degrees, sheets sampled at
    fewer than some six spacings from the crossing, solids of fewer than a few
    hundred samples.

    References
    ----------
    Aamari, Levrard, *Nonasymptotic rates for manifold, tangent space and curvature
    estimation*, Annals of Statistics 47(1), 2019. Stolz, Tanner, Harrington, Nanda,
    *Geometric anomaly detection in data*, PNAS 117(33), 2020: anomalies by the homology
    of the shell around a sample.

    Examples
    --------
    >>> import remanifold as rm
    >>> curve = rm.datasets.figure_eight(400, random_state=0)
    >>> found = rm.find_singularities(curve, 1)
    >>> [place.kind for place in found.places]
    ['crossing']
    """
    samples = check_samples(points, gram, distances)
    k = check_dim(dim, samples)
    if num_neighbors is not None:
        num_neighbors = check_int(
            num_neighbors, "num_neighbors", minimum=k + 1, hint=f" (dim + 1 = {k + 1})"
        )
    if not isinstance(samples, Points):  # symmetry and signs are the core's to check
        neighborhoods(num_neighbors=1, gram=gram, distances=distances)
    return singularities_of(
        samples, k, num_neighbors, check_num_threads(num_threads) or None
    )


def neighbors_wanted(dim: int) -> int:
    """Neighbors of every sample that are looked at."""
    scales = _scales(dim, None)
    return max(scales.wide, scales.nested[1], 2 * scales.plane, scales.spacing)


def places_among(samples: Input, k: int, known: Neighbors) -> Singularities:
    """Where samples of which at least `neighbors_wanted` are known are no manifold.

    The ``kind`` of the result goes by their places among the known.
    """
    found = singularities_of(samples.subset(known.samples), k, near=known.near)
    places = [
        place._replace(samples=np.sort(known.samples[place.samples]))
        for place in found.places
    ]
    places.sort(key=lambda place: int(place.samples[0]))
    return Singularities(k, found.kind, tuple(places), verdict_on(k, places))


def singularities_of(
    samples: Input,
    k: int,
    num_neighbors: int | None = None,
    threads: int | None = None,
    near: NDArray[np.int32] | None = None,
) -> Singularities:
    """The same for samples that were checked, and whose neighbors may be known."""
    coordinates = _coordinates(samples)
    scales = _scales(k, num_neighbors)
    kind = np.zeros(len(coordinates), dtype=np.int8)
    if near is None:
        near, _ = neighborhoods(coordinates, neighbors_wanted(k), num_threads=threads)
    fitted = _fit(coordinates, near, k, scales, threads)
    places: list[Place] = []
    if fitted is not None:
        lower = _lower(fitted, scales, threads)
        higher = _higher(fitted, scales, threads)
        branches = _branches(fitted, scales, threads)
        places = _places(fitted, lower, higher, branches, kind)
    if isinstance(samples, Points):
        places = [
            place._replace(center=_middle(samples.matrix[place.samples]))
            for place in places
        ]
    for place in places:
        for array in (place.samples, place.center):
            if array is not None:
                array.flags.writeable = False
    return Singularities(k, kind, tuple(places), verdict_on(k, places))


def _middle(points: Floats) -> Floats:
    """The point nearest to the mean: places may be rings."""
    distances = np.linalg.norm(points - points.mean(axis=0), axis=1)
    return np.array(points[int(distances.argmin())])


def _coordinates(samples: Input) -> Floats:
    """Coordinates of order one, about their mean."""
    scaled = samples.of(samples.matrix / samples.scale)
    if isinstance(scaled, Points):
        return np.ascontiguousarray(scaled.matrix - scaled.matrix.mean(axis=0))
    return classical_scaling(scaled).coordinates


def _blocks(count: int, size: int) -> list[slice]:
    """Slices of so many rows that rows of this size fit a block."""
    step = max(1, BLOCK // max(size, 1))
    return [slice(start, start + step) for start in range(0, count, step)]


def _differences(points: Floats, own: Any, near: NDArray[Any]) -> tuple[Floats, Floats]:
    """Samples and their neighbors around their mean, and the mean."""
    cloud = np.concatenate([points[own][:, None], points[near]], axis=1)
    mean = cloud.mean(axis=1)
    cloud -= mean[:, None]
    return cloud, mean


def _principal(cloud: Floats) -> tuple[Floats, Floats]:
    """Variances along principal directions, largest first, and the coordinates."""
    size, ambient = cloud.shape[1:]
    if ambient <= size:
        values, vectors = np.linalg.eigh(cloud.transpose(0, 2, 1) @ cloud / size)
        values = np.maximum(values[:, ::-1], 0.0)
        return values, cloud @ vectors[:, :, ::-1]
    values, vectors = np.linalg.eigh(cloud @ cloud.transpose(0, 2, 1) / size)
    values = np.maximum(values[:, ::-1], 0.0)
    return values, vectors[:, :, ::-1] * np.sqrt(values * size)[:, None]


def _spreads(
    points: Floats,
    rows: Integers,
    near: NDArray[np.int32],
    sizes: list[int],
    dim: int,
    threads: int | None,
) -> Floats:
    """K+1 standard deviations along principal directions, for each row and size."""
    return _core.local_spreads(
        points,
        rows.astype(np.int32),
        np.ascontiguousarray(near),
        sizes,
        dim + 1,
        threads or 0,
    )


def _unfit(
    points: Floats, own: Integers, near: NDArray[np.int32], size: int, dim: int
) -> Floats:
    """Spread off the best quadric over the K-th spread."""
    first, second = np.triu_indices(dim)
    unknowns = 1 + dim + len(first)
    result = np.empty(len(own))
    for block in _blocks(len(own), (size + 1) * max(points.shape[1], unknowns)):
        cloud, _ = _differences(points, own[block], near[block, :size])
        values, coordinates = _principal(cloud)
        tangent = coordinates[:, :, :dim] / _positive(np.sqrt(values[:, :1]))[:, None]
        normal = coordinates[:, :, dim : dim + 1]
        squares = tangent[:, :, first] * tangent[:, :, second]
        ones = np.ones((*tangent.shape[:2], 1))
        basis = np.linalg.qr(np.concatenate([ones, tangent, squares], axis=2))[0]
        rest = normal - basis @ (basis.transpose(0, 2, 1) @ normal)
        variance = (rest**2).sum(axis=(1, 2)) / max(size + 1 - unknowns, 1)
        result[block] = np.sqrt(variance / _positive(values[:, dim - 1]))
    return result


def _positive(values: Floats) -> Floats:
    return np.maximum(values, np.finfo(float).tiny)


def _fit(
    points: Floats,
    near: NDArray[np.int32],
    dim: int,
    scales: _Scales,
    threads: int | None,
) -> _Samples | None:
    """What the neighborhoods of all samples tell; None where there are too few for any."""
    if near.shape[1] < max(2 * scales.plane, scales.spacing):
        return None
    asked = {scales.plane, 2 * scales.plane, *scales.nested[:2], scales.wide}
    sizes = sorted({min(size, near.shape[1]) for size in asked})
    spreads = _spreads(points, np.arange(len(points)), near, sizes, dim, threads)
    by_size = {size: spreads[:, i] for i, size in enumerate(sizes)}
    samples = _Samples(points, dim, near, scales.spacing, np.empty(0), by_size)
    volume = pi ** (dim / 2) / gamma(dim / 2 + 1)
    spanned = samples.distances(np.arange(len(points)), scales.spacing - 1)
    unit = (volume / scales.spacing) ** (1 / dim)
    return samples._replace(spread_out=spanned * unit)


def _planes(samples: _Samples, scales: _Scales, own: Integers) -> _Planes:
    """Planes of these samples."""
    points, dim, size = samples.points, samples.dim, scales.plane
    ambient = points.shape[1]
    centers = np.empty((len(own), ambient))
    bases = np.empty((len(own), dim, ambient))
    for block in _blocks(len(own), (size + 1) * max(ambient, size)):
        rows = own[block]
        cloud, centers[block] = _differences(points, rows, samples.near[rows, :size])
        values, coordinates = _principal(cloud)
        # Directions from coordinates: free of D x D matrices.
        # Collinear samples have none but the first; what rounding says is as good.
        known = np.maximum(values[:, None, :dim], 1e-30 * values[:, None, :1])
        scaled = coordinates[:, :, :dim] / _positive(known)
        vectors = scaled.transpose(0, 2, 1) @ cloud
        lengths = np.linalg.norm(vectors, axis=2, keepdims=True)
        bases[block] = vectors / _positive(lengths)
    spread = samples.spreads[size][own]
    clean = (spread[:, dim] <= CLEAN * spread[:, dim - 1]) & (
        spread[:, dim - 1] >= ROUND * spread[:, 0]
    )
    place = np.full(len(points), -1)
    place[own] = np.arange(len(own))
    return _Planes(place, centers, bases, clean)


# ------------------------------------------------------------- other dimensions

THIN = 0.2  # K-th spread over the first in a part of lower dimension
# Samples on a curve are in a bend where the second spread is no more than this of the
# first. Edges and tips of surfaces are sampled like that: only this share of all counts.
BENT, BENT_SHARE = 0.6, 0.1
SOLID = 0.5  # (K+1)-th spread over the K-th in a solid, and the same off a quadric
COMPACT = 0.6  # (K+1)-th spread over the first in the inner part of a solid
SURROUNDED = 0.95  # share of neighbors in the solid there
GROWTH = 0.5  # dimension above K by which the number of neighbors grows


def _lower(samples: _Samples, scales: _Scales, threads: int | None) -> NDArray[np.int8]:
    """Dimension of the part of lower dimension that a sample is in, or -1."""
    dim, count = samples.dim, len(samples.points)
    result = np.full(count, -1, dtype=np.int8)
    if dim == 1:
        return result
    rows = np.arange(count)
    for size in (scales.plane, 2 * scales.plane):
        spread = samples.spreads[size][rows]
        thin = spread[:, dim - 1] <= THIN * spread[:, 0]
        rows, spread = rows[thin], spread[thin]
    result[rows] = (spread[:, :dim] > THIN * spread[:, :1]).sum(axis=1)
    spread = samples.spreads[scales.plane]
    bent = np.flatnonzero((result < 0) & (spread[:, 1] <= BENT * spread[:, 0]))
    bent = bent[
        _core.lie_on_curve(
            samples.points, bent.astype(np.int32), samples.near[bent], threads or 0
        )
    ]
    if len(bent) >= BENT_SHARE * count:
        result[bent] = 1
    return result


def _higher(
    samples: _Samples, scales: _Scales, threads: int | None
) -> tuple[Bools, Bools]:
    """Samples in a part of higher dimension, and those deep in it."""
    points, dim = samples.points, samples.dim
    solid = np.zeros(len(points), dtype=np.bool_)
    deep = solid.copy()
    rows = np.arange(len(points))
    if points.shape[1] == dim or len(points) < 4 * scales.nested[-1]:
        return solid, deep
    compact = np.ones(len(points), dtype=np.bool_)
    near: NDArray[np.int32] = samples.near
    first = scales.nested[0]
    dense = np.zeros(len(points))
    for size in scales.nested[1:]:
        if size > samples.near.shape[1] and len(rows):
            near, distances = _wide(samples, rows, size, threads)
            if near.shape[1] < size:
                return solid, deep
            dense[rows] = np.log(size / first) / np.log(
                distances[:, -1] / samples.distances(rows, first - 1)
            )
        else:
            near = samples.near[rows]
        spread = (
            samples.spreads[size][rows]
            if size in samples.spreads
            else _spreads(points, rows, near, [size], dim, threads)[:, 0]
        )
        keep = spread[:, dim] >= SOLID * spread[:, dim - 1]
        rows, near, spread = rows[keep], near[keep], spread[keep]
        keep = _unfit(points, rows, near, size, dim) >= SOLID
        rows, spread = rows[keep], spread[keep]
        if size >= scales.nested[-2]:
            compact[rows] &= spread[:, dim] >= COMPACT * spread[:, 0]
    solid[rows] = True
    if len(rows) == 0:
        return solid, deep
    near, _ = _wide(samples, rows, scales.nested[-2], threads)
    spread = samples.spreads[first][rows]
    small = np.zeros(len(points))
    small[rows] = spread[:, dim] / _positive(spread[:, dim - 1])
    around = solid[near[:, : scales.nested[-2]]].mean(axis=1)
    # At the smallest scale single samples tell little; their neighbors do.
    usual = np.median(small[near[:, : scales.nested[-3]]], axis=1)
    inner = compact[rows] & (around >= SURROUNDED) & (usual >= SOLID)
    growth = np.zeros(len(points))
    growth[rows] = dense[rows]
    usual = np.median(growth[near[:, : scales.nested[-3]]], axis=1)
    deep[rows[inner & (usual >= dim + GROWTH)]] = True
    return solid, deep


def _wide(
    samples: _Samples, rows: Integers, size: int, threads: int | None
) -> tuple[NDArray[np.int32], Floats]:
    """More neighbors of few samples, among those within two steps of any of them."""
    close = np.zeros(len(samples.points), dtype=np.bool_)
    close[rows] = True
    close[samples.near[rows]] = True
    close[samples.near[close]] = True
    pool = np.flatnonzero(close)
    place = np.zeros(len(close), dtype=np.int64)
    place[pool] = np.arange(len(pool))
    near, distances = neighborhoods(samples.points[pool], size, num_threads=threads)
    own = place[rows]
    return pool[near[own]].astype(np.int32), distances[own]


# -------------------------------------------------------------------- branches


def _branches(
    samples: _Samples, scales: _Scales, threads: int | None
) -> NDArray[np.int8]:
    """Number of branches at crossings, 0 where they meet in less than a face, or -1."""
    points, dim = samples.points, samples.dim
    result = np.full(len(points), -1, dtype=np.int8)
    if points.shape[1] == dim:
        return result
    rows = np.arange(len(points))
    size = min(scales.wide, samples.near.shape[1])
    spread = samples.spreads[size]
    rows = rows[spread[:, dim] >= SUSPICIOUS * spread[:, dim - 1]]
    unfit = _unfit(points, rows, samples.near[rows], size, dim)
    rows = rows[unfit >= UNFIT]
    if len(rows) == 0:
        return result
    near, distances = _wide(samples, rows, scales.branches, threads)
    planes = _planes(samples, scales, np.unique(near))
    for block in _blocks(len(rows), near.shape[1] * dim * points.shape[1] * 4):
        result[rows[block]] = _count(
            samples, planes, scales, rows[block], near[block], distances[block]
        )
    return result


def _count(
    samples: _Samples,
    fitted: _Planes,
    scales: _Scales,
    rows: Integers,
    near: NDArray[np.int32],
    distances: Floats,
) -> NDArray[np.int8]:
    """`_branches` of a block of suspicious samples."""
    dim = samples.dim
    result = np.full(len(rows), -1, dtype=np.int8)
    spacing = samples.spacing(rows)[:, None]
    counts = fitted.clean[fitted.place[near]] & (distances >= INNER * spacing)
    counts &= distances <= scales.reach * spacing
    keep = np.flatnonzero(counts.sum(axis=1) >= 2 * scales.fewest)
    near, distances, spacing = near[keep], distances[keep], spacing[keep]
    counts = counts[keep]

    # Planes that pass through the sample.
    here = samples.points[rows[keep]][:, None]
    bases = fitted.bases[fitted.place[near]]
    offset = fitted.centers[fitted.place[near]] - here
    along = np.einsum("nmkd,nmd->nmk", bases, offset)
    squared = np.einsum("nmd,nmd->nm", offset, offset)
    missed = np.sqrt(np.maximum(squared - (along**2).sum(axis=2), 0.0))
    passing = counts & (missed <= scales.miss * spacing + SLOPE * distances)

    some = passing.sum(axis=1) >= 2 * scales.fewest
    keep, near, distances = keep[some], near[some], distances[some]
    spacing, bases, along = spacing[some], bases[some], along[some]
    counts, passing = counts[some], passing[some]
    if len(keep) == 0:
        return result
    each = np.arange(len(keep))

    # The plane that most agree with, and the one of most of those that differ from it.
    chosen = _evenly(passing, NUM_HYPOTHESES)
    hypotheses = np.take_along_axis(bases, chosen[:, :, None, None], axis=1)
    apart = _disagreement(hypotheses, bases)
    alike = apart <= np.sin(FLAT) ** 2
    support = (alike & passing[:, None]).sum(axis=2)
    first = support.argmax(axis=1)
    differs = apart[each, first] > np.sin(APART) ** 2
    others = passing & differs
    other_support = (alike & others[:, None]).sum(axis=2)
    other_support *= np.take_along_axis(differs, chosen, axis=1)
    second = other_support.argmax(axis=1)
    total = passing.sum(axis=1)

    if dim > 1:
        for share in TIP_REACHES:
            inside = distances <= share * scales.reach * spacing
            held, all_held = passing & inside, counts & inside
            tip = held.sum(axis=1) >= np.maximum(
                TIP_PASSING * all_held.sum(axis=1), TIP_FEWEST
            )
            most_alike = (alike[each, first] & held).sum(axis=1)
            tip &= most_alike <= TIP_ALIKE * held.sum(axis=1)
            for i in np.flatnonzero(tip & (result[keep] < 0)):
                if _is_cone(bases[i, held[i]], along[i, held[i]]):
                    result[keep[i]] = 0

    two = other_support[each, second] >= scales.fewest
    two &= support[each, first] >= scales.fewest
    two &= total >= 3 * scales.fewest - 1
    keep, each = keep[two], each[two]
    near, distances, spacing = near[two], distances[two], spacing[two]
    bases, passing = bases[two], passing[two]
    first, second = first[two], second[two]
    planes = hypotheses[each, first], hypotheses[each, second]
    members = (
        passing & alike[each, first],
        others[two] & alike[each, second],
    )
    difference = samples.points[near] - samples.points[rows[keep]][:, None]
    surrounded = np.full(len(keep), dim > 1)
    for plane, member in zip(planes, members, strict=True):
        surrounded &= _surround(difference @ plane.transpose(0, 2, 1), member)
    result[keep[surrounded]] = 0

    # Where all but one direction of two planes agree, these span their common face.
    left, cosines, right = np.linalg.svd(planes[0] @ planes[1].transpose(0, 2, 1))
    flat = np.flatnonzero((cosines >= np.cos(FLAT)).sum(axis=1) == dim - 1)
    if len(flat):
        face = left[flat].transpose(0, 2, 1) @ planes[0][flat]
        face = (face + right[flat] @ planes[1][flat])[:, : dim - 1]
        if dim > 1:
            face = np.linalg.qr(face.transpose(0, 2, 1))[0].transpose(0, 2, 1)
        found = _half_sheets(
            scales,
            difference[flat],
            bases[flat],
            passing[flat],
            face,
            distances[flat],
            spacing[flat],
        )
        result[keep[flat]] = np.where(found >= 3, found, result[keep[flat]])
    return result


def _evenly(mask: Bools, count: int) -> Integers:
    """Columns of the marked entries of each row, evenly over them."""
    order = np.argsort(~mask, axis=1, kind="stable")
    steps = (np.arange(count) + 0.5) / count * mask.sum(axis=1)[:, None]
    return np.take_along_axis(order, steps.astype(np.int64), axis=1)


def _disagreement(planes: Floats, bases: Floats) -> Floats:
    """Sum of squared sines of the angles between planes, (n, h, K, D), and bases."""
    blocks, dim, ambient = bases.shape[0], *bases.shape[2:]
    if ambient <= 4 * dim:
        # The product of projections has the squared cosines for its trace.
        projections = [
            np.einsum("nmkd,nmke->nmde", b, b).reshape(blocks, -1, ambient**2)
            for b in (planes, bases)
        ]
        return np.asarray(dim - projections[0] @ projections[1].transpose(0, 2, 1))
    flat = [b.reshape(blocks, -1, ambient) for b in (planes, bases)]
    cosines = (flat[0] @ flat[1].transpose(0, 2, 1)).reshape(
        blocks, planes.shape[1], dim, bases.shape[1], dim
    )
    return np.asarray(dim - np.einsum("nhkml,nhkml->nhm", cosines, cosines))


def _surround(vectors: Floats, members: Bools) -> Bools:
    """Whether members lie in all directions around the origin."""
    dim = vectors.shape[2]
    probes = np.concatenate([np.eye(dim), -np.eye(dim)])
    if dim > 1:
        axes = min(dim, DIAGONALS)
        signs = np.indices((2,) * axes).reshape(axes, -1).T * 2.0 - 1.0
        diagonals = np.pad(signs, ((0, 0), (0, dim - signs.shape[1])))
        probes = np.concatenate([probes, diagonals / np.sqrt(signs.shape[1])])
    lengths = np.linalg.norm(vectors, axis=2, keepdims=True)
    cosines = (vectors / _positive(lengths)) @ probes.T
    hits = ((cosines >= TOWARDS) & members[:, :, None]).sum(axis=1)
    return np.asarray((hits >= (HITS_ON_A_LINE if dim == 1 else HITS)).all(axis=1))


def _half_sheets(
    scales: _Scales,
    difference: Floats,
    bases: Floats,
    passing: Bools,
    face: Floats,
    distances: Floats,
    spacing: Floats,
) -> Integers:
    """Number of half sheets that leave a common face, (n, K-1, D), of samples."""
    dim = bases.shape[2]
    each = np.arange(len(face))
    on_face = difference @ face.transpose(0, 2, 1)
    off_face = difference - on_face @ face
    length = np.linalg.norm(off_face, axis=2)
    holds = (bases @ face.transpose(0, 2, 1)[:, None]) ** 2
    # Directions of the branches, in the planes of their samples.
    inside = np.einsum("nmkd,nmd->nmk", bases, off_face)
    ways = np.einsum("nmk,nmkd->nmd", inside, bases)
    ways -= (ways @ face.transpose(0, 2, 1)) @ face
    way_length = np.linalg.norm(ways, axis=2)
    ways /= _positive(way_length)[:, :, None]
    left = passing & (length >= INNER * spacing)
    left &= way_length >= np.cos(APART) * length
    left &= holds.sum(axis=(2, 3)) >= dim - 1 - np.sin(FLAT) ** 2
    chosen = _evenly(left, NUM_DIRECTIONS)
    directions = np.take_along_axis(ways, chosen[:, :, None], axis=1)
    cosines = directions @ ways.transpose(0, 2, 1)
    count = np.zeros(len(face), dtype=np.int64)
    explained = np.zeros(left.shape, dtype=np.bool_)
    for _ in range(MOST_BRANCHES):
        close = (cosines >= np.cos(NARROW)) & left[:, None]
        support = close.sum(axis=2) * np.take_along_axis(left, chosen, axis=1)
        best = support.argmax(axis=1)
        members = close[each, best]
        number = support[each, best]
        good = number >= scales.fewest
        # Far sheets that merely point here have no planes near here.
        good &= (members & (length <= scales.start * spacing)).sum(axis=1) >= 2
        weights = members / np.maximum(number, 1)[:, None]
        # The sample is not at an end of the face.
        mean = np.einsum("nm,nmk->nk", weights, on_face)
        square = np.einsum("nm,nmk->nk", weights, on_face**2)
        good &= (mean**2 <= ASKEW * square).all(axis=1)
        # The branch has samples from here on.
        way = np.einsum("nm,nmd->nd", weights, ways)
        way /= _positive(np.linalg.norm(way, axis=1, keepdims=True))
        ahead = np.einsum("nmd,nd->nm", off_face, way)
        aside = np.sqrt(np.maximum(length**2 - ahead**2, 0.0))
        on_branch = aside <= scales.miss * spacing + SLOPE * distances
        for low, high in zip(scales.steps[:-1], scales.steps[1:], strict=True):
            there = (ahead >= low * spacing) & (ahead < high * spacing)
            good &= (on_branch & there).any(axis=1)
        count += good
        explained |= on_branch & (ahead >= 0.0) & good[:, None]
        left &= cosines[each, best] < np.cos(CLAIMED * NARROW)
    for radius in scales.steps[1:]:
        inside = distances <= radius * spacing
        needed = EXPLAINED * inside.sum(axis=1)
        count[(explained & inside).sum(axis=1) < needed] = 0
    return count


def _is_cone(bases: Floats, along: Floats) -> bool:
    """Whether planes through a point, (m, K, D), are those of two closed cones."""
    vectors = np.einsum("mk,mkd->md", along, bases)
    vectors /= _positive(np.linalg.norm(vectors, axis=1, keepdims=True))
    apart = _disagreement(bases[None], bases[None])[0]
    joined = (vectors @ vectors.T >= np.cos(CONE_STEP)) & (apart <= CONE_APART)
    closed = 0
    dim = bases.shape[1]
    for members in _connected(np.argwhere(joined), len(vectors)):
        piece = vectors[members]
        if len(piece) < CONE_FEWEST:
            continue
        mean = piece.mean(axis=0)
        values, directions = np.linalg.eigh((piece - mean).T @ (piece - mean))
        if values[-dim] < CONE_ROUND * values[-1]:
            continue
        if np.linalg.norm(mean) >= CONE_OFFSET:  # a cone; else a plane
            piece = piece - mean
        inside = (piece @ directions[:, -dim:])[None]
        closed += bool(_surround(inside, np.ones((1, len(piece)), dtype=np.bool_))[0])
    return closed >= 2


# ---------------------------------------------------------------------- places

FEWEST_CROSSING = 2  # samples of a place; of curves few are near it, and one will do
FEWEST_LOWER = 10
FEWEST_DEEP = 20
DEEP_SHARE = 0.1  # of a solid


def _places(
    samples: _Samples,
    lower: NDArray[np.int8],
    higher: tuple[Bools, Bools],
    branches: NDArray[np.int8],
    kind: NDArray[np.int8],
) -> list[Place]:
    """Sets of samples that agree; marks them in `kind`."""
    dim = samples.dim
    found: list[Place] = []
    solid, deep = higher
    close = samples.near
    # Parts of higher dimension end where a part that is deep inside is no more.
    for members in _groups(solid, close):
        inner = np.count_nonzero(deep[members])
        if inner >= max(FEWEST_DEEP, DEEP_SHARE * len(members)):
            kind[members] = HIGHER
            found.append(Place(KINDS[HIGHER], members, None, dim + 1, 0))
    for members in _groups((lower >= 0) & (kind == REGULAR), close):
        if len(members) >= FEWEST_LOWER:
            kind[members] = LOWER
            part = int(np.median(lower[members]))
            found.append(Place(KINDS[LOWER], members, None, part, 0))
    for members in _groups((branches >= 0) & (kind == REGULAR), close):
        if len(members) >= min(FEWEST_CROSSING, dim):
            kind[members] = CROSSING
            # Planes alone say nothing of branches.
            seen = branches[members]
            seen = seen[seen > 0] if (seen > 0).any() else seen
            number = int(np.quantile(seen, SEEN, method="nearest"))
            found.append(Place(KINDS[CROSSING], members, None, dim, number))
    return sorted(found, key=lambda place: int(place.samples[0]))


def _groups(marked: Bools, near: NDArray[np.int32]) -> list[NDArray[np.int32]]:
    """Sets of marked samples connected through neighborhoods."""
    rows = np.flatnonzero(marked)
    position = np.full(len(marked), len(rows))
    position[rows] = np.arange(len(rows))
    links = position[near[rows]]  # what is not marked points behind the last
    linked, columns = np.nonzero(links < len(rows))
    pairs = np.column_stack([linked, links[linked, columns]])
    return [rows[own].astype(np.int32) for own in _connected(pairs, len(rows))]


def _connected(pairs: NDArray[np.intp], count: int) -> list[NDArray[np.intp]]:
    """Sets connected by pairs, of all numbers below `count`, by their lowest member."""
    itself = np.arange(count)[:, None].repeat(2, axis=1)
    edges = np.concatenate([itself, pairs]).astype(np.int32)
    labels = _core.component_labels(edges, count)
    order = np.argsort(labels, kind="stable")
    return np.split(order, np.cumsum(np.bincount(labels))[:-1]) if count else []


def verdict_on(dim: int, places: list[Place]) -> str:
    """One sentence about the largest places."""
    if not places:
        return "no crossing, branching or part of another dimension found"
    largest = sorted(places, key=lambda place: -len(place.samples))
    parts = [_describe(place) for place in largest[:3]]
    if len(largest) > 3:
        parts.append(f"{len(largest) - 3} more places")
    return f"no {dim}-manifold: {'; '.join(parts)}"


def _describe(place: Place) -> str:
    if place.kind != KINDS[CROSSING]:
        what = f"a part of dimension {place.dim}"
    elif place.branches == 0:
        what = "sheets meet in a point or a thin face"
    elif place.branches == 3:
        what = "three half sheets meet"
    elif place.branches == 4:
        what = "two sheets cross"
    else:
        what = f"{place.branches} half sheets meet"
    number = len(place.samples)
    where = f"from sample {place.samples[0]} on"
    if place.center is not None and len(place.center) <= 3:
        where = f"around ({', '.join(f'{x:.3g}' for x in place.center)})"
    return f"{what} near {number} samples {where}"
