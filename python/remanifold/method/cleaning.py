# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done to the samples before: outliers found, noise smoothed away."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold import _core
from remanifold._base.progress import progress_callback
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.samples import Input, Points
from remanifold._base.scaling import classical_scaling
from remanifold._base.text import one_line, rounded, two_digits
from remanifold._base.validation import (
    check_choice,
    check_dim,
    check_num_neighbors,
    check_num_threads,
    check_outliers,
    check_samples,
)
from remanifold.method.options import EXACT_SEARCHES

if TYPE_CHECKING:
    from typing import Literal

    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.progress import Callback
    from remanifold.method.options import ExactSearch


@dataclass(frozen=True, eq=False, repr=False)
class Smoothing(ReadOnlyArrays):
    """Samples moved onto the manifold, and how noisy they were.

    Attributes
    ----------
    points : ndarray, shape (N, D), float64, or None
        The smoothed samples; those given where nothing was moved, and outliers where
        they were. None where only products of the samples are known.
    noise : float
        Root of the mean squared normal distance of the samples from the manifold, over
        all normal directions together, in the units of the samples: the residuals of the
        fits, less what a fit itself takes up. The worst 1 % do not count. NaN where
        there are too few samples.
    prediction_error : float
        Root of the mean squared normal distance of a sample from what the others
        predict, likewise.
    num_neighbors : int
        Neighbors each fit was made to; 0 where nothing was moved.
    rounds : int
        More than one where neighbors were looked for again among the smoothed samples.
    remaining_error : float
        Root of the mean squared normal distance from the manifold that is expected to
        remain: noise that neighborhoods of this size leave, and bias.
    resolution : float
        With `reconstruct`: smoothed samples nearer to each other than this, four
        times ``remaining_error``, carry no more shape: one of them is a vertex. 0 where all
        are.
    drowned : bool
        The noise is as large as the shape: no neighborhood is wide enough to average it
        out and narrow enough to be the graph of a quadric.
    layers : bool
        The samples lie in two layers rather than about one, as noise would: ``"auto"`` took
        the distance between them for no noise and moved nothing.
    enough_samples : int or None
        About how many samples would do, where it has drowned.
    fitting_dim : int or None
        The dimension that neighborhoods of all sizes show, where that is not K. Noise that
        drowns the shape fills space, as well as a manifold of more dimensions does.
    """

    points: NDArray[np.float64] | None
    noise: float
    prediction_error: float
    num_neighbors: int
    rounds: int
    remaining_error: float = float("nan")
    resolution: float = 0.0
    drowned: bool = False
    enough_samples: int | None = None
    fitting_dim: int | None = None
    layers: bool = False

    def __repr__(self) -> str:
        return one_line(
            self,
            samples=None if self.points is None else len(self.points),
            moved=self.moved,
            noise=rounded(self.noise),
            prediction_error=rounded(self.prediction_error),
            num_neighbors=self.num_neighbors,
            rounds=self.rounds,
            resolution=rounded(self.resolution) if self.resolution else None,
            drowned=True if self.drowned else None,
            layers=True if self.layers else None,
        )

    @property
    def moved(self) -> bool:
        """Whether samples were moved: not where ``"auto"`` found no noise."""
        return self.num_neighbors > 0


def smooth(
    points: ArrayLike | None = None,
    dim: int | None = None,
    num_neighbors: int | None = None,
    *,
    only_noise: bool = False,
    search: ExactSearch = "auto",
    num_threads: int | None = None,
    progress: bool | Callback | None = None,
) -> Smoothing:
    """Move noisy samples onto the K-manifold that their neighborhoods show.

    Each sample goes along the normals to a quadric fitted to its neighborhood: moving
    least squares in any dimension K and any number of coordinates. Quadrics are fitted at
    some of the samples, and each sample goes to the mean of those that it is near the
    middle of. How large neighborhoods are is found by looking at a ladder of sizes: noise
    is the scatter about the quadrics where it does not grow with the size, bias is how far
    the foot of a sample moves from half the size to the whole beyond what noise explains
    (Lepski), and the sum of both is the least at the size that is taken.

    Parameters
    ----------
    points : array_like, shape (N, D)
        Samples; complex samples count as real ones of dimension 2 D.
    dim : int
        K, the dimension of the manifold.
    num_neighbors : int, optional
        Neighbors of each fit, at least K + 1, weighted down to zero at the last; by
        default those at which noise and bias balance.
    only_noise : bool
        Leave the samples alone unless scatter stays the same from some size of the
        neighborhoods to the next, and large neighborhoods predict better than small ones.
    search : {"auto", "kdtree", "brute_force"}
        An exact search, see `neighborhoods`.
    num_threads : int, optional
        All cores by default. The result does not depend on it.
    progress : bool or callable, optional
        True for a bar, or a function of (step, done, total).

    Returns
    -------
    Smoothing

    References
    ----------
    O. Lepski, On a problem of adaptive estimation in Gaussian white noise, Theory of
    Probability and Its Applications 35, 1991.

    D. Levin, Mesh-independent surface interpolation, 2003.

    B. Sober and D. Levin, Manifold approximation by moving least-squares projection
    (MMLS), Constructive Approximation 52, 2020.

    Examples
    --------
    >>> import numpy as np
    >>> import remanifold as rm
    >>> circle = rm.datasets.circle(400, random_state=0)
    >>> noisy = rm.datasets.add_noise(circle, 0.02, random_state=1)
    >>> smoothed = rm.smooth(noisy, 1)
    >>> bool(abs(np.hypot(*smoothed.points.T) - 1).max() < 0.01)
    True
    >>> round(smoothed.noise, 2)
    0.02
    """
    given = check_samples(points)
    k = check_dim(dim, given)
    check_choice(search, "search", EXACT_SEARCHES)
    neighbors = 0
    if num_neighbors is not None:
        neighbors = check_num_neighbors(num_neighbors, k)
    with progress_callback(progress) as callback:
        options = _core.Options(
            dim=k,
            smooth=True,
            smoothing_neighbors=neighbors,
            only_noise=bool(only_noise),
            search=search,
        )
        report = _core.clean(
            given,
            options,
            num_threads=check_num_threads(num_threads),
            progress=callback,
        )
    return smoothing_of(given, report, k)


def find_outliers(
    points: ArrayLike | None = None,
    dim: int | None = None,
    outliers: Literal["auto"] | float = "auto",
    *,
    gram: ArrayLike | None = None,
    distances: ArrayLike | None = None,
    search: ExactSearch = "auto",
    num_threads: int | None = None,
    progress: bool | Callback | None = None,
) -> NDArray[np.int32]:
    """Samples that do not lie on the K-manifold of the others.

    A sample is judged by its neighbors: by its normal distances from the quadrics fitted
    to their neighborhoods without it, of which the lower quartile counts. Far from
    everything, where outliers are each other's neighbors, they are known by being three
    times sparser than most samples while their neighbors do not agree on any surface.

    Parameters
    ----------
    points : array_like, shape (N, D)
        Samples; complex samples count as real ones of dimension 2 D.
    dim : int
        K, the dimension of the manifold.
    outliers : "auto" or float
        Distance from which on a sample is an outlier, in units of the local scale (the
        distance to the (2K+2)-th neighbor around it, and at most twice the median of
        these; the distance between the curves where samples are dense along curves);
        "auto" is 2. Among noisy samples it is at least eight times the distance that one
        in four exceeds.
    gram, distances : array_like, shape (N, N), optional
        Inner products or distances of the samples, instead of `points`.
    search, num_threads, progress
        As in `smooth`.

    Returns
    -------
    ndarray of int32
        Indices of the outliers, ascending.

    Examples
    --------
    >>> import numpy as np
    >>> import remanifold as rm
    >>> circle = rm.datasets.circle(100, random_state=0)
    >>> rm.find_outliers(np.vstack([circle, [[0.1, 0.2], [2.0, 1.0]]]), 1).tolist()
    [100, 101]
    """
    given = check_samples(points, gram, distances)
    k = check_dim(dim, given)
    check_choice(search, "search", EXACT_SEARCHES)
    distance = check_outliers(outliers)
    if distance == 0:
        msg = 'outliers is False, expected "auto" or a distance'
        raise ValueError(msg)
    with progress_callback(progress) as callback:
        report = _core.clean(
            given,
            _core.Options(dim=k, outlier_distance=distance, search=search),
            num_threads=check_num_threads(num_threads),
            progress=callback,
        )
    found: NDArray[np.int32] = report["outliers"]
    return found


def smoothing_of(
    given: Input, report: dict[str, Any], dim: int, known: bool = True
) -> Smoothing:
    """What the core did, as positions; None where they are not `known`."""
    points = given.matrix if known else None
    if known and len(report["displacements"]):
        points = given.matrix + report["displacements"]
    return Smoothing(
        points=None if points is None else points.view(),
        noise=report["noise"],
        prediction_error=report["prediction_error"],
        num_neighbors=report["num_neighbors"],
        rounds=report["rounds"],
        remaining_error=report["remaining_error"],
        resolution=report["resolution"],
        drowned=report["drowned"],
        layers=report["layers"],
        enough_samples=(
            two_digits(len(given) * report["growth"]) if report["drowned"] else None
        ),
        fitting_dim=report["fitting_dim"] if report["fitting_dim"] != dim else None,
    )


def as_points(samples: Input) -> Points:
    """Coordinates for samples known by products or distances (classical scaling)."""
    if isinstance(samples, Points):
        return samples
    return Points(classical_scaling(samples).coordinates)
