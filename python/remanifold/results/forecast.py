# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a reconstruction will take and how much memory, before it is begun."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from remanifold._base.samples import Points
from remanifold._base.validation import check_dim, check_int, check_samples
from remanifold.method.forecast import (
    Forecast,
    expected_bytes,
    expected_seconds,
    forecast_of,
    typical_samples,
)
from remanifold.results.reconstruct import by_one_thread

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def forecast(
    points: ArrayLike | int | None = None,
    ambient_dim: int | None = None,
    dim: int | None = None,
    *,
    gram: ArrayLike | None = None,
    distances: ArrayLike | None = None,
) -> Forecast:
    """Forecast the time and the memory of `reconstruct`.

    A patch of the samples is reconstructed by one thread, which takes a second at most
    for K up to 3, and what it took is taken for each of the others: cost is linear in N.
    Where there is only a number of samples, as many are tried of a sphere, or of a cube
    where K = D. Memory goes by what was measured. How far either has been off is in the
    intervals, and on the page on speed.

    Parameters
    ----------
    points : int or array_like, shape (N, D)
        The samples, or N, the number of them.
    ambient_dim : int, optional
        D, the number of coordinates, where `points` is a number.
    dim : int
        K, the dimension of the manifold.
    gram, distances : array_like, shape (N, N), optional
        Inner products or distances of the samples, instead of `points`.

    Returns
    -------
    Forecast

    Raises
    ------
    ValueError
        A number of samples without `ambient_dim`, or `dim` out of range; as
        `reconstruct` where samples are given.

    Examples
    --------
    >>> import remanifold as rm
    >>> expected = rm.forecast(1_000_000, 3, 2)
    >>> round(expected.bytes / 1e6)
    530
    """
    if isinstance(points, int | np.integer):
        count = check_int(points, "points", minimum=1)
        if ambient_dim is None:
            msg = "ambient_dim is needed where points is the number of the samples"
            raise ValueError(msg)
        columns = check_int(ambient_dim, "ambient_dim", minimum=1)
        k = check_int(dim, "dim", minimum=1)
        if k > columns:
            msg = f"dim is {k}, more than ambient_dim, {columns}"
            raise ValueError(msg)
        tried, products = typical_samples(columns, k), False
    else:
        samples = check_samples(points, gram, distances)
        k = check_dim(dim, samples)
        products = not isinstance(samples, Points)
        count, columns = samples.matrix.shape
        tried = samples.matrix
        if products:
            # What the steps do to coordinates they do to products of as few.
            tried, columns = typical_samples(k + 1, k), 0
    seconds = expected_seconds(tried, k, by_one_thread, count)
    memory = expected_bytes(count, columns, k, products=products)
    return forecast_of(count, columns, k, seconds, memory)
