# SPDX-License-Identifier: GPL-3.0-or-later
"""A reconstruction that knows how far to trust it."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold.judging.answer import answer_of
from remanifold.judging.quality import Quality, assess
from remanifold.method.result import ReconstructionData

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.judging.answer import Answer

_JUDGED_AT_ONCE = 60_000  # coordinates or products

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

        Takes up to as long as the reconstruction.
        """
        return assess(self)

    @property
    def answer(self) -> str:
        """What the result is and whether to trust it, in one sentence.

        Such as "a closed surface of genus 1 (a torus), right as far as can be told". It
        needs `quality`.
        """
        return self._answer(judged=True).text

    def _answer(self, *, judged: bool) -> Answer:
        quality = self.quality if judged else None
        return answer_of(self.topology(), self.repair, quality)

    @property
    def _is_judged_at_once(self) -> bool:
        """Whether `quality` is known, or takes a second at most."""
        return "quality" in vars(self) or self._source.matrix.size <= _JUDGED_AT_ONCE

    def fields(self, *, quality: bool | None = None) -> dict[str, NDArray[Any]]:
        """Values at the vertices, by their names, as files and viewers take them.

        Parameters
        ----------
        quality : bool, optional
            With the arrays of `quality`: by default if it has been computed already.

        Returns
        -------
        dict of str to ndarray
            Arrays of shape (N,). `vertex_attributes`; always ``boundary`` and
            ``outlier``, where samples are `invalid` that too; with `quality`
            ``spacing``, ``curvature``, ``reach``, ``sampling_ratio``,
            ``tangent_confidence``, ``disputed``, ``fold``, ``gap`` and ``doubtful``.
        """
        outlier = np.zeros(self.num_samples, dtype=np.bool_)
        outlier[self.outliers] = True
        # What is known now takes the place of what a file knew of an older result.
        fields: dict[str, NDArray[Any]] = {
            **self.vertex_attributes,
            "boundary": self.boundary,
            "outlier": outlier,
        }
        if quality is None:
            quality = "quality" in vars(self)
        if quality:
            fields |= {name: getattr(self.quality, name) for name in QUALITY_FIELDS}
        return fields
