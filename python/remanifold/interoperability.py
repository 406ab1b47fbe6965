# SPDX-License-Identifier: GPL-3.0-or-later
"""Complexes as the objects of other libraries, and back."""

from __future__ import annotations

from typing import Any

from remanifold.formats.objects import (
    to_gudhi,
    to_meshio,
    to_networkx,
    to_pyvista,
    to_trimesh,
)
from remanifold.results.simplicial_complex import SimplicialComplex

__all__ = [
    "from_meshio",
    "to_gudhi",
    "to_meshio",
    "to_networkx",
    "to_pyvista",
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
