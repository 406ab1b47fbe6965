# SPDX-License-Identifier: GPL-3.0-or-later
"""Poisson's equation on a complex, solved in each component."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line
from remanifold.calculus.solving import factorized

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.calculus.operators import Operators

    Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class PoissonSolution(ReadOnlyArrays):
    """A function whose Laplacian was given. Arrays are read-only.

    Attributes
    ----------
    values : ndarray, shape (N,) or (N, C), float64
        The function at the vertices; NaN at `Calculus.missing_vertices`.
    imbalance : ndarray, shape (P,) or (P, C), float64
        For each of the P components the mean of the source that had to be taken off,
        since the Laplacian of a function that is fixed nowhere has mean zero. Zero in
        components with fixed vertices.
    """

    values: Floats
    imbalance: Floats

    def __repr__(self) -> str:
        return one_line(self, vertices=len(self.values), components=len(self.imbalance))


def solve_poisson(
    operators: Operators,
    source: Floats,
    fixed: NDArray[np.int64],
    fixed_values: Floats,
) -> PoissonSolution:
    """Solve Laplacian u = source weakly; see `Calculus.poisson`."""
    labels, used = operators.labels, operators.used
    shape = source.shape
    right = source.reshape(shape[0], -1)
    free = free_components(operators, fixed)
    own = np.where(used[:, None], right, 0.0)
    load = -(operators.mass @ own)
    sizes = per_component(operators, operators.volumes[:, None])
    imbalance = per_component(operators, -load) / sizes
    imbalance[~free] = 0.0
    load[used] += operators.volumes[used, None] * imbalance[labels[used]]
    boundary = fixed_values.reshape(len(fixed), right.shape[1])
    values = solve_stiffness(operators, load, fixed, boundary)
    means = per_component(operators, operators.volumes[:, None] * values) / sizes
    means[~free] = 0.0
    values[used] -= means[labels[used]]
    values[~used] = np.nan
    return PoissonSolution(
        values.reshape(shape), imbalance.reshape(len(free), *shape[1:])
    )


def free_components(
    operators: Operators, fixed: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Components without fixed vertices."""
    labels = operators.labels
    free = np.ones(int(labels.max(initial=-1)) + 1, dtype=np.bool_)
    free[labels[fixed]] = False
    return free


def solve_stiffness(
    operators: Operators,
    load: Floats,
    fixed: NDArray[np.int64],
    fixed_values: Floats,
) -> Floats:
    """Solve with the stiffness matrix, (N, C); zero at missing vertices.

    Where a component has no fixed vertices its first one has zero: the load of such a
    component adds up to zero.
    """
    labels, used = operators.labels, operators.used
    free = free_components(operators, fixed)
    values = np.zeros(load.shape)
    values[fixed] = fixed_values
    inner = used.copy()
    inner[fixed] = False
    first = np.full(len(free), -1)
    order = np.flatnonzero(used)[::-1]
    first[labels[order]] = order
    inner[first[free]] = False
    stiffness = operators.stiffness
    rest = (load - stiffness @ values)[inner]
    values[inner] = factorized(stiffness[inner][:, inner])(rest)
    return values


def per_component(operators: Operators, values: Floats) -> Floats:
    """Sums over the vertices of each component, (P, C)."""
    labels, used = operators.labels, operators.used
    count = int(labels.max(initial=-1)) + 1
    columns = [
        np.bincount(labels[used], column[used], minlength=count) for column in values.T
    ]
    return np.asarray(np.array(columns).reshape(values.shape[1], count).T)
