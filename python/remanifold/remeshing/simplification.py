# SPDX-License-Identifier: GPL-3.0-or-later
"""Fewer vertices and the same topology, by collapses of edges."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from remanifold import _core
from remanifold._base.progress import progress_callback
from remanifold._base.validation import check_int, check_positive, check_selection
from remanifold.complex.parts import Part, take

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.progress import Callback
    from remanifold.complex.data import ComplexData


_STAYS, _UNTOUCHED = 1, 2  # as the core has it


class Simplified(NamedTuple):
    """What is left, and what that costs; see `SimplifiedComplex`."""

    part: Part
    errors: NDArray[np.float64]
    reached: bool


def simplify(
    whole: ComplexData,
    num_vertices: int | None = None,
    max_error: float | None = None,
    *,
    keep: ArrayLike | None = None,
    even: bool = False,
    progress: bool | Callback | None = None,
) -> Simplified:
    """Fewer vertices, as `SimplicialComplex.simplify` describes it."""
    if num_vertices is None and max_error is None:
        msg = "give num_vertices or max_error, or both: where to stop"
        raise TypeError(msg)
    if whole.dim < 1 or len(whole.simplices) == 0:
        msg = (
            f"the complex has {len(whole.simplices)} simplices of dimension "
            f"{whole.dim}: there is no edge to collapse"
        )
        raise ValueError(msg)
    least = 0
    if num_vertices is not None:
        least = check_int(num_vertices, "num_vertices", minimum=whole.dim + 1)
    limit = np.inf if max_error is None else check_positive(max_error, "max_error")
    fixed = np.zeros(whole.num_vertices, dtype=np.uint8)
    if keep is not None:
        fixed[check_selection(keep, "keep", whole.num_vertices)] = _STAYS
    topology = whole.topology()
    fixed[topology.singular_vertices] = _UNTOUCHED
    used = np.zeros(whole.num_vertices, dtype=np.bool_)
    used[whole.simplices] = True
    with progress_callback(progress) as callback:
        simplices, errors = _core.simplify(
            np.where(used[:, None], whole.coordinates, 0.0),
            np.ascontiguousarray(whole.simplices),
            fixed,
            num_vertices=least,
            max_error=limit,
            even=bool(even),
            progress=callback,
        )
    errors[~used] = np.nan
    part = take(whole, simplices)
    reached = num_vertices is None or part.num_vertices <= least
    return Simplified(part, errors, reached)
