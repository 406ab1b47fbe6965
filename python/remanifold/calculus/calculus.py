# SPDX-License-Identifier: GPL-3.0-or-later
"""All that can be computed of functions on a complex, as methods of one object."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeVar, overload

import numpy as np

from remanifold._base.progress import progress_callback
from remanifold._base.text import one_line
from remanifold._base.validation import (
    check_choice,
    check_int,
    check_positive,
    check_selection,
    check_values,
    check_values_where,
)
from remanifold.calculus.charts import Atlas, make_atlas
from remanifold.calculus.cohomology import (
    CircularCoordinates,
    circular_coordinates,
    harmonic_forms,
)
from remanifold.calculus.curvature import (
    AngleDefects,
    Curvature,
    angle_defects,
    curvature,
)
from remanifold.calculus.delaunay import DelaunayOperators, IntrinsicTriangles
from remanifold.calculus.geodesics import METHODS, Distances, GeodesicMethod
from remanifold.calculus.level_sets import level_set
from remanifold.calculus.operators import Operators
from remanifold.calculus.paths import (
    FrechetMean,
    LogarithmMap,
    VoronoiCells,
    farthest_points,
    frechet_mean,
    logarithm_map,
    refined_path,
    voronoi_cells,
)
from remanifold.calculus.poisson import (
    PoissonSolution,
    free_components,
    solve_poisson,
)
from remanifold.calculus.regression import (
    Regression,
    check_order,
    default_order,
    fit_exactly,
    fit_smooth,
)
from remanifold.calculus.spectrum import Spectrum, compute_spectrum
from remanifold.calculus.straightening import Surface
from remanifold.calculus.unrolling import CHART_METHODS, ChartMethod
from remanifold.complex.data import ComplexData
from remanifold.complex.measures import shapes
from remanifold.complex.normals import vertex_normals
from remanifold.complex.parts import open_faces

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.progress import Callback

    Floats = NDArray[np.float64]

C = TypeVar("C", bound=ComplexData)


class Calculus(Generic[C]):
    """Functions on a complex and its geometry; `SimplicialComplex.calculus` has one.

    Everything follows from the lengths of the edges, unless a method says that it needs
    coordinates: it works for any K, any number of coordinates, and for complexes known
    by inner products or distances. Functions are linear on each simplex and given by
    their values at the N vertices. Matrices and factorizations are made when first
    needed.

    Where the complex is no manifold (`singular_vertices`) functions are still defined,
    and equations hold in the weak sense. Vertices in no simplex, or in flat ones only,
    are `missing_vertices`: values there are ignored, and those of results are NaN.

    Needs ``pip install remanifold[calculus]``.
    """

    def __init__(
        self,
        complex: ComplexData,
        make: Callable[[Floats, NDArray[np.int32], dict[str, NDArray[Any]]], C],
    ) -> None:
        if complex.dim < 1 or len(complex.simplices) == 0:
            msg = (
                f"the complex has {len(complex.simplices)} simplices of dimension "
                f"{complex.dim}: calculus needs edges at least"
            )
            raise ValueError(msg)
        self._complex = complex
        self._make = make
        self._operators = Operators(complex)
        self._delaunay: DelaunayOperators | None = None
        self._distances: dict[str, Distances] = {}

    def __repr__(self) -> str:
        return one_line(
            self, vertices=self._complex.num_vertices, dim=self._complex.dim
        )

    # ------------------------------------------------------------ what it stands on

    @property
    def missing_vertices(self) -> NDArray[np.int64]:
        """Vertices where functions have no values, ascending: in no simplex with volume."""
        return np.flatnonzero(~self._operators.used)

    @property
    def flat_simplices(self) -> NDArray[np.int64]:
        """Rows of simplices that are left out.

        They have no volume, up to rounding, or distances that no simplex in space has.
        """
        return np.flatnonzero(self._operators.elements.flat)

    @property
    def singular_vertices(self) -> NDArray[np.int32]:
        """Vertices around which the complex is no manifold; see `Topology`."""
        return self._complex.topology().singular_vertices

    @property
    def boundary_vertices(self) -> NDArray[np.int64]:
        """Vertices of the faces that lie in one simplex only, ascending."""
        return np.unique(open_faces(self._complex.simplices)).astype(np.int64)

    @property
    def vertex_volumes(self) -> Floats:
        """Share of each vertex in the K-volume, (N,): the lumped mass."""
        return np.array(self._operators.volumes)

    def intrinsic_delaunay(self) -> IntrinsicTriangles:
        """Intrinsic Delaunay triangulation of a surface: the best triangles on it.

        Edges are flipped, straight along the surface, until the angles opposite to none
        add up to more than pi. The surface stays what it is; thin triangles go, and no
        cotangent weight inside is negative. ``delaunay=True`` computes functions by these
        triangles; where the surface has a boundary, or edges of more than two triangles,
        by those of both its sides, which are sewn together there: then no weight is
        negative at all.

        Returns
        -------
        IntrinsicTriangles
            Triangles with the lengths of their sides.

        Raises
        ------
        ValueError
            Another dimension than 2.

        References
        ----------
        M. Fisher, B. Springborn, P. Schröder, A. I. Bobenko, An algorithm for the
        construction of intrinsic Delaunay triangulations with applications to digital
        geometry processing, Computing 81, 2007.

        N. Sharp, K. Crane, A Laplacian for nonmanifold triangle meshes, Computer
        Graphics Forum 39(5), 2020.
        """
        return self._operators_by(delaunay=True).intrinsic

    @overload
    def _operators_by(self, *, delaunay: Literal[True]) -> DelaunayOperators: ...
    @overload
    def _operators_by(self, *, delaunay: bool) -> Operators: ...
    def _operators_by(self, *, delaunay: bool) -> Operators:
        if not delaunay:
            return self._operators
        if self._complex.dim != 2:
            msg = (
                f"delaunay is for surfaces, and the complex has dimension "
                f"{self._complex.dim}: leave it out"
            )
            raise ValueError(msg)
        if self._delaunay is None:
            self._delaunay = DelaunayOperators(self._complex)
        return self._delaunay

    def mass(self, *, lumped: bool = False, delaunay: bool = False) -> Any:
        """Mass matrix: integrals of products of the hat functions.

        Parameters
        ----------
        lumped : bool
            The sums of its rows on the diagonal, which are `vertex_volumes`.
        delaunay : bool
            Of the hat functions on the triangles of `intrinsic_delaunay`.

        Returns
        -------
        scipy.sparse.csr_array, shape (N, N), float64
            Symmetric, in units of K-volume. ``u @ mass() @ v`` is the integral of the
            product of two functions.
        """
        operators = self._operators_by(delaunay=delaunay)
        if not lumped:
            return operators.mass.copy()
        from scipy import sparse

        return sparse.csr_array(sparse.diags(operators.volumes))

    def stiffness(self, *, delaunay: bool = False) -> Any:
        """Stiffness matrix: integrals of products of gradients of the hat functions.

        Parameters
        ----------
        delaunay : bool
            Of the hat functions on the triangles of `intrinsic_delaunay`: no entry off
            the diagonal is positive.

        Returns
        -------
        scipy.sparse.csr_array, shape (N, N), float64
            Symmetric, not negative; its kernel are the functions that are constant on
            each component. For K = 2 its entries are the cotangent weights.

        References
        ----------
        U. Pinkall, K. Polthier, Computing discrete minimal surfaces and their
        conjugates, Experimental Mathematics 2(1), 1993.
        """
        return self._operators_by(delaunay=delaunay).stiffness.copy()

    # -------------------------------------------------------------- differential forms

    def faces(self, degree: int) -> NDArray[np.int32]:
        """Simplices of a dimension: what forms of this degree have values on.

        Parameters
        ----------
        degree : int
            k, from 0 to K.

        Returns
        -------
        ndarray, shape (M_k, k+1), int32
            As in `interoperability.to_scipy`: all vertices, below K sorted and oriented
            by ascending vertices, in K the simplices as they are.
        """
        return np.array(self._operators.faces(self._check_degree(degree, 0)))

    def exterior_derivative(self, degree: int) -> Any:
        """Exterior derivative of k-forms: the transpose of the boundary operator.

        Parameters
        ----------
        degree : int
            k, from 0 to K - 1.

        Returns
        -------
        scipy.sparse.csr_array, shape (M_{k+1}, M_k), int8
        """
        return self._operators.derivative(self._check_degree(degree, 0, -1))

    def hodge_star(self, degree: int, *, diagonal: bool = False) -> Any:
        """Hodge star of k-forms as a matrix: the inner products of Whitney forms.

        Parameters
        ----------
        degree : int
            k, from 0 to K.
        diagonal : bool
            Instead the K-k-volumes of the circumcentric duals over the k-volumes of the
            faces. It is diagonal, but entries may be zero or negative where simplices do
            not contain their circumcenters.

        Returns
        -------
        scipy.sparse.csr_array, shape (M_k, M_k), float64
            Symmetric; of Whitney forms positive definite, but for faces of flat
            simplices only, whose rows are zero. For k = 0 it is `mass`.

        References
        ----------
        H. Whitney, Geometric Integration Theory, Princeton University Press, 1957.

        M. Desbrun, A. N. Hirani, M. Leok, J. E. Marsden, Discrete exterior calculus,
        arXiv:math/0508341, 2005.
        """
        return self._operators.star(
            self._check_degree(degree, 0), diagonal=bool(diagonal)
        ).copy()

    def codifferential(self, degree: int, form: ArrayLike) -> Floats:
        """Codifferential of a k-form: the adjoint of the exterior derivative.

        Parameters
        ----------
        degree : int
            k, from 1 to K.
        form : array_like, shape (M_k,)
            Values on the faces of dimension k: integrals over them.

        Returns
        -------
        ndarray, shape (M_{k-1},), float64
            A (k-1)-form; at the boundary in the weak sense, as if the normal part of the
            form vanished there.
        """
        degree = self._check_degree(degree, 1)
        values = self._check_form(form, degree)
        operators = self._operators
        right = operators.derivative(degree - 1).T @ (operators.star(degree) @ values)
        return operators.star_solver(degree - 1)(right)

    def hodge_laplacian(self, degree: int, form: ArrayLike) -> Floats:
        """Hodge Laplacian of a k-form: d of the codifferential and the reverse.

        Parameters
        ----------
        degree : int
            k, from 0 to K.
        form : array_like, shape (M_k,)
            Values on the faces of dimension k.

        Returns
        -------
        ndarray, shape (M_k,), float64
            A k-form, not negative as an operator: for k = 0 minus `laplacian`, by the
            full mass.
        """
        degree = self._check_degree(degree, 0)
        values = self._check_form(form, degree)
        operators = self._operators
        total = np.zeros_like(values)
        if degree < self._complex.dim:
            step = operators.derivative(degree)
            right = step.T @ (operators.star(degree + 1) @ (step @ values))
            total += operators.star_solver(degree)(right)
        if degree > 0:
            total += operators.derivative(degree - 1) @ self.codifferential(
                degree, values
            )
        return total

    # ------------------------------------------------------------------- functions

    def integrate(self, values: ArrayLike) -> Any:
        """Integral of a function over the complex.

        Parameters
        ----------
        values : array_like, shape (N,) or (N, C)
            At the vertices.

        Returns
        -------
        float, or ndarray of shape (C,), float64
            In units of the values times K-volume; exact for functions that are linear
            on each simplex.
        """
        table = self._check_function(values, "values")
        total = self._operators.volumes @ table
        return float(total) if table.ndim == 1 else total

    def gradient(self, values: ArrayLike, *, intrinsic: bool = False) -> Floats:
        """Gradient of a function on each simplex, where it is constant.

        Parameters
        ----------
        values : array_like, shape (N,)
            At the vertices.
        intrinsic : bool
            In an orthonormal frame of each simplex instead of coordinates: its first
            axis is the first edge, and each edge from the first vertex adds one.

        Returns
        -------
        ndarray, shape (M, D) or (M, K), float64
            In coordinates (`ComplexData.coordinates` where only products or distances
            are known), or in the frames. Zero on `flat_simplices`.
        """
        table = self._check_function(values, "values", ndim=1)
        within = self._operators.frame_gradients(table)
        if intrinsic:
            return within
        axes = self._operators.ambient_frames()
        return np.asarray(np.einsum("mk,mkd->md", within, axes))

    def divergence(self, vectors: ArrayLike, *, intrinsic: bool = False) -> Floats:
        """Divergence of vectors that are constant on each simplex, at the vertices.

        Parameters
        ----------
        vectors : array_like, shape (M, D) or (M, K)
            As `gradient` has them; what is orthogonal to a simplex does not count.
        intrinsic : bool
            In the frames of the simplices.

        Returns
        -------
        ndarray, shape (N,), float64
            The mean around each vertex, by its share in the volume; NaN at
            `missing_vertices`. At the boundary what flows out counts as well.
        """
        operators = self._operators
        columns = self._complex.dim
        if not intrinsic:
            columns = self._complex.coordinates.shape[1]
        table = check_values(vectors, "vectors", len(self._complex.simplices), ndim=2)
        if table.ndim != 2 or table.shape[1] != columns:
            msg = (
                f"vectors has shape {table.shape}, expected "
                f"({len(self._complex.simplices)}, {columns})"
            )
            raise ValueError(msg)
        if not intrinsic:
            table = np.einsum("md,mkd->mk", table, operators.ambient_frames())
        return self._over_volumes(-operators.weak_divergence(table))

    def laplacian(self, values: ArrayLike, *, delaunay: bool = False) -> Floats:
        """Laplacian of a function: the divergence of its gradient, never positive.

        Parameters
        ----------
        values : array_like, shape (N,) or (N, C)
            At the vertices.
        delaunay : bool
            By the triangles of `intrinsic_delaunay`.

        Returns
        -------
        ndarray, shape (N,) or (N, C), float64
            The mean around each vertex, by its share in the volume; NaN at
            `missing_vertices`. At the boundary the slope across it counts as well.
            Means of values over random simplices scatter: `poisson` and `spectrum`
            converge where this does not.
        """
        operators = self._operators_by(delaunay=delaunay)
        table = self._check_function(values, "values", operators=operators)
        return self._over_volumes(-(operators.stiffness @ table), operators)

    def poisson(
        self,
        source: ArrayLike,
        fixed: ArrayLike | None = None,
        values: ArrayLike = 0.0,
        *,
        delaunay: bool = False,
    ) -> PoissonSolution:
        """Find the function whose Laplacian is given.

        Parameters
        ----------
        source : array_like, shape (N,) or (N, C)
            The Laplacian, at the vertices; zero for harmonic functions.
        fixed : array_like of bool, shape (N,), or of int, shape (F,), optional
            Vertices where the function is known, such as `boundary_vertices`. By
            default none. Everywhere else on the boundary the slope across it is zero.
        values : float, or array_like of shape (F,) or (F, C)
            The function there, in ascending order of a mask or in that of `fixed`.
        delaunay : bool
            By the triangles of `intrinsic_delaunay`: harmonic functions have their
            least and greatest values where they are fixed.

        Returns
        -------
        PoissonSolution
            Components are solved by themselves. Where nothing is fixed the function has
            mean zero, and the mean of the source, its `imbalance`, is taken off.

        Raises
        ------
        ValueError
            Wrong shape, not finite, or a fixed vertex that is missing.

        Examples
        --------
        >>> import remanifold as rm
        >>> path = rm.SimplicialComplex([[0], [1], [3], [4]], [[0, 1], [1, 2], [2, 3]])
        >>> found = path.calculus.poisson([0, 0, 0, 0], fixed=[0, 3], values=[0, 8])
        >>> found.values.round(12).tolist()
        [0.0, 2.0, 6.0, 8.0]
        """
        operators = self._operators_by(delaunay=delaunay)
        table = self._check_function(source, "source", operators=operators)
        chosen = self._check_vertices(fixed, "fixed", operators)
        shape = (len(chosen), *table.shape[1:])
        known = np.asarray(values)
        if known.ndim == 0:
            known = np.full(shape, known)
        known = check_values(known, "values", len(chosen)) if len(chosen) else known
        if known.shape != shape:
            msg = f"values has shape {known.shape}, expected {shape} or a number"
            raise ValueError(msg)
        return solve_poisson(operators, table, chosen, known)

    # -------------------------------------------------------------------- spectrum

    def spectrum(
        self,
        count: int,
        fixed: ArrayLike | None = None,
        *,
        lumped: bool = True,
        delaunay: bool = False,
    ) -> Spectrum:
        """Eigenfunctions of the Laplacian of smallest eigenvalues.

        Parameters
        ----------
        count : int
            How many, constant functions included.
        fixed : array_like of bool, shape (N,), or of int, shape (F,), optional
            Vertices where the functions are zero, such as `boundary_vertices`. By
            default none: the slope across the boundary is zero.
        lumped : bool
            By the lumped mass matrix, the default: its eigenvalues are a little too
            small as a rule, those of the full one too large, and several times farther
            off.
        delaunay : bool
            By the triangles of `intrinsic_delaunay`.

        Returns
        -------
        Spectrum
            Components are solved by themselves, by ARPACK about a shift below zero.

        Raises
        ------
        ValueError
            More than there are vertices.

        References
        ----------
        R. B. Lehoucq, D. C. Sorensen, C. Yang, ARPACK users' guide, SIAM, 1998.

        Examples
        --------
        >>> import numpy as np
        >>> import remanifold as rm
        >>> angles = np.linspace(0, 2 * np.pi, 200, endpoint=False)
        >>> circle = rm.reconstruct(np.stack([np.cos(angles), np.sin(angles)], 1), 1)
        >>> circle.calculus.spectrum(5).eigenvalues.round(2).tolist()
        [0.0, 1.0, 1.0, 4.0, 4.0]
        """
        number = check_int(count, "count", minimum=1)
        operators = self._operators_by(delaunay=delaunay)
        chosen = self._check_vertices(fixed, "fixed", operators)
        return compute_spectrum(operators, number, chosen, lumped=bool(lumped))

    # --------------------------------------------------------- functions from values

    def fit(
        self,
        values: ArrayLike,
        vertices: ArrayLike | None = None,
        *,
        weights: ArrayLike | None = None,
        penalty: float | Literal["gcv"] = "gcv",
        order: int | None = None,
    ) -> Regression:
        """Smooth function near values at some vertices, or through them.

        Parameters
        ----------
        values : array_like, shape (Q,) or (Q, C)
            What was measured.
        vertices : array_like of bool, shape (N,), or of int, shape (Q,), optional
            Where, by default at all vertices; those of `missing_vertices` do not count.
        weights : array_like, shape (Q,), optional
            Of the squared residuals, positive: inverse variances of the values, up to a
            factor. All 1 by default.
        penalty : float or "gcv"
            Weight of the roughness beside the squared residuals. "gcv": that of the
            least generalized cross-validation, the same for all columns. 0: the
            smoothest function that has the values.
        order : int, optional
            Roughness is the integral of the square of the gradient (1), of the Laplacian
            (2), or of further derivatives. By default the least for which values at
            points make sense: 2 up to K = 3, then more than K / 2.

        Returns
        -------
        Regression
            The function at all vertices, its noise, and on request its standard errors.

        Raises
        ------
        ValueError
            Wrong shape, not finite, a vertex that is missing, a component without
            values, or an order of which rounding leaves nothing.

        Notes
        -----
        For more than 32 values the trace in the cross-validation is estimated by 32
        random vectors, the same each time. At the boundary the slope across it is
        taken to be small.

        References
        ----------
        P. Craven, G. Wahba, Smoothing noisy data with spline functions, Numerische
        Mathematik 31, 1979.

        F. Lindgren, H. Rue, J. Lindström, An explicit link between Gaussian fields and
        Gaussian Markov random fields: the stochastic partial differential equation
        approach, Journal of the Royal Statistical Society B 73(4), 2011.

        Examples
        --------
        >>> import numpy as np
        >>> import remanifold as rm
        >>> points = rm.datasets.sphere(500, random_state=0)
        >>> noisy = points[:, 2] + 0.3 * np.random.default_rng(0).normal(size=500)
        >>> found = rm.reconstruct(points, 2).calculus.fit(noisy)
        >>> print(np.abs(found.values - points[:, 2]).mean() < 0.05)
        True
        """
        used = self._operators.used
        count = self._complex.num_vertices
        if vertices is None:
            table = self._check_function(values, "values")
            chosen = np.flatnonzero(used)
            rows = chosen
        else:
            chosen = self._check_vertices(vertices, "vertices")
            table = check_values(values, "values", len(chosen))
            rows = np.arange(len(chosen))
        heights = np.ones(len(table))
        if weights is not None:
            heights = check_values(weights, "weights", len(table), ndim=1)
            if not (heights > 0).all():
                place = int((heights <= 0).argmax())
                msg = f"weights[{place}] is {heights[place]}, expected more than 0"
                raise ValueError(msg)
        power = default_order(self._complex.dim)
        if order is not None:
            power = check_int(order, "order", minimum=1)
        check_order(self._operators, power)
        lacking = free_components(self._operators, chosen)
        if lacking.any():
            label = int(lacking.argmax())
            first = int(np.flatnonzero(self._operators.labels == label)[0])
            msg = (
                f"no value is given in the component of vertex {first}: fit components "
                "with values by themselves, as subset() has them"
            )
            raise ValueError(msg)
        if isinstance(penalty, str):
            check_choice(penalty, "penalty", ("gcv",))
            wanted = None
        elif penalty == 0 and not isinstance(penalty, bool):
            return fit_exactly(self._operators, chosen, table[rows], power)
        else:
            wanted = check_positive(penalty, "penalty")
        if wanted is None and len(chosen) < 3:
            msg = (
                f"{len(chosen)} of {count} vertices have values: cross-validation needs "
                "three at least, give penalty= a number"
            )
            raise ValueError(msg)
        return fit_smooth(
            self._operators, chosen, table[rows], heights[rows], wanted, power
        )

    def level_set(self, values: ArrayLike, level: float = 0.0) -> C:
        """Where a function has a value: points, polylines, triangles, for any K.

        Parameters
        ----------
        values : array_like, shape (N,)
            At the vertices; simplices with `missing_vertices` count as well.
        level : float
            The value.

        Returns
        -------
        SimplicialComplex
            Of dimension K - 1, in the coordinates of the complex. On an oriented complex it is oriented as the
            boundary of what lies below. Its `vertex_attributes` say where its vertices
            are: ``edge`` their two vertices here, ``share`` how far along.

        Raises
        ------
        ValueError
            Wrong shape, not finite, or a level that is taken nowhere.

        Notes
        -----
        Values equal to the level count as above it. Where they are taken at vertices
        the set may be no manifold there; a level beside it cuts edges only.
        """
        table = check_values_where(values, "values", self._in_simplices, 1)
        height = float(check_values([level], "level", 1)[0])
        found = level_set(self._complex.simplices, table, height)
        if len(found.simplices) == 0:
            own = table[np.unique(self._complex.simplices)]
            msg = (
                f"level is {height}, but values are from {own.min():.6g} to "
                f"{own.max():.6g}: it is taken nowhere, or in single points only"
            )
            raise ValueError(msg)
        coordinates = self._complex.coordinates
        start, end = coordinates[found.edges[:, 0]], coordinates[found.edges[:, 1]]
        points = start + found.shares[:, None] * (end - start)
        attributes: dict[str, NDArray[Any]] = {
            "edge": found.edges,
            "share": found.shares,
        }
        return self._make(points, found.simplices, attributes)

    def harmonic_forms(self, degree: int) -> Floats:
        """Forms without derivative and codifferential, one for each class of cohomology.

        Parameters
        ----------
        degree : int
            k, from 0 to K.

        Returns
        -------
        ndarray, shape (M_k, B), float64
            Values on ``faces(k)``, orthonormal by ``hodge_star(k)``; B is the Betti
            number over the reals. For k = 1 found by whole numbers, beyond as
            eigenforms whose eigenvalue is zero up to rounding.
        """
        return harmonic_forms(self._operators, self._check_degree(degree, 0))

    def circular_coordinates(self) -> CircularCoordinates:
        """Angles along the independent loops: two on a torus, one on an annulus.

        Returns
        -------
        CircularCoordinates
            One angle for each class of the first cohomology over the integers, as
            smooth as it can be, those that turn most slowly first. None on a sphere, and none for loops that close after two
            rounds only, as on a projective plane.

        References
        ----------
        V. de Silva, D. Morozov, M. Vejdemo-Johansson, Persistent cohomology and
        circular coordinates, Discrete and Computational Geometry 45(4), 2011.

        Examples
        --------
        >>> import numpy as np
        >>> import remanifold as rm
        >>> rec = rm.reconstruct(rm.datasets.annulus(500, random_state=0), 2)
        >>> rec.calculus.circular_coordinates()
        CircularCoordinates(vertices=500, loops=1)
        """
        return circular_coordinates(self._operators)

    # ------------------------------------------------------------ paths and distances

    def shortest_path(
        self, start: int, end: int, *, points: int = 4, exact: bool = False
    ) -> C:
        """Shortest path along the complex between two vertices, as a polyline.

        Parameters
        ----------
        start, end : int
            Vertices, not the same.
        points : int
            How many points on each edge the path may pass, besides the vertices. 0:
            along the edges. More are nearer to the truth and cost their square.
        exact : bool
            Straightened as far as that makes it shorter: for curves, and for surfaces
            that are manifolds, orientable or not, by lengths alone. It begins with one
            point on each edge; `points` does not count then.

        Returns
        -------
        SimplicialComplex
            Of dimension 1, its vertices in order from the start to the end, its `volume`
            the length of the path. Its `vertex_attributes` say where they are: ``edge``
            their two vertices here, ``share`` how far along.

        Raises
        ------
        ValueError
            Vertices that are the same, missing, or joined by no path; ``exact`` on other
            complexes; so many points that their steps would fill the memory.

        Notes
        -----
        Paths bend at edges only, for K >= 3 too, and are too long; the page on calculus
        has how much. Straightened ones are straight on the triangles laid flat, and
        shortest among those nearby: not always the shortest of all. For K >= 3 there are
        none.

        References
        ----------
        D. T. Lee, F. P. Preparata, Euclidean shortest paths in the presence of
        rectilinear barriers, Networks 14, 1984.

        S.-Q. Xin, G.-J. Wang, Efficiently determining a locally exact shortest path on
        polyhedral surfaces, Computer-Aided Design 39(12), 2007.
        """
        ends = self._check_vertices([start, end], "start and end")
        number = check_int(points, "points", minimum=0)
        whole = self._complex
        if exact:
            if whole.dim > 2:
                msg = (
                    "exact paths are for curves and surfaces, and the dimension is "
                    f"{whole.dim}: leave exact out"
                )
                raise ValueError(msg)
            if whole.dim == 2 and not whole.topology().manifold:
                msg = "exact paths are for manifolds, and this complex is none"
                raise ValueError(msg)
            number = whole.dim - 1  # along the edges is all that a curve has
        labels = self._operators.labels[ends]
        found = None
        if labels[0] == labels[1]:
            found = refined_path(whole, int(ends[0]), int(ends[1]), number)
        if found is None:
            msg = f"no path leads from vertex {ends[0]} to vertex {ends[1]}"
            raise ValueError(msg)
        edges, shares = found
        if exact and whole.dim == 2:
            edges, shares = self._surface.straightened(edges, shares)
        coordinates = whole.coordinates
        first, last = (coordinates[edges[:, i]] for i in range(2))
        way = first + shares[:, None] * (last - first)
        attributes: dict[str, NDArray[Any]] = {"edge": edges, "share": shares}
        steps = np.arange(len(way) - 1, dtype=np.int32)
        return self._make(way, np.stack([steps, steps + 1], axis=1), attributes)

    def farthest_points(
        self, count: int, start: int | None = None, method: GeodesicMethod = "auto"
    ) -> NDArray[np.int64]:
        """Vertices that cover the complex evenly: each the farthest from those before.

        Parameters
        ----------
        count : int
            How many.
        start : int, optional
            The first; by default the lowest vertex that has a simplex.
        method : {"auto", "graph", "heat", "exact"}
            As in `SimplicialComplex.geodesic_distances`.

        Returns
        -------
        ndarray, shape (count,), int64
            In the order in which they were chosen. Every component has one before any
            has two.

        References
        ----------
        T. F. Gonzalez, Clustering to minimize the maximum intercluster distance,
        Theoretical Computer Science 38, 1985.
        """
        used = self._operators.used
        number = check_int(count, "count", minimum=1)
        if number > used.sum():
            msg = f"count is {number}, but there are {used.sum()} vertices"
            raise ValueError(msg)
        first = np.flatnonzero(used)[:1]
        if start is not None:
            first = self._check_vertices([start], "start")
        return farthest_points(self._along(method), used, number, int(first[0]))

    def voronoi_cells(
        self, sites: ArrayLike, method: GeodesicMethod = "auto"
    ) -> VoronoiCells:
        """Which of some vertices is nearest along the complex.

        Parameters
        ----------
        sites : array_like of bool, shape (N,), or of int, shape (S,)
            The vertices.
        method : {"auto", "graph", "heat", "exact"}
            As in `SimplicialComplex.geodesic_distances`.

        Returns
        -------
        VoronoiCells
        """
        chosen = self._check_vertices(sites, "sites")
        return voronoi_cells(self._along(method), self._operators, chosen)

    def mean(
        self,
        vertices: ArrayLike,
        weights: ArrayLike | None = None,
        method: GeodesicMethod = "auto",
    ) -> FrechetMean:
        """Mean of samples on the manifold (Fréchet): of least mean squared distance.

        Parameters
        ----------
        vertices : array_like of bool, shape (N,), or of int, shape (Q,)
            The samples; they are all in one component.
        weights : array_like, shape (Q,), optional
            Positive; all the same by default.
        method : {"auto", "graph", "heat", "exact"}
            As in `SimplicialComplex.geodesic_distances`.

        Returns
        -------
        FrechetMean
            A vertex: the mean itself lies within about a spacing. There may be several
            as good.
        """
        chosen = self._check_vertices(vertices, "vertices")
        labels = np.unique(self._operators.labels[chosen])
        if len(labels) != 1:
            msg = f"vertices lie in {len(labels)} components: a mean needs them in one"
            raise ValueError(msg)
        heights = np.ones(len(chosen))
        if weights is not None:
            heights = check_values(weights, "weights", len(chosen), ndim=1)
            if not (heights > 0).all():
                place = int((heights <= 0).argmax())
                msg = f"weights[{place}] is {heights[place]}, expected more than 0"
                raise ValueError(msg)
        return frechet_mean(self._along(method), chosen, heights)

    def logarithm(self, vertex: int, method: GeodesicMethod = "auto") -> LogarithmMap:
        """Normal coordinates about a vertex: where all others lie as seen from there.

        Parameters
        ----------
        vertex : int
            The vertex.
        method : {"auto", "graph", "heat", "exact"}
            As in `SimplicialComplex.geodesic_distances`; the more exact the better.

        Returns
        -------
        LogarithmMap
            It takes exact distances from seven vertices, or by the heat method from some
            twenty for K = 2, forty for K = 3. Near
            points that several shortest paths lead to, directions are between theirs.

        Raises
        ------
        ValueError
            Too few vertices around for a tangent space.
        """
        chosen = self._check_vertices([vertex], "vertex")
        return logarithm_map(self._along(method), self._complex, int(chosen[0]))

    # ---------------------------------------------------------------------- charts

    def charts(
        self,
        method: ChartMethod = "auto",
        *,
        max_distortion: float = 2.0,
        progress: bool | Callback | None = None,
    ) -> Atlas:
        """Coordinates: parts laid out in R^K, with the ways between them and back.

        Parameters
        ----------
        method : {"auto", "rigid", "conformal", "tangent"}
            "rigid", which "auto" stands for: as rigid as possible, for any K. On
            surfaces it starts from a conformal map, and follows from lengths alone, else
            from a projection. "conformal": least squares conformal maps, for surfaces.
            "tangent": projections onto the mean tangent space of each part.
        max_distortion : float
            More than 1. No length is stretched or shrunk by a larger factor in a chart;
            parts where one would be are cut in two. Slivers decide: a larger bound
            gives fewer charts.
        progress : bool or callable, optional
            True for a bar, or a function of (step, done, total).

        Returns
        -------
        Atlas
            Each simplex belongs to one chart first. No chart turns a simplex over or
            lays one on another.

        Raises
        ------
        ValueError
            A method for surfaces elsewhere, or a distortion that is none.

        References
        ----------
        B. Levy, S. Petitjean, N. Ray, J. Maillot, Least squares conformal maps for
        automatic texture atlas generation, ACM Transactions on Graphics 21(3), 2002.

        L. Liu, L. Zhang, Y. Xu, C. Gotsman, S. J. Gortler, A local/global approach to
        mesh parameterization, Computer Graphics Forum 27(5), 2008.

        W. T. Tutte, How to draw a graph, Proceedings of the London Mathematical Society
        13, 1963.

        Examples
        --------
        >>> import remanifold as rm
        >>> roll = rm.reconstruct(rm.datasets.swiss_roll(1000, random_state=0), 2)
        >>> atlas = roll.calculus.charts()
        >>> len(atlas), atlas.charts[0].coordinates.shape
        (1, (1000, 2))
        """
        check_choice(method, "method", CHART_METHODS)
        if method == "conformal" and self._complex.dim != 2:
            msg = (
                f'method is "conformal", which is for surfaces, and the dimension is '
                f'{self._complex.dim}: use "rigid"'
            )
            raise ValueError(msg)
        limit = check_positive(max_distortion, "max_distortion")
        if limit <= 1:
            msg = f"max_distortion is {max_distortion}, expected more than 1"
            raise ValueError(msg)
        with progress_callback(progress) as callback:
            return make_atlas(self._complex, method, limit, self._make, callback)

    # -------------------------------------------------------------------- geometry

    def angle_defects(self) -> AngleDefects:
        """Gaussian curvature of a surface, from the angles of its triangles.

        Returns
        -------
        AngleDefects
            With the check of Gauss and Bonnet. It follows from lengths alone. Defects
            are exact as integrals; over the area of a vertex of random triangles they
            scatter and do not converge, where `curvature` does.

        Raises
        ------
        ValueError
            K is not 2.
        """
        if self._complex.dim != 2:
            msg = (
                f"angle defects are for surfaces, and the dimension is "
                f"{self._complex.dim}: see curvature()"
            )
            raise ValueError(msg)
        return angle_defects(self._operators)

    def curvature(self) -> Curvature:
        """Second fundamental form at the vertices, and the curvatures that follow.

        Returns
        -------
        Curvature
            By polynomials of degree 3 over a tangent space, fitted to two neighbors a
            coefficient at least, out of one to four rings of edges. Needs coordinates;
            where only products or distances are known `ComplexData.coordinates` are
            taken. At the boundary neighbors lie on one side only, and errors are
            several times larger.

        References
        ----------
        F. Cazals, M. Pouget, Estimating differential quantities using polynomial
        fitting of osculating jets, Computer Aided Geometric Design 22, 2005.
        """
        whole = self._complex
        hyper = whole.vertices is not None and whole.ambient_dim == whole.dim + 1
        normals = None
        if hyper and whole.topology().orientable:
            normals = np.nan_to_num(vertex_normals(whole))
        return curvature(whole, normals)

    def element_shapes(self) -> Floats:
        """How regular the simplices are: what errors of all the above grow with.

        Returns
        -------
        ndarray, shape (M,), float64
            1 for regular simplices, 0 for flat ones: the K-volume over that of a regular
            simplex with the same mean square of the edges.
        """
        return shapes(self._complex)

    # ---------------------------------------------------------------------- checks

    @functools.cached_property
    def _surface(self) -> Surface:
        return Surface(self._complex)

    def _along(self, method: GeodesicMethod) -> Distances:
        check_choice(method, "method", METHODS)
        if method not in self._distances:
            self._distances[method] = Distances(self._complex, method)
        return self._distances[method]

    def _check_degree(self, degree: Any, least: int, less: int = 0) -> int:
        most = self._complex.dim + less
        number = check_int(degree, "degree", minimum=least)
        if number > most:
            msg = f"degree is {number}, expected {least} to {most}"
            raise ValueError(msg)
        return number

    def _check_form(self, form: ArrayLike, degree: int) -> Floats:
        return check_values(form, "form", len(self._operators.faces(degree)), ndim=1)

    def _check_function(
        self,
        values: ArrayLike,
        name: str,
        ndim: int | None = None,
        operators: Operators | None = None,
    ) -> Floats:
        """Finite where functions have values, zero elsewhere."""
        used = (operators or self._operators).used
        return check_values_where(values, name, used, ndim)

    @property
    def _in_simplices(self) -> NDArray[np.bool_]:
        found = np.zeros(self._complex.num_vertices, dtype=np.bool_)
        found[self._complex.simplices] = True
        return found

    def _check_vertices(
        self,
        vertices: ArrayLike | None,
        name: str,
        operators: Operators | None = None,
    ) -> NDArray[np.int64]:
        if vertices is None:
            return np.empty(0, dtype=np.int64)
        chosen = check_selection(vertices, name, self._complex.num_vertices)
        missing = ~(operators or self._operators).used[chosen]
        if missing.any():
            place = int(missing.argmax())
            msg = (
                f"{name}[{place}] is vertex {chosen[place]}, which is in no simplex "
                "with volume: see missing_vertices"
            )
            raise ValueError(msg)
        return chosen

    def _over_volumes(self, sums: Floats, operators: Operators | None = None) -> Floats:
        volumes = (operators or self._operators).volumes.reshape(
            -1, *(1,) * (sums.ndim - 1)
        )
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(volumes > 0, sums / volumes, np.nan)
