# SPDX-License-Identifier: GPL-3.0-or-later
"""What can be chosen about a reconstruction, checked once and for all."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args

import numpy as np

from remanifold import _core
from remanifold._base.samples import Points
from remanifold._base.validation import (
    check_boundary,
    check_choice,
    check_int,
    check_num_neighbors,
    check_outliers,
    check_positive,
    check_significance,
    check_smooth,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.samples import Input

Method: TypeAlias = Literal["manifold", "paper"]
Estimator: TypeAlias = Literal["enclosure", "pca", "jet"]
EdgeRule: TypeAlias = Literal["mutual", "either"]
ExactSearch: TypeAlias = Literal["auto", "kdtree", "brute_force"]
Search: TypeAlias = Literal["auto", "kdtree", "brute_force", "approximate"]

METHODS: tuple[str, ...] = get_args(Method)
EXACT_SEARCHES: tuple[str, ...] = get_args(ExactSearch)
# The words of the core; a test holds the types above against them.
ESTIMATORS = _core.ESTIMATORS
EDGE_RULES = _core.EDGE_RULES
SEARCHES = _core.SEARCHES
CHECKS = _core.CHECKS
SIGNIFICANCE = _core.SIGNIFICANCE
# What belongs to one method, and says so when it is given to the other.
_ONLY = {
    "boundary": "manifold",
    "hole_radius": "manifold",
    "significance": "manifold",
    "edges": "paper",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Options:
    """Parameters of `reconstruct` but for samples and dimension, as callers give them.

    Refuses what no samples could make right; `for_samples` does the rest.
    """

    method: Method = "manifold"
    boundary: Literal["auto", False] | ArrayLike = "auto"
    hole_radius: float | None = None
    significance: float | None = None
    outliers: Literal["auto", False] | float | None = None
    smooth: Literal["auto"] | bool | int | None = None
    num_neighbors: int | None = None
    estimator: Estimator | None = None
    edges: EdgeRule | None = None
    search: Search = "auto"
    checks: int = CHECKS

    def __post_init__(self) -> None:
        """Raise ValueError or TypeError, in words that begin with the parameter's name."""
        check_choice(self.method, "method", METHODS)
        if self.boundary is None or isinstance(self.boundary, (str, bool)):
            self.boundary_rule(0)
        for name, method in _ONLY.items():
            if method != self.method and self._is_given(name):
                msg = f'{name} is for method="{method}" only'
                raise ValueError(msg)
        check_choice(self.search, "search", SEARCHES)
        check_choice(self.tangent_estimator, "estimator", ESTIMATORS)
        check_choice(self.edge_rule, "edges", EDGE_RULES)
        check_int(self.checks, "checks", minimum=1)
        if self.hole_radius is not None:
            check_positive(self.hole_radius, "hole_radius")
        check_significance(self.chance)
        check_outliers(self.outliers_or_default)
        check_smooth(self.smooth)

    def _is_given(self, name: str) -> bool:
        value = getattr(self, name)
        return not (value is None or (isinstance(value, str) and value == "auto"))

    @property
    def is_paper(self) -> bool:
        """Whether the method is Freedman's."""
        return self.method == "paper"

    @property
    def tangent_estimator(self) -> str:
        """The estimator, given or not."""
        if self.estimator is not None:
            return self.estimator
        return "enclosure" if self.is_paper else "jet"

    @property
    def edge_rule(self) -> str:
        """The rule for edges, given or not."""
        return "mutual" if self.edges is None else self.edges

    @property
    def chance(self) -> float:
        """The significance, given or not."""
        return SIGNIFICANCE if self.significance is None else self.significance

    @property
    def outliers_or_default(self) -> Any:
        """`outliers`, given or not."""
        if self.outliers is not None:
            return self.outliers
        return False if self.is_paper else "auto"

    def smoothing_of(self, samples: Input) -> Literal["auto"] | bool | int:
        """`smooth`, given or not: by default nothing is moved that has no coordinates.

        Finding some (`classical_scaling`) costs more than the reconstruction.
        """
        if self.smooth is not None:
            return self.smooth
        return "auto" if isinstance(samples, Points) and not self.is_paper else False

    def neighbors(self, dim: int) -> int:
        """Neighbors for the tangent spaces of a K-manifold."""
        if self.num_neighbors is None:
            count = _core.paper_neighbors if self.is_paper else _core.jet_neighbors
            return count(dim)
        return check_num_neighbors(self.num_neighbors, dim)

    def check_dim(self, dim: int) -> None:
        """Refuse what does not go with this dimension."""
        self.neighbors(dim)
        check_smooth(self.smooth, dim)

    def boundary_rule(self, num_samples: int) -> tuple[str, NDArray[np.bool_]]:
        """The core's rule for the boundary, and flags where it is given."""
        return check_boundary(self.boundary, num_samples)

    def of_rows(self, rows: NDArray[np.int64] | None, num_samples: int) -> Options:
        """The same for some of so many samples."""
        rule, mask = self.boundary_rule(num_samples)
        if rows is None or rule != "given":
            return self
        return replace(self, boundary=mask[rows])

    def for_core(
        self,
        samples: Input,
        dim: int,
        decisions: Sequence[tuple[NDArray[np.int32], bool]] = (),
    ) -> _core.Options:
        """All of it in the words of the core."""
        rule, mask = self.boundary_rule(len(samples))
        smooth, neighbors, only_noise = check_smooth(self.smoothing_of(samples), dim)
        return _core.Options(
            dim=dim,
            # By default of the core: it knows how many samples there are without copies.
            num_neighbors=0 if self.num_neighbors is None else self.neighbors(dim),
            estimator=self.tangent_estimator,
            edges=self.edge_rule,
            boundary=rule,
            boundary_samples=mask,
            hole_radius=0.0 if self.hole_radius is None else float(self.hole_radius),
            significance=float(self.chance),
            outlier_distance=check_outliers(self.outliers_or_default),
            smooth=smooth,
            smoothing_neighbors=neighbors,
            only_noise=only_noise,
            search=self.search,
            checks=int(self.checks),
            decisions=decisions,
        )
