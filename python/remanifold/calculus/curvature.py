# SPDX-License-Identifier: GPL-3.0-or-later
"""Curvature: angle defects of surfaces, and second fundamental forms by local fits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from remanifold import _core
from remanifold._base.read_only import ReadOnlyArrays
from remanifold._base.text import one_line, rounded
from remanifold.complex.parts import open_faces

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from remanifold.calculus.operators import Operators
    from remanifold.complex.data import ComplexData

    Floats = NDArray[np.float64]

# As in the core: neighbors of a fit, in coefficients, and rings of edges with them.
_ENOUGH = 2
_MOST_RINGS = 4
_ALL_THREADS = 0


@dataclass(frozen=True, eq=False, repr=False)
class AngleDefects(ReadOnlyArrays):
    """Gaussian curvature of a surface by the angles of its triangles. Read-only.

    Attributes
    ----------
    defects : ndarray, shape (N,), float64
        What the angles around each vertex lack of 2 pi: the integral of the Gaussian
        curvature over its share of the area. At the boundary what they lack of pi, the
        integral of the geodesic curvature of the boundary. NaN at
        `Calculus.missing_vertices` and at `singular`.
    gaussian_curvature : ndarray, shape (N,), float64
        Defects over `Calculus.vertex_volumes`, in units of 1 / length^2; NaN at the
        boundary as well.
    singular : ndarray of int64
        Vertices around which the triangles are neither a disc nor half of one.
    total : float
        Sum of the defects.
    expected : float
        2 pi times the Euler characteristic of the complex: by Gauss and Bonnet the
        total, up to rounding, where nothing is singular.
    """

    defects: Floats
    gaussian_curvature: Floats
    singular: NDArray[np.int64]
    total: float
    expected: float

    def __repr__(self) -> str:
        return one_line(
            self,
            vertices=len(self.defects),
            total=rounded(self.total),
            expected=rounded(self.expected),
        )


@dataclass(frozen=True, eq=False, repr=False)
class Curvature(ReadOnlyArrays):
    """How a manifold bends in its space, at each vertex. Arrays are read-only.

    Attributes
    ----------
    tangents : ndarray, shape (N, K, D), float64
        Orthonormal tangent vectors; those of the fit, not of the reconstruction.
    second_form : ndarray, shape (N, K, K, D), float64
        Second fundamental form in these tangent vectors: symmetric, with values in the
        normal space, in units of 1 / length.
    missing : ndarray of int64
        Vertices where too few others are near for a fit, or none: NaN there.
    """

    tangents: Floats
    second_form: Floats
    missing: NDArray[np.int64]
    _normals: Floats | None

    def __repr__(self) -> str:
        count, dim, _, ambient = self.second_form.shape
        return one_line(
            self,
            vertices=count,
            dim=dim,
            ambient_dim=ambient,
            missing=len(self.missing),
        )

    @property
    def mean_curvature_vectors(self) -> Floats:
        """Mean of the second fundamental form over directions, (N, D)."""
        trace = np.einsum("niid->nd", self.second_form)
        return np.asarray(trace / self.tangents.shape[1])

    @property
    def ricci(self) -> Floats:
        """Ricci curvature in the tangent vectors, (N, K, K), by Gauss's equation."""
        form = self.second_form
        trace = np.einsum("niid->nd", form)
        first = np.einsum("nd,nijd->nij", trace, form)
        return np.asarray(first - np.einsum("nikd,nkjd->nij", form, form))

    @property
    def scalar(self) -> Floats:
        """Scalar curvature, (N,), by Gauss's equation: for K = 2 twice the Gaussian."""
        return np.asarray(np.einsum("nii->n", self.ricci))

    def sectional(self, first: int, second: int) -> Floats:
        """Sectional curvature of the plane of two of the tangent vectors.

        Parameters
        ----------
        first, second : int
            Which of them, from 0 to K - 1, not the same.

        Returns
        -------
        ndarray, shape (N,), float64
            In units of 1 / length^2.
        """
        dim = self.tangents.shape[1]
        if not (0 <= first < dim and 0 <= second < dim and first != second):
            msg = f"first and second are {first} and {second}, expected two of 0 to {dim - 1}"
            raise ValueError(msg)
        form = self.second_form
        squares = (form[:, first, first] * form[:, second, second]).sum(axis=1)
        return np.asarray(squares - (form[:, first, second] ** 2).sum(axis=1))

    @property
    def principal_curvatures(self) -> Floats:
        """Of a hypersurface, (N, K), ascending, positive where it bends to the normal.

        Raises
        ------
        ValueError
            D is not K + 1.
        """
        return self._shape_operators()[0]

    @property
    def principal_directions(self) -> Floats:
        """Unit vectors of `principal_curvatures`, (N, K, D)."""
        return np.asarray(
            np.einsum("nij,nid->njd", self._shape_operators()[1], self.tangents)
        )

    def _shape_operators(self) -> tuple[Floats, Floats]:
        if self._normals is None:
            _, dim, ambient = self.tangents.shape
            msg = (
                f"a manifold of dimension {dim} has principal curvatures in {dim + 1} "
                f"coordinates, not {ambient}: second_form has all there is"
            )
            raise ValueError(msg)
        form = np.einsum("nijd,nd->nij", self.second_form, self._normals)
        known = np.isfinite(form).all(axis=(1, 2))
        form[~known] = 0.0
        values, vectors = np.linalg.eigh(form)
        values[~known], vectors[~known] = np.nan, np.nan
        return values, vectors


def angle_defects(operators: Operators) -> AngleDefects:
    """What angles lack; see `Calculus.angle_defects`."""
    simplices, count = operators.simplices, operators.count
    frames, flat = operators.elements.frames, operators.elements.flat
    # Edges from the first corner are (base, 0) and (along, high).
    base, along, high = frames[:, 0, 0], frames[:, 1, 0], frames[:, 1, 1]
    angles = np.empty(simplices.shape)
    angles[:, 0] = np.arctan2(high, along)
    angles[:, 1] = np.arctan2(high, base - along)
    angles[:, 2] = np.arctan2(high * base, high * high - along * (base - along))
    angles[flat] = 0.0
    sums = np.asarray(np.bincount(simplices.ravel(), angles.ravel(), count), np.float64)
    rim = np.zeros(count, dtype=np.bool_)
    rim[open_faces(simplices)] = True
    defects: Floats = np.where(rim, np.pi, 2 * np.pi) - sums
    topology = operators.complex.topology()
    singular = np.zeros(count, dtype=np.bool_)
    singular[topology.singular_vertices] = True
    # An angle of a flat triangle is not known.
    singular[simplices[flat]] = True
    defects[~operators.used | singular] = np.nan
    with np.errstate(divide="ignore", invalid="ignore"):
        density = np.where(rim, np.nan, defects / operators.volumes)
    return AngleDefects(
        defects,
        density,
        np.flatnonzero(singular & operators.used),
        float(np.nansum(defects)),
        2 * np.pi * topology.euler_characteristic,
    )


def curvature(complex_: ComplexData, normals: Floats | None) -> Curvature:
    """Second fundamental forms; see `Calculus.curvature`.

    Normals say which way a hypersurface is positive.
    """
    dim, ambient = complex_.dim, complex_.coordinates.shape[1]
    tangents, form = second_forms(complex_)
    missing = np.flatnonzero(np.isnan(tangents).any(axis=(1, 2)))
    directions = None
    if ambient == dim + 1:
        directions = _normal_directions(tangents)
        if normals is not None:
            along = np.einsum("nd,nd->n", directions, normals)
            directions *= np.where(along < 0, -1.0, 1.0)[:, None]
    return Curvature(tangents, form, missing, directions)


def second_forms(
    complex_: ComplexData, vertices: NDArray[np.int32] | None = None
) -> tuple[Floats, Floats]:
    """Tangent vectors, (N, K, D), and second fundamental forms; NaN where none."""
    own = np.arange(complex_.num_vertices, dtype=np.int32)
    tangents, forms = _core.second_forms(
        np.ascontiguousarray(complex_.coordinates),
        np.ascontiguousarray(complex_.edges),
        complex_.dim,
        own if vertices is None else vertices,
        _ALL_THREADS,
    )
    return tangents, forms


def fit_at(
    complex_: ComplexData, vertex: int
) -> tuple[NDArray[np.int32], Floats, Floats]:
    """The others around a vertex, its tangent vectors, and where the others lie there.

    As far from the origin as they are from the vertex in space.
    """
    coordinates, dim = complex_.coordinates, complex_.dim
    wanted = _ENOUGH * (math.comb(dim + 3, 3) - 1)
    i, j = complex_.edges.T
    near = np.zeros(len(coordinates), dtype=np.bool_)
    near[vertex] = True
    for _ in range(_MOST_RINGS):
        ring = np.concatenate([j[near[i]], i[near[j]]])
        near[ring] = True
        if near.sum() > wanted:
            break
    near[vertex] = False
    others = np.flatnonzero(near).astype(np.int32)
    tangents, _ = second_forms(complex_, np.array([vertex], dtype=np.int32))
    if np.isnan(tangents).any():
        msg = (
            f"vertex {vertex} has {len(others)} others within {_MOST_RINGS} edges, too "
            f"few for a tangent space: {wanted} are needed, and not all on one curve"
        )
        raise ValueError(msg)
    steps = coordinates[others] - coordinates[vertex]
    places = steps @ tangents[0].T
    shadow = np.linalg.norm(places, axis=1)
    chord = np.linalg.norm(steps, axis=1)
    places *= (chord / np.where(shadow > 0, shadow, 1.0))[:, None]
    return others, tangents[0], places


def _normal_directions(tangents: Floats) -> Floats:
    """What is orthogonal to all tangent vectors, its largest entry positive."""
    known = np.asarray(np.isfinite(tangents).all(axis=(1, 2)))
    filled = np.where(known[:, None, None], tangents, 0.0)
    _, _, rows = np.linalg.svd(filled, full_matrices=True)
    normals = rows[:, -1]
    largest = np.abs(normals).argmax(axis=1)
    normals = normals * np.sign(normals[np.arange(len(normals)), largest])[:, None]
    normals[~known] = np.nan
    return np.asarray(normals)
