# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of samples and result when they are judged, and the limits of signs."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold._base.samples import Input
    from remanifold.complex.topology import Topology
    from remanifold.method.openings import Opening
    from remanifold.method.result import ReconstructionData, Repair


SURE = 0.1  # of the significance, below which an opening is beyond doubt


@dataclass(frozen=True)
class _Limits:
    """Where a sign is strong, and from where on it is a weak one (`some_...`).

    Measured on half of the runs of ``benchmarks/critical_sampling.py``.
    """

    # Samples at folds wider than so many degrees, plus so many a unit of noise.
    folded: int
    fold: float
    some_folded: int
    some_fold: float
    fold_by_noise: float
    # Samples so near, in spacings, to others that are far along the result.
    near: int
    distance: float
    some_distance: float
    # Share of disputed simplices.
    disputed: float
    some_disputed: float
    # Openings narrower than so many times hole_radius.
    opening: float
    some_opening: float
    # Balls that large expected among as many samples at random: powers of ten.
    gap: float
    some_gap: float
    # Spacing over reach at 5 % of the samples, tangent confidence at 5 %, and scatter
    # about the fits over the spacing, which for curves takes the place of the first.
    some_ratio: float
    some_confidence: float
    scatter: float = math.inf
    some_scatter: float = math.inf


_CURVES = _Limits(
    folded=2,
    fold=160,
    some_folded=1,
    some_fold=90,
    fold_by_noise=600,
    near=1,
    distance=0.4,
    some_distance=0.7,
    disputed=0.4,
    some_disputed=0.6,
    opening=0,
    some_opening=0,
    gap=-4,
    some_gap=-2,
    some_ratio=2.45,
    some_confidence=0.4,
    scatter=0.4,
    some_scatter=0.3,
)
_SURFACES = _Limits(
    folded=4,
    fold=130,
    some_folded=3,
    some_fold=115,
    fold_by_noise=500,
    near=2,
    distance=0.85,
    some_distance=1.0,
    disputed=0.8,
    some_disputed=0.75,
    opening=1.0,
    some_opening=1.0,
    gap=-2.3,
    some_gap=-0.7,
    some_ratio=2.0,
    some_confidence=0.3,
)
_THREE = _Limits(
    folded=6,
    fold=140,
    some_folded=4,
    some_fold=120,
    fold_by_noise=500,
    near=2,
    distance=0.85,
    some_distance=1.0,
    disputed=0.9,
    some_disputed=0.85,
    opening=0.3,
    some_opening=0.5,
    gap=-2.3,
    some_gap=-1,
    some_ratio=2.25,
    some_confidence=0.25,
)
_MORE = _Limits(
    folded=8,
    fold=160,
    some_folded=6,
    some_fold=150,
    fold_by_noise=500,
    near=2,
    distance=0.85,
    some_distance=1.0,
    disputed=0.97,
    some_disputed=0.92,
    opening=0.2,
    some_opening=0.3,
    gap=-2.3,
    some_gap=-1,
    some_ratio=2.25,
    some_confidence=0.25,
)
_LIMITS = {1: _CURVES, 2: _SURFACES, 3: _THREE}


@dataclass
class Findings:
    """What is known about the samples and the result."""

    rec: ReconstructionData
    dim: int
    ambient_dim: int | None
    samples: Input
    num_samples: int  # without copies
    num_simplices: int
    simplices: NDArray[np.int32]
    repair: Repair
    openings: tuple[Opening, ...]
    significance: float
    own: NDArray[np.bool_]  # not a copy
    spacing: NDArray[np.float64]
    reach: NDArray[np.float64]
    ratio: NDArray[np.float64]
    confidence: NDArray[np.float64]
    fold: NDArray[np.float64]
    gap: NDArray[np.float64]
    strange: NDArray[np.float64]  # distance to the nearest far along the result
    disputed: NDArray[np.float64]
    noise: float
    limits: _Limits = field(init=False)

    def __post_init__(self) -> None:
        self.limits = _LIMITS.get(self.dim, _MORE)

    @property
    def topology(self) -> Topology:
        """Computed when first asked for: most first looks do without."""
        return self.rec.topology()

    @functools.cached_property
    def rows(self) -> NDArray[np.int32]:
        """The simplices, the vertices of each ascending."""
        return np.sort(self.simplices, axis=1)

    @functools.cached_property
    def on_rim(self) -> NDArray[np.bool_]:
        """Samples of open faces."""
        marked = np.zeros(len(self.own), dtype=bool)
        marked[self.repair.open_faces] = True
        return marked

    def where(self, mask: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Marked samples, each in the name of its copies."""
        return np.flatnonzero(mask & self.own)

    def is_sure(self, opening: Opening) -> bool:
        """Whether an opening is far from being closed."""
        return opening.significance <= SURE * self.significance

    def quantile(self, values: NDArray[np.float64], q: float) -> float:
        """Of the values that are known; NaN where there are none."""
        known = values[self.own & np.isfinite(values)]
        return float(np.quantile(known, q)) if len(known) else math.nan


class Sign(NamedTuple):
    """Something that casts doubt on the result; a weak one alone makes no verdict."""

    strong: bool
    text: str
    samples: NDArray[np.int64]
    growth: float = math.nan  # of the number of samples that would remove it
    kind: Literal["sampling", "noise", "singular"] = "sampling"
