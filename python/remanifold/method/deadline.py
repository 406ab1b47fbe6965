# SPDX-License-Identifier: GPL-3.0-or-later
"""An end of the time that a reconstruction may take."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold.method.programs import solve_program

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold._base.progress import Callback

LAST_STEP = "complex"  # from there on there are simplices to return


class Deadline:
    """So many seconds from now.

    What is left to do in the last step when they are over is not searched for: cavities
    that need a program stay as the simplices around them leave them.

    Attributes
    ----------
    num_left : int
        Programs that were not solved for lack of time.
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._end = time.monotonic() + seconds
        self.num_left = 0

    def is_over(self) -> bool:
        """Whether there is no more time."""
        return time.monotonic() >= self._end

    def solve(self, *arguments: Any) -> NDArray[np.float64]:
        """`solve_program`, as long as there is time."""
        cancelled = arguments[-1]
        found = np.empty(0)
        if not self.is_over():
            program = (*arguments[:-1], lambda: cancelled() or self.is_over())
            found = solve_program(*program)
        # What a solver has when it is stopped may be far from the best.
        if self.is_over():
            self.num_left += 1
            return np.empty(0)
        return found

    def watch(self, callback: Callback | None) -> Callback:
        """The callback, and a `TimeoutError` when time is over before the last step."""

        def watching(step: str, done: int, total: int) -> None:
            if step != LAST_STEP and self.is_over():
                msg = (
                    f"max_seconds is {self.seconds:g}, which was over in the step "
                    f"{step!r}, before there was any simplex: give fewer samples, or "
                    "more time"
                )
                raise TimeoutError(msg)
            if callback is not None:
                callback(step, done, total)

        return watching
