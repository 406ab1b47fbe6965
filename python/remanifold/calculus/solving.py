# SPDX-License-Identifier: GPL-3.0-or-later
"""Sparse symmetric systems, by Eigen or SciPy."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from remanifold import _core
from remanifold._base.optional import load

if TYPE_CHECKING:
    from numpy.typing import NDArray

Solver: TypeAlias = Callable[["NDArray[np.float64]"], "NDArray[np.float64]"]
EXTRA = "calculus"
# A row, in the mean: a vertex of a surface has six neighbors.
_FEW_ENTRIES = 8


def scipy_module(name: str) -> Any:
    """A module of SciPy, or an error that says how to install it."""
    return load(f"scipy.{name}", EXTRA)


def factorized(matrix: Any) -> Solver:
    """Solve by one factorization for any number of right hand sides.

    The matrix is symmetric and positive definite: no pivots are looked for, and the
    order of elimination is that of minimum degree. Systems of curves and surfaces are
    solved by Eigen, which takes half as long; those that fill up by SuperLU, whose
    supernodes pay there.
    """
    linalg = scipy_module("sparse.linalg")
    columns = matrix.tocsc()
    if columns.shape[0] == 0:
        return lambda right: right.copy()
    if columns.nnz <= _FEW_ENTRIES * columns.shape[0]:
        columns.sum_duplicates()
        return by_columns(
            _core.SparseFactors(
                columns.indptr.astype(np.int32),
                columns.indices.astype(np.int32),
                columns.data.astype(np.float64),
            ).solve
        )
    factors = linalg.splu(
        columns,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )

    # One by one: SuperLU takes ten times as long for many at once.
    return by_columns(factors.solve)


def by_columns(solve: Solver) -> Solver:
    """Solve for each column of the right hand sides what `solve` does for one."""

    def solve_all(right: NDArray[np.float64]) -> NDArray[np.float64]:
        if right.ndim == 1:
            return np.asarray(solve(np.ascontiguousarray(right)))
        found = np.empty(right.shape)
        for i, column in enumerate(right.T):
            found[:, i] = solve(np.ascontiguousarray(column))
        return found

    return solve_all
