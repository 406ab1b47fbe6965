# SPDX-License-Identifier: GPL-3.0-or-later
"""Complexes, and parts of them, with all that can be asked of them as methods."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold._base.deprecated import renamed
from remanifold._base.html import fragment
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line
from remanifold._base.validation import (
    check_cells,
    check_int,
    check_points,
    float_rows,
)
from remanifold.calculus import geodesics
from remanifold.calculus.calculus import Calculus
from remanifold.complex import normals, parts, projection
from remanifold.complex.data import ComplexData
from remanifold.complex.graphs import edge_graph
from remanifold.complex.topology import simplex_names
from remanifold.drawing.draw_svg import picture
from remanifold.drawing.plotting import plot
from remanifold.formats import objects
from remanifold.formats.writing import check_fields, write_complex
from remanifold.remeshing import resampling, simplification, subdivision
from remanifold.remeshing.volume import VolumeEstimate, estimate_volume

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Literal

    from numpy.typing import ArrayLike, NDArray

    from remanifold._base.files import StrPath
    from remanifold._base.progress import Callback
    from remanifold.calculus.geodesics import GeodesicMethod
    from remanifold.complex.parts import Part
    from remanifold.complex.projection import PointsOnComplex, Projection, RandomState
    from remanifold.formats.objects import Fields


def _positions(vertices: ArrayLike, simplices: ArrayLike) -> NDArray[np.float64]:
    """Finite, but for rows of NaN that are in no simplex."""
    given, cells = float_rows(vertices, "vertices"), np.asarray(simplices)
    if given.ndim == 2 and given.dtype.kind == "f" and cells.dtype.kind in "iu":
        nowhere = np.isnan(given).all(axis=1)
        nowhere[cells[(cells >= 0) & (cells < len(given))]] = False
        if nowhere.any():
            filled = np.where(nowhere[:, None], 0.0, given)
            whole = np.array(check_points(filled, "vertices"))
            whole[nowhere] = np.nan
            return whole
    own: NDArray[np.float64] = check_points(vertices, "vertices").view()
    return own


@dataclass(frozen=True, eq=False, repr=False)
class SimplicialComplex(ComplexData):
    """A pure K-dimensional simplicial complex in R^D. Arrays are read-only.

    Parameters
    ----------
    vertices : array_like, shape (N, D)
        Positions; vertices that no simplex uses are allowed, and may be NaN.
    simplices : array_like, shape (M, K+1)
        K-simplices, indices of vertices.
    vertex_attributes : mapping of str to array_like, optional
        What is known of each vertex, such as its color: numbers or bool of shape (N,) or
        (N, C).

    Attributes
    ----------
    vertices : ndarray, shape (N, D), float64, or None
        Positions of the vertices; None where only their inner products or distances are
        known.
    simplices : ndarray, shape (M, K+1), int32
        K-simplices.
    vertex_attributes : dict of str to ndarray
        As given; `subset` and its like take them along, `write` writes them.

    Raises
    ------
    ValueError
        Wrong shape, not finite, or an index out of range.

    Examples
    --------
    >>> import remanifold as rm
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> rm.SimplicialComplex(square, [[0, 1, 2], [0, 2, 3]])
    SimplicialComplex(vertices=4, ambient_dim=2, dim=2, simplices=2)
    """

    def __post_init__(self) -> None:
        """Check what was given; coordinates that are as they should be are not copied."""
        if self.vertices is None:
            msg = "vertices must be an array of shape (N, D), got None"
            raise TypeError(msg)
        vertices = _positions(self.vertices, self.simplices)
        object.__setattr__(self, "vertices", vertices)
        simplices = check_cells(self.simplices, len(vertices))
        object.__setattr__(self, "simplices", simplices)
        attributes = check_fields(
            self.vertex_attributes, len(vertices), "vertex_attributes"
        )
        copies = {name: array.copy() for name, array in attributes.items()}
        object.__setattr__(self, "vertex_attributes", copies)
        super().__post_init__()

    def __repr__(self) -> str:
        return one_line(
            self,
            vertices=self.num_vertices,
            ambient_dim=self.ambient_dim,
            dim=self.dim,
            simplices=len(self.simplices),
        )

    def _repr_html_(self) -> str:
        found = self.topology()
        rows: list[tuple[str, object]] = [("vertices", f"{self.num_vertices:,}")]
        if self.ambient_dim is not None:
            rows.append(("coordinates", self.ambient_dim))
        rows.append((simplex_names(self.dim)[-1], f"{len(self.simplices):,}"))
        rows.append(("Euler characteristic", f"{found.euler_characteristic:,}"))
        if found.counting_settles_homology:
            rows.append(("Betti numbers", ", ".join(map(str, found.betti_numbers))))
        if self.vertex_attributes:
            rows.append(("attributes", ", ".join(self.vertex_attributes)))
        return fragment(found.description, rows, picture(self))

    @functools.cached_property
    def vertex_normals(self) -> NDArray[np.float64]:
        """Unit normals at the vertices, (N, D), where K = D - 1; computed when asked for.

        Those of the simplices around a vertex, so weighted that they are exact where the
        vertices lie on a sphere. They point outwards where the simplices are oriented
        so; NaN where there is none: at vertices in no simplex, and where orientations
        contradict each other.

        References
        ----------
        N. Max, Weights for computing vertex normals from facet normals, Journal of
        Graphics Tools 4(2), 1999.
        """
        found = normals.vertex_normals(self)
        found.flags.writeable = False
        return found

    def write(
        self,
        path: StrPath,
        fields: Literal["auto"] | Mapping[str, ArrayLike] | None = "auto",
        *,
        format: str | None = None,
    ) -> None:
        """Write the complex to a file; its suffix names the format.

        Parameters
        ----------
        path : str or path-like
            The file: ``.ply``, ``.obj``, ``.off``, ``.stl``, ``.vtk``, ``.vtu``,
            ``.glb``, ``.gltf``, or ``.npz`` for any K and D. See `io.write_mesh`.
        fields : "auto", None or mapping of str to array_like
            Values at the vertices, of shape (N,) or (N, C): numbers or bool. "auto":
            those of `vertex_attributes` that the format holds.
        format : str, optional
            The format by its suffix, such as "ply", whatever the name of the file.

        Raises
        ------
        ValueError
            If the format cannot hold the complex.
        OSError
            If the file cannot be written. Nothing is left behind.
        """
        write_complex(path, self, fields, format=format)

    def to_gudhi(self, filtration: ArrayLike | None = None) -> Any:
        """Simplex tree of GUDHI; see `interoperability.to_gudhi`."""
        return objects.to_gudhi(self, filtration)

    def to_trimesh(self, fields: Fields = "auto") -> Any:
        """Triangles as an object of trimesh; see `interoperability.to_trimesh`."""
        return objects.to_trimesh(self, fields)

    def to_pyvista(self, fields: Fields = "auto") -> Any:
        """Mesh or grid of PyVista; see `interoperability.to_pyvista`."""
        return objects.to_pyvista(self, fields)

    def to_meshio(self, fields: Fields = "auto") -> Any:
        """Mesh of meshio; see `interoperability.to_meshio`."""
        return objects.to_meshio(self, fields)

    def to_open3d(self, fields: Fields = "auto") -> Any:
        """Line set or mesh of Open3D; see `interoperability.to_open3d`."""
        return objects.to_open3d(self, fields)

    def to_scipy(self) -> objects.Matrices:
        """Adjacency and boundary operators; see `interoperability.to_scipy`."""
        return objects.to_scipy(self)

    def to_networkx(self, fields: Fields = "auto") -> Any:
        """Graph of NetworkX, with lengths; see `interoperability.to_networkx`."""
        return objects.to_networkx(self, fields)

    def to_scipy_graph(self) -> Any:
        """Sparse matrix of the lengths of the edges; see `edge_graph`."""
        return edge_graph(self)

    @classmethod
    def from_meshio(cls, mesh: Any, dim: int | None = None) -> SimplicialComplex:
        """Complex of a mesh of meshio; see `interoperability.from_meshio`."""
        return SimplicialComplex(*objects.arrays_of_meshio(mesh, dim))

    def plot(self, **options: Any) -> Any:
        """Draw the complex, by PyVista, Plotly or Matplotlib.

        Parameters
        ----------
        **options
            Those of `remanifold.plot`: ``color=``, ``show_samples=``, ``screenshot=``,
            ``backend=`` and others.

        Returns
        -------
        pyvista.Plotter, plotly.graph_objects.Figure or matplotlib.figure.Figure
        """
        return plot(self, **options)

    def project(
        self,
        points: ArrayLike | None = None,
        *,
        products: ArrayLike | None = None,
        squared_norms: ArrayLike | None = None,
        distances: ArrayLike | None = None,
        num_threads: int | None = None,
        progress: bool | Callback | None = None,
    ) -> Projection:
        """Nearest points of the complex, exact up to rounding.

        Simplices whose distances agree up to rounding are equally near, and the first
        of them is taken. The answer for one point does not depend on the others. The
        first call builds a tree over the simplices, which later ones use again.

        Parameters
        ----------
        points : array_like, shape (Q, D), optional
            Points of the space.
        products, squared_norms : array_like, shape (Q, N) and (Q,), optional
            Instead of `points` where the complex comes from ``gram=``: inner products
            of each point with each of the N vertices, and with itself.
        distances : array_like, shape (Q, N), optional
            Instead of `points` where it comes from ``distances=``: from each point to
            each of the N vertices.
        num_threads : int, optional
            All cores by default. The result does not depend on it.
        progress : bool or callable, optional
            True for a bar, or a function of (step, done, total).

        Returns
        -------
        Projection

        Raises
        ------
        ValueError
            Wrong shape, not finite, or a complex without simplices.
        TypeError
            Points given in another way than the vertices are known.

        Examples
        --------
        >>> import remanifold as rm
        >>> triangle = rm.SimplicialComplex([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> found = triangle.project([[1, 1, 3], [9, -2, 0]])
        >>> found.points.tolist(), found.distances.round(3).tolist()
        ([[1.0, 1.0, 0.0], [4.0, 0.0, 0.0]], [3.0, 5.385])
        """
        return projection.project(
            self,
            points,
            products=products,
            squared_norms=squared_norms,
            distances=distances,
            num_threads=num_threads,
            progress=progress,
        )

    def interpolate(
        self,
        values: ArrayLike,
        points: ArrayLike | PointsOnComplex,
        *,
        num_threads: int | None = None,
    ) -> NDArray[np.float64]:
        """Values at points, linear on each simplex between those at the vertices.

        Parameters
        ----------
        values : array_like, shape (N,) or (N, C)
            One value, or C of them, for each vertex; those of vertices in no simplex
            are ignored.
        points : array_like, shape (Q, D), or PointsOnComplex
            Points, whose projections are taken, or the result of `project` or `sample`.
        num_threads : int, optional
            All cores by default. The result does not depend on it.

        Returns
        -------
        ndarray, shape (Q,) or (Q, C), float64

        Examples
        --------
        >>> import remanifold as rm
        >>> segment = rm.SimplicialComplex([[0, 0], [4, 0]], [[0, 1]])
        >>> segment.interpolate([10, 20], [[1, 7], [9, 0]]).tolist()
        [12.5, 20.0]
        """
        return projection.interpolate(self, values, points, num_threads=num_threads)

    def sample(
        self,
        num_points: int,
        random_state: RandomState = None,
        *,
        rng: RandomState = None,
    ) -> PointsOnComplex:
        """Independent points of the complex, uniform by K-volume.

        Parameters
        ----------
        num_points : int
            How many.
        random_state : int, Generator, RandomState or None
            A seed for the same points again, or a generator.
        rng
            The same, deprecated.

        Returns
        -------
        PointsOnComplex
            With the simplices the points lie in, and their barycentric coordinates,
            which `interpolate` takes.

        Raises
        ------
        ValueError
            A complex of no volume.
        """
        state = renamed("rng", rng, "random_state", random_state)
        return projection.sample(self, self.simplex_volumes, num_points, state)

    @functools.cached_property
    def simplex_volumes(self) -> NDArray[np.float64]:
        """K-volume of each simplex, (M,), never negative; computed when first asked for.

        Lengths, areas, volumes; 1 for points, so that their volume is their number.
        """
        volumes = projection.simplex_volumes(self)
        volumes.flags.writeable = False
        return volumes

    def volume(self) -> float:
        """K-volume of the complex: the length of a curve, the area of a surface.

        Returns
        -------
        float
        """
        return float(self.simplex_volumes.sum())

    def estimate_volume(self) -> VolumeEstimate:
        """K-volume of the manifold itself, which `volume` falls short of.

        Every edge is halved at a point of the fitted manifold, as `subdivide` does, and
        what the volume gains by this tells what more halving would give (Richardson).

        Returns
        -------
        VolumeEstimate
            In units of length^K. On closed manifolds with samples dense enough the error
            is about a hundredth of that of `volume`. At a boundary samples say only how
            far they reach, and ``error`` is mostly what they may miss there.

        Raises
        ------
        ImportError
            SciPy is not installed: ``pip install remanifold[calculus]``.

        Examples
        --------
        >>> import remanifold as rm
        >>> sphere = rm.reconstruct(rm.datasets.sphere(500, random_state=0), 2)
        >>> round(sphere.volume(), 2), round(sphere.estimate_volume().value, 2)
        (12.42, 12.57)
        """
        return estimate_volume(self)

    @functools.cached_property
    def calculus(self) -> Calculus[SimplicialComplex]:
        """Functions on the complex, its spectrum, paths and curvature; see `Calculus`.

        Made when first asked for, and kept with the factorizations that it needs.
        """
        return Calculus(self, _complex_of)

    def geodesic_distances(
        self, sources: ArrayLike, method: GeodesicMethod = "auto"
    ) -> NDArray[np.float64]:
        """Lengths of the shortest paths along the complex from some vertices to all.

        Parameters
        ----------
        sources : int or array_like of int, shape (S,)
            Vertices to start at, each on its own.
        method : {"auto", "graph", "heat", "exact"}
            "graph": along the edges, exact on curves, too long elsewhere. "exact":
            across the triangles, for surfaces that are manifolds, from the lengths of
            their edges, so for any D. "heat": the heat method, off by some percent; on
            surfaces in space by potpourri3d, else by linear elements, for any K and D.
            "auto": "graph" on curves, "exact" on surfaces that are manifolds where it
            takes no more than a few seconds (N^2 S up to 5e8, so 22,000 vertices and one
            source, or 2,200 and a hundred), "heat" else. "graph" and "heat" need
            ``pip install remanifold[geodesic]``.

        Returns
        -------
        ndarray, shape (S, N), float64
            Infinite where no path leads.

        Raises
        ------
        ValueError
            A source that is no vertex, or in no simplex; a method for other complexes.
        ImportError
            A package is missing; says which.

        References
        ----------
        K. Crane, C. Weischedel, M. Wardetzky, Geodesics in heat: a new approach to
        computing distance based on heat flow, ACM Transactions on Graphics 32(5), 2013.

        S.-Q. Xin, G.-J. Wang, Improving Chen and Han's algorithm on the discrete
        geodesic problem, ACM Transactions on Graphics 28(4), 2009.
        """
        return geodesics.geodesic_distances(self, sources, method)

    def simplify(
        self,
        num_vertices: int | None = None,
        max_error: float | None = None,
        *,
        keep: ArrayLike | None = None,
        even: bool = False,
        progress: bool | Callback | None = None,
    ) -> SimplifiedComplex:
        """Fewer vertices and simplices, with the same topology and the same openings.

        Edges are collapsed, those first that change the shape least. Vertices that are
        left stay where they are and keep their attributes, so that this works for any K
        and D, and where only inner products or distances are known.

        Parameters
        ----------
        num_vertices : int, optional
            Stop when no more vertices are left.
        max_error : float, optional
            Stop where a vertex that goes would lie farther from the result, in the unit
            of the coordinates. One of both has to be given.
        keep : array_like of bool, shape (N,), or of int, optional
            Vertices that must stay.
        even : bool
            Collapse the shortest edges first, so that what is left is spread evenly
            instead of dense where the manifold bends.
        progress : bool or callable, optional
            True for a bar, or a function of (step, done, total).

        Returns
        -------
        SimplifiedComplex
            With how far each vertex lies from it.

        Raises
        ------
        ValueError
            A number that is too small, or a complex without edges.
        TypeError
            Neither num_vertices nor max_error.

        Notes
        -----
        An edge collapses where the links of its ends have no more in common than its own
        link; then a combinatorial manifold becomes one that is homeomorphic to it, with
        the boundary closed by a cone and so as it was. Vertices of the boundary move
        along it only. Vertices where the complex is no manifold (`Topology`) stay, and
        so do their edges to each other. Sheets that are near in space may come to cross.

        References
        ----------
        T. K. Dey, H. Edelsbrunner, S. Guha, D. V. Nekhayev, Topology preserving edge
        contraction, Publications de l'Institut Mathematique 66, 1999.

        E. Nevo, Higher minors and Van Kampen's obstruction, Mathematica Scandinavica
        101(2), 2007.

        Examples
        --------
        >>> import numpy as np
        >>> import remanifold as rm
        >>> line = rm.SimplicialComplex(np.arange(10)[:, None], [[i, i + 1] for i in range(9)])
        >>> line.simplify(max_error=0.1).simplices.tolist()
        [[0, 1]]
        """
        found = simplification.simplify(
            self, num_vertices, max_error, keep=keep, even=even, progress=progress
        )
        part = found.part
        return SimplifiedComplex(
            part.vertices,
            part.simplices,
            vertex_indices=part.vertex_indices,
            vertex_attributes=part.vertex_attributes,
            errors=found.errors,
            reached=found.reached,
            _products=part._products,
        )

    def subdivide(self, rounds: int = 1, *, fitted: bool = True) -> SimplicialComplex:
        """Cut each simplex into 2^K, with the new vertices on the fitted manifold.

        Parameters
        ----------
        rounds : int
            How often; each makes 2^K times as many simplices.
        fitted : bool
            Put new vertices where curves through the edges' ends, along their tangent
            spaces, pass: exact on spheres, of fourth order elsewhere. Otherwise, and for
            edges of the boundary of a region of R^K, in the middle of the edges. Needs
            ``pip install remanifold[calculus]``.

        Returns
        -------
        SimplicialComplex
            Its first N vertices are those of this complex. Of the last round its
            `vertex_attributes` have as ``edge`` the two vertices between which each lies,
            the same twice for those that were there.

        Raises
        ------
        ValueError
            More simplices than a complex can have, which is said before the first round.

        References
        ----------
        H. Edelsbrunner, D. R. Grayson, Edgewise subdivision of a simplex, Discrete and
        Computational Geometry 24, 2000.

        Examples
        --------
        >>> import remanifold as rm
        >>> square = rm.SimplicialComplex([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]])
        >>> len(square.subdivide(2).simplices)
        16
        """
        number = check_int(rounds, "rounds", minimum=1)
        subdivision.check_rounds(self, number)
        found = self
        for _ in range(number):
            finer = subdivision.subdivide(found, fitted=bool(fitted))
            own = np.repeat(
                np.arange(found.num_vertices, dtype=np.int32)[:, None], 2, 1
            )
            edge = np.concatenate([own, found.edges])
            found = SimplicialComplex(
                finer.vertices, finer.simplices, vertex_attributes={"edge": edge}
            )
        return found

    def resample(
        self, num_vertices: int, *, progress: bool | Callback | None = None
    ) -> SimplicialComplex:
        """Other vertices on the fitted manifold, evenly spread, with the same topology.

        Parameters
        ----------
        num_vertices : int
            How many; more than there are, or fewer.
        progress : bool or callable, optional
            True for a bar, or a function of (step, done, total).

        Returns
        -------
        SimplicialComplex
            By `subdivide` until there are four times as many to choose from, and
            `simplify` with ``even``. It has more vertices where the topology needs them.

        Raises
        ------
        ValueError
            Four times as many vertices could not be numbered.
        """
        found = resampling.resample(self, num_vertices, progress).part
        assert found.vertices is not None
        return SimplicialComplex(found.vertices, found.simplices)

    def subset(self, simplices: ArrayLike) -> Subcomplex:
        """Some of the simplices, with the vertices they use.

        Parameters
        ----------
        simplices : array_like of bool, shape (M,), or of int
            A mask, or rows of `simplices`, in any order, none twice.

        Returns
        -------
        Subcomplex
            Its `vertex_indices` lead back here.
        """
        return _as_complex(parts.subset(self, simplices))

    def components(self) -> list[Subcomplex]:
        """Connected components, in the order of `component_labels`.

        Returns
        -------
        list of Subcomplex
        """
        return [_as_complex(part) for part in parts.components(self)]

    def boundary_complex(self) -> Subcomplex:
        """The (K-1)-faces that lie in one simplex only.

        Each has the orientation that its simplex induces, so that the boundary of an
        oriented complex is oriented, but for the points that a curve ends in. A closed
        complex has a boundary without simplices and vertices.

        Returns
        -------
        Subcomplex
            Of dimension K - 1.

        Raises
        ------
        ValueError
            A complex of dimension 0.
        """
        return _as_complex(parts.boundary_complex(self))


@dataclass(frozen=True, eq=False, repr=False)
class Subcomplex(SimplicialComplex):
    """Part of another complex, with the vertices that it uses only.

    Attributes
    ----------
    vertices, simplices : ndarray
        As in `SimplicialComplex`; there may be none.
    vertex_attributes : dict of str to ndarray
        Those of the whole, for the vertices that are here.
    vertex_indices : ndarray, shape (N,), int32
        Number of each vertex in the complex that this is part of, ascending.
    """

    vertex_indices: NDArray[np.int32] = field(kw_only=True)

    def __post_init__(self) -> None:
        """Taken from a complex that was checked: nothing to check."""
        ReadOnlyArrays.__post_init__(self)


@dataclass(frozen=True, eq=False, repr=False)
class SimplifiedComplex(Subcomplex):
    """What `SimplicialComplex.simplify` left of another complex. Arrays are read-only.

    Attributes
    ----------
    vertices, simplices, vertex_attributes, vertex_indices
        As in `Subcomplex`; simplices are oriented as those they come from.
    errors : ndarray, shape (N of the other,), float64
        How far each vertex of the other complex lies from this one, at most: from the
        simplex that took the place of its own. Zero for those that are left, NaN for
        those in no simplex.
    reached : bool
        Whether as few vertices are left as were asked for.
    """

    errors: NDArray[np.float64] = field(kw_only=True)
    reached: bool = field(kw_only=True)


def _as_complex(part: Part) -> Subcomplex:
    return Subcomplex(
        part.vertices,
        part.simplices,
        vertex_indices=part.vertex_indices,
        vertex_attributes=part.vertex_attributes,
        _products=part._products,
    )


def _complex_of(
    vertices: NDArray[np.float64],
    simplices: NDArray[np.int32],
    attributes: dict[str, NDArray[Any]],
) -> SimplicialComplex:
    return SimplicialComplex(vertices, simplices, vertex_attributes=attributes)
