# SPDX-License-Identifier: GPL-3.0-or-later
"""What can be said of samples before they are reconstructed: how they lie."""

from __future__ import annotations

import contextlib
import itertools
import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from remanifold.method.dimension import DimensionEstimate, estimate_dimension
from remanifold.method.steps import neighborhoods

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

MOST = 10_000  # samples that the dimension is estimated from, 0.5 s
_LOOKED_AT = 2_000  # samples whose neighborhoods are looked at for structure
_FEWEST = 9  # samples, of which there is nothing to say
_NEAR = 24  # neighbors of each
# A lattice: nearly all steps to neighbors are the same few. Random samples have no two
# alike; a lattice with noise of a tenth of its step still has most of them.
_SAME_VALUE = 1e-7  # of the extent, up to which coordinates are the same
_FILLED = 0.5  # share of the places of a grid that hold a sample
_SAME_STEP = 0.05  # of the spacing
_LATTICE = 0.8  # share of steps
# Scan lines: the two nearest samples lie on opposite sides, and others are farther.
_OPPOSITE = -0.9  # cosine
_LINES = 0.6  # share of samples
_ACROSS = 1.5  # times the spacing along the line
_CHAIN = 1.5  # of the spacing, from each sample to the next in the file
# Extents that differ by so much are not of one unit.
_UNEQUAL = 1e4
_DEGREES = (360.0, 90.0)  # largest longitude and latitude
_BESIDE = 20.0  # extent of heights over that of angles


@dataclass(frozen=True)
class Survey:
    """How samples lie.

    Attributes
    ----------
    spread : float
        Ratio of the distances to the sixth neighbor that 95 % and 5 % of the samples
        stay below; 1.0 for a lattice, about 2 for random samples of a surface.
    estimate : DimensionEstimate or None
        Of at most 10,000 of them.
    structure : str
        What they are not random in; empty for nothing.
    units : tuple of str
        What speaks against all coordinates having one unit.
    """

    spread: float
    estimate: DimensionEstimate | None
    structure: str
    units: tuple[str, ...]


def survey(points: Floats, threads: int | None = None) -> Survey:
    """Look at finite, distinct samples, (N, D)."""
    if len(points) <= _FEWEST:
        return Survey(float("nan"), None, "", suspicious_units(points))
    far = neighborhoods(points, 6, num_threads=threads).distances[:, 5]
    low, high = np.quantile(far, [0.05, 0.95])
    rng = np.random.default_rng(0)
    some = points
    if len(points) > MOST:
        some = points[np.sort(rng.choice(len(points), MOST, replace=False))]
    estimate = None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with contextlib.suppress(ValueError):  # too few of them
            estimate = estimate_dimension(some, num_threads=threads)
    return Survey(
        spread=float(high / low) if low > 0 else float("inf"),
        estimate=estimate,
        structure=structure(points, threads),
        units=suspicious_units(points),
    )


def structure(points: Floats, threads: int | None = None) -> str:
    """Lattice, scan lines, the order of the samples; in words."""
    found = neighborhoods(points, min(_NEAR, len(points) - 1), num_threads=threads)
    chosen = np.arange(len(points))
    if len(points) > _LOOKED_AT:
        rng = np.random.default_rng(0)
        chosen = np.sort(rng.choice(len(points), _LOOKED_AT, replace=False))
    steps = points[found.indices[chosen]] - points[chosen][:, None]
    spacing = float(np.median(found.distances[:, 0]))
    words = []
    axes = _grid_axes(points)
    if axes:
        words.append(f"a lattice over the coordinates {', '.join(map(str, axes))}")
    elif _is_lattice(steps, spacing):
        words.append("a lattice")
    else:
        across = _lines(steps)
        if across > _ACROSS:
            words.append(
                f"lines of a scan, {across:.2g} times as far apart as along them"
            )
    following = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if np.median(following) < _CHAIN * spacing:
        words.append("each next to the one before in the file")
    return ", ".join(words)


def _grid_axes(points: Floats) -> tuple[int, ...]:
    """Coordinates whose few values, all with all, make up the samples; or none."""
    count, dim = points.shape
    if dim > 4:
        return ()
    extent = np.ptp(points, axis=0)
    cells = np.rint(points / np.where(extent > 0, extent, 1) / _SAME_VALUE)
    values = [len(np.unique(cells[:, axis])) for axis in range(dim)]
    for size in (2, 3):
        for axes in itertools.combinations(range(dim), size):
            sizes = [values[axis] for axis in axes]
            places = math.prod(sizes)
            if min(sizes) > 2 and max(sizes) * 3 <= count <= places <= count / _FILLED:
                return axes
    return ()


def _is_lattice(steps: Floats, spacing: float) -> bool:
    """Whether few steps, up to their signs, make up nearly all."""
    # As many as a lattice of the dimension has neighbors at the least.
    flat = steps[:, :4].reshape(-1, steps.shape[2])
    cells = np.rint(flat / (_SAME_STEP * spacing))
    first = np.take_along_axis(cells, (cells != 0).argmax(axis=1)[:, None], axis=1)
    cells *= np.where(first < 0, -1, 1)
    counts = np.sort(np.unique(cells, axis=0, return_counts=True)[1])[::-1]
    return bool(counts[:8].sum() > _LATTICE * len(flat))


def _lines(steps: Floats) -> float:
    """How much farther the next line is than the next sample; 0 where there are none."""
    length = np.linalg.norm(steps, axis=2)
    with np.errstate(invalid="ignore", divide="ignore"):
        along = steps / length[:, :, None]
    cosines = np.einsum("nkd,nd->nk", along, along[:, 0])
    if np.mean(cosines[:, 1] < _OPPOSITE) < _LINES:
        return 0.0
    aside = np.abs(cosines) < 0.7
    known = aside.any(axis=1)
    rows = np.arange(len(steps))
    far = length[rows, aside.argmax(axis=1)] / length[:, 0]
    # Where all neighbors are on the line the next one is farther still.
    far[~known] = length[~known, -1] / length[~known, 0]
    if known.mean() < 0.05:  # a curve
        return 0.0
    return float(np.median(far))


def suspicious_units(points: Floats) -> tuple[str, ...]:
    """What speaks against all coordinates having one unit."""
    low, high = points.min(axis=0), points.max(axis=0)
    extent = high - low
    found = []
    if (
        points.shape[1] == 3
        and extent[2] > _BESIDE * max(extent[0], extent[1])
        and _are_degrees(points[:, :2], low, high)
    ):
        found.append(
            "the first two coordinates look like degrees and the third like metres: "
            "project them to metres first"
        )
    known = extent[extent > 0]
    if not found and 1 < len(known) <= 3 and known.max() > _UNEQUAL * known.min():
        most, least = (
            int(extent.argmax()),
            int(np.where(extent > 0, extent, np.inf).argmin()),
        )
        found.append(
            f"coordinate {most} spans {known.max() / known.min():.1g} times as much as "
            f"coordinate {least}: are their units the same?"
        )
    return tuple(found)


def _are_degrees(plane: Floats, low: Floats, high: Floats) -> bool:
    """Whether two coordinates can be longitudes and latitudes of some place on earth."""
    longitude, latitude = _DEGREES
    inside = bool((np.abs([low[0], high[0]]) <= longitude).all())
    inside = inside and bool((np.abs([low[1], high[1]]) <= latitude).all())
    # A region, off the origin: shapes around it are no places.
    region = (high[:2] - low[:2] < 5).all() and (np.abs(plane).min(axis=0) > 1e-3).any()
    return inside and bool(region) and bool((np.trunc(plane) != plane).mean() > 0.9)
