# SPDX-License-Identifier: GPL-3.0-or-later
"""What a complex in space is: positions of the vertices and simplices between them."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold import _core
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.samples import Points
from remanifold._base.scaling import ClassicalScaling, classical_scaling
from remanifold._base.validation import check_int
from remanifold.complex.topology import Topology, topology_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold._base.progress import Callback
    from remanifold._base.samples import Input


@dataclass(frozen=True, eq=False, repr=False)
class ComplexData(ReadOnlyArrays):
    """What all functions of complexes know of one; `SimplicialComplex` has them as methods.

    The arrays are known to be in order.
    """

    vertices: NDArray[np.float64] | None
    simplices: NDArray[np.int32]
    vertex_attributes: dict[str, NDArray[Any]] = field(
        default_factory=dict, kw_only=True
    )
    # How the samples are known where they have no coordinates.
    _products: Input | None = field(default=None, kw_only=True)

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
        return len(self._products)

    @functools.cached_property
    def edges(self) -> NDArray[np.int32]:
        """Edges of the simplices, (E, 2), i < j, sorted; computed when first asked for."""
        edges = _core.edges(self.simplices, self.num_vertices)
        edges.flags.writeable = False
        return edges

    @functools.cached_property
    def coordinates(self) -> NDArray[np.float64]:
        """Positions of the vertices, (N, D); computed when first asked for.

        Where only inner products or distances are known, an isometric embedding about
        the centroid of the vertices (classical scaling), with as many columns as these
        span: as exact as square roots of products are, about eight digits. It takes
        O(N^3) time and O(N^2) memory.
        """
        if self.vertices is not None:
            return self.vertices
        return self._scaling.coordinates

    def component_labels(self) -> NDArray[np.int32]:
        """Component of each vertex, in order of lowest vertex; -1 in no simplex.

        Returns
        -------
        ndarray, shape (N,), int32
        """
        return _core.component_labels(self.simplices, self.num_vertices)

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

    @functools.cached_property
    def _topology(self) -> Topology:
        return topology_of(np.sort(self.simplices, axis=1), self.num_vertices)

    @property
    def comment(self) -> str | None:
        """What a file that it is written to says of where it comes from, if anything."""
        return None

    @property
    def _source(self) -> Input:
        """The positions, or the products as they were given."""
        if self.vertices is not None:
            return Points(self.vertices)
        assert self._products is not None
        return self._products

    @functools.cached_property
    def _scaling(self) -> ClassicalScaling:
        assert self._products is not None
        found = classical_scaling(self._products)
        found.coordinates.flags.writeable = False
        return found

    def _search(self, num_threads: int, progress: Callback | None) -> Any:
        """The spatial index, made when first asked for."""
        index = vars(self).get("_search_index")
        if index is None:
            coordinates = self.coordinates
            if not np.isfinite(coordinates).all():  # of vertices in no simplex
                coordinates = np.nan_to_num(coordinates)
            index = _core.SimplexSearch(
                coordinates, self.simplices, num_threads, progress
            )
            vars(self)["_search_index"] = index
        return index

    def __getstate__(self) -> dict[str, Any]:
        """All but the spatial index and what was factorized: they are made again."""
        state = dict(vars(self))
        state.pop("_search_index", None)
        state.pop("calculus", None)
        return state


def check_complex(value: Any, name: str = "complex") -> None:
    """Refuse what is no complex in space."""
    if not isinstance(value, ComplexData):
        msg = f"{name} must be a SimplicialComplex, got {type(value).__name__}"
        raise TypeError(msg)
