# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators of a surface by its intrinsic Delaunay triangulation."""

from __future__ import annotations

import functools
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from remanifold import _core
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line
from remanifold.calculus.elements import Elements, elements_of_triangles
from remanifold.calculus.operators import Operators
from remanifold.warnings import DoubtWarning

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.complex.data import ComplexData


@dataclass(frozen=True, eq=False, repr=False)
class IntrinsicTriangles(ReadOnlyArrays):
    """Triangles on a surface, with its vertices and straight along it, read-only.

    Attributes
    ----------
    triangles : ndarray, shape (M, 3), int32
        A vertex may stand twice in one, and two may have the same vertices.
    lengths : ndarray, shape (M, 3), float64
        Of the sides opposite to the vertices.
    num_flips : int
        Edges that were flipped.
    complete : bool
        False where a hundred flips for each triangle were not enough.
    """

    triangles: NDArray[np.int32]
    lengths: NDArray[np.float64]
    num_flips: int
    complete: bool

    def __repr__(self) -> str:
        return one_line(
            self,
            triangles=len(self.triangles),
            num_flips=self.num_flips,
            complete=self.complete,
        )


class DelaunayOperators(Operators):
    """Matrices of functions on an intrinsic Delaunay triangulation; it has no forms.

    Where edges have one triangle, or more than two, of both sides of the surface, which
    share its vertices.
    """

    def __init__(self, complex_: ComplexData) -> None:
        super().__init__(complex_)
        triangles = np.ascontiguousarray(complex_.simplices)
        squares = complex_._source.squared_distances(
            triangles[:, [1, 2, 0]], triangles[:, [2, 0, 1]]
        )
        self._given = triangles, np.ascontiguousarray(np.sqrt(squares))
        pairs = np.sort(np.concatenate([triangles[:, [i, i - 1]] for i in range(3)]))
        shared = np.unique(pairs, axis=0, return_counts=True)[1]
        self._sides = 1 if (shared == 2).all() else 2
        found = self._flipped(both_sides=self._sides == 2)
        self.simplices, self.lengths = found.triangles, found.lengths
        if not found.complete:
            msg = "no intrinsic Delaunay triangulation after a hundred flips a triangle"
            warnings.warn(f"{msg}: weights may be negative", DoubtWarning, stacklevel=5)

    def _flipped(self, *, both_sides: bool) -> IntrinsicTriangles:
        """Flip edges until the angles opposite to none add up to more than pi."""
        return IntrinsicTriangles(*_core.intrinsic_delaunay(*self._given, both_sides))

    @functools.cached_property
    def intrinsic(self) -> IntrinsicTriangles:
        """Of one side."""
        return self._flipped(both_sides=False)

    @functools.cached_property
    def elements(self) -> Elements:
        """Triangles as elements, each of them half where there are both sides."""
        elements = elements_of_triangles(self.lengths)
        return elements._replace(volumes=elements.volumes / self._sides)
