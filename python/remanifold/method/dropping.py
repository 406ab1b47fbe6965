# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples that are no points, such as the pixels of a depth camera that saw nothing.

The core gets the others; what it returns is numbered as the caller's samples are.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold import _core
from remanifold._base.validation import check_choice, float_rows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.samples import Input

INVALID = ("raise", "drop")
# Arrays of the core that hold numbers of samples, -1 for none.
NUMBERS = frozenset(
    (
        *("simplices", "edges", "edge_set_indices", "star_simplices"),
        *("tangent_simplices", "representatives", "outliers", "singular_vertices"),
        *("disputed_simplices", "filled_simplices", "open_faces", "callous_faces"),
        *(
            "inserted_vertices",
            "cut_vertices",
            "unused_vertices",
            "attached",
            "samples",
        ),
    )
)
# Those with a row for each sample, and what it is for one that was left out.
ROWS = {
    "tangents": np.nan,
    "boundary": False,
    "tangent_simplices": -1,
    "representatives": -1,
    "unbounded": False,
    "displacements": 0.0,
}
# Where the rows of each sample begin in another array.
OFFSETS = frozenset(("edge_set_offsets", "star_offsets"))


def finite_rows(
    points: ArrayLike, invalid: str
) -> tuple[NDArray[Any], NDArray[np.int64] | None]:
    """Samples as numbers, and which of them are points; None for all."""
    check_choice(invalid, "invalid", INVALID)
    array = float_rows(points, "points")
    if array.ndim != 2 or not array.size:
        return array, None  # for others to refuse
    finite = np.isfinite(array).all(axis=1)
    if finite.all():
        return array, None
    rows = np.flatnonzero(finite)
    if len(rows) == 0:
        msg = f"points has {len(array)} rows and none of finite numbers"
        raise ValueError(msg)
    return array, rows


def number_as_given(
    result: dict[str, Any], given: Input, rows: NDArray[np.int64], count: int
) -> None:
    """Turn a result for some of the samples into one for all, in place."""
    frames = result.get("tangents")
    if isinstance(frames, tuple):
        # Coefficients of neighbors, by their old numbers.
        result["tangents"] = _core.tangent_bases(
            given.matrix, *frames, num_threads=0, progress=None
        )
    parts = (result, result.get("repair", {}), result["cleaning"])
    for part in (*parts, *result.get("openings", ())):
        for name, array in part.items():
            if isinstance(array, np.ndarray):
                part[name] = _as_given(name, array, rows, count)
    # A sample that was left out is like no other.
    alone = result["representatives"] < 0
    result["representatives"][alone] = np.flatnonzero(alone)


def _as_given(
    name: str, array: NDArray[Any], rows: NDArray[np.int64], count: int
) -> NDArray[Any]:
    if name in NUMBERS:
        numbers = np.append(rows, -1).astype(np.int32)  # -1 stays
        array = numbers[array]
    if name in ROWS and len(array):
        return filled(array, rows, count, ROWS[name])
    if name in OFFSETS:
        sizes = np.zeros(count, dtype=array.dtype)
        sizes[rows] = np.diff(array)
        return np.concatenate([np.zeros(1, dtype=array.dtype), np.cumsum(sizes)])
    return array


def filled(
    array: NDArray[Any], rows: NDArray[np.int64], count: int, nothing: Any
) -> NDArray[Any]:
    """Rows in their places among so many, the others holding nothing."""
    whole = np.full((count, *array.shape[1:]), nothing, dtype=array.dtype)
    whole[rows] = array
    return whole
