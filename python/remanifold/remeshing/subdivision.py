# SPDX-License-Identifier: GPL-3.0-or-later
"""Simplices cut into smaller ones, with new vertices on the manifold."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from remanifold.calculus.curvature import second_forms
from remanifold.complex.faces import parities

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.complex.data import ComplexData

    Floats = NDArray[np.float64]


class Subdivision(NamedTuple):
    """Half as long edges.

    Attributes
    ----------
    vertices : ndarray, shape (N + E, D), float64
        Those that were there, then one for each edge.
    simplices : ndarray, shape (2^K M, K+1), int32
    """

    vertices: Floats
    simplices: NDArray[np.int32]


def check_rounds(whole: ComplexData, rounds: int) -> None:
    """Refuse, before the first, rounds after which simplices could not be numbered.

    Raises
    ------
    ValueError
        2^(K rounds) times as many simplices are more than an index can tell apart.
    """
    most, halvings = int(np.iinfo(np.int32).max), whole.dim * rounds
    count = len(whole.simplices)
    # Beyond the first condition the power need not be written out.
    if count and (halvings >= most.bit_length() or count << halvings > most):
        msg = (
            f"rounds is {rounds}, which makes 2^{halvings} times as many simplices as the "
            f"{count:,} there are: more than {most:,}"
        )
        raise ValueError(msg)


def subdivide(whole: ComplexData, *, fitted: bool) -> Subdivision:
    """Every edge cut once; see `SimplicialComplex.subdivide`."""
    count = whole.num_vertices
    order = np.argsort(whole.simplices, axis=1, kind="stable")
    rows = np.take_along_axis(whole.simplices, order, axis=1).astype(np.int64)
    turned = parities(order)
    low, high, signs = _pieces(whole.dim)
    start, end = rows[:, low], rows[:, high]
    edges = whole.edges.astype(np.int64)
    number = np.searchsorted(edges[:, 0] * count + edges[:, 1], start * count + end)
    pieces = np.where(start == end, start, count + number)
    # The last two corners change places where the orientation is the other one.
    wrong = turned[:, None] * signs < 0
    if whole.dim > 0:
        pieces[wrong, -2:] = pieces[wrong, :-3:-1]
    middles = _middles(whole, fitted=fitted)
    return Subdivision(
        np.concatenate([whole.coordinates, middles]),
        pieces.reshape(-1, whole.dim + 1).astype(np.int32),
    )


@functools.cache
def _pieces(
    dim: int,
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Edgewise subdivision: the ends of the edge that each corner halves.

    As (2^K, K+1) each, the same twice for corners that were there, and the orientation
    of each piece. Pieces of simplices that share a face share its pieces, as the corners
    are in one order (Edelsbrunner and Grayson, 2000).
    """
    low, high = [], []
    for steps in range(2**dim):
        first = [steps >> i & 1 for i in range(dim)]
        low.append(np.concatenate([[0], np.cumsum(first)]).astype(np.int64))
        rest = np.concatenate([[0], np.cumsum(np.subtract(1, first))])
        high.append((sum(first) + rest).astype(np.int64))
    ends = np.array(low), np.array(high)
    places = np.eye(dim + 1)[ends[0]] + np.eye(dim + 1)[ends[1]]
    signs = np.sign(np.linalg.det(places)).astype(np.int64)
    return ends[0], ends[1], signs


def _middles(whole: ComplexData, *, fitted: bool) -> Floats:
    """Of the edges; fitted on curves that leave both ends along the tangent spaces.

    A cubic whose end tangents are as long as it takes to be exact on circles.
    """
    points = whole.coordinates
    i, j = whole.edges.T
    middles = (points[i] + points[j]) / 2
    if not fitted or whole.dim >= points.shape[1]:
        return np.asarray(middles)
    tangents = second_forms(whole)[0]
    chords = points[j] - points[i]
    lengths = np.linalg.norm(chords, axis=1)
    bends = []
    for end in (i, j):
        own = tangents[end]
        along = np.einsum(
            "ek,ekd->ed", np.einsum("ed,ekd->ek", chords, own), own, optimize=False
        )
        shadow = np.linalg.norm(along, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            cosine = shadow / lengths
            bends.append(along * (2 / (cosine * (1 + cosine)))[:, None])
    moves = (bends[0] - bends[1]) / 8
    # No tangent space, or one across the edge: the middle stays where it is.
    wild = ~(np.linalg.norm(moves, axis=1) < lengths / 2)
    moves[wild] = 0.0
    return np.asarray(middles + moves)
