# SPDX-License-Identifier: GPL-3.0-or-later
"""A complex in space: positions of the vertices and simplices between them."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold import _core, interoperability
from remanifold._read_only import ReadOnlyArrays
from remanifold._validation import check_cells, check_int, check_points
from remanifold.graphs import edge_graph
from remanifold.io import write_complex
from remanifold.topology import Topology, topology_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    from remanifold._validation import Kind
    from remanifold.io._source import StrPath


@dataclass(frozen=True, eq=False, repr=False)
class SimplicialComplex(ReadOnlyArrays):
    """A pure K-dimensional simplicial complex in R^D. Arrays are read-only.

    Parameters
    ----------
    vertices : array_like, shape (N, D)
        Positions; vertices that no simplex uses are allowed.
    simplices : array_like, shape (M, K+1)
        K-simplices, indices of vertices.

    Attributes
    ----------
    vertices : ndarray, shape (N, D), float64, or None
        Positions of the vertices; None where only their inner products or distances are
        known.
    simplices : ndarray, shape (M, K+1), int32
        K-simplices.

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

    vertices: NDArray[np.float64] | None
    simplices: NDArray[np.int32]
    # How the samples are known where they have no coordinates: "gram" or "distances".
    _products: tuple[Kind, NDArray[np.float64]] | None = field(
        default=None, kw_only=True
    )

    def __post_init__(self) -> None:
        """Check what was given; coordinates that are as they should be are not copied."""
        if self.vertices is None:
            msg = "vertices must be an array of shape (N, D), got None"
            raise TypeError(msg)
        vertices = check_points(self.vertices, "vertices").view()
        object.__setattr__(self, "vertices", vertices)
        simplices = check_cells(self.simplices, len(vertices))
        object.__setattr__(self, "simplices", simplices)
        super().__post_init__()

    def __repr__(self) -> str:
        ambient = (
            "" if self.ambient_dim is None else f", ambient_dim={self.ambient_dim}"
        )
        return (
            f"{type(self).__name__}(vertices={self.num_vertices}{ambient}, "
            f"dim={self.dim}, simplices={len(self.simplices)})"
        )

    @property
    def dim(self) -> int:
        """K, the dimension of the simplices."""
        return int(self.simplices.shape[1]) - 1

    @property
    def ambient_dim(self) -> int | None:
        """D, the number of coordinates; None where only products are known."""
        return None if self.vertices is None else self.vertices.shape[1]

    @property
    def num_vertices(self) -> int:
        """N, whether simplices use them or not."""
        if self.vertices is not None:
            return len(self.vertices)
        assert self._products is not None
        return len(self._products[1])

    @functools.cached_property
    def edges(self) -> NDArray[np.int32]:
        """Edges of the simplices, (E, 2), i < j, sorted; computed when first asked for."""
        edges = _core.edges(self.simplices, self.num_vertices)
        edges.flags.writeable = False
        return edges

    def write(
        self,
        path: StrPath,
        fields: Mapping[str, ArrayLike] | None = None,
        *,
        format: str | None = None,
    ) -> None:
        """Write the complex to a file; its suffix names the format.

        Parameters
        ----------
        path : str or path-like
            The file: ``.ply``, ``.obj``, ``.off``, ``.stl``, ``.vtk``, ``.vtu``,
            ``.glb``, ``.gltf``, or ``.npz`` for any K and D. See `io.write_mesh`.
        fields : mapping of str to array_like, optional
            Values at the vertices, of shape (N,) or (N, C): numbers or bool.
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
        return interoperability.to_gudhi(self, filtration)

    def to_trimesh(self, fields: Mapping[str, ArrayLike] | None = None) -> Any:
        """Triangles as an object of trimesh; see `interoperability.to_trimesh`."""
        return interoperability.to_trimesh(self, fields)

    def to_pyvista(self, fields: Mapping[str, ArrayLike] | None = None) -> Any:
        """Mesh or grid of PyVista; see `interoperability.to_pyvista`."""
        return interoperability.to_pyvista(self, fields)

    def to_meshio(self, fields: Mapping[str, ArrayLike] | None = None) -> Any:
        """Mesh of meshio; see `interoperability.to_meshio`."""
        return interoperability.to_meshio(self, fields)

    def to_networkx(self) -> Any:
        """Graph of NetworkX, with lengths; see `interoperability.to_networkx`."""
        return interoperability.to_networkx(self)

    def to_scipy_graph(self) -> Any:
        """Sparse matrix of the lengths of the edges; see `edge_graph`."""
        return edge_graph(self)

    @classmethod
    def from_meshio(cls, mesh: Any, dim: int | None = None) -> SimplicialComplex:
        """Complex of a mesh of meshio; see `interoperability.from_meshio`."""
        return interoperability.from_meshio(mesh, dim)

    def component_labels(self) -> NDArray[np.int32]:
        """Component of each vertex, in order of lowest vertex; -1 in no simplex."""
        return _core.component_labels(self.simplices, self.num_vertices)

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
        from remanifold.plotting import plot

        return plot(self, **options)

    def topology(self, component: int | None = None) -> Topology:
        """Topology of the complex, computed once, or of one of its components.

        Parameters
        ----------
        component : int, optional
            Label of a component, as in `component_labels`.

        Returns
        -------
        Topology

        Raises
        ------
        ValueError
            No component has this label.
        """
        if component is None:
            return self._topology
        count = self._topology.components
        index = check_int(component, "component", minimum=0)
        if index >= count:
            msg = f"component is {index}, expected 0 to {count - 1}"
            raise ValueError(msg)
        simplices = np.sort(self.simplices, axis=1)
        own = self.component_labels()[simplices[:, 0]] == index
        return topology_of(simplices[own], self.num_vertices)

    @property
    def _source(self) -> tuple[Kind, NDArray[np.float64]]:
        """The positions, or the products as they were given."""
        if self.vertices is not None:
            return "points", self.vertices
        assert self._products is not None
        return self._products

    @functools.cached_property
    def _topology(self) -> Topology:
        return topology_of(np.sort(self.simplices, axis=1), self.num_vertices)
