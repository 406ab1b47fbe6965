# SPDX-License-Identifier: GPL-3.0-or-later
"""A scikit-learn estimator: learn a manifold from samples, project others onto it."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

try:
    from joblib import effective_n_jobs
    from sklearn.base import BaseEstimator, OneToOneFeatureMixin, TransformerMixin
    from sklearn.utils.validation import check_is_fitted, validate_data
except ImportError as error:
    _HINT = (
        f"{error}. remanifold.sklearn needs scikit-learn 1.6 or later: pip install "
        "remanifold[sklearn]"
    )
    raise ImportError(_HINT) from error

from remanifold._base.validation import check_int, check_samples
from remanifold.method.dimension import (
    LOW_CONFIDENCE,
    MIN_SAMPLES,
    estimate_dimension,
    low_confidence,
)
from remanifold.method.options import Options
from remanifold.results.reconstruct import reconstruct_samples
from remanifold.warnings import DimensionWarning, ManifoldWarning

if TYPE_CHECKING:
    from typing import Literal

    from numpy.typing import ArrayLike, NDArray

    from remanifold.complex.projection import Projection
    from remanifold.method.options import Estimator, Method
    from remanifold.results.reconstruction import Reconstruction

__all__ = ["ManifoldReconstruction"]


class ManifoldReconstruction(OneToOneFeatureMixin, TransformerMixin, BaseEstimator):  # type: ignore[misc]
    """Reconstruct a manifold from its samples, and project points onto it.

    `transform` replaces each point by the nearest one of the reconstructed manifold, in
    the same coordinates: it takes away what leads off the manifold. The answer for one
    point does not depend on the others.

    Parameters
    ----------
    n_components : int or "auto", default="auto"
        K, the dimension of the manifold. "auto" takes that of `estimate_dimension`,
        which needs ten samples, and where the samples span no simplices of that
        dimension, the largest below of which they do.
    method, boundary, hole_radius, significance, outliers, smooth, num_neighbors
        As in `remanifold.reconstruct`.
    tangent_estimator : {"enclosure", "pca", "jet"}, optional
        `estimator` of `remanifold.reconstruct`.
    n_jobs : int, optional
        Threads, as everywhere in scikit-learn: None for one, -1 for all cores. The
        result does not depend on it.

    Attributes
    ----------
    reconstruction_ : Reconstruction
        The manifold.
    n_components_ : int
        Its dimension.
    n_features_in_ : int
        D, the number of coordinates.
    feature_names_in_ : ndarray, shape (D,)
        Their names, where the samples had such.

    Examples
    --------
    >>> import remanifold as rm
    >>> from remanifold.sklearn import ManifoldReconstruction
    >>> samples = rm.datasets.circle(100, random_state=0)
    >>> model = ManifoldReconstruction(n_components=1).fit(samples)
    >>> model.transform([[2.0, 0.0]]).round(2).tolist()
    [[1.0, 0.0]]
    """

    def __init__(
        self,
        n_components: int | str = "auto",
        *,
        method: Method = "manifold",
        boundary: Literal["auto", False] | ArrayLike = "auto",
        hole_radius: float | None = None,
        significance: float | None = None,
        outliers: Literal["auto", False] | float | None = None,
        smooth: Literal["auto"] | bool | int | None = None,
        num_neighbors: int | None = None,
        tangent_estimator: Estimator | None = None,
        n_jobs: int | None = None,
    ) -> None:
        self.n_components = n_components
        self.method = method
        self.boundary = boundary
        self.hole_radius = hole_radius
        self.significance = significance
        self.outliers = outliers
        self.smooth = smooth
        self.num_neighbors = num_neighbors
        self.tangent_estimator = tangent_estimator
        self.n_jobs = n_jobs

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
        automatic = isinstance(self.n_components, str) and self.n_components == "auto"
        least = MIN_SAMPLES
        if not automatic:
            least = check_int(self.n_components, "n_components", minimum=1) + 1
        samples = validate_data(
            self, X, dtype=np.float64, order="C", ensure_min_samples=least
        )
        self.reconstruction_ = (
            self._fit_auto(samples) if automatic else self._fit(samples, least - 1)
        )
        if len(self.reconstruction_.simplices) == 0:
            msg = (
                f"n_components={self.n_components!r}: the samples span no simplices of "
                "that dimension; choose a lower one, or give more samples"
            )
            raise ValueError(msg)
        self.n_components_ = self.reconstruction_.dim
        return self

    def _fit(self, samples: NDArray[np.float64], dim: int) -> Reconstruction:
        options = Options(
            method=self.method,
            boundary=self.boundary,
            hole_radius=self.hole_radius,
            significance=self.significance,
            outliers=self.outliers,
            smooth=self.smooth,
            num_neighbors=self.num_neighbors,
            estimator=self.tangent_estimator,
        )
        threads = effective_n_jobs(self.n_jobs)
        return reconstruct_samples(
            check_samples(samples), dim, options, threads, progress=None
        )

    def _fit_auto(self, samples: NDArray[np.float64]) -> Reconstruction:
        found = estimate_dimension(samples, num_threads=effective_n_jobs(self.n_jobs))
        if found.confidence < LOW_CONFIDENCE:
            warnings.warn(low_confidence(found), DimensionWarning, stacklevel=3)
        for dim in range(max(found.dim, 1), 0, -1):
            with warnings.catch_warnings():
                if dim > 1:  # the next one down may do
                    warnings.filterwarnings(
                        "ignore", "no .* simplices", ManifoldWarning
                    )
                result = self._fit(samples, dim)
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
        """Mean of `score_samples`: minus the mean squared error of `transform`.

        Parameters
        ----------
        X : array_like, shape (Q, D)
            Points.
        y : ignored

        Returns
        -------
        float
        """
        return float(self.score_samples(X).mean())

    def _project(self, X: ArrayLike) -> Projection:
        check_is_fitted(self)
        points = validate_data(self, X, dtype=np.float64, order="C", reset=False)
        return self.reconstruction_.project(
            points, num_threads=effective_n_jobs(self.n_jobs)
        )
