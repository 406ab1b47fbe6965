# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear and integer programs of the core, solved by HiGHS.

Q. Huangfu and J. A. J. Hall, Parallelizing the dual revised simplex method,
Mathematical Programming Computation 10, 2018; MIT licence.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Counted, not timed: the same input gives the same result on any machine.
MAX_NODES = 200
# Between looks at whether to go on: some tenths of a second of the largest programs. A
# call back from each iteration took a tenth of the time.
SLICE = 5000


def solve_program(
    costs: NDArray[np.float64],
    upper: NDArray[np.float64],
    integral: NDArray[np.uint8],
    row_lower: NDArray[np.float64],
    row_upper: NDArray[np.float64],
    offsets: NDArray[np.int64],
    columns: NDArray[np.int32],
    values: NDArray[np.float64],
    cancelled: Callable[[], bool],
) -> NDArray[np.float64]:
    """Minimise costs @ x where row_lower <= A x <= row_upper and 0 <= x <= upper.

    Parameters
    ----------
    costs, upper : ndarray, shape (n,), float64
        Of each column.
    integral : ndarray, shape (n,) or (0,), uint8
        Columns that must be integers.
    row_lower, row_upper : ndarray, shape (m,), float64
        May be infinite.
    offsets, columns, values : ndarray
        A by rows, compressed.
    cancelled : callable
        Looked at now and then; the solver stops when it returns true.

    Returns
    -------
    ndarray, shape (n,) or (0,), float64
        Nothing where no solution was found within `MAX_NODES` nodes.

    Raises
    ------
    MemoryError
        Memory ran out within the solver.
    """
    import highspy  # most results ask for no program, and it takes its time

    # Presolving a linear program takes longer here than it saves, and cannot be interrupted.
    presolve = "choose" if len(integral) else "off"
    kind = highspy.HighsVarType
    kinds = np.full(len(costs), int(kind.kContinuous), dtype=np.int32)
    if len(integral):
        kinds[integral != 0] = int(kind.kInteger)
    solver = _silent_solver(highspy)
    solver.setOptionValue("threads", 1)
    solver.setOptionValue("presolve", presolve)
    solver.setOptionValue("mip_max_nodes", MAX_NODES)
    solver.setOptionValue("mip_rel_gap", 1e-9)
    # These take a quarter each of the time of small programs and find nothing that they
    # need; older versions know neither them nor the options.
    solver.setOptionValue("mip_heuristic_run_feasibility_jump", False)
    solver.setOptionValue("mip_heuristic_run_root_reduced_cost", False)

    if len(integral):
        _stop_when(cancelled, solver, highspy)
    else:
        solver.setOptionValue("simplex_iteration_limit", SLICE)
    # As arrays: into an `HighsLp` each of their entries would go as an object of Python.
    solver.passModel(
        len(costs),
        len(row_lower),
        len(values),
        int(highspy.MatrixFormat.kRowwise),
        int(highspy.ObjSense.kMinimize),
        0.0,
        costs,
        np.zeros(len(costs)),
        upper,
        row_lower,
        row_upper,
        offsets.astype(np.int32),
        columns,
        values,
        kinds,
    )
    solver.run()
    more = highspy.HighsModelStatus.kIterationLimit
    while solver.getModelStatus() == more and not cancelled():
        solver.run()
    # The solver takes a failed allocation for the end of the search.
    if solver.getModelStatus() == highspy.HighsModelStatus.kMemoryLimit:
        msg = "no memory is left for a program"
        raise MemoryError(msg)
    if solver.getInfo().primal_solution_status != 2:  # feasible
        return np.empty(0)
    return np.array(solver.getSolution().col_value)


def _silent_solver(highspy: Any) -> Any:
    """Make a solver that has never been able to print.

    `highspy.Highs` hands its callbacks over as it is made, and HiGHS 1.16 greets on
    standard output at the first such call, before anybody can switch its output off. Its
    base class is the same solver without that.
    """
    solver = highspy._Highs()
    solver.setOptionValue("output_flag", False)
    return solver


def _stop_when(cancelled: Callable[[], bool], solver: Any, highspy: Any) -> None:
    def stop_if_cancelled(
        _kind: Any, _message: str, _out: Any, into: Any, _: Any
    ) -> None:
        if into is not None and cancelled():
            into.user_interrupt = True

    solver.setCallback(stop_if_cancelled, None)
    kinds = highspy.cb.HighsCallbackType
    for kind in (
        kinds.kCallbackSimplexInterrupt,
        kinds.kCallbackIpmInterrupt,
        kinds.kCallbackMipInterrupt,
    ):
        solver.startCallback(kind)
