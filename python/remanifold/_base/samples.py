# SPDX-License-Identifier: GPL-3.0-or-later
"""What samples are known by: points, inner products or distances, one class each."""

from __future__ import annotations

import functools
import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

Kind = Literal["points", "gram", "distances"]
_ROUNDING = 2.0**-48  # of the largest coordinate: samples nearer than this are one
_FEWEST = 6  # rows of a matrix that is symmetric by no accident
_CHANCE = 1e-3  # of a place with so many copies, over all data: as of an opening
_FEW_COORDINATES = 8  # up to which differences cost less than products


@dataclass(frozen=True, eq=False)
class Input(ABC):
    """N samples in the layout of the core.

    Everything that depends on how the samples are known is a method here; nobody else
    asks for the kind.
    """

    matrix: Floats
    kind: ClassVar[Kind]
    words: ClassVar[str]  # what the matrix holds, in a sentence

    @property
    def cancels(self) -> bool:
        """Whether `squares_from` loses the digits of small distances."""
        return False

    def __len__(self) -> int:
        return len(self.matrix)

    @functools.cached_property
    def scale(self) -> float:
        """The largest number, 1 where all are zero."""
        return float(np.abs(self.matrix).max()) or 1.0

    def of(self, matrix: Floats) -> Input:
        """Other samples, known by the same."""
        return type(self)(np.ascontiguousarray(matrix))

    @abstractmethod
    def subset(self, kept: NDArray[Any]) -> Input:
        """Some of the samples, by a mask or by numbers."""

    @abstractmethod
    def squared_distances(self, a: NDArray[Any], b: NDArray[Any]) -> Floats:
        """Between samples, by broadcasting."""

    @abstractmethod
    def squares_to_middle(self, a: int, b: int) -> Floats:
        """Squared distances of all samples from the middle between two."""

    @abstractmethod
    def squares_from(self, queries: NDArray[Any]) -> Floats:
        """Squared distances of some samples from all, (Q, N)."""

    @abstractmethod
    def products(self) -> Floats:
        """Inner products of the samples, about any origin."""

    @abstractmethod
    def local_products(self, members: NDArray[np.integer]) -> Floats:
        """Matrices with the spectra of neighborhoods but for zeros; `members` is (B, c)."""

    def words_of_place(self, i: int) -> str:  # noqa: ARG002  no place is known here
        """Where sample i lies, after the word that says so."""
        return ""

    def is_plain(self, i: int) -> bool:  # noqa: ARG002  as above
        """Whether sample i is zero, or one number throughout, as no measured one is."""
        return False

    @abstractmethod
    def first_copies(self) -> NDArray[np.int64]:
        """For each sample the first one that coincides with it up to rounding."""


class Points(Input):
    """Samples known by their coordinates, (N, D)."""

    kind = "points"
    words = "points"

    @property
    def cancels(self) -> bool:
        """Products are faster in many coordinates."""
        return bool(self.matrix.shape[1] > _FEW_COORDINATES)

    @functools.cached_property
    def _squared_norms(self) -> Floats:
        return np.asarray(np.einsum("nd,nd->n", self.matrix, self.matrix))

    def subset(self, kept: NDArray[Any]) -> Input:
        return self.of(self.matrix[kept])

    def squared_distances(self, a: NDArray[Any], b: NDArray[Any]) -> Floats:
        return np.asarray(((self.matrix[a] - self.matrix[b]) ** 2).sum(axis=-1))

    def squares_to_middle(self, a: int, b: int) -> Floats:
        middle = (self.matrix[a] + self.matrix[b]) / 2
        return np.asarray(((self.matrix - middle) ** 2).sum(axis=1))

    def squares_from(self, queries: NDArray[Any]) -> Floats:
        matrix = self.matrix
        if self.cancels:
            squares = self._squared_norms
            products = matrix[queries] @ matrix.T
            return np.asarray(squares[queries, None] + squares - 2 * products)
        far = np.zeros((len(queries), len(matrix)))
        for column in matrix.T:
            far += (column[queries, None] - column) ** 2
        return far

    def products(self) -> Floats:
        return np.asarray(self.matrix @ self.matrix.T)

    def local_products(self, members: NDArray[np.integer]) -> Floats:
        local = self.matrix[members]
        local -= local.mean(axis=1, keepdims=True)
        local /= np.maximum(
            np.abs(local).max(axis=(1, 2), keepdims=True), np.finfo(float).tiny
        )
        turned = local.transpose(0, 2, 1)
        small = local.shape[2] < local.shape[1]
        return np.asarray(turned @ local if small else local @ turned)

    def words_of_place(self, i: int) -> str:
        row = self.matrix[i]
        shown = ", ".join(f"{x:.6g}" for x in row[:_FEW_COORDINATES].tolist())
        return f" at ({shown}{', ...' if len(row) > _FEW_COORDINATES else ''})"

    def is_plain(self, i: int) -> bool:
        row = self.matrix[i]
        return len(row) > 1 and bool((row == row[0]).all())

    def first_copies(self) -> NDArray[np.int64]:
        # Only samples that share a first coordinate need a second look.
        largest = self.scale
        cells = np.rint(self.matrix[:, 0] / largest / _ROUNDING)
        order = np.argsort(cells, kind="stable")
        same = np.concatenate([[False], cells[order][1:] == cells[order][:-1], [False]])
        maybe = np.sort(order[same[1:] | same[:-1]])
        keys = np.rint(self.matrix[maybe] / largest / _ROUNDING) + 0.0  # no -0.0
        _, first, inverse = np.unique(
            keys, axis=0, return_index=True, return_inverse=True
        )
        original = np.arange(len(self.matrix))
        original[maybe] = maybe[first][inverse.ravel()]
        return original


class _Square(Input):
    """Samples known by an N x N matrix."""

    def subset(self, kept: NDArray[Any]) -> Input:
        return self.of(self.matrix[np.ix_(kept, kept)])

    def local_products(self, members: NDArray[np.integer]) -> Floats:
        products = self._products_of(
            self.matrix[members[:, :, None], members[:, None, :]]
        )
        products -= products.mean(axis=1, keepdims=True)
        products -= products.mean(axis=2, keepdims=True)
        return products

    def products(self) -> Floats:
        return self._products_of(self.matrix)

    def first_copies(self) -> NDArray[np.int64]:
        original = np.empty(len(self.matrix), dtype=np.int64)
        for i in range(len(original)):
            near = self._coincide(i)
            near[i] = True
            original[i] = np.argmax(near)
        return original

    @abstractmethod
    def _products_of(self, matrix: Floats) -> Floats:
        """Inner products, about any origin, from entries of the matrix."""

    @abstractmethod
    def _coincide(self, i: int) -> NDArray[np.bool_]:
        """Which samples are sample i up to rounding."""


def looks_like_a_mark(
    samples: Input, representatives: NDArray[np.integer], used: NDArray[np.integer]
) -> str | None:
    """What to say of many copies of one sample, as where it stands for missing ones.

    Depth cameras give zeros where they see nothing, which are another point once a scan is
    turned and shifted. Copies by chance are many places with few each: a mark has more
    than chance leaves to any place, and is one number throughout, or alone and with more
    than chance adds to the place that has most of the others.

    Parameters
    ----------
    representatives : array of int, shape (N,)
        Of each sample, the first one that it coincides with.
    used : array of int
        Samples in simplices.
    """
    counts = np.bincount(representatives)
    place = int(np.argmax(counts))
    copies = int(counts[place]) - 1
    places = int(np.count_nonzero(counts))
    if copies < 1 or places == 1:
        return None
    # The tail of Poisson's law at the rate of the other places, to which one copy is added:
    # that there are none may be chance as well.
    rate = (len(representatives) - places - copies + 1) / places
    if not samples.is_plain(place):
        if (used == place).any():
            return None
        # Molecules have a few shapes that come again and again, alone as these may be.
        counts[place] = 0
        rate = max(rate, int(counts.max()) - 1)
    by_chance = math.log(places) + copies * math.log(rate) - math.lgamma(copies + 1)
    if by_chance > math.log(_CHANCE):
        return None
    return (
        f"{copies + 1:,} of {len(representatives):,} samples coincide"
        f"{samples.words_of_place(place)}, sample {place:,} and copies of it, and count as "
        "one: if they mark missing ones, leave them out"
    )


def looks_like_a_matrix(points: Floats) -> str | None:
    """What to say of points that are a matrix of distances, or of inner products."""
    count = len(points)
    # A few samples may be symmetric; of most arrays the first row and column tell.
    if count < _FEWEST or points.shape != (count, count):
        return None
    scale = 1e-6 * float(np.abs(points[0]).max())
    if not np.allclose(points[0], points[:, 0], rtol=0, atol=scale):
        return None
    scale = 1e-6 * float(np.abs(points).max())
    if not np.allclose(points, points.T, rtol=0, atol=scale):
        return None
    own = np.diagonal(points)
    said = f"points is a symmetric matrix of {count:,} rows"
    if (np.abs(own) <= scale).all() and (points >= -scale).all():
        return f"{said} with zeros on its diagonal: distances= takes distances"
    # Products are no larger than those of each with itself; the unit matrix is corners.
    outer = np.sqrt(np.maximum(own[:, None] * own, 0)) + scale
    alone = np.count_nonzero(points) == np.count_nonzero(own)
    if (own > 0).all() and (np.abs(points) <= outer).all() and not alone:
        return f"{said}, as that of inner products is: gram= takes it"
    return None


class Gram(_Square):
    """Samples known by their inner products."""

    kind = "gram"
    words = "inner products"

    def is_plain(self, i: int) -> bool:
        return bool(self.matrix[i, i] == 0)

    def squared_distances(self, a: NDArray[Any], b: NDArray[Any]) -> Floats:
        matrix = self.matrix
        squares = matrix[a, a] + matrix[b, b] - 2 * matrix[a, b]
        return np.asarray(np.maximum(squares, 0.0))

    def squares_to_middle(self, a: int, b: int) -> Floats:
        matrix = self.matrix
        middle_norm = (matrix[a, a] + matrix[b, b] + 2 * matrix[a, b]) / 4
        return np.asarray(np.diagonal(matrix) + middle_norm - matrix[a] - matrix[b])

    def squares_from(self, queries: NDArray[Any]) -> Floats:
        squares = np.array(np.diagonal(self.matrix))
        return np.asarray(squares[queries, None] + squares - 2 * self.matrix[queries])

    def _products_of(self, matrix: Floats) -> Floats:
        return matrix

    def _coincide(self, i: int) -> NDArray[np.bool_]:
        diagonal = np.diagonal(self.matrix)
        size = diagonal[i] + diagonal
        return np.asarray(size - 2 * self.matrix[i] <= _ROUNDING * size)


class Distances(_Square):
    """Samples known by their distances."""

    kind = "distances"
    words = "distances"

    def squared_distances(self, a: NDArray[Any], b: NDArray[Any]) -> Floats:
        return np.asarray(self.matrix[a, b] ** 2)

    def squares_to_middle(self, a: int, b: int) -> Floats:
        matrix = self.matrix
        return np.asarray((matrix[a] ** 2 + matrix[b] ** 2) / 2 - matrix[a, b] ** 2 / 4)

    def squares_from(self, queries: NDArray[Any]) -> Floats:
        return np.asarray(self.matrix[queries] ** 2)

    def _products_of(self, matrix: Floats) -> Floats:
        return np.square(matrix) / -2

    def _coincide(self, i: int) -> NDArray[np.bool_]:
        return np.asarray(self.matrix[i] <= _ROUNDING * self.scale)


INPUTS: Sequence[type[Input]] = (Points, Gram, Distances)
