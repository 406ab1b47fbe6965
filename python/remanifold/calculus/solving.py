# SPDX-License-Identifier: GPL-3.0-or-later
"""Sparse symmetric systems, by SciPy."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from remanifold._base.optional import load

if TYPE_CHECKING:
    from numpy.typing import NDArray

Solver: TypeAlias = Callable[["NDArray[np.float64]"], "NDArray[np.float64]"]
EXTRA = "calculus"


def scipy_module(name: str) -> Any:
    """A module of SciPy, or an error that says how to install it."""
    return load(f"scipy.{name}", EXTRA)


def factorized(matrix: Any) -> Solver:
    """Solve by one factorization for any number of right hand sides.

    The matrix is symmetric and positive definite: no pivots are looked for, and the
    order of elimination is that of minimum degree.
    """
    linalg = scipy_module("sparse.linalg")
    if matrix.shape[0] == 0:
        return lambda right: right.copy()
    factors = linalg.splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )

    def solve(right: NDArray[np.float64]) -> NDArray[np.float64]:
        if right.ndim == 1:
            return np.asarray(factors.solve(right))
        # One by one: SuperLU takes ten times as long for many at once.
        found = np.empty(right.shape)
        for i, column in enumerate(right.T):
            found[:, i] = factors.solve(np.ascontiguousarray(column))
        return found

    return solve
