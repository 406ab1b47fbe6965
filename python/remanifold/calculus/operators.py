# SPDX-License-Identifier: GPL-3.0-or-later
"""Mass, stiffness and Hodge stars of a complex, by linear elements and Whitney forms."""

from __future__ import annotations

import functools
import itertools
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold import _core
from remanifold.calculus.elements import (
    Elements,
    differences,
    elements_of,
    solve_frames,
)
from remanifold.calculus.solving import Solver, factorized, scipy_module
from remanifold.complex.faces import boundary_operators, face_numbers

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.complex.data import ComplexData

    Floats = NDArray[np.float64]


class Operators:
    """The matrices of a complex, each made when first asked for."""

    def __init__(self, complex_: ComplexData) -> None:
        self.complex = complex_
        self.simplices = complex_.simplices
        self.count = complex_.num_vertices
        self.dim = complex_.dim
        self._stars: dict[tuple[int, bool], Any] = {}
        self._star_solvers: dict[int, Solver] = {}

    @functools.cached_property
    def elements(self) -> Elements:
        """Simplices as elements."""
        return elements_of(self.complex)

    @functools.cached_property
    def frames(self) -> Floats:
        """Frames of the elements, (M, K, K); those of flat ones the identity."""
        frames: Floats = self.elements.frames.copy()
        frames[self.elements.flat] = np.eye(self.dim)
        return np.asarray(frames)

    @functools.cached_property
    def volumes(self) -> Floats:
        """Share of each vertex in the volume, (N,): the lumped mass."""
        shares = np.repeat(self.elements.volumes / (self.dim + 1), self.dim + 1)
        return np.asarray(
            np.bincount(self.simplices.ravel(), shares, self.count), np.float64
        )

    @functools.cached_property
    def used(self) -> NDArray[np.bool_]:
        """Vertices in a simplex that is not flat: where functions have values."""
        return self.volumes > 0

    @functools.cached_property
    def labels(self) -> NDArray[np.int32]:
        """Component of each vertex through simplices that are not flat; -1 where none."""
        solid = np.ascontiguousarray(self.simplices[~self.elements.flat])
        return _core.component_labels(solid, self.count)

    @functools.cached_property
    def mass(self) -> Any:
        """Inner products of the hat functions, (N, N)."""
        corners = self.dim + 1
        shares = (np.ones((corners, corners)) + np.eye(corners)) / (
            corners * (corners + 1)
        )
        return self._assembled(self.elements.volumes[:, None, None] * shares)

    @functools.cached_property
    def stiffness(self) -> Any:
        """Inner products of the gradients of the hat functions, (N, N)."""
        elements = self.elements
        return self._assembled(elements.volumes[:, None, None] * elements.products)

    def _assembled(self, local: Floats) -> Any:
        corners = self.dim + 1
        rows = np.repeat(self.simplices, corners, axis=1).ravel()
        columns = np.tile(self.simplices, (1, corners)).ravel()
        return _matrix(local.ravel(), rows, columns, self.count)

    @functools.cached_property
    def _chains(self) -> tuple[tuple[Any, ...], tuple[NDArray[np.int32], ...]]:
        scipy_module("sparse")
        return boundary_operators(self.simplices, self.count)

    def faces(self, degree: int) -> NDArray[np.int32]:
        """Simplices of a dimension, which forms of this degree have values on."""
        return self._chains[1][degree]

    def derivative(self, degree: int) -> Any:
        """From forms of a degree to the next: the coboundary operator, int8."""
        return self._chains[0][degree].T.tocsr()

    def star(self, degree: int, *, diagonal: bool = False) -> Any:
        """Hodge star of forms: inner products of Whitney forms, or a diagonal."""
        key = (degree, diagonal)
        if key not in self._stars:
            make = self._diagonal_star if diagonal else self._whitney_star
            self._stars[key] = make(degree)
        return self._stars[key]

    def star_solver(self, degree: int) -> Solver:
        """Solve with the star of Whitney forms; faces of flat simplices only have zero."""
        if degree not in self._star_solvers:
            star = self.star(degree)
            have = star.diagonal() > 0
            inner = factorized(star[have][:, have])

            def solve(right: Floats) -> Floats:
                found = np.zeros_like(right)
                found[have] = inner(right[have])
                return found

            self._star_solvers[degree] = solve
        return self._star_solvers[degree]

    @functools.cached_property
    def _ascending(self) -> tuple[NDArray[np.int32], Floats]:
        """Simplices with ascending vertices, and products of the gradients in this order."""
        order = np.argsort(self.simplices, axis=1, kind="stable")
        rows = np.arange(len(order))[:, None, None]
        products = self.elements.products[rows, order[:, :, None], order[:, None, :]]
        return np.take_along_axis(self.simplices, order, axis=1), products

    def _whitney_star(self, degree: int) -> Any:
        """Integrals of the products of Whitney forms.

        The form of a face is k! times the alternating sum, over its vertices, of the
        barycentric coordinate of one times the gradients of those of the others.
        """
        simplices, products = self._ascending
        places, numbers = face_numbers(simplices, degree, self.count)
        corners = self.dim + 1
        weight = self.elements.volumes * math.factorial(degree) ** 2
        weight = weight / (corners * (corners + 1))
        minors: dict[tuple[tuple[int, ...], tuple[int, ...]], Floats] = {}

        def minor(a: tuple[int, ...], b: tuple[int, ...]) -> Floats:
            a, b = min(a, b), max(a, b)
            if (a, b) not in minors:
                block = products[:, list(a)][:, :, list(b)]
                minors[a, b] = np.linalg.det(block) if a else np.ones(len(block))
            return minors[a, b]

        rows, columns, entries = [], [], []
        for p, q in itertools.combinations_with_replacement(range(len(places)), 2):
            total = np.zeros(len(simplices))
            for i, a in enumerate(places[p]):
                for j, b in enumerate(places[q]):
                    sign = (-1) ** (i + j) * (2 if a == b else 1)
                    rest = places[p][:i] + places[p][i + 1 :]
                    total += sign * minor(rest, places[q][:j] + places[q][j + 1 :])
            pairs = ((p, q),) if p == q else ((p, q), (q, p))
            for first, second in pairs:
                rows.append(numbers[:, first])
                columns.append(numbers[:, second])
                entries.append(weight * total)
        size = len(self.faces(degree))
        return _matrix(
            np.concatenate(entries),
            np.concatenate(rows),
            np.concatenate(columns),
            size,
        )

    def _diagonal_star(self, degree: int) -> Any:
        """Volumes of the circumcentric duals of faces over their own, on the diagonal.

        The dual is made of right-angled simplices, one for each way from the face to a
        K-simplex through faces of each dimension, whose legs lead from circumcenter to
        circumcenter. A leg counts as negative where it leads away from its simplex.
        """
        simplices, _ = self._ascending
        squares = _squared_lengths(self, simplices)
        corners = self.dim + 1
        legs: dict[tuple[tuple[int, ...], int], Floats] = {}
        centers: dict[tuple[int, ...], tuple[Floats, Floats]] = {}
        solid = ~self.elements.flat

        def center(face: tuple[int, ...]) -> tuple[Floats, Floats]:
            if face not in centers:
                centers[face] = _circumcenter(squares[:, face][:, :, face], solid)
            return centers[face]

        def leg(face: tuple[int, ...], added: int) -> Floats:
            """Signed distance from the center of a face to that with one vertex more."""
            if (face, added) not in legs:
                bigger = tuple(sorted((*face, added)))
                radius, weights = center(bigger)
                high = np.maximum(radius - center(face)[0], 0.0)
                sign = np.sign(weights[:, bigger.index(added)])
                legs[face, added] = sign * np.sqrt(high)
            return legs[face, added]

        def dual(face: tuple[int, ...]) -> Floats:
            if len(face) == corners:
                return np.ones(len(simplices))
            total = np.zeros(len(simplices))
            for added in set(range(corners)) - set(face):
                total += leg(face, added) * dual(tuple(sorted((*face, added))))
            return total / (corners - len(face))

        places, numbers = face_numbers(simplices, degree, self.count)
        size = len(self.faces(degree))
        duals, own = np.zeros(size), np.zeros(size)
        for column, place in enumerate(places):
            volumes = _volumes_of(squares[:, place][:, :, place])
            duals += np.bincount(numbers[:, column], solid * dual(place), size)
            own[numbers[:, column]] = volumes
        with np.errstate(divide="ignore", invalid="ignore"):
            entries = np.where(own > 0, duals / own, 0.0)
        rows = np.arange(size)
        return _matrix(entries, rows, rows, size)

    def frame_gradients(self, values: Floats) -> Floats:
        """Gradients in the frames of the simplices, (M, K) or (M, K, C); zero if flat."""
        steps = differences(values, self.simplices)
        steps[self.elements.flat] = 0.0
        return solve_frames(self.frames, steps)

    def ambient_frames(self) -> Floats:
        """Orthonormal axes of the frames in coordinates, (M, K, D); zero if flat."""
        coordinates = self.complex.coordinates
        edges = differences(coordinates, self.simplices)
        axes = solve_frames(self.frames, edges)
        axes[self.elements.flat] = 0.0
        return np.asarray(axes)

    def weak_divergence(self, vectors: Floats) -> Floats:
        """Products of vectors in the frames with the gradients of the hats, (N,)."""
        # Gradients of the coordinates of all vertices but the first are the columns of
        # the inverse; that of the first is minus their sum.
        others = solve_frames(self.frames, vectors, transposed=True)
        sums = np.concatenate([-others.sum(axis=1, keepdims=True), others], axis=1)
        sums *= self.elements.volumes[:, None]
        return np.asarray(
            np.bincount(self.simplices.ravel(), sums.ravel(), self.count), np.float64
        )


def _matrix(
    entries: Floats, rows: NDArray[Any], columns: NDArray[Any], size: int
) -> Any:
    sparse = scipy_module("sparse")
    matrix = sparse.coo_array((entries, (rows, columns)), shape=(size, size)).tocsr()
    matrix.sum_duplicates()
    return matrix


def _squared_lengths(operators: Operators, simplices: NDArray[np.int32]) -> Floats:
    """Between all corners of each simplex, (M, K+1, K+1)."""
    source = operators.complex._source
    return source.squared_distances(simplices[:, :, None], simplices[:, None, :])


def _grams(squares: Floats) -> Floats:
    """Inner products of the edges from the first corner."""
    first = squares[:, 0, 1:]
    return (first[:, :, None] + first[:, None, :] - squares[:, 1:, 1:]) / 2


def _volumes_of(squares: Floats) -> Floats:
    dim = squares.shape[1] - 1
    if dim == 0:
        return np.ones(len(squares))
    determinants = np.linalg.det(_grams(squares))
    return np.asarray(np.sqrt(np.maximum(determinants, 0.0)) / math.factorial(dim))


def _circumcenter(squares: Floats, solid: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Squared radii, and barycentric coordinates of the centers."""
    size = squares.shape[1]
    if size == 1:
        return np.zeros(len(squares)), np.ones((len(squares), 1))
    gram = np.where(solid[:, None, None], _grams(squares), np.eye(size - 1))
    half = np.diagonal(gram, axis1=1, axis2=2)[:, :, None] / 2
    weights = np.linalg.solve(gram, half)[:, :, 0]
    radii = (weights * half[:, :, 0]).sum(axis=1)
    return radii, np.concatenate([1 - weights.sum(axis=1)[:, None], weights], axis=1)
