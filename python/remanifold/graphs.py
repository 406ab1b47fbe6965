# SPDX-License-Identifier: GPL-3.0-or-later
"""The edges of a complex as a sparse matrix."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.simplicial_complex import SimplicialComplex


def edge_lengths(complex_: SimplicialComplex) -> NDArray[np.float64]:
    """Length of each edge."""
    edges = complex_.edges
    coordinates = complex_.coordinates
    block = max(1, 2**21 // coordinates.shape[1])
    lengths = np.empty(len(edges))
    for start in range(0, len(edges), block):
        tail, head = edges[start : start + block].T
        lengths[start : start + block] = np.linalg.norm(
            coordinates[head] - coordinates[tail], axis=1
        )
    return lengths


def edge_graph(complex_: SimplicialComplex) -> Any:
    """Symmetric scipy.sparse.csr_matrix, (N, N), of the lengths of the edges."""
    try:
        from scipy.sparse import csr_matrix
    except ImportError as error:
        msg = "graphs need SciPy: pip install remanifold[geodesic]"
        raise ImportError(msg) from error
    edges, lengths = complex_.edges, edge_lengths(complex_)
    rows = np.concatenate([edges[:, 0], edges[:, 1]])
    columns = np.concatenate([edges[:, 1], edges[:, 0]])
    count = complex_.num_vertices
    return csr_matrix((np.tile(lengths, 2), (rows, columns)), shape=(count, count))
