# SPDX-License-Identifier: GPL-3.0-or-later
"""What was opened, or closed, and on what evidence."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from remanifold import _core
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line, rounded

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, repr=False)
class Opening(ReadOnlyArrays):
    """A place where samples may be missing, and what was decided there.

    Attributes
    ----------
    kind : {"gap", "hole", "joint", "part"}
        Samples are missing along a curve; in the middle or along a strip of a surface or
        solid; two ends do not continue each other; or a few samples are far from all
        others.
    decision : {"open", "closed", "left out"}
        Whether simplices go through it. "left out": the samples of the part are in no
        simplex.
    samples : ndarray of int32
        Those on its rim and inside, ascending.
    radius : float
        Of the ball of dimension K that is as large, in the units of the samples; half
        the length of a gap.
    spacing : float
        K-th root of the volume per sample around, in the units of the samples.
    missing : float
        Samples that the place would hold, at the density around, beyond those that it
        has.
    dispersion : float
        Variance of the volumes around over that among independent samples: below 1 where
        the samples lie evenly, above where unevenly. The evidence is divided by it.
    expected : float
        How many places with no less evidence are to be expected in the whole data by
        chance.
    significance : float
        The chance of one or more: with a `significance` of `reconstruct` from here on
        the place is open.
    hole_radius : float
        `hole_radius` of `reconstruct`, in local scales, up to which a round hole of this
        volume is open.
    given : bool
        Whether `Reconstruction.reopen` or `close` decided so.
    simplices : ndarray, shape (M, K+1), int32
        Those that go through it, or did before they were taken out.
    """

    kind: Literal["gap", "hole", "joint", "part"]
    decision: Literal["open", "closed", "left out"]
    samples: NDArray[np.int32]
    radius: float
    spacing: float
    missing: float
    dispersion: float
    expected: float
    significance: float
    hole_radius: float
    # Files of earlier versions have none of these.
    given: bool = False
    simplices: NDArray[np.int32] = field(
        default_factory=lambda: np.empty((0, 0), dtype=np.int32)
    )

    @property
    def flips_at(self) -> float:
        """The `significance` of `reconstruct` at which the decision becomes the other one.

        From there on the place is open, below it is closed. NaN where that does not
        decide: for joints, for parts and for what was given.
        """
        weighed = self.kind in ("gap", "hole") and not self.given
        return self.significance if weighed else math.nan

    def __repr__(self) -> str:
        return one_line(
            self,
            kind=self.kind,
            decision=self.decision,
            samples=len(self.samples),
            radius=rounded(self.radius),
            spacings=rounded(self.radius / self.spacing) if self.spacing else None,
            missing=rounded(self.missing),
            significance=rounded(self.significance),
        )


def openings_of(
    found: list[dict[str, Any]], dim: int, significance: float
) -> tuple[Opening, ...]:
    """Those that the core lists, the closest decisions first."""
    ball = math.pi ** (dim / 2) / math.gamma(dim / 2 + 1)
    openings = []
    for one in found:
        radius = (one["volume"] / ball) ** (1 / dim)
        # Samples in a ball whose radius is the local scale.
        scale = (_core.scale_neighbors(dim) / ball) ** (1 / dim) * one["spacing"]
        decision: Literal["open", "closed", "left out"]
        decision = "open" if one["open"] else "closed"
        if one["kind"] == "part":
            decision = "left out" if one["open"] else "closed"
        openings.append(
            Opening(
                kind=one["kind"],
                decision=decision,
                given=one["given"],
                samples=one["samples"],
                simplices=one["simplices"],
                radius=radius,
                spacing=one["spacing"],
                missing=one["missing"],
                dispersion=one["dispersion"],
                expected=one["expected"],
                significance=one["significance"],
                hole_radius=radius / scale if scale > 0 else math.inf,
            )
        )

    def margin(opening: Opening) -> float:
        least = 1e-300
        chance = max(opening.significance, least)
        return abs(math.log(chance / max(significance, least)))

    return tuple(sorted(openings, key=margin))
