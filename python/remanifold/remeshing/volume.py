# SPDX-License-Identifier: GPL-3.0-or-later
"""The volume of the manifold that a complex stands for, and how far that may be off."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from remanifold.complex.data import ComplexData
from remanifold.complex.parts import open_faces
from remanifold.complex.projection import simplex_volumes
from remanifold.remeshing.subdivision import subdivide

if TYPE_CHECKING:
    from numpy.typing import NDArray


class VolumeEstimate(NamedTuple):
    """K-volume of a manifold by that of a complex.

    Attributes
    ----------
    value : float
        What the volume tends to as simplices become smaller.
    error : float
        How far it may be off: what the last step changed, and what samples at random miss
        at the boundary, half a spacing, at the ends of curves a whole one.
    """

    value: float
    error: float


def estimate_volume(whole: ComplexData) -> VolumeEstimate:
    """By halving the edges; see `SimplicialComplex.estimate_volume`."""
    flat = ComplexData(whole.coordinates, whole.simplices)
    once = float(simplex_volumes(flat).sum())
    if whole.dim == 0 or once == 0:
        return VolumeEstimate(once, 0.0)
    finer = subdivide(flat, fitted=True)
    twice = float(simplex_volumes(ComplexData(finer.vertices, finer.simplices)).sum())
    # Chords are too short by a share that falls with the square of the edges.
    step = (twice - once) / 3
    rim = _boundary(flat)
    spacing = (once / len(np.unique(whole.simplices))) ** (1 / whole.dim)
    return VolumeEstimate(twice + step, abs(step) + rim * spacing / min(whole.dim, 2))


def _boundary(flat: ComplexData) -> float:
    """Volume of the open faces; of a curve their number."""
    faces: NDArray[np.int32] = open_faces(flat.simplices)
    if flat.dim == 1 or len(faces) == 0:
        return float(len(faces))
    return float(simplex_volumes(ComplexData(flat.coordinates, faces)).sum())
