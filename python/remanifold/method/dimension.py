# SPDX-License-Identifier: GPL-3.0-or-later
"""Intrinsic dimension of the samples, from the scales at which it shows."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from remanifold import _core
from remanifold._base.progress import progress_callback
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.samples import Input, Points, looks_like_a_matrix
from remanifold._base.validation import (
    check_int,
    check_num_threads,
    check_samples,
)
from remanifold.method.options import CHECKS
from remanifold.warnings import DimensionWarning, MatrixWarning

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.progress import Callback

    Ints = NDArray[np.int64]
    Floats = NDArray[np.float64]

LOW_CONFIDENCE = 0.5

MIN_SAMPLES = 10
SMALLEST_SCALE, LARGEST_SCALE = 6, 1024  # neighbors; half an octave between scales
MAX_QUERIES = 256  # samples that the scales are compared at
MAX_PRODUCTS = 2**25  # distances from these to all samples
# Of a neighborhood, that enter its spectrum: beyond 64 LAPACK starts threads for each.
MAX_MEMBERS = 64
MAX_NEIGHBORS = 128  # per sample, where every sample is asked
MAX_POOLED = 16  # neighborhoods that decide together for one sample
BLOCK = 2**20  # numbers gathered at a time
CLEAR_DROP = 3.0  # of variance from the last tangent direction to the first normal one
BOUNDARY_DROP = 4.0  # what a boundary cannot cause
EVEN_DROP = 2.7  # what chance causes among directions that are alike
SHARP_DROP = 10.0  # a larger one is no clearer
ROUNDING = 1e-10  # of the largest variance: directions that the data do not have


@dataclass(frozen=True, eq=False)
class DimensionEstimate(ReadOnlyArrays):
    """Intrinsic dimension of samples, and how far it is to be trusted.

    Attributes
    ----------
    dim : int
        The answer.
    confidence : float
        Between 0 and 1, the product of three agreements. Of the samples: the share with
        this dimension in `per_sample`. Of the scales: the share of this dimension in what
        all scales show, small and clear ones counting more, against a little for those
        that show nothing. Of the two estimators from distances: with e the median over
        these scales of what the distances say beyond K, 1 / (1 + e / K), or
        1 / (1 + 2 e^2 / K) below K. It is 0 where no scale shows a dimension. It is no
        probability, and it cannot see what the samples do not tell: a sheet so noisy that
        it fills space is said to fill space.
    estimates : dict of str to float
        At the scale of `num_neighbors`: ``"local_pca"``, principal directions before the
        largest drop of variance; ``"maximum_likelihood"`` (Levina and Bickel; MacKay and
        Ghahramani) and ``"two_nn"``, from the distances (Facco et al., with neighbors m/2
        and m instead of 1 and 2 as in Denti et al.).
    num_neighbors : int
        Neighbors per sample at the scale that was decided at.
    per_sample : ndarray, shape (N,), int
        Dimension around each sample.
    per_sample_confidence : ndarray, shape (N,), float64
        Share of the neighborhoods around the sample that by themselves say the same.
    scales : ndarray, shape (S,), int
        Neighbors per sample at the scales that were looked at.
    dims : ndarray, shape (S,), int
        Dimension that each of them shows, 0 where none is clear.
    """

    dim: int
    confidence: float
    estimates: dict[str, float]
    num_neighbors: int
    per_sample: Ints
    per_sample_confidence: Floats
    scales: Ints
    dims: Ints

    @property
    def verdict(self) -> str:
        """One sentence on the dimension, and on what speaks against it."""
        others = self.estimates
        text = (
            f"dimension {self.dim}, confidence {self.confidence:.2f} "
            f"({self.num_neighbors} neighbors; maximum likelihood "
            f"{others['maximum_likelihood']:.2f}, TwoNN {others['two_nn']:.2f})"
        )
        doubts = self._doubts()
        return f"{text}: {'; '.join(doubts)}" if doubts else text

    def _doubts(self) -> list[str]:
        own = self.scales[self.dims == self.dim]
        if len(own) == 0:
            doubts = ["no scale shows a clear one, the distances are nearest to this"]
        elif own[0] >= 8 * (self.dim + 1):
            doubts = [f"below {own[0]} neighbors nothing is clear, as with noise"]
        else:
            doubts = []
        values, counts = np.unique(self.per_sample, return_counts=True)
        shares = counts / len(self.per_sample)
        if shares[values == self.dim].sum() < 0.95:
            parts = [
                f"{shares[i]:.0%} look {values[i]}-dimensional"
                for i in np.argsort(-shares, kind="stable")[:3]
            ]
            doubts.append(f"of the samples {', '.join(parts)}")
        other = (self.dims != self.dim) & (self.dims > 0)
        small = np.flatnonzero(other & (self.scales < self.num_neighbors))
        large = np.flatnonzero(other & (self.scales > self.num_neighbors))
        doubts += [
            f"at {self.scales[i]} neighbors it looks {self.dims[i]}-dimensional"
            for i in (*small[-1:], *large[:1])
        ]
        return doubts

    def __str__(self) -> str:
        return self.verdict

    def __repr__(self) -> str:
        return (
            f"DimensionEstimate(dim={self.dim}, confidence={self.confidence:.2f}, "
            f"samples={len(self.per_sample)})"
        )


def estimate_dimension(
    points: ArrayLike | None = None,
    *,
    gram: ArrayLike | None = None,
    distances: ArrayLike | None = None,
    num_neighbors: int | None = None,
    num_threads: int | None = None,
    progress: bool | Callback | None = None,
) -> DimensionEstimate:
    """Estimate the intrinsic dimension of samples, for all and for each.

    Noise makes small neighborhoods look as high as the space, curvature makes large ones
    look too high, and a long strip is a curve from afar. So the spectra of the local
    covariances are compared over all scales, at a fixed choice of samples (Little,
    Maggioni and Rosasco): the dimension is the number of directions before the largest
    drop of variance, at the scales where that drop is clear and the distances agree. At
    the clearest of these scales every sample is then asked. Nothing is random.

    Parameters
    ----------
    points : array_like, shape (N, D)
        At least ten different samples; complex samples count as real ones of dimension
        2 D.
    gram, distances : array_like, shape (N, N), optional
        Inner products or distances of the samples, instead of `points`.
    num_neighbors : int, optional
        The scale to decide at, as neighbors per sample; by default found from the data.
    num_threads : int, optional
        All cores by default. The result does not depend on it.
    progress : bool or callable, optional
        True for a bar, or a function of (step, done, total).

    Returns
    -------
    DimensionEstimate

    Raises
    ------
    ValueError
        Fewer than ten different samples, or samples that `reconstruct` refuses too.

    References
    ----------
    E. Levina and P. Bickel, Maximum Likelihood Estimation of Intrinsic Dimension, NIPS
    17, 2004; with the inverses averaged after D. MacKay and Z. Ghahramani, 2005.

    E. Facco, M. d'Errico, A. Rodriguez and A. Laio, Estimating the intrinsic dimension of
    datasets by a minimal neighborhood information, Scientific Reports 7, 2017.

    F. Denti, D. Doimo, A. Laio and A. Mira, The generalized ratios intrinsic dimension
    estimator, Scientific Reports 12, 2022.

    A. Little, M. Maggioni and L. Rosasco, Multiscale geometric methods for data sets I:
    Multiscale SVD, noise and curvature, Applied and Computational Harmonic Analysis 43,
    2017.

    Examples
    --------
    >>> import remanifold as rm
    >>> rm.estimate_dimension(rm.datasets.torus(1000, random_state=0)).dim
    2
    """
    samples = check_samples(points, gram, distances)
    if isinstance(samples, Points) and (said := looks_like_a_matrix(samples.matrix)):
        warnings.warn(said, MatrixWarning, stacklevel=2)
    scale = None
    if num_neighbors is not None:
        scale = check_int(num_neighbors, "num_neighbors", minimum=SMALLEST_SCALE)
    threads = check_num_threads(num_threads)
    with progress_callback(progress) as callback:
        return estimate(samples, scale, threads, callback)


def find_dimension(
    samples: Input, threads: int, progress: bool | Callback | None
) -> DimensionEstimate:
    """Find the dimension for ``dim="auto"``; warn where it is not to be trusted."""
    with progress_callback(progress) as callback:
        found = estimate(samples, None, threads, callback)
    if found.confidence < LOW_CONFIDENCE:
        warnings.warn(low_confidence(found), DimensionWarning, stacklevel=3)
    return found


def low_confidence(found: DimensionEstimate) -> str:
    """What to say of an estimate that is not to be trusted."""
    return f"the dimension is uncertain, give it if it is known: {found.verdict}"


def other_dimension(dim: int, fitting: int) -> str:
    """What to say where another dimension than K fits at all scales."""
    if fitting < dim:
        return (
            f"neighborhoods of all sizes spread in {fitting} directions, dim={dim} does "
            f"not fit: dim={fitting} may"
        )
    return (
        f"neighborhoods of all sizes fill about {fitting} dimensions, dim={dim} does not "
        f"fit: dim={fitting} may, unless noise drowns the shape"
    )


def estimate(
    samples: Input, scale: int | None, threads: int, callback: Callback | None
) -> DimensionEstimate:
    """Estimate the dimension of samples that are checked already."""
    if not isinstance(samples, Points):  # what only the core checks comes first
        _nearest_of_all(samples, 1, threads, callback)
    data, copies = _distinct(samples)
    count = len(data)
    if count < MIN_SAMPLES:
        msg = (
            f"{samples.kind} has {count} different sample{'' if count == 1 else 's'}; "
            f"an estimate of the dimension needs at least {MIN_SAMPLES}"
        )
        raise ValueError(msg)
    run = _Blocks(threads, callback)
    scales = _scales(count, scale)
    looks, rank = _look_at_scales(data, scales, run)
    dims = np.array([look.dim for look in looks])
    support = np.array(
        [look.support(m) for look, m in zip(looks, scales.tolist(), strict=True)]
    )
    clarity = np.array([look.clarity for look in looks])
    chosen = _choose(dims, support, clarity, scales)
    if chosen is None:
        # What is nearest to the distances, at a scale of some tens of neighbors.
        chosen = int(np.argmin(np.abs(scales - 32)))
        dim = int(np.clip(np.rint(looks[chosen].by_distance), 1, rank))
        share = 0.0
    else:
        dim = int(dims[chosen])
        share = _share(scales, dims, support, dim)
    neighbors = int(scales[chosen])
    if scale is None:
        neighbors = min(neighbors, MAX_NEIGHBORS)
    around = _ask_every_sample(data, neighbors, dim, rank, share > 0, run)
    estimates = {
        "local_pca": around.local_pca,
        "maximum_likelihood": around.maximum_likelihood,
        "two_nn": around.two_nn,
    }
    by_distance = [look.by_distance for look in looks if look.dim == dim]
    per_sample = around.dims[copies]
    return DimensionEstimate(
        dim=dim,
        confidence=(
            share
            * float(np.mean(per_sample == dim))
            * _agreement(float(np.median(by_distance or [dim])), dim)
        ),
        estimates=estimates,
        num_neighbors=neighbors,
        per_sample=per_sample,
        per_sample_confidence=around.confidences[copies],
        scales=scales,
        dims=dims,
    )


# ------------------------------------------------------------------- the samples


def _nearest_of_all(
    samples: Input, count: int, threads: int, callback: Callback | None
) -> tuple[NDArray[np.int32], Floats]:
    """Nearest other samples of each, and the distances."""
    indices, distances, _, _ = _core.neighborhoods(
        samples,
        num_neighbors=count,
        search="auto",
        checks=CHECKS,
        num_threads=threads,
        progress=callback,
    )
    return indices, distances


def _distinct(samples: Input) -> tuple[Input, Ints]:
    """Scale to unit size and leave copies out; also the place of every sample."""
    kept, copies = np.unique(samples.first_copies(), return_inverse=True)
    data = samples.of(samples.matrix / samples.scale)
    if len(kept) < len(samples):
        data = data.subset(kept)
    if isinstance(data, Points):
        data = data.of(data.matrix - data.matrix.mean(axis=0))
    return data, copies.ravel()


def _nearest(data: Input, queries: Ints, count: int) -> tuple[Ints, Floats]:
    """Nearest other samples of some samples, and the distances."""
    far = data.squares_from(queries)
    far[np.arange(len(queries)), queries] = np.inf
    near = np.argpartition(far, count - 1, axis=1)[:, :count]
    near.sort(axis=1)  # ties by index
    far = np.take_along_axis(far, near, axis=1)
    if data.cancels:  # and logarithms are to be taken
        for row, query, own in zip(far, queries, near, strict=True):
            row[:] = data.squared_distances(query, own)
    order = np.argsort(far, axis=1, kind="stable")
    near = np.take_along_axis(near, order, axis=1)
    far = np.take_along_axis(far, order, axis=1)
    return near, np.sqrt(np.maximum(far, np.finfo(float).tiny))


def _log_spectra(data: Input, members: NDArray[np.integer]) -> Floats:
    """Logarithms of the variances of neighborhoods, the largest first and zero.

    `members` is (B, c), the result (B, min(D, c - 1)).
    """
    total, count = members.shape
    gathered = data.matrix.shape[1] if isinstance(data, Points) else count
    size = max(1, BLOCK // (count * gathered))
    if size < total:
        parts = [
            _log_spectra(data, members[i : i + size]) for i in range(0, total, size)
        ]
        return np.concatenate(parts)
    products = data.local_products(members)
    values = np.linalg.eigvalsh(products)[:, ::-1][:, : count - 1]
    largest = np.maximum(values[:, :1], np.finfo(float).tiny)
    return np.asarray(np.log(np.maximum(values / largest, ROUNDING)))


class _Blocks(NamedTuple):
    """Work on many samples in blocks, by several threads: numpy lets them run."""

    threads: int
    callback: Callback | None

    def run(
        self, step: str, count: int, size: int, work: Callable[[slice], None]
    ) -> None:
        """Every block writes its own part of the result."""
        blocks = [slice(i, min(i + size, count)) for i in range(0, count, size)]
        pool = ThreadPoolExecutor(self.threads or os.cpu_count())
        try:
            for block, _ in zip(blocks, pool.map(work, blocks), strict=True):
                if self.callback is not None:
                    self.callback(step, block.stop, count)
        finally:
            pool.shutdown(cancel_futures=True)


# --------------------------------------------------------------- what a scale shows


class _Look(NamedTuple):
    """What one scale shows."""

    dim: int  # 0: nothing clear
    clarity: float
    by_distance: float

    def support(self, scale: int) -> float:
        """Small scales weigh more: they come before curvature and other sheets."""
        if self.dim == 0:
            return 0.0
        return (
            self.clarity
            * _agreement(self.by_distance, self.dim)
            / float(np.sqrt(scale))
        )


def _scales(count: int, scale: int | None) -> Ints:
    """Numbers of neighbors, half an octave apart."""
    if scale is not None:
        return np.array([min(scale, count - 1)])
    octaves = np.arange(0, np.log2(LARGEST_SCALE / SMALLEST_SCALE), 0.5)
    scales: Ints = np.rint(SMALLEST_SCALE * 2**octaves).astype(np.int64)
    return np.extract(scales <= max(SMALLEST_SCALE, count // 3), scales)


def _look_at_scales(data: Input, scales: Ints, run: _Blocks) -> tuple[list[_Look], int]:
    """Look at the same samples at every scale; also the rank of the neighborhoods."""
    count, columns = data.matrix.shape
    number = min(count, MAX_QUERIES, max(MAX_QUERIES // 4, MAX_PRODUCTS // count))
    # Evenly over the indices, but in step with no period of theirs.
    golden = (np.sqrt(5) - 1) / 2
    queries = np.arange(count)
    if number < count:
        queries = np.unique((np.arange(number) * golden % 1 * count).astype(np.int64))
        number = len(queries)
    most = int(scales[-1])
    places = [_spread(m + 1, MAX_MEMBERS) for m in scales.tolist()]
    # A Gram matrix has as many columns as samples.
    spectra = [np.empty((number, min(len(p) - 1, columns))) for p in places]
    logs = np.empty((number, len(scales)))

    def work(block: slice) -> None:
        near, distances = _nearest(data, queries[block], most)
        members = np.column_stack([queries[block], near])
        logs[block] = [
            [np.log(row[m - 1] / row[m // 2 - 1]) for m in scales] for row in distances
        ]
        for spectrum, place in zip(spectra, places, strict=True):
            spectrum[block] = _log_spectra(data, members[:, place])

    run.run("scales", number, 8, work)
    # Directions in which the data do not extend at all are no part of the space.
    reached = (spectra[-1] > np.log(2 * ROUNDING)).any(axis=0)
    rank = int(np.flatnonzero(reached)[-1]) + 1
    looks = []
    for m, spectrum, log in zip(scales, spectra, logs.mean(axis=0), strict=True):
        by_distance = _inverse_sum(m // 2, m) / max(log, 1e-9)
        middle = np.median(spectrum, axis=0)[None, :rank]
        (by_drop,), (drop,), (filling,) = _decide(
            middle, min(int(m) + 1, MAX_MEMBERS), rank, np.array([by_distance])
        )
        dim, clarity = 0, 0.0
        if drop >= CLEAR_DROP * (1 + 1 / m):  # chance is greater among few
            dim, clarity = int(by_drop), float(np.log(drop) / np.log(SHARP_DROP))
        elif filling:
            dim, clarity = rank, 0.5  # the drop that is missing cannot be sharp
        looks.append(_Look(dim, clarity, float(by_distance)))
    return looks, rank


def _decide(
    logs: Floats, members: int, rank: int, by_distance: Floats
) -> tuple[Ints, Floats, NDArray[np.bool_]]:
    """Directions before the largest drop of each spectrum, the drop, and if none matters.

    The last says whether the samples may fill all their space.
    """
    most = max(members // 4, 1)  # more directions cannot be told from fewer members
    width = min(rank, logs.shape[1])
    if width == 1:
        return (
            np.ones(len(logs), dtype=np.int64),
            np.zeros(len(logs)),
            np.ones(len(logs), dtype=bool),
        )
    drops = (logs[:, : width - 1] - logs[:, 1:width])[:, :most]
    drops = np.minimum(drops, np.log(SHARP_DROP))
    filling = np.zeros(len(logs), dtype=bool)
    if rank <= most:
        # The limits of the variances of that many members in all directions alike
        # (Marchenko and Pastur), and room for a boundary.
        ratio = np.sqrt(rank / members)
        least = 0.4 * ((1 - ratio) / (1 + ratio)) ** 2
        filling = logs[:, rank - 1] >= np.log(least)
        filling &= by_distance > 0.8 * rank
    # The first of several sharp drops: further ones are of the curvature.
    return np.argmax(drops, axis=1) + 1, np.exp(drops.max(axis=1)), filling


def _choose(dims: Ints, support: Floats, clarity: Floats, scales: Ints) -> int | None:
    """The clearest scale of the dimension with most support, None without any."""
    if not support.any():
        return None
    dim = int(np.argmax(np.bincount(dims, weights=support)))
    own = np.where(dims == dim, clarity, 0.0)
    # Fewer neighbors tell little about one sample, and nothing of the next dimension.
    enough = own * (scales >= 5 * (dim + 1))
    return int(np.argmax(enough if enough.any() else own))


def _share(scales: Ints, dims: Ints, support: Floats, dim: int) -> float:
    """Share of the dimension in the support of all scales.

    Scales that could show it and do not count a quarter, unless larger than all that do;
    and something is always against it, so that few scales are no proof.
    """
    own = dims == dim
    last = np.flatnonzero(own)[-1]
    silent = (dims == 0) & (scales + 1 >= 4 * (dim + 1))
    doubt = 0.25 * np.sum(1 / np.sqrt(scales[:last][silent[:last]]))
    return float(support[own].sum() / (support.sum() + doubt + 0.1))


class _Around(NamedTuple):
    """What the samples show at one scale."""

    dims: Ints
    confidences: Floats
    local_pca: float
    maximum_likelihood: float
    two_nn: float


def _ask_every_sample(
    data: Input, neighbors: int, dim: int, rank: int, clear: bool, run: _Blocks
) -> _Around:
    """Decide for each sample, together with the neighborhoods around."""
    indices, lengths = _nearest_of_all(data, neighbors, run.threads, run.callback)
    count, m = indices.shape
    lengths = np.maximum(lengths, np.finfo(float).tiny)
    chosen = _spread(m + 1, MAX_MEMBERS)
    width = min(rank, len(chosen) - 1, len(chosen) // 4 + 1)
    logs = np.empty((count, width))
    inverses = np.empty((2, count))

    def measure(block: slice) -> None:
        members = np.column_stack([np.arange(block.start, block.stop), indices[block]])
        logs[block] = _log_spectra(data, members[:, chosen])[:, :width]
        ratios = np.log(lengths[block, -1:] / lengths[block])
        inverses[0, block] = ratios.sum(axis=1) / (m - 1)
        inverses[1, block] = ratios[:, m // 2 - 1] / _inverse_sum(m // 2, m)

    run.run("spectra", count, 2**12, measure)
    likelihoods = 1 / np.maximum(inverses[0], 1e-9)

    def decided(spectra: Floats, by_distance: Floats) -> tuple[Ints, Ints]:
        by_drop, drop, filling = _decide(spectra, len(chosen), rank, by_distance)
        by_drop = np.where(filling & (drop < EVEN_DROP), rank, by_drop)
        rest = by_drop
        if not clear:
            rest = np.clip(np.rint(by_distance), 1, rank).astype(np.int64)
        elif dim == rank:
            rest = np.full(len(drop), dim)
        return np.where(drop >= BOUNDARY_DROP, by_drop, rest), by_drop

    own, _ = decided(logs, likelihoods)
    by_drop = np.empty(count, dtype=np.int64)
    dims = np.empty(count, dtype=np.int64)
    confidences = np.empty(count)

    def decide(block: slice) -> None:
        pool = np.column_stack(
            [np.arange(block.start, block.stop), indices[block, :MAX_POOLED]]
        )
        mean = inverses[0, pool].mean(axis=1)
        by_distance = 1 / np.maximum(mean, 1e-9)
        dims[block], by_drop[block] = decided(
            np.median(logs[pool], axis=1), by_distance
        )
        confidences[block] = np.mean(own[pool] == dims[block, None], axis=1)

    run.run("dimensions", count, 2**12, decide)
    maximum_likelihood, two_nn = 1 / np.maximum(inverses.mean(axis=1), 1e-9)
    return _Around(
        dims,
        confidences,
        float(by_drop.mean()),
        float(maximum_likelihood),
        float(two_nn),
    )


def _spread(count: int, most: int) -> Ints:
    """At most so many of the first numbers, evenly, with the first and the last."""
    places: Ints = np.linspace(0, count - 1, min(count, most)).round().astype(np.int64)
    return places


def _inverse_sum(first: int, end: int) -> float:
    """Mean of log(r_end / r_first) in dimension one, for uniform samples."""
    return float((1 / np.arange(first, end)).sum())


def _agreement(by_distance: float, dim: int) -> float:
    """How well an estimate from distances goes with a dimension, 1 at best.

    It may be too high, as noise makes it, rather than too low.
    """
    excess = by_distance - dim
    return 1 / (1 + (excess / dim if excess > 0 else 2 * excess**2 / dim))
