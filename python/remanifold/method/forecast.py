# SPDX-License-Identifier: GPL-3.0-or-later
"""What a reconstruction will take: memory by counting, seconds by trying a patch."""

from __future__ import annotations

import math
import time
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from remanifold._base.html import fragment
from remanifold._base.text import one_line, rounded
from remanifold.datasets import embed, sphere

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Interval = tuple[float, float]

# Bytes a sample for each K, measured as the peak of a process beyond the samples
# themselves: of closed manifolds, and of solids with as many simplices as there are.
_BYTES = {1: (150, 420), 2: (200, 560), 3: (600, 4000), 4: (2500, 36_000)}
_BYTES_OF_COORDINATE = (20, 60)
# In more coordinates products of all with all may be quicker than a tree, and are kept
# up to so many bytes.
_FEW_COORDINATES = 8
_BYTES_OF_PRODUCT, _BYTES_OF_PRODUCTS = 4, 1 << 28
# A matrix of products or distances beside the given one: entries of 8 bytes, times.
_BYTES_OF_ENTRY = (8, 32)
_PATCHES = {1: (1000, 4000), 2: (1000, 4000), 3: (300, 1000), 4: (200,), 5: (100,)}
_QUICK = 0.25  # seconds, below which a larger patch is tried as well
# Cost is linear, but a patch has a rim that the whole has not, and may have cleaner
# samples: by how much it took less, or more, than said, up to K = 3 and beyond. Measured.
_FASTER, _SLOWER = (3.0, 8.0), (5.0, 25.0)


@dataclass(frozen=True)
class Forecast:
    """What a reconstruction will take, by one thread.

    Attributes
    ----------
    num_samples, ambient_dim, dim : int
        N, D and K; D is 0 where only products or distances are known.
    seconds : float
        Of one processor of this machine; NaN where no patch says anything.
    seconds_between : tuple of float
        From the least to the most that is to be expected.
    bytes : float
        Memory beyond the samples themselves; NaN for K beyond 4.
    bytes_between : tuple of float
        From the least, of a closed manifold, to the most, of a solid.
    """

    num_samples: int
    ambient_dim: int
    dim: int
    seconds: float
    seconds_between: tuple[float, float]
    bytes: float
    bytes_between: tuple[float, float]

    def __repr__(self) -> str:
        return one_line(
            self,
            samples=self.num_samples,
            dim=self.dim,
            seconds=rounded(self.seconds) if self.seconds > 0 else None,
            bytes=rounded(self.bytes) if self.bytes > 0 else None,
        )

    def _repr_html_(self) -> str:
        low, high = self.seconds_between
        least, most = (one / 1e6 for one in self.bytes_between)
        rows = [
            ("samples", f"{self.num_samples:,}"),
            ("seconds", f"{self.seconds:.2g}, from {low:.2g} to {high:.2g}"),
            ("megabytes", f"{self.bytes / 1e6:.2g}, from {least:.2g} to {most:.2g}"),
        ]
        return fragment(f"about {self.seconds:.2g} seconds by one thread", rows)


def expected_bytes(
    num_samples: int, ambient_dim: int, dim: int, *, products: bool = False
) -> Interval | None:
    """Least and most memory beyond the samples; None for K beyond 4.

    `products` where a matrix of inner products or distances is given.
    """
    if dim not in _BYTES:
        return None
    least, most = (
        num_samples * (one + coordinate * ambient_dim)
        for one, coordinate in zip(_BYTES[dim], _BYTES_OF_COORDINATE, strict=True)
    )
    if products:
        low, high = (entry * num_samples**2 for entry in _BYTES_OF_ENTRY)
        return float(least + low), float(most + high)
    if ambient_dim > _FEW_COORDINATES:
        kept = max(8 * num_samples * ambient_dim, _BYTES_OF_PRODUCTS)
        most += min(_BYTES_OF_PRODUCT * num_samples**2, kept)
    return float(least), float(most)


def middle(interval: Interval | None) -> float:
    """What is as many times the least as the most is of it; NaN for nothing."""
    return math.nan if interval is None else math.sqrt(interval[0] * interval[1])


def expected_seconds(
    points: Floats,
    dim: int,
    reconstruct: Callable[[Floats, int], object],
    num_samples: int | None = None,
) -> float | None:
    """Seconds of one processor, by doing a patch of the samples; None where it fails.

    `num_samples` is for how many of the kind, those given by default.
    """
    rng = np.random.default_rng(0)
    center = points[int(rng.integers(len(points)))]
    far = np.square(points - center).sum(axis=1)
    rate = None
    for size in _PATCHES.get(dim, ()):
        patch = points
        if size < len(points):
            patch = points[np.sort(np.argpartition(far, size)[:size])]
        start = time.process_time()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                reconstruct(patch, dim)
            except ValueError:
                return rate
        seconds = time.process_time() - start
        rate = seconds / len(patch) * (num_samples or len(points))
        if seconds > _QUICK or len(patch) == len(points):
            break
    return rate


def largest_patch(dim: int) -> int:
    """Samples of the largest that is tried."""
    return max(_PATCHES.get(dim, (0,)))


def least_seconds(expected: float, dim: int) -> float:
    """What it has never taken less than, of what was expected."""
    return expected / _FASTER[dim > 3]


def typical_samples(ambient_dim: int, dim: int) -> Floats:
    """Samples to try where none are given: a sphere, or a cube where K = D."""
    size = max(_PATCHES.get(dim, (1,)))
    if dim == ambient_dim:
        # More than a patch: the patch is not all rim.
        return np.random.default_rng(0).random((4 * size, dim))
    return embed(sphere(size, dim=dim, random_state=0), ambient_dim, random_state=0)


def forecast_of(
    num_samples: int,
    ambient_dim: int,
    dim: int,
    seconds: float | None,
    memory: Interval | None,
) -> Forecast:
    """Put together what is expected, with what was measured of such expectations."""
    time_taken = math.nan if seconds is None else seconds
    less, more = (factors[dim > 3] for factors in (_FASTER, _SLOWER))
    return Forecast(
        num_samples=num_samples,
        ambient_dim=ambient_dim,
        dim=dim,
        seconds=time_taken,
        seconds_between=(time_taken / less, time_taken * more),
        bytes=middle(memory),
        bytes_between=memory or (math.nan, math.nan),
    )


def refuse_late(seconds: float, least: float, num_samples: int, dim: int) -> None:
    """Refuse what cannot be done in this time, by the least that is expected.

    Raises
    ------
    TimeoutError
        That is longer.
    """
    if least > seconds:
        msg = (
            f"max_seconds is {seconds:g}, and {num_samples:,} samples with dim={dim} take "
            f"{least:.2g} at least: give fewer samples, or more time"
        )
        raise TimeoutError(msg)


def check_memory(
    num_samples: int, ambient_dim: int, dim: int, most: float, *, products: bool
) -> None:
    """Refuse what does not fit, before any work.

    Raises
    ------
    MemoryError
        What is expected is more than `most` bytes.
    """
    needed = middle(expected_bytes(num_samples, ambient_dim, dim, products=products))
    if needed > most:
        msg = (
            f"max_memory is {most / 1e6:.3g} MB, and {num_samples:,} samples with "
            f"dim={dim} take about {needed / 1e6:.3g} MB: give fewer samples, or more memory"
        )
        raise MemoryError(msg)
