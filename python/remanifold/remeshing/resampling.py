# SPDX-License-Identifier: GPL-3.0-or-later
"""Other vertices on the same manifold, as evenly as can be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from remanifold._base.validation import check_int
from remanifold.complex.data import ComplexData
from remanifold.remeshing.simplification import Simplified, simplify
from remanifold.remeshing.subdivision import subdivide

if TYPE_CHECKING:
    from remanifold._base.progress import Callback

# Vertices to choose from, for each that is wanted: of four in a square of the spacing one
# is near enough to where it would be best.
_TO_CHOOSE_FROM = 4


def resample(
    whole: ComplexData, num_vertices: int, progress: bool | Callback | None = None
) -> Simplified:
    """Cut as often as it takes, then the shortest edges collapsed."""
    wanted = check_int(num_vertices, "num_vertices", minimum=whole.dim + 1)
    if whole.dim < 1 or len(whole.simplices) == 0:
        msg = f"the complex has {len(whole.simplices)} simplices: nothing to resample"
        raise ValueError(msg)
    most = int(np.iinfo(np.int32).max)
    if _TO_CHOOSE_FROM * wanted > most:
        msg = (
            f"num_vertices is {wanted}, expected at most {most // _TO_CHOOSE_FROM}: "
            f"{_TO_CHOOSE_FROM} times as many are made to choose from"
        )
        raise ValueError(msg)
    dense = ComplexData(whole.coordinates, whole.simplices)
    while len(np.unique(dense.simplices)) < _TO_CHOOSE_FROM * wanted:
        finer = subdivide(dense, fitted=True)
        dense = ComplexData(finer.vertices, finer.simplices)
    return simplify(dense, wanted, even=True, progress=progress)
