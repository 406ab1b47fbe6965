# SPDX-License-Identifier: GPL-3.0-or-later
"""The graph of the edges of a complex."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from remanifold.complex import measures
from remanifold.complex.data import check_complex

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.complex.data import ComplexData

__all__ = ["edge_graph"]


def edge_graph(complex: ComplexData) -> Any:
    """Graph of the edges, with their lengths, as SciPy's graph routines take it.

    Parameters
    ----------
    complex : SimplicialComplex
        With coordinates, or known by products or distances.

    Returns
    -------
    scipy.sparse.csr_array, shape (N, N), float64
        Symmetric; entry (i, j) is the length of the edge. An edge of length zero is an
        entry that is stored.

    Raises
    ------
    ImportError
        SciPy is not installed.

    Examples
    --------
    >>> import remanifold as rm
    >>> path = rm.SimplicialComplex([[0, 0], [3, 4], [3, 5]], [[0, 1], [1, 2]])
    >>> rm.edge_graph(path).toarray().tolist()
    [[0.0, 5.0, 0.0], [5.0, 0.0, 1.0], [0.0, 1.0, 0.0]]
    """
    try:
        from scipy.sparse import csr_array
    except ImportError as error:
        msg = "the graph of the edges needs SciPy: pip install remanifold[graph]"
        raise ImportError(msg) from error
    check_complex(complex)
    i, j = complex.edges.T
    lengths = edge_lengths(complex)
    rows, columns = np.concatenate([i, j]), np.concatenate([j, i])
    shape = (complex.num_vertices, complex.num_vertices)
    return csr_array((np.tile(lengths, 2), (rows, columns)), shape=shape)


def edge_lengths(complex: ComplexData) -> NDArray[np.float64]:
    """Lengths of `edges`, in their order."""
    if complex.vertices is None:
        return np.sqrt(complex._source.squared_distances(*complex.edges.T))
    return measures.edge_lengths(complex.vertices, complex.edges)
