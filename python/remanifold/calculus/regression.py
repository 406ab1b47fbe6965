# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth functions from values at some vertices, with the smoothness and the errors."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line, rounded
from remanifold._base.validation import check_selection
from remanifold.calculus.solving import Solver, by_columns, factorized, scipy_module

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold.calculus.operators import Operators

    Floats = NDArray[np.float64]

_PROBES = 32  # random vectors that estimate a trace; up to as many it is exact
_PER_DECADE = 1  # penalties that are tried, before the best is refined
_REFINEMENTS = 8  # steps of golden section: to 2 % of two decades
_BLOCK = 256  # right hand sides at a time
# By how much a constant function, which has no roughness, may come back changed: rounding
# then is a thousandth of the values, which is less than what they tell.
_STEADY = 1e-3


@dataclass(frozen=True, eq=False, repr=False)
class Regression(ReadOnlyArrays):
    """A smooth function near given values. Arrays are read-only.

    Attributes
    ----------
    values : ndarray, shape (N,) or (N, C), float64
        The function at all vertices; NaN at `Calculus.missing_vertices`.
    penalty : float
        Weight of the roughness beside the squared residuals; 0 where the values are met
        exactly.
    order : int
        Half the number of derivatives of which the roughness is made, see
        `Calculus.fit`.
    degrees_of_freedom : float
        Trace of the map from given values to those of the function, as if so many
        numbers had been fitted.
    noise : ndarray, shape () or (C,), float64
        Standard deviation of the given values about the function that this supposes.
    score : float
        Generalized cross-validation: an estimate of the mean squared error of a value
        that was left out, summed over columns. NaN where the values are met exactly,
        which it does not apply to.
    """

    values: Floats
    penalty: float
    order: int
    degrees_of_freedom: float
    noise: Floats
    score: float
    _solve: Solver | None  # not saved
    _places: NDArray[np.int64]  # row of each vertex in what is solved for, or -1
    _scale: Floats  # of the covariance

    def __repr__(self) -> str:
        return one_line(
            self,
            vertices=len(self.values),
            penalty=rounded(self.penalty),
            degrees_of_freedom=rounded(self.degrees_of_freedom),
        )

    def __getstate__(self) -> dict[str, Any]:
        """Factorizations cannot be saved."""
        return {**vars(self), "_solve": None}

    def standard_errors(self, vertices: ArrayLike | None = None) -> Floats:
        """Standard deviation of the function at vertices, given the values.

        Parameters
        ----------
        vertices : array_like of bool, shape (N,), or of int, shape (Q,), optional
            Where; all by default. Each takes the solution of one system.

        Returns
        -------
        ndarray, shape (Q,) or (Q, C), float64
            Of the function itself: a new measurement scatters by `noise` besides. NaN at
            `Calculus.missing_vertices`.

        Raises
        ------
        RuntimeError
            For a result that was saved and loaded: fit again.

        Notes
        -----
        The model: the function is a Gaussian process whose precision is the roughness,
        of any level on each component, and the values have independent normal noise.
        Then the function that was fitted is the mean, and this the standard deviation,
        with the scales of both estimated from the values (Wahba, 1983). Where the true
        function is not as rough everywhere the intervals are right on average over the
        vertices, not at each.

        References
        ----------
        G. Wahba, Bayesian "confidence intervals" for the cross-validated smoothing
        spline, Journal of the Royal Statistical Society B 45(1), 1983.
        """
        if self._solve is None:
            msg = (
                "this result was saved and loaded without its factorization: fit again"
            )
            raise RuntimeError(msg)
        count = len(self.values)
        chosen = (
            np.arange(count)
            if vertices is None
            else check_selection(vertices, "vertices", count)
        )
        places = self._places[chosen]
        free = np.flatnonzero(places >= 0)
        variance = np.zeros(len(chosen))
        size = int((self._places >= 0).sum())
        for start in range(0, len(free), _BLOCK):
            own = free[start : start + _BLOCK]
            units = np.zeros((size, len(own)))
            units[places[own], np.arange(len(own))] = 1.0
            found = self._solve(units)
            variance[own] = found[places[own], np.arange(len(own))]
        variance = np.sqrt(np.maximum(variance, 0.0))
        errors = np.multiply.outer(variance, self._scale)
        errors[np.isnan(self.values[chosen])] = np.nan
        return errors


def default_order(dim: int) -> int:
    """The least for which values at single points bound a function (Sobolev)."""
    return max(2, dim // 2 + 1)


def roughness(operators: Operators, used: NDArray[np.bool_], order: int) -> Any:
    """Integral of the squares of order-fold derivatives: S (M^-1 S)^(order - 1)."""
    sparse = scipy_module("sparse")
    stiffness = operators.stiffness[used][:, used]
    inverse = sparse.csr_array(sparse.diags(1 / operators.volumes[used]))
    matrix = stiffness
    for _ in range(order - 1):
        matrix = matrix @ inverse @ stiffness
    return ((matrix + matrix.T) / 2).tocsr()


def check_order(operators: Operators, order: int) -> None:
    """Refuse an order whose roughness has twice the digits of a number, and more.

    As many as its eigenvalues span; half of them is what the mixed system takes.
    """
    spanned = order * 2 / operators.dim * np.log10(max(int(operators.used.sum()), 1))
    if spanned > -2 * np.log10(np.finfo(np.float64).eps):
        raise ValueError(_too_high(order))


def _too_high(order: int) -> str:
    return (
        f"order is {order}: derivatives of that order are lost in rounding on these "
        "simplices; take a lower order, or fewer vertices"
    )


def _solver(
    operators: Operators,
    rough: Any,
    data: Floats,
    weight: float,
    order: int,
    lost: list[float],
) -> Solver | None:
    """Of data and weighted roughness; None where all is rounding.

    `lost` is the least weight at which the sum of both was: from there on it always is.

    The product of stiffness matrices squares, and more, what rounding does. Where that
    shows the factors are kept apart: u_0 is the function, u_k+1 = s M^-1 S u_k with
    s^order = weight, and data u_0 + s S u_last is the load.
    """
    sparse = scipy_module("sparse")
    if weight < lost[0]:
        solve = factorized(sparse.csr_array(sparse.diags(data)) + weight * rough)
        if _is_steady(solve, data):
            return solve
        lost[0] = weight
    if order == 1:
        return None
    used, size = operators.used, len(data)
    stiffness = weight ** (1 / order) * operators.stiffness[used][:, used]
    masses = sparse.diags(operators.volumes[used])
    rows: list[list[Any]] = [[None] * order for _ in range(order)]
    rows[0][0] = sparse.diags(data)
    rows[0][-1] = stiffness
    for k in range(1, order):
        rows[k][k - 1], rows[k][k] = stiffness, -masses
    factors = scipy_module("sparse.linalg").splu(sparse.block_array(rows).tocsc())

    @by_columns
    def solve_mixed(right: Floats) -> Floats:
        whole = np.concatenate([right, np.zeros((order - 1) * size)])
        return np.asarray(factors.solve(whole)[:size])

    return solve_mixed if _is_steady(solve_mixed, data) else None


def _is_steady(solve: Solver, data: Floats) -> bool:
    """Whether a right hand side of which the solution is one everywhere has that."""
    return bool(np.abs(solve(data) - 1).max(initial=0.0) <= _STEADY)


def fit_smooth(
    operators: Operators,
    vertices: NDArray[np.int64],
    values: Floats,
    weights: Floats,
    penalty: float | None,
    order: int,
) -> Regression:
    """Least squares with a penalty on roughness; see `Calculus.fit`."""
    used = operators.used
    places = np.full(len(used), -1, dtype=np.int64)
    places[used] = np.arange(used.sum())
    rough = roughness(operators, used, order)
    at = places[vertices]
    table = values.reshape(len(values), -1)
    root = np.sqrt(weights)[:, None]
    load = np.zeros((rough.shape[0], table.shape[1]))
    load[at] = weights[:, None] * table
    diagonal = np.zeros(len(load))
    diagonal[at] = weights
    probes = _probes(len(vertices))
    lost = [np.inf]

    def at_penalty(weight: float) -> tuple[float, float, Floats, Floats, Solver] | None:
        solve = _solver(operators, rough, diagonal, weight, order, lost)
        if solve is None:
            return None
        found = solve(load)
        residuals = root * (table - found[at])
        spread = np.zeros((len(load), probes.shape[1]))
        spread[at] = root * probes
        trace = float((probes * (root * solve(spread)[at])).sum())
        trace *= len(vertices) / (probes**2).sum()
        squares = (residuals**2).sum(axis=0)
        left = max(len(vertices) - trace, 1e-300)
        score = float(squares.sum()) * len(vertices) / left**2
        return score, trace, squares, found, solve

    @functools.cache
    def score_at(weight: float) -> float:
        found = at_penalty(weight)
        return np.inf if found is None else found[0]

    if penalty is None:
        penalty = _best_penalty(operators, len(vertices), weights, order, score_at)
    best = at_penalty(penalty)
    if best is None:
        raise ValueError(_too_high(order))
    score, trace, squares, found, solve = best
    noise = np.sqrt(squares / max(len(vertices) - trace, 1e-300))
    wide = np.full((len(used), load.shape[1]), np.nan)
    wide[used] = found
    shape = values.shape[1:]
    return Regression(
        wide.reshape(len(used), *shape),
        penalty,
        order,
        trace,
        noise.reshape(shape),
        score,
        solve,
        places,
        noise.reshape(shape),
    )


def _probes(count: int) -> Floats:
    """Vectors whose products estimate a trace: unit ones, or random signs."""
    if count <= _PROBES:
        return np.eye(count)
    return np.random.default_rng(0).choice([-1.0, 1.0], size=(count, _PROBES))


def _best_penalty(
    operators: Operators,
    observed: int,
    weights: Floats,
    order: int,
    score_at: Callable[[float], float],
) -> float:
    """Least score: by decades first, then by golden section.

    From where the smoothest functions are hardly damped to where the roughest that the
    vertices carry are hardly kept: eigenvalues lie between those of the whole and of a
    spacing.
    """
    volume = float(operators.volumes.sum())
    slowest = volume ** (-2 / operators.dim)
    fastest = slowest * operators.used.sum() ** (2 / operators.dim)
    density = observed * float(weights.mean()) / volume
    low = np.log10(density * (10 * fastest) ** -order) - 1
    high = np.log10(density * slowest**-order) + 2
    trials = np.linspace(low, high, int(np.ceil((high - low) * _PER_DECADE)) + 1)
    scores = [score_at(float(10**trial)) for trial in trials]
    best = int(np.argmin(scores))
    left = trials[max(best - 1, 0)]
    right = trials[min(best + 1, len(trials) - 1)]
    ratio = (np.sqrt(5) - 1) / 2
    a, b = right - ratio * (right - left), left + ratio * (right - left)
    for _ in range(_REFINEMENTS):
        if score_at(float(10**a)) <= score_at(float(10**b)):
            right, b = b, a
            a = right - ratio * (right - left)
        else:
            left, a = a, b
            b = left + ratio * (right - left)
    return float(10 ** ((left + right) / 2))


def fit_exactly(
    operators: Operators,
    vertices: NDArray[np.int64],
    values: Floats,
    order: int,
) -> Regression:
    """The smoothest function through values; see `Calculus.fit`."""
    used = operators.used
    rough = roughness(operators, used, order)
    places = np.full(len(used), -1, dtype=np.int64)
    places[used] = np.arange(used.sum())
    inner = np.ones(int(used.sum()), dtype=np.bool_)
    inner[places[vertices]] = False
    table = values.reshape(len(values), -1)
    found = np.zeros((len(inner), table.shape[1]))
    found[places[vertices]] = table
    solve = factorized(rough[inner][:, inner])
    found[inner] = solve(-(rough @ found)[inner])
    held = -(rough @ (~inner).astype(np.float64))[inner]
    if not _is_steady(solve, held):
        raise ValueError(_too_high(order))
    squares = np.einsum("nc,nc->c", found, rough @ found)
    components = int(operators.labels.max()) + 1
    # Without components that one value each determines nothing is left to scatter.
    scale = np.sqrt(np.maximum(squares, 0.0) / max(len(vertices) - components, 1))
    wide = np.full((len(used), table.shape[1]), np.nan)
    wide[used] = found
    own = np.full(len(used), -1, dtype=np.int64)
    own[np.flatnonzero(used)[inner]] = np.arange(inner.sum())
    shape = values.shape[1:]
    return Regression(
        wide.reshape(len(used), *shape),
        0.0,
        order,
        float(len(vertices)),
        np.zeros(shape),
        float("nan"),
        solve,
        own,
        scale.reshape(shape),
    )
