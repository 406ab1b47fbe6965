# SPDX-License-Identifier: GPL-3.0-or-later
"""A reconstruction that knows how far to trust it."""

from __future__ import annotations

import functools
from dataclasses import dataclass

from remanifold.judging.quality import Quality, assess
from remanifold.method.result import ReconstructionData

# Those of `Quality` that have a value at each vertex.
QUALITY_FIELDS = (
    *("spacing", "curvature", "reach", "sampling_ratio", "tangent_confidence"),
    *("disputed", "fold", "gap", "doubtful"),
)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class JudgedReconstruction(ReconstructionData):
    """What is drawn and reported: the data of a `Reconstruction` and its quality."""

    @functools.cached_property
    def quality(self) -> Quality:
        """Whether and where the samples are dense enough for the result; computed once.

        Takes about as long as the reconstruction.
        """
        return assess(self)
