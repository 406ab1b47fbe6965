# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a complex, with the vertices that they use."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from remanifold._base.distinct import distinct
from remanifold._base.validation import check_selection
from remanifold.complex.data import ComplexData

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_KEY_BITS = 62  # of a number that stands for a row; one more is for a sign


@dataclass(frozen=True, eq=False, repr=False)
class Part(ComplexData):
    """The data of a `Subcomplex`."""

    vertex_indices: NDArray[np.int32] = field(kw_only=True)


def take(whole: ComplexData, simplices: NDArray[np.int32]) -> Part:
    """The part of a complex that has these simplices."""
    used = distinct(simplices).astype(np.int32)
    products = None if whole._products is None else whole._products.subset(used)
    return Part(
        vertices=None if whole.vertices is None else whole.vertices[used],
        simplices=np.searchsorted(used, simplices).astype(np.int32),
        vertex_attributes={n: a[used] for n, a in whole.vertex_attributes.items()},
        _products=products,
        vertex_indices=used,
    )


def subset(whole: ComplexData, simplices: ArrayLike) -> Part:
    """Some simplices, as `SimplicialComplex.subset` describes it."""
    chosen = check_selection(simplices, "simplices", len(whole.simplices))
    return take(whole, whole.simplices[chosen])


def components(whole: ComplexData) -> list[Part]:
    """Connected components in the order of their labels."""
    if len(whole.simplices) == 0:
        return []
    own = whole.component_labels()[whole.simplices[:, 0]]
    order = np.argsort(own, kind="stable")
    ends = np.cumsum(np.bincount(own))[:-1]
    return [take(whole, whole.simplices[rows]) for rows in np.split(order, ends)]


def boundary_complex(whole: ComplexData) -> Part:
    """Faces in one simplex, as `SimplicialComplex.boundary_complex` describes it."""
    if whole.dim == 0:
        msg = "a complex of points has no boundary"
        raise ValueError(msg)
    return take(whole, open_faces(whole.simplices))


def open_faces(simplices: NDArray[np.int32]) -> NDArray[np.int32]:
    """Faces in one simplex only, in the order of their sorted vertices."""
    faces = _faces(simplices)
    keys = face_keys(np.sort(faces, axis=1))
    if keys is not None:
        ascending = np.sort(keys)
        once = np.ones(len(keys) + 1, dtype=bool)
        once[1:-1] = ascending[1:] != ascending[:-1]
        alone = once[1:] & once[:-1]
        if not alone.any():  # as of all closed complexes: no order is needed
            return faces[:0]
        return np.asarray(faces[np.argsort(keys, kind="stable")[alone]])
    rows = np.sort(faces, axis=1)
    order = np.lexsort(rows.T[::-1])
    rows = rows[order]
    other = np.ones(len(faces) + 1, dtype=bool)
    other[1:-1] = (rows[1:] != rows[:-1]).any(axis=1)
    return np.asarray(faces[order[other[1:] & other[:-1]]])


def face_keys(ascending: NDArray[np.int32]) -> NDArray[np.int64] | None:
    """One number for each row of vertices, in the order of the rows, if 62 bits do.

    Numbers are sorted in a tenth of the time that rows take.
    """
    bits = int(ascending.max(initial=0)).bit_length()
    if bits * ascending.shape[1] > _KEY_BITS or ascending.shape[1] == 0:
        return None
    keys = ascending[:, 0].astype(np.int64)
    for column in ascending.T[1:]:
        keys <<= bits
        keys |= column
    return keys


def _faces(simplices: NDArray[np.int32]) -> NDArray[np.int32]:
    """All (K-1)-faces, with the orientation that the simplices induce."""
    columns = simplices.shape[1]
    faces = []
    for left_out in range(columns):
        face = np.delete(simplices, left_out, axis=1)
        if left_out % 2 and columns > 2:
            face[:, -2:] = face[:, :-3:-1].copy()
        faces.append(face)
    return np.concatenate(faces)
