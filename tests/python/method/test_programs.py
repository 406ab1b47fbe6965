# SPDX-License-Identifier: GPL-3.0-or-later
"""The solver of the chain's programs, by itself."""

import numpy as np
import pytest
from scipy.optimize import LinearConstraint, milp
from scipy.sparse import csr_array

from remanifold.method import programs
from remanifold.method.programs import solve_program


def random_program(rows, columns, seed, integral=False):
    """A program with a known feasible point, as arguments of the solver."""
    rng = np.random.default_rng(seed)
    size = (rows, columns)
    matrix = csr_array(rng.uniform(size=size) * (rng.uniform(size=size) < 0.1))
    inside = rng.integers(0, 2, columns)
    low = matrix @ inside - rng.uniform(0, 0.2, rows)
    high = matrix @ inside + rng.uniform(0, 0.2, rows)
    low[::3] = -np.inf
    high[1::3] = np.inf
    return (
        rng.normal(size=columns),
        np.ones(columns),
        np.ones(columns if integral else 0, np.uint8),
        low,
        high,
        matrix.indptr.astype(np.int64),
        matrix.indices.astype(np.int32),
        matrix.data,
    )


def never():
    return False


@pytest.mark.parametrize("integral", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_solutions_are_optimal(seed, integral):
    program = random_program(15, 25, seed, integral)
    costs, upper, marks, low, high, offsets, columns, values = program
    matrix = csr_array((values, columns, offsets), shape=(15, 25))
    x = solve_program(*program, never)
    assert x.shape == costs.shape
    assert (matrix @ x >= low - 1e-6).all()
    assert (matrix @ x <= high + 1e-6).all()
    assert x.min() >= -1e-9
    assert (x <= upper + 1e-9).all()
    expected = milp(
        costs,
        integrality=marks if integral else None,
        bounds=(0, 1),
        constraints=LinearConstraint(matrix, low, high),
    )
    assert costs @ x == pytest.approx(expected.fun, rel=1e-6, abs=1e-6)
    if integral:
        np.testing.assert_allclose(x, np.round(x), atol=1e-6)


def test_nothing_where_there_is_no_solution():
    one = np.ones(1)
    contradiction = (one, one, np.zeros(0, np.uint8), 2 * one, 2 * one)
    row = (np.array([0, 1]), np.zeros(1, np.int32), one)
    assert solve_program(*contradiction, *row, never).shape == (0,)


@pytest.mark.parametrize(("rows", "integral"), [(300, False), (35, True)])
def test_cancelled_programs_end(rows, integral, monkeypatch):
    program = random_program(rows, 2 * rows, 0, integral)
    expected = solve_program(*program, never)
    monkeypatch.setattr(programs, "SLICE", 20)
    asked = []

    def after(number):
        def cancelled():
            asked.append(number)
            return asked.count(number) >= number

        return cancelled

    np.testing.assert_allclose(
        solve_program(*program, after(10**9)), expected, rtol=0, atol=1e-9
    )
    solve_program(*program, after(1))
    assert 1 <= asked.count(1) <= asked.count(10**9) / 5


def test_nothing_is_printed(capfd):
    solve_program(*random_program(15, 25, 0, integral=True), never)
    assert capfd.readouterr() == ("", "")
