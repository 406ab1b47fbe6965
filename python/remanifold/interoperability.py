# SPDX-License-Identifier: GPL-3.0-or-later
"""Complexes as the objects of other libraries, and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold.formats import objects
from remanifold.formats.objects import (
    Matrices,
    to_gudhi,
    to_meshio,
    to_networkx,
    to_open3d,
    to_pyvista,
    to_scipy,
    to_trimesh,
)
from remanifold.results.simplicial_complex import SimplicialComplex

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = [
    "Matrices",
    "from_gudhi",
    "from_meshio",
    "from_networkx",
    "from_open3d",
    "from_pyvista",
    "from_trimesh",
    "to_gudhi",
    "to_meshio",
    "to_networkx",
    "to_open3d",
    "to_pyvista",
    "to_scipy",
    "to_trimesh",
]


def from_meshio(mesh: Any, dim: int | None = None) -> SimplicialComplex:
    """Complex of a mesh of meshio.

    Parameters
    ----------
    mesh : meshio.Mesh
        Blocks of cells other than edges, triangles and tetrahedra are passed over.
    dim : int, optional
        Dimension of the simplices to take, by default the highest there is.

    Returns
    -------
    SimplicialComplex

    Raises
    ------
    ValueError
        No simplices of this dimension.
    """
    return SimplicialComplex.from_meshio(mesh, dim)


def from_trimesh(mesh: Any) -> SimplicialComplex:
    """Complex of a mesh of trimesh.

    Parameters
    ----------
    mesh : trimesh.Trimesh
        With its ``vertex_attributes``, and colors of its vertices as ``colors``.

    Returns
    -------
    SimplicialComplex
    """
    points, simplices = objects.arrays_of_trimesh(mesh)
    known = dict(getattr(mesh, "vertex_attributes", {}))
    visual: Any = getattr(mesh, "visual", None)
    if "colors" not in known and getattr(visual, "kind", None) == "vertex":
        known["colors"] = np.asarray(visual.vertex_colors)
    return SimplicialComplex(points, simplices, vertex_attributes=known)


def from_pyvista(mesh: Any, dim: int | None = None) -> SimplicialComplex:
    """Complex of a mesh or grid of PyVista.

    Parameters
    ----------
    mesh : pyvista.PolyData or pyvista.UnstructuredGrid
        Cells other than lines, triangles and tetrahedra are passed over. Its
        ``point_data`` of numbers become `vertex_attributes`.
    dim : int, optional
        Dimension of the simplices to take, by default the highest there is.

    Returns
    -------
    SimplicialComplex

    Raises
    ------
    ValueError
        No simplices of this dimension.
    """
    points, simplices = objects.arrays_of_pyvista(mesh, dim)
    data = {name: np.asarray(mesh.point_data[name]) for name in mesh.point_data.keys()}  # noqa: SIM118
    known = {n: a for n, a in data.items() if a.dtype.kind in "biuf" and a.ndim < 3}
    return SimplicialComplex(points, simplices, vertex_attributes=known)


def from_open3d(mesh: Any) -> SimplicialComplex:
    """Complex of an object of Open3D.

    Parameters
    ----------
    mesh : open3d.geometry.LineSet, TriangleMesh or TetraMesh
        Its colors and normals at the vertices become `vertex_attributes`.

    Returns
    -------
    SimplicialComplex
    """
    points, simplices = objects.arrays_of_open3d(mesh)
    known = {}
    for name in ("colors", "normals"):
        values = np.asarray(getattr(mesh, f"vertex_{name}", ()), dtype=np.float64)
        if len(values) == len(points):
            known[name] = values
    return SimplicialComplex(points, simplices, vertex_attributes=known)


def from_networkx(graph: Any) -> SimplicialComplex:
    """Curves of a graph of NetworkX.

    Parameters
    ----------
    graph : networkx.Graph
        Each node has its coordinates as ``pos``; vertices have the order of the nodes.

    Returns
    -------
    SimplicialComplex
        Of dimension 1.

    Raises
    ------
    ValueError
        A node without a position.
    """
    return SimplicialComplex(*objects.arrays_of_networkx(graph))


def from_gudhi(tree: Any, vertices: ArrayLike) -> SimplicialComplex:
    """Complex of the simplices of highest dimension of a simplex tree of GUDHI.

    Parameters
    ----------
    tree : gudhi.SimplexTree
        Its vertices are numbers of rows of `vertices`.
    vertices : array_like, shape (N, D)
        Positions, which a simplex tree has not.

    Returns
    -------
    SimplicialComplex
    """
    points = np.asarray(vertices, dtype=np.float64)
    return SimplicialComplex(points, objects.arrays_of_gudhi(tree))


def __dir__() -> list[str]:
    """Public names only."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
