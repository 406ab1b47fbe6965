# SPDX-License-Identifier: GPL-3.0-or-later
"""Corners of curves that lie in a gap between samples."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold._base.samples import Input

MOST_APART = 0.5  # spacings between two lines that meet, as far as samples tell


def length_through_corner(
    samples: Input,
    rows: NDArray[np.int32],
    ends: NDArray[np.int32],
    spacing: float,
    steps: int,
) -> float:
    """From one end of an edge to the other, straight on to where its two sides meet.

    Parameters
    ----------
    samples : Input
    rows : ndarray, shape (M, 2), int32
        Edges of a curve.
    ends : ndarray, shape (2,), int32
        Those of the edge.
    spacing : float
        Between the samples around.
    steps : int
        Along either side that tell its direction.

    Returns
    -------
    float
        Infinite where the sides do not meet, or are too short to tell.
    """
    a, b = ends.tolist()
    starts = [_along(rows, first, before, steps) for first, before in ((a, b), (b, a))]
    if min(starts) < 0:
        return math.inf
    four = np.array([a, b, *starts], dtype=np.int64)
    squares = samples.squared_distances(four[:, None], four[None, :])
    # Inner products of the way from a to b and of the directions of both sides.
    from_a = (squares[:1] + squares[:, :1] - squares) / 2
    ways = np.array([[0.0, 1, 0, 0], [0, 0, -1, 0], [0, 1, 0, -1]])
    products: NDArray[Any] = ways @ from_a @ ways.T
    lengths = np.sqrt(np.maximum(np.diag(products), 0))
    if not lengths.min() > 0:
        return math.inf
    between, first, second = lengths
    cosine = products[1, 2] / (first * second)
    on_first, on_second = products[0, 1] / first, products[0, 2] / second
    sine = 1 - cosine**2
    if not sine > np.finfo(float).eps:
        return math.inf
    s = (on_first - cosine * on_second) / sine
    t = (cosine * on_first - on_second) / sine
    apart = between**2 + t * t + s * s + 2 * (t * on_second - s * on_first)
    apart = math.sqrt(max(0.0, apart - 2 * s * t * cosine))
    # Samples just behind the corner may have come before it.
    return float(abs(s) + abs(t) + apart) if apart <= MOST_APART * spacing else math.inf


def _along(rows: NDArray[np.int32], first: int, before: int, steps: int) -> int:
    """The sample so many steps along a curve, -1 where it ends before."""
    for _ in range(steps):
        at = rows[(rows == first).any(axis=1)].ravel()
        onward = at[(at != first) & (at != before)]
        if len(onward) != 1:
            return -1
        first, before = int(onward[0]), first
    return first
