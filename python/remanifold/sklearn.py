# SPDX-License-Identifier: GPL-3.0-or-later
"""A scikit-learn estimator: learn a manifold from samples, project others onto it."""

from __future__ import annotations

import functools
import math
import sys
import warnings
from typing import TYPE_CHECKING

import numpy as np

try:
    from sklearn.base import BaseEstimator, OneToOneFeatureMixin, TransformerMixin
    from sklearn.utils.validation import check_is_fitted, validate_data
except ImportError as error:
    _HINT = (
        f"{error}. remanifold.sklearn needs scikit-learn 1.6 or later: pip install "
        "remanifold[sklearn]"
    )
    raise ImportError(_HINT) from error

import remanifold._public  # noqa: F401  (results are pickled by their public names)
from remanifold._base.deprecated import renamed
from remanifold._base.validation import check_int, check_num_threads, check_samples
from remanifold.method.dimension import (
    LOW_CONFIDENCE,
    MIN_SAMPLES,
    estimate_dimension,
    low_confidence,
)
from remanifold.method.options import CHECKS, Options
from remanifold.results.reconstruct import reconstruct_samples
from remanifold.warnings import DimensionWarning, ManifoldWarning

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, Literal

    from numpy.typing import ArrayLike, NDArray

    from remanifold.complex.projection import Projection
    from remanifold.method.options import EdgeRule, Estimator, Method, Search
    from remanifold.results.reconstruction import Reconstruction

__all__ = ["ManifoldReconstruction"]

_NEAREST = 2.0**-24  # of the extent


_OLD_NAMES = {
    "n_components": "dim",
    "tangent_estimator": "estimator",
    "n_jobs": "num_threads",
}


def _with_old_names(init: Callable[..., None]) -> Callable[..., None]:
    """Let a constructor take old names, which are no parameters to scikit-learn."""

    @functools.wraps(init)
    def with_old_names(self: object, *args: Any, **given: Any) -> None:
        named = {**given, **dict(zip(("dim",), args, strict=False))}
        for old, new in _OLD_NAMES.items():
            if given.get(old) is not None:
                given[new] = renamed(old, given[old], new, named.get(new))
            given.pop(old, None)
        init(self, *args, **given)

    return with_old_names


def _is_auto(dim: object) -> bool:
    return isinstance(dim, str) and dim == "auto"


def _score_of_solid(rec: Reconstruction, mean_square: float) -> float:
    """Density constant inside and normal outside; the width of that is fitted."""
    volume = max(rec.volume(), sys.float_info.min)
    if mean_square == 0:
        return -math.log(volume)
    shell = rec.boundary_complex().volume() * math.sqrt(math.pi / 2)
    # Where the derivative by s vanishes: shell s^3 - shell m s - m volume = 0.
    roots = np.roots([shell, 0.0, -shell * mean_square, -mean_square * volume])
    width = float(roots.real.max())
    return -math.log(volume + shell * width) - mean_square / (2 * width**2)


class ManifoldReconstruction(OneToOneFeatureMixin, TransformerMixin, BaseEstimator):  # type: ignore[misc]
    """Reconstruct a manifold from its samples, and project points onto it.

    `transform` replaces each point by the nearest one of the reconstructed manifold, in
    the same coordinates: it takes away what leads off the manifold. The answer for one
    point does not depend on the others.

    Parameters
    ----------
    dim : int or "auto", default="auto"
        K, the dimension of the manifold. "auto" takes that of `estimate_dimension`,
        which needs ten samples, and where the samples span no simplices of that
        dimension, the largest below of which they do.
    method, boundary, hole_radius, significance, outliers, smooth, num_neighbors, \
    estimator, edges, search, checks, num_threads
        As in `remanifold.reconstruct`, with the same defaults.
    n_components, tangent_estimator, n_jobs
        Old names of `dim`, `estimator` and `num_threads`, deprecated.

    Attributes
    ----------
    reconstruction_ : Reconstruction
        The manifold.
    dim_ : int
        Its dimension; `n_components_` is the same.
    n_features_in_ : int
        D, the number of coordinates.
    feature_names_in_ : ndarray, shape (D,)
        Their names, where the samples had such.

    Examples
    --------
    >>> import remanifold as rm
    >>> from remanifold.sklearn import ManifoldReconstruction
    >>> samples = rm.datasets.circle(100, random_state=0)
    >>> model = ManifoldReconstruction(dim=1).fit(samples)
    >>> model.transform([[2.0, 0.0]]).round(2).tolist()
    [[1.0, 0.0]]
    """

    @_with_old_names
    def __init__(
        self,
        dim: int | Literal["auto"] = "auto",
        *,
        method: Method = "manifold",
        boundary: Literal["auto", False] | ArrayLike = "auto",
        hole_radius: float | None = None,
        significance: float | None = None,
        outliers: Literal["auto", False] | float | None = None,
        smooth: Literal["auto"] | bool | int | None = None,
        num_neighbors: int | None = None,
        estimator: Estimator | None = None,
        edges: EdgeRule | None = None,
        search: Search = "auto",
        checks: int = CHECKS,
        num_threads: int | None = None,
    ) -> None:
        self.dim = dim
        self.method = method
        self.boundary = boundary
        self.hole_radius = hole_radius
        self.significance = significance
        self.outliers = outliers
        self.smooth = smooth
        self.num_neighbors = num_neighbors
        self.estimator = estimator
        self.edges = edges
        self.search = search
        self.checks = checks
        self.num_threads = num_threads

    def fit(self, X: ArrayLike, y: object = None) -> ManifoldReconstruction:  # noqa: ARG002
        """Reconstruct the manifold.

        Parameters
        ----------
        X : array_like, shape (N, D)
            Samples.
        y : ignored

        Returns
        -------
        ManifoldReconstruction
            The estimator itself.

        Raises
        ------
        ValueError
            Too few samples, or none that span a simplex.
        """
        dim: Any = self.dim
        automatic = _is_auto(dim)
        least = MIN_SAMPLES
        if not automatic:
            least = check_int(dim, "dim", minimum=1) + 1
        samples = validate_data(
            self, X, dtype=np.float64, order="C", ensure_min_samples=least
        )
        options = Options(
            method=self.method,
            boundary=self.boundary,
            hole_radius=self.hole_radius,
            significance=self.significance,
            outliers=self.outliers,
            smooth=self.smooth,
            num_neighbors=self.num_neighbors,
            estimator=self.estimator,
            edges=self.edges,
            search=self.search,
            checks=self.checks,
        )
        self.reconstruction_ = (
            self._fit_auto(samples, options)
            if automatic
            else self._fit(samples, options, least - 1)
        )
        if len(self.reconstruction_.simplices) == 0:
            msg = (
                f"dim={self.reconstruction_.dim}: the samples span no simplices of that "
                "dimension; choose a lower one, or give more samples"
            )
            raise ValueError(msg)
        self.dim_ = self.n_components_ = self.reconstruction_.dim
        return self

    def _threads(self) -> int:
        """As the core counts them."""
        return check_num_threads(self.num_threads)

    def _fit(
        self, samples: NDArray[np.float64], options: Options, dim: int
    ) -> Reconstruction:
        return reconstruct_samples(
            check_samples(samples), dim, options, self._threads(), progress=None
        )

    def _fit_auto(
        self, samples: NDArray[np.float64], options: Options
    ) -> Reconstruction:
        found = estimate_dimension(samples, num_threads=self._threads() or None)
        if found.confidence < LOW_CONFIDENCE:
            warnings.warn(low_confidence(found), DimensionWarning, stacklevel=3)
        for dim in range(max(found.dim, 1), 0, -1):
            with warnings.catch_warnings():
                if dim > 1:  # the next one down may do
                    warnings.filterwarnings(
                        "ignore", "no .* simplices", ManifoldWarning
                    )
                result = self._fit(samples, options, dim)
            if len(result.simplices):
                break
        return result

    def transform(self, X: ArrayLike) -> NDArray[np.float64]:
        """Nearest points of the manifold.

        Parameters
        ----------
        X : array_like, shape (Q, D)
            Points.

        Returns
        -------
        ndarray, shape (Q, D), float64
        """
        points = self._project(X).points
        assert points is not None
        result: NDArray[np.float64] = points.copy()  # what comes next may write to it
        return result

    def score_samples(self, X: ArrayLike) -> NDArray[np.float64]:
        """Minus the squared distance from the manifold: the higher, the nearer.

        No log-likelihood: that would take a variance of the noise, which samples that
        are the vertices of the manifold do not show. With noise of known variance s in
        each coordinate off the manifold, this over 2 s is one, up to a constant.

        Parameters
        ----------
        X : array_like, shape (Q, D)
            Points.

        Returns
        -------
        ndarray, shape (Q,), float64
        """
        return -np.square(self._project(X).distances)

    def score(self, X: ArrayLike, y: object = None) -> float:  # noqa: ARG002
        """Mean log-likelihood of points that the manifold was not made of.

        With these a grid search chooses among dimensions: a larger one comes nearer to
        all points, but spreads over more.

        Parameters
        ----------
        X : array_like, shape (Q, D)
            Points, not those of `fit`: these lie on it.
        y : ignored

        Returns
        -------
        float
            Of points that lie anywhere on the manifold with the same chance, plus normal
            noise in the D - K directions off it, of the size that `X` shows; where K = D
            noise leads out of the boundary only.

        Notes
        -----
        With V the K-volume and s^2 the mean of the squared distances over D - K, this is
        -log V - (D - K) (1 + log 2 pi s^2) / 2, the density in R^D: comparable for
        all K. Where K = D it is the largest of -log (V + S s (pi / 2)^(1/2)) - m / 2 s^2,
        over s, with S the volume of the boundary and m the mean of the squared distances.
        It needs `X` to be several rows.
        """
        squares = np.square(self._project(X).distances)
        rec = self.reconstruction_
        assert rec.ambient_dim is not None
        codim = rec.ambient_dim - rec.dim
        if codim == 0:
            return _score_of_solid(rec, float(squares.mean()))
        spread = math.log(max(rec.volume(), sys.float_info.min))
        # Nearer than single precision tells is as near.
        scale = float(np.ptp(rec.coordinates, axis=0).max()) or 1.0
        variance = max(float(squares.mean()) / codim, (_NEAREST * scale) ** 2)
        return -spread - codim * (1 + math.log(2 * math.pi * variance)) / 2

    def inverse_transform(self, X: ArrayLike) -> NDArray[np.float64]:
        """Give the points back: they are in the coordinates of the samples already.

        What `transform` took away is gone. It is there for pipelines, whose other steps
        lead back from here.

        Parameters
        ----------
        X : array_like, shape (Q, D)
            Points, such as those of `transform`.

        Returns
        -------
        ndarray, shape (Q, D), float64
        """
        check_is_fitted(self)
        points = validate_data(self, X, dtype=np.float64, order="C", reset=False)
        return np.array(points)

    def _project(self, X: ArrayLike) -> Projection:
        check_is_fitted(self)
        points = validate_data(self, X, dtype=np.float64, order="C", reset=False)
        return self.reconstruction_.project(points, num_threads=self._threads() or None)


def __dir__() -> list[str]:
    """Public names only."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
