# SPDX-License-Identifier: GPL-3.0-or-later
"""Harmonic forms, and circular coordinates from integer cohomology classes."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line
from remanifold.calculus.poisson import solve_stiffness
from remanifold.calculus.solving import factorized, scipy_module
from remanifold.complex.embedding import fixed_signs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.calculus.operators import Operators

    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

# Eigenvalues of harmonic forms are zero up to rounding, beside those of the complex.
_ZERO = 1e-8


@dataclass(frozen=True, eq=False, repr=False)
class CircularCoordinates(ReadOnlyArrays):
    """Angles along the independent loops of a complex. Arrays are read-only.

    Attributes
    ----------
    angles : ndarray, shape (N, B), float64
        B angles at each vertex, from 0 to 2 pi, the smoothest of their classes; zero at
        the first vertex of each component, NaN at `Calculus.missing_vertices`.
    forms : ndarray, shape (E, B), float64
        Steps of the angles over 2 pi along `edges`: harmonic 1-forms, whose integrals
        around loops are whole numbers.
    cocycles : ndarray, shape (E, B), int64
        Integer cocycles of the same classes, a basis of the cohomology over the integers.
    edges : ndarray, shape (E, 2), int32
        ``Calculus.faces(1)``.
    energies : ndarray, shape (B,), float64
        Integrals of the squared lengths of the forms, ascending: (length of the loop)^-2
        times K-volume where an angle grows evenly.
    """

    angles: Floats
    forms: Floats
    cocycles: Integers
    edges: NDArray[np.int32]
    energies: Floats

    def __repr__(self) -> str:
        return one_line(self, vertices=len(self.angles), loops=self.angles.shape[1])


def circular_coordinates(operators: Operators) -> CircularCoordinates:
    """Angles of a basis of the first cohomology; see `Calculus.circular_coordinates`."""
    cocycles = integer_cocycles(operators)
    star = operators.star(1)
    potentials = _potentials(operators, cocycles)
    forms = cocycles - operators.derivative(0) @ potentials
    change = _reduced(forms.T @ (star @ forms))
    cocycles, forms, potentials = cocycles @ change, forms @ change, potentials @ change
    signs = fixed_signs(forms).astype(np.int64) if forms.size else np.ones(0, np.int64)
    cocycles, forms, potentials = cocycles * signs, forms * signs, potentials * signs
    # On the spanning tree the cocycles are zero: there the potentials are the angles.
    turns = -potentials
    angles = 2 * np.pi * (turns - np.floor(turns))
    angles[~operators.used] = np.nan
    return CircularCoordinates(
        angles=angles,
        forms=forms,
        cocycles=cocycles,
        edges=operators.faces(1),
        energies=np.einsum("eb,eb->b", forms, star @ forms),
    )


def _potentials(operators: Operators, forms: NDArray[Any]) -> Floats:
    """Functions whose differences are nearest to 1-forms."""
    step = operators.derivative(0)
    load = step.T @ (operators.star(1) @ forms.astype(np.float64))
    none = np.empty(0, dtype=np.int64)
    return solve_stiffness(operators, load, none, np.empty((0, load.shape[1])))


def integer_cocycles(operators: Operators) -> Integers:
    """A basis of the first cohomology over the integers, (E, B); zero on a tree.

    Edges of a spanning forest have zero. Wherever a triangle has one edge that is not
    known, the others determine it; where there is no such triangle an edge becomes a
    new unknown. What triangles then demand of the few unknowns is solved by whole
    numbers.
    """
    edges = operators.faces(1)
    known = _forest(operators, edges)
    values: list[dict[int, int] | None] = [{} if own else None for own in known]
    number = 0
    if operators.dim == 1:
        for edge in np.flatnonzero(~known).tolist():
            values[edge] = {number: 1}
            number += 1
        relations = np.zeros((0, number), dtype=np.int64)
        return np.asarray(_table(values, number) @ _integer_kernel(relations))
    derivative = operators.derivative(1)
    sides = derivative.indices.reshape(-1, 3)
    signs = derivative.data.reshape(-1, 3).tolist()
    unknown = (~known[sides]).sum(axis=1)
    around = derivative.tocsc()
    starts, triangles = around.indptr.tolist(), around.indices.tolist()
    sides = sides.tolist()
    left = unknown.tolist()
    ready = deque(np.flatnonzero(unknown == 1).tolist())
    following = 0
    while True:
        edge = -1
        while ready and edge < 0:
            triangle = ready.popleft()
            if left[triangle] == 1:
                edge, value = _third(triangle, sides[triangle], signs[triangle], values)
        if edge < 0:
            while following < len(values) and values[following] is not None:
                following += 1
            if following == len(values):
                break
            edge, value = following, {number: 1}
            number += 1
        values[edge] = value
        for triangle in triangles[starts[edge] : starts[edge + 1]]:
            left[triangle] -= 1
            if left[triangle] == 1:
                ready.append(triangle)
    table = _table(values, number)
    demands = derivative.astype(np.int64) @ table
    relations = np.unique(demands[demands.any(axis=1)], axis=0)
    return np.asarray(table @ _integer_kernel(relations))


def _third(
    triangle: int,
    sides: list[int],
    signs: list[int],
    values: list[dict[int, int] | None],
) -> tuple[int, dict[int, int]]:
    """The edge of a triangle that is not known, and what the others make of it."""
    total: dict[int, int] = {}
    edge, sign = -1, 0
    for side, own in zip(sides, signs, strict=True):
        value = values[side]
        if value is None:
            edge, sign = side, own
            continue
        for key, amount in value.items():
            total[key] = total.get(key, 0) + own * amount
    assert edge >= 0, triangle
    return edge, {key: -sign * amount for key, amount in total.items() if amount}


def _forest(operators: Operators, edges: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Edges of a spanning forest, breadth first from the first vertex of each part."""
    sparse, csgraph = scipy_module("sparse"), scipy_module("sparse.csgraph")
    count = operators.count
    i, j = edges.T
    ones = np.ones(len(edges))
    graph = sparse.csr_array((ones, (i, j)), shape=(count, count))
    parents = np.full(count, -1)
    labels = operators.complex.component_labels()
    _, first = np.unique(labels, return_index=True)
    for root in first:
        if labels[root] < 0:
            continue
        _, above = csgraph.breadth_first_order(graph, int(root), directed=False)
        reached = above >= 0
        parents[reached] = above[reached]
    return np.asarray((parents[i] == j) | (parents[j] == i))


def _table(values: list[dict[int, int] | None], number: int) -> Integers:
    table = np.zeros((len(values), number), dtype=np.int64)
    for row, value in enumerate(values):
        for key, amount in (value or {}).items():
            table[row, key] = amount
    return table


def _integer_kernel(relations: Integers) -> Integers:
    """Basis of the whole numbers that fulfil all relations, as columns.

    By Euclid's algorithm on the columns, with integers of any size.
    """
    number = relations.shape[1]
    columns = [
        [int(x) for x in column] + [int(k == i) for k in range(number)]
        for i, column in enumerate(relations.T)
    ]
    rows = len(relations)
    for row in range(rows):
        while True:
            having = [c for c in columns if c[row]]
            if len(having) < 2:
                break
            least = min(having, key=lambda c: abs(c[row]))
            for column in having:
                if column is least:
                    continue
                times = column[row] // least[row]
                column[:] = [a - times * b for a, b in zip(column, least, strict=True)]
        columns = [c for c in columns if not c[row]]
    kernel = np.array([c[rows:] for c in columns], dtype=np.int64)
    return np.asarray(kernel.reshape(len(columns), number).T)


def _reduced(products: Floats) -> Integers:
    """Change to a basis of shorter vectors, shortest first: none shortens another."""
    size = len(products)
    change = np.eye(size, dtype=np.int64)
    gram = products.copy()
    moved = True
    while moved:
        moved = False
        for i in range(size):
            for j in range(size):
                times = int(np.rint(gram[i, j] / gram[j, j])) if i != j else 0
                # Ties of one half would go on forever.
                if times == 0 or abs(gram[i, j]) <= gram[j, j] * (0.5 + 1e-9):
                    continue
                change[:, i] -= times * change[:, j]
                gram = change.T @ products @ change
                moved = True
    order = np.argsort(np.diagonal(gram), kind="stable")
    return np.asarray(change[:, order])


def harmonic_forms(operators: Operators, degree: int) -> Floats:
    """Orthonormal basis of harmonic forms; see `Calculus.harmonic_forms`."""
    star = operators.star(degree)
    if degree == 0:
        labels, used = operators.labels, operators.used
        count = int(labels.max(initial=-1)) + 1
        return np.where(used[:, None], labels[:, None] == np.arange(count), 0.0) / (
            np.sqrt(np.bincount(labels[used], operators.volumes[used], count))
        )
    if degree == 1:
        cocycles = integer_cocycles(operators)
        forms = cocycles - operators.derivative(0) @ _potentials(operators, cocycles)
        return _orthonormal(forms, star)
    topology = operators.complex.topology()
    most = min(topology.betti_numbers[degree], topology.betti_numbers_mod3[degree])
    have = np.flatnonzero(star.diagonal() > 0)
    wanted = min(most, len(have) - 1)
    if wanted == 0:
        return np.zeros((len(operators.faces(degree)), 0))
    # Any positive weight in place of the inverse star leaves the kernel as it is.
    sparse = scipy_module("sparse")
    step = operators.derivative(degree - 1).astype(np.float64)
    weights = operators.star(degree - 1).diagonal()
    inverse = np.divide(1.0, weights, out=np.zeros_like(weights), where=weights > 0)
    half = star @ step
    matrix = half @ sparse.csr_array(sparse.diags(inverse)) @ half.T
    if degree < operators.dim:
        up = operators.derivative(degree).astype(np.float64)
        matrix = matrix + up.T @ operators.star(degree + 1) @ up
    matrix, mass = matrix[have][:, have], star[have][:, have]
    scale = float(operators.elements.volumes.sum()) ** (-2 / operators.dim)
    if len(have) <= 300:
        values, vectors = scipy_module("linalg").eigh(
            matrix.toarray(), mass.toarray(), subset_by_index=(0, wanted - 1)
        )
    else:
        linalg = scipy_module("sparse.linalg")
        solve = factorized(matrix + scale * mass)
        values, vectors = linalg.eigsh(
            matrix,
            k=wanted,
            M=mass,
            sigma=-scale,
            OPinv=linalg.LinearOperator(matrix.shape, matvec=solve, dtype=np.float64),
            v0=np.random.default_rng(0).normal(size=len(have)),
        )
    vectors = vectors[:, np.abs(values) < _ZERO * scale]
    forms = np.zeros((len(operators.faces(degree)), vectors.shape[1]))
    forms[have] = vectors
    return _orthonormal(forms, star)


def _orthonormal(forms: Floats, star: Any) -> Floats:
    if forms.shape[1] == 0:
        return forms
    factor = np.linalg.cholesky(forms.T @ (star @ forms))
    found = np.linalg.solve(factor, forms.T).T
    return np.asarray(found * fixed_signs(found))
